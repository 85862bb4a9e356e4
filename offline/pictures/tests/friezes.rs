//! Patterns that repeat along one direction: the translation, the seven groups, stripes, and
//! pictures that have none.

use crate::exact_brownian;
use crate::patterns;

use asperity_dsp::rng::Rng;
use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_pictures::symmetry::{Frieze, FriezeGroup, find_frieze, find_lattice};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// Where a group carries a point of a band, in periods.
type Image = fn(f64, f64) -> (f64, f64);

/// A band of ornaments, turned by `turn`, on a quiet ground: blobs and their images under the
/// group.
fn band(group: FriezeGroup, period: f64, turn: f64, noise: f64, seed: u64) -> Raster {
    let mut rng = Rng::new(seed);
    let blobs: Vec<[f64; 4]> = (0..3_usize)
        .map(|i| {
            let side = 0.09 + 0.1 * rng.uniform();
            [rng.uniform(), 0.12 + 0.3 * rng.uniform(), side, [1.0, 0.6, -0.8][i]]
        })
        .collect();
    let images: &[Image] = match group {
        FriezeGroup::P1 => &[|u, v| (u, v)],
        FriezeGroup::P11g => &[|u, v| (u, v), |u, v| (u + 0.5, -v)],
        FriezeGroup::P1m1 => &[|u, v| (u, v), |u, v| (-u, v)],
        FriezeGroup::P11m => &[|u, v| (u, v), |u, v| (u, -v)],
        FriezeGroup::P2 => &[|u, v| (u, v), |u, v| (-u, -v)],
        FriezeGroup::P2mg => &[|u, v| (u, v), |u, v| (0.5 - u, v), |u, v| (-u, -v), |u, v| (u + 0.5, -v)],
        FriezeGroup::P2mm => &[|u, v| (u, v), |u, v| (-u, v), |u, v| (u, -v), |u, v| (-u, -v)],
    };
    Raster::from_fn(256, 256, |x, y| {
        let (dx, dy) = (x as f64 - 127.3, y as f64 - 121.7);
        let (u, v) =
            ((dx * turn.cos() + dy * turn.sin()) / period, (dy * turn.cos() - dx * turn.sin()) / period);
        let mut height = noise * rng.normal();
        for image in images {
            for &[bu, bv, size, gain] in &blobs {
                let (cu, cv) = image(bu, 2.0 * bv);
                let du = u - cu - (u - cu).round();
                height += gain * (-(du * du + (v - cv) * (v - cv)) / (2.0 * 0.5 * size * size)).exp();
            }
        }
        height
    })
}

fn off(found: &Frieze, size: f64, turn: f64) -> f64 {
    let wanted = [size * turn.cos(), size * turn.sin()];
    (found.t_px[0] - wanted[0]).hypot(found.t_px[1] - wanted[1])
}

#[test]
fn all_seven_frieze_groups_are_named() {
    let (mut right, mut wrong) = (0, Vec::new());
    for group in FriezeGroup::ALL {
        for (seed, period, turn) in [(1, 24.0, 0.0), (2, 31.3, 0.3), (5, 26.0, -0.5), (4, 36.5, 0.0)] {
            let picture = band(group, period, turn, 0.0, seed);
            let found = find_frieze(&picture);
            if found.as_ref().is_some_and(|f| f.group == group && off(f, period, turn) < 0.3 && !f.stripes) {
                right += 1;
            } else {
                let found = found.map(|f| (f.t_px, f.confidence, f.stripes, f.group));
                wrong.push(format!("{} {seed}: {found:?}", group.name()));
            }
        }
    }
    assert!(right >= 26, "{right} of 28, wrong: {wrong:#?}");
}

#[test]
fn corrugated_sheets_have_their_profile_for_a_primitive() {
    for (period, turn, noise) in [(17.3, 0.0, 0.0), (24.0, 0.4, 0.3), (12.5, 1.2, 0.1), (30.0, -0.7, 0.0)] {
        for sawtooth in [false, true] {
            let mut rng = Rng::new(5);
            let sheet = Raster::from_fn(256, 240, |x, y| {
                let phase = (x as f64 * f64::cos(turn) + y as f64 * f64::sin(turn)) / period;
                let wave = if sawtooth { 1.7 * (phase - phase.floor()) } else { (TAU * phase).cos() };
                wave + noise * rng.normal()
            });
            assert!(find_lattice(&sheet).is_none());
            let found = find_frieze(&sheet).unwrap();
            let message = (found.t_px, found.confidence, found.group);
            assert!(
                found.stripes && off(&found, period, turn) < 0.1,
                "{period}, {turn}, {sawtooth}: {message:?}"
            );
            let group = if sawtooth { FriezeGroup::P11m } else { FriezeGroup::P2mm };
            assert_eq!(found.group, group, "{period}, {turn}: {message:?}");
            let (low, high) = found.primitive.range();
            assert!((high - low - if sawtooth { 1.6 } else { 2.0 }).abs() < 0.25, "{low} to {high}");
        }
    }
}

#[test]
fn pictures_without_a_pattern_have_no_frieze() {
    let mut controls: Vec<(String, Raster)> = Vec::new();
    for tenth in [1, 5, 9] {
        let generator = ExactBrownian::new(256, 1.0 - 0.1 * f64::from(tenth));
        for seed in 0..4 {
            let pair = exact_brownian::pair(&generator, seed);
            controls.extend(pair.into_iter().map(|surface| (format!("Brownian 2.{tenth} {seed}"), surface)));
        }
    }
    for seed in 0..6 {
        controls.push((format!("blobs {seed}"), patterns::blobs(256, 4.0 + 3.0 * seed as f64, seed)));
        controls.push((format!("grains {seed}"), patterns::grains(192, 6.0 + 2.0 * seed as f64, seed)));
        controls.push((format!("noise {seed}"), patterns::stripes(256, 1e9, 0.0, 1.0, seed)));
    }
    controls.push(("ramp".into(), Raster::from_fn(128, 128, |x, y| (x + 2 * y) as f64)));
    controls.push(("grey".into(), Raster::constant(128, 128, 0.5)));
    controls.push(("tiny".into(), Raster::from_fn(20, 20, |x, _| (x % 4) as f64)));
    for (name, control) in &controls {
        let found = find_frieze(control).map(|f| (f.t_px, f.confidence, f.stripes));
        assert!(found.is_none(), "{name}: {found:?}");
    }
}

#[test]
fn a_real_corrugated_sheet_shows_its_profile() {
    let sheet = "textures/CorrugatedSteel003_1K-PNG_Displacement.png";
    let Some(path) = asperity_evidence::corpus::corpus(sheet) else { return };
    let sheet = load_channel(path, Channel::Luma).unwrap().raster;
    let found = find_frieze(&sheet).unwrap();
    assert!(found.stripes, "{:?} {}", found.t_px, found.confidence);
    // A map that tiles has a whole number of waves.
    let waves = 1024.0 / found.t_px[0].hypot(found.t_px[1]);
    assert!((waves - waves.round()).abs() < 0.05, "{:?}: {waves} waves", found.t_px);
}
