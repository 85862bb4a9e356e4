//! The report of a fit, as JSON for programs and as lines for people.

use super::Options;
use super::places::PlacesReport;
use crate::output;
use asperity_dsp::mode::Mode;
use asperity_fit::Fit;
use asperity_fit::after::scaling::DampingLaw;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// A table's modes with a longer T60 are probably mistakes.
const LONGEST_T60_S: f64 = 60.0;

/// The object of `--json`.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Number of modes found.
    pub modes: usize,
    /// Beginning of the strike, s of the file.
    pub onset_s: f64,
    /// From the onset to where the modes were fitted, s.
    pub start_offset_s: f64,
    /// Recording over residual from where the modes were fitted, dB.
    pub resynthesis_snr_db: f64,
    /// Recording over what the struck body leaves of it, from the onset on, dB.
    pub snr_from_onset_db: f64,
    /// SNR within half an octave of the modes, dB: without rumble and hiss.
    pub snr_in_band_db: f64,
    /// Peak of what the engine plays at the file's own impulse over the recording's, dB.
    pub struck_peak_db: f64,
    /// Noise power, dB re full scale.
    pub noise_floor_db: f64,
    /// Duration of the fit.
    pub seconds: f64,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Number of samples, strikes or modes that each kind of warning is about.
    pub warning_counts: BTreeMap<&'static str, usize>,
    /// α of d = α + β ω², 1/s.
    pub damping_alpha_per_s: Option<f64>,
    /// β, s.
    pub damping_beta_s: Option<f64>,
    /// Residual level in the attack, dB re the recording there.
    pub attack_residual_db: f64,
    /// The five modes with most energy: `[frequency_hz, decay_per_s, amplitude]`.
    pub strongest: Vec<[f64; 3]>,
    /// With `--mesh`: where the strikes were made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub places: Option<PlacesReport>,
}

impl Report {
    /// Adds the warnings of a further recording of the same object.
    pub fn warn_of(&mut self, recording: &Path, fit: &Fit) {
        for warning in &fit.warnings {
            *self.warning_counts.entry(warning.kind()).or_default() += warning.count();
            self.warnings.push(format!("{}: {warning}", recording.display()));
        }
    }

    /// Sums a fit up.
    pub fn new(fit: &Fit, law: Option<DampingLaw>, seconds: f64) -> Self {
        Self {
            modes: fit.modes.len(),
            onset_s: fit.onset_s,
            start_offset_s: fit.start_offset_s,
            resynthesis_snr_db: fit.resynthesis_snr_db,
            snr_from_onset_db: fit.snr_from_onset_db,
            snr_in_band_db: fit.snr_in_band_db,
            struck_peak_db: fit.struck_peak_db,
            noise_floor_db: fit.noise_floor_db,
            seconds,
            warnings: fit.warnings.iter().map(ToString::to_string).collect(),
            warning_counts: fit.warnings.iter().map(|w| (w.kind(), w.count())).collect(),
            damping_alpha_per_s: law.map(|law| law.alpha_per_s),
            damping_beta_s: law.map(|law| law.beta_s),
            attack_residual_db: fit.residual.attack_db,
            strongest: fit
                .modes
                .iter()
                .take(5)
                .map(|m| [m.frequency_hz, m.decay_per_s, m.amplitude])
                .collect(),
            places: None,
        }
    }

    /// Writes for a person.
    pub fn in_words(&self, options: &Options) -> String {
        let mut text = format!(
            "{}: {} modes, {:.1} dB above what they leave, struck {} dB of the recording's peak, onset at {:.4} s, noise {:.0} dB; {:.1} s",
            options.output.display(),
            self.modes,
            self.snr_from_onset_db,
            asperity_plot::decibels(self.struck_peak_db),
            self.onset_s,
            self.noise_floor_db,
            self.seconds
        );
        for [frequency_hz, decay_per_s, amplitude] in &self.strongest {
            let t60_s = 3.0 * std::f64::consts::LN_10 / decay_per_s;
            text += &format!("\n  {frequency_hz:10.2} Hz   T60 {t60_s:7.3} s   amplitude {amplitude:.4}");
        }
        text += &output::warned(&self.warnings);
        text.extend(self.places.iter().flat_map(PlacesReport::lines).map(|line| format!("\n  {line}")));
        text
    }
}

/// The object of `--json` for an imported table.
#[derive(Debug, Serialize)]
pub struct TableReport {
    /// Number of modes imported.
    pub modes: usize,
    /// Strike positions, the first included.
    pub positions: usize,
    /// Warnings.
    pub warnings: Vec<String>,
    /// α of d = α + β ω², 1/s.
    pub damping_alpha_per_s: Option<f64>,
    /// β, s.
    pub damping_beta_s: Option<f64>,
}

impl TableReport {
    /// Sums an import up; `more` strike positions beside the first.
    pub fn new(modes: &[Mode], more: usize, mut warnings: Vec<String>) -> Self {
        let endless = modes.iter().filter(|mode| mode.decay_per_s * LONGEST_T60_S < 6.9).count();
        if endless > 0 {
            warnings.push(format!("{endless} modes ring longer than {LONGEST_T60_S} s"));
        }
        let law = DampingLaw::of(modes);
        Self {
            modes: modes.len(),
            positions: 1 + more,
            warnings,
            damping_alpha_per_s: law.map(|law| law.alpha_per_s),
            damping_beta_s: law.map(|law| law.beta_s),
        }
    }

    /// Writes for a person.
    pub fn in_words(&self, options: &Options) -> String {
        let (modes, positions, warnings) = (self.modes, self.positions, output::warned(&self.warnings));
        format!("{}: {modes} modes, {positions} strike positions{warnings}", options.output.display())
    }
}
