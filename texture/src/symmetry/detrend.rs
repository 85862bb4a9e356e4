//! Taking the light out of a picture before its pattern is sought.
//!
//! A brightness gradient raises the distortion of every long shift and tilts the minima out of the feature matrix. We
//! subtract a least-squares surface of second order, then a wide blur (standard deviation one eighth of the
//! shorter side), which leaves any pattern with three periods or more.

use crate::raster::Raster;

/// Standard deviation of the blur over the shorter side.
const BLUR: f64 = 0.125;

/// The picture without its slow changes; mean 0.
pub(super) fn detrended(picture: &Raster) -> Raster {
    let flat = without_quadratic(picture);
    let slow = blurred(&flat, BLUR * picture.width.min(picture.height) as f64);
    let values: Vec<f64> = flat.values.iter().zip(&slow.values).map(|(v, s)| v - s).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    Raster { width: flat.width, height: flat.height, values: values.iter().map(|v| v - mean).collect() }
}

/// Means of `factor` × `factor` texels.
pub(super) fn decimated(picture: &Raster, factor: usize) -> Raster {
    if factor <= 1 {
        return picture.clone();
    }
    let area = (factor * factor) as f64;
    Raster::from_fn(picture.width / factor, picture.height / factor, |x, y| {
        let rows = y * factor..(y + 1) * factor;
        rows.map(|row| picture.row(row)[x * factor..(x + 1) * factor].iter().sum::<f64>()).sum::<f64>() / area
    })
}

/// Subtracts the least-squares Legendre surface 1, x, y, x², xy, y². On a full grid the terms are orthogonal but for
/// sampling, which two rounds remove.
fn without_quadratic(picture: &Raster) -> Raster {
    let mut rest = picture.clone();
    let along = |i: usize, size: usize| (2 * i + 1) as f64 / size as f64 - 1.0;
    let terms: [fn(f64, f64) -> f64; 6] =
        [|_, _| 1.0, |x, _| x, |_, y| y, |x, _| x * x - 1.0 / 3.0, |x, y| x * y, |_, y| y * y - 1.0 / 3.0];
    let across: Vec<f64> = (0..rest.width).map(|x| along(x, rest.width)).collect();
    let (width, height) = (rest.width, rest.height);
    for term in terms.iter().chain(&terms) {
        let (mut product, mut square) = (0.0, 0.0);
        for (y, row) in rest.values.chunks_exact(width).enumerate() {
            let v = along(y, height);
            for (value, &u) in row.iter().zip(&across) {
                let s = term(u, v);
                product += s * value;
                square += s * s;
            }
        }
        let gain = product / square;
        for (y, row) in rest.values.chunks_exact_mut(width).enumerate() {
            let v = along(y, height);
            for (value, &u) in row.iter_mut().zip(&across) {
                *value -= gain * term(u, v);
            }
        }
    }
    rest
}

/// A Gaussian blur as three box blurs; at the border each box is cut and averages what is left.
pub(super) fn blurred(picture: &Raster, sigma: f64) -> Raster {
    let mean = RunningMean::of_variance(sigma * sigma / 3.0);
    let mut result = picture.clone();
    if sigma > 0.0 {
        for _ in 0..3 {
            result = transposed_row_means(&transposed_row_means(&result, mean), mean);
        }
    }
    result
}

/// Weights of a running mean: 1 up to `reach` texels to both sides, and `end` (0–1) one texel further.
#[derive(Debug, Clone, Copy)]
struct RunningMean {
    reach: usize,
    end: f64,
}

impl RunningMean {
    /// The box of exactly this variance, texels²: between whole boxes the ends make up the difference.
    fn of_variance(variance: f64) -> Self {
        // A whole box of reach r has the variance r (r + 1)/3.
        let reach = (0.5 * ((1.0 + 12.0 * variance).sqrt() - 1.0)).floor();
        let outside = (reach + 1.0) * (reach + 1.0) - variance;
        let end = (2.0 * reach + 1.0) * (variance - reach * (reach + 1.0) / 3.0) / (2.0 * outside);
        Self { reach: reach as usize, end }
    }
}

/// Means over a box of each row, with rows and columns swapped on the way out.
fn transposed_row_means(picture: &Raster, mean: RunningMean) -> Raster {
    let (width, height) = (picture.width, picture.height);
    let mut values = vec![0.0; width * height];
    let mut sums = vec![0.0; width + 1];
    for y in 0..height {
        let row = picture.row(y);
        for (x, value) in row.iter().enumerate() {
            sums[x + 1] = sums[x] + value;
        }
        for x in 0..width {
            let (left, right) = (x.saturating_sub(mean.reach), (x + mean.reach + 1).min(width));
            let (mut sum, mut weight) = (sums[right] - sums[left], (right - left) as f64);
            if x > mean.reach {
                sum += mean.end * row[x - mean.reach - 1];
                weight += mean.end;
            }
            if x + mean.reach + 1 < width {
                sum += mean.end * row[x + mean.reach + 1];
                weight += mean.end;
            }
            values[x * height + y] = sum / weight;
        }
    }
    Raster { width: height, height: width, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_gradient_vanishes_and_a_pattern_stays() {
        let pattern = Raster::from_fn(96, 96, |x, y| f64::from(u8::from((x / 8 + y / 8) % 2 == 0)) - 0.5);
        let lit = Raster::from_fn(96, 96, |x, y| {
            pattern.at(x, y) + 0.05 * x as f64 - 0.0004 * (x * y) as f64 + 0.0003 * (y * y) as f64
        });
        let (clean, found) = (detrended(&pattern), detrended(&lit));
        let worst = clean.values.iter().zip(&found.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-6, "{worst}");
        let energy: f64 = clean.values.iter().zip(&pattern.values).map(|(a, b)| a * b).sum();
        assert!(energy > 0.9 * 0.25 * 96.0 * 96.0);
    }

    #[test]
    fn a_blur_keeps_a_constant_and_has_its_width() {
        assert!(blurred(&Raster::constant(40, 30, 3.0), 4.0).values.iter().all(|v| (v - 3.0).abs() < 1e-12));
        let mut point = Raster::constant(65, 65, 0.0);
        point.values[32 * 65 + 32] = 1.0;
        for sigma in [0.4, 1.0, 1.7, 5.0] {
            let spread = blurred(&point, sigma);
            let variance: f64 = (0..65).map(|x| (x as f64 - 32.0).powi(2) * spread.row(32)[x]).sum::<f64>()
                / spread.row(32).iter().sum::<f64>();
            assert!((variance.sqrt() - sigma).abs() < 1e-9, "{} for {sigma}", variance.sqrt());
        }
    }

    #[test]
    fn decimation_averages_and_drops_the_rest() {
        let small = decimated(&Raster::from_fn(7, 4, |x, _| x as f64), 2);
        assert_eq!((small.width, small.height, small.row(1)), (3, 2, &[0.5, 2.5, 4.5][..]));
    }
}
