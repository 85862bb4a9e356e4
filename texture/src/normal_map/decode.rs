//! Slopes from the numbers of a normal map.
//!
//! Gentle slopes: red and green tell n_z better than blue does, whose steps are too coarse near 1. Steep ones: blue. A normal that is no unit vector was
//! averaged with others, as resizing does: its blue is the average's, and −n_x / n_z nearer to the average slope than what red and green alone would
//! say; the same where somebody scaled it. Blue says nothing in maps of two channels, where it is the same everywhere or does not follow from red and green.

use super::next_to_zero::NextToZero;
use crate::gradient_field::Slopes;
use crate::raster::Raster;

/// Steepest slope that is believed (84°); beyond it 8 bits say nothing.
const STEEPEST: f64 = 10.0;
/// Numbers of steps from 0 to 1 that image files round to.
const STEPS: [f64; 2] = [255.0, 65_535.0];
/// n_x² + n_y² from which a slope is steep.
const STEEP: f64 = 0.5;
/// By how much rounding to 8 bits changes a normal's length at the most: three halves of a step.
const ROUNDED: f64 = 0.01;
/// Root mean square by which blue may differ from what red and green say and still be theirs.
const UNRELATED: f64 = 0.2;

/// The number of steps from 0 to 1 to which all channels were rounded; `None`: they were not.
pub(super) fn rounding_steps(channels: [&Raster; 3]) -> Option<f64> {
    let rounded = |value: f64, steps: f64| (value * steps - (value * steps).round()).abs() < 1e-6 * steps;
    let all = |steps| channels.iter().all(|c| c.values.iter().all(|&v| rounded(v, steps)));
    STEPS.into_iter().find(|&steps| all(steps))
}

/// Slopes with green taken as OpenGL's.
pub(super) fn slopes_of_normals(red: &Raster, green: &Raster, blue: &Raster, steps: Option<f64>) -> Slopes {
    let (w, h) = (red.width, red.height);
    let (mut along_u, mut along_v) = (Raster::constant(w, h, 0.0), Raster::constant(w, h, 0.0));
    let [centre_x, centre_y] = [red, green].map(|c| steps.map(|steps| NextToZero::of(c, steps)));
    let blue_is_theirs = blue_is_theirs(red, green, blue);
    for i in 0..w * h {
        let [x, y, z] = [red, green, blue].map(|c| 2.0 * c.values[i] - 1.0);
        let x = centre_x.as_ref().map_or(x, |c| c.value(x));
        let y = centre_y.as_ref().map_or(y, |c| c.value(y));
        let flat = x * x + y * y;
        let unit = ((flat + z * z).sqrt() - 1.0).abs() <= ROUNDED;
        let up = if blue_is_theirs && (flat >= STEEP || !unit) { z } else { (1.0 - flat).max(0.0).sqrt() };
        let up = up.max(flat.sqrt() / STEEPEST).max(1e-9);
        along_u.values[i] = -x / up;
        along_v.values[i] = y / up;
    }
    Slopes { along_u, along_v }
}

/// Whether blue is what is left of a unit vector, or of the average of some.
fn blue_is_theirs(red: &Raster, green: &Raster, blue: &Raster) -> bool {
    let (low, high) = blue.range();
    if low == high {
        return false;
    }
    let square = |i: usize| {
        let [x, y, z] = [red, green, blue].map(|c| 2.0 * c.values[i] - 1.0);
        (z - (1.0 - x * x - y * y).max(0.0).sqrt()).powi(2)
    };
    let n = blue.values.len();
    (0..n).map(square).sum::<f64>() < UNRELATED * UNRELATED * n as f64
}

/// Variance of a slope whose normal was rounded to this step of its components, mean over the map.
pub(super) fn rounding_noise(field: &Slopes, step: f64) -> f64 {
    let gain = |(&p, &q): (&f64, &f64)| {
        let (p2, q2) = (p * p, q * q);
        0.5 * (1.0 + p2 + q2) * ((1.0 + p2).powi(2) + 2.0 * p2 * q2 + (1.0 + q2).powi(2))
    };
    let gains = field.along_u.values.iter().zip(&field.along_v.values).map(gain);
    step * step / 12.0 * gains.sum::<f64>() / field.along_u.values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One texel of a map whose other texels are `flat`.
    fn slope(normal: [f64; 3], flat: [f64; 3]) -> f64 {
        let channel =
            |i: usize| Raster::from_fn(4, 4, |x, y| 0.5 + 0.5 * if x + y == 0 { normal[i] } else { flat[i] });
        slopes_of_normals(&channel(0), &channel(1), &channel(2), None).along_u.values[0]
    }

    #[test]
    fn a_normal_that_was_averaged_gives_its_slope_by_its_blue() {
        // Half of a texel flat, half at 45°: the mean slope is ½.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let averaged = slope([-0.5 * half, 0.0, 0.5 + 0.5 * half], [0.0, 0.0, 1.0]);
        assert!((averaged - 0.414).abs() < 0.001, "{averaged}");
    }

    #[test]
    fn blue_is_not_asked_where_it_is_no_normals() {
        let x = -0.3_f64;
        let true_slope = -x / (1.0 - x * x).sqrt();
        for blue in [1.0, 0.0, -1.0] {
            let made = slope([x, 0.0, blue], [0.0, 0.0, blue]);
            assert!((made - true_slope).abs() < 1e-12, "{blue}: {made}");
        }
        // Something else in blue.
        let made = slope([x, 0.0, 0.1], [0.0, 0.0, -0.4]);
        assert!((made - true_slope).abs() < 1e-12, "{made}");
    }
}
