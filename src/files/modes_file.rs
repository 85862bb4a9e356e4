//! Modes files, `NAME.modes.json`: the modes of one body, where they come from, and what its strike
//! had besides.

use super::shapes_sidecar::{shapes_from_bytes, shapes_to_file};
use super::storage::{self, Disk, Files};
use crate::model::click::Click;
use crate::model::diffuse::Diffuse;
use crate::model::modal_model::{ModalModel, ModalModelError};
use crate::model::mode_shapes::{ModeShapes, Unit};
use crate::model::residual::Residual;
use asperity_dsp::mode::Mode;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

/// The `format` field of a modes file.
pub const FORMAT: &str = "asperity.modes";
/// The `version` of a file with modes alone.
pub const VERSION: u32 = 1;
/// The version that has shapes beside the modes ([`ModeShapes`]); its modes play as those of
/// version 1 do.
pub const VERSION_WITH_SHAPES: u32 = 2;
/// The version that has diffuse bands ([`Diffuse`]), with or without shapes.
pub const VERSION_WITH_BANDS: u32 = 3;

#[derive(Serialize, Deserialize)]
struct File {
    format: String,
    version: u32,
    #[serde(default)]
    source: String,
    #[serde(default = "one")]
    impulse_n_s: f64,
    #[serde(default, skip_serializing_if = "is_relative")]
    unit: Unit,
    modes: Vec<Mode>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    positions: Vec<Vec<f64>>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    takes: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    residual: Option<Residual>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    diffuse: Option<Diffuse>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shapes: Option<ModeShapes>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    click: Option<Click>,
    /// Name of the file that holds the shapes instead, beside this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shapes_beside: Option<String>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_relative(unit: &Unit) -> bool {
    *unit == Unit::Relative
}

fn one() -> f64 {
    1.0
}

impl ModalModel {
    /// Reads `NAME.modes.json`.
    ///
    /// # Errors
    /// When the file cannot be read, is not a modes file of version 1 to 3, or holds a number that
    /// no body can have.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, ModalModelError> {
        Self::load_from(&Disk, path)
    }

    /// [`load`](Self::load), from wherever the files lie.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: impl AsRef<Path>) -> Result<Self, ModalModelError> {
        let path = path.as_ref();
        let text = storage::text(files, path).map_err(|source| match source.kind() {
            ErrorKind::InvalidData => {
                let remedy = "is no text; `asperity fit` makes a modes file of a recording";
                ModalModelError::Malformed { path: path.into(), message: remedy.into() }
            }
            _ => ModalModelError::Unreadable { path: path.into(), source },
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = |name: &str| match files.read(&folder.join(name)) {
            Ok(bytes) => Ok(bytes),
            Err(error) => Err(format!("cannot be read ({error}); put it beside the modes file")),
        };
        Self::parse_with(&text, &beside).map_err(|error| match error {
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
        Self::parse_with(text, &|_| {
            Err("lies in a file of its own, so the modes file must be loaded by its path".into())
        })
    }

    /// Parses with whatever gives the bytes of a file beside it.
    fn parse_with(
        text: &str,
        beside: &dyn Fn(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, ModalModelError> {
        let malformed = |message: String| ModalModelError::Malformed { path: "modes".into(), message };
        let mut file: File = serde_json::from_str(text).map_err(|error| malformed(error.to_string()))?;
        if file.format != FORMAT {
            return Err(malformed(format!("format is \"{}\"", file.format)));
        }
        if let Some(name) = &file.shapes_beside {
            let refused = |what: String| malformed(format!("shapes_beside \"{name}\": {what}"));
            if file.shapes.is_some() {
                return Err(refused("stands beside shapes; write one of them".into()));
            }
            if Path::new(name).components().count() != 1 {
                return Err(refused("must be the name of a file in the same folder".into()));
            }
            let bytes = beside(name).map_err(refused)?;
            file.shapes = Some(shapes_from_bytes(&bytes, file.modes.len()).map_err(refused)?);
        }
        match (&file.shapes, file.version) {
            (None, VERSION..=VERSION_WITH_BANDS) => {}
            (Some(shapes), VERSION_WITH_SHAPES | VERSION_WITH_BANDS) => {
                shapes.check(file.modes.len()).map_err(malformed)?
            }
            (Some(_), VERSION) => return Err(malformed("shapes stand in version 1; need version 2".into())),
            _ => return Err(malformed(format!("version is {}", file.version))),
        }
        if file.diffuse.is_some() && file.version < VERSION_WITH_BANDS {
            return Err(malformed(format!("diffuse stands in version {}; need version 3", file.version)));
        }
        let File {
            source, impulse_n_s, modes, positions, takes, residual, diffuse, shapes, unit, click, ..
        } = file;
        let shapes = shapes.map(Arc::new);
        let model =
            Self { source, impulse_n_s, modes, positions, takes, residual, diffuse, shapes, unit, click };
        model.check()?;
        Ok(model)
    }

    /// The text of the modes file, of version 2 where there are shapes, 3 where there are bands;
    /// numbers round-trip.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string(&self.file()).unwrap_or_default()
    }

    /// Writes with the shapes in a file of their own, `name` beside it (a glTF document where it
    /// ends in `.glb`): its text, and the bytes of that file. None where there are no shapes.
    #[must_use]
    pub fn to_json_beside(&self, name: &str) -> Option<(String, Vec<u8>)> {
        let mut file = self.file();
        let bytes = shapes_to_file(&file.shapes.take()?, name);
        file.shapes_beside = Some(name.to_owned());
        Some((serde_json::to_string(&file).unwrap_or_default(), bytes))
    }

    fn file(&self) -> File {
        File {
            format: FORMAT.into(),
            version: match (&self.diffuse, &self.shapes) {
                (Some(_), _) => VERSION_WITH_BANDS,
                (None, Some(_)) => VERSION_WITH_SHAPES,
                (None, None) => VERSION,
            },
            source: self.source.clone(),
            impulse_n_s: self.impulse_n_s,
            unit: self.unit,
            modes: self.modes.clone(),
            positions: self.positions.clone(),
            takes: self.takes,
            residual: self.residual.clone(),
            diffuse: self.diffuse.clone(),
            shapes: self.shapes.as_deref().cloned(),
            click: self.click,
            shapes_beside: None,
        }
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
    fn a_unit_survives_the_round_trip_and_another_word_is_refused() {
        let pascals = TILE.replace("\"version\":1,", "\"version\":1,\"unit\":\"pa_1m\",");
        let model = ModalModel::parse(&pascals).unwrap();
        assert_eq!(model.unit, Unit::PascalsAtOneMetre);
        assert_eq!(ModalModel::parse(&model.to_json()).unwrap(), model);
        assert_eq!(ModalModel::parse(TILE).unwrap().unit, Unit::Relative);
        let sones = ModalModel::parse(&pascals.replace("pa_1m", "sone")).unwrap_err().to_string();
        assert!(sones.contains("sone"), "{sones}");
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
