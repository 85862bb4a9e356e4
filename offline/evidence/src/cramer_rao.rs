//! The joint Cramér–Rao bound of damped sinusoids in white noise.

use asperity_dsp::mode::Mode;
use nalgebra::{Cholesky, DMatrix};
use std::f64::consts::PI;

/// Standard deviations (f Hz, d 1/s, relative a, phase) no unbiased estimator can go below.
pub fn cramer_rao(modes: &[Mode], rate_hz: f64, count: usize, noise_std: f64) -> Vec<[f64; 4]> {
    let size = 4 * modes.len();
    let mut gram = DMatrix::<f64>::zeros(size, size);
    let mut start = 0;
    while start < count {
        let rows = (count - start).min(2048);
        let mut jacobian = DMatrix::<f64>::zeros(rows, size);
        for (k, mode) in modes.iter().enumerate() {
            for row in 0..rows {
                let t = (start + row) as f64 / rate_hz;
                let e = (-mode.decay_per_s * t).exp();
                let angle = 2.0 * PI * mode.frequency_hz * t + mode.phase_rad;
                let (s, c) = (e * angle.sin(), e * angle.cos());
                jacobian[(row, 4 * k)] = 2.0 * PI * t * mode.amplitude * c;
                jacobian[(row, 4 * k + 1)] = -t * mode.amplitude * s;
                jacobian[(row, 4 * k + 2)] = mode.amplitude * s;
                jacobian[(row, 4 * k + 3)] = mode.amplitude * c;
            }
        }
        gram += jacobian.transpose() * jacobian;
        start += rows;
    }
    let scale: Vec<f64> = (0..size).map(|i| 1.0 / gram[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(size, size, |i, j| gram[(i, j)] * scale[i] * scale[j]);
    let inverse = [0.0, 1e-14, 1e-12]
        .iter()
        .find_map(|ridge| {
            Cholesky::new(&scaled + DMatrix::identity(size, size) * *ridge).map(|c| c.inverse())
        })
        .expect("the bound of these modes exists");
    let std = |i: usize| noise_std * inverse[(i, i)].sqrt() * scale[i];
    (0..modes.len()).map(|k| [std(4 * k), std(4 * k + 1), std(4 * k + 2), std(4 * k + 3)]).collect()
}

/// Tests whether the data determine this mode at all.
pub fn identifiable(mode: &Mode, bound: &[f64; 4]) -> bool {
    bound[2] < 0.15
        && bound[1] < 0.3 * mode.decay_per_s
        && bound[0] < 0.15 * mode.decay_per_s / (2.0 * PI) + 0.05
}
