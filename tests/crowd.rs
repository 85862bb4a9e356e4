//! Crowds of contacts of which some are computed and the others spoken for.

use crate::common;
use crate::counting;

use asperity::{
    AudioBus, Config, ContactEvent, ContactId, ContactSample, Engine, ModalModel, Mode, Touching,
};
use asperity_dsp::rng::Rng;
use asperity_measure::spectrum::third_octaves_from_db;
use common::{SIDE_M, grating, plate};

/// A body that answers everywhere between 80 Hz and 10 kHz.
fn floor() -> ModalModel {
    let mode = |i: i32| {
        let frequency_hz = 80.0 * 1.083f64.powi(i);
        Mode { frequency_hz, decay_per_s: 40.0 + 0.08 * frequency_hz, amplitude: 0.2, phase_rad: 0.0 }
    };
    ModalModel::new((0..60).map(mode).collect(), 0.01).unwrap()
}

/// One of a crowd: where it begins, where it goes, how hard it is pressed.
struct Walker {
    uv: [f64; 2],
    velocity_m_s: [f64; 2],
    force_n: f64,
}

fn crowd(count: usize, seed: u64) -> Vec<Walker> {
    let mut rng = Rng::new(seed);
    (0..count)
        .map(|_| {
            let (speed, (sin, cos)) = (0.03 * 10f64.powf(rng.uniform()), (6.3 * rng.uniform()).sin_cos());
            Walker {
                uv: [rng.uniform(), rng.uniform()],
                velocity_m_s: [speed * cos, speed * sin],
                force_n: 0.1 * 10f64.powf(rng.uniform()),
            }
        })
        .collect()
}

impl Walker {
    fn at(&self, t: f64, tells_velocity: bool) -> ContactSample {
        ContactSample {
            uv: [0, 1].map(|axis| self.uv[axis] + self.velocity_m_s[axis] * t / SIDE_M),
            velocity_m_s: tells_velocity.then_some(self.velocity_m_s),
            normal_force_n: self.force_n,
            ..ContactSample::default()
        }
    }
}

/// What a crowd sounds like, reported 60 times a second, in blocks of these lengths; and the time in the renderer, s.
fn sound(
    walkers: &[Walker],
    config: &Config,
    seconds: f64,
    tells_velocity: bool,
    blocks: &[usize],
) -> (Vec<f32>, f64) {
    let Engine { mut scene, mut renderer, .. } = config.clone().build().unwrap();
    let body = scene.add_body(floor()).unwrap();
    let surface = scene.add_surface(plate(0.7).on(body)).unwrap();
    for (index, walker) in walkers.iter().enumerate() {
        let (contact, touching) = (ContactId(index as u64), Touching::on(surface));
        scene.report(0.0, ContactEvent::Begin { contact, touching, sample: walker.at(0.0, true) }).unwrap();
    }
    let frames = (seconds * 44_100.0) as usize;
    let mut audio = vec![0.0; frames];
    let (mut at, mut reports, mut took_s, mut block) = (0, 1, 0.0, 0);
    while at < frames {
        while 735 * reports <= at {
            let t = reports as f64 / 60.0;
            for (index, walker) in walkers.iter().enumerate() {
                let moved = ContactEvent::moved(ContactId(index as u64), walker.at(t, tells_velocity));
                scene.report(t, moved).unwrap();
            }
            reports += 1;
        }
        let n = blocks[block % blocks.len()].min(frames - at);
        let mut haptic = vec![0.0; n];
        let out = &mut audio[at..at + n];
        let since = std::time::Instant::now();
        let heap = counting::heap_operations(|| renderer.render(&mut [&mut haptic], &mut [&mut *out]));
        took_s += since.elapsed().as_secs_f64();
        assert_eq!(heap, 0);
        (at, block) = (at + n, block + 1);
    }
    assert_eq!(scene.stats().contacts, walkers.len() as u64);
    (audio, took_s)
}

fn many(exact_contacts: Option<usize>, seed: u64) -> Config {
    let audio = vec![AudioBus::default()];
    Config { max_contacts: 256, queue_capacity: 65_536, exact_contacts, seed, audio, ..Config::default() }
}

#[test]
fn of_two_hundred_contacts_thirty_two_speak_for_all_within_a_decibel_and_a_half_a_third_octave() {
    let (mut exact, mut stood) = (vec![0.0; 20], vec![0.0; 20]);
    let mut times_s = [0.0; 2];
    for seed in 1..=3 {
        let walkers = crowd(200, 100 + seed);
        for (config, sum, time_s) in
            [(many(None, seed), &mut exact, 0), (many(Some(32), seed), &mut stood, 1)]
        {
            let (sound, took_s) = sound(&walkers, &config, 3.0, true, &[64]);
            times_s[time_s] += took_s;
            let levels_db = third_octaves_from_db(&sound[22_050..], 44_100.0, 8192, 100.0, 20);
            sum.iter_mut().zip(levels_db).for_each(|(sum, db)| *sum += 10f64.powf(0.1 * db));
        }
    }
    let apart_db: Vec<f64> = exact.iter().zip(&stood).map(|(a, b)| 10.0 * (b / a).log10()).collect();
    println!("third octaves from 100 Hz: {apart_db:.2?} dB, {:.1} times the speed", times_s[0] / times_s[1]);
    assert!(apart_db.iter().all(|db| db.abs() <= 1.5), "{apart_db:?}");
    assert!(times_s[1] < times_s[0]);
}

#[test]
fn a_crowd_that_does_not_tell_its_velocity_is_as_loud() {
    let walkers = crowd(100, 7);
    let rms = |tells| common::rms(&sound(&walkers, &many(Some(16), 1), 1.5, tells, &[64]).0[22_050..]);
    let louder_db = 20.0 * (rms(false) / rms(true)).log10();
    assert!(louder_db.abs() < 1.5, "{louder_db} dB");
}

#[test]
fn blocks_of_any_size_and_any_number_of_threads_sound_the_same_to_the_bit() {
    let walkers = crowd(60, 5);
    let config = many(Some(8), 3);
    let whole = sound(&walkers, &config, 0.7, true, &[735]).0;
    assert!(common::rms(&whole) > 0.0);
    // Reports come at multiples of 735 samples.
    let cut = sound(&walkers, &config, 0.7, true, &[64, 1, 100, 7, 256, 307]).0;
    assert_eq!(whole.iter().zip(&cut).position(|(a, b)| a != b), None, "the first sample that differs");
    let threads = Config { threads: 3, ..config };
    let shared_out = sound(&walkers, &threads, 0.7, true, &[735]).0;
    assert_eq!(
        whole.iter().zip(&shared_out).position(|(a, b)| a != b),
        None,
        "the first sample that differs"
    );
}

#[test]
fn without_a_bound_and_below_it_nothing_changes_a_bit() {
    let walkers = crowd(12, 9);
    let all = sound(&walkers, &many(None, 1), 0.3, true, &[64]).0;
    assert!(sound(&walkers, &many(Some(12), 1), 0.3, true, &[64]).0 == all);
}

#[test]
fn a_crowd_that_lifts_or_is_lost_falls_silent() {
    let walkers = crowd(50, 11);
    for lifts in [true, false] {
        let Engine { mut scene, mut renderer, .. } = many(Some(4), 1).build().unwrap();
        let body = scene.add_body(floor()).unwrap();
        let surface = scene.add_surface(grating(2e-3, 2e-5).on(body)).unwrap();
        for (index, walker) in walkers.iter().enumerate() {
            let (contact, touching) = (ContactId(index as u64), Touching::on(surface));
            scene
                .report(0.0, ContactEvent::Begin { contact, touching, sample: walker.at(0.0, true) })
                .unwrap();
        }
        if lifts {
            for contact in (0..walkers.len() as u64).map(ContactId) {
                scene.report(0.2, ContactEvent::End { contact }).unwrap();
            }
        }
        let (mut haptic, mut audio) = (vec![0.0; 88_200], vec![0.0; 88_200]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        assert!(common::rms(&audio[..8820]) > 0.0);
        assert!(common::rms(&audio[66_150..]) < 1e-4 * common::rms(&audio[..8820]), "lifts {lifts}");
        assert_eq!(scene.stats().contacts, 0);
    }
}

#[test]
fn what_is_felt_is_always_computed() {
    let walkers = crowd(20, 13);
    let felt = |exact_contacts| {
        let Engine { mut scene, mut renderer, .. } = many(exact_contacts, 1).build().unwrap();
        let body = scene.add_body(floor()).unwrap();
        let surface = scene.add_surface(plate(0.7).on(body)).unwrap();
        for (index, walker) in walkers.iter().enumerate() {
            let event = ContactEvent::begin(
                ContactId(index as u64),
                surface,
                asperity::Actuator(0),
                walker.at(0.0, true),
            );
            scene.report(0.0, event).unwrap();
        }
        let (mut haptic, mut audio) = (vec![0.0; 4410], vec![0.0; 4410]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        (haptic, audio)
    };
    assert!(felt(Some(2)) == felt(None));
}
