//! Modes that were found against the truth: missed, spurious, errors in units of the Cramér–Rao
//! bound.

use crate::cramer_rao::identifiable;
use crate::impact::{Impact, render_fast};
use asperity_dsp::mode::Mode;
use std::f64::consts::PI;

/// Score of found modes.
#[derive(Debug, Clone, Default)]
pub struct Score {
    /// True modes that the data can tell.
    pub identifiable: usize,
    /// Identifiable modes that were not found.
    pub missed: usize,
    /// Found modes that match no true one.
    pub spurious: usize,
    /// Errors of the frequency over its bound, of matched identifiable modes.
    pub f_ratio: Vec<f64>,
    /// Errors of the decay over its bound, of the same modes.
    pub d_ratio: Vec<f64>,
    /// Signal to error of the resynthesis, dB.
    pub snr_db: f64,
    /// Error of the best unbiased estimate, dB.
    pub limit_db: f64,
    /// Missed modes, and their bounds.
    pub missed_modes: Vec<(Mode, [f64; 4])>,
    /// Invented modes.
    pub spurious_modes: Vec<Mode>,
}

impl Score {
    /// Share of the matched identifiable modes whose frequency and decay are within four bounds.
    pub fn within_four_bounds(&self) -> f64 {
        let good = self.f_ratio.iter().zip(&self.d_ratio).filter(|(f, d)| f.abs() < 4.0 && d.abs() < 4.0);
        good.count() as f64 / self.f_ratio.len().max(1) as f64
    }
}

/// Root mean square of normally distributed ratios, outliers aside: median |ratio| / 0.6745.
pub fn robust_rms(ratios: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = ratios.iter().map(|r| r.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    if sizes.is_empty() { 0.0 } else { sizes[sizes.len() / 2] / 0.6745 }
}

/// Signal to error, dB.
pub fn snr_db(clean: &[f64], made: &[f64]) -> f64 {
    let signal: f64 = clean.iter().map(|x| x * x).sum();
    let error: f64 = clean.iter().zip(made).map(|(x, y)| (x - y) * (x - y)).sum();
    10.0 * (signal / error.max(1e-300)).log10()
}

/// One-to-one matching by frequency, nearest pairs (in bounds) first; a pair further apart than 8
/// bounds or half a bandwidth does not match.
pub fn score(impact: &Impact, bounds: &[[f64; 4]], found: &[Mode]) -> Score {
    let mut pairs = Vec::new();
    for (t, (truth, bound)) in impact.truth.iter().zip(bounds).enumerate() {
        let width = truth.decay_per_s / (2.0 * PI);
        let tolerance = (8.0 * bound[0]).max(0.05).min(0.5 * width + 8.0 * bound[0]).min(2.0 * width + 0.5);
        for (f, mode) in found.iter().enumerate() {
            let gap = (mode.frequency_hz - truth.frequency_hz).abs();
            if gap < tolerance {
                let decays = (mode.decay_per_s - truth.decay_per_s).abs() / bound[1];
                // What cannot be told apart must not take what can.
                let last = if identifiable(truth, bound) { 0.0 } else { 1e6 };
                pairs.push((last + gap / bound[0] + decays.min(20.0), t, f));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut of_truth, mut of_found) = (vec![None; impact.truth.len()], vec![None; found.len()]);
    for (_, t, f) in pairs {
        if of_truth[t].is_none() && of_found[f].is_none() {
            of_truth[t] = Some(f);
            of_found[f] = Some(t);
        }
    }
    let mut score = Score::default();
    for (t, (truth, bound)) in impact.truth.iter().zip(bounds).enumerate() {
        if !identifiable(truth, bound) {
            continue;
        }
        score.identifiable += 1;
        match of_truth[t] {
            None => {
                score.missed += 1;
                score.missed_modes.push((*truth, *bound));
            }
            Some(f) => {
                score.f_ratio.push((found[f].frequency_hz - truth.frequency_hz) / bound[0]);
                score.d_ratio.push((found[f].decay_per_s - truth.decay_per_s) / bound[1]);
            }
        }
    }
    for (f, of) in of_found.iter().enumerate() {
        if of.is_none() {
            score.spurious += 1;
            score.spurious_modes.push(found[f]);
        }
    }
    let made = render_fast(found, impact.rate_hz, impact.clean.len());
    score.snr_db = snr_db(&impact.clean, &made);
    let signal: f64 = impact.clean.iter().map(|x| x * x).sum();
    let count = 4.0 * impact.truth.len() as f64;
    score.limit_db = 10.0 * (signal / (count * impact.noise_std.powi(2))).log10();
    score
}
