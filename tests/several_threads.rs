//! Several threads render what one does, to the bit, and nobody allocates or waits for ever.

#[path = "common/counting.rs"]
mod counting;
#[path = "common/random_game.rs"]
#[allow(dead_code)]
mod random_game;

#[path = "common/many_bodies.rs"]
mod many_bodies;

mod common;

use asperity::{Body, Config, ContactEvent, Impact, Material};
use counting::heap_operations;
use many_bodies::{Strokes, modes};
use random_game::RandomGame;
use std::time::Instant;

fn bits([haptic, audio]: &[Vec<f32>; 2]) -> Vec<u32> {
    haptic.iter().chain(audio).map(|x| x.to_bits()).collect()
}

#[test]
fn any_threads_and_blocks_render_the_same_bits() {
    let alone = Strokes::new(7, 200, 1).render(40_000, || 256);
    assert!(alone.iter().all(|channel| channel.iter().any(|x| x.abs() > 1e-5)), "nothing to compare");
    for (threads, frames) in [(2, 256), (3, 64), (8, 256), (2, 37), (8, 500)] {
        let shared = Strokes::new(7, 200, threads).render(40_000, || frames);
        assert!(bits(&shared) == bits(&alone), "{threads} threads, blocks of {frames}");
    }
}

#[test]
fn a_random_game_renders_the_same_bits_on_three_threads() {
    let play = |threads| {
        let (mut game, mut renderer) = RandomGame::with(7, Config { threads, ..Config::default() });
        let mut all = [Vec::new(), Vec::new()];
        let (mut haptic, mut audio) = ([0.0f32; 128], [0.0f32; 128]);
        while game.time_s < 8.0 {
            let until = game.time_s + 0.005;
            while game.time_s < until {
                game.step();
            }
            while (renderer.position() as f64) < game.time_s * renderer.sample_rate_hz() {
                renderer.render(&mut [&mut haptic], &mut [&mut audio]);
                all[0].extend(haptic);
                all[1].extend(audio);
            }
            game.scene.collect();
        }
        all
    };
    assert!(bits(&play(1)) == bits(&play(3)));
}

#[test]
fn rendering_on_several_threads_touches_no_heap_on_the_audio_half() {
    let mut strokes = Strokes::new(6, 300, 3);
    let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
    let mut touched = 0;
    for _ in 0..3000 {
        strokes.block(&mut haptic, &mut audio);
        let Strokes { renderer, .. } = &mut strokes;
        touched += heap_operations(|| renderer.render(&mut [&mut haptic], &mut [&mut audio]));
        strokes.scene.collect();
    }
    assert_eq!(touched, 0);
}

#[test]
fn a_renderer_that_is_dropped_while_everything_rings_ends_its_threads() {
    for round in 0..40 {
        let mut strokes = Strokes::new(4, 300, 4);
        for body in 0..round % 3 {
            let on = strokes.scene.add_body(Body::new(modes(100)).material(Material::CERAMIC)).unwrap();
            strokes.scene.report(0.01 * f64::from(body), ContactEvent::Impact(Impact::on(on))).unwrap();
        }
        strokes.render(64 * round as usize, || 64);
    }
}

#[test]
fn no_more_threads_than_sixty_four_are_taken_and_at_least_one() {
    for threads in [0, 65] {
        let message = Config { threads, ..Config::default() }.build().unwrap_err().to_string();
        assert!(message.contains("threads") && message.contains("1–64 threads"), "{message}");
    }
}

#[test]
fn a_second_thread_costs_three_microseconds_a_silent_block() {
    let cost_s = |threads| {
        let mut idle = Strokes::new(0, 1, threads);
        let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
        let mut times: Vec<f64> = (0..20_000)
            .map(|_| {
                let began = Instant::now();
                idle.block(&mut haptic, &mut audio);
                began.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        times[10_000]
    };
    let more_s = cost_s(2) - cost_s(1);
    println!("{:.2} µs a block", 1e6 * more_s);
    assert!(more_s <= 3e-6, "{more_s}");
}
