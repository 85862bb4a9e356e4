//! The modes of a body and the file they come in, `NAME.modes.json`.
//!
//! y(t) = Σ amplitude · e^(−decay_per_s · t) · sin(2π · frequency_hz · t + phase_rad) is the response
//! to an impulse of `impulse_n_s`; the engine scales linearly, so an impulse J sounds as
//! y · J / `impulse_n_s` (Hasti §III-D).

use crate::model::mode_shapes::ModeShapes;
use crate::model::residual::Residual;
use asperity_dsp::modal_bank::{self, Culling};
use asperity_dsp::mode::Mode;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The `format` field of a modes file.
pub const FORMAT: &str = "asperity.modes";
/// The `version` this crate reads and writes.
pub const VERSION: u32 = 1;
/// The version that has shapes beside the modes ([`ModeShapes`]); its modes play as those of version 1 do.
pub const VERSION_WITH_SHAPES: u32 = 2;
/// Most modes a body may have.
pub const MAX_MODES: usize = 65_536;

/// Validated modes of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalModel {
    /// What was recorded or where the modes come from; free text.
    pub source: String,
    /// The strike that `modes` is the answer to, N·s.
    pub impulse_n_s: f64,
    /// The modes, in any order.
    pub modes: Vec<Mode>,
    /// Amplitudes when the body is struck elsewhere: strike position 1, 2, … (at most
    /// [`MAX_POSITIONS`] − 1), each with one amplitude for every mode. Position 0 is `modes` itself.
    pub positions: Vec<Vec<f64>>,
    /// What the strike had besides modes, played at every impact.
    pub residual: Option<Residual>,
}

/// Most strike positions a body may have, the first included.
pub const MAX_POSITIONS: usize = modal_bank::MAX_INPUTS;

/// Why a modes file was refused.
#[derive(Debug, thiserror::Error)]
pub enum ModalModelError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); give a readable modes file", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is not JSON of this shape.
    #[error("{}: {message}; must be JSON with format \"asperity.modes\", version 1 or 2 and a list \"modes\"", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong and where.
        message: String,
    },
    /// A number that no body can have.
    #[error("{field}: {value:?} is refused; must be {expected}")]
    BadValue {
        /// Which field of which mode.
        field: String,
        /// Its value.
        value: f64,
        /// What would be accepted.
        expected: &'static str,
    },
}

#[derive(Serialize, Deserialize)]
struct File {
    format: String,
    version: u32,
    #[serde(default)]
    source: String,
    #[serde(default = "one")]
    impulse_n_s: f64,
    modes: Vec<FileMode>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    positions: Vec<Vec<f64>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    residual: Option<Residual>,
    #[serde(default, skip_serializing)]
    shapes: Option<ModeShapes>,
}

#[derive(Serialize, Deserialize)]
struct FileMode {
    frequency_hz: f64,
    decay_per_s: f64,
    amplitude: f64,
    #[serde(default)]
    phase_rad: f64,
}

fn one() -> f64 {
    1.0
}

impl ModalModel {
    /// A model from modes that are the answer to an impulse of `impulse_n_s`.
    ///
    /// # Errors
    /// When a mode grows, has no frequency, or a number is not finite.
    pub fn new(modes: Vec<Mode>, impulse_n_s: f64) -> Result<Self, ModalModelError> {
        let model = Self { source: String::new(), impulse_n_s, modes, positions: Vec::new(), residual: None };
        model.check()?;
        Ok(model)
    }

    /// A body without modes, which nobody hears.
    #[must_use]
    pub fn silent() -> Self {
        Self {
            source: String::new(),
            impulse_n_s: 1.0,
            modes: Vec::new(),
            positions: Vec::new(),
            residual: None,
        }
    }

    /// The same model, every answer `gain` times as strong.
    ///
    /// # Errors
    /// When an amplitude leaves ±1e9.
    pub fn with_gain(mut self, gain: f64) -> Result<Self, ModalModelError> {
        self.modes.iter_mut().for_each(|mode| mode.amplitude *= gain);
        self.positions.iter_mut().flatten().for_each(|amplitude| *amplitude *= gain);
        if let Some(residual) = &mut self.residual {
            residual.samples.iter_mut().for_each(|x| *x = (f64::from(*x) * gain) as f32);
        }
        self.check()?;
        Ok(self)
    }

    /// Reads `NAME.modes.json`.
    ///
    /// # Errors
    /// When the file cannot be read, is not a modes file of version 1 or 2, or holds a number that no body
    /// can have.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ModalModelError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|source| match source.kind() {
            ErrorKind::InvalidData => {
                let remedy = "is no text; `asperity fit` makes a modes file of a recording";
                ModalModelError::Malformed { path: path.into(), message: remedy.into() }
            }
            _ => ModalModelError::Unreadable { path: path.into(), source },
        })?;
        Self::parse(&text).map_err(|error| match error {
            ModalModelError::Malformed { message, .. } => {
                ModalModelError::Malformed { path: path.into(), message }
            }
            ModalModelError::BadValue { field, value, expected } => {
                ModalModelError::BadValue { field: format!("{}: {field}", path.display()), value, expected }
            }
            other => other,
        })
    }

    /// Reads the text of a modes file.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str) -> Result<Self, ModalModelError> {
        let malformed = |message: String| ModalModelError::Malformed { path: "modes".into(), message };
        let file: File = serde_json::from_str(text).map_err(|error| malformed(error.to_string()))?;
        if file.format != FORMAT {
            return Err(malformed(format!("format is \"{}\"", file.format)));
        }
        match (&file.shapes, file.version) {
            (None, VERSION | VERSION_WITH_SHAPES) => {}
            (Some(shapes), VERSION_WITH_SHAPES) => shapes.check(file.modes.len()).map_err(malformed)?,
            (Some(_), VERSION) => return Err(malformed("shapes stand in version 1; need version 2".into())),
            _ => return Err(malformed(format!("version is {}", file.version))),
        }
        let modes = file
            .modes
            .iter()
            .map(|m| Mode {
                frequency_hz: m.frequency_hz,
                decay_per_s: m.decay_per_s,
                amplitude: m.amplitude,
                phase_rad: m.phase_rad,
            })
            .collect();
        let File { source, impulse_n_s, positions, residual, .. } = file;
        let model = Self { source, impulse_n_s, modes, positions, residual };
        model.check()?;
        Ok(model)
    }

    /// The text of the modes file; numbers round-trip.
    #[must_use]
    pub fn to_json(&self) -> String {
        let modes: Vec<_> = self
            .modes
            .iter()
            .map(|m| FileMode {
                frequency_hz: m.frequency_hz,
                decay_per_s: m.decay_per_s,
                amplitude: m.amplitude,
                phase_rad: m.phase_rad,
            })
            .collect();
        let file = File {
            format: FORMAT.into(),
            version: VERSION,
            source: self.source.clone(),
            impulse_n_s: self.impulse_n_s,
            modes,
            positions: self.positions.clone(),
            residual: self.residual.clone(),
            shapes: None,
        };
        serde_json::to_string(&file).unwrap_or_default()
    }

    /// The same model with more strike positions: one amplitude for every mode in each list.
    ///
    /// # Errors
    /// When a list is not as long as the modes, a number is not finite, or there are too many.
    pub fn with_positions(mut self, positions: Vec<Vec<f64>>) -> Result<Self, ModalModelError> {
        self.positions = positions;
        self.check()?;
        Ok(self)
    }

    /// The same model with what a strike has besides its modes; `gain` scales it, 0 leaves it out.
    ///
    /// # Errors
    /// When the burst is longer than [`LONGEST_S`](crate::model::residual::LONGEST_S) or holds no finite numbers.
    pub fn with_residual(mut self, residual: Option<Residual>, gain: f64) -> Result<Self, ModalModelError> {
        self.residual = residual.filter(|_| gain != 0.0).map(|mut residual| {
            residual.samples.iter_mut().for_each(|x| *x = (f64::from(*x) * gain) as f32);
            residual
        });
        self.check()?;
        Ok(self)
    }

    /// How many strike positions there are, the first included.
    #[must_use]
    pub fn position_count(&self) -> usize {
        1 + self.positions.len()
    }

    /// The model without the modes that nobody can hear at `sample_rate_hz`, wherever it is struck.
    #[must_use]
    pub fn audible(&self, sample_rate_hz: f64, culling: &Culling) -> Self {
        let mut keep = vec![false; self.modes.len()];
        let mut audible = vec![false; self.modes.len()];
        // Slow decays first: maskers come before what they mask.
        let mut order: Vec<usize> = (0..self.modes.len()).collect();
        order.sort_by(|&a, &b| self.modes[a].decay_per_s.total_cmp(&self.modes[b].decay_per_s));
        for position in 0..self.position_count() {
            let at: Vec<_> = self.modes_at(position).collect();
            let sorted: Vec<_> = order.iter().map(|&i| at[i]).collect();
            modal_bank::audible(&sorted, sample_rate_hz, culling, &mut audible);
            order.iter().zip(&audible).for_each(|(&i, audible)| keep[i] |= audible);
        }
        let kept = |i: &usize| keep[*i];
        Self {
            modes: (0..self.modes.len()).filter(kept).map(|i| self.modes[i]).collect(),
            positions: self
                .positions
                .iter()
                .map(|amplitudes| (0..amplitudes.len()).filter(kept).map(|i| amplitudes[i]).collect())
                .collect(),
            source: self.source.clone(),
            impulse_n_s: self.impulse_n_s,
            residual: self.residual.clone(),
        }
    }

    /// The modes as they answer a strike at a position.
    fn modes_at(&self, position: usize) -> impl Iterator<Item = Mode> + '_ {
        let elsewhere = position.checked_sub(1).and_then(|i| self.positions.get(i));
        self.modes.iter().enumerate().map(move |(i, mode)| {
            let amplitude = elsewhere.and_then(|a| a.get(i)).copied().unwrap_or(mode.amplitude);
            Mode { amplitude, ..*mode }
        })
    }

    /// The modes for an impulse of 1 N·s, each at the position where it answers most, and its share of
    /// that (−1 to 1) at every position.
    pub(crate) fn unit_modes(&self) -> impl Iterator<Item = (Mode, [f32; MAX_POSITIONS])> + '_ {
        (0..self.modes.len()).map(|i| {
            let mode = self.modes[i];
            let at = |p: usize| if p == 0 { mode.amplitude } else { self.positions[p - 1][i] };
            let most = (0..self.position_count()).map(at).max_by(|a, b| a.abs().total_cmp(&b.abs()));
            let most = most.unwrap_or(mode.amplitude);
            let share =
                |p| if p < self.position_count() && most != 0.0 { (at(p) / most) as f32 } else { 0.0 };
            (Mode { amplitude: most / self.impulse_n_s, ..mode }, std::array::from_fn(share))
        })
    }

    fn check(&self) -> Result<(), ModalModelError> {
        let refuse =
            |field: String, value: f64, expected| ModalModelError::BadValue { field, value, expected };
        let in_range = |value: f64, low: f64, high: f64| value >= low && value <= high;
        if !in_range(self.impulse_n_s, 1e-12, 1e6) {
            return Err(refuse("impulse_n_s".into(), self.impulse_n_s, "1e-12–1e6 N·s"));
        }
        if self.modes.len() > MAX_MODES {
            return Err(refuse("modes".into(), self.modes.len() as f64, "at most 65536 modes"));
        }
        if self.positions.len() >= MAX_POSITIONS {
            return Err(refuse("positions".into(), self.positions.len() as f64, "at most 15 lists"));
        }
        for (p, amplitudes) in self.positions.iter().enumerate() {
            if amplitudes.len() != self.modes.len() {
                let expected = "as many amplitudes as there are modes";
                return Err(refuse(format!("positions[{p}]"), amplitudes.len() as f64, expected));
            }
            if let Some(bad) = amplitudes.iter().find(|a| !in_range(**a, -1e9, 1e9)) {
                return Err(refuse(format!("positions[{p}]"), *bad, "finite, within ±1e9"));
            }
        }
        if let Some(Err((field, value, expected))) = self.residual.as_ref().map(Residual::check) {
            return Err(refuse(field.into(), value, expected));
        }
        for (i, mode) in self.modes.iter().enumerate() {
            if !in_range(mode.frequency_hz, 1e-3, 1e7) {
                return Err(refuse(format!("modes[{i}].frequency_hz"), mode.frequency_hz, "1e-3–1e7 Hz"));
            }
            if !in_range(mode.decay_per_s, 0.0, 1e7) {
                return Err(refuse(format!("modes[{i}].decay_per_s"), mode.decay_per_s, "0–1e7 1/s"));
            }
            if !in_range(mode.amplitude, -1e9, 1e9) {
                return Err(refuse(format!("modes[{i}].amplitude"), mode.amplitude, "finite, within ±1e9"));
            }
            if !in_range(mode.phase_rad, -1e3, 1e3) {
                return Err(refuse(
                    format!("modes[{i}].phase_rad"),
                    mode.phase_rad,
                    "finite, within ±1e3 rad",
                ));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TILE: &str = r#"{"format":"asperity.modes","version":1,"source":"tile.wav","impulse_n_s":0.01,
        "modes":[{"frequency_hz":812.4,"decay_per_s":14.2,"amplitude":0.31,"phase_rad":0.1}]}"#;

    #[test]
    fn a_modes_file_survives_the_round_trip_to_the_last_bit() {
        let model = ModalModel::parse(TILE).unwrap();
        assert_eq!(ModalModel::parse(&model.to_json()).unwrap(), model);
        assert_eq!(model.modes[0].frequency_hz, 812.4);
    }

    #[test]
    fn a_missing_impulse_means_one_newton_second() {
        let text = TILE.replace(r#""impulse_n_s":0.01,"#, "");
        assert_eq!(ModalModel::parse(&text).unwrap().impulse_n_s, 1.0);
    }

    #[test]
    fn unit_modes_are_scaled_by_the_recorded_strike() {
        let model = ModalModel::parse(TILE).unwrap();
        let (unit, _) = model.unit_modes().next().unwrap();
        assert!((unit.amplitude - 31.0).abs() < 1e-12);
    }

    #[test]
    fn growing_modes_and_other_formats_are_refused_with_the_place() {
        let growing = TILE.replace("14.2", "-14.2");
        let message = ModalModel::parse(&growing).unwrap_err().to_string();
        assert!(message.contains("modes[0].decay_per_s"), "{message}");
        let other = TILE.replace("asperity.modes", "something");
        assert!(ModalModel::parse(&other).unwrap_err().to_string().contains("something"));
        let future = TILE.replace("\"version\":1", "\"version\":7");
        assert!(ModalModel::parse(&future).unwrap_err().to_string().contains("version is 7"));
        assert!(ModalModel::parse("{").is_err());
    }
}
