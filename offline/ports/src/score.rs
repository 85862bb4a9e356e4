//! Score: how far what is left of a vibration lies from what it was.
//!
//! | number | how |
//! |---|---|
//! | in-band error | over the third octaves whose centre lies in the device's range, 10 % wider on either side: rms of the differences of their levels; what lies 30 dB below the strongest of the original counts as that |
//! | balance | level above 100 Hz against below it: difference between both signals; neither part below −20 dB of the whole |
//! | level bias | median of the differences of the levels of 20 ms, where the original is within 30 dB of its loudest |
//! | envelope correlation | of those levels as amplitudes, over the whole clip |
//!
//! All of it at 8 kHz, displacement over the [detection threshold](crate::felt). The first two are
//! about which frequencies, the last two about how much and when.

use crate::felt::{RATE_HZ, bin_hz, felt, power, weight};

/// The four numbers.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Score {
    /// dB rms.
    pub in_band_error_db: f64,
    /// dB, absolute.
    pub balance_db: f64,
    /// dB, positive when what is left is stronger.
    pub level_bias_db: f64,
    /// −1 to 1.
    pub envelope_correlation: f64,
}

/// Length of a level, samples of 8 kHz.
const FRAME: usize = 160;
/// Split of the balance, Hz.
const SPLIT_HZ: f64 = 100.0;
const FLOOR_DB: f64 = -30.0;
const BALANCE_FLOOR_DB: f64 = -20.0;

/// The original, measured once.
#[derive(Debug, Clone)]
pub struct Reference {
    band_hz: [f64; 2],
    /// Power of the third octaves of the device's range.
    pub(crate) bands: Vec<f64>,
    balance_db: f64,
    levels: Vec<f64>,
    count: usize,
}

impl Reference {
    /// Score of samples at 8 kHz for a device's range.
    #[must_use]
    pub fn new(samples: &[f64], band_hz: [f64; 2]) -> Self {
        let spectrum = power(samples);
        let levels = levels(&felt(samples));
        let (bands, balance_db) = (third_octaves(&spectrum, band_hz), balance_db(&spectrum));
        Self { band_hz, bands, balance_db, levels, count: samples.len() }
    }

    /// Scores what is left of it: samples at 8 kHz, of which what is missing counts as 0.
    #[must_use]
    pub fn score(&self, left: &[f64]) -> Score {
        let mut left = left.to_vec();
        left.resize(self.count, 0.0);
        let spectrum = power(&left);
        let bands = third_octaves(&spectrum, self.band_hz);
        let felt_levels = levels(&felt(&left));
        Score {
            in_band_error_db: difference_db(&self.bands, &bands),
            balance_db: (balance_db(&spectrum) - self.balance_db).abs(),
            level_bias_db: bias_db(&self.levels, &felt_levels),
            envelope_correlation: correlation(&self.levels, &felt_levels),
        }
    }
}

/// Centres of the third octaves of a range, 10 % wider on either side, Hz.
pub(crate) fn centres_hz([lowest, highest]: [f64; 2]) -> impl Iterator<Item = f64> {
    let all = (-20..10).map(|k| 1000.0 * 2f64.powf(f64::from(k) / 3.0));
    all.filter(move |hz| (0.9 * lowest..=1.1 * highest).contains(hz))
}

pub(crate) fn third_octaves(spectrum: &[f64], band_hz: [f64; 2]) -> Vec<f64> {
    centres_hz(band_hz)
        .map(|centre_hz| {
            let edges = centre_hz * 2f64.powf(-1.0 / 6.0)..centre_hz * 2f64.powf(1.0 / 6.0);
            weighted(spectrum, |hz| edges.contains(&hz))
        })
        .collect()
}

fn weighted(spectrum: &[f64], inside: impl Fn(f64) -> bool) -> f64 {
    let bins = spectrum.iter().enumerate().map(|(bin, power)| (bin_hz(bin), power));
    bins.filter(|(hz, _)| *hz > 0.0 && inside(*hz)).map(|(hz, power)| power * weight(hz).powi(2)).sum()
}

fn db(power: f64) -> f64 {
    10.0 * power.max(1e-300).log10()
}

fn difference_db(was: &[f64], is: &[f64]) -> f64 {
    let strongest = was.iter().copied().fold(0.0, f64::max);
    if was.is_empty() || strongest <= 0.0 {
        return 0.0;
    }
    let floor = db(strongest) + FLOOR_DB;
    let squares = was.iter().zip(is).map(|(was, is)| (db(*was).max(floor) - db(*is).max(floor)).powi(2));
    (squares.sum::<f64>() / was.len() as f64).sqrt()
}

fn balance_db(spectrum: &[f64]) -> f64 {
    let low = weighted(spectrum, |hz| hz < SPLIT_HZ);
    let high = weighted(spectrum, |hz| hz >= SPLIT_HZ);
    let whole = low + high;
    if whole <= 0.0 {
        return 0.0;
    }
    db(high / whole).max(BALANCE_FLOOR_DB) - db(low / whole).max(BALANCE_FLOOR_DB)
}

/// Root mean squares of 20 ms.
fn levels(felt: &[f64]) -> Vec<f64> {
    felt.chunks(FRAME)
        .map(|frame| (frame.iter().map(|x| x * x).sum::<f64>() / frame.len() as f64).sqrt())
        .collect()
}

fn bias_db(was: &[f64], is: &[f64]) -> f64 {
    let loudest = was.iter().copied().fold(0.0, f64::max);
    let least = loudest * 10f64.powf(FLOOR_DB / 20.0);
    let mut differences: Vec<f64> = was
        .iter()
        .zip(is)
        .filter(|(was, _)| **was > 0.0 && **was >= least)
        .map(|(was, is)| 20.0 * (is.max(1e-3 * least) / was).log10())
        .collect();
    if differences.is_empty() {
        return 0.0;
    }
    differences.sort_by(f64::total_cmp);
    differences[differences.len() / 2]
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
    };
    let both = product(a, mean_a, b, mean_b);
    let alone = (product(a, mean_a, a, mean_a) * product(b, mean_b, b, mean_b)).sqrt();
    // Two envelopes that do not move agree.
    let flat = |x: &[f64], m: f64| x.iter().all(|x| (x - m).abs() <= 1e-3 * m.max(1e-300));
    if flat(a, mean_a) && flat(b, mean_b) || alone <= 0.0 { 1.0 } else { both / alone }
}

/// Length of what is scored, s.
#[must_use]
pub fn duration_s(samples: &[f64]) -> f64 {
    samples.len() as f64 / RATE_HZ
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn sine(frequency_hz: f64, peak: f64) -> Vec<f64> {
        (0..16_000).map(|n| peak * (TAU * frequency_hz * n as f64 / RATE_HZ).sin()).collect()
    }

    #[test]
    fn a_signal_is_no_way_from_itself() {
        let x = sine(130.0, 0.5);
        let score = Reference::new(&x, [55.0, 200.0]).score(&x);
        assert_eq!((score.in_band_error_db, score.balance_db, score.level_bias_db), (0.0, 0.0, 0.0));
        assert!((score.envelope_correlation - 1.0).abs() < 1e-9);
    }

    #[test]
    fn half_is_six_decibels_less_and_another_tone_is_another_balance() {
        let x = sine(130.0, 0.5);
        let reference = Reference::new(&x, [55.0, 200.0]);
        let half = reference.score(&sine(130.0, 0.25));
        assert!((half.level_bias_db + 6.02).abs() < 0.05, "{half:?}");
        let low = reference.score(&sine(60.0, 0.5));
        assert!((low.balance_db - 40.0).abs() < 0.5, "{low:?}");
        assert!(low.in_band_error_db > 10.0);
    }

    #[test]
    fn an_envelope_that_moves_the_other_way_correlates_below_zero() {
        let ramp = |up: bool| -> Vec<f64> {
            let part = |n: usize| if up { n as f64 } else { (15_999 - n) as f64 } / 16_000.0;
            sine(130.0, 0.5).iter().enumerate().map(|(n, x)| x * part(n)).collect()
        };
        let score = Reference::new(&ramp(true), [55.0, 200.0]).score(&ramp(false));
        assert!(score.envelope_correlation < -0.9, "{score:?}");
    }
}
