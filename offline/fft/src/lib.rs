//! Planned Fourier transforms of `f64`, compiled once.
//!
//! `rustfft`'s planner is generic: every crate and every test program that calls it compiles all of
//! its algorithms for itself, ten seconds each. The planner here is not, so that they are compiled
//! in this crate and linked elsewhere.

pub use rustfft::{Fft, num_complex};

use num_complex::Complex64;
use std::f64::consts::TAU;
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

/// Hann window, 0 at `shift` samples before its first one and as many short of the one behind its
/// last.
#[must_use]
pub fn hann(length: usize, shift: f64) -> Vec<f64> {
    (0..length).map(|i| 0.5 - 0.5 * (TAU * (i as f64 + shift) / length as f64).cos()).collect()
}

/// Samples from one of any sign on, silence before the first and behind the last.
pub fn samples_from<S: Copy + Into<f64>>(samples: &[S], first: isize) -> impl Iterator<Item = f64> + '_ {
    let at = |n: isize| usize::try_from(n).ok().and_then(|n| samples.get(n));
    (first..).map(move |n| at(n).map_or(0.0, |x| (*x).into()))
}

/// Power spectra of pieces of a signal through one window.
#[derive(Clone)]
pub struct PowerSpectra {
    plan: Arc<dyn Fft<f64>>,
    window: Vec<f64>,
    length: usize,
}

impl std::fmt::Debug for PowerSpectra {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "PowerSpectra({} of {})", self.window.len(), self.length)
    }
}

impl PowerSpectra {
    /// Spectra of pieces as long as the window, with zeros behind them up to `length`.
    #[must_use]
    pub fn new(window: Vec<f64>, length: usize) -> Self {
        Self { plan: FftPlanner::new().plan_fft_forward(length), window, length }
    }

    /// Sum of the window's squares.
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.window.iter().map(|w| w * w).sum()
    }

    /// |Σ w(n) x(n) e^(−2πi k n / length)|² of a piece, k from 0 to half the length.
    pub fn of(&self, piece: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut block = vec![Complex64::default(); self.length];
        for ((bin, w), x) in block.iter_mut().zip(&self.window).zip(piece) {
            bin.re = x * w;
        }
        self.plan.process(&mut block);
        block[..=self.length / 2].iter().map(|bin| bin.norm_sqr()).collect()
    }
}
