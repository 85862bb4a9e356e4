//! Edits of a scene as lines of a log: what a game added, replaced, removed or set while it
//! recorded.
//!
//! ```json
//! {"t":0.5,"event":"replace_body","body":"tile","modes":{"format":"asperity.modes",…},"material":{…},"bus":0}
//! {"t":0.8,"event":"replace_surface","surface":"plate","is":{"name":"plate","solid":"granite",…},"folder":"scenes"}
//! {"t":0.9,"event":"audio_gain","bus":0,"gain":0.5}
//! ```
//! A body and a probe are held whole. A surface is held as its table of the scene file (`is`, with
//! paths relative to `folder`); one that the game's own code has made cannot be written down, and
//! the program that replays the log makes it under the same name.

use crate::model::body::Body;
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use asperity_dsp::micro_contact::Probe;
use serde::{Deserialize, Serialize};

/// An edit, with names instead of ids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum LogEdit {
    /// A body comes.
    AddBody {
        /// Its name.
        body: String,
        /// Description.
        #[serde(flatten)]
        is: LogBody,
    },
    /// A body becomes another.
    ReplaceBody {
        /// Its name.
        body: String,
        /// Description from now on.
        #[serde(flatten)]
        is: LogBody,
    },
    /// A body sounds on another bus.
    BodyBus {
        /// Its name.
        body: String,
        /// Index of the bus.
        bus: usize,
    },
    /// A body sounds on a further bus.
    BodySend {
        /// Its name.
        body: String,
        /// Index of the bus.
        bus: usize,
        /// Linear gain there.
        gain: f64,
    },
    /// A body is louder or softer.
    BodyGain {
        /// Its name.
        body: String,
        /// Linear gain.
        gain: f64,
    },
    /// All that leaves fades, or comes back.
    Mute {
        /// True where it fades.
        muted: bool,
    },
    /// The game stands still, or goes on.
    Pause {
        /// True where it stands still.
        paused: bool,
    },
    /// The game runs in slow motion or fast from `t` on; `t` of later lines stays the game's time.
    TimeScale {
        /// Game seconds a second of audio.
        scale: f64,
        /// True where pitch bends with it; missing: false.
        #[serde(default)]
        bend_pitch: bool,
    },
    /// All that leaves sounds at this speed and pitch: what recordings hold of a bent time scale.
    Pitch {
        /// Speed and pitch.
        pitch: f64,
    },
    /// Every contact ends, and what rings is damped.
    FadeAll,
    /// A body goes.
    RemoveBody {
        /// Its name.
        body: String,
    },
    /// A probe comes.
    AddProbe {
        /// Its name.
        probe: String,
        /// Its numbers.
        is: Probe,
    },
    /// A surface comes.
    AddSurface {
        /// Its name.
        surface: String,
        /// Description.
        #[serde(flatten)]
        is: LogSurface,
    },
    /// A surface becomes another.
    ReplaceSurface {
        /// Its name.
        surface: String,
        /// Description from now on.
        #[serde(flatten)]
        is: LogSurface,
    },
    /// A surface goes.
    RemoveSurface {
        /// Its name.
        surface: String,
    },
    /// Parameters of a surface's source change; which and how is the game's own.
    ChangeSurface {
        /// Its name.
        surface: String,
    },
    /// The user's gain of a haptic channel.
    HapticGain {
        /// Index of the channel.
        actuator: u16,
        /// Linear gain.
        gain: f64,
    },
    /// The gain of an audio bus.
    AudioGain {
        /// Index of the bus.
        bus: usize,
        /// Linear gain.
        gain: f64,
    },
}

/// A body, whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LogBody {
    /// Its modes, as in a modes file.
    pub modes: serde_json::Value,
    /// Material.
    pub material: Material,
    /// Index of the bus it plays on.
    pub bus: usize,
    /// Linear gain; missing: 1.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub gain: f64,
    /// Linear gain of impacts beside strokes; missing: 1, or by the level policy of the engine.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strike_gain: Option<f64>,
    /// Least time between equally strong impacts, s; missing: 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub least_time_s: f64,
    /// Spread of equal impacts, 0–1; missing: 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub variation: f64,
    /// Its mass, if it is known, kg.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
}

fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_one(gain: &f64) -> bool {
    *gain == 1.0
}

/// A surface, if it can be written down.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LogSurface {
    /// Its table of the scene file; none = the game's own code made it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub is: Option<toml::Table>,
    /// Folder that paths in it are relative to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
    /// Material of its body, if the scene says so: surfaces take their finish from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<Material>,
}

impl From<&Body> for LogBody {
    fn from(body: &Body) -> Self {
        let modes = serde_json::from_str(&body.model.to_json()).unwrap_or_default();
        let Body { material, bus, gain, strike_gain, least_time_s, variation, mass_kg, .. } = *body;
        Self { modes, material, bus, gain, strike_gain, least_time_s, variation, mass_kg }
    }
}

impl LogBody {
    /// The body.
    ///
    /// # Errors
    /// When the modes are none.
    pub(crate) fn body(&self) -> Result<Body, crate::model::modal_model::ModalModelError> {
        let body = Body::new(ModalModel::parse(&self.modes.to_string())?);
        let Self { material, bus, gain, strike_gain, least_time_s, variation, mass_kg, .. } = *self;
        Ok(Body { material, bus, gain, strike_gain, least_time_s, variation, mass_kg, ..body })
    }
}
