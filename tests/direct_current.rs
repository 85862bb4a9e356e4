//! A push does not stay in a sound: the mean of what is heard, beside its level.

use crate::common;

use asperity::files::contact_log::Names;
use asperity::offline::{self, Options};
use asperity::{Config, Excitation, ModalModel, Mode};
use common::{plate, stroke};
use std::collections::HashMap;
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;

/// A body that bends under a push, as fitted plates do: its modes do not begin at zero.
fn bending() -> ModalModel {
    let mode = |frequency_hz, amplitude| Mode { frequency_hz, decay_per_s: 40.0, amplitude, phase_rad: 0.9 };
    ModalModel::new(vec![mode(310.0, 0.3), mode(870.0, 0.2), mode(2100.0, 0.2)], 0.01).unwrap()
}

/// What is heard of a stroke over ground of a roughness.
fn heard(roughness: f64, speed_m_s: f64, excitation: Excitation) -> Vec<f32> {
    let asperity::Engine { mut scene, renderer, .. } = Config::default().build().unwrap();
    let body = scene.add_body(bending()).unwrap();
    let surface = scene.add_surface(plate(roughness).body(body).excitation(excitation)).unwrap();
    let names = Names { surfaces: HashMap::from([("s".to_owned(), surface)]), ..Names::default() };
    let log = stroke(common::SIDE_M, speed_m_s, 1.0, 1.5);
    let take = offline::render(scene, renderer, &log, &names, &Options::default()).unwrap();
    take.audio.into_iter().next().unwrap()
}

/// Mean over 0.25 s, Hann-weighted, over the rms there, at the loudest place, dB.
fn mean_over_rms_db(x: &[f32]) -> f64 {
    let n = (0.25 * RATE_HZ) as usize;
    let window: Vec<f64> = (0..n).map(|i| 1.0 - (TAU * i as f64 / n as f64).cos()).collect();
    let sums = x.windows(n).step_by(n / 8).map(|part| {
        let weigh = |of: fn(f64) -> f64| {
            part.iter().zip(&window).map(|(x, w)| of(f64::from(*x)) * w).sum::<f64>() / n as f64
        };
        (weigh(|x| x), weigh(|x| x * x))
    });
    let (mean, power) = sums.fold((0.0, 0.0), |most, part| if part.1 > most.1 { part } else { most });
    20.0 * (mean.abs() / power.sqrt()).log10()
}

#[test]
fn a_rough_stroke_does_not_hold_its_body_bent() {
    for roughness in [0.5, 0.7, 0.95] {
        for speed_m_s in [0.05, 0.2] {
            for excitation in [Excitation::COLLISIONS, Excitation::BOTH] {
                let db = mean_over_rms_db(&heard(roughness, speed_m_s, excitation));
                println!("R {roughness} {speed_m_s} m/s {excitation:?}: {db:.1} dB");
                assert!(db <= -40.0, "R {roughness}, {speed_m_s} m/s: {db:.1} dB");
            }
        }
    }
}
