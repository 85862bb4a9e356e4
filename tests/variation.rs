//! Variation: repeated blows that are not the same sound again, and the same blows every time.

use crate::closed_forms;
use crate::common;

use asperity::files::contact_log::Names;
use asperity::offline::{self, Options};
use asperity::{
    Body, BodyId, Config, ContactEvent, Diffuse, DiffuseBand, DiffusePart, Engine, Impact, Material,
    ModalModel, Stock,
};
use closed_forms::{FREE_BAR, modes_file};
use common::rms;

/// Frames between two blows: what rang before is gone.
const APART: usize = 44_100;

/// A bell of which four hits were recorded: poles in common, amplitudes of their own.
fn family() -> ModalModel {
    let mut model = Stock::Bar.modes(&Material::WOOD, 0.3).unwrap();
    model.modes.truncate(12);
    let take = |take: usize| {
        let gain = move |i: usize| 1.0 + 0.4 * ((take * 7 + i * 3) as f64).sin();
        model.modes.iter().enumerate().map(|(i, mode)| gain(i) * mode.amplitude).collect()
    };
    let takes = (1..4).map(take).collect();
    ModalModel { takes: true, ..model.with_positions(takes).unwrap() }
}

fn steel(body: BodyId, position: usize) -> ContactEvent {
    let blow = Impact::on(body).striker(Material::STEEL, 0.005, 0.005).at_speed(0.5);
    ContactEvent::Impact(Impact { position, ..blow })
}

/// Equal blows a second apart, each as it sounds.
fn blows(body: &Body, seed: u64, positions: &[usize], block: usize) -> Vec<Vec<f32>> {
    let mut engine = Config { seed, culling: None, ..Config::default() }.build().unwrap();
    let id = engine.scene.add_body(body.clone()).unwrap();
    let mut sounds = Vec::new();
    for (n, position) in positions.iter().enumerate() {
        engine.scene.report(n as f64, steel(id, *position)).unwrap();
        let (mut haptic, mut audio) = (vec![0.0; APART], vec![0.0; APART]);
        for (haptic, audio) in haptic.chunks_mut(block).zip(audio.chunks_mut(block)) {
            engine.renderer.render(&mut [haptic], &mut [audio]);
        }
        sounds.push(audio);
    }
    sounds
}

/// Difference of two sounds over the first, dB.
fn apart_db(a: &[f32], b: &[f32]) -> f64 {
    let difference: Vec<f32> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    20.0 * (rms(&difference) / rms(a)).max(1e-12).log10()
}

fn varied(model: ModalModel, variation: f64) -> Body {
    Body::new(model).material(Material::WOOD).variation(variation)
}

#[test]
fn blows_on_a_family_are_its_takes_never_repeated() {
    let takes = blows(&varied(family(), 0.0), 1, &[0, 1, 2, 3], 256);
    let heard = blows(&varied(family(), 1.0), 1, &[0; 12], 256);
    let take_of = |sound: &Vec<f32>| {
        let same = |take: &Vec<f32>| apart_db(take, sound) < -90.0;
        takes.iter().position(same).expect("a blow that is no take")
    };
    let played: Vec<usize> = heard.iter().map(take_of).collect();
    assert!(played.windows(2).all(|pair| pair[0] != pair[1]), "{played:?}");
    assert!((0..4).all(|take| played.contains(&take)), "{played:?}");
}

#[test]
fn half_of_the_variation_lies_half_way_between_two_takes() {
    let takes = blows(&varied(family(), 0.0), 1, &[0, 1, 2, 3], 256);
    for sound in blows(&varied(family(), 0.5), 1, &[2; 6], 256) {
        let halfway = |take: &Vec<f32>| -> Vec<f32> {
            take.iter().zip(&takes[2]).map(|(take, asked)| 0.5 * (take + asked)).collect()
        };
        assert!(takes.iter().any(|take| apart_db(&sound, &halfway(take)) < -90.0));
    }
}

#[test]
fn without_variation_equal_blows_are_equal_to_the_bit() {
    let plain = blows(&Body::new(family()).material(Material::WOOD), 1, &[0; 3], 256);
    assert!(plain == blows(&varied(family(), 0.0), 1, &[0; 3], 256));
    assert!(plain.windows(2).all(|pair| apart_db(&pair[0], &pair[1]) < -90.0));
}

#[test]
fn varied_blows_are_those_of_the_seed_in_any_blocks() {
    let body = varied(Stock::Bar.modes(&Material::WOOD, 0.3).unwrap(), 1.0);
    let first = blows(&body, 7, &[0; 4], 256);
    for block in [1, 63, 512] {
        assert!(first == blows(&body, 7, &[0; 4], block), "blocks of {block}");
    }
    let other = blows(&body, 8, &[0; 4], 256);
    assert!(first.iter().zip(&other).all(|(a, b)| a != b));
}

#[test]
fn every_kind_of_body_varies_no_more_than_a_player() {
    let shaped = modes_file(&closed_forms::bar(), |m| 220.0 * (FREE_BAR[m] / FREE_BAR[0]).powi(2), 14.0);
    let band = DiffuseBand {
        centre_hz: 900.0,
        width_hz: 300.0,
        parts: vec![DiffusePart { energy: 1e-3, decay_per_s: 60.0 }],
    };
    let diffuse = Some(Diffuse { source: "made".to_owned(), bands: vec![band] });
    let bodies = [
        ("a bar that is struck in one place", Stock::Bar.modes(&Material::WOOD, 0.3).unwrap()),
        ("a bar with shapes", ModalModel::parse(&shaped).unwrap()),
        ("bands of noise", ModalModel { impulse_n_s: 0.01, diffuse, ..ModalModel::silent() }),
    ];
    for (name, model) in bodies {
        let sounds = blows(&varied(model, 1.0), 3, &[0; 10], 256);
        let mut apart: Vec<f64> = Vec::new();
        for pair in sounds.windows(2) {
            let louder = 20.0 * (rms(&pair[0]) / rms(&pair[1])).log10();
            assert!(louder.abs() < 6.0, "{name}: {louder} dB");
            apart.push(apart_db(&pair[0], &pair[1]));
        }
        apart.sort_by(f64::total_cmp);
        println!("{name}: {:.1} dB apart at least, {:.1} in the median", apart[0], apart[4]);
        assert!(apart[0] > -60.0 && apart[4] > -25.0, "{name}: {apart:?}");
    }
}

#[test]
fn a_recorded_game_repeats_its_varied_blows() {
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    scene.start_recording(&Names::default());
    let id = scene.add_body(varied(family(), 0.7)).unwrap();
    let mut heard = Vec::new();
    for n in 0..6 {
        scene.report(0.25 * f64::from(n), steel(id, 0)).unwrap();
        let (mut haptic, mut audio) = (vec![0.0; 11_025], vec![0.0; 11_025]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        heard.extend(audio);
    }
    let (log, late) = (scene.stop_recording(), renderer.latency_samples());
    let Engine { scene, renderer, .. } = Config::default().build().unwrap();
    let again = offline::render(scene, renderer, &log, &Names::default(), &Options::default()).unwrap();
    // The replay has no look-ahead in front.
    assert!(again.audio[0].starts_with(&heard[late..]), "{} dB", apart_db(&heard[late..], &again.audio[0]));
}

#[test]
fn a_variation_beyond_one_is_refused_by_its_name() {
    let mut engine = Config::default().build().unwrap();
    for amount in [-0.1, 1.1, f64::NAN] {
        let error = engine.scene.add_body(varied(family(), amount)).unwrap_err().to_string();
        assert!(error.contains("variation") && error.contains("0 to 1"), "{error}");
    }
}
