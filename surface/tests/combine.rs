//! Combinations of sources: what they add up to, and that they make neither clicks nor seams.

use crate::common;

use asperity_surface::combine::{BandSplit, Crossfade, Mask, Scale, Source, Sum};
use asperity_surface::combine::{BandWeights, CrossfadeTo, ScaleTo};
use asperity_surface::height_field::{HeightField, PathBlock, SurfaceBlock};
use asperity_surface::lattice::Lattice;
use asperity_surface::raster::Raster;
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use common::{Stroke, bits, rms};

const RATE: f64 = 44_100.0;

fn solid(material: SolidMaterial) -> Source {
    Box::new(SolidNoise::new(material.parameters(), 11).unwrap())
}

fn flat(height_m: f64) -> Source {
    let cell = Raster::constant(4, 4, height_m);
    Box::new(Lattice::new(&cell, [0.01, 0.0], [0.0, 0.01]).unwrap())
}

fn stroke() -> Stroke {
    Stroke::new([0.003, 0.004], [0.08, 0.02], RATE, 9000)
}

fn heights(mut source: impl HeightField) -> Vec<f64> {
    stroke().heights(&mut source, &[64])
}

#[test]
fn a_sum_is_its_parts_in_height_slope_and_force() {
    let (a, b) =
        (heights_and_slopes(solid(SolidMaterial::Wood)), heights_and_slopes(solid(SolidMaterial::Sand)));
    let sum =
        heights_and_slopes(Box::new(Sum::new(vec![solid(SolidMaterial::Wood), solid(SolidMaterial::Sand)])));
    for ((a, b), s) in a.iter().zip(&b).zip(&sum) {
        for k in 0..3 {
            assert_eq!(a[k] + b[k], s[k]);
        }
    }
    let path = PathBlock {
        position_m: &[[0.01, 0.02]],
        velocity_m_s: &[[0.1, 0.0]],
        footprint_m: &[0.0],
        normal_force_n: &[1.0],
        first_sample: 0,
        contact: 0,
        slopes: true,
        ..PathBlock::default()
    };
    let force = |mut s: Source| {
        let mut out = SurfaceBlock::default();
        s.sample(&path, &mut out);
        let answer = out.answer.at(0);
        // The law stands in the place of the slope.
        assert_eq!(answer.push_per_n, out.gradient[0]);
        answer.force_n
    };
    let [a, b] = [SolidMaterial::Wood, SolidMaterial::Pebbles].map(|m| force(solid(m)));
    let both = force(Box::new(Sum::new(vec![solid(SolidMaterial::Wood), solid(SolidMaterial::Pebbles)])));
    assert_eq!(both, [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
    assert_eq!(heights(Sum::new(Vec::new())), vec![0.0; 9000]);
}

fn heights_and_slopes(mut source: Source) -> Vec<[f64; 3]> {
    let mut rows = Vec::new();
    stroke().run(
        &mut *source,
        &[64],
        |_, _| (),
        |_, out, i| {
            rows.push([out.height_m[i], out.gradient[i][0], out.gradient[i][1]]);
        },
    );
    rows
}

#[test]
fn a_crossfade_between_sources_has_no_step_above_minus_60_db() {
    let fade = || {
        let mut fade = Crossfade::new(flat(0.0), flat(1e-3));
        assert!(fade.set(&CrossfadeTo(1.0), 700));
        assert!(!fade.set(&CrossfadeTo(2.0), 700));
        fade
    };
    let line = heights(fade());
    assert!(line[700].abs() < 1e-18 && (line[8999] - 1e-3).abs() < 1e-15);
    let step = line.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!(20.0 * (step / 1e-3).log10() < -60.0, "{step}");

    // Before and after it is exactly one of the two; any split into blocks gives the same bits.
    let made = || {
        let mut fade = Crossfade::new(solid(SolidMaterial::Wood), solid(SolidMaterial::Gravel));
        assert!(fade.set(&CrossfadeTo(1.0), 701));
        fade
    };
    let line = heights(made());
    assert_eq!(line[..701], stroke().heights(&mut *solid(SolidMaterial::Wood), &[64])[..701]);
    assert_eq!(line[8000..], stroke().heights(&mut *solid(SolidMaterial::Gravel), &[64])[8000..]);
    assert_eq!(bits(&line), bits(&stroke().heights(&mut made(), &[1, 31, 5])));
}

#[test]
fn a_scale_multiplies_and_changes_without_a_step() {
    let mut scale = Scale::new(flat(1e-3), 2.0).unwrap();
    assert!(scale.set(&ScaleTo(0.5), 100));
    assert!(!scale.set(&ScaleTo(f64::NAN), 100));
    let line = heights(scale);
    assert!((line[0] - 2e-3).abs() < 1e-15 && (line[8999] - 5e-4).abs() < 1e-15);
    let step = line.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!(20.0 * (step / 2e-3).log10() < -60.0);
    // Other messages reach the source inside.
    let mut scale = Scale::new(solid(SolidMaterial::Sand), 1.0).unwrap();
    assert!(scale.set(&SolidMaterial::Wood.parameters(), 0));
    assert!(!scale.set(&CrossfadeTo(0.5), 0));
}

#[test]
fn a_mask_chooses_by_place_with_the_slope_of_its_result() {
    let stripes = Raster::from_fn(16, 1, |x, _| if x < 8 { 0.0 } else { 1.0 });
    let mask = || -> Source { Box::new(Lattice::new(&stripes, [0.02, 0.0], [0.0, 0.02]).unwrap()) };
    let made = || Mask::new(mask(), flat(1e-3), solid(SolidMaterial::RoughGlass));
    let line = heights(made());
    let x = |n: usize| (stroke().position_m(n)[0] / 0.02).fract();
    for (n, h) in line.iter().enumerate() {
        if (0.6..0.9).contains(&x(n)) && x(n) > 0.65 && x(n) < 0.85 {
            assert!((h - 1e-3).abs() < 6e-5, "{h} at {}", x(n));
        }
    }
    assert!(line.iter().any(|&h| h < 1e-4));
    // dh/dt along the stroke agrees with slope · velocity.
    let rows = heights_and_slopes(Box::new(made()));
    let v = stroke().velocity_m_s;
    let mut kinks = 0;
    for n in 1..rows.len() - 1 {
        let measured = (rows[n + 1][0] - rows[n - 1][0]) * 0.5 * RATE;
        let wanted = rows[n][1] * v[0] + rows[n][2] * v[1];
        kinks += i32::from((measured - wanted).abs() > 2e-3 + 0.01 * wanted.abs());
    }
    // Only where the mask is clipped at 0 or 1 does the slope jump between two samples.
    assert!(kinks <= 12, "{kinks}");
}

#[test]
fn a_band_split_of_one_source_with_itself_gives_it_back() {
    let same = || solid(SolidMaterial::Gravel);
    let split = BandSplit::new(same(), same(), 3e-3).unwrap();
    let whole = heights_and_slopes(same());
    for (a, b) in heights_and_slopes(Box::new(split)).iter().zip(&whole) {
        assert!((a[0] - b[0]).abs() < 1e-15 && (a[1] - b[1]).abs() < 1e-12);
    }
}

#[test]
fn a_band_split_takes_long_waves_from_one_source_short_from_another() {
    let wave = |texels: usize, metres: f64| -> Source {
        let cell = Raster::from_fn(texels, 1, |x, _| {
            1e-4 * (std::f64::consts::TAU * (x as f64 + 0.5) / texels as f64).cos()
        });
        Box::new(Lattice::new(&cell, [metres, 0.0], [0.0, 0.01]).unwrap())
    };
    // 40 mm waves and 1 mm waves, split at 5 mm: swapped, hardly anything is left.
    let right = heights(BandSplit::new(wave(64, 0.04), wave(16, 0.001), 0.005).unwrap());
    let wrong = heights(BandSplit::new(wave(16, 0.001), wave(64, 0.04), 0.005).unwrap());
    assert!(rms(&right) > 8e-5 && rms(&wrong) < 1.5e-5, "{} {}", rms(&right), rms(&wrong));
    let mut split = BandSplit::new(flat(1e-3), flat(0.0), 0.005).unwrap();
    assert!(split.set(&BandWeights([0.25, 1.0]), 0));
    let line = heights(split);
    assert!((line[8999] - 2.5e-4).abs() < 1e-15);
}
