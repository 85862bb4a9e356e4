//! One damped sinusoid as the algorithms see it: per sample, complex amplitude.
//!
//! ```text
//! x[n] = Re( c · zⁿ )      z = e^(−δ + jω)      ω = 2π f / rate      δ = d / rate
//! ```
//! | symbol | here | unit |
//! |---|---|---|
//! | ω | [`Partial::omega`] | radians a sample |
//! | δ | [`Partial::delta`] | nepers a sample |
//! | c | [`Partial::c`] | signal units, at sample 0 of the window in use |

use nalgebra::Complex;

/// A damped sinusoid in units of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Partial {
    /// Angular frequency, radians a sample, inside (0, π).
    pub omega: f64,
    /// Damping, nepers a sample, at or above 0.
    pub delta: f64,
    /// Complex amplitude at sample 0.
    pub c: Complex<f64>,
}

impl Partial {
    /// z: the factor between two samples.
    #[must_use]
    pub fn pole(&self) -> Complex<f64> {
        self.power(1.0)
    }

    /// zⁿ for a real number of samples.
    #[must_use]
    pub fn power(&self, n: f64) -> Complex<f64> {
        Complex::from_polar((-self.delta * n).exp(), self.omega * n)
    }

    /// Sinusoid seen from `n` samples later (earlier when negative).
    #[must_use]
    pub fn moved(&self, n: f64) -> Self {
        Self { c: self.c * self.power(n), ..*self }
    }

    /// Energy Σ `x[n]²` over `samples` samples, without the double-frequency ripple.
    #[must_use]
    pub fn energy(&self, samples: usize) -> f64 {
        let exponent = 2.0 * self.delta * samples as f64;
        let length = if exponent < 1e-9 {
            samples as f64
        } else {
            -(-exponent).exp_m1() / -(-2.0 * self.delta).exp_m1()
        };
        0.5 * self.c.norm_sqr() * length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_is_the_sum_of_squares_of_a_fast_oscillation() {
        let partial = Partial { omega: 1.0, delta: 1e-3, c: Complex::new(0.3, -0.4) };
        let sum: f64 = (0..5000).map(|n| (partial.c * partial.power(f64::from(n))).re.powi(2)).sum();
        assert!((partial.energy(5000) / sum - 1.0).abs() < 2e-3);
        let endless = Partial { delta: 0.0, ..partial };
        assert!((endless.energy(1000) - 0.125 * 1000.0).abs() < 1e-9);
    }

    #[test]
    fn moving_there_and_back_changes_nothing() {
        let partial = Partial { omega: 0.3, delta: 1e-3, c: Complex::new(0.3, -0.4) };
        let back = partial.moved(700.0).moved(-700.0);
        assert!((back.c - partial.c).norm() < 1e-12);
    }
}
