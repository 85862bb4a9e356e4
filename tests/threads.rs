//! The two halves on two real threads, and games that misbehave: nothing is lost uncounted, nothing
//! waits, nothing leaks.

use crate::common;
use crate::steps;

use asperity::{
    ActuatorSettings, ChannelId, ClockMode, Config, ContactEvent, ContactId, ContactSample, Material,
    ModalModel, Mode, Renderer, Scene, SurfaceId,
};
use common::{grating, peak};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use steps::largest_step;

/// Loud, because modes fall asleep at −120 dB of full scale, which must lie far below −60 dB of the
/// signal.
fn low_body() -> ModalModel {
    let mode = Mode { frequency_hz: 220.0, decay_per_s: 8.0, amplitude: 90.0, phase_rad: 0.0 };
    ModalModel::new(vec![mode], 0.01).unwrap()
}

fn engine(config: Config) -> (Scene, Renderer, SurfaceId, asperity::BodyId) {
    let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(low_body()).unwrap();
    let surface = scene.add_surface(grating(2e-3, 2e-5).body(body)).unwrap();
    (scene, renderer, surface, body)
}

fn live() -> Config {
    let actuators = vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }];
    Config { clock: ClockMode::LIVE, actuators, ..Config::default() }
}

fn sample_at(time_s: f64) -> ContactSample {
    ContactSample {
        uv: [0.1 + 0.1 * time_s / common::SIDE_M, 0.5],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    }
}

#[test]
fn two_threads_lose_no_event_and_no_memory_between_them() {
    let (mut scene, mut renderer, surface, body) = engine(Config { queue_capacity: 256, ..live() });
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = stop.clone();
    let audio = std::thread::spawn(move || {
        let mut finite = true;
        while !stopped.load(Ordering::Relaxed) {
            let (mut h, mut a) = ([0.0f32; 64], [0.0f32; 64]);
            renderer.render(&mut [&mut h], &mut [&mut a]);
            finite &= h.iter().chain(&a).all(|x| x.is_finite());
        }
        (renderer, finite)
    });
    let began = Instant::now();
    let (mut reported, mut handed_back, mut swaps, mut freed) = (0u64, 0u64, 0u64, 0u64);
    while began.elapsed() < Duration::from_millis(1500) {
        let time_s = began.elapsed().as_secs_f64();
        let contact = ContactId(reported % 12);
        let event = match reported % 97 {
            0..=11 => ContactEvent::begin(contact, surface, ChannelId(0), sample_at(time_s)),
            12..=14 => ContactEvent::end(contact),
            _ => ContactEvent::moved(contact, sample_at(time_s)),
        };
        reported += 1;
        if let Err(refused) = scene.report(time_s, event) {
            assert_eq!(refused.event, event, "the event comes back as it was");
            handed_back += 1;
        }
        if reported.is_multiple_of(1000) {
            swaps += u64::from(scene.replace_surface(surface, grating(2e-3, 1e-5).body(body)).is_ok());
            swaps += u64::from(
                scene.replace_body(body, asperity::Body::new(low_body()).material(Material::GLASS)).is_ok(),
            );
        }
        freed += scene.collect() as u64;
    }
    // Let the audio half catch up, then stop it.
    let settled = Instant::now();
    while settled.elapsed() < Duration::from_millis(100) {
        freed += scene.collect() as u64;
        std::thread::sleep(Duration::from_millis(1));
    }
    stop.store(true, Ordering::Relaxed);
    let (mut renderer, finite) = audio.join().unwrap();
    let (mut h, mut a) = (vec![0.0; 50_000], vec![0.0; 50_000]);
    renderer.render(&mut [&mut h], &mut [&mut a]);
    freed += scene.collect() as u64;
    let stats = scene.stats();
    assert!(finite);
    assert_eq!(stats.dropped, handed_back);
    let nowhere = reported - stats.events - stats.superseded - stats.dropped;
    // What is still held back for the next report: at most one move a contact.
    assert!(nowhere <= 12, "{nowhere} events are nowhere: {stats:?}");
    // Swaps free what came home before; were anything lost on the way, the places would run out.
    assert!(swaps > 20 && freed > 0, "{swaps} swaps, {freed} freed");
    eprintln!("{reported} events, {swaps} swaps, {freed} of them freed last: {stats:?}");
}

/// Plays `game` for `seconds`: it is asked at each block for what it reports.
fn play(
    scene: &mut Scene,
    renderer: &mut Renderer,
    seconds: f64,
    mut game: impl FnMut(&mut Scene, f64),
) -> (Vec<f32>, Vec<f32>) {
    let (mut haptic, mut audio) = (Vec::new(), Vec::new());
    while (audio.len() as f64) < seconds * 44_100.0 {
        game(scene, audio.len() as f64 / 44_100.0);
        let (mut h, mut a) = ([0.0f32; 64], [0.0f32; 64]);
        renderer.render(&mut [&mut h], &mut [&mut a]);
        haptic.extend(h);
        audio.extend(a);
    }
    (haptic, audio)
}

/// The game's clock as a function of the audio's; `None` while the game stands still.
fn stroke_with(clock: impl Fn(f64) -> Option<f64>) -> (asperity::Stats, Vec<f32>, Vec<f32>) {
    let (mut scene, mut renderer, surface, _) = engine(live());
    scene.report(0.0, ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample_at(0.0))).unwrap();
    let mut next = 0u64;
    let (haptic, audio) = play(&mut scene, &mut renderer, 4.0, |scene, now_s| {
        if now_s * 60.0 < next as f64 {
            return;
        }
        next += 1;
        if let Some(time_s) = clock(now_s) {
            scene.report(time_s, ContactEvent::moved(ContactId(1), sample_at(now_s))).unwrap();
        }
    });
    (scene.stats(), haptic, audio)
}

fn assert_no_glitch(x: &[f32], what: &str) {
    let step = largest_step(&x[4410..]) / peak(&x[4410..]);
    eprintln!("{what}: largest step {:.1} dB", 20.0 * step.log10());
    assert!(step < 1e-3, "{what}: a step of {:.1} dB of the peak", 20.0 * step.log10());
}

#[test]
fn a_game_that_stands_still_for_two_seconds_fades_and_comes_back() {
    let (stats, haptic, audio) = stroke_with(|now_s| (!(1.0..3.0).contains(&now_s)).then_some(now_s));
    assert_eq!((stats.lapsed, stats.contacts), (1, 1), "{stats:?}");
    assert_eq!(peak(&haptic[80_000..130_000]), 0.0, "silent while nothing is heard of the game");
    assert!(peak(&haptic[150_000..]) > 0.0, "back with the first move");
    assert_no_glitch(&haptic, "stalled, felt");
    assert_no_glitch(&audio, "stalled, heard");
}

#[test]
fn game_time_that_jumps_ahead_is_tied_anew_and_counted() {
    let (stats, haptic, audio) =
        stroke_with(|now_s| Some(if now_s < 1.0 { now_s } else { now_s + 1000.0 * now_s.floor() }));
    assert!((1..=4).contains(&stats.clock_jumps), "{stats:?}");
    assert_eq!((stats.refused, stats.lapsed), (0, 0), "{stats:?}");
    assert_no_glitch(&haptic, "time jumps ahead, felt");
    assert_no_glitch(&audio, "time jumps ahead, heard");
}

#[test]
fn game_time_that_runs_backwards_is_tied_anew_and_counted() {
    let (stats, haptic, audio) =
        stroke_with(|now_s| Some(if (1.0..1.5).contains(&now_s) { now_s - 0.6 } else { now_s }));
    assert_eq!((stats.clock_jumps, stats.refused, stats.contacts), (2, 0, 1), "{stats:?}");
    assert_no_glitch(&haptic, "time runs backwards, felt");
    assert_no_glitch(&audio, "time runs backwards, heard");
}

#[test]
fn both_halves_can_live_where_only_what_is_shared_may() {
    fn shared<T: Send + Sync>(_: &T) {}
    let asperity::Engine { scene, renderer, .. } = Config::default().build().unwrap();
    shared(&scene);
    shared(&renderer);
}
