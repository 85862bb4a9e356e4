//! The whole analysis of a strike: a recording becomes modes, past the traps of real recordings.
//!
//! mean removed → the best strike chosen ([`crate::recording::onset`]) → analysed from its onset on
//! (`ways`) → what does not ring taken out and doubts named ([`crate::proof::suspicion`]) → held
//! against the recording as the engine will play it ([`mod@crate::body::fitted`]).

use crate::body::fitted::{Fit, Warning};
use crate::options::{FitOptions, Found};
use crate::recording::onset::{self, Strike};
use crate::recording::{FEWEST_SAMPLES, Recording};
use crate::search::limits::LEAST_DECAY_PER_S;
use crate::ways::Sound;

/// Sound shorter than this is warned of, s.
const SHORT_S: f64 = 0.05;
/// Longest analysed part, s; recordings above `UNTRIMMED_S` are trimmed where they reach their
/// noise.
const LONGEST_S: f64 = 40.0;
const UNTRIMMED_S: f64 = 5.0;
/// Why a recording cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitError {
    /// An option outside its range.
    #[error("{field}: {value} is refused; {right}")]
    Option {
        /// Which.
        field: &'static str,
        /// Its value.
        value: f64,
        /// Remedy.
        right: &'static str,
    },
    /// A strike that is not there.
    #[error("{name}: strike {wanted} is not there; the recording has strikes {}", listed(strikes_s))]
    NoSuchStrike {
        /// The recording.
        name: String,
        /// The number asked for.
        wanted: usize,
        /// Times of those that were found, s of the file.
        strikes_s: Vec<f64>,
    },
    /// Nothing is left to analyse.
    #[error("{name}: only {samples} samples follow the onset; {FEWEST_SAMPLES} or more are needed")]
    NothingAfterOnset {
        /// The recording.
        name: String,
        /// Number that follow.
        samples: usize,
    },
}

/// `1 (0.102 s), 2 (0.75 s)`.
fn listed(strikes_s: &[f64]) -> String {
    let strike = |(i, at_s): (usize, &f64)| format!("{} ({at_s:.3} s)", i + 1);
    strikes_s.iter().enumerate().map(strike).collect::<Vec<_>>().join(", ")
}

impl FitOptions {
    fn check(&self, rate_hz: f64) -> Result<(), FitError> {
        let refuse = |field, value, right| Err(FitError::Option { field, value, right });
        if self.max_modes == 0 || self.max_modes > 1000 {
            return refuse("max_modes", self.max_modes as f64, "1 to 1000 would do");
        }
        let (low, high) = self.band_hz;
        if !(low >= 0.0 && low < 0.49 * rate_hz) {
            return refuse("band_hz", low, "a lower edge from 0 to 0.49 of the sample rate would do");
        }
        if high.is_nan() || high <= low {
            return refuse("band_hz", high, "an upper edge above the lower one would do");
        }
        if self.least_level_db.is_nan() || self.least_level_db >= 0.0 {
            return refuse("least_level_db", self.least_level_db, "a negative number of decibels would do");
        }
        if !(self.fastest_decay_per_s > LEAST_DECAY_PER_S && self.fastest_decay_per_s <= 1e5) {
            return refuse("fastest_decay_per_s", self.fastest_decay_per_s, "1 to 100000 would do");
        }
        if let Some(offset) = self.start_offset_s
            && !(0.0..=0.1).contains(&offset)
        {
            return refuse("start_offset_s", offset, "0 to 0.1 s would do");
        }
        Ok(())
    }
}

/// Fits one strike of `recording`; `progress` gets the part done, 0 to 1.
///
/// ```
/// use asperity_fit::{FitOptions, Recording, fit};
///
/// // A bar of one mode, struck after 50 ms.
/// let ring = |n: usize| (n >= 2205).then(|| (n - 2205) as f64 / 44_100.0);
/// let sound = |t: f64| (-12.0 * t).exp() * (std::f64::consts::TAU * 812.0 * t).sin();
/// let samples = (0..44_100).map(|n| ring(n).map_or(0.0, sound)).collect();
/// let recording = Recording::from_samples("bar", samples, 44_100.0)?;
/// let found = fit(&recording, &FitOptions::default(), &mut |_| {})?;
/// assert!((found.modes[0].frequency_hz - 812.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Options out of range, a strike that is not there, or next to nothing after the onset.
pub fn fit(
    recording: &Recording,
    options: &FitOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Fit, FitError> {
    let rate = recording.sample_rate_hz;
    options.check(rate)?;
    let mut warnings = Vec::new();
    let samples = without_mean(&recording.samples, &mut warnings);
    let strike = chosen(&samples, recording, options)?;
    let end = trimmed_end(&samples, strike.onset, strike.end, rate);
    if end - strike.onset < FEWEST_SAMPLES {
        return Err(FitError::NothingAfterOnset {
            name: recording.name.clone(),
            samples: end - strike.onset,
        });
    }
    let found = Found { onset: strike.onset, end };
    warn_of_recording(recording, &strike, &found, &mut warnings);
    let sound = Sound { samples: &samples[found.onset..end], recording, options };
    let (offset, analysis) = match fixed_offset(recording, &found, options) {
        Some(offset) => (offset, sound.analysed_from(offset, progress)),
        None => sound.analysed(progress),
    };
    Ok(Fit::assemble(recording, &samples, found, offset, analysis, options, warnings))
}

/// The strike asked for, or the best.
fn chosen(samples: &[f64], recording: &Recording, options: &FitOptions) -> Result<Strike, FitError> {
    let rate = recording.sample_rate_hz;
    let strikes = onset::find(samples, rate);
    let index = match options.strike {
        None => strikes.best(),
        Some(wanted) if (1..=strikes.onsets.len()).contains(&wanted) => wanted - 1,
        Some(wanted) => {
            let at_s = |&onset: &usize| recording.starts_at_s + onset as f64 / rate;
            let strikes_s = strikes.onsets.iter().map(at_s).collect();
            return Err(FitError::NoSuchStrike { name: recording.name.clone(), wanted, strikes_s });
        }
    };
    Ok(strikes.strike(index))
}

/// The samples less the mean of their last quarter (where a strike is no more).
fn without_mean(samples: &[f64], warnings: &mut Vec<Warning>) -> Vec<f64> {
    let tail = &samples[samples.len() * 3 / 4..];
    let mean = tail.iter().sum::<f64>() / tail.len() as f64;
    let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max((x - mean).abs()));
    if mean.abs() > 0.01 * peak && mean.abs() > 1e-3 {
        warnings.push(Warning::Offset { mean });
    }
    samples.iter().map(|x| x - mean).collect()
}

/// End, where the sound has gone down in the noise for good, and a little after.
fn trimmed_end(samples: &[f64], onset: usize, end: usize, rate: f64) -> usize {
    let end = end.min(onset + (LONGEST_S * rate) as usize);
    if ((end - onset) as f64) < UNTRIMMED_S * rate {
        return end;
    }
    let block = (0.1 * rate) as usize;
    let powers: Vec<f64> = samples[onset..end]
        .chunks_exact(block)
        .map(|c| c.iter().map(|x| x * x).sum::<f64>() / block as f64)
        .collect();
    let mut sorted = powers.clone();
    sorted.sort_by(f64::total_cmp);
    let quiet = sorted[sorted.len() / 10];
    let last = powers.iter().rposition(|&p| p > 1.5 * quiet).unwrap_or(0);
    let kept = (((last + 1) * block) as f64 * 1.2 + 0.5 * rate).max(UNTRIMMED_S * rate) as usize;
    end.min(onset + kept)
}

fn warn_of_recording(recording: &Recording, strike: &Strike, found: &Found, warnings: &mut Vec<Warning>) {
    let rate = recording.sample_rate_hz;
    let runs = recording.clipped_runs();
    if !runs.is_empty() {
        warnings.push(Warning::Clipped { samples: runs.iter().map(|(a, b)| b - a).sum() });
    }
    if recording.truncated {
        warnings.push(Warning::Truncated);
    }
    if !strike.others.is_empty() {
        let at_s = |&onset: &usize| recording.starts_at_s + onset as f64 / rate;
        warnings.push(Warning::SecondStrike {
            taken: strike.number,
            taken_s: at_s(&strike.onset),
            others_s: strike.others.iter().map(at_s).collect(),
        });
    }
    let length_s = (found.end - found.onset) as f64 / rate;
    if length_s < SHORT_S {
        warnings.push(Warning::TooShort { length_s });
    }
    let kept_s = recording.samples.len() as f64 / rate;
    if recording.file_s > kept_s + 1e-3 || kept_s - found.onset as f64 / rate > LONGEST_S {
        let from_s = recording.starts_at_s + found.onset as f64 / rate;
        warnings.push(Warning::PartOfFile { from_s, to_s: from_s + length_s });
    }
}

/// Beginning of free ringing as the user says, or the end of the clipping; `None` finds out.
fn fixed_offset(recording: &Recording, found: &Found, options: &FitOptions) -> Option<usize> {
    let given = options.start_offset_s.map(|offset| (offset * recording.sample_rate_hz).round() as usize);
    let offset = given.or_else(|| clipped_offset(recording, found))?;
    Some(if offset + FEWEST_SAMPLES <= found.end - found.onset { offset } else { 0 })
}

/// From the onset to the end of the clipping, when it is over soon.
fn clipped_offset(recording: &Recording, found: &Found) -> Option<usize> {
    let soon = found.onset + (0.1 * recording.sample_rate_hz) as usize;
    let runs = recording.clipped_runs();
    let last = runs.iter().rev().find(|run| run.0 >= found.onset && run.1 < soon.min(found.end))?;
    let offset = last.1 + 2 - found.onset;
    (offset + FEWEST_SAMPLES < found.end - found.onset).then_some(offset)
}
