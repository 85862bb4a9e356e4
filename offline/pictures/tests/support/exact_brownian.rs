//! Exact Brownian surfaces as maps.

#![allow(dead_code, reason = "each user takes what it needs")]

use asperity_evidence::exact_brownian::ExactBrownian;
use asperity_surface::raster::Raster;

/// Two independent surfaces of a seed.
pub fn pair(generator: &ExactBrownian, seed: u64) -> [Raster; 2] {
    let size = generator.size();
    generator.pair(seed).map(|values| Raster { width: size, height: size, values })
}

/// Rounds a relief to a map of `levels` grey values over its full range, as a file would hold it.
pub fn quantise(surface: &Raster, levels: u32) -> Raster {
    let (low, high) = surface.range();
    let steps = f64::from(levels - 1);
    surface.map(|v| ((v - low) / (high - low) * steps).round() / steps)
}
