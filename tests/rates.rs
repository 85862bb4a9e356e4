//! The same scene sounds and feels the same at every sample rate.

mod common;

use asperity::contact_log::{ContactLog, Names};
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
        let (mut scene, renderer) = config(rate).build().unwrap();
        let names = Names {
            bodies: HashMap::from([("b".to_owned(), scene.add_body(bar()).unwrap())]),
            ..Names::default()
        };
        let take = offline::render(scene, renderer, &log, &names, &Options::default()).unwrap();
        rms(&take.audio)
    };
    let reference = level(44_100.0);
    assert!(reference > 1e-3);
    for rate in [22_050.0, 48_000.0, 96_000.0, 192_000.0] {
        let difference = db(level(rate) / reference);
        assert!(difference.abs() <= 0.1, "{rate} Hz: {difference} dB");
    }
}

#[test]
fn a_stroke_is_felt_and_heard_alike_at_every_rate() {
    let surface = || grating(2e-3, 5e-5);
    let width_m = (common::SIDE_M / 2e-3).round() * 2e-3;
    let log = stroke(width_m, 0.1, 0.7, 0.5);
    let levels = |rate| {
        let take = render(config(rate), surface(), &log, &Options::default());
        (rms(&take.haptic[0]), rms(&take.audio))
    };
    let reference = levels(44_100.0);
    for rate in [22_050.0, 48_000.0, 96_000.0, 192_000.0] {
        let (felt, heard) = levels(rate);
        assert!(db(felt / reference.0).abs() < 0.1, "{rate} Hz: felt {} dB", db(felt / reference.0));
        // The contact force is a mean over one step, which droops as sinc(f / rate): 0.9 dB at the
        // highest mode (5.5 kHz) at 22.05 kHz, 0.2 dB at 44.1 kHz.
        let allowed = if rate < 44_100.0 { 1.0 } else { 0.3 };
        assert!(db(heard / reference.1).abs() < allowed, "{rate} Hz: heard {} dB", db(heard / reference.1));
    }
}
