//! The same scene sounds and feels the same at every sample rate.

use crate::common;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::{ActuatorSettings, Config};
use common::{bar, grating, render, rms, stroke};
use std::collections::HashMap;

fn config(sample_rate_hz: f64) -> Config {
    Config {
        sample_rate_hz,
        actuators: vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }],
        ..Config::default()
    }
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

#[test]
fn an_impact_is_equally_loud_at_every_rate() {
    let log = ContactLog::parse(
        r#"{"t":0.1,"event":"impact","body":"b","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"steel"}"#,
        "log",
    )
    .unwrap();
    let level = |rate: f64| {
        let asperity::Engine { mut scene, renderer, .. } = config(rate).build().unwrap();
        let names = Names {
            bodies: HashMap::from([("b".to_owned(), scene.add_body(bar()).unwrap())]),
            ..Names::default()
        };
        let take = offline::render(scene, renderer, &log, &names, &Options::default()).unwrap();
        rms(&take.audio[0])
    };
    let reference = level(44_100.0);
    assert!(reference > 1e-3);
    for rate in [22_050.0, 48_000.0, 96_000.0, 192_000.0] {
        let difference = db(level(rate) / reference);
        assert!(difference.abs() <= 0.1, "{rate} Hz: {difference} dB");
    }
}

/// Felt and heard level of a stroke over a grating, dB about those at 44.1 kHz.
fn stroke_levels_db(wavelength_m: f64, amplitude_m: f64) -> Vec<(f64, f64, f64)> {
    let width_m = (common::SIDE_M / wavelength_m).round() * wavelength_m;
    let log = stroke(width_m, 0.1, 0.7, 0.5);
    let levels = |rate| {
        let take = render(config(rate), grating(wavelength_m, amplitude_m), &log, &Options::default());
        (rms(&take.haptic[0]), rms(&take.audio[0]))
    };
    let (felt, heard) = levels(44_100.0);
    assert!(felt > 0.0 && heard > 0.0);
    [22_050.0, 48_000.0, 96_000.0, 192_000.0]
        .map(|rate| {
            let now = levels(rate);
            let (felt, heard) = (db(now.0 / felt), db(now.1 / heard));
            println!("{wavelength_m} m, {rate} Hz: felt {felt:.3} dB, heard {heard:.3} dB");
            (rate, felt, heard)
        })
        .to_vec()
}

#[test]
fn a_grating_ringing_the_body_is_alike_at_every_rate() {
    // 412 Hz, the lowest mode of the bar, at 0.1 m/s.
    for (rate, felt, heard) in stroke_levels_db(0.1 / 412.0, 2e-6) {
        assert!(felt.abs() < 0.1 && heard.abs() < 0.1, "{rate} Hz: felt {felt} dB, heard {heard} dB");
    }
}

/// Far below its lowest mode a body follows the force like a spring. What is heard then is the sum
/// of the modes' static responses, and that of a mode sampled at ω T rad a step is (ω T/2) cot(ω
/// T/2) of the true one: at 44.1 kHz 0.28 dB of that rumble are missing, at 32 kHz, the slowest
/// rate inside, 0.53.
#[test]
fn a_coarse_grating_is_felt_and_heard_alike_at_every_rate() {
    for (rate, felt, heard) in stroke_levels_db(2e-3, 5e-5) {
        assert!(felt.abs() < 0.1 && heard.abs() < 0.3, "{rate} Hz: felt {felt} dB, heard {heard} dB");
    }
}
