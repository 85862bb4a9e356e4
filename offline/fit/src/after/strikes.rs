//! Several strikes of one object: one set of frequencies and decays, amplitudes for every strike.
//!
//! A body has its poles; where it is struck only weights them. Modes of different strikes are one
//! mode when their frequencies agree within four standard deviations or a part in a thousand;
//! frequency and decay are averaged with the inverse variances as weights, and every strike's
//! amplitudes are fitted again with the common poles.

use crate::body::fitted::{Fit, FittedMode, partial_of};
use crate::recording::Recording;
use crate::sinusoid::amplitudes::fit_amplitudes_at_cost;
use asperity_dsp::mode::Mode;

/// Relative distance within which two frequencies may be one mode.
const SAME: f64 = 1e-3;
/// Cost of a mode's own energy in a strike that hardly has it, as a part of it.
const ENERGY_COST: f64 = 1e-4;
/// Least relative standard deviation an average gives a mode, so that none rules alone.
const LEAST_STD: f64 = 1e-6;

/// The common modes of several strikes.
#[derive(Debug, Clone, PartialEq)]
pub struct Merged {
    /// `strikes[s][k]`: mode k as strike s excited it; frequency and decay are the same in all.
    pub strikes: Vec<Vec<Mode>>,
    /// In how many strikes each mode was found.
    pub seen: Vec<usize>,
}

impl Merged {
    /// Amplitudes of every strike but the first, signed: a mode that a strike drives the other way
    /// round has a negative one. With the first strike's phases they are a body's further strike
    /// positions. Onsets are known to a fraction of a millisecond only, so the delay that makes the
    /// phases agree best (or oppose) is taken out first.
    #[must_use]
    pub fn positions(&self) -> Vec<Vec<f64>> {
        let Some((first, others)) = self.strikes.split_first() else { return Vec::new() };
        others
            .iter()
            .map(|modes| {
                let delay_s = delay_s(first, modes);
                let sign =
                    |(mode, first): (&Mode, &Mode)| mode.amplitude * agreement(first, mode, delay_s).signum();
                modes.iter().zip(first).map(sign).collect()
            })
            .collect()
    }
}

/// Largest difference between two onsets, s, and the step of the search.
const LARGEST_DELAY_S: f64 = 2e-3;
const DELAY_STEP_S: f64 = 2e-6;

/// Cosine of what two phases of a mode differ by when the second strike is `delay_s` late.
fn agreement(a: &Mode, b: &Mode, delay_s: f64) -> f64 {
    (b.phase_rad - a.phase_rad - 2.0 * std::f64::consts::PI * a.frequency_hz * delay_s).cos()
}

/// The delay at which the modes of two strikes are nearest to in phase or opposed.
fn delay_s(first: &[Mode], other: &[Mode]) -> f64 {
    let steps = (LARGEST_DELAY_S / DELAY_STEP_S) as i32;
    let worth = |delay_s: f64| {
        let pairs = first.iter().zip(other);
        pairs.map(|(a, b)| a.amplitude * b.amplitude * agreement(a, b, delay_s).powi(2)).sum::<f64>()
    };
    (-steps..=steps)
        .map(|step| f64::from(step) * DELAY_STEP_S)
        .map(|delay_s| (worth(delay_s), delay_s))
        .fold((f64::NEG_INFINITY, 0.0), |best, next| if next.0 > best.0 { next } else { best })
        .1
}

/// Merges fits with the recordings they came from, in the same order.
#[must_use]
pub fn merge(strikes: &[(&Recording, &Fit)]) -> Merged {
    let mut groups: Vec<Vec<(usize, FittedMode)>> = Vec::new();
    let mut all: Vec<(usize, FittedMode)> = strikes
        .iter()
        .enumerate()
        .flat_map(|(s, (_, fit))| fit.modes.iter().map(move |mode| (s, *mode)))
        .collect();
    // The best known modes found groups, the others join them.
    all.sort_by(|a, b| b.1.energy.total_cmp(&a.1.energy));
    for (s, mode) in all {
        let near = groups
            .iter()
            .enumerate()
            .filter(|(_, group)| group.iter().all(|(other, _)| *other != s) && same(&group[0].1, &mode))
            .map(|(g, group)| (g, (group[0].1.frequency_hz - mode.frequency_hz).abs()))
            .fold(None, |best: Option<(usize, f64)>, next| match best {
                Some(best) if best.1 <= next.1 => Some(best),
                _ => Some(next),
            });
        match near {
            Some((g, _)) => groups[g].push((s, mode)),
            None => groups.push(vec![(s, mode)]),
        }
    }
    let common: Vec<Mode> = groups.iter().map(|group| average(group)).collect();
    Merged {
        strikes: strikes.iter().map(|(recording, fit)| weights(recording, fit, &common)).collect(),
        seen: groups.iter().map(Vec::len).collect(),
    }
}

fn same(a: &FittedMode, b: &FittedMode) -> bool {
    let gap = (a.frequency_hz - b.frequency_hz).abs();
    let std = a.frequency_std_hz.hypot(b.frequency_std_hz).min(0.005 * a.frequency_hz);
    gap < (SAME * a.frequency_hz).max(4.0 * std)
}

fn average(group: &[(usize, FittedMode)]) -> Mode {
    let mean = |value: fn(&FittedMode) -> (f64, f64)| {
        let (mut sum, mut total) = (0.0, 0.0);
        for (_, mode) in group {
            let (x, std) = value(mode);
            let weight = 1.0 / (std * std + (LEAST_STD * x).powi(2) + 1e-30);
            if weight.is_finite() && weight > 0.0 {
                sum += weight * x;
                total += weight;
            }
        }
        if total > 0.0 { sum / total } else { value(&group[0].1).0 }
    };
    Mode {
        frequency_hz: mean(|m| (m.frequency_hz, m.frequency_std_hz)),
        decay_per_s: mean(|m| (m.decay_per_s, m.decay_std_per_s)),
        amplitude: 0.0,
        phase_rad: 0.0,
    }
}

/// The common poles with the amplitudes of one strike.
fn weights(recording: &Recording, fit: &Fit, common: &[Mode]) -> Vec<Mode> {
    let rate = fit.sample_rate_hz;
    let offset = (fit.start_offset_s * rate).round();
    let from = fit.onset_sample + offset as usize;
    let to = ((fit.end_s - recording.starts_at_s) * rate).round() as usize;
    let tail = &recording.samples[recording.samples.len() * 3 / 4..];
    let mean = tail.iter().sum::<f64>() / tail.len() as f64;
    let segment: Vec<f64> =
        recording.samples[from..to.min(recording.samples.len())].iter().map(|x| x - mean).collect();
    let mut partials: Vec<_> = common.iter().map(|mode| partial_of(mode, rate)).collect();
    fit_amplitudes_at_cost(&segment, &mut partials, ENERGY_COST);
    partials
        .iter()
        .zip(common)
        .map(|(partial, mode)| {
            let c = partial.moved(-offset).c;
            Mode { amplitude: c.norm(), phase_rad: c.arg() + std::f64::consts::FRAC_PI_2, ..*mode }
        })
        .collect()
}
