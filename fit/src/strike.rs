//! From a recording to modes: the whole way, with the traps of real recordings.
//!
//! mean removed → strike found ([`crate::onset`]) → end of the contact found ([`crate::contact`]; 1 ms of
//! half-sine force: 27 dB with it in the analysed part, 75 dB without) → analysed from there on
//! ([`crate::analysis`]) → hum and non-exponential decays named → residual.

use crate::analysis::{Analysis, analyse};
use crate::contact::{contact_samples, rise, unexplained};
use crate::fitted::{Fit, FittedMode, LEAST_DECAY_PER_S, Warning};
use crate::limits::Limits;
use crate::noise_floor::NoiseFloor;
use crate::onset;
use crate::partial::Partial;
use crate::projection::synthesise;
use crate::pruning::uncertainties;
use crate::recording::{FEWEST_SAMPLES, Recording};
use crate::refinement::Bounds;
use crate::residual::{Residual, ratio_db};
use std::f64::consts::PI;

/// Sound shorter than this is warned of, s.
const SHORT_S: f64 = 0.05;
/// Longest analysed part, s; recordings above `UNTRIMMED_S` are trimmed where they reach their noise.
const LONGEST_S: f64 = 40.0;
const UNTRIMMED_S: f64 = 5.0;
/// Largest amplitude of a mode, in peaks of the recording.
const LARGEST_AMPLITUDE: f64 = 8.0;

/// Lowest frequency analysed unless a lower one is asked for, Hz.
const LOWEST_HZ: f64 = 20.0;
/// A mode that falls by more nepers than this during the contact is not known at the onset: it is part of
/// the attack.
const BACK_NEPERS: f64 = 3.0;

/// What a fit may find and how.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Most modes.
    pub max_modes: usize,
    /// Lowest and highest frequency, Hz; the upper one is also bounded by 0.49 of the rate.
    pub band_hz: (f64, f64),
    /// Modes whose energy lies further than this below the strongest one's are dropped, dB (negative).
    pub least_level_db: f64,
    /// Fastest decay, 1/s.
    pub fastest_decay_per_s: f64,
    /// From the onset to where modes are fitted, s; `None` finds out.
    pub start_offset_s: Option<f64>,
    /// Threads for the bands; 0 takes what the machine has, up to 8.
    pub threads: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            max_modes: 150,
            band_hz: (20.0, f64::INFINITY),
            least_level_db: -90.0,
            fastest_decay_per_s: 1500.0,
            start_offset_s: None,
            threads: 0,
        }
    }
}

/// Why a recording cannot be fitted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// An option outside its range.
    #[error("{field}: {value} is refused; {right}")]
    Option {
        /// Which.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What would be right.
        right: &'static str,
    },
    /// Nothing is left to analyse.
    #[error("{name}: only {samples} samples follow the onset; {FEWEST_SAMPLES} or more are needed")]
    NothingAfterOnset {
        /// The recording.
        name: String,
        /// How many follow.
        samples: usize,
    },
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

/// Fits the first strike of `recording`; `progress` hears the part done, 0 to 1.
///
/// # Errors
/// Options out of range, or next to nothing after the onset.
pub fn fit(
    recording: &Recording,
    options: &FitOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Fit, FitError> {
    let rate = recording.sample_rate_hz;
    options.check(rate)?;
    let mut warnings = Vec::new();
    let samples = without_mean(&recording.samples, &mut warnings);
    let strike = onset::find(&samples, rate);
    let end = trimmed_end(&samples, strike.onset, strike.end, rate);
    if end - strike.onset < FEWEST_SAMPLES {
        return Err(FitError::NothingAfterOnset {
            name: recording.name.clone(),
            samples: end - strike.onset,
        });
    }
    let found = Found { onset: strike.onset, end };
    warn_of_recording(recording, &strike.others, &found, &mut warnings);
    let mut offset = start_offset(&samples, &found, recording, options);
    let strike = &samples[found.onset..end];
    let mut analysis = analyse_from(strike, offset, recording, options, progress);
    if offset > 0 && options.start_offset_s.is_none() && clipped_offset(recording, &found).is_none() {
        let early: Vec<Partial> = analysis.partials.iter().map(|p| p.moved(-(offset as f64))).collect();
        let left = unexplained(
            strike,
            &synthesise(&early, 2 * offset),
            offset,
            rate,
            analysis.noise.mean_variance(),
        );
        if left < offset {
            offset = left;
            analysis = analyse_from(strike, offset, recording, options, progress);
        }
    }
    Ok(assemble(recording, &samples, &found, offset, analysis, options, warnings))
}

/// The modes of what follows the first `offset` samples of `strike`.
fn analyse_from(
    strike: &[f64],
    offset: usize,
    recording: &Recording,
    options: &FitOptions,
    progress: &mut dyn FnMut(f64),
) -> Analysis {
    let segment = &strike[offset..];
    let mut limits = limits(segment, recording, options);
    if offset > 0 {
        limits.bounds.delta_high = limits.bounds.delta_high.min(BACK_NEPERS / offset as f64);
    }
    analyse(segment, &limits, progress)
}

/// The analysed part, in samples of the recording.
struct Found {
    onset: usize,
    end: usize,
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

/// Where the sound has gone down in the noise for good, and a little after.
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

fn warn_of_recording(recording: &Recording, others: &[usize], found: &Found, warnings: &mut Vec<Warning>) {
    let rate = recording.sample_rate_hz;
    let runs = recording.clipped_runs();
    if !runs.is_empty() {
        warnings.push(Warning::Clipped { samples: runs.iter().map(|(a, b)| b - a).sum() });
    }
    if recording.truncated {
        warnings.push(Warning::Truncated);
    }
    for &other in others {
        warnings.push(Warning::SecondStrike { at_s: recording.starts_at_s + other as f64 / rate });
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

/// From the onset to where it rings freely: after the clipping, or after the striker has let go.
fn start_offset(samples: &[f64], found: &Found, recording: &Recording, options: &FitOptions) -> usize {
    let rate = recording.sample_rate_hz;
    let strike = &samples[found.onset..found.end];
    let offset = match (options.start_offset_s, clipped_offset(recording, found)) {
        (Some(offset), _) => (offset * rate).round() as usize,
        (None, Some(after)) => after,
        (None, None) => {
            let noise = NoiseFloor::estimate(strike, rate, recording.quantum.powi(2) / 12.0);
            contact_samples(strike, rate, noise.mean_variance())
        }
    };
    if offset + FEWEST_SAMPLES <= strike.len() { offset } else { 0 }
}

/// From the onset to the end of the clipping, when it is over soon.
fn clipped_offset(recording: &Recording, found: &Found) -> Option<usize> {
    let soon = found.onset + (0.1 * recording.sample_rate_hz) as usize;
    let runs = recording.clipped_runs();
    let last = runs.iter().rev().find(|run| run.0 >= found.onset && run.1 < soon.min(found.end))?;
    let offset = last.1 + 2 - found.onset;
    (offset + FEWEST_SAMPLES < found.end - found.onset).then_some(offset)
}

fn limits(segment: &[f64], recording: &Recording, options: &FitOptions) -> Limits {
    let rate = recording.sample_rate_hz;
    let peak = segment.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    // Modes outside the band are found as well, or what they leave would be taken for noise in it.
    let low = options.band_hz.0.min(LOWEST_HZ);
    Limits {
        bounds: Bounds {
            omega_low: 2.0 * PI * low.max(1.0) / rate,
            omega_high: 2.0 * PI * 0.49,
            // An undamped tone is fitted as it is; only what is written down must die some day.
            delta_low: 1e-3 * LEAST_DECAY_PER_S / rate,
            delta_high: options.fastest_decay_per_s / rate,
            amplitude_high: LARGEST_AMPLITUDE * peak,
            energy_cost: 0.0,
        },
        max_partials: options.max_modes,
        least_energy: 10.0_f64.powf(0.1 * options.least_level_db),
        threads: match options.threads {
            0 => std::thread::available_parallelism().map_or(1, |n| n.get().min(8)),
            n => n,
        },
        rate_hz: rate,
        // Rounding of the file, and of what rendered it: 120 dB under the peak.
        least_noise: (recording.quantum.powi(2) / 12.0).max(1e-12 * peak * peak),
    }
}

fn assemble(
    recording: &Recording,
    samples: &[f64],
    found: &Found,
    offset: usize,
    analysis: Analysis,
    options: &FitOptions,
    mut warnings: Vec<Warning>,
) -> Fit {
    let rate = recording.sample_rate_hz;
    let (onset, end) = (found.onset, found.end);
    let mut partials = analysis.partials;
    let count = end - onset - offset;
    let peak = samples[onset..end].iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let sane = |p: &Partial| p.moved(-(offset as f64)).c.norm() <= LARGEST_AMPLITUDE * peak;
    partials.retain(sane);
    let (low, high) = options.band_hz;
    partials.retain(|p| (low..=high).contains(&(p.omega * rate / (2.0 * PI))));
    warnings.extend(crate::suspicion::take_hum(&mut partials, count, rate));
    warnings.extend(crate::suspicion::doubts(&partials, &analysis.residual, &analysis.noise, rate));
    let mut modes: Vec<FittedMode> = uncertainties(&partials, &analysis.noise, count)
        .iter()
        .zip(&partials)
        .map(|(uncertainty, partial)| FittedMode::new(partial, uncertainty, offset, count, rate))
        .collect();
    modes.sort_by(|a, b| b.energy.total_cmp(&a.energy));
    if modes.is_empty() {
        warnings.push(Warning::NoModes);
    }
    if analysis.capped {
        warnings.push(Warning::ModesCapped { limit: options.max_modes });
    }
    let early: Vec<Partial> = partials.iter().map(|p| p.moved(-(offset as f64))).collect();
    let mut ringing = synthesise(&early, samples.len() - onset);
    rise(&mut ringing, offset);
    let mut left = samples.to_vec();
    left[onset..].iter_mut().zip(&ringing).for_each(|(left, ringing)| *left -= ringing);
    let snr = |from: usize| -ratio_db(&left[from..end], &samples[from..end]);
    let resynthesis_snr_db = snr(onset + offset);
    let snr_from_onset_db = snr(onset);
    if !modes.is_empty() && resynthesis_snr_db < 6.0 {
        warnings.push(Warning::PoorFit { snr_db: resynthesis_snr_db });
    }
    Fit {
        modes,
        source: recording.name.clone(),
        sample_rate_hz: rate,
        onset_s: recording.starts_at_s + onset as f64 / rate,
        onset_sample: onset,
        start_offset_s: offset as f64 / rate,
        end_s: recording.starts_at_s + end as f64 / rate,
        noise_floor_db: 10.0 * analysis.noise.mean_variance().max(1e-30).log10(),
        resynthesis_snr_db,
        snr_from_onset_db,
        residual: Residual::new(left, samples, onset, end, rate),
        warnings,
    }
}
