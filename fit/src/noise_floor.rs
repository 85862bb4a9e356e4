//! The noise under a recording, per frequency, estimated although modes still ring in it.
//!
//! Blackman–Harris frames over the quieter half of the recording; median over time in every bin (a
//! click or a decaying mode touches few frames), then the 30th percentile over 1.5 kHz (modes touch
//! few bins). Both order statistics of exponentially distributed powers are calibrated together, exactly.
//! Edges of the spectrum are mirrored; the bins beside 0 Hz carry the removed mean and are replaced.

use crate::partial::Partial;
use crate::tilt::Tilt;
use nalgebra::Complex;
use rustfft::FftPlanner;
use std::f64::consts::PI;

/// Width over which the percentile is taken, Hz.
const SMOOTHING_HZ: f64 = 1500.0;
/// The percentile over frequency.
pub(crate) const PERCENTILE: f64 = 0.3;
/// The first half counts when it is this much louder than its share: the larger of two estimates of the
/// same noise would be biased.
const LOUDER: f64 = 0.8;
/// Length of the first epoch of noise by time, s.
const FIRST_EPOCH_S: f64 = 0.02;
/// The local noise over the smoothed one that makes noise steep: no scatter of the local one reaches that.
const STEEP: f64 = 4.0;
/// Bins beside 0 Hz and half the rate that the window's main lobe reaches.
const EDGE_BINS: usize = 5;

/// Noise variance per frequency, as if the noise at that frequency were white.
#[derive(Debug, Clone, PartialEq)]
pub struct NoiseFloor {
    variance: Vec<f64>,
    /// For what is no steady noise: its first sample and the floor from there to the next.
    epochs: Vec<(f64, Self)>,
    /// Where noise is steeper over frequency than the variances can follow.
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
        // Blackman–Harris frames are nearly independent at half, and still add something at a third.
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

    /// [`of_residual`](Self::of_residual), and by time as well: in epochs that double in length from
    /// 20 ms on. What a real body leaves beside its modes dies away with them; a mode of 30 ms has
    /// to stand above what is left in those 30 ms, not above the silence after it.
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

    /// The noise that a partial stands in: of every epoch as much as it sounds there.
    #[must_use]
    pub fn variance_of(&self, partial: &Partial) -> f64 {
        let ends = self.epochs.iter().skip(1).map(|(from, _)| *from).chain([f64::INFINITY]);
        let (mut sum, mut total) = (0.0, 0.0);
        for ((from, floor), to) in self.epochs.iter().zip(ends) {
            let left = |n: f64| (-2.0 * partial.delta.max(1e-12) * n).exp();
            let weight = left(*from) - left(to);
            sum += weight * floor.variance_at(partial.omega);
            total += weight;
        }
        let steady = self.variance_at(partial.omega);
        if total > 0.0 { self.tilted(sum / total, partial.omega) } else { steady }
    }

    /// The same floor, and louder where `residual` is over a part of an octave.
    #[must_use]
    pub fn following(mut self, residual: &[f64]) -> Self {
        self.tilt = Tilt::of(residual);
        self
    }

    /// Whether the noise [followed](Self::following) is anywhere far louder than smoothed over 1.5 kHz.
    #[must_use]
    pub fn is_steep(&self) -> bool {
        let smooth = Self { tilt: None, ..self.clone() };
        let steep = |tilt: &Tilt, omega: f64| tilt.at(omega) > STEEP * smooth.variance_at(omega);
        self.tilt.as_ref().is_some_and(|tilt| tilt.places().any(|omega| steep(tilt, omega)))
    }

    fn tilted(&self, smooth: f64, omega: f64) -> f64 {
        self.tilt.as_ref().map_or(smooth, |tilt| tilt.above(smooth, omega))
    }

    /// Estimates from what a fit left of a segment: the louder of its halves at every frequency, so that
    /// a recording that is not quite a sum of modes is not judged by its silent end.
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

pub(crate) fn previous_power_of_two(n: usize) -> usize {
    if n == 0 { 1 } else { 1 << n.ilog2() }
}

fn mean_square(samples: &[f64]) -> f64 {
    samples.iter().map(|x| x * x).sum::<f64>() / samples.len().max(1) as f64
}

/// Median over time of the normalised power in every bin from 0 Hz to half the rate.
pub(crate) fn medians(samples: &[f64], length: usize, starts: &[usize]) -> Vec<f64> {
    let window: Vec<f64> = (0..length).map(|i| blackman_harris(i as f64 / length as f64)).collect();
    let norm: f64 = window.iter().map(|w| w * w).sum();
    let fft = FftPlanner::new().plan_fft_forward(length);
    let mut powers = vec![Vec::with_capacity(starts.len()); length / 2 + 1];
    let mut frame = vec![Complex::new(0.0, 0.0); length];
    for &start in starts {
        for ((value, x), w) in frame.iter_mut().zip(&samples[start..]).zip(&window) {
            *value = Complex::new(x * w, 0.0);
        }
        fft.process(&mut frame);
        for (bin, value) in powers.iter_mut().zip(&frame) {
            bin.push(value.norm_sqr() / norm);
        }
    }
    let middle = median_rank(starts.len()) - 1;
    let mut medians: Vec<f64> =
        powers.iter_mut().map(|bin| *bin.select_nth_unstable_by(middle, f64::total_cmp).1).collect();
    let last = medians.len() - 1;
    for bin in 0..EDGE_BINS.min(last / 4) {
        medians[bin] = medians[2 * EDGE_BINS.min(last / 4) - bin];
        medians[last - bin] = medians[last - (2 * EDGE_BINS.min(last / 4) - bin)];
    }
    medians
}

fn blackman_harris(x: f64) -> f64 {
    let c = |k: f64| (2.0 * PI * k * x).cos();
    0.358_75 - 0.488_29 * c(1.0) + 0.141_28 * c(2.0) - 0.011_68 * c(3.0)
}

/// The rank (from 1) taken as the median of `count` values.
fn median_rank(count: usize) -> usize {
    count.div_ceil(2)
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

/// The 30th percentile of the median of `count` unit exponentials: the median is below x when at least its
/// rank of them are, each with probability p = 1 − e^(−x).
pub(crate) fn percentile_of_median(count: usize) -> f64 {
    let least = median_rank(count);
    let below = |p: f64| {
        // Σ C(count, j) p^j (1 − p)^(count − j), j < least, from the logarithm of each term.
        let (mut term, mut sum) = (count as f64 * (1.0 - p).ln(), 0.0);
        for j in 0..least {
            sum += term.exp();
            term += ((count - j) as f64 / (j + 1) as f64 * p / (1.0 - p)).ln();
        }
        1.0 - sum
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if below(middle) < PERCENTILE {
            low = middle;
        } else {
            high = middle;
        }
    }
    -(-low).ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::projection::synthesise;
    use asperity_dsp::rng::Rng;

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

    /// Figures of scipy 1.17: −ln(1 − beta.ppf(0.3, k, M − k + 1)).
    #[test]
    fn the_percentile_of_the_median_is_the_one_scipy_computes() {
        for (count, theirs) in
            [(1, 0.356_674_943_9), (4, 0.317_981_762_9), (9, 0.537_178_846_7), (100, 0.632_786_936_2)]
        {
            let ours = percentile_of_median(count);
            assert!((ours / theirs - 1.0).abs() < 1e-9, "{count}: {ours} {theirs}");
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
