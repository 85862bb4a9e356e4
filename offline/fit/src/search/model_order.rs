//! Model order of a band, the number of its exponentials: a gate, then the edge of the noise.
//!
//! *Gate.* A band is looked at only if a periodogram (over the full, half, quarter or eighth
//! window, for modes that die early) peaks in its central half above what q samples of noise reach,
//! σ √(q (ln q + 4)) — more than 4 where a level has so many bands that noise would open more than
//! a few — and above what the strongest band leaks into it.
//!
//! *Order.* The number of singular values of the L × M Hankel matrix above 1.05 σ (√L + √M), the
//! edge a random matrix has. It errs towards too many; significance is tested afterwards on the
//! joint fit, where it can be done properly ([`crate::proof::pruning`]).

use asperity_fft::{Fft, FftPlanner};
use nalgebra::Complex;
use std::sync::Arc;

type C = Complex<f64>;

/// Largest order of one band.
pub const MAX_ORDER: usize = 60;
/// Half width of the kept part of a band, as a fraction of the decimated rate (a quarter, and a
/// margin).
pub const KEPT_HALF_WIDTH: f64 = 0.27;
/// Height over ln q, in noise powers, that a peak must have: noise opens one band in twenty, and a
/// mode at the edge of proof (squared amplitude 35 variances) has about 12.
const GATE_MARGIN: f64 = 4.0;
/// Height over the logarithm of the number of bands: noise opens about twenty of them, however many
/// there are (a file of 30 s has 8193, and four hundred open bands of noise are all the modes a fit
/// may have).
const OPENED_BY_NOISE: f64 = 2.2;
/// Gain of the band filter's stop band, doubled: a weaker peak may be another band's.
const LEAKAGE: f64 = 2e-4;
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
    samples: usize,
    margin: f64,
}

/// Parts of the window that are looked at, for modes that die early.
const PARTS: [usize; 4] = [1, 2, 4, 8];

impl Gate {
    /// For `bands` bands of `samples` samples.
    #[must_use]
    pub fn new(samples: usize, bands: usize) -> Self {
        let margin = GATE_MARGIN.max((bands.max(1) as f64).ln() - OPENED_BY_NOISE);
        let size = (2 * samples).next_power_of_two();
        Self { fft: FftPlanner::new().plan_fft_forward(size), size, samples, margin }
    }

    /// Largest squared periodogram magnitude in the central half of `band`, per part of the window.
    /// `real`: the band is the signal itself, and all of it counts.
    #[must_use]
    pub fn peaks(&self, band: &[C], real: bool) -> [f64; 4] {
        let reach = if real { 0.5 } else { KEPT_HALF_WIDTH };
        let bins = (reach * self.size as f64) as usize;
        let mut buffer = vec![C::new(0.0, 0.0); self.size];
        PARTS.map(|part| {
            let q = (band.len() / part).max(1);
            buffer.fill(C::new(0.0, 0.0));
            buffer[..q].copy_from_slice(&band[..q]);
            self.fft.process(&mut buffer);
            let sides = buffer[..=bins].iter().chain(&buffer[self.size - bins..]);
            sides.map(C::norm_sqr).fold(0.0, f64::max)
        })
    }

    /// Tests whether a band with these peaks may hold a mode; `strongest`: the peaks of the
    /// strongest band.
    #[must_use]
    pub fn opens(&self, peaks: &[f64; 4], noise_std: f64, strongest: &[f64; 4]) -> bool {
        PARTS.iter().zip(peaks).zip(strongest).any(|((part, &peak), most)| {
            let q = (self.samples / part).max(1) as f64;
            peak > noise_std * noise_std * q * (q.ln() + self.margin) && peak > LEAKAGE * LEAKAGE * most
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn noise_rarely_opens_the_gate_and_a_sinusoid_above_it_always_does() {
        let gate = Gate::new(160, 1);
        let mut rng = Rng::new(5);
        let half = 0.5_f64.sqrt();
        let mut opened = 0;
        for _ in 0..500 {
            let mut band: Vec<C> =
                (0..160).map(|_| C::new(rng.normal() * half, rng.normal() * half)).collect();
            opened += usize::from(gate.opens(&gate.peaks(&band, false), 1.0, &[0.0; 4]));
            for (m, y) in band.iter_mut().enumerate() {
                *y += C::from_polar(0.8, 0.9 * m as f64);
            }
            assert!(gate.opens(&gate.peaks(&band, false), 1.0, &[0.0; 4]));
        }
        assert!(opened < 50, "{opened}");
    }

    #[test]
    fn order_counts_what_stands_above_the_edge() {
        assert_eq!(order(&[1e4, 5e3, 1.0, 0.5], 50, 60, 1.0), 2);
    }
}
