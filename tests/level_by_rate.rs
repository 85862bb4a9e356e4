//! Rough strokes are equally loud and equally strong at every sample rate: means over seeds,
//! because no two seeds collide alike.

use crate::common;

use asperity::files::contact_log::Names;
use asperity::offline::{self, Options};
use asperity::{ActuatorSettings, Config, Excitation, ModalModel, Mode, Probe, Surface};
use common::{SIDE_M, grating, plate, rms, stroke};
use std::collections::HashMap;

const RATES_HZ: [f64; 7] = [16_000.0, 22_050.0, 32_000.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];
const SEEDS: u64 = 16;
/// The octave at 1 mm at R = 1, as shipped.
const MICRO_RELIEF_M: f64 = 22e-6;

/// Modes below 3.4 kHz, so that every rate has them all.
fn body() -> ModalModel {
    let mode = |frequency_hz, decay_per_s| Mode { frequency_hz, decay_per_s, amplitude: 0.3, phase_rad: 0.0 };
    ModalModel::new(vec![mode(430.0, 12.0), mode(1190.0, 18.0), mode(2110.0, 25.0), mode(3390.0, 35.0)], 0.01)
        .unwrap()
}

struct Case {
    name: &'static str,
    surface: fn() -> Surface,
    speed_m_s: f64,
    force_n: f64,
    contact_stiffness_n_m: f64,
    excitation: Excitation,
}

/// Mean levels of sound and feel over the seeds, dB, and micro-collisions a stroke.
fn levels(case: &Case, rate_hz: f64) -> (f64, f64, u64) {
    let (mut heard_db, mut felt_db, mut collisions) = (0.0, 0.0, 0);
    for seed in 1..=SEEDS {
        let probe = Probe { contact_stiffness_n_m: case.contact_stiffness_n_m, ..Probe::default() };
        let actuators = vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }];
        let config = Config { sample_rate_hz: rate_hz, seed, probe, actuators, ..Config::default() };
        let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
        let body = scene.add_body(body()).unwrap();
        let surface = scene.add_surface((case.surface)().body(body).excitation(case.excitation)).unwrap();
        let names = Names { surfaces: HashMap::from([("s".to_owned(), surface)]), ..Names::default() };
        let log = stroke(SIDE_M, case.speed_m_s, case.force_n, 0.4);
        let take = offline::render(scene, renderer, &log, &names, &Options::default()).unwrap();
        let db = |x: &[f32]| 20.0 * rms(x).log10() / SEEDS as f64;
        heard_db += db(&take.audio[0]);
        felt_db += db(&take.haptic[0]);
        collisions += take.stats.micro_collisions / SEEDS;
    }
    (heard_db, felt_db, collisions)
}

#[test]
fn a_rough_stroke_is_equally_loud_at_every_rate() {
    let plain = Case {
        name: "light stroke over micro-relief, collisions",
        surface: || plate(0.5),
        speed_m_s: 0.2,
        force_n: 0.05,
        contact_stiffness_n_m: 5e4,
        excitation: Excitation::COLLISIONS,
    };
    let cases = [
        Case { name: "the same, collisions and force", excitation: Excitation::BOTH, ..plain },
        Case {
            name: "stiff contact on a matte plate",
            surface: || plate(0.9).micro_relief_m(2e-6),
            speed_m_s: 0.1,
            force_n: 0.5,
            contact_stiffness_n_m: 2e5,
            ..plain
        },
        Case {
            name: "stiff contact on rough waves",
            surface: || grating(SIDE_M / 20.0, 5e-4).micro_relief_m(1.1e-5),
            speed_m_s: 0.12,
            force_n: 0.5,
            contact_stiffness_n_m: 2e5,
            ..plain
        },
        Case {
            name: "shipped defaults on a matte plate",
            surface: || plate(0.9),
            speed_m_s: 0.1,
            force_n: 0.6,
            contact_stiffness_n_m: Probe::default().contact_stiffness_n_m,
            excitation: Excitation::BOTH,
        },
        Case {
            name: "shipped defaults on waves, R 0.5",
            surface: || grating(SIDE_M / 20.0, 5e-4).micro_relief_m(MICRO_RELIEF_M),
            speed_m_s: 0.1,
            force_n: 0.6,
            contact_stiffness_n_m: Probe::default().contact_stiffness_n_m,
            excitation: Excitation::BOTH,
        },
        plain,
    ];
    for case in &cases {
        let (heard, felt, _) = levels(case, 44_100.0);
        assert!(heard.is_finite() && felt.is_finite(), "{}: silence has no level", case.name);
        let mut worst: f64 = 0.0;
        for rate_hz in RATES_HZ {
            let (now_heard, now_felt, collisions) = levels(case, rate_hz);
            let (heard_db, felt_db) = (now_heard - heard, now_felt - felt);
            println!(
                "{}, {rate_hz} Hz: heard {heard_db:+.2} dB ({now_heard:.1}), felt {felt_db:+.2} dB, {collisions} collisions",
                case.name
            );
            worst = worst.max(heard_db.abs()).max(felt_db.abs());
        }
        assert!(worst <= 0.5, "{}: {worst:.2} dB", case.name);
    }
}
