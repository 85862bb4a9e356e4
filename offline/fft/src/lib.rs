//! Planned Fourier transforms of `f64`, compiled once.
//!
//! `rustfft`'s planner is generic: every crate and every test program that calls it compiles all of
//! its algorithms for itself, ten seconds each. The planner here is not, so that they are compiled
//! in this crate and linked elsewhere.

pub use rustfft::{Fft, num_complex};

use std::sync::Arc;

/// [`rustfft::FftPlanner`] of `f64`: keeps what it has planned.
pub struct FftPlanner(rustfft::FftPlanner<f64>);

impl Default for FftPlanner {
    fn default() -> Self {
        Self::new()
    }
}

impl std::fmt::Debug for FftPlanner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("FftPlanner")
    }
}

impl FftPlanner {
    /// Nothing planned yet.
    #[must_use]
    pub fn new() -> Self {
        Self(rustfft::FftPlanner::new())
    }

    /// Σ x(n) e^(−2πi k n / length), not scaled.
    pub fn plan_fft_forward(&mut self, length: usize) -> Arc<dyn Fft<f64>> {
        self.0.plan_fft_forward(length)
    }

    /// Σ X(k) e^(2πi k n / length), not scaled.
    pub fn plan_fft_inverse(&mut self, length: usize) -> Arc<dyn Fft<f64>> {
        self.0.plan_fft_inverse(length)
    }
}
