//! Sand as a surface: reproducible renders, a hand-over that never waits, what is felt and heard.

mod common;

use asperity_texture::height_field::{HeightField, MAX_BLOCK, PathBlock, Reaction, SurfaceBlock, Touch};
use asperity_texture::sand::{SandDesign, SandLaw, SandSource};
use common::{bits, rms};

const RATE: f64 = 44_100.0;

fn design() -> SandDesign {
    SandDesign { width_m: 0.2, height_m: 0.1, cells: 400, ..SandDesign::default() }
}

/// A stroke as the engine makes it: a touch every 64 samples of the absolute grid, blocks of any
/// length between them.
fn play(
    source: &mut dyn HeightField,
    first_sample: u64,
    samples: usize,
    lengths: &[usize],
    force_n: f64,
    mut each: impl FnMut(&Reaction),
) -> Vec<f64> {
    let (start, velocity) = ([0.03, 0.05], [0.08, 0.01]);
    let position = |n: usize| [0, 1].map(|a| start[a] + velocity[a] * n as f64 / RATE);
    let mut out = SurfaceBlock::default();
    let mut heights = Vec::with_capacity(samples);
    let mut turn = 0;
    while heights.len() < samples {
        let n = heights.len();
        let sample = first_sample + n as u64;
        if sample.is_multiple_of(MAX_BLOCK as u64) {
            let touch = Touch {
                contact: 0,
                sample,
                position_m: position(n),
                velocity_m_s: velocity,
                normal_force_n: force_n,
            };
            each(&source.react(&touch));
        }
        let to_grid = MAX_BLOCK - (sample % MAX_BLOCK as u64) as usize;
        let length = lengths[turn % lengths.len()].min(to_grid).min(samples - n);
        turn += 1;
        let path: Vec<[f64; 2]> = (n..n + length).map(position).collect();
        let block = PathBlock {
            position_m: &path,
            velocity_m_s: &vec![velocity; length],
            footprint_m: &vec![0.0806 / RATE; length],
            normal_force_n: &[],
            first_sample: sample,
            contact: 0,
            slopes: true,
        };
        source.sample(&block, &mut out);
        heights.extend_from_slice(&out.height_m[..length]);
    }
    heights
}

#[test]
fn synchronous_sand_renders_the_same_bits_in_any_split_and_keeps_its_volume() {
    let run = |lengths: &[usize]| {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        let heights = play(&mut sand, 1000, 60_000, lengths, 2.0, |_| ());
        (bits(&heights), sand.finish().unwrap())
    };
    let (whole, (figures, picture)) = run(&[64]);
    assert_eq!(figures.drift_units, 0);
    assert!(figures.max_slope_deg <= 30.5 && figures.max_slope_deg > 3.0, "{figures:?}");
    assert!(picture.metres_per_grey > 0.0);
    let (split, (other, _)) = run(&[1, 17, 64, 5]);
    assert_eq!(whole, split);
    assert_eq!(figures, other);
}

#[test]
fn fresh_flat_sand_is_flat_but_for_its_grains_and_has_no_saw_at_the_frame_rate() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    let heights = play(&mut sand, 0, 60_000, &[64], 1.0, |_| ());
    // Grains alone, from a source that is never pressed.
    let mut still = SandSource::synchronous(&design(), 1).unwrap();
    let grains = play(&mut still, 0, 60_000, &[64], 0.0, |_| ());
    let rest: Vec<f64> = heights.iter().zip(&grains).map(|(a, b)| a - b).collect();
    let depth = SandLaw::default().depth_m(1.0);
    println!("grains {:.2e} m, the rest {:.2e} m, depth {depth:.2e} m", rms(&grains), rms(&rest));
    assert!(rms(&grains) > 1e-6 && rms(&rest) < 0.05 * depth);
    // The part at 60 Hz and its harmonics, against the depth.
    let at = |hz: f64| {
        let turn = std::f64::consts::TAU * hz / RATE;
        let (mut re, mut im) = (0.0, 0.0);
        for (n, r) in rest[10_000..50_000].iter().enumerate() {
            let window = (std::f64::consts::PI * n as f64 / 40_000.0).sin().powi(2);
            re += window * r * (turn * n as f64).cos();
            im += window * r * (turn * n as f64).sin();
        }
        4.0 * re.hypot(im) / 40_000.0
    };
    let frame_hz = RATE / 704.0;
    for k in 1..5 {
        let db = 20.0 * (at(f64::from(k) * frame_hz) / depth).log10();
        println!("{:.0} Hz: {db:.0} dB", f64::from(k) * frame_hz);
        assert!(db < -50.0, "{db} dB");
    }
}

#[test]
fn an_old_groove_is_felt_by_a_stroke_across_it() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    // A trench across the stroke at u = 0.07 m, 2 mm deep.
    sand.shape(|x, _| 0.05 - 0.002 * (-((x as f64 * 0.0005 - 0.07) / 0.003).powi(2)).exp());
    let heights = play(&mut sand, 0, 44_100, &[64], 0.3, |_| ());
    let near = |u: f64| {
        let n = ((u - 0.03) / 0.08 * RATE) as usize;
        heights[n - 200..n + 200].iter().sum::<f64>() / 400.0
    };
    println!("before {:.5}, in the trench {:.5}, after {:.5}", near(0.05), near(0.07), near(0.09));
    assert!(near(0.07) < -0.0008 && near(0.05) > -3e-4 && near(0.09) > -3e-4);
}

#[test]
fn a_finger_that_was_lifted_is_put_down_again_and_not_dragged_across() {
    // Two taps of the same voice, 0.1 m apart, with half a second between them or hardly any.
    for gap in [22_016, 64] {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        let tap = |sand: &mut SandSource, first: u64, u: f64| {
            for k in 0..40 {
                sand.react(&Touch {
                    contact: 0,
                    sample: first + 64 * k,
                    position_m: [u, 0.05],
                    velocity_m_s: [0.0; 2],
                    normal_force_n: 3.0,
                });
            }
            first + 64 * 40
        };
        let end = tap(&mut sand, 0, 0.05);
        tap(&mut sand, end + gap, 0.15);
        sand.finish().unwrap();
        let height = |u: f64| sand.simulation().unwrap().grid().height_at_m([u, 0.05]) - 0.05;
        println!("{gap}: {:.5} {:.5} {:.5}", height(0.05), height(0.1), height(0.15));
        assert!(height(0.05) < -1e-3 && height(0.15) < -1e-3 && height(0.1).abs() < 1e-9);
    }
}

#[test]
fn a_touch_is_answered_by_drag_and_by_grains_in_proportion_to_what_is_displaced() {
    let answers = |force: f64| {
        let mut sand = SandSource::synchronous(&design(), 1).unwrap();
        let mut last = Reaction::default();
        play(&mut sand, 0, 22_050, &[64], force, |r| last = *r);
        last
    };
    let (light, heavy) = (answers(0.5), answers(4.0));
    assert!((light.force_n[0] + 20.0 * 0.08 * 0.5).abs() < 1e-12 && light.force_n[2] == 0.0);
    assert!((heavy.force_n[1] + 20.0 * 0.01 * 4.0).abs() < 1e-12);
    println!("{light:?}\n{heavy:?}");
    assert!(light.grain_rate_per_s > 0.0 && heavy.grain_rate_per_s > 2.0 * light.grain_rate_per_s);
    // 0.3 mm of quartz at 0.08 m/s.
    assert!((heavy.grain_impulse_n_s / 3.0e-9 - 1.0).abs() < 0.05, "{}", heavy.grain_impulse_n_s);
}

#[test]
fn the_audio_half_goes_on_while_the_simulation_is_stuck_for_good() {
    let (mut sand, worker) = SandSource::threaded(&design(), 1).unwrap();
    // The worker never runs: poses fill their ring and are dropped, the surface stays what it was.
    let heights = play(&mut sand, 0, 300_000, &[64], 2.0, |_| ());
    assert!(heights.iter().all(|h| h.is_finite() && h.abs() < 1e-3));
    assert!(sand.finish().is_none());
    drop(worker);
    // Nor does a simulation that is gone.
    assert_eq!(play(&mut sand, 300_000, 6400, &[64], 2.0, |_| ()).len(), 6400);
}

#[test]
fn the_simulation_catches_up_after_a_pause_and_its_patches_circulate_for_ever() {
    let (mut sand, mut worker) = SandSource::threaded(&design(), 1).unwrap();
    let mut touches = 0;
    for round in 0..40 {
        play(&mut sand, round * 70_400, 70_400, &[64], 2.0, |_| {
            touches += 1;
            // A frame every 11 touches, with pauses of half a second in between.
            if touches % 11 == 0 && touches % 700 > 350 {
                worker.frame();
            }
        });
    }
    let figures = worker.simulation().figures();
    assert_eq!(figures.drift_units, 0);
    assert!(figures.max_slope_deg > 3.0, "the tool was heard: {figures:?}");
}

#[test]
fn a_simulation_on_its_own_thread_moves_sand_and_gives_it_back() {
    let (mut sand, worker) = SandSource::threaded(&design(), 1).unwrap();
    let thread = worker.spawn();
    for round in 0..30 {
        play(&mut sand, round * 6400, 6400, &[64], 2.0, |_| ());
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let mut simulation = thread.stop().unwrap();
    simulation.settle();
    let figures = simulation.figures();
    assert_eq!(figures.drift_units, 0);
    assert!(figures.max_slope_deg > 3.0 && figures.max_slope_deg <= 30.5, "{figures:?}");
}

#[test]
fn the_force_of_another_law_comes_without_a_step() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    let mut forces = Vec::new();
    let touch = |sample| Touch {
        contact: 0,
        sample,
        position_m: [0.05, 0.05],
        velocity_m_s: [0.08, 0.0],
        normal_force_n: 1.0,
    };
    for sample in 0..20_000 {
        if sample == 5000 {
            assert!(sand.change(&SandLaw { drag_s_per_m: 200.0, ..SandLaw::default() }, sample));
        }
        forces.push(sand.react(&touch(sample)).force_n[0]);
    }
    let step = forces.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!((forces[0] + 1.6).abs() < 1e-12 && (forces[19_999] + 16.0).abs() < 1e-12);
    assert!(20.0 * (step / 16.0).log10() < -60.0, "{step} N a sample");
}

#[test]
fn another_law_is_taken_at_run_time_and_an_impossible_one_is_not() {
    let mut sand = SandSource::synchronous(&design(), 1).unwrap();
    let wet = SandLaw { wetness: 1.0, ..SandLaw::default() };
    assert!(sand.change(&wet, 0));
    assert!(!sand.change(&SandLaw { drag_s_per_m: -1.0, ..wet }, 0));
    assert_eq!(sand.simulation().unwrap().law().wetness, 1.0);
    let mut drag = 0.0;
    play(&mut sand, 0, 6400, &[64], 1.0, |r| drag = r.force_n[0]);
    assert!((drag + 1.6).abs() < 1e-12);
}
