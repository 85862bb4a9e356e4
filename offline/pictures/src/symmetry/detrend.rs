//! Taking the light out of a picture before its pattern is sought.
//!
//! A brightness gradient raises the distortion of every long shift and tilts the minima out of the
//! feature matrix. We subtract a least-squares surface of second order, then a wide blur (standard
//! deviation one eighth of the shorter side), which leaves any pattern with three periods or more.

use asperity_surface::raster::Raster;

/// Standard deviation of the blur over the shorter side.
const BLUR: f64 = 0.125;

/// The picture without its slow changes; mean 0.
pub(crate) fn detrended(picture: &Raster) -> Raster {
    let mut level = without_quadratic(picture);
    let slow = blurred(&level, BLUR * picture.width.min(picture.height) as f64);
    level.values.iter_mut().zip(&slow.values).for_each(|(v, s)| *v -= s);
    let mean = level.mean();
    level.values.iter_mut().for_each(|v| *v -= mean);
    level
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

/// Subtracts the least-squares surface 1, u, v, u² − c, u v, v² − c, which are orthogonal on the
/// grid: c is the mean of the squares.
fn without_quadratic(picture: &Raster) -> Raster {
    let (across, down) = (Along::of(picture.width), Along::of(picture.height));
    // Sums of the picture times each term.
    let mut products = [0.0; 6];
    for (y, row) in picture.values.chunks_exact(picture.width).enumerate() {
        let mut moments = [0.0; 3];
        for ((value, u), bend) in row.iter().zip(&across.tilt).zip(&across.bend) {
            moments = [moments[0] + value, moments[1] + u * value, moments[2] + bend * value];
        }
        let ([sum, tilt, bend], v, curve) = (moments, down.tilt[y], down.bend[y]);
        let row = [sum, tilt, v * sum, bend, v * tilt, curve * sum];
        products.iter_mut().zip(row).for_each(|(to, more)| *to += more);
    }
    let (x, y) = (&across.squares, &down.squares);
    let squares = [x[0] * y[0], x[1] * y[0], x[0] * y[1], x[2] * y[0], x[1] * y[1], x[0] * y[2]];
    let mut gains = [0.0; 6];
    for ((gain, product), square) in gains.iter_mut().zip(products).zip(squares) {
        *gain = if square > 0.0 { product / square } else { 0.0 };
    }
    let mut rest = picture.clone();
    for (y, row) in rest.values.chunks_exact_mut(picture.width).enumerate() {
        let v = down.tilt[y];
        let (level, tilt) = (gains[0] + gains[2] * v + gains[5] * down.bend[y], gains[1] + gains[4] * v);
        for ((value, u), bend) in row.iter_mut().zip(&across.tilt).zip(&across.bend) {
            *value -= level + tilt * u + gains[3] * bend;
        }
    }
    rest
}

/// The terms along one side: a tilt from −1 to 1 and its square about the mean.
struct Along {
    tilt: Vec<f64>,
    bend: Vec<f64>,
    /// Sums of the squares of 1, tilt and bend.
    squares: [f64; 3],
}

impl Along {
    fn of(size: usize) -> Self {
        let tilt: Vec<f64> = (0..size).map(|i| (2 * i + 1) as f64 / size as f64 - 1.0).collect();
        let power = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        let mean = power(&tilt) / size as f64;
        let bend: Vec<f64> = tilt.iter().map(|t| t * t - mean).collect();
        let squares = [size as f64, power(&tilt), power(&bend)];
        Self { tilt, bend, squares }
    }
}

/// A Gaussian blur as three box blurs each way; at the border each box is cut and averages what is
/// left.
pub(super) fn blurred(picture: &Raster, sigma: f64) -> Raster {
    let mut result = picture.clone();
    if sigma > 0.0 {
        let mean = RunningMean::of_variance(sigma * sigma / 3.0);
        result.values.chunks_exact_mut(picture.width).for_each(|row| mean.thrice(row));
        let mut turned = result.transposed();
        turned.values.chunks_exact_mut(picture.height).for_each(|column| mean.thrice(column));
        result = turned.transposed();
    }
    result
}

/// Weights of a running mean: 1 up to `reach` texels to both sides, and `end` (0–1) one texel
/// further.
#[derive(Debug, Clone, Copy)]
struct RunningMean {
    reach: usize,
    end: f64,
}

impl RunningMean {
    /// The box of exactly this variance, texels²: between whole boxes the ends make up the
    /// difference.
    fn of_variance(variance: f64) -> Self {
        // A whole box of reach r has the variance r (r + 1)/3.
        let reach = (0.5 * ((1.0 + 12.0 * variance).sqrt() - 1.0)).floor();
        let outside = (reach + 1.0) * (reach + 1.0) - variance;
        let end = (2.0 * reach + 1.0) * (variance - reach * (reach + 1.0) / 3.0) / (2.0 * outside);
        Self { reach: reach as usize, end }
    }

    /// The line's running mean's running mean's running mean.
    fn thrice(self, line: &mut [f64]) {
        let mut sums = vec![0.0; line.len() + 1];
        let mut before = vec![0.0; line.len()];
        for _ in 0..3 {
            before.copy_from_slice(line);
            for (x, value) in before.iter().enumerate() {
                sums[x + 1] = sums[x] + value;
            }
            let last = line.len();
            let whole = self.reach + 1..last.saturating_sub(self.reach + 1).max(self.reach + 1).min(last);
            let share = 1.0 / ((2 * self.reach + 1) as f64 + 2.0 * self.end);
            (0..whole.start.min(last))
                .chain(whole.end..last)
                .for_each(|x| line[x] = self.cut(&before, &sums, x));
            for x in whole {
                let inside = sums[x + self.reach + 1] - sums[x - self.reach];
                line[x] =
                    share * (inside + self.end * (before[x - self.reach - 1] + before[x + self.reach + 1]));
            }
        }
    }

    /// The mean at a place where the line may end within the box.
    fn cut(self, line: &[f64], sums: &[f64], x: usize) -> f64 {
        let (left, right) = (x.saturating_sub(self.reach), (x + self.reach + 1).min(line.len()));
        let (mut sum, mut weight) = (sums[right] - sums[left], (right - left) as f64);
        if x > self.reach {
            sum += self.end * line[x - self.reach - 1];
            weight += self.end;
        }
        if x + self.reach + 1 < line.len() {
            sum += self.end * line[x + self.reach + 1];
            weight += self.end;
        }
        sum / weight
    }
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
