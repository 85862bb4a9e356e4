//! The shipped defaults forget: a path moved by 1e-12 m is felt and heard the same. Where a contact
//! bounces for good it would be chaotic instead, and only levels could be compared.

use crate::common;

use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::offline::{Options, Render};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::surface::solid_noise::SolidNoise;
use asperity::{Config, PROBE_PRESETS, Surface, probe_by_name};
use common::strokes::{power, third_octaves_db};
use common::{SIDE_M, grating, plate, render, rms, stroke};

/// The same stroke 1e-12 m further along u.
fn moved(log: &ContactLog, width_m: f64) -> ContactLog {
    let mut log = log.clone();
    for line in &mut log.lines {
        if let LogEvent::Begin { sample, .. } | LogEvent::Move { sample, .. } = &mut line.event {
            sample.uv[0] += 1e-12 / width_m;
        }
    }
    log
}

/// The same stroke, and that stroke moved.
fn pair(probe: &str, make: &dyn Fn() -> Surface, speed_m_s: f64, force_n: f64) -> [Render; 2] {
    let log = stroke(SIDE_M, speed_m_s, force_n, 1.0);
    let config = || Config { probe: probe_by_name(probe).unwrap(), ..Config::default() };
    [log.clone(), moved(&log, SIDE_M)].map(|log| render(config(), make(), &log, &Options::default()))
}

/// Level of the difference, dB: felt and heard.
fn difference_db([one, other]: [&Render; 2]) -> [f64; 2] {
    let db = |a: &[f32], b: &[f32]| {
        let apart: Vec<f32> = a.iter().zip(b).map(|(a, b)| a - b).collect();
        20.0 * (rms(&apart) / rms(a)).max(1e-12).log10()
    };
    [db(&one.haptic[0], &other.haptic[0]), db(&one.audio[0], &other.audio[0])]
}

fn solid(material: SolidMaterial) -> Surface {
    Surface::new(SolidNoise::new(material.parameters(), 5).unwrap(), SIDE_M, SIDE_M).unwrap()
}

#[test]
fn a_path_moved_by_a_picometre_renders_the_same_by_default() {
    let polished = || plate(0.1);
    let matte = || plate(0.9);
    let coarse = || grating(7e-3, 2e-4);
    let fine = || grating(2e-3, 1e-5);
    let granite = || solid(SolidMaterial::Granite);
    let wood = || solid(SolidMaterial::Wood);
    let surfaces: [(&str, &dyn Fn() -> Surface); 6] = [
        ("polished", &polished),
        ("matte", &matte),
        ("grating of 7 mm", &coarse),
        ("grating of 2 mm", &fine),
        ("granite", &granite),
        ("wood", &wood),
    ];
    for (name, make) in surfaces {
        for (speed_m_s, force_n) in [(0.05, 0.5), (0.1, 0.6), (0.2, 1.0)] {
            let [one, other] = pair("fingertip", make, speed_m_s, force_n);
            let [felt_db, heard_db] = difference_db([&one, &other]);
            println!("{name}, {speed_m_s} m/s, {force_n} N: felt {felt_db:.0} dB, heard {heard_db:.0} dB");
            assert!(felt_db.max(heard_db) < -80.0, "{name}: felt {felt_db} dB, heard {heard_db} dB");
        }
    }
}

/// Probes that leap from asperity to asperity, and so never converge: a leg of 5 kg on a newton.
const LEAP: [&str; 1] = ["sole"];

#[test]
fn stock_probes_recover_on_ceramic_and_keep_their_third_octaves() {
    for (probe, _) in PROBE_PRESETS {
        for (roughness, force_n) in [(0.2, 1.0), (0.5, 1.0), (0.9, 1.0), (0.5, 20.0)] {
            let [one, other] = pair(probe, &|| plate(roughness), 0.1, force_n);
            let [felt_db, heard_db] = difference_db([&one, &other]);
            let [felt, heard] =
                [[&one.haptic[0], &other.haptic[0]], [&one.audio[0], &other.audio[0]]].map(octaves_apart_db);
            println!(
                "{probe}, R {roughness}, {force_n} N: felt {felt_db:.0} dB, heard {heard_db:.0} dB; third octaves {felt:.2} and {heard:.2} dB"
            );
            let forgets = felt_db.max(heard_db) < -80.0;
            assert!(
                forgets || LEAP.contains(&probe),
                "{probe}, R {roughness}: felt {felt_db}, heard {heard_db} dB"
            );
            assert!(
                felt.max(heard) < 1.0,
                "{probe}, R {roughness}: third octaves {felt} and {heard} dB apart"
            );
        }
    }
}

/// Root mean square of the difference of third octaves from 25 Hz to 10 kHz, dB.
fn octaves_apart_db(signals: [&Vec<f32>; 2]) -> f64 {
    let [a, b] = signals.map(|x| third_octaves_db(&power(x, 44_100.0), 25.0, 27));
    (a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}
