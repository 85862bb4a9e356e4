//! Settings as text: what an engine is built with, for programs and languages that would rather not
//! name every field.
//!
//! ```toml
//! sample_rate_hz = 48000
//! max_contacts = 128
//! integrator = "exact-event"
//! clock = { live = { max_lead_s = 0.05 } }
//! actuators = [{ output = "acceleration", full_scale = 50.0 }]
//! ```

use super::FileError;
use crate::model::config::Config;

impl Config {
    /// Reads settings as TOML, or as JSON where the text begins with a brace. What is missing is as
    /// in [`Config::default`].
    ///
    /// ```
    /// use asperity::{Config, PathMode};
    ///
    /// let config = Config::parse("path = \"hold\"\nmax_contacts = 8")?;
    /// assert_eq!((config.path, config.max_contacts), (PathMode::Hold, 8));
    /// assert_eq!(config, Config::parse(r#"{"path": "hold", "max_contacts": 8}"#)?);
    /// # Ok::<(), asperity::files::FileError>(())
    /// ```
    ///
    /// # Errors
    /// When the text is neither, a key is unknown, or a number is outside its range; the message
    /// names it.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let refuse = |message: &str| {
            let right = "fields and their values are those of `Config`";
            FileError::new("config", message.replace('\n', " "), right)
        };
        let config: Self = if text.trim_start().starts_with('{') {
            serde_json::from_str(text).map_err(|error| refuse(&error.to_string()))?
        } else {
            toml::from_str(text).map_err(|error: toml::de::Error| refuse(error.message()))?
        };
        config.check().map_err(|error| FileError::from_error(error).within("config"))?;
        Ok(config)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::actuator::{ActuatorSettings, DeviceProfile, Quantity};
    use crate::model::clock_mode::ClockMode;
    use asperity_dsp::micro_contact::Integrator;
    use asperity_dsp::simd::Isa;
    use asperity_dsp::trajectory::PathMode;

    #[test]
    fn every_field_survives_the_way_through_text() {
        let rare = Config {
            sample_rate_hz: 96_000.0,
            seed: 77,
            path: PathMode::Hermite,
            integrator: Integrator::SemiImplicitEulerExplicitDamper,
            actuators: vec![
                ActuatorSettings::default(),
                ActuatorSettings {
                    output: Quantity::Acceleration,
                    full_scale: 50.0,
                    equalise: Some(DeviceProfile::LRA_170),
                    limit_peaks: true,
                    ..ActuatorSettings::default()
                },
            ],
            clock: ClockMode::LIVE,
            culling: None,
            shed_load: false,
            kernel: Some(Isa::Portable),
            ..Config::default()
        };
        for config in [Config::default(), Config::live(48_000.0), rare] {
            let json = serde_json::to_string(&config).unwrap();
            assert_eq!(Config::parse(&json).unwrap(), config, "{json}");
            let toml = toml::to_string(&config).unwrap();
            assert_eq!(Config::parse(&toml).unwrap(), config, "{toml}");
        }
        assert_eq!(Config::parse("").unwrap(), Config::default());
    }

    #[test]
    fn what_is_unknown_is_refused_by_name_at_any_depth() {
        for (text, parts) in [
            ("sampel_rate_hz = 1", &["unknown field `sampel_rate_hz`", "`sample_rate_hz`"][..]),
            ("[probe]\nweight_kg = 1", &["unknown field `weight_kg`", "`pad_mass_kg`"]),
            ("[[audio]]\ngian = 1", &["unknown field `gian`", "`gain`"]),
            ("[[actuators]]\nequalise = { quality = 3, q = 1 }", &["unknown field `q`", "`resonance_hz`"]),
            ("[culling]\nlevel = 3", &["unknown field `level`", "`level_db`"]),
            ("culling = \"some\"", &["\"none\", or a table"]),
            ("integrator = \"magic\"", &["unknown variant `magic`", "`exact-event`"]),
            ("clock = { live = { lead_s = 1 } }", &["lead_s"]),
            ("{\"seed\": -1}", &["-1"]),
            ("sample_rate_hz = 100", &["config: sample_rate_hz: 100 is refused; must be 8000 to 384000 Hz"]),
            ("[probe]\npad_mass_kg = 7", &["config: pad_mass_kg: 7 is refused; must be 1e-6 to 1 kg"]),
            ("[[actuators]]\nfull_scale = 0", &["config: full_scale: 0 is refused"]),
            ("max_contacts = 0", &["config: max_contacts: 0 is refused; must be 1–4096 contacts"]),
        ] {
            let line = Config::parse(text).unwrap_err().to_string();
            for part in parts {
                assert!(line.contains(part), "{line}\nlacks {part}");
            }
            assert_eq!(line.lines().count(), 1);
        }
    }

    #[test]
    fn a_kernel_that_the_processor_lacks_is_refused_with_those_it_has() {
        let absent = if cfg!(target_arch = "aarch64") { "avx2" } else { "neon" };
        let line = Config::parse(&format!("kernel = \"{absent}\"")).unwrap_err().to_string();
        assert!(
            line.contains(&format!(
                "kernel: \"{absent}\" is not in this processor; must be one of: portable"
            )),
            "{line}"
        );
    }
}
