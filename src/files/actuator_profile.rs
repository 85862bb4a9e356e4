//! Actuators as data: profiles in TOML, shipped or measured by the user.
//!
//! ```toml
//! label = "what it is"
//! resonance_hz = 170.0           # f₀
//! quality = 8.0                  # Q, above 0.5
//! felt_at_resonance_m = 1.2e-5   # amplitude at f₀ for a sine of drive 1
//! excursion_m = 1.3e-5           # felt displacement at the stop
//! band_hz = [60.0, 400.0]
//! rated_drive = 0.7071           # RMS that may be held for ever
//! thermal_time_s = 5.0
//! [source]                       # where each number comes from; say so when it is assumed
//! resonance_hz = "data sheet"
//! [error]                        # standard error of each number, for people; may be missing
//! resonance_hz = 0.4
//! ```

use super::FileError;
use super::storage::{self, Disk, Files};
use crate::model::actuator::DeviceProfile;
use std::collections::BTreeMap;
use std::path::Path;

/// A profile and what is known about it.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorPreset {
    /// Description.
    pub label: String,
    /// Its numbers.
    pub profile: DeviceProfile,
    /// Source of each number, by field.
    pub source: BTreeMap<String, String>,
}

/// Why a profile was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PresetError {
    /// The file cannot be read.
    #[error(
        "{place}: cannot be read ({source}); name a readable profile, or one of: {}",
        ActuatorPreset::names()
    )]
    Unreadable {
        /// The file.
        place: String,
        /// Message of the system.
        source: std::io::Error,
    },
    /// It is not a profile.
    #[error("{place}: {message}")]
    Malformed {
        /// The file.
        place: String,
        /// Fault.
        message: String,
    },
    /// A number no device has.
    #[error("{place}: {problem}")]
    Impossible {
        /// The file.
        place: String,
        /// Which number, and what would be right.
        problem: asperity_dsp::DesignError,
    },
}

/// A profile as its file holds it.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    label: String,
    resonance_hz: f64,
    quality: f64,
    felt_at_resonance_m: f64,
    excursion_m: f64,
    band_hz: [f64; 2],
    rated_drive: f64,
    thermal_time_s: f64,
    #[serde(default)]
    source: BTreeMap<String, String>,
    #[serde(default, rename = "error")]
    _error: toml::Table,
}

/// The profiles that ship with the engine, by name.
const SHIPPED: [(&str, &str); 4] = [
    ("lra-170", include_str!("actuators/lra-170.toml")),
    ("console-voice-coil", include_str!("actuators/console-voice-coil.toml")),
    ("haptuator", include_str!("actuators/haptuator.toml")),
    ("vr-controller", include_str!("actuators/vr-controller.toml")),
];

/// A profile is checked at this rate when it is read, Hz; the engine checks it again at its own.
const CHECK_RATE_HZ: f64 = 192_000.0;

impl ActuatorPreset {
    /// The shipped profile of that name; `None` when there is none.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        let (_, text) = SHIPPED.iter().find(|(known, _)| *known == name)?;
        Self::parse(text, name).ok()
    }

    /// Names of the shipped profiles, separated by commas.
    #[must_use]
    pub fn names() -> String {
        SHIPPED.map(|(name, _)| name).join(", ")
    }

    /// Reads a profile from a file.
    ///
    /// # Errors
    /// When it cannot be read or is no profile; the message names the file.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, PresetError> {
        Self::load_from(&Disk, path)
    }

    /// [`load`](Self::load), from wherever the files lie.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: impl AsRef<Path>) -> Result<Self, PresetError> {
        let place = path.as_ref().display().to_string();
        match storage::text(files, path.as_ref()) {
            Ok(text) => Self::parse(&text, &place),
            Err(source) => Err(PresetError::Unreadable { place, source }),
        }
    }

    /// Reads a profile from text; `place` names it in messages.
    ///
    /// # Errors
    /// When it is no profile.
    pub fn parse(text: &str, place: &str) -> Result<Self, PresetError> {
        let malformed =
            |error: FileError| PresetError::Malformed { place: place.into(), message: error.to_string() };
        let right = "a profile is TOML with label, the seven numbers of a device and [source]";
        let written: Written =
            toml::from_str(text).map_err(|error| malformed(FileError::toml(text, &error, right)))?;
        let Written { label, source, .. } = written;
        let profile = DeviceProfile {
            resonance_hz: written.resonance_hz,
            quality: written.quality,
            felt_at_resonance_m: written.felt_at_resonance_m,
            excursion_m: written.excursion_m,
            band_hz: written.band_hz,
            rated_drive: written.rated_drive,
            thermal_time_s: written.thermal_time_s,
        };
        profile
            .check(CHECK_RATE_HZ)
            .map_err(|problem| PresetError::Impossible { place: place.into(), problem })?;
        Ok(Self { label, profile, source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_profiles_are_the_constants_of_the_actuator_stage() {
        for (name, profile) in [
            ("lra-170", DeviceProfile::LRA_170),
            ("console-voice-coil", DeviceProfile::CONSOLE_VOICE_COIL),
            ("haptuator", DeviceProfile::HAPTUATOR),
            ("vr-controller", DeviceProfile::VR_CONTROLLER),
        ] {
            assert_eq!(ActuatorPreset::by_name(name).unwrap().profile, profile, "{name}");
        }
        assert_eq!(ActuatorPreset::by_name("hammer"), None);
    }

    #[test]
    fn every_number_of_a_shipped_profile_says_where_it_comes_from() {
        for (name, text) in SHIPPED {
            let preset = ActuatorPreset::parse(text, name).unwrap();
            assert!(!preset.label.is_empty());
            for field in [
                "resonance_hz",
                "quality",
                "felt_at_resonance_m",
                "excursion_m",
                "band_hz",
                "rated_drive",
                "thermal_time_s",
            ] {
                assert!(preset.source.contains_key(field), "{name}: {field}");
            }
        }
    }

    #[test]
    fn a_profile_that_no_device_has_is_refused_by_field() {
        let text = SHIPPED[0].1.replace("quality = 8.0", "quality = 0.3");
        let refused = ActuatorPreset::parse(&text, "mine.toml").unwrap_err().to_string();
        assert!(refused.starts_with("mine.toml: quality: "), "{refused}");
        let text = SHIPPED[0].1.replacen("quality =", "qality =", 1);
        let refused = ActuatorPreset::parse(&text, "x").unwrap_err().to_string();
        assert!(
            refused.starts_with("x: line ") && refused.contains("qality: unknown key; write quality"),
            "{refused}"
        );
    }
}
