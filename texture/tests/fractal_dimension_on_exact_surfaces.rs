//! The dimension estimators against exact Brownian surfaces of known dimension.
#![cfg(feature = "offline")]

#[path = "support/exact_brownian.rs"]
mod exact_brownian;

use asperity_measure::exact_brownian::ExactBrownian;
use asperity_texture::fractal_dimension::{fractal_dimension, local_map, probability_dimension, transects};
use asperity_texture::raster::Raster;
use exact_brownian::{pair, quantise};

const SIZE: usize = 256;

/// Surfaces of one dimension, as many as asked for.
fn surfaces(dimension: f64, count: u64) -> Vec<Raster> {
    let generator = ExactBrownian::new(SIZE, 3.0 - dimension);
    let seeds = 0..count.div_ceil(2);
    seeds.flat_map(|seed| pair(&generator, 1000 * (10.0 * dimension) as u64 + seed)).collect()
}

#[test]
fn the_generator_has_the_variogram_it_promises() {
    for hurst in [0.2, 0.5, 0.9] {
        let generator = ExactBrownian::new(64, hurst);
        for (dx, dy) in [(1, 0), (0, 3), (12, 9), (40, 0)] {
            let (mut sum, mut n) = (0.0, 0.0);
            for seed in 0..150 {
                for surface in pair(&generator, seed) {
                    for (x, y) in [(0, 0), (10, 50), (20, 20)] {
                        let d = surface.at(x + dx, y + dy) - surface.at(x, y);
                        sum += d * d;
                        n += 1.0;
                    }
                }
            }
            let texel = 1.0 / (63.0 * 2.0_f64.sqrt());
            let promised = (texel * (dx as f64).hypot(dy as f64)).powf(2.0 * hurst);
            let ratio = sum / n / promised;
            assert!((ratio - 1.0).abs() < 0.25, "H {hurst}, lag ({dx}, {dy}): {ratio}");
        }
    }
}

#[test]
fn the_recommended_dimension_is_within_a_hundredth_on_8_and_16_bit_maps() {
    let mut errors = [0.0; 2];
    for tenth in 1..=9 {
        let dimension = 2.0 + 0.1 * f64::from(tenth);
        for surface in surfaces(dimension, 2) {
            for (error, levels) in errors.iter_mut().zip([256, 65_536]) {
                let found = transects(&quantise(&surface, levels)).unwrap();
                *error += (found.dimension - dimension).abs() / 18.0;
            }
        }
    }
    assert!(errors.iter().all(|e| *e <= 0.01), "mean absolute errors at 8 and 16 bits: {errors:?}");
}

#[test]
fn the_probability_dimension_rises_with_the_true_one() {
    let (mut before, mut errors) = ([0.0; 2], [0.0; 2]);
    for tenth in 1..=9 {
        let dimension = 2.0 + 0.1 * f64::from(tenth);
        let maps = surfaces(dimension, 2);
        for (k, levels) in [256, 65_536].into_iter().enumerate() {
            let found: f64 =
                maps.iter().map(|s| probability_dimension(&quantise(s, levels)).unwrap() / 2.0).sum();
            assert!(found > before[k], "D {dimension}, {levels} levels: {found} after {}", before[k]);
            before[k] = found;
            errors[k] += (found - dimension).abs() / 9.0;
        }
    }
    assert!(errors.iter().all(|e| *e <= 0.05), "mean absolute errors at 8 and 16 bits: {errors:?}");
}

#[test]
fn grid_cubes_saturate_on_rough_surfaces_and_the_recommended_dimension_does_not() {
    let found = [2.2, 2.8].map(|d| fractal_dimension(&quantise(&surfaces(d, 1)[0], 256)).unwrap().dimension);
    let rise =
        |of: fn(&asperity_texture::fractal_dimension::FractalDimension) -> f64| of(&found[1]) - of(&found[0]);
    // The document's table rises by 0.22 over these 0.6.
    for saturated in [rise(|d| d.box_counting), rise(|d| d.information), rise(|d| d.correlation)] {
        assert!(saturated.abs() < 0.22, "{found:?}");
    }
    assert!((rise(|d| d.recommended) - 0.6).abs() < 0.03, "{found:?}");
}

#[test]
fn brownian_surfaces_meet_every_input_condition() {
    for tenth in [1, 5, 9] {
        for surface in surfaces(2.0 + 0.1 * f64::from(tenth), 2) {
            let report = fractal_dimension(&quantise(&surface, 256)).unwrap();
            assert!(report.conditions.is_empty(), "D 2.{tenth}: {:?}", report.conditions);
        }
    }
}

#[test]
fn a_local_map_follows_the_dimension() {
    for dimension in [2.3, 2.6] {
        let surface = &surfaces(dimension, 1)[0];
        let map = local_map(&quantise(surface, 65_536), 64, 64).unwrap();
        let squares: f64 = map.dimension.values.iter().map(|d| (d - dimension) * (d - dimension)).sum();
        let rms = (squares / map.dimension.values.len() as f64).sqrt();
        assert!(rms < 0.04, "D {dimension}: rms {rms}");
    }
}
