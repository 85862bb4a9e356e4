//! Noise that is steep over frequency: rumble, wind, 1/f.
//!
//! [`crate::noise::noise_floor`] smooths over 1.5 kHz, because modes ring in what it looks at;
//! noise that falls by 6 dB an octave is ten times as loud at 100 Hz as the answer there, and its
//! peaks pass for modes. In a *residual* little rings, so the spectrum can be followed over parts
//! of an octave:
//!
//! 1. medians over time of long frames (a quarter of the record: 1.5 Hz a bin at 2 s);
//! 2. their 30th percentile over an octave at knots a quarter of an octave apart, joined by
//!    straight lines over the logarithm of frequency;
//! 3. the same again on the spectrum divided by that line, so that the slope within an octave does
//!    not bias the percentile.
//!
//! Only where this exceeds the smooth floor by `TRUSTED` does it count: the percentile of few bins
//! scatters, and what is white must stay so.

use crate::noise::median_spectrum::{PERCENTILE, medians, percentile_of_median, previous_power_of_two};

/// Excess of the local floor over the smooth one from which on it counts, as a part of it, when it
/// is the percentile of one bin: some three standard deviations, which fall with the root of the
/// number of bins.
const TRUSTED: f64 = 3.4;
/// Knots an octave.
const KNOTS_PER_OCTAVE: f64 = 4.0;
/// Least half width of what a knot looks at, in bins.
const LEAST_HALF_WIDTH: f64 = 16.0;
/// First bin that the removed mean and the window's main lobe leave alone.
const FIRST_BIN: usize = 5;

/// A line through knots over the logarithm of the angular frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Tilt {
    /// (ln ω, ln variance), ascending.
    knots: Vec<(f64, f64)>,
    /// Radians a sample between bins.
    per_bin: f64,
}

impl Tilt {
    /// Tilt of `residual`; `None` when it is too short to say.
    #[must_use]
    pub fn of(residual: &[f64]) -> Option<Self> {
        let length = previous_power_of_two(residual.len() / 2).min(1 << 17);
        if length < 256 {
            return None;
        }
        let starts: Vec<usize> = (0..=residual.len() - length).step_by(length / 3).collect();
        let scale = 1.0 / percentile_of_median(starts.len());
        let spectrum: Vec<f64> = medians(residual, length, &starts).iter().map(|m| m * scale).collect();
        let per_bin = 2.0 * std::f64::consts::PI / length as f64;
        let rough = Self::through(&spectrum, per_bin)?;
        let flat: Vec<f64> =
            spectrum.iter().enumerate().map(|(bin, v)| v / rough.at(bin as f64 * per_bin)).collect();
        let mut fine = Self::through(&flat, per_bin)?;
        for (knot, rough) in fine.knots.iter_mut().zip(&rough.knots) {
            knot.1 += rough.1;
        }
        Some(fine)
    }

    fn through(spectrum: &[f64], per_bin: f64) -> Option<Self> {
        let last = spectrum.len() - 1;
        let mut knots = Vec::new();
        let mut centre = FIRST_BIN as f64 + LEAST_HALF_WIDTH;
        while centre < last as f64 {
            let half_octave = 2.0_f64.sqrt();
            let low = (centre / half_octave).min(centre - LEAST_HALF_WIDTH) as usize;
            let high = (centre * half_octave).max(centre + LEAST_HALF_WIDTH) as usize;
            let mut near = spectrum[low.max(FIRST_BIN)..=high.min(last)].to_vec();
            let rank = (PERCENTILE * (near.len() - 1) as f64).round() as usize;
            let value = *near.select_nth_unstable_by(rank, f64::total_cmp).1;
            knots.push(((centre * per_bin).ln(), value.max(f64::MIN_POSITIVE).ln()));
            centre *= 2.0_f64.powf(1.0 / KNOTS_PER_OCTAVE);
        }
        (knots.len() >= 2).then_some(Self { knots, per_bin })
    }

    /// The variance at an angular frequency; above the last knot as at it.
    #[must_use]
    pub fn at(&self, omega: f64) -> f64 {
        let x = omega.max(1e-9).ln();
        let first = self.knots[0];
        if x < first.0 {
            // Below the first knot as between it and the octave above, for an octave at most.
            let octave = self.knots[(KNOTS_PER_OCTAVE as usize).min(self.knots.len() - 1)];
            let slope = (octave.1 - first.1) / (octave.0 - first.0);
            return (first.1 + slope * (x - first.0).max(-std::f64::consts::LN_2)).exp();
        }
        let above = self.knots.partition_point(|knot| knot.0 < x).clamp(1, self.knots.len() - 1);
        let (a, b) = (self.knots[above - 1], self.knots[above]);
        let part = (x - a.0) / (b.0 - a.0);
        (a.1 + (b.1 - a.1) * part.min(1.0)).exp()
    }

    /// The angular frequencies of the knots.
    pub(crate) fn places(&self) -> impl Iterator<Item = f64> {
        self.knots.iter().map(|knot| knot.0.exp())
    }

    /// The variance at `omega` where the smooth floor says `smooth`.
    #[must_use]
    pub fn above(&self, smooth: f64, omega: f64) -> f64 {
        let local = self.at(omega);
        let bins = (omega / self.per_bin / 2.0_f64.sqrt()).max(2.0 * LEAST_HALF_WIDTH);
        if local > (1.0 + TRUSTED / bins.sqrt()) * smooth { local } else { smooth }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;
    use std::f64::consts::PI;

    /// Noise through a one-pole low-pass.
    fn coloured(pole: f64, count: usize, seed: u64) -> Vec<f64> {
        let (mut rng, mut last) = (Rng::new(seed), 0.0);
        let mut next = || {
            last += pole * (rng.normal() - last);
            last
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn one_pole_noise_is_followed_within_three_decibels() {
        for (pole, count) in [(0.02, 88_200), (0.005, 88_200), (0.1, 44_100), (0.02, 400_000)] {
            let tilt = Tilt::of(&coloured(pole, count, 3)).unwrap();
            for hz in [30.0, 60.0, 120.0, 300.0, 1000.0, 4000.0, 12_000.0] {
                let omega = 2.0 * PI * hz / 44_100.0;
                let z = nalgebra::Complex::from_polar(1.0, -omega);
                let truth = (pole / (1.0 - (1.0 - pole) * z).norm()).powi(2);
                let db = 10.0 * (tilt.at(omega) / truth).log10();
                assert!(db.abs() < 3.0, "{pole} {count}: {hz} Hz {db} dB");
            }
        }
    }

    #[test]
    fn white_noise_is_hardly_ever_tilted() {
        let (mut tried, mut tilted) = (0, 0);
        for seed in 0..10 {
            let mut rng = Rng::new(seed);
            let white: Vec<f64> = (0..60_000).map(|_| rng.normal()).collect();
            let tilt = Tilt::of(&white).unwrap();
            for i in 1..200 {
                let omega = PI * 1.05_f64.powi(-i);
                if omega > 0.003 {
                    tried += 1;
                    tilted += usize::from(tilt.above(1.0, omega) != 1.0);
                }
            }
        }
        assert!(100 * tilted <= tried, "{tilted} of {tried}");
    }
}
