//! Bands of noise: impacts and strokes play them, they scale as modes do, and soft bodies consist
//! of them.

use crate::common;

use asperity::files::contact_log::{ContactLog, Names};
use asperity::offline::{self, Options};
use asperity::{Body, Config, Diffuse, DiffuseBand, DiffusePart, Engine, Material, ModalModel, Stock};
use common::{plate, rms, si_config, stroke, tone_amplitude};
use std::collections::HashMap;

const RATE_HZ: f64 = 44_100.0;

/// A body of three bands and no mode.
fn three_bands() -> ModalModel {
    let band = |centre_hz: f64| DiffuseBand {
        centre_hz,
        width_hz: 0.2 * centre_hz,
        parts: vec![
            DiffusePart { energy: 1e-3, decay_per_s: 60.0 },
            DiffusePart { energy: 1e-4, decay_per_s: 20.0 },
        ],
    };
    let bands = [500.0, 1500.0, 4500.0].map(band).to_vec();
    let diffuse = Some(Diffuse { source: "made".to_owned(), bands });
    ModalModel { impulse_n_s: 0.01, diffuse, ..ModalModel::silent() }
}

/// Sound of impacts of steel, (s, m/s), in blocks.
fn struck(model: &ModalModel, seed: u64, impacts: &[(f64, f64)], block_frames: usize) -> Vec<f32> {
    let config = Config { seed, culling: None, ..Config::default() };
    let Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(Body::new(model.clone()).material(Material::STEEL)).unwrap();
    let lines = impacts.iter().map(|(t, speed)| {
        format!(
            "{{\"t\":{t},\"event\":\"impact\",\"body\":\"b\",\"speed_m_s\":{speed},\"mass_kg\":0.01,\"radius_m\":0.005,\"striker\":\"steel\"}}\n"
        )
    });
    let log = ContactLog::parse(&lines.collect::<String>(), "made").unwrap();
    let names = Names { bodies: HashMap::from([("b".to_owned(), body)]), ..Names::default() };
    let options = Options { block_frames, tail_s: 0.5, clock_s: None };
    offline::render(scene, renderer, &log, &names, &options).unwrap().audio.swap_remove(0)
}

fn db(a: &[f32], b: &[f32]) -> f64 {
    20.0 * (rms(a) / rms(b)).log10()
}

#[test]
fn twice_the_momentum_is_six_decibels_more() {
    let model = three_bands();
    let one = struck(&model, 1, &[(0.01, 0.5)], 256);
    assert!(rms(&one) > 0.0);
    let two = struck(&model, 1, &[(0.01, 1.0)], 256);
    assert!((db(&two, &one) - 6.02).abs() < 0.2, "{}", db(&two, &one));
    let again = struck(&model, 1, &[(0.25, 0.5), (2.25, 0.5)], 256);
    let (first, second) = (11_025, 11_025 + 88_200);
    assert!(again[first..first + 20_000] == again[second..second + 20_000]);
    assert!(one != struck(&model, 2, &[(0.01, 0.5)], 256));
}

#[test]
fn any_blocks_give_the_same_bits_for_strikes_and_for_strokes() {
    let impacts = [(0.01, 0.5), (0.0123, 0.2), (0.3, 1.0)];
    let whole = struck(&three_bands(), 1, &impacts, 256);
    assert!(whole == struck(&three_bands(), 1, &impacts, 37));
    let stroked = |block_frames: usize| {
        let Engine { mut scene, renderer, .. } = si_config().build().unwrap();
        let body = scene.add_body(three_bands()).unwrap();
        let surface = scene.add_surface(plate(0.5).body(body)).unwrap();
        let names = Names { surfaces: HashMap::from([("s".to_owned(), surface)]), ..Names::default() };
        let log = stroke(common::SIDE_M, 0.1, 0.6, 0.5);
        let options = Options { block_frames, tail_s: 0.2, clock_s: None };
        offline::render(scene, renderer, &log, &names, &options).unwrap().audio.swap_remove(0)
    };
    let sound = stroked(256);
    assert!(rms(&sound) > 0.0 && sound == stroked(61));
}

#[test]
fn half_the_size_is_an_octave_up() {
    let centres = |model: &ModalModel| -> Vec<f64> {
        model.diffuse.as_ref().unwrap().bands.iter().map(|band| band.centre_hz).collect()
    };
    let half = three_bands().scaled(0.5, &Material::WOOD).unwrap();
    assert_eq!(centres(&half), [1000.0, 3000.0, 9000.0]);
    let decay_per_s = |model: &ModalModel| model.diffuse.as_ref().unwrap().bands[0].parts[0].decay_per_s;
    let damping = Material::WOOD.damping();
    let ratio = 60.0 * damping.decay_per_s(1000.0) / damping.decay_per_s(500.0);
    assert!((decay_per_s(&half) / ratio - 1.0).abs() < 1e-12);
    // In what is heard, too: what was about a centre is about twice as much.
    let sounds = |model: &ModalModel| -> Vec<Vec<f32>> {
        (0..8).map(|seed| struck(model, seed, &[(0.0, 1.0)], 256)).collect()
    };
    let power = |sounds: &[Vec<f32>], centre_hz: f64| -> f64 {
        let tone = |x: &[f32], k: i32| tone_amplitude(x, centre_hz * (1.0 + 0.02 * f64::from(k)), RATE_HZ);
        sounds.iter().flat_map(|x| (-5..=5).map(|k| tone(&x[..8820], k).powi(2))).sum()
    };
    let (one, half) = (sounds(&three_bands()), sounds(&half));
    for centre_hz in [500.0, 1500.0, 4500.0] {
        let [before, after] = [&one, &half].map(|x| power(x, 2.0 * centre_hz) / power(x, centre_hz));
        assert!(before < 0.1 && after > 10.0, "{centre_hz} Hz: {before} {after}");
    }
}

#[test]
fn version_3_survives_the_round_trip_and_older_ones_have_no_bands() {
    let text = three_bands().to_json();
    assert_eq!(ModalModel::parse(&text).unwrap(), three_bands());
    let old = ModalModel::parse(&text.replace("\"version\":3", "\"version\":2")).unwrap_err().to_string();
    assert!(old.contains("diffuse") && old.contains("version 3"), "{old}");
    let bad = ModalModel::parse(&text.replace("\"width_hz\":300", "\"width_hz\":-3")).unwrap_err();
    assert!(bad.to_string().contains("diffuse.bands[1].width_hz"), "{bad}");
}

#[test]
fn a_knock_on_a_soft_body_neither_rings_nor_has_a_line() {
    for (stock, material) in [
        (Stock::Sheet, Material::CLOTH),
        (Stock::Sheet, Material::LEATHER),
        (Stock::Sheet, Material::CARDBOARD),
        (Stock::Cushion, Material::FOAM),
        (Stock::Cushion, Material::SOIL),
    ] {
        let model = stock.modes(&material, stock.usual().1).unwrap();
        let bands = &model.diffuse.as_ref().unwrap().bands;
        assert!(model.modes.is_empty() && bands.len() >= 30);
        for band in bands.iter().filter(|band| band.centre_hz > 200.0) {
            assert!(6.91 / band.parts[0].decay_per_s <= 0.15, "{stock:?} {} Hz", band.centre_hz);
        }
        let sounds: Vec<_> = (0..16).map(|seed| struck(&model, 100 * seed, &[(0.0, 1.0)], 256)).collect();
        for centre_hz in [250.0, 600.0, 1400.0, 3000.0, 6000.0] {
            let half_erb_hz = 0.5 * 24.7 * (1.0 + 4.37e-3 * centre_hz);
            let power = |k: i32| {
                let hz = centre_hz + half_erb_hz * (f64::from(k) / 8.0);
                sounds.iter().map(|x| tone_amplitude(&x[..8820], hz, RATE_HZ).powi(2)).sum::<f64>()
            };
            let powers: Vec<f64> = (-8..=8).map(power).collect();
            let mean = powers.iter().sum::<f64>() / powers.len() as f64;
            let most = powers.iter().fold(0.0, |most: f64, x| most.max(*x));
            assert!(most < 4.0 * mean, "{stock:?} of {:?}, {centre_hz} Hz: {}", material.name(), most / mean);
        }
    }
}
