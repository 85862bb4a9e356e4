//! Reliefs of the study are heard as such: by micro-collisions loud enough, with the force not far
//! above, and with an envelope that beats with the waves, also where a finger follows them without
//! leaping.

use crate::common;

use asperity::files::contact_log::Names;
use asperity::offline::{self, Options};
use asperity::{Config, Engine, Excitation, ModalModel, Mode, Probe, Tap};
use common::plates::surface;
use common::{SIDE_M, rms, si_config, stroke};
use std::collections::HashMap;
use std::f64::consts::PI;

/// The gain of the demo's plates.
const GAIN: f64 = 5.0;
const WAVE_M: f64 = 0.007;
const RELIEFS: [&str; 5] = ["flat", "ridge", "bumps", "sine", "sawtooth"];
const STROKES: [(f64, f64); 4] = [(0.1, 0.2), (0.1, 0.6), (0.2, 0.2), (0.2, 0.6)];

/// A free disc of printed PLA, as the demo's: λ² of Leissa 1969.
fn disc() -> ModalModel {
    const SQUARES: [f64; 9] = [5.25, 9.08, 12.2, 20.5, 21.5, 33.1, 35.3, 38.6, 53.0];
    let mode = |(index, square): (usize, &f64)| {
        let frequency_hz = 430.0 * square / SQUARES[0];
        let amplitude = 0.3 / (1.0 + 0.35 * index as f64);
        Mode { frequency_hz, decay_per_s: 25.0 + 0.03 * frequency_hz, amplitude, phase_rad: 0.0 }
    };
    ModalModel::new(SQUARES.iter().enumerate().map(mode).collect(), 0.01).unwrap()
}

/// How far a pad stands above the ground at most, m.
struct Leap(f64);

impl Tap for Leap {
    fn contact(&mut self, block: &asperity::ContactBlock<'_>) {
        let gaps = block.contact_samples.iter().map(|row| row.pad_m - row.height_m);
        self.0 = gaps.fold(self.0, f64::max);
    }
}

fn heard(plate: &str, (speed_m_s, force_n): (f64, f64), excitation: Excitation) -> (Vec<f32>, f64) {
    // One asperity, before many share the load.
    let config = si_config();
    let probe = Probe { asperities: 1.0, ..config.probe };
    let Engine { mut scene, renderer, .. } = Config { probe, ..config }.build().unwrap();
    let body = scene.add_body(disc()).unwrap();
    let id = scene.add_surface(surface(plate).body(body).excitation(excitation)).unwrap();
    let names = Names { surfaces: HashMap::from([("s".to_owned(), id)]), ..Names::default() };
    let log = stroke(SIDE_M, speed_m_s, force_n, if speed_m_s > 0.15 { 0.6 } else { 1.0 });
    let mut leap = Leap(0.0);
    let options = Options { tail_s: 0.0, ..Options::default() };
    let take = offline::render_tapped(scene, renderer, &log, &names, &options, &mut leap).unwrap();
    (take.audio[0][8820..].to_vec(), leap.0)
}

fn db(x: &[f32]) -> f64 {
    20.0 * (GAIN * rms(x)).log10()
}

/// Depth to which the envelope beats at a frequency or twice that.
fn beat(x: &[f32], frequency_hz: f64) -> f64 {
    const HOP: usize = 44;
    let envelope: Vec<f64> = x.chunks_exact(HOP).map(rms).collect();
    let hann = |i: usize| 1.0 - (2.0 * PI * i as f64 / envelope.len() as f64).cos();
    let mean: f64 = envelope.iter().enumerate().map(|(i, level)| hann(i) * level).sum();
    let depth = |harmonic: f64| {
        let turn = |i: usize| 2.0 * PI * harmonic * frequency_hz * (i * HOP) as f64 / 44_100.0;
        let part = |wave: fn(f64) -> f64| -> f64 {
            envelope.iter().enumerate().map(|(i, level)| hann(i) * level * wave(turn(i))).sum()
        };
        2.0 * part(f64::cos).hypot(part(f64::sin)) / mean
    };
    depth(1.0).max(depth(2.0))
}

#[test]
fn every_relief_sounds_by_collisions_and_beats_with_its_waves() {
    let mut least_beat = f64::INFINITY;
    for plate in RELIEFS {
        for at in STROKES {
            let (collisions, leap_m) = heard(plate, at, Excitation::COLLISIONS);
            let (force, _) = heard(plate, at, Excitation::FORCE);
            let (both, _) = heard(plate, at, Excitation::BOTH);
            let depth = beat(&both, at.0 / WAVE_M);
            println!(
                "{plate:>8}, {} m/s, {} N: collisions {:.1}, force {:.1} dBFS, beats {depth:.2}, leaps {:.2} mm",
                at.0,
                at.1,
                db(&collisions),
                db(&force),
                1e3 * leap_m
            );
            assert!(db(&collisions) >= -45.0 && db(&force) <= db(&collisions) + 10.0, "{plate} {at:?}");
            assert!(leap_m <= 1.5e-3, "{plate} {at:?}: {leap_m} m");
            match plate {
                "bumps" | "sine" => least_beat = least_beat.min(depth),
                "flat" => assert!(depth < 0.12, "{depth}"),
                _ => {}
            }
        }
    }
    println!("bumps and sine beat by at least {least_beat:.2}");
    assert!(least_beat > 0.2, "{least_beat}");
}
