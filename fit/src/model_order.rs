//! How many exponentials a band holds: a gate, then the edge of the noise.
//!
//! *Gate.* A band is looked at only if a periodogram (over the full, half, quarter or eighth window,
//! for modes that die early) peaks in its central half above what q samples of noise reach,
//! 1.1 σ √(q (ln q + 1)).
//!
//! *Order.* The number of singular values of the L × M Hankel matrix above 1.05 σ (√L + √M), the edge
//! a random matrix has. It errs towards too many; significance is tested afterwards on the joint fit,
//! where it can be done properly ([`crate::pruning`]).

use nalgebra::Complex;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

type C = Complex<f64>;

/// Largest order of one band.
pub const MAX_ORDER: usize = 60;
/// Half width of the kept part of a band, as a fraction of the decimated rate (a quarter, and a margin).
pub const KEPT_HALF_WIDTH: f64 = 0.27;
const GATE_MARGIN: f64 = 1.1;
const EDGE_MARGIN: f64 = 1.05;

/// Number of singular values (given as squares, descending) above the noise edge.
#[must_use]
pub fn order(squares: &[f64], rows: usize, columns: usize, noise_std: f64) -> usize {
    let edge = EDGE_MARGIN * noise_std * ((rows as f64).sqrt() + (columns as f64).sqrt());
    squares.iter().take_while(|&&s| s > edge * edge).count().min(MAX_ORDER)
}

/// The periodogram gate of one level.
pub struct Gate {
    fft: Arc<dyn Fft<f64>>,
    size: usize,
}

impl Gate {
    /// For bands of `samples` samples.
    #[must_use]
    pub fn new(samples: usize) -> Self {
        let size = (2 * samples).next_power_of_two();
        Self { fft: FftPlanner::new().plan_fft_forward(size), size }
    }

    /// Whether the central half of `band` may hold a mode. `real`: the band is the signal itself.
    #[must_use]
    pub fn opens(&self, band: &[C], noise_std: f64, real: bool) -> bool {
        let reach = if real { 0.5 } else { KEPT_HALF_WIDTH };
        let bins = (reach * self.size as f64) as usize;
        let mut buffer = vec![C::new(0.0, 0.0); self.size];
        [1, 2, 4, 8].into_iter().any(|part| {
            let q = (band.len() / part).max(1);
            buffer.fill(C::new(0.0, 0.0));
            buffer[..q].copy_from_slice(&band[..q]);
            self.fft.process(&mut buffer);
            let peak = buffer[..=bins]
                .iter()
                .chain(&buffer[self.size - bins..])
                .map(C::norm_sqr)
                .fold(0.0, f64::max);
            let q = q as f64;
            peak > (GATE_MARGIN * noise_std).powi(2) * q * (q.ln() + 1.0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn noise_rarely_opens_the_gate_and_a_sinusoid_above_it_always_does() {
        let gate = Gate::new(160);
        let mut rng = Rng::new(5);
        let half = 0.5_f64.sqrt();
        let mut opened = 0;
        for _ in 0..500 {
            let mut band: Vec<C> =
                (0..160).map(|_| C::new(rng.normal() * half, rng.normal() * half)).collect();
            opened += usize::from(gate.opens(&band, 1.0, false));
            for (m, y) in band.iter_mut().enumerate() {
                *y += C::from_polar(0.8, 0.9 * m as f64);
            }
            assert!(gate.opens(&band, 1.0, false));
        }
        assert!(opened < 250, "{opened}");
    }

    #[test]
    fn order_counts_what_stands_above_the_edge() {
        assert_eq!(order(&[1e4, 5e3, 1.0, 0.5], 50, 60, 1.0), 2);
    }
}
