//! Whether anything rings at all, or all of it is noise that goes on as it began.
//!
//! Modes fitted to steep noise (rumble, wind, 1/f²) take the loudest part of it with them: the noise measured in
//! what they leave is then too low, and they pass every test against it. So before anything is fitted, the
//! segment is held against the noise it would be: stationary, with any spectrum that is smooth over some dozen bins.
//! Nothing has to be known of that spectrum, for a mode differs from it in two ways:
//!
//! * *it decays*: seen through a window of L samples at the segment's start, its bin is louder than the same bin
//!   seen through the same window later on. L = 64, 128, … a quarter of the segment;
//! * *it is a line*: its bin is louder than bins above and below it. L = the segment and half of it.
//!
//! The windows are w(n) = n³ e^(−a n), a = 20 / L, nearest to the exponential e^(−a n / 7): it keeps 63 % (−2 dB) of
//! what the exponential itself would, but has no jump at its start, so that steep noise does not leak through
//! (a⁸ / ω⁸). What they see are the differences of successive samples, in which a mode is the same mode and a slow
//! wander is none.
//!
//! The power P of a bin of noise over the mean Q of n others, independent and alike, exceeds r with the probability
//! of an F(2, 2n) variable, which bounds the ratio r of the least that counts:
//!
//! ```text
//! p = (1 + r / n)^(−n)            r = n (p^(−1/n) − 1)            p = FALSE_ALARM / samples
//! ```
//! The mean of others is arithmetic and taken on both sides: where the noise is steep, it is too high rather than too low.
//! A mode that is alone in a recording must have 2 to 4 dB more than [`crate::pruning`] asks for: the price of
//! not knowing the noise.

use nalgebra::Complex;
use rustfft::FftPlanner;
use std::f64::consts::PI;

/// Chance that noise is not recognised.
const FALSE_ALARM: f64 = 0.01;
/// Shortest window, samples.
const SHORTEST: usize = 64;
/// a · L: the window has fallen by 98 dB at its end.
const WINDOW_NEPERS: f64 = 20.0;
/// Windows overlap by three quarters: their bins are independent (the correlation of powers is 0.03).
const HOPS: usize = 4;
/// Lowest bin looked at: three a, what is slower is not seen as an oscillation.
const LOWEST_BIN: usize = 10;
/// Bins this near share too much with the one looked at.
const GUARD: usize = 4;
/// Neighbouring bins are not independent: this many are worth one.
const BINS_A_CELL: f64 = 4.45;
/// Farthest bins compared, as a part of the bin's number and in bins.
const LINE_REACH: (f64, usize, usize) = (0.5, 12, 48);
const DECAY_REACH: (f64, usize, usize) = (1.0 / 6.0, 0, 12);
/// Independent cells that are enough.
const ENOUGH: f64 = 60.0;

/// Whether `segment` is more than steady noise between two angular frequencies; `least_noise` is a variance
/// that counts as noise in any case (rounding).
#[must_use]
pub fn anything_rings(segment: &[f64], omega: (f64, f64), least_noise: f64) -> bool {
    let differences: Vec<f64> = segment.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let count = differences.len();
    if count < 8 * SHORTEST {
        // Too short to be compared with itself.
        return true;
    }
    let chance = FALSE_ALARM / count as f64;
    let test = |length: usize| Cells::of(&differences, length, omega, least_noise);
    let mut length = SHORTEST;
    while 4 * length <= count {
        if test(length).decay(chance) {
            return true;
        }
        length *= 2;
    }
    test(count / 4).decay(chance) || [2, 1].into_iter().any(|part| test(count / part).line(chance))
}

/// Powers per frame and bin through windows of one length.
struct Cells {
    powers: Vec<Vec<f64>>,
    bins: (usize, usize),
    /// Power of the rounding noise in bin k: its first factor times 1 − cos(2π k / L).
    rounding: f64,
    length: usize,
}

impl Cells {
    fn of(samples: &[f64], length: usize, omega: (f64, f64), least_noise: f64) -> Self {
        let rate = WINDOW_NEPERS / length as f64;
        let window: Vec<f64> = (0..length)
            .map(|n| (n as f64 + 0.5) * rate)
            .map(|x| x.powi(3) * (-x).exp())
            .collect();
        let norm: f64 = window.iter().map(|w| w * w).sum();
        let fft = FftPlanner::new().plan_fft_forward(length);
        let mut frame = vec![Complex::new(0.0, 0.0); length];
        let powers = (0..=samples.len() - length)
            .step_by((length / HOPS).max(1))
            .map(|start| {
                for ((value, x), w) in frame.iter_mut().zip(&samples[start..]).zip(&window) {
                    *value = Complex::new(x * w, 0.0);
                }
                fft.process(&mut frame);
                frame[..=length / 2].iter().map(|value| value.norm_sqr() / norm).collect()
            })
            .collect();
        let bin = |omega: f64| omega * length as f64 / (2.0 * PI);
        let low = (bin(omega.0).ceil() as usize).max(LOWEST_BIN);
        let high = (bin(omega.1) as usize).min(length / 2 - 1);
        Self { powers, bins: (low, high), rounding: 2.0 * least_noise, length }
    }

    /// Whether any bin of the first frame is louder than what later frames have there.
    fn decay(&self, chance: f64) -> bool {
        let Some(later) = self.powers.get(HOPS..).filter(|later| !later.is_empty()) else { return false };
        let frames = later.len() as f64;
        let sums: Vec<f64> =
            (0..self.powers[0].len()).map(|k| later.iter().map(|frame| frame[k]).sum()).collect();
        let sums = running_sums(&sums);
        (self.bins.0..=self.bins.1).any(|k| {
            let wanted = (0.5 * ENOUGH / frames * BINS_A_CELL) as usize;
            let reach = if frames >= ENOUGH { 0 } else { reach(DECAY_REACH, k).min(wanted) };
            let (from, to) = (k - reach, (k + reach + 1).min(sums.len() - 1));
            let bins = (to - from) as f64;
            let mean = (sums[to] - sums[from]) / (bins * frames);
            self.exceeds(k, mean, frames * (bins / BINS_A_CELL).max(1.0), chance)
        })
    }

    /// Whether any bin of the first frame is louder than its neighbours.
    fn line(&self, chance: f64) -> bool {
        let sums = running_sums(&self.powers[0]);
        (self.bins.0..=self.bins.1).any(|k| {
            let reach = reach(LINE_REACH, k);
            let below = (k.saturating_sub(reach).max(1), k - GUARD + 1);
            let above = ((k + GUARD).min(sums.len() - 1), (k + reach + 1).min(sums.len() - 1));
            let bins = (below.1 - below.0 + above.1 - above.0) as f64;
            let sum = sums[below.1] - sums[below.0] + sums[above.1] - sums[above.0];
            self.exceeds(k, sum / bins, bins / BINS_A_CELL, chance)
        })
    }

    fn exceeds(&self, k: usize, mean: f64, cells: f64, chance: f64) -> bool {
        let rounding = self.rounding * (1.0 - (2.0 * PI * k as f64 / self.length as f64).cos());
        let least = cells * ((-chance.ln() / cells).exp() - 1.0);
        self.powers[0][k] > least * mean.max(rounding)
    }
}

fn reach((part, least, most): (f64, usize, usize), k: usize) -> usize {
    ((part * k as f64) as usize).clamp(least, most)
}

/// Sums of the first 0, 1, 2, … values.
fn running_sums(values: &[f64]) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for value in values {
        sum += value;
        sums.push(sum);
    }
    sums
}
