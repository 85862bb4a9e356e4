//! End to end from 60 reports a second: what a path that has to be guessed between reports leaves
//! of what is felt and heard.
//!
//! A hand strokes 90 mm in 0.55 s, speeding up and slowing down (minimum jerk). The reference gets
//! of it 2000 times a second, so that its path is the hand's but for the filter's delay, which both
//! have. On a grating waveforms are compared; on a rough plate, where no tracker has the finger
//! well enough for that, third-octave levels in frames of 100 ms.

use super::cases::{CASES, Case, Chain, FROM_REPORTS, LENGTH_M, SEEDS, STROKE_S, Signal, Take, take};
use super::resampled::after_the_lead_in;
use super::{CaseError, Row, SAMPLE_RATE_HZ};
use crate::error::CliError;
use crate::measure::relative_error;
use asperity::PathMode;
use asperity::files::contact_log::{ContactLog, ContactSample, LogHand, LogLine};
use asperity_fft::{PowerSpectra, hann};
use serde::Serialize;

const REPORT_RATE_HZ: f64 = 60.0;
/// Levels of the reference.
const DENSE_RATE_HZ: f64 = 2_000.0;
const REFERENCE: &str = "the same mode with 2000 reports a second of the same hand: what 60 reports a second cost. On rough ground no path is near enough \
                         for waveforms; there levels count (the table from 60 reports a second)";
/// Length of the hand's way, m.
const REACH_M: f64 = 0.09;
/// Frames in which levels are compared, s.
const FRAME_S: f64 = 0.1;
/// The third octaves compared: from the band at 1 kHz, so many down and up.
const BANDS: std::ops::RangeInclusive<i32> = -12..=3;

/// A path mode on a ground.
#[derive(Debug, Clone, Serialize)]
pub struct Stroke {
    /// Wavelength of the ground.
    pub name: &'static str,
    /// As on the command line.
    pub path: &'static str,
    /// Error of the haptic waveform, dB.
    pub felt_db: f64,
    /// Error of the audio waveform, dB.
    pub heard_db: f64,
    /// Median difference of third-octave levels of what is felt, dB.
    pub felt_levels_db: f64,
    /// Error of the audio, dB.
    pub heard_levels_db: f64,
}

/// The hand's stroke, reported so many times a second.
fn log(case: &Case, rate_hz: f64) -> ContactLog {
    let (begin_s, end_s) = STROKE_S;
    let time_s = end_s - begin_s;
    let samples = (0..(time_s * rate_hz) as usize).map(|report| {
        let since_s = report as f64 / rate_hz;
        let x = since_s / time_s;
        let place_m = REACH_M * x * x * x * (10.0 + x * (6.0 * x - 15.0));
        let velocity_m_s = REACH_M * 30.0 * x * x * (1.0 - x) * (1.0 - x) / time_s;
        let sample = ContactSample {
            uv: [0.1 + place_m / LENGTH_M, 0.5],
            velocity_m_s: Some([velocity_m_s, 0.0]),
            normal_force_n: case.force_n,
            ..ContactSample::default()
        };
        (begin_s + since_s, sample)
    });
    ContactLog { lines: LogLine::contact(1, ("ground", LogHand::felt_by(0)), samples, end_s) }
}

/// Third-octave levels of each frame, dB.
fn levels_db(samples: &[f64]) -> Vec<f64> {
    let frame = (FRAME_S * SAMPLE_RATE_HZ) as usize;
    let spectra = PowerSpectra::new(hann(frame, 0.5), frame);
    let mut levels = Vec::new();
    for part in samples.chunks_exact(frame) {
        let powers = spectra.of(part.iter().copied());
        for band in BANDS {
            let edge = |side: f64| 1000.0 * 2f64.powf((f64::from(band) + side) / 3.0) * FRAME_S;
            let bins = powers.iter().enumerate().take(frame / 2);
            let inside = bins.filter(|(bin, _)| (edge(-0.5)..edge(0.5)).contains(&(*bin as f64)));
            let power: f64 = inside.map(|(_, power)| power).sum();
            levels.push(10.0 * power.max(1e-300).log10());
        }
    }
    levels
}

/// Third-octave levels of a whole, 63 Hz–2 kHz: means over frames of [`FRAME_S`], dB.
pub fn third_octaves_db(samples: &[f64]) -> Vec<f64> {
    let (levels, bands) = (levels_db(samples), BANDS.count());
    let frames = (levels.len() / bands).max(1) as f64;
    let mean =
        |band| levels.iter().skip(band).step_by(bands).map(|db| 10f64.powf(0.1 * db)).sum::<f64>() / frames;
    (0..bands).map(|band| 10.0 * mean(band).max(1e-300).log10()).collect()
}

/// Median difference of levels, dB.
fn median_apart_db(a: &[f64], b: &[f64]) -> f64 {
    let mut apart: Vec<f64> = levels_db(a).iter().zip(levels_db(b)).map(|(a, b)| (a - b).abs()).collect();
    apart.sort_by(f64::total_cmp);
    crate::measure::quantile(&apart, 0.5)
}

/// The path modes on the named cases: each against itself with 2000 reports of the hand a second,
/// so that its delay is taken out.
///
/// # Errors
/// Never but by a defect.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let row = |(name, mode): (&'static str, PathMode)| {
        let chain = Chain { path: Some(mode), ..Chain::default() };
        let cases = CASES.iter().map(|case| {
            let render = |rate_hz| take(case, *SEEDS.start(), &chain, Some(&log(case, rate_hz)));
            let (found, truth) = (render(REPORT_RATE_HZ)?, render(DENSE_RATE_HZ)?);
            let all = after_the_lead_in(truth.audio.len().min(found.audio.len()), SAMPLE_RATE_HZ);
            let error = |signal: Signal| {
                relative_error(
                    found.signal(signal)[all.clone()].iter().copied(),
                    &truth.signal(signal)[all.clone()],
                )
            };
            Ok(CaseError {
                name: case.name,
                displacement: Some(error(Signal::Displacement)),
                contact_force: Some(error(Signal::ContactForce)),
                output: error(Signal::Felt).max(error(Signal::Heard)),
            })
        });
        let cases = cases.collect::<Result<Vec<_>, CliError>>()?;
        let (ns_per_sample, lag_s) = super::path::cost(mode)?;
        let row = Row::on_cases(("path, on the cases", name), ns_per_sample, cases, REFERENCE);
        Ok(Row { latency_ms: Some(1e3 * lag_s), ..row })
    };
    super::path::MODES.into_iter().map(row).collect()
}

/// Measures the path modes that do not wait.
///
/// # Errors
/// Never but by a defect.
pub fn strokes() -> Result<Vec<Stroke>, CliError> {
    let mut strokes = Vec::new();
    for case in &FROM_REPORTS {
        let dense = Chain { path: Some(PathMode::BandLimited), ..Chain::default() };
        let truth = take(case, 1, &dense, Some(&log(case, DENSE_RATE_HZ)))?;
        for (name, path) in [("extrapolate", PathMode::Extrapolate), ("band-limited", PathMode::BandLimited)]
        {
            let chain = Chain { path: Some(path), ..Chain::default() };
            let found = take(case, 1, &chain, Some(&log(case, REPORT_RATE_HZ)))?;
            strokes.push(stroke(case.name, name, &found, &truth));
        }
    }
    Ok(strokes)
}

fn stroke(name: &'static str, path: &'static str, found: &Take, truth: &Take) -> Stroke {
    let all = after_the_lead_in(truth.audio.len().min(found.audio.len()), SAMPLE_RATE_HZ);
    let parts = |signal: Signal| (&found.signal(signal)[all.clone()], &truth.signal(signal)[all.clone()]);
    let waveform_db = |signal| {
        let (found, truth) = parts(signal);
        20.0 * relative_error(found.iter().copied(), truth).log10()
    };
    let apart_db = |signal| {
        let (found, truth) = parts(signal);
        median_apart_db(found, truth)
    };
    Stroke {
        name,
        path,
        felt_db: waveform_db(Signal::Felt),
        heard_db: waveform_db(Signal::Heard),
        felt_levels_db: apart_db(Signal::Felt),
        heard_levels_db: apart_db(Signal::Heard),
    }
}
