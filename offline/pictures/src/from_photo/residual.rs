//! Residual of a pattern, the part that does not repeat, as heights: its fine waves stay in the
//! map, its law goes on below the map's texels.
//!
//! ```text
//! Z(ω) += Z_r(ω) g(λ)        g = 1 up to FINE_PX[0], cos² in octaves down to 0 at FINE_PX[1]
//! ```
//! Z: heights of the mean cell, Z_r: heights of the residual ([`mod@crate::darkness_prior`]). A
//! mean cell has lost the grain that lies on the pattern, and the engine's overlay begins at two
//! texels only: without g nothing at all would be felt between two texels and the cell. Longer
//! waves of the residual are dirt, wear and uneven light, which is what averaging is for.

use super::heights::contrast;
use crate::camera_noise::without_noise_and_steps;
use crate::darkness_prior::darkness_prior;
use crate::waves::Waves;
use asperity_surface::raster::Raster;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Wavelengths up to which the residual stays, and from which nothing of it does, texels. Source:
/// ours; the first is the longest wave of the plain contrast that ranks fine levels.
const FINE_PX: [f64; 2] = [8.0, 16.0];

/// Heights of what does not repeat, texels, by its contrast against the whole picture.
pub(super) fn residual_heights(residual: &Raster, picture: &Raster, jpeg_divisor: f64) -> Raster {
    let mean = picture.mean();
    let mut picture = residual.map(|v| v + mean);
    picture = without_noise_and_steps(&picture, jpeg_divisor).picture;
    picture = contrast(&picture);
    darkness_prior(&picture)
}

/// Adds the fine waves of the residual's heights to those of the mean cell.
pub(super) fn add_fine_waves(heights_px: &mut Raster, residual_px: &Raster) {
    let fine = Waves::of(residual_px).weighed_by_frequency(share);
    heights_px.values.iter_mut().zip(&fine.values).for_each(|(height, fine)| *height += fine);
}

/// g of a wave of so many radians a texel.
fn share(frequency: f64) -> f64 {
    if frequency <= 0.0 {
        return 0.0;
    }
    let octaves = (TAU / frequency / FINE_PX[0]).log2() / (FINE_PX[1] / FINE_PX[0]).log2();
    (FRAC_PI_2 * octaves.clamp(0.0, 1.0)).cos().powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_waves_stay_and_long_ones_do_not() {
        for (period, kept) in [(4, 1.0), (8, 1.0), (16, 0.0), (32, 0.0)] {
            let wave = Raster::from_fn(128, 64, |x, _| (TAU * x as f64 / f64::from(period)).cos());
            let mut heights = Raster::constant(128, 64, 0.25);
            add_fine_waves(&mut heights, &wave);
            let (low, high) = heights.range();
            assert!((0.5 * (high - low) - kept).abs() < 1e-9, "{period}: {low} to {high}");
            assert!((heights.mean() - 0.25).abs() < 1e-12);
        }
    }
}
