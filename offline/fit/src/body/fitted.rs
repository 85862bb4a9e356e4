//! The result of a fit: modes with their standard deviations, and figures of the rest.
//!
//! Everything that is said of the modes is said of the *struck body*: of what the engine plays when
//! the modes file is struck once by its own impulse, which is Σ amplitude · e^(−d t) · sin(2π f t +
//! φ) from the onset on and nothing else.

use crate::body::diffuse;
use crate::body::residual::{Burst, Residual, ratio_db};
use crate::body::solved::{Solved, Solving};
use crate::body::struck::struck;
use crate::options::{FitOptions, Found, LARGEST_AMPLITUDE};
use crate::proof::pruning::{Uncertainty, uncertainties};
use crate::proof::rumble::take_rumble;
use crate::proof::suspicion::{self, energy_spectrum};
pub use crate::proof::warning::Warning;
use crate::recording::Recording;
use crate::sinusoid::partial::Partial;
use crate::ways::analysis::Analysis;
use asperity_dsp::diffuse::DiffuseBand;
use asperity_dsp::mode::Mode;
use std::f64::consts::PI;

/// One mode of the struck body as the recording shows it:
/// `amplitude · e^(−decay_per_s t) · sin(2π frequency_hz t + phase_rad)`, t from the onset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedMode {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Decay rate, 1/s.
    pub decay_per_s: f64,
    /// Amplitude at the onset, full scale 1.
    pub amplitude: f64,
    /// Phase at the onset, −π to π.
    pub phase_rad: f64,
    /// Standard deviation of `frequency_hz`.
    pub frequency_std_hz: f64,
    /// Standard deviation of `decay_per_s`.
    pub decay_std_per_s: f64,
    /// Standard deviation of `amplitude`.
    pub amplitude_std: f64,
    /// Standard deviation of `phase_rad`.
    pub phase_std_rad: f64,
    /// Energy in the analysed part: ∫ y² dt, s.
    pub energy: f64,
}

impl FittedMode {
    /// The engine's mode.
    #[must_use]
    pub fn mode(&self) -> Mode {
        Mode {
            frequency_hz: self.frequency_hz,
            decay_per_s: self.decay_per_s,
            amplitude: self.amplitude,
            phase_rad: self.phase_rad,
        }
    }

    /// From a partial whose amplitude stands `offset` samples after the onset.
    pub(crate) fn new(
        partial: &Partial,
        uncertainty: &Uncertainty,
        offset: usize,
        count: usize,
        rate_hz: f64,
    ) -> Self {
        let at_onset = partial.moved(-(offset as f64));
        let growth = at_onset.c.norm() / partial.c.norm().max(1e-300);
        Self {
            frequency_hz: partial.omega * rate_hz / (2.0 * PI),
            decay_per_s: partial.delta * rate_hz,
            amplitude: at_onset.c.norm(),
            // Re(c z^n) is a cosine.
            phase_rad: wrapped(at_onset.c.arg() + 0.5 * PI),
            frequency_std_hz: uncertainty.omega * rate_hz / (2.0 * PI),
            decay_std_per_s: uncertainty.delta * rate_hz,
            amplitude_std: uncertainty.amplitude * growth,
            phase_std_rad: uncertainty.phase,
            energy: partial.energy(count) / rate_hz,
        }
    }
}

fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

/// A fitted recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The modes, most energy first.
    pub modes: Vec<FittedMode>,
    /// Name of the recording.
    pub source: String,
    /// Sample rate, Hz.
    pub sample_rate_hz: f64,
    /// Beginning of the strike, s of the file.
    pub onset_s: f64,
    /// First sample of the strike in the recording.
    pub onset_sample: usize,
    /// From the onset to where the modes were fitted: what comes before is contact, s.
    pub start_offset_s: f64,
    /// End of the analysed part, s of the file.
    pub end_s: f64,
    /// Noise power, dB re full scale.
    pub noise_floor_db: f64,
    /// Recording over residual from `onset_s` + `start_offset_s` to `end_s`, dB.
    pub resynthesis_snr_db: f64,
    /// SNR from the onset on, the contact included: all that the engine plays.
    pub snr_from_onset_db: f64,
    /// SNR within the band of the modes, half an octave around: without a rumble or a hiss that is
    /// no business of the modes.
    pub snr_in_band_db: f64,
    /// Peak of the struck body over the recording's, dB.
    pub struck_peak_db: f64,
    /// Residual of the modes.
    pub residual: Residual,
    /// Warnings.
    pub warnings: Vec<Warning>,
}

/// A warning of the mode limit is true where at least this part of the places is taken.
const TAKEN: f64 = 0.95;
/// Below this resynthesis, dB, a user should know.
const POOR_DB: f64 = 6.0;
/// The band of the modes reaches this far beyond the lowest and the highest, as a factor.
const HALF_OCTAVE: f64 = std::f64::consts::SQRT_2;

impl Fit {
    /// Result of `analysis`, whose partials stand `offset` samples after the onset. `samples`: the
    /// recording without its mean.
    pub(crate) fn assemble(
        recording: &Recording,
        samples: &[f64],
        found: Found,
        offset: usize,
        analysis: Analysis,
        options: &FitOptions,
        mut warnings: Vec<Warning>,
    ) -> Self {
        let rate = recording.sample_rate_hz;
        let Found { onset, end } = found;
        let sound = &samples[onset..end];
        let count = end - onset - offset;
        let mut partials = analysis.partials;
        partials.retain(|p| p.moved(-(offset as f64)).c.norm() <= LARGEST_AMPLITUDE * peak(sound));
        let (low, high) = options.band_hz;
        partials.retain(|p| (low..=high).contains(&(p.omega * rate / (2.0 * PI))));
        let strongest = partials.iter().map(|p| p.energy(count)).fold(0.0, f64::max);
        let least = strongest * 10.0_f64.powf(0.1 * options.least_level_db);
        partials.retain(|p| p.energy(count) >= least);
        warnings.extend(suspicion::remove_undamped(&mut partials, count, rate));
        if !analysis.explained {
            let left: f64 = analysis.residual.iter().map(|x| x * x).sum();
            warnings.extend(take_rumble(&mut partials, count, left, rate));
        }
        let solving = Solving {
            samples,
            found: Found { onset, end },
            offset,
            noise: &analysis.noise,
            rate_hz: rate,
            as_is: analysis.explained || offset > 0,
        };
        let any = !partials.is_empty();
        let (Solved { partials, early, lead, .. }, further) = solving.solved(partials);
        warnings.extend(further);
        warnings.extend(suspicion::doubts(&partials, &analysis.residual, &analysis.noise, rate));
        // The strike itself, from which times are counted now.
        let (contact, onset, offset) = (offset, onset - lead, offset + lead);
        let sound = &samples[onset..end];
        let struck = struck(&early, samples.len() - onset);
        let mut left = samples.to_vec();
        left[onset..].iter_mut().zip(&struck).for_each(|(left, struck)| *left -= struck);
        let snr = |from: usize| -ratio_db(&left[from..end], &samples[from..end]);
        let resynthesis_snr_db = snr(onset + offset);
        let snr_from_onset_db = snr(onset);
        let struck_peak_db = 20.0 * (peak(&struck[..end - onset]).max(1e-15) / peak(sound)).log10();
        let snr_in_band_db = in_band_snr_db(sound, &left[onset..end], &partials);
        let mut modes: Vec<FittedMode> = uncertainties(&partials, &analysis.noise, count)
            .iter()
            .zip(&partials)
            .map(|(uncertainty, partial)| FittedMode::new(partial, uncertainty, offset, count, rate))
            .collect();
        modes.sort_by(|a, b| b.energy.total_cmp(&a.energy));
        if modes.is_empty() && !any {
            warnings.push(Warning::NoModes);
        } else if snr_in_band_db < POOR_DB {
            warnings.push(Warning::PoorFit { snr_db: snr_in_band_db });
        }
        if analysis.capped && modes.len() as f64 >= TAKEN * options.max_modes as f64 {
            warnings.push(Warning::ModesCapped { limit: options.max_modes });
        }
        Self {
            modes,
            source: recording.name.clone(),
            sample_rate_hz: rate,
            onset_s: recording.starts_at_s + onset as f64 / rate,
            onset_sample: onset,
            start_offset_s: contact as f64 / rate,
            end_s: recording.starts_at_s + end as f64 / rate,
            noise_floor_db: 10.0 * analysis.noise.mean_variance().max(1e-30).log10(),
            resynthesis_snr_db,
            snr_from_onset_db,
            snr_in_band_db,
            struck_peak_db,
            residual: Residual::new(left, samples, onset, end, rate),
            warnings,
        }
    }

    /// The struck body from the onset on, `count` samples.
    #[must_use]
    pub fn resynthesise(&self, count: usize) -> Vec<f64> {
        let partials: Vec<Partial> =
            self.modes.iter().map(|mode| partial_of(&mode.mode(), self.sample_rate_hz)).collect();
        struck(&partials, count)
    }

    /// The first `length_s` of the residual after the onset, faded out: what a body plays at an
    /// impact.
    #[must_use]
    pub fn burst(&self, length_s: f64) -> Burst {
        Burst::new(&self.residual.samples[self.onset_sample..], length_s, self.sample_rate_hz)
    }

    /// Bands of noise for what the modes leave, as the answer to the recorded strike.
    #[must_use]
    pub fn diffuse(&self) -> Vec<DiffuseBand> {
        let struck = self.resynthesis();
        let recorded: Vec<f64> = self.residual.samples.iter().zip(&struck).map(|(a, b)| a + b).collect();
        let begin_s = self.onset_s - self.onset_sample as f64 / self.sample_rate_hz;
        let end = (((self.end_s - begin_s) * self.sample_rate_hz) as usize).min(recorded.len());
        let strike = self.onset_sample.min(end)..end;
        diffuse::bands(&recorded[strike.clone()], &struck[strike], &recorded, self.sample_rate_hz)
    }

    /// The modes in the place of the strike, as long as the recording.
    #[must_use]
    pub fn resynthesis(&self) -> Vec<f64> {
        let mut samples = vec![0.0; self.onset_sample];
        samples.extend(self.resynthesise(self.residual.samples.len() - self.onset_sample));
        samples
    }
}

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |peak, x| peak.max(x.abs()))
}

/// Recording over residual within the band of `partials`, dB; 0 where there are none.
fn in_band_snr_db(sound: &[f64], left: &[f64], partials: &[Partial]) -> f64 {
    let (low, high) = partials
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), p| (low.min(p.omega), high.max(p.omega)));
    let spectrum = energy_spectrum(sound);
    let bin = |omega: f64| ((omega / PI).min(1.0) * spectrum.len() as f64) as usize;
    let (from, to) = (bin(low / HALF_OCTAVE), bin(high * HALF_OCTAVE));
    if from >= to {
        return 0.0;
    }
    let energy = |spectrum: &[f64]| spectrum[from..to].iter().sum::<f64>().max(1e-300);
    (10.0 * (energy(&spectrum) / energy(&energy_spectrum(left))).log10()).clamp(-300.0, 300.0)
}

/// A mode at a sample rate.
#[must_use]
pub fn partial_of(mode: &Mode, rate_hz: f64) -> Partial {
    Partial {
        omega: 2.0 * PI * mode.frequency_hz / rate_hz,
        delta: mode.decay_per_s / rate_hz,
        c: nalgebra::Complex::from_polar(mode.amplitude, mode.phase_rad - 0.5 * PI),
    }
}
