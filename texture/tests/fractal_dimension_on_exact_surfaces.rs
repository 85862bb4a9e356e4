//! The dimension estimators against exact Brownian surfaces of known dimension.
#![cfg(feature = "offline")]

#[path = "support/exact_brownian.rs"]
mod exact_brownian;

use asperity_texture::fractal_dimension::{fractal_dimension, local_map, probability_dimension, transects};
use asperity_texture::raster::Raster;
use exact_brownian::{ExactBrownian, quantise};

const SIZE: usize = 256;

/// Surfaces of one dimension, as many as asked for.
fn surfaces(dimension: f64, count: u64) -> Vec<Raster> {
    let generator = ExactBrownian::new(SIZE, 3.0 - dimension);
    let seeds = 0..count.div_ceil(2);
    seeds.flat_map(|seed| generator.pair(1000 * (10.0 * dimension) as u64 + seed)).collect()
}

#[test]
fn the_generator_has_the_variogram_it_promises() {
    for hurst in [0.2, 0.5, 0.9] {
        let generator = ExactBrownian::new(64, hurst);
        for (dx, dy) in [(1, 0), (0, 3), (12, 9), (40, 0)] {
            let (mut sum, mut n) = (0.0, 0.0);
            for seed in 0..150 {
                for surface in generator.pair(seed) {
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
    for levels in [256, 65_536] {
        let mut errors = Vec::new();
        for tenth in 1..=9 {
            let dimension = 2.0 + 0.1 * f64::from(tenth);
            for surface in surfaces(dimension, 4) {
                let found = transects(&quantise(&surface, levels)).unwrap();
                errors.push((found.dimension - dimension).abs());
            }
        }
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        assert!(mean <= 0.01, "{levels} levels: mean absolute error {mean:.4}");
    }
}

#[test]
fn the_probability_dimension_rises_with_the_true_one() {
    for levels in [256, 65_536] {
        let (mut before, mut error) = (0.0, 0.0);
        for tenth in 1..=9 {
            let dimension = 2.0 + 0.1 * f64::from(tenth);
            let found: Vec<f64> = surfaces(dimension, 2)
                .iter()
                .map(|s| probability_dimension(&quantise(s, levels)).unwrap())
                .collect();
            let mean = found.iter().sum::<f64>() / found.len() as f64;
            assert!(mean > before, "D {dimension}: {mean} after {before}");
            before = mean;
            error += (mean - dimension).abs() / 9.0;
        }
        assert!(error <= 0.05, "{levels} levels: mean absolute error {error:.3}");
    }
}

#[test]
fn grid_cubes_saturate_as_the_documents_table_says() {
    for (dimension, boxes) in [(2.2, 2.22), (2.5, 2.36), (2.8, 2.44)] {
        let found = fractal_dimension(&quantise(&surfaces(dimension, 1)[0], 256)).unwrap().dimension;
        for d in [found.box_counting, found.information, found.correlation] {
            assert!((d - boxes).abs() < 0.15, "D {dimension}: {found:?}");
        }
    }
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
