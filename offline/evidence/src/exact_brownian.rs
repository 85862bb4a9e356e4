//! Exact fractional Brownian surfaces, the ground truth of the dimension: E|h(p) − h(q)|² = |p −
//! q|^2H on the whole grid (lengths in diagonals of the map), by circulant embedding after Stein,
//! "Fast and exact simulation of fractional Brownian surfaces", J. Comput. Graph. Stat. 11 (2002).
//! Independent of the product's own generator on purpose.

use asperity_dsp::rng::Rng;
use asperity_fft::{FftPlanner, num_complex::Complex};

/// Makes surfaces of one size and dimension.
#[derive(Debug)]
pub struct ExactBrownian {
    size: usize,
    torus: usize,
    /// Square roots of the embedding's eigenvalues over the number of points.
    amplitude: Vec<f64>,
    /// Standard deviation of the random plane's slope, per texel.
    slope: f64,
}

impl ExactBrownian {
    /// Surfaces of `size` × `size` texels with Hurst index `hurst`.
    pub fn new(size: usize, hurst: f64) -> Self {
        let alpha = 2.0 * hurst;
        let reach = if alpha <= 1.5 { 1.0 } else { 2.0 };
        // Lengths in units of the domain in which Stein's covariance is exact: the map's diagonal.
        let texel = 1.0 / ((size - 1) as f64 * 2.0_f64.sqrt());
        let beta =
            if reach > 1.0 { alpha * (2.0 - alpha) / (3.0 * reach * (reach * reach - 1.0)) } else { 0.0 };
        let c2 = 0.5 * (alpha - beta * (reach - 1.0) * (reach - 1.0) * (reach + 2.0));
        let c0 = beta * (reach - 1.0).powi(3) + 1.0 - c2;
        let covariance = |r: f64| {
            if r <= 1.0 {
                c0 - r.powf(alpha) + c2 * r * r
            } else if r <= reach {
                beta * (reach - r).powi(3) / r
            } else {
                0.0
            }
        };
        let least = (2.0 * reach / texel).ceil() as usize;
        let torus = (least..).find(|&n| [2, 3, 5].iter().fold(n, |m, p| strip(m, *p)) == 1).unwrap();
        let wrapped = |i: usize| i.min(torus - i) as f64 * texel;
        let mut spectrum: Vec<Complex<f64>> = (0..torus * torus)
            .map(|i| Complex::new(covariance(wrapped(i % torus).hypot(wrapped(i / torus))), 0.0))
            .collect();
        transform(&mut spectrum, torus);
        let points = (torus * torus) as f64;
        let largest = spectrum.iter().fold(0.0_f64, |m, e| m.max(e.re));
        let least = spectrum.iter().fold(0.0_f64, |m, e| m.min(e.re));
        assert!(least > -1e-9 * largest, "the embedding is not exact: {least} against {largest}");
        let amplitude = spectrum.iter().map(|e| (e.re.max(0.0) / points).sqrt()).collect();
        Self { size, torus, amplitude, slope: (2.0 * c2).sqrt() * texel }
    }

    /// Texels in a row.
    #[must_use]
    pub fn size(&self) -> usize {
        self.size
    }

    /// Heights of two independent surfaces of a seed, row by row.
    pub fn pair(&self, seed: u64) -> [Vec<f64>; 2] {
        let mut rng = Rng::new(seed);
        let mut field: Vec<Complex<f64>> =
            self.amplitude.iter().map(|a| Complex::new(rng.normal(), rng.normal()) * a).collect();
        transform(&mut field, self.torus);
        let mut surface = |part: fn(&Complex<f64>) -> f64| {
            let (u, v) = (self.slope * rng.normal(), self.slope * rng.normal());
            let origin = part(&field[0]);
            // Stein's increments have twice the variance.
            let height = |i: usize| {
                let (x, y) = (i % self.size, i / self.size);
                let height = part(&field[y * self.torus + x]) - origin + u * x as f64 + v * y as f64;
                height * std::f64::consts::FRAC_1_SQRT_2
            };
            (0..self.size * self.size).map(height).collect()
        };
        [surface(|c| c.re), surface(|c| c.im)]
    }
}

fn strip(mut n: usize, factor: usize) -> usize {
    while n.is_multiple_of(factor) {
        n /= factor;
    }
    n
}

/// Unscaled forward transform of a square of complex numbers.
fn transform(square: &mut [Complex<f64>], size: usize) {
    let fft = FftPlanner::new().plan_fft_forward(size);
    for _ in 0..2 {
        fft.process(square);
        for y in 0..size {
            for x in 0..y {
                square.swap(y * size + x, x * size + y);
            }
        }
    }
}
