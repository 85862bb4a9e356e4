//! Device profile: what a port has to know of the hardware behind it, as TOML with the source of
//! every number.
//!
//! ```toml
//! label = "Controller of a headset"
//! band_hz = [55.0, 200.0]        # frequency 0 and 1
//! pcm_rate_hz = 2000.0           # rate of waveforms
//! points_per_s = 250.0           # what its envelopes hold
//! [emphasis]                     # the stroke at frequency 0 and at 1
//! ducking = 0.5                  # what is left of the envelope meanwhile
//! dull = { hz = 55.0, duration_s = 0.0364, square = false }
//! sharp = { hz = 165.0, duration_s = 0.0121, square = true }
//! [source]
//! band_hz = "published profile"
//! ```
//!
//! An actuator configuration (ACF: JSON with comments) gives its range, its ducking and nothing
//! else; the rest stays as the default device has it.

use crate::error::{PortError, within};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Stroke at one end of its scale.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stroke {
    /// Its frequency, Hz.
    pub hz: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// A square wave instead of a sine.
    #[serde(default)]
    pub square: bool,
}

/// Strokes of a device.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Strokes {
    /// Share of the envelope that is left while a stroke sounds, 0 to 1.
    pub ducking: f64,
    /// At emphasis frequency 0.
    pub dull: Stroke,
    /// At 1.
    pub sharp: Stroke,
}

/// Data of the hardware that a port needs.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Device {
    /// Description.
    pub label: String,
    /// Range of frequencies, lowest and highest, Hz.
    pub band_hz: [f64; 2],
    /// Rate of its waveforms, Hz.
    pub pcm_rate_hz: f64,
    /// Points a second that its envelopes hold.
    pub points_per_s: f64,
    /// Its strokes.
    pub emphasis: Strokes,
    /// Source of each number, by field.
    pub source: BTreeMap<String, String>,
}

/// The shipped profiles, by name.
const SHIPPED: [(&str, &str); 4] = [
    ("quest", include_str!("../devices/quest.toml")),
    ("console", include_str!("../devices/console.toml")),
    ("iphone", include_str!("../devices/iphone.toml")),
    ("lra-170", include_str!("../devices/lra-170.toml")),
];

impl Device {
    /// Names of the shipped profiles.
    pub const NAMES: [&'static str; 4] = ["quest", "console", "iphone", "lra-170"];

    /// A shipped profile.
    #[must_use]
    pub fn shipped(name: &str) -> Option<Self> {
        let (_, text) = SHIPPED.into_iter().find(|(shipped, _)| *shipped == name)?;
        Self::from_toml(text).ok()
    }

    /// The device that is meant where none is named.
    #[must_use]
    pub fn quest() -> Self {
        // The shipped text is part of the program; a test reads all four.
        Self::shipped("quest").unwrap_or_else(|| unreachable!("the shipped profile is read by a test"))
    }

    pub(crate) fn from_toml(text: &str) -> Result<Self, PortError> {
        let device: Self =
            toml::from_str(text).map_err(|error| crate::profile_file::refused(text, &error))?;
        device.checked()
    }

    pub(crate) fn checked(self) -> Result<Self, PortError> {
        let [lowest, highest] = self.band_hz;
        within("band_hz[0]", lowest, [1.0, 1000.0])?;
        within("band_hz[1]", highest, [lowest, 1000.0])?;
        within("pcm_rate_hz", self.pcm_rate_hz, [100.0, 192_000.0])?;
        if self.pcm_rate_hz.fract() != 0.0 {
            return Err(PortError::new("pcm_rate_hz", self.pcm_rate_hz, "must be a whole number"));
        }
        within("points_per_s", self.points_per_s, [1.0, 4000.0])?;
        within("emphasis.ducking", self.emphasis.ducking, [0.0, 1.0])?;
        for (name, stroke) in [("dull", self.emphasis.dull), ("sharp", self.emphasis.sharp)] {
            within(format!("emphasis.{name}.hz"), stroke.hz, [1.0, 2000.0])?;
            within(format!("emphasis.{name}.duration_s"), stroke.duration_s, [0.0, 1.0])?;
        }
        Ok(self)
    }

    /// Frequency 0 to 1 → Hz.
    #[must_use]
    pub fn hz(&self, frequency: f64) -> f64 {
        let [lowest, highest] = self.band_hz;
        lowest + frequency * (highest - lowest)
    }

    /// Hz → frequency 0 to 1, at the ends what lies beyond.
    #[must_use]
    pub fn frequency(&self, hz: f64) -> f64 {
        let [lowest, highest] = self.band_hz;
        if highest > lowest { ((hz - lowest) / (highest - lowest)).clamp(0.0, 1.0) } else { 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_profile_is_read_and_names_the_source_of_every_number() {
        for (name, text) in SHIPPED {
            let device = Device::parse(text).unwrap_or_else(|error| panic!("{name}: {error}"));
            for field in ["band_hz", "pcm_rate_hz", "points_per_s", "emphasis"] {
                assert!(device.source.contains_key(field), "{name}: {field} has no source");
            }
        }
        assert_eq!(Device::quest().band_hz, [55.0, 200.0]);
    }

    #[test]
    fn a_number_that_no_device_has_is_refused_by_field() {
        let text = include_str!("../devices/quest.toml");
        for (from, to, field) in [
            ("[55.0, 200.0]", "[55.0, nan]", "band_hz[1]"),
            ("[55.0, 200.0]", "[200.0, 55.0]", "band_hz[1]"),
            ("pcm_rate_hz = 2000.0", "pcm_rate_hz = 0.0", "pcm_rate_hz"),
            ("ducking = 0.5", "ducking = 2.0", "emphasis.ducking"),
        ] {
            let error = Device::parse(&text.replace(from, to)).unwrap_err();
            assert_eq!(error.at, field, "{error}");
        }
        assert!(Device::parse("x = 1").unwrap_err().to_string().starts_with("line 1: x: unknown key"));
    }
}
