//! A sweep in narrow bands: where the resonance is looked for, and where the model is proved.

use super::record::{Fit, Record};
use super::{DEEPEST_DB, MISFIT_DB, NARROWEST, SweepError, refused};
use asperity_fft::num_complex::Complex64;
use std::f64::consts::{LN_10, TAU};
use std::ops::RangeInclusive;

/// Range that is looked at, Hz.
const RANGE_HZ: [f64; 2] = [10.0, 2000.0];
/// Bands of an octave where the resonance is looked for.
const FINE: f64 = 48.0;
/// Bands of an octave where the model is proved.
const COARSE: f64 = 12.0;
/// Drive in a band over the largest in one, dB at least.
const DRIVEN_DB: f64 = -25.0;
/// Lags of the acceleration's channel that are tried, s: from, to, step.
const LAGS_S: [f64; 3] = [-0.002, 0.03, 0.000_25];

/// A band: its middle, and sums over its bins.
struct Band {
    hz: f64,
    /// Σ |drive|².
    drive: f64,
    /// Σ acceleration · drive*.
    cross: Complex64,
}

/// Bands that are driven.
pub(super) struct Bands(Vec<Band>);

impl Bands {
    pub(super) fn new(record: &Record<'_>) -> Self {
        let recorded = &record.sweep.acceleration_m_s2;
        let mean = recorded.iter().sum::<f64>() / recorded.len() as f64;
        let acceleration = record.spectrum(recorded.iter().map(|a| a - mean));
        let band = |(hz, bins): (f64, RangeInclusive<usize>)| {
            let drive = record.drive[bins.clone()].iter().map(Complex64::norm_sqr).sum();
            let cross = bins.map(|bin| acceleration[bin] * record.drive[bin].conj()).sum();
            Band { hz, drive, cross }
        };
        let mut all: Vec<Band> = edges(record, FINE).into_iter().map(band).collect();
        let least = driven(&all.iter().map(|band| band.drive).collect::<Vec<_>>());
        all.retain(|band| band.drive >= least);
        Self(all)
    }

    /// Best of all resonances, Qs and lags in the driven range.
    pub(super) fn search(&self, record: &Record<'_>) -> Fit {
        let lags = (0..).map(|n| LAGS_S[0] + f64::from(n) * LAGS_S[2]).take_while(|lag| *lag <= LAGS_S[1]);
        let turned = |lag_s: f64| -> Vec<Complex64> {
            self.0.iter().map(|band| band.cross * Complex64::cis(TAU * band.hz * lag_s)).collect()
        };
        let lags: Vec<(f64, Vec<Complex64>)> = lags.map(|lag_s| (lag_s, turned(lag_s))).collect();
        let mut best =
            (0.0, Fit { resonance_hz: 100.0, quality: 2.0, lag_s: 0.0, felt_m: 0.0, offset_m_s2: 0.0 });
        for band in self.0.iter().step_by(2) {
            for quality in [0.7, 1.1, 1.8, 3.0, 5.0, 9.0, 16.0, 30.0] {
                let fit = Fit { resonance_hz: band.hz, quality, ..best.1 };
                let model: Vec<Complex64> =
                    self.0.iter().map(|at| -(TAU * at.hz).powi(2) * fit.motion(TAU * at.hz)).collect();
                let power: f64 = self.0.iter().zip(&model).map(|(at, m)| at.drive * m.norm_sqr()).sum();
                for (lag_s, cross) in &lags {
                    let along: f64 = cross.iter().zip(&model).map(|(c, m)| (c * m.conj()).re).sum();
                    // What the model takes of the sum of squares.
                    if along * along / power > best.0 {
                        let found = Fit { lag_s: *lag_s, felt_m: along / power, ..fit };
                        best = (along * along / power, found);
                    }
                }
            }
        }
        let recorded = &record.sweep.acceleration_m_s2;
        Fit { offset_m_s2: recorded.iter().sum::<f64>() / recorded.len() as f64, ..best.1 }
    }

    /// Edges of the band in which the record proves the model, Hz.
    pub(super) fn proved(
        &self,
        record: &Record<'_>,
        fit: &Fit,
        kept: &[bool],
    ) -> Result<[f64; 2], SweepError> {
        let [first_hz, last_hz] =
            [self.0.first(), self.0.last()].map(|band| band.map_or(0.0, |band| band.hz));
        if !(first_hz..=last_hz).contains(&fit.resonance_hz) {
            let what = format!(
                "is driven from {first_hz:.0} to {last_hz:.0} Hz and follows a resonance at {:.1} Hz",
                fit.resonance_hz
            );
            return refused(what, "sweep from well below the resonance to well above it");
        }
        let bands = misfits(record, fit, kept);
        let peak = fit.motion(TAU * fit.resonance_hz).norm();
        let is_good = |band: &(f64, f64)| {
            let depth_db = 20.0 * (fit.motion(TAU * band.0).norm() / peak).log10();
            band.1 <= MISFIT_DB && depth_db >= DEEPEST_DB
        };
        let nearest = |band: &(f64, f64)| (band.0 / fit.resonance_hz).ln().abs();
        let Some(middle) =
            (0..bands.len()).min_by(|a, b| nearest(&bands[*a]).total_cmp(&nearest(&bands[*b])))
        else {
            return refused("is too short for its bands", "sweep some seconds");
        };
        let below = bands[..=middle].iter().rev().take_while(|band| is_good(band)).last();
        let above = bands[middle..].iter().take_while(|band| is_good(band)).last();
        let half = 2f64.powf(0.5 / COARSE);
        match (below, above) {
            (Some(below), Some(above)) if above.0 / below.0 * half * half >= NARROWEST => {
                Ok([below.0 / half, above.0 * half])
            }
            _ => {
                let what = format!(
                    "departs from one resonance at {:.1} Hz: {:.1} dB of misfit and noise there",
                    fit.resonance_hz, bands[middle].1
                );
                refused(what, "sweep weaker, so that nothing strikes a stop, or longer")
            }
        }
    }
}

/// Middle of each driven band and its misfit with the uncertainty of that, dB.
fn misfits(record: &Record<'_>, fit: &Fit, kept: &[bool]) -> Vec<(f64, f64)> {
    let [model, ..] = record.model(fit);
    let only = |of: &dyn Fn(usize) -> f64| {
        record.spectrum((0..model.len()).map(|at| if kept[at] { of(at) } else { 0.0 }))
    };
    let recorded = &record.sweep.acceleration_m_s2;
    let rest = only(&|at| recorded[at] - model[at] - fit.offset_m_s2);
    let model = only(&|at| model[at]);
    let padded = record.length as f64 / record.sweep.drive.len() as f64;
    let edges = edges(record, COARSE);
    let of = |x: &[Complex64]| x.iter().map(Complex64::norm_sqr).sum::<f64>();
    let drive: Vec<f64> = edges.iter().map(|(_, bins)| of(&record.drive[bins.clone()])).collect();
    let least = driven(&drive);
    let band = |((hz, bins), drive): ((f64, RangeInclusive<usize>), f64)| {
        let (power, noise) = (of(&model[bins.clone()]), of(&rest[bins.clone()]));
        let along: Complex64 = bins.clone().map(|bin| rest[bin] * model[bin].conj()).sum();
        let independent = (bins.count() as f64 / padded).max(1.0);
        let share = along.norm() / power + (noise / power / independent).sqrt();
        (drive >= least).then_some((hz, 20.0 / LN_10 * share.ln_1p()))
    };
    edges.into_iter().zip(drive).filter_map(band).collect()
}

/// Least drive of a band that is driven.
fn driven(drives: &[f64]) -> f64 {
    10f64.powf(0.1 * DRIVEN_DB) * drives.iter().fold(0.0, |most: f64, drive| most.max(*drive))
}

/// Bands of a share of an octave that hold a bin: middle and bins.
fn edges(record: &Record<'_>, share: f64) -> Vec<(f64, RangeInclusive<usize>)> {
    let highest_hz = RANGE_HZ[1].min(0.45 * record.sweep.rate_hz);
    let count = (share * (highest_hz / RANGE_HZ[0]).log2()) as usize;
    let bin = |hz: f64| (hz / record.frequency_hz(1)).ceil() as usize;
    let band = |n: usize| {
        let edge = |n: usize| RANGE_HZ[0] * 2f64.powf(n as f64 / share);
        let bins = bin(edge(n))..=bin(edge(n + 1)) - 1;
        (!bins.is_empty()).then_some((edge(n) * 2f64.powf(0.5 / share), bins))
    };
    (0..count).filter_map(band).collect()
}
