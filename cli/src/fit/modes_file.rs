//! `NAME.modes.json` as the fit writes it: what the engine reads, and beside it what a user may
//! ask.

use crate::error::CliError;
use crate::output::Outputs;
use asperity::Residual;
use asperity_dsp::diffuse::DiffuseBand;
use asperity_dsp::mode::Mode;
use asperity_fit::body::residual::Burst;
use asperity_fit::{Fit, FittedMode};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// Contents of a modes file.
#[derive(Serialize)]
pub struct Body<'a> {
    format: &'static str,
    version: u32,
    source: &'a str,
    impulse_n_s: f64,
    modes: Vec<FileMode>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    positions: Vec<Vec<f64>>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    takes: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    fit: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    residual: Option<Residual>,
    #[serde(skip_serializing_if = "Option::is_none")]
    diffuse: Option<asperity::Diffuse>,
}

#[derive(Serialize)]
struct FileMode {
    #[serde(flatten)]
    mode: Mode,
    /// Standard deviations; null where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    std: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    energy: Option<f64>,
}

impl<'a> Body<'a> {
    /// Modes alone.
    pub fn plain(source: &'a str, modes: &[Mode], impulse_n_s: f64) -> Self {
        let modes = modes.iter().map(|mode| FileMode { mode: *mode, std: None, energy: None }).collect();
        let (format, version) = ("asperity.modes", 1);
        let (positions, fit, residual, diffuse) = (Vec::new(), None, None, None);
        Self { format, version, source, impulse_n_s, modes, positions, takes: false, fit, residual, diffuse }
    }

    /// A fit, with `modes` (rescaled ones, perhaps) in the place of its own.
    pub fn fitted(fit: &'a Fit, modes: &[Mode], impulse_n_s: f64) -> Self {
        let modes = modes.iter().zip(&fit.modes).map(|(mode, fitted)| detailed(mode, fitted)).collect();
        Self { modes, fit: Some(details(fit)), ..Self::plain(&fit.source, &[], impulse_n_s) }
    }

    /// With amplitudes at further strike positions.
    pub fn with_positions(mut self, positions: &[Vec<f64>]) -> Self {
        self.positions = positions.to_vec();
        self
    }

    /// Positions that are takes of one blow, where `takes` says so.
    pub fn of_takes(self, takes: bool) -> Self {
        Self { takes, ..self }
    }

    /// With bands of noise, if there are any: then of version 3.
    pub fn with_bands(mut self, bands: &[DiffuseBand]) -> Self {
        if !bands.is_empty() {
            let band = |band: &DiffuseBand| asperity::DiffuseBand {
                centre_hz: band.centre_hz,
                width_hz: band.width_hz,
                parts: band.parts.iter().filter(|part| part.energy > 0.0).copied().collect(),
            };
            let bands = bands.iter().map(band).collect();
            let source = "what the modes leave of the recording".to_owned();
            (self.version, self.diffuse) = (3, Some(asperity::Diffuse { source, bands }));
        }
        self
    }

    /// With a residual that impacts play.
    pub fn with_burst(mut self, burst: Option<Burst>) -> Self {
        self.residual = burst.map(|burst| Residual {
            sample_rate_hz: burst.sample_rate_hz,
            samples: burst.samples.iter().map(|&x| x as f32).collect(),
        });
        self
    }
}

/// Figures of the recording and of what the modes leave of it.
fn details(fit: &Fit) -> Value {
    json!({
        "sample_rate_hz": fit.sample_rate_hz,
        "onset_s": fit.onset_s,
        "start_offset_s": fit.start_offset_s,
        "end_s": fit.end_s,
        "noise_floor_db": fit.noise_floor_db,
        "resynthesis_snr_db": fit.resynthesis_snr_db,
        "residual": {
            "level_db": fit.residual.level_db,
            "attack_db": fit.residual.attack_db,
            "step_s": asperity_fit::body::residual::STEP_S,
            "bands": fit.residual.bands,
        },
    })
}

/// Writes a modes file; a body that the engine would refuse is none.
pub fn write(outputs: &mut Outputs, path: &Path, body: &Body<'_>) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(body).map_err(CliError::from_error)?;
    let refused = |error| CliError::from_error(error).within(path.display());
    asperity::ModalModel::parse(&text).map_err(refused)?;
    outputs.write(path, text.as_bytes())
}

fn detailed(mode: &Mode, fitted: &FittedMode) -> FileMode {
    // A rescaled mode's deviations scale with it.
    let (f, d) = (mode.frequency_hz / fitted.frequency_hz, mode.decay_per_s / fitted.decay_per_s.max(1e-12));
    let std = json!({
        "frequency_hz": fitted.frequency_std_hz * f,
        "decay_per_s": fitted.decay_std_per_s * d,
        "amplitude": fitted.amplitude_std,
        "phase_rad": fitted.phase_std_rad,
    });
    FileMode { mode: *mode, std: Some(std), energy: Some(fitted.energy) }
}
