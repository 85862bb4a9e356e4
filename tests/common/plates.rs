//! The six plates of the Hasti study, as the demo has them, and a flat one of their plastic.
#![allow(dead_code)]

use super::SIDE_M;
use asperity::{Excitation, Extent, Roughness, Surface, Wrap};
use asperity_surface::height_map::HeightMap;
use asperity_surface::raster::Raster;
use std::f64::consts::PI;

/// R of printed PLA, as the table of materials and the plates of the demo have it.
const PLASTIC: f64 = 0.5;

/// Height of a plate at a place, m.
fn height_m(plate: &str, x: f64, y: f64) -> f64 {
    let pitch = 0.007;
    match plate {
        "ridge" => {
            let across = (x - 0.5 * SIDE_M) / 0.009;
            if across.abs() < 1.0 { 0.002 * (1.0 + (PI * across).cos()) } else { 0.0 }
        }
        "bumps" => {
            let (u, v) = ((x / pitch).fract() - 0.5, (y / pitch).fract() - 0.5);
            let radius = u.hypot(v) / 0.45;
            if radius < 1.0 { 0.0005 * (1.0 + (PI * radius).cos()) } else { 0.0 }
        }
        "sine" => 0.0005 * (1.0 - (2.0 * PI * x / pitch).cos()),
        "sawtooth" => {
            let (phase, fall) = ((x / pitch).fract(), 0.06);
            0.001 * if phase < 1.0 - fall { phase / (1.0 - fall) } else { (1.0 - phase) / fall }
        }
        _ => 0.0,
    }
}

/// A plate of the study.
pub fn surface(plate: &str) -> Surface {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let raster = |side: usize, of: &dyn Fn(f64, f64) -> f64| {
        let texel = SIDE_M / side as f64;
        Raster::from_fn(side, side, |x, y| of((x as f64 + 0.5) * texel, (y as f64 + 0.5) * texel))
    };
    let map = HeightMap::new(&raster(512, &|x, y| height_m(plate, x, y)), extent, Wrap::Clamp).unwrap();
    let halves = |x: f64| if (x < 0.5 * SIDE_M) == (plate == "matte-shiny") { 0.9 } else { 0.1 };
    let roughness = |x: f64, _: f64| if plate.contains("matte") { halves(x) } else { PLASTIC };
    let rough = HeightMap::new(&raster(128, &roughness), extent, Wrap::Clamp).unwrap();
    let surface = Surface::new(map, SIDE_M, SIDE_M).unwrap().roughness(Roughness::Map(Box::new(rough)));
    surface.excitation(Excitation::BOTH)
}
