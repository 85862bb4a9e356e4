//! Engine of a world: from its scene file, or from its own properties.

use super::AsperityWorld;
use crate::res_files::ResFiles;
use crate::stream::MOST_CHANNELS;
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::{ActuatorSettings, AudioBus, ClockMode, Config, Engine, LevelPolicy};
use godot::classes::AudioServer;
use godot::prelude::*;
use std::path::Path;

/// Lead of a stamp over the audio, s, at most: Godot catches up with up to 8 physics ticks in one
/// frame, 133 ms at 60 Hz.
const CLOCK: ClockMode = ClockMode::Live { max_lead_s: 0.2 };

impl AsperityWorld {
    /// Reads and builds; `live`: for the audio server, else for a render.
    pub(crate) fn open(&self, live: bool) -> Result<Engine, String> {
        let rate_hz = f64::from(AudioServer::singleton().get_mix_rate());
        let clock = if live { CLOCK } else { ClockMode::Exact };
        if self.scene_file.is_empty() {
            let channels = usize::try_from(self.haptic_channels)
                .ok()
                .filter(|count| *count <= MOST_CHANNELS)
                .ok_or_else(|| {
                    format!("haptic_channels: {} is refused; must be 0 to 16", self.haptic_channels)
                })?;
            // Limited as before a sound card, what is felt too.
            let felt = ActuatorSettings {
                full_scale: self.haptic_full_scale_m,
                limit_peaks: true,
                ..ActuatorSettings::default()
            };
            let config = Config {
                levels: self.level_policy()?,
                sample_rate_hz: rate_hz,
                clock,
                actuators: vec![felt; channels],
                audio: vec![AudioBus { gain: self.gain, limit: true, ..AudioBus::default() }],
                ..Config::default()
            };
            return config.build().map_err(|error| error.to_string());
        }
        let files = ResFiles::default();
        let path = self.scene_file.to_string();
        let file = SceneFile::load_from(&files, Path::new(&path)).map_err(|error| error.to_string())?;
        // Limited as before a sound card, whether it is played or rendered.
        let overrides = Overrides {
            files: &files,
            sample_rate_hz: Some(rate_hz),
            clock: Some(clock),
            live: true,
            ..Overrides::default()
        };
        Engine::from_scene(&file, &overrides).map_err(|error| error.to_string())
    }

    fn level_policy(&self) -> Result<LevelPolicy, String> {
        match self.levels.to_string().as_str() {
            "shared" => Ok(LevelPolicy::Shared),
            "each" => Ok(LevelPolicy::Each),
            "as_given" => Ok(LevelPolicy::AsGiven),
            other => Err(format!("levels: \"{other}\" is refused; must be shared, each or as_given")),
        }
    }
}
