//! Random midpoint displacement, the document's construction of Brownian paths and surfaces.
//!
//! A new point is the mean of its neighbours plus a normal number whose variance is what the law
//! E\[ΔX²\] = |r|^{2H} leaves open. For neighbours at distances ρ_i from the point and r_ij from each
//! other, n of them, it is
//!
//! ```text
//! v = (1/n) Σ_i ρ_i^{2H} − (1/2n²) Σ_ij r_ij^{2H}
//! path, both ends at d/2           d^{2H} (2^{−2H} − ¼)
//! centre of a square of edge d     d^{2H} (2^{−H} − ¼ − 2^{H−3})
//! middle of an edge d, four        the same with d/√2 (two ends, two centres)
//! middle of a border edge          as on a path, from its two ends
//! ```
//!
//! Source: the texture-analysis thesis §6.3.2. What we changed: its variances 2^{−jH} and 2^{−(i+j)H}
//! scale with r^H where the law needs r^{2H} (a surface of nominal dimension 2.1 would measure 2.59);
//! its surface rule defines centres of squares only, so the step on the edges is added; the far
//! corner has variance 2^H, and the corners are correlated as the law asks. Even so the result is not stationary, and its measured dimension is off
//! by up to 0.1: see the table in the tests.

use asperity_dsp::rng::Rng;

/// A path of `n` samples, cut from one of 2^k + 1.
pub(super) fn path(hurst: f64, n: usize, rng: &mut Rng) -> Vec<f64> {
    let span = (n - 1).next_power_of_two();
    let mut values = vec![0.0; span + 1];
    values[span] = rng.normal();
    let mut step = span;
    while step > 1 {
        let d = step as f64 / span as f64;
        let deviation = (d.powf(2.0 * hurst) * (2.0_f64.powf(-2.0 * hurst) - 0.25)).sqrt();
        for i in (step / 2..span).step_by(step) {
            let mean = 0.5 * (values[i - step / 2] + values[i + step / 2]);
            values[i] = mean + deviation * rng.normal();
        }
        step /= 2;
    }
    values.truncate(n);
    values
}

/// X itself on a square of n × n samples, cut from one of (2^k + 1)², before it is brought to an rms:
/// X(0, 0) = 0, and variances are those of an edge of length 1.
#[must_use]
pub fn raw_surface(hurst: f64, n: usize, rng: &mut Rng) -> Vec<f64> {
    let span = (n - 1).next_power_of_two();
    let mut square = Square { width: span + 1, values: vec![0.0; (span + 1) * (span + 1)] };
    // Corners (0,0), (1,0), (0,1), (1,1) of the unit square: variances 0, 1, 1, 2^H; the two near ones
    // have covariance ρ = 1 − 2^{H−1}, each has c = 2^{H−1} with the far one.
    let c = 2.0_f64.powf(hurst - 1.0);
    let rho = 1.0 - c;
    let right = rng.normal();
    let below = rho * right + (1.0 - rho * rho).sqrt() * rng.normal();
    let share = c / (1.0 + rho);
    *square.at(span, 0) = right;
    *square.at(0, span) = below;
    *square.at(span, span) =
        share * (right + below) + (2.0 * c - 2.0 * share * c).max(0.0).sqrt() * rng.normal();
    let mut step = span;
    while step > 1 {
        square.centres(step, hurst, rng);
        square.edges(step, hurst, rng);
        step /= 2;
    }
    (0..n * n).map(|i| *square.at(i % n, i / n)).collect()
}

struct Square {
    width: usize,
    values: Vec<f64>,
}

impl Square {
    fn at(&mut self, x: usize, y: usize) -> &mut f64 {
        &mut self.values[y * self.width + x]
    }

    /// d^{2H} for a distance in samples; the whole edge has length 1.
    fn law(&self, samples: f64, hurst: f64) -> f64 {
        (samples / (self.width - 1) as f64).powf(2.0 * hurst)
    }

    fn centres(&mut self, step: usize, hurst: f64, rng: &mut Rng) {
        let open = 2.0_f64.powf(-hurst) - 0.25 - 2.0_f64.powf(hurst - 3.0);
        let deviation = (self.law(step as f64, hurst) * open).sqrt();
        let half = step / 2;
        for y in (half..self.width).step_by(step) {
            for x in (half..self.width).step_by(step) {
                let mean = 0.25
                    * (*self.at(x - half, y - half)
                        + *self.at(x + half, y - half)
                        + *self.at(x - half, y + half)
                        + *self.at(x + half, y + half));
                *self.at(x, y) = mean + deviation * rng.normal();
            }
        }
    }

    fn edges(&mut self, step: usize, hurst: f64, rng: &mut Rng) {
        let open = 2.0_f64.powf(-hurst) - 0.25 - 2.0_f64.powf(hurst - 3.0);
        let inside = (self.law(step as f64 * core::f64::consts::FRAC_1_SQRT_2, hurst) * open).sqrt();
        let border = (self.law(step as f64, hurst) * (2.0_f64.powf(-2.0 * hurst) - 0.25)).sqrt();
        let (half, last) = (step / 2, self.width - 1);
        for y in (0..self.width).step_by(half) {
            let first = if (y / half).is_multiple_of(2) { half } else { 0 };
            for x in (first..self.width).step_by(step) {
                let across = || (x > 0 && x < last).then(|| [(x - half, y), (x + half, y)]);
                let along = || (y > 0 && y < last).then(|| [(x, y - half), (x, y + half)]);
                let mean = |pair: [(usize, usize); 2]| {
                    0.5 * pair.iter().map(|&(x, y)| self.values[y * self.width + x]).sum::<f64>()
                };
                let (mean, deviation) = match (across().map(mean), along().map(mean)) {
                    (Some(a), Some(b)) => (0.5 * (a + b), inside),
                    (Some(a), None) | (None, Some(a)) => (a, border),
                    (None, None) => continue,
                };
                *self.at(x, y) = mean + deviation * rng.normal();
            }
        }
    }
}
