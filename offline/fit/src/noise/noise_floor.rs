//! The noise under a recording, per frequency, estimated although modes still ring in it.
//!
//! Blackman–Harris frames over the quieter half of the recording; median over time in every bin (a
//! click or a decaying mode touches few frames), then the 30th percentile over 1.5 kHz (modes touch
//! few bins). Both order statistics of exponentially distributed powers are calibrated together,
//! exactly. Edges of the spectrum are mirrored; the bins beside 0 Hz carry the removed mean and are
//! replaced.

use crate::noise::median_spectrum::{PERCENTILE, medians, percentile_of_median, previous_power_of_two};
use crate::noise::tilt::Tilt;
use crate::sinusoid::partial::Partial;
use std::f64::consts::PI;

/// Width over which the percentile is taken, Hz.
const SMOOTHING_HZ: f64 = 1500.0;
/// The first half counts when it is this much louder than its share: the larger of two estimates of
/// the same noise would be biased.
const LOUDER: f64 = 0.8;
/// Length of the first epoch of noise by time, s.
const FIRST_EPOCH_S: f64 = 0.02;
/// The local noise over the smoothed one that makes noise steep: no scatter of the local one
/// reaches that.
const STEEP: f64 = 4.0;
/// Noise variance per frequency, as if the noise at that frequency were white.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseFloor {
    variance: Vec<f64>,
    /// For what is no steady noise: its first sample and the floor from there to the next.
    epochs: Vec<(f64, Self)>,
    /// Frequencies at which noise is steeper than the variances can follow.
    tilt: Option<Tilt>,
}

impl NoiseFloor {
    /// Estimates from `samples`; `least` is a variance the answer never goes below.
    #[must_use]
    pub fn estimate(samples: &[f64], rate_hz: f64, least: f64) -> Self {
        let part = &samples[samples.len() / 2..];
        let length = previous_power_of_two(part.len() / 4).clamp(16, 1 << 15);
        if part.len() < length {
            return Self::steady(vec![least.max(mean_square(part)); 2]);
        }
        // Blackman–Harris frames are nearly independent at half, and still add something at a
        // third.
        let hop = length / 3;
        let frames = 1 + (part.len() - length) / hop;
        // At most a few hundred frames, spread evenly: enough for a steady median.
        let stride = frames.div_ceil(300);
        let starts: Vec<usize> = (0..frames).step_by(stride).map(|f| f * hop).collect();
        let medians = medians(part, length, &starts);
        let half = (0.5 * SMOOTHING_HZ / rate_hz * length as f64).ceil() as usize;
        let scale = 1.0 / percentile_of_median(starts.len());
        let variance = percentiles(&medians, half.max(4)).iter().map(|v| (v * scale).max(least)).collect();
        Self::steady(variance)
    }

    fn steady(variance: Vec<f64>) -> Self {
        Self { variance, epochs: Vec::new(), tilt: None }
    }

    /// [`of_residual`](Self::of_residual), and by time as well: in epochs that double in length
    /// from 20 ms on. What a real body leaves beside its modes dies away with them; a mode of 30 ms
    /// has to stand above what is left in those 30 ms, not above the silence after it.
    #[must_use]
    pub fn by_time(samples: &[f64], rate_hz: f64, least: f64) -> Self {
        let mut floor = Self::of_residual(samples, rate_hz, least);
        let (mut from, mut length) = (0, ((FIRST_EPOCH_S * rate_hz) as usize).max(64));
        while from + length <= samples.len() {
            // The estimate looks at the second half of what it gets.
            let epoch = &samples[from..from + length];
            let mut twice = epoch.to_vec();
            twice.extend_from_slice(epoch);
            floor.epochs.push((from as f64, Self::estimate(&twice, rate_hz, least)));
            from += length;
            length *= 2;
        }
        floor
    }

    /// The noise that a partial stands in: what least squares with the epochs' own weights would
    /// know of it. In an epoch that holds the part w of its energy over a variance v it learns w /
    /// v of it,
    ///
    /// ```text
    /// variance = Σ w / Σ (w / v)
    /// ```
    /// so that a loud attack takes little from a mode that is heard long after it (the arithmetic
    /// mean makes the attack the noise of every mode).
    #[must_use]
    pub fn variance_of(&self, partial: &Partial) -> f64 {
        let ends = self.epochs.iter().skip(1).map(|(from, _)| *from).chain([f64::INFINITY]);
        let (mut sum, mut total) = (0.0, 0.0);
        for ((from, floor), to) in self.epochs.iter().zip(ends) {
            let left = |n: f64| (-2.0 * partial.delta.max(1e-12) * n).exp();
            let weight = left(*from) - left(to);
            sum += weight / floor.variance_at(partial.omega).max(f64::MIN_POSITIVE);
            total += weight;
        }
        let steady = self.variance_at(partial.omega);
        if sum > 0.0 { self.tilted(total / sum, partial.omega) } else { steady }
    }

    /// Floor that is louder where `residual` is over a part of an octave.
    #[must_use]
    pub fn following(mut self, residual: &[f64]) -> Self {
        self.tilt = Tilt::of(residual);
        self
    }

    /// Tests whether the noise [followed](Self::following) is anywhere far louder than smoothed
    /// over 1.5 kHz.
    #[must_use]
    pub fn is_steep(&self) -> bool {
        let smooth = Self { tilt: None, ..self.clone() };
        let steep = |tilt: &Tilt, omega: f64| tilt.at(omega) > STEEP * smooth.variance_at(omega);
        self.tilt.as_ref().is_some_and(|tilt| tilt.places().any(|omega| steep(tilt, omega)))
    }

    fn tilted(&self, smooth: f64, omega: f64) -> f64 {
        self.tilt.as_ref().map_or(smooth, |tilt| tilt.above(smooth, omega))
    }

    /// Estimates from what a fit left of a segment: the louder of its halves at every frequency, so
    /// that a recording that is not quite a sum of modes is not judged by its silent end.
    #[must_use]
    pub fn of_residual(samples: &[f64], rate_hz: f64, least: f64) -> Self {
        let end = Self::estimate(samples, rate_hz, least);
        let start = Self::estimate(&samples[..samples.len() / 2], rate_hz, least);
        let points = end.variance.len() - 1;
        let variance = end
            .variance
            .iter()
            .enumerate()
            .map(|(i, &v)| v.max(LOUDER * start.variance_at(PI * i as f64 / points as f64)))
            .collect();
        Self::steady(variance)
    }

    /// Variance at an angular frequency in radians a sample.
    #[must_use]
    pub fn variance_at(&self, omega: f64) -> f64 {
        let position = (omega / PI).clamp(0.0, 1.0) * (self.variance.len() - 1) as f64;
        let low = position.floor() as usize;
        let high = (low + 1).min(self.variance.len() - 1);
        let part = position - low as f64;
        self.tilted(self.variance[low] * (1.0 - part) + self.variance[high] * part, omega)
    }

    /// Mean variance over all frequencies: the noise power of the recording.
    #[must_use]
    pub fn mean_variance(&self) -> f64 {
        self.variance.iter().sum::<f64>() / self.variance.len() as f64
    }
}

fn mean_square(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x * x).sum::<f64>() / samples.len().max(1) as f64
}

/// Running percentile over ± `half` bins with mirrored edges, evaluated on a coarse grid.
fn percentiles(values: &[f64], half: usize) -> Vec<f64> {
    let last = values.len() as isize - 1;
    let mirrored = |i: isize| {
        values[(if i < 0 {
            -i
        } else if i > last {
            2 * last - i
        } else {
            i
        })
        .clamp(0, last) as usize]
    };
    let points = (values.len() / (half / 4).max(1)).clamp(2, values.len());
    (0..points)
        .map(|p| {
            let centre = (p as f64 / (points - 1) as f64 * last as f64).round() as isize;
            let mut near: Vec<f64> =
                (centre - half as isize..=centre + half as isize).map(mirrored).collect();
            let rank = (PERCENTILE * (near.len() - 1) as f64).round() as usize;
            *near.select_nth_unstable_by(rank, f64::total_cmp).1
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;
    use asperity_dsp::rng::Rng;
    use nalgebra::Complex;

    fn noise(seed: u64, count: usize) -> Vec<f64> {
        let mut rng = Rng::new(seed);
        (0..count).map(|_| 0.1 * rng.normal()).collect()
    }

    #[test]
    fn white_noise_is_measured_within_two_decibels_at_every_frequency() {
        for (seed, count) in [(1, 88_200), (2, 20_000), (3, 200_000)] {
            let floor = NoiseFloor::estimate(&noise(seed, count), 44_100.0, 0.0);
            for i in 1..100 {
                let db = 10.0 * (floor.variance_at(PI * f64::from(i) / 100.0) / 0.01).log10();
                assert!(db.abs() < 2.0, "{count}: {i} {db}");
            }
            assert!((10.0 * (floor.mean_variance() / 0.01).log10()).abs() < 0.6);
        }
    }

    #[test]
    fn a_short_mode_is_judged_by_the_noise_it_sounds_in() {
        let mut samples = noise(7, 88_200);
        samples.iter_mut().enumerate().for_each(|(n, x)| *x *= (-(n as f64) / 8820.0).exp() + 1e-3);
        let floor = NoiseFloor::by_time(&samples, 44_100.0, 0.0);
        let variance = |decay_per_s: f64| {
            floor.variance_of(&Partial {
                omega: 0.5,
                delta: decay_per_s / 44_100.0,
                c: Complex::new(1.0, 0.0),
            })
        };
        assert!((0.004..0.015).contains(&variance(300.0)), "{}", variance(300.0));
        assert!(variance(300.0) > 5.0 * variance(1.0), "{}", variance(1.0));
    }

    #[test]
    fn ringing_modes_do_not_raise_the_floor() {
        let modes: Vec<Partial> = (0..30)
            .map(|k| Partial {
                omega: 0.01 * 1.2_f64.powi(k),
                delta: 2e-5 * f64::from(k + 1),
                c: Complex::new(1.0, 0.0),
            })
            .collect();
        let mut signal = noise(4, 88_200);
        signal.iter_mut().zip(synthesise(&modes, 88_200)).for_each(|(s, m)| *s += m);
        let floor = NoiseFloor::estimate(&signal, 44_100.0, 0.0);
        for i in 0..100 {
            let db = 10.0 * (floor.variance_at(PI * f64::from(i) / 100.0) / 0.01).log10();
            assert!(db.abs() < 3.0, "{i} {db}");
        }
    }
}
