//! Sensors of pickups as data: profiles in TOML, shipped or written by the user.
//!
//! ```toml
//! label = "what it is"
//! resonance_hz = 21000.0       # of the seismic mass, or of the mounting
//! quality = 20.0
//! band_hz = [0.5, 10000.0]     # −3 dB each; 0 = down to nothing
//! noise_m_s2_rthz = 2.5e-4     # added behind the resonance
//! clip_m_s2 = 490.0
//! gain_v_per_m_s2 = 4.08e-3
//! adc_bits = 16                # over ± clip; 0 = none
//! [source]                     # where each number comes from; say so when it is assumed
//! resonance_hz = "data sheet"
//! ```

use super::FileError;
use super::storage::{self, Files};
use asperity_dsp::sensor::SensorProfile;
use std::collections::BTreeMap;
use std::path::Path;

/// The profiles that ship with the engine, by name.
pub const SHIPPED: [(&str, &str); 2] = [
    ("adxl1004", include_str!("sensors/adxl1004.toml")),
    ("adxl1005", include_str!("sensors/adxl1005.toml")),
];

/// A profile and what is known about it.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorPreset {
    /// Description.
    pub label: String,
    /// Its numbers.
    pub profile: SensorProfile,
    /// Source of each number, by field.
    pub source: BTreeMap<String, String>,
}

/// A profile as its file holds it.
#[derive(serde::Deserialize)]
struct Written {
    label: String,
    resonance_hz: f64,
    quality: f64,
    band_hz: [f64; 2],
    noise_m_s2_rthz: f64,
    clip_m_s2: f64,
    gain_v_per_m_s2: f64,
    adc_bits: u32,
    #[serde(default)]
    source: BTreeMap<String, String>,
}

impl SensorPreset {
    /// A shipped profile by name, or a profile's file, relative to `folder`.
    ///
    /// # Errors
    /// When there is none, or it is no profile; the message says what would be right.
    pub fn find(files: &dyn Files, name: &str, folder: &Path) -> Result<Self, FileError> {
        if let Some((name, text)) = SHIPPED.iter().find(|(known, _)| *known == name) {
            return Self::parse(text, name);
        }
        if Path::new(name).extension().is_none_or(|ending| ending != "toml") {
            let names = SHIPPED.map(|(name, _)| name).join(", ");
            let right = format!("must be a profile's file (NAME.toml) or one of: {names}");
            return Err(FileError::new("sensor", format!("\"{name}\" is unknown"), right));
        }
        let path = folder.join(name);
        let text = storage::text(files, &path).map_err(|error| FileError::read(&path, &error))?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Reads a profile from text; `place` names it in messages.
    ///
    /// # Errors
    /// When it is no profile.
    pub fn parse(text: &str, place: &str) -> Result<Self, FileError> {
        let right = "a profile is TOML with label, the seven numbers of a sensor and [source]";
        let written: Written =
            toml::from_str(text).map_err(|error| FileError::toml(text, &error, right).within(place))?;
        let Written { label, source, resonance_hz, quality, band_hz, noise_m_s2_rthz, .. } = written;
        let Written { clip_m_s2, gain_v_per_m_s2, adc_bits, .. } = written;
        let profile = SensorProfile {
            resonance_hz,
            quality,
            band_hz,
            noise_m_s2_rthz,
            clip_m_s2,
            gain_v_per_m_s2,
            adc_bits,
        };
        profile.check().map_err(|error| FileError::from_error(error).within(place))?;
        Ok(Self { label, profile, source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_of_a_shipped_sensor_says_where_it_comes_from() {
        for (name, text) in SHIPPED {
            let preset = SensorPreset::parse(text, name).unwrap();
            assert!(!preset.label.is_empty());
            for field in [
                "resonance_hz",
                "quality",
                "band_hz",
                "noise_m_s2_rthz",
                "clip_m_s2",
                "gain_v_per_m_s2",
                "adc_bits",
            ] {
                assert!(preset.source.contains_key(field), "{name}: {field}");
            }
        }
    }

    #[test]
    fn shipped_sensors_respond_as_their_data_sheets_say() {
        for (name, hz, within_db) in [("adxl1004", 24e3, 0.5), ("adxl1005", 21e3, 0.6)] {
            let text = SHIPPED.iter().find(|(known, _)| *known == name).unwrap().1;
            let response = SensorPreset::parse(text, name).unwrap().profile.response(hz);
            let db = 20.0 * response.log10();
            println!("{name}: {db:.2} dB at {hz} Hz");
            assert!((db - 3.0).abs() <= within_db, "{name}: {db} dB at {hz} Hz");
        }
    }

    #[test]
    fn a_sensor_that_is_none_is_refused_by_field() {
        let text = SHIPPED[0].1.replace("quality = 20.0", "quality = 0.0");
        let refused = SensorPreset::parse(&text, "mine.toml").unwrap_err().to_string();
        assert!(refused.starts_with("mine.toml: quality: "), "{refused}");
        let text = SHIPPED[0].1.replacen("quality =", "qality =", 1);
        let refused = SensorPreset::parse(&text, "mine.toml").unwrap_err().to_string();
        assert!(refused.starts_with("mine.toml: ") && refused.contains("quality"), "{refused}");
    }
}
