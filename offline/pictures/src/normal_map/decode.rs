//! Slopes from the numbers of a normal map.
//!
//! Gentle slopes: red and green give n_z better than blue does, whose steps are too coarse near 1.
//! Steep ones: blue. A normal that is no unit vector was averaged with others, as resizing does:
//! its blue is the average's, and −n_x / n_z nearer to the average slope than what red and green
//! alone would say; the same where somebody scaled it. Blue says nothing in maps of two channels,
//! where it is the same everywhere or does not follow from red and green.
//!
//! Normals of a steep surface, averaged, are much shorter than 1 (half as long and less in maps of
//! rock and lava), and red and green alone would halve their slopes. An average of unit vectors is
//! never longer than 1, and is the flatter the higher both its blue and what red and green say of
//! it.

use super::zero_code::NextToZero;
use crate::gradient_field::Slopes;
use asperity_surface::raster::Raster;

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
/// Correlation of both from which blue is that of averages, further away though it is. Source:
/// ours; 0.47–0.83 in three maps of rock and lava whose normals are short.
const RELATED: f64 = 0.4;
/// Length of a normal that JPEG made longer than 1 at the most.
const LONGEST: f64 = 1.1;
/// Share of normals of a map that may be longer than that, or point down.
const FEW: f64 = 0.01;

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

/// Tests whether blue is what is left of a unit vector, or of the average of some.
fn blue_is_theirs(red: &Raster, green: &Raster, blue: &Raster) -> bool {
    let (low, high) = blue.range();
    if low == high {
        return false;
    }
    let normal = |i: usize| [red, green, blue].map(|c| 2.0 * c.values[i] - 1.0);
    let pairs = || (0..blue.values.len()).map(normal).map(|n| (n[2], left_of_unit(n)));
    let count = blue.values.len() as f64;
    pairs().map(|(z, up)| (z - up).powi(2)).sum::<f64>() < UNRELATED * UNRELATED * count
        || (are_averages((0..blue.values.len()).map(normal), count) && correlation(pairs()) >= RELATED)
}

/// n_z of a unit vector with these n_x and n_y.
fn left_of_unit([x, y, _]: [f64; 3]) -> f64 {
    (1.0 - x * x - y * y).max(0.0).sqrt()
}

/// Tests whether normals may be averages of unit vectors that point up.
fn are_averages(normals: impl Iterator<Item = [f64; 3]>, count: f64) -> bool {
    let none = |n: &[f64; 3]| n[2] < 0.0 || n.iter().map(|c| c * c).sum::<f64>() > LONGEST * LONGEST;
    normals.filter(none).count() as f64 <= FEW * count
}

/// Deviation of two numbers, from both.
fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut sums = [0.0; 6];
    for (a, b) in pairs {
        for (sum, value) in sums.iter_mut().zip([1.0, a, b, a * a, b * b, a * b]) {
            *sum += value;
        }
    }
    let [n, a, b, aa, bb, ab] = sums;
    let variances = (aa - a * a / n) * (bb - b * b / n);
    if variances > 0.0 { (ab - a * b / n) / variances.sqrt() } else { 0.0 }
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
    fn short_normals_of_steep_surfaces_give_their_slopes_by_their_blue() {
        let mut rng = asperity_dsp::rng::Rng::new(8);
        // Two flanks tilted by the same angle in each texel, one of them larger than the other.
        let normals: Vec<[f64; 3]> = (0..400)
            .map(|_| (0.3 + 1.1 * rng.uniform(), 0.6 * rng.uniform() - 0.3))
            .map(|(tilt, more)| [more * tilt.sin(), 0.0, tilt.cos()])
            .collect();
        let channel = |i: usize| Raster::from_fn(20, 20, |x, y| 0.5 + 0.5 * normals[20 * y + x][i]);
        let away = normals.iter().map(|&n| (n[2] - left_of_unit(n)).powi(2)).sum::<f64>() / 400.0;
        assert!(away.sqrt() > UNRELATED, "{}", away.sqrt());
        let made = slopes_of_normals(&channel(0), &channel(1), &channel(2), None).along_u;
        for (made, [x, _, z]) in made.values.iter().zip(&normals) {
            assert!((made + x / z).abs() < 1e-9, "{made} for {}", -x / z);
        }
        // The same numbers in another order are no blue of these normals.
        let blue = Raster::from_fn(20, 20, |x, y| channel(2).values[(20 * y + x + 7) % 400]);
        let made = slopes_of_normals(&channel(0), &channel(1), &blue, None).along_u;
        for (made, n) in made.values.iter().zip(&normals) {
            assert!((made + n[0] / left_of_unit(*n)).abs() < 1e-9, "{made}");
        }
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
