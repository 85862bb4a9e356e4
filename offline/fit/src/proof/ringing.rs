//! Ringing against stationary noise: a decaying partial is told from noise that goes on as it
//! began.
//!
//! Modes fitted to steep noise (rumble, wind, 1/f²) take the loudest part of it with them: the
//! noise measured in what they leave is then too low, and they pass every test against it. So the
//! recording itself is held against the noise it would be: stationary, with any spectrum that is
//! smooth over some dozen bins. Nothing else has to be known of that spectrum, for a mode differs
//! from it in two ways:
//!
//! * *it decays*: seen through a window of L samples at the segment's start, its bin is louder than
//!   the same bin seen through the same window later on. L = 64, 128, … a quarter of the segment;
//! * *it is a line*: its bin is louder than bins above and below it. L = the segment and half of
//!   it.
//!
//! The windows are w(n) = (a n)³ e^(−a n), a = 20 / L, nearest to the exponential e^(−a n / 7): it
//! keeps 63 % (−2 dB) of what the exponential itself would, but has no jump at its start, so that
//! steep noise does not leak through (a⁸ / ω⁸). What they see are the differences of successive
//! samples, in which a mode is the same mode and a slow wander is none.
//!
//! The power P of a bin of noise over the mean Q of n others, independent and alike, is an F(2, 2n)
//! variable, which says how large the ratio r must be to count:
//!
//! ```text
//! p = (1 + r / n)^(−n)            r = n (p^(−1/n) − 1)            p = FALSE_ALARM / samples
//! ```
//! The mean of others is arithmetic and taken on both sides: where the noise is steep, it is too
//! high rather than too low. A mode must have 2 to 4 dB more than [`crate::proof::pruning`] asks
//! for: the price of not knowing the noise. It is paid only by a mode that is alone, or stands in
//! noise that is steep.

use crate::noise::noise_floor::NoiseFloor;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::synthesise;
use asperity_fft::PowerSpectra;
use std::f64::consts::PI;

/// Chance that noise is not recognised.
const FALSE_ALARM: f64 = 0.003;
/// Shortest window, samples.
const SHORTEST: usize = 64;
/// a · L: the window has fallen by 98 dB at its end.
const WINDOW_NEPERS: f64 = 20.0;
/// Windows overlap by three quarters: their bins are independent (the correlation of powers is
/// 0.03).
const HOPS: usize = 4;
/// Lowest bin looked at: three a, what is slower is not seen as an oscillation.
const LOWEST_BIN: usize = 10;
/// Bins this near share too much with the one looked at.
const GUARD: usize = 4;
/// Neighbouring bins are not independent: this many are worth one.
const BINS_A_CELL: f64 = 4.45;
/// Farthest bins compared, as a part of the bin's number and in bins at least and at most.
const LINE_REACH: (f64, usize, usize) = (0.5, 12, 48);
const DECAY_REACH: (f64, usize, usize) = (1.0 / 6.0, 0, 12);
/// Largest power of a steady residual's first half, in powers of its second.
const STEADY: f64 = 4.0;
/// Independent cells that are enough.
const ENOUGH: f64 = 60.0;

/// Tests whether `segment` is more than steady noise between two angular frequencies; `least_noise`
/// is a variance that counts as noise in any case (rounding).
#[must_use]
pub fn anything_rings(segment: &[f64], omega: (f64, f64), least_noise: f64) -> bool {
    let differences = differences(segment);
    let Some(views) = views(differences.len()) else { return true };
    let chance = FALSE_ALARM / differences.len() as f64;
    views.into_iter().any(|view| {
        let cells = Cells::of(&differences, view, least_noise);
        cells.bins(omega).any(|k| cells.first[k] > cells.least(k, chance))
    })
}

/// Tests whether `residual`, what a fit left of a segment, is steady noise that is steep over
/// frequency. What a real body leaves beside its modes dies away with them (ten times in power and
/// more from one half to the other, on every recording of the corpus; noise stays within a tenth).
#[must_use]
pub fn is_steep_noise(residual: &[f64], rate_hz: f64, least_noise: f64) -> bool {
    let (start, end) = residual.split_at(residual.len() / 2);
    let power = |x: &[f64]| differences(x).iter().map(|d| d * d).sum::<f64>();
    let noise = || NoiseFloor::estimate(end, rate_hz, least_noise).following(end);
    power(start) < STEADY * power(end) && noise().is_steep()
}

/// Which of `partials`, fitted to a segment and leaving `residual` of it, stand out of steady
/// noise. One that does is taken away before the others are looked at again.
#[must_use]
pub fn standing_out(residual: &[f64], partials: &[Partial], least_noise: f64) -> Vec<bool> {
    let mut standing = vec![false; partials.len()];
    let Some(views) = views(residual.len().saturating_sub(1)) else { return vec![true; partials.len()] };
    let chance = FALSE_ALARM / residual.len() as f64;
    while standing.contains(&false) {
        let doubtful: Vec<Partial> =
            partials.iter().zip(&standing).filter(|(_, standing)| !**standing).map(|(p, _)| *p).collect();
        let mut left = synthesise(&doubtful, residual.len());
        left.iter_mut().zip(residual).for_each(|(x, r)| *x += r);
        let left = differences(&left);
        let before = standing.clone();
        for &view in &views {
            let cells = Cells::of(&left, view, least_noise);
            for (standing, partial) in standing.iter_mut().zip(partials) {
                *standing |= cells.show(partial, chance);
            }
        }
        if standing == before {
            break;
        }
    }
    standing
}

fn differences(samples: &[f64]) -> Vec<f64> {
    samples.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// One way of looking at a segment.
#[derive(Debug, Clone, Copy)]
struct View {
    /// Length of the window, samples.
    length: usize,
    /// Comparison of the first frame's bins: later frames, or other bins.
    with_later: bool,
}

/// All views of `count` samples, `None` when these are too few to be compared with each other.
fn views(count: usize) -> Option<Vec<View>> {
    let decays = std::iter::successors(Some(SHORTEST), |length| Some(2 * length))
        .take_while(|length| 4 * length < count)
        .chain([count / 4])
        .map(|length| View { length, with_later: true });
    let lines = [count / 2, count].map(|length| View { length, with_later: false });
    (count >= 8 * SHORTEST).then(|| decays.chain(lines).collect())
}

/// Powers per bin through windows of one length.
struct Cells {
    view: View,
    /// Power of the first frame.
    first: Vec<f64>,
    /// Running sums, over bins, of what these are compared with, and of how many frames that is.
    sums: Vec<f64>,
    frames: f64,
    least_noise: f64,
}

impl Cells {
    fn of(samples: &[f64], view: View, least_noise: f64) -> Self {
        let length = view.length;
        let rate = WINDOW_NEPERS / length as f64;
        let window: Vec<f64> = (0..length).map(|n| n as f64 * rate).map(|x| x.powi(3) * (-x).exp()).collect();
        let spectra = PowerSpectra::new(window, length);
        let norm = spectra.energy();
        let powers = |start: usize| -> Vec<f64> {
            let powers = spectra.of(samples[start..].iter().copied());
            powers.into_iter().map(|power| power / norm).collect()
        };
        let first = powers(0);
        let (mut compared, mut frames) = (first.clone(), 1.0);
        if view.with_later {
            compared.fill(0.0);
            frames = 0.0;
            for start in (length..=samples.len() - length).step_by(length / HOPS) {
                compared.iter_mut().zip(powers(start)).for_each(|(sum, power)| *sum += power);
                frames += 1.0;
            }
        }
        Self { view, first, sums: running_sums(&compared), frames, least_noise }
    }

    /// The bins between two angular frequencies.
    fn bins(&self, omega: (f64, f64)) -> std::ops::RangeInclusive<usize> {
        let bin = |omega: f64| omega * self.view.length as f64 / (2.0 * PI);
        let low = (bin(omega.0).ceil() as usize).max(LOWEST_BIN);
        low..=(bin(omega.1) as usize).min(self.first.len() - 2)
    }

    /// The power that counts in bin `k`, where noise has more with this `chance`.
    fn least(&self, k: usize, chance: f64) -> f64 {
        let end = self.first.len();
        let (sum, bins) = if self.view.with_later {
            let wanted = (0.5 * ENOUGH / self.frames * BINS_A_CELL) as usize;
            let reach = if self.frames >= ENOUGH { 0 } else { reach(DECAY_REACH, k).min(wanted) };
            let (from, to) = (k - reach, (k + reach + 1).min(end));
            (self.sums[to] - self.sums[from], to - from)
        } else {
            let reach = reach(LINE_REACH, k);
            let below = (k.saturating_sub(reach).max(1), k - GUARD + 1);
            let above = ((k + GUARD).min(end), (k + reach + 1).min(end));
            let sum = self.sums[below.1] - self.sums[below.0] + self.sums[above.1] - self.sums[above.0];
            (sum, below.1 - below.0 + above.1 - above.0)
        };
        let mean = sum / (self.frames * bins as f64);
        let independent = self.frames * (bins as f64 / BINS_A_CELL).max(1.0);
        let turn = 2.0 * PI * k as f64 / self.view.length as f64;
        let rounding = 2.0 * self.least_noise * (1.0 - turn.cos());
        independent * ((-chance.ln() / independent).exp() - 1.0) * mean.max(rounding)
    }

    /// Tests whether the first frame shows `partial`: both what it would have there alone and what
    /// is there count.
    fn show(&self, partial: &Partial, chance: f64) -> bool {
        let per_bin = 2.0 * PI / self.view.length as f64;
        let k = (partial.omega / per_bin).round() as usize;
        if !self.bins((0.0, PI)).contains(&k) {
            return false;
        }
        let a = WINDOW_NEPERS / self.view.length as f64;
        let difference = (partial.c * (partial.pole() - 1.0)).norm_sqr();
        let away = partial.omega - k as f64 * per_bin;
        // |Σ w c zⁿ / 2|² / Σ w² with Σ (a n)³ e^(−s n) = 6 a³ / s⁴.
        let own = 1.6 * difference * a.powi(7) / ((a + partial.delta).powi(2) + away * away).powi(4);
        own.min(self.first[k]) > self.least(k, chance)
    }
}

fn reach((part, least, most): (f64, usize, usize), k: usize) -> usize {
    ((part * k as f64) as usize).clamp(least, most)
}

/// Sums of the first 0, 1, 2, … values.
fn running_sums(values: &[f64]) -> Vec<f64> {
    let sums = values.iter().scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;
    use nalgebra::Complex;

    /// Brown noise of unit steps that is lost after `1 / leak` samples, and white noise of its own.
    fn brown(leak: f64, count: usize, seed: u64) -> Vec<f64> {
        let (mut rng, mut sum) = (Rng::new(seed), 0.0);
        let mut next = || {
            sum += rng.normal() - leak * sum;
            sum
        };
        (0..count + 100_000).map(|_| next()).skip(100_000).collect()
    }

    /// A mode with `excess` times the energy, in variances of the noise at its frequency.
    fn mode(omega: f64, delta: f64, excess: f64, leak: f64) -> Partial {
        let z = Complex::from_polar(1.0 - leak, -omega);
        let variance = 1.0 / (1.0 - z).norm_sqr();
        Partial { omega, delta, c: Complex::from_polar((excess * variance * 4.0 * delta).sqrt(), 0.7) }
    }

    const BAND: (f64, f64) = (0.003, 3.1);

    #[test]
    fn noise_does_not_ring_however_steep_it_is() {
        let (mut tried, mut rang) = (0, 0);
        for leak in [1.0, 0.1, 0.003, 0.0007, 0.0] {
            for (count, draws) in [(1000, 60), (22_050, 20), (88_200, 4)] {
                for seed in 0..draws {
                    tried += 1;
                    rang += usize::from(anything_rings(&brown(leak, count, 70 + seed), BAND, 0.0));
                }
            }
        }
        // Chance lets one in some hundreds by.
        assert!(100 * rang <= tried, "{rang} of {tried}");
    }

    #[test]
    fn a_lone_mode_in_noise_is_found_when_its_parameters_can_be() {
        // A relative standard deviation of 0.15 of the amplitude is an energy of 89 variances.
        let (mut tried, mut seen) = (0, 0);
        for leak in [1.0, 0.003, 0.0] {
            for (omega, delta) in [(0.03, 1e-3), (0.1, 3e-4), (0.1, 2e-3), (0.5, 1e-4), (1.5, 1e-2)] {
                for seed in 0..4 {
                    let mut samples = brown(leak, 66_150, 90 + seed);
                    let ringing = synthesise(&[mode(omega, delta, 89.0, leak)], samples.len());
                    samples.iter_mut().zip(ringing).for_each(|(x, y)| *x += y);
                    tried += 1;
                    seen += usize::from(anything_rings(&samples, BAND, 0.0));
                }
            }
        }
        assert!(10 * seen >= 9 * tried, "{seen} of {tried}");
    }

    #[test]
    fn of_partials_in_steep_noise_those_that_ring_stand_out() {
        let leak = 0.003;
        let real =
            [mode(0.02, 2e-4, 3000.0, leak), mode(0.1, 1e-3, 300.0, leak), mode(0.7, 4e-3, 200.0, leak)];
        // As loud as the noise that such modes are fitted to.
        let invented =
            [mode(0.004, 3e-5, 20.0, leak), mode(0.006, 5e-5, 20.0, leak), mode(0.3, 1e-4, 15.0, leak)];
        let mut samples = brown(leak, 88_200, 5);
        let ringing = synthesise(&real, samples.len());
        samples.iter_mut().zip(ringing).for_each(|(x, y)| *x += y);
        let partials = [real, invented].concat();
        let residual: Vec<f64> =
            samples.iter().zip(synthesise(&partials, samples.len())).map(|(x, y)| x - y).collect();
        assert!(is_steep_noise(&residual, 44_100.0, 0.0));
        assert_eq!(standing_out(&residual, &partials, 0.0), [true, true, true, false, false, false]);
    }

    #[test]
    fn white_noise_and_what_dies_away_are_no_steep_noise() {
        assert!(!is_steep_noise(&brown(1.0, 66_150, 1), 44_100.0, 0.0));
        let dying: Vec<f64> = brown(0.003, 66_150, 2)
            .iter()
            .enumerate()
            .map(|(n, x)| x * (-(n as f64) / 15_000.0).exp())
            .collect();
        assert!(!is_steep_noise(&dying, 44_100.0, 0.0));
    }
}
