//! How ground bends under a tip: in closed form, scaled, tiled, and the same by every way to the
//! same place.

use asperity_surface::combine::{Scale, Sum};
use asperity_surface::height_field::{HeightField, SurfaceBlock, Touch, local_concavity_m};
use asperity_surface::height_map::{Extent, HeightMap};
use asperity_surface::raster::Raster;
use asperity_surface::tiled::Tiled;
use asperity_surface::wrap::Wrap;
use std::f64::consts::TAU;

const SIDE_M: f64 = 0.14;
const WAVE_M: f64 = 0.014;
const AMPLITUDE_M: f64 = 0.5e-3;

/// Waves along u.
fn waves() -> HeightMap {
    let height = |x: usize, _| AMPLITUDE_M * (TAU * (x as f64 + 0.5) / 1024.0 * SIDE_M / WAVE_M).sin();
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    HeightMap::new(&Raster::from_fn(1024, 64, height), extent, Wrap::Repeat).unwrap()
}

fn hollow(source: &mut dyn HeightField, touch: &Touch, reach_m: f64) -> f64 {
    local_concavity_m(source, touch, (reach_m, 0.0), &mut SurfaceBlock::default())
}

fn at(u_m: f64, v_m: f64) -> Touch {
    Touch {
        contact: 0,
        sample: 0,
        position_m: [u_m, v_m],
        velocity_m_s: [0.0; 2],
        normal_force_n: 1.0,
        ..Touch::default()
    }
}

#[test]
fn waves_bend_as_their_second_difference_says() {
    let mut waves = waves();
    for reach_m in [1e-3, 2e-3] {
        for step in 0..28 {
            let u_m = 0.03 + 0.5e-3 * f64::from(step);
            // Half of the four points lie along the crest.
            let second = (TAU * reach_m / WAVE_M).cos() - 1.0;
            let expected_m = 0.5 * AMPLITUDE_M * (TAU * u_m / WAVE_M).sin() * second;
            let local_concavity_m = hollow(&mut waves, &at(u_m, 0.05), reach_m);
            assert!(
                (local_concavity_m - expected_m).abs() < 0.03 * AMPLITUDE_M,
                "{u_m}: {local_concavity_m} {expected_m}"
            );
        }
    }
}

#[test]
fn sums_scales_and_tiles_bend_as_their_parts() {
    let touch = at(0.0413, 0.02);
    let once_m = hollow(&mut waves(), &touch, 2e-3);
    assert!(once_m.abs() > 1e-6);
    let boxed = || -> Box<dyn HeightField> { Box::new(waves()) };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
    close(hollow(&mut Sum::new(vec![boxed(), boxed()]), &touch, 2e-3), 2.0 * once_m);
    close(hollow(&mut Scale::new(boxed(), -0.5).unwrap(), &touch, 2e-3), -0.5 * once_m);
    close(hollow(&mut Tiled::new(boxed(), [f64::INFINITY; 2]), &touch, 2e-3), once_m);
    let flat = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 0.0 };
    close(hollow(&mut HeightMap::flat(flat, 0.5).unwrap(), &touch, 2e-3), 0.0);
}
