//! A body's residual: every impact plays it once, in the contact's own sample, as loud as the
//! strike.

use crate::common;

use asperity::files::contact_log::{ContactLog, LogEvent, Names};
use asperity::offline::{self, Options, Render};
use asperity::{Config, ModalModel, Residual};
use common::bar;
use std::collections::HashMap;

/// A burst at `rate_hz` of a strike of 0.01 N·s.
fn burst(rate_hz: f64) -> Residual {
    let at = |n: usize| 0.3 * (1.0 - n as f64 / 600.0) * (0.9 * n as f64).sin();
    Residual { sample_rate_hz: rate_hz, samples: (0..600).map(|n| at(n) as f32).collect() }
}

fn body(residual: Option<Residual>) -> ModalModel {
    bar().with_residual(residual, 1.0).unwrap()
}

/// Impacts of `speeds` on the body, 5 ms apart, on samples that are no block's first.
fn struck(model: ModalModel, speeds: &[f64], options: &Options) -> Render {
    let asperity::Engine { mut scene, renderer, .. } = Config::default().build().unwrap();
    let body = scene.add_body(model).unwrap();
    let lines = speeds.iter().enumerate().map(|(i, speed)| {
        format!(
            "{{\"t\":{},\"event\":\"impact\",\"body\":\"b\",\"speed_m_s\":{speed},\"mass_kg\":0.01,\"radius_m\":0.005,\"striker\":\"steel\"}}\n",
            0.01003 + 0.005 * i as f64
        )
    });
    let log = ContactLog::parse(&lines.collect::<String>(), "made").unwrap();
    assert!(log.lines.iter().all(|line| matches!(line.event, LogEvent::Impact { .. })));
    let names = Names { bodies: HashMap::from([("b".to_owned(), body)]), ..Names::default() };
    offline::render(scene, renderer, &log, &names, options).unwrap()
}

/// The sample that an impact at 0.01003 s is heard from: sound lags the report by the impulse
/// ring's two samples.
fn start() -> usize {
    (0.01003_f64 * 44_100.0).round() as usize + 2
}

const OPTIONS: Options = Options { block_frames: 256, tail_s: 0.2, clock_s: None };

#[test]
fn an_impact_plays_the_residual_scaled_by_its_impulse() {
    for (speed, gain) in [(0.5, 1.0), (1.0, 2.0), (0.05, 0.1)] {
        let with = struck(body(Some(burst(44_100.0))), &[speed], &OPTIONS).audio.swap_remove(0);
        let without = struck(body(None), &[speed], &OPTIONS).audio.swap_remove(0);
        let start = start();
        for (n, (with, without)) in with.iter().zip(&without).enumerate() {
            let played = n.checked_sub(start).and_then(|n| burst(44_100.0).samples.get(n).copied());
            let expected = gain * f64::from(played.unwrap_or(0.0));
            let heard = f64::from(*with) - f64::from(*without);
            assert!(
                (heard - expected).abs() < 1e-5 * (1.0 + gain),
                "speed {speed}, sample {n}: {heard} {expected}"
            );
        }
    }
}

#[test]
fn overlapping_bursts_are_the_same_bits_in_blocks_of_any_size() {
    let speeds = [0.3, 0.9, 0.1, 0.7, 0.2, 0.8, 0.4, 0.6, 0.5, 1.0, 0.3, 0.2];
    let with = |block_frames| {
        struck(body(Some(burst(48_000.0))), &speeds, &Options { block_frames, ..OPTIONS })
            .audio
            .swap_remove(0)
    };
    let reference = with(256);
    assert!(reference.iter().any(|x| *x != 0.0));
    for block_frames in [1, 7, 63, 64, 441, 4096] {
        assert!(with(block_frames) == reference, "blocks of {block_frames} differ");
    }
}

#[test]
fn a_body_of_nothing_but_a_residual_sounds_and_is_silent_again() {
    let model = ModalModel::new(Vec::new(), 0.01).unwrap().with_residual(Some(burst(44_100.0)), 2.0).unwrap();
    let audio = struck(model, &[0.5], &OPTIONS).audio.swap_remove(0);
    let last = audio.iter().rposition(|x| *x != 0.0).unwrap();
    let start = start();
    assert!((start + 590..start + 600).contains(&last), "{last}");
    assert!((f64::from(audio[start + 10]) - 2.0 * f64::from(burst(44_100.0).samples[10])).abs() < 1e-6);
}

#[test]
fn the_modes_file_carries_the_residual_and_refuses_what_is_none() {
    let model = body(Some(burst(44_100.0)));
    assert_eq!(ModalModel::parse(&model.to_json()).unwrap(), model);
    assert!(!body(None).to_json().contains("residual"));
    let text = |residual: &str| {
        format!(r#"{{"format":"asperity.modes","version":1,"modes":[],"residual":{residual}}}"#)
    };
    let long = format!(r#"{{"sample_rate_hz":1000.0,"samples":[{}0.0]}}"#, "0.0,".repeat(600));
    for bad in [
        r#"{"sample_rate_hz":0.0,"samples":[0.1]}"#,
        r#"{"sample_rate_hz":44100.0,"samples":[1e30]}"#,
        r#"{"sample_rate_hz":44100.0}"#,
        &long,
    ] {
        let error = ModalModel::parse(&text(bad)).unwrap_err().to_string();
        assert!(error.contains("residual") || error.contains("samples"), "{error}");
        assert!(error.contains("; must be"), "{error}");
    }
    assert!(body(Some(burst(44_100.0))).with_residual(None, 1.0).unwrap().residual.is_none());
}
