//! Everything that is fixed when an engine is built: rates, capacities, model choices, channels.

use crate::clock::{Clock, ClockMode};
use crate::error::ConfigError;
use crate::inner_rate::InnerRate;
use crate::queue;
use crate::renderer::Renderer;
use crate::scene::Scene;
use crate::stats::Counters;
use asperity_dsp::DesignError;
use asperity_dsp::limits::output as limits;
use asperity_dsp::micro_contact::{Integrator, MicroContact, Probe};
use asperity_dsp::modal_bank::Culling;
use asperity_dsp::trajectory::PathMode;
use std::sync::Arc;

pub use asperity_dsp::actuator::{DeviceProfile, Quantity};

/// One haptic channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorSettings {
    /// What the channel plays: the pad's displacement (the paper) or its acceleration.
    pub output: Quantity,
    /// m or m/s² at sample value 1.0; 1.0 gives SI units.
    pub full_scale: f64,
    /// Cutoff of the high-pass that turns pad positions into movement about the mean surface, Hz;
    /// 0 = off.
    pub highpass_hz: f64,
    /// Time from silence to full level after the start, s.
    pub soft_start_s: f64,
    /// Device whose frequency response is inverted.
    pub equalise: Option<DeviceProfile>,
    /// Device whose excursion and heat are kept within limits.
    pub limit: Option<DeviceProfile>,
    /// Whether a peak limiter keeps the channel within ±1, whatever the device.
    pub limit_peaks: bool,
}

impl Default for ActuatorSettings {
    fn default() -> Self {
        Self {
            output: Quantity::Displacement,
            full_scale: 1e-4,
            highpass_hz: 10.0,
            soft_start_s: 0.0,
            equalise: None,
            limit: None,
            limit_peaks: false,
        }
    }
}

/// Settings of the audio bus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AudioSettings {
    /// Linear gain.
    pub gain: f64,
    /// Whether a peak limiter keeps the output within ±1.
    pub limit: bool,
}

impl Default for AudioSettings {
    fn default() -> Self {
        Self { gain: 1.0, limit: false }
    }
}

/// How an engine is built. `Config::default()` is one finger, one actuator, 44.1 kHz, rendered offline;
/// [`Config::live`] is the same for a game that runs now.
#[derive(Debug, Clone)]
pub struct Config {
    /// Rate of every output, Hz; 8–384 kHz.
    pub sample_rate_hz: f64,
    /// Seed of the micro-noise: the same seed feels the same at the same place.
    pub seed: u64,
    /// How sparse contact positions become a path.
    pub path: PathMode,
    /// Cutoff of the path's Butterworth filter, Hz (Hasti §III-C: 30 Hz).
    pub path_cutoff_hz: f64,
    /// How the micro-contact model is integrated.
    pub integrator: Integrator,
    /// The fingertip, or another probe.
    pub probe: Probe,
    /// Haptic channels, in order.
    pub actuators: Vec<ActuatorSettings>,
    /// The audio bus.
    pub audio: AudioSettings,
    /// Most contacts that sound at once; more steal the least important.
    pub max_contacts: usize,
    /// Most surfaces at once.
    pub max_surfaces: usize,
    /// Most bodies at once.
    pub max_bodies: usize,
    /// Events that may wait between the threads.
    pub queue_capacity: usize,
    /// A contact that is not refreshed for so long fades, s: a lost `end` cannot stick.
    pub contact_timeout_s: f64,
    /// How game time becomes samples: exactly, as an offline render wants it, unless told otherwise. A game that
    /// runs now begins with [`Config::live`].
    pub clock: ClockMode,
    /// Modes that are left out when a body is added, because nobody can hear them; `None` keeps all. The
    /// default costs −100 dB of error or less; [`Culling::default`] goes further, as far as the ear does.
    pub culling: Option<Culling>,
    /// Whether the audio half leaves out the least audible work while blocks run late, as told by
    /// [`Renderer::report_load`]. Where nobody reports a load, nothing is ever left out.
    pub shed_load: bool,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            sample_rate_hz: 44_100.0,
            seed: 1,
            path: PathMode::default(),
            path_cutoff_hz: 30.0,
            integrator: Integrator::default(),
            probe: Probe::default(),
            actuators: vec![ActuatorSettings::default()],
            audio: AudioSettings::default(),
            max_contacts: 64,
            max_surfaces: 256,
            max_bodies: 256,
            queue_capacity: 4096,
            contact_timeout_s: 0.25,
            clock: ClockMode::default(),
            culling: Some(Culling::NEGLIGIBLE),
            shed_load: true,
        }
    }
}

impl Config {
    /// What a game wants that runs now: the device's rate, and a clock that follows the game through pauses, restarts,
    /// slow motion and bursts of ticks ([`ClockMode::LIVE`]). The default's exact clock is for offline renders.
    #[must_use]
    pub fn live(sample_rate_hz: f64) -> Self {
        Self { sample_rate_hz, clock: ClockMode::LIVE, ..Self::default() }
    }

    /// Builds the two halves: [`Scene`] for the game thread, [`Renderer`] for the audio thread.
    ///
    /// # Errors
    /// When a setting is outside its range; the message names the field.
    pub fn build(self) -> Result<(Scene, Renderer), ConfigError> {
        self.check()?;
        let micro_contact = MicroContact::new(&self.probe, self.integrator, self.inner_rate_hz())?;
        let counters = Arc::new(Counters::default());
        let (to_audio, from_game) = queue::channel(self.queue_capacity);
        // Every resource that can be alive, and as many that are being replaced.
        let (to_game, from_audio) = queue::channel(2 * (self.max_surfaces + self.max_bodies));
        let renderer = Renderer::new(&self, micro_contact, from_game, to_game, counters.clone())?;
        let clock = Clock::new(self.clock, self.inner_rate_hz());
        Ok((Scene::new(self, clock, to_audio, from_audio, counters), renderer))
    }

    /// Rate at which the engine runs inside, Hz: the smallest multiple of [`Self::sample_rate_hz`] from 44.1 kHz on, so that what
    /// a stroke sounds and feels like does not depend on the rate of the outputs. Sources that keep time (sand, scales and
    /// crossfades that change) are made for this rate.
    #[must_use]
    pub fn inner_rate_hz(&self) -> f64 {
        self.sample_rate_hz * InnerRate::samples(self.sample_rate_hz) as f64
    }

    fn check(&self) -> Result<(), DesignError> {
        limits::SAMPLE_RATE_HZ.check("sample_rate_hz", self.sample_rate_hz)?;
        limits::CONTACT_TIMEOUT_S.check("contact_timeout_s", self.contact_timeout_s)?;
        limits::AUDIO_GAIN.check("audio.gain", self.audio.gain)?;
        if let Some(culling) = self.culling {
            // Without end is allowed: nothing is too quiet.
            let level_db = culling.level_db.clamp(-1.0, 1e9);
            DesignError::check("culling.level_db", level_db, "0 dB or more", |l| l >= 0.0)?;
            DesignError::check("culling.loudest_db_spl", culling.loudest_db_spl, "0–200 dB", |l| {
                (0.0..=200.0).contains(&l)
            })?;
        }
        let count = |field, value: usize, most: usize, expected| {
            DesignError::check(field, value as f64, expected, |v| v >= 1.0 && v <= most as f64).map(|_| ())
        };
        count("actuators", self.actuators.len(), 1024, "1–1024 channels")?;
        count("max_contacts", self.max_contacts, 4096, "1–4096 contacts")?;
        count("max_surfaces", self.max_surfaces, 65_536, "1–65536 surfaces")?;
        count("max_bodies", self.max_bodies, 65_536, "1–65536 bodies")?;
        count("queue_capacity", self.queue_capacity, 1 << 24, "1–16777216 events")
    }
}
