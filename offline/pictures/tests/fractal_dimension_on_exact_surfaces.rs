//! The dimension estimators against exact Brownian surfaces of known dimension.

use crate::exact_brownian;

use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_pictures::fractal_dimension::{
    cube_dimensions, fractal_dimension, local_map, probability_dimension, transects,
};
use asperity_surface::raster::Raster;
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
fn the_recommended_dimension_is_within_a_hundredth_on_maps() {
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

/// Table 6.1 of the thesis: true dimension, then D_B, D_I, D_C.
const TABLE_6_1: [(f64, [f64; 3]); 3] =
    [(2.2, [2.22, 2.21, 2.20]), (2.5, [2.36, 2.36, 2.36]), (2.8, [2.44, 2.44, 2.44])];

/// The three cube dimensions of a map.
fn cubes(map: &Raster) -> [f64; 3] {
    let found = cube_dimensions(map).unwrap();
    [found.box_counting, found.information, found.correlation]
}

/// Counting the surface's points instead of its columns, D_B was 1.97, 1.99, 1.93 here.
#[test]
fn the_three_cube_dimensions_rise_and_are_those_of_the_documents_table() {
    let mut before = [0.0; 3];
    for tenth in 1..=9 {
        let dimension = 2.0 + 0.1 * f64::from(tenth);
        let maps = surfaces(dimension, 6);
        let each: Vec<[f64; 3]> = maps.iter().map(|map| cubes(&quantise(map, 256))).collect();
        let mean = [0, 1, 2].map(|k| each.iter().map(|d| d[k]).sum::<f64>() / each.len() as f64);
        assert!((0..3).all(|k| mean[k] > before[k]), "D {dimension}: {mean:?} after {before:?}");
        before = mean;
        for (_, theirs) in TABLE_6_1.iter().filter(|(d, _)| (d - dimension).abs() < 1e-9) {
            let off = (0..3).map(|k| (mean[k] - theirs[k]).abs()).fold(0.0, f64::max);
            assert!(off <= 0.1, "D {dimension}: {mean:?}, the document has {theirs:?}");
        }
    }
}

/// The document's three resolutions of D = 2.7: 130, 185 and 235 texels.
#[test]
fn the_cube_dimensions_do_not_depend_on_the_resolution() {
    let rows = [(130, [2.39, 2.38, 2.37]), (185, [2.42, 2.42, 2.43]), (235, [2.42, 2.42, 2.43])];
    for (size, theirs) in rows {
        let generator = ExactBrownian::new(size, 0.3);
        let each: Vec<[f64; 3]> =
            (0..3).flat_map(|seed| pair(&generator, seed)).map(|map| cubes(&quantise(&map, 256))).collect();
        for k in 0..3 {
            let mean = each.iter().map(|d| d[k]).sum::<f64>() / each.len() as f64;
            assert!((mean - theirs[k]).abs() <= 0.1, "{size}², {k}: {mean}, the document has {}", theirs[k]);
        }
    }
}

#[test]
fn grid_cubes_saturate_on_rough_surfaces_and_the_recommended_dimension_does_not() {
    let found = [2.2, 2.8].map(|d| fractal_dimension(&quantise(&surfaces(d, 1)[0], 256)).unwrap().dimension);
    let rise = |of: fn(&asperity_pictures::fractal_dimension::FractalDimension) -> f64| {
        of(&found[1]) - of(&found[0])
    };
    // The document's table rises by 0.22 over these 0.6.
    for saturated in [rise(|d| d.box_counting), rise(|d| d.information), rise(|d| d.correlation)] {
        assert!((0.1..0.45).contains(&saturated), "{found:?}");
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
