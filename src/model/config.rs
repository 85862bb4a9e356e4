//! Everything that is fixed when an engine is built: rates, capacities, model choices, channels.

use crate::model::actuator::ActuatorSettings;
use crate::model::bus::{AudioBus, MAX_BUSES};
use crate::model::clock_mode::ClockMode;
use crate::model::error::ConfigError;
use crate::model::inner_rate::InnerRate;
use crate::model::level_policy::LevelPolicy;
use asperity_dsp::DesignError;
use asperity_dsp::limits::output as limits;
use asperity_dsp::micro_contact::{Integrator, Probe};
use asperity_dsp::modal_bank::Culling;
use asperity_dsp::sensor::SensorProfile;
use asperity_dsp::simd::{Isa, Level};
use asperity_dsp::trajectory::PathMode;
use serde::{Deserialize, Serialize};

/// Most inner samples for each that leaves, besides those of low rates.
const MAX_OVERSAMPLING: usize = 16;

/// Settings of an engine. `Config::default()` is one finger, one actuator, 44.1 kHz, rendered
/// offline; [`Config::live`] is the same for a game that runs now.
///
/// As text it is a table with these fields, of which any may be missing, and no others
/// ([`Config::parse`]).
///
/// ```
/// use asperity::Config;
///
/// let many = Config { max_contacts: 128, seed: 7, ..Config::live(48_000.0) };
/// assert!(many.build().is_ok());
/// let wrong = Config { sample_rate_hz: 10.0, ..Config::default() };
/// assert!(wrong.build().unwrap_err().to_string().contains("8000 to 384000 Hz"));
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Config {
    /// Rate of every output, Hz; 8–384 kHz, default 44.1 kHz.
    pub sample_rate_hz: f64,
    /// Inner samples where there would be one: 1–16, default 1. What a sample is too coarse for
    /// (the contact between its samples, the force as the body takes it) errs the less, and
    /// everything but the outputs costs so many times as much.
    pub oversampling: usize,
    /// Seed of the micro-noise: the same seed feels the same at the same place. Default 1.
    pub seed: u64,
    /// Way from sparse contact positions to a path.
    pub path: PathMode,
    /// Cutoff of the path's Butterworth filter, Hz (Hasti §III-C: 30 Hz).
    pub path_cutoff_hz: f64,
    /// Integrator of the micro-contact model.
    pub integrator: Integrator,
    /// The engine's own probe, for contacts that name no other: the fingertip by
    /// default.
    pub probe: Probe,
    /// Haptic channels, in order; by default one of 0.1 mm at full scale, without limiter.
    pub actuators: Vec<ActuatorSettings>,
    /// Audio buses, in order; a body plays on one of them, the first by default. By
    /// default one with gain 1, without limiter. With none nothing sounds, and a body that is only
    /// listened to by pickups costs less.
    pub audio: Vec<AudioBus>,
    /// Channels of [pickups](crate::Pickup), each read by a sensor, or in SI units; by default
    /// none.
    pub pickups: Vec<Option<SensorProfile>>,
    /// Origin of the levels of bodies and surfaces that are added; as their numbers say by
    /// default, shared levels that are found with [`Config::live`].
    pub levels: LevelPolicy,
    /// Most contacts that sound at once, 1–4096, default 64; more steal the least important: force
    /// times speed times importance.
    pub max_contacts: usize,
    /// Most probes, the engine's own not counted; 1–4096, default 64.
    pub max_probes: usize,
    /// Most ports that can be open at once; 1–4096, default 16.
    pub max_ports: usize,
    /// Most surfaces at once; 1–65,536, default 256.
    pub max_surfaces: usize,
    /// Most bodies at once; 1–65,536, default 256.
    pub max_bodies: usize,
    /// Events that may wait between the threads; 1–16,777,216, default 4096.
    pub queue_capacity: usize,
    /// A contact that is not refreshed for so long fades, s: a lost `end` cannot stick. 0.01–3600
    /// s, default 0.25 s.
    pub contact_timeout_s: f64,
    /// Conversion of game time to samples: exactly, as an offline render wants it, by
    /// default. A game that runs now begins with [`Config::live`].
    pub clock: ClockMode,
    /// Modes that are left out when a body is added, because nobody can hear them; `None` keeps
    /// all. The default costs −100 dB of error or less; [`Culling::default`] goes further, as far
    /// as the ear does.
    #[serde(with = "culling_or_none")]
    pub culling: Option<Culling>,
    /// Lets the audio half leave out the least audible work while blocks run late, by
    /// [`Renderer::report_load`](crate::Renderer::report_load). Without a reported load,
    /// nothing is ever left out.
    pub shed_load: bool,
    /// Instruction set of the kernels whose last bits depend on it, the modal bank and the contact
    /// model: [`Isa::Portable`] gives the same bits on every processor. `None`: the fastest that
    /// this processor has.
    pub kernel: Option<Isa>,
    /// Most threads that render at once, the one that calls
    /// [`Renderer::render`](crate::Renderer::render) among them; 1–64, default 1: no other is ever
    /// started. With more, surfaces with their contacts, and bodies, are dealt to threads that live
    /// as long as the renderer; the bits are those of one thread. Pays from a few bodies of a
    /// thousand modes or a dozen contacts on surfaces of their own. The system schedules them as
    /// any thread: on a machine that is busy with other things, leave them out.
    pub threads: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            sample_rate_hz: 44_100.0,
            oversampling: 1,
            seed: 1,
            path: PathMode::default(),
            path_cutoff_hz: 30.0,
            integrator: Integrator::default(),
            probe: Probe::default(),
            actuators: vec![ActuatorSettings::default()],
            audio: vec![AudioBus::default()],
            pickups: Vec::new(),
            levels: LevelPolicy::default(),
            max_contacts: 64,
            max_probes: 64,
            max_ports: 16,
            max_surfaces: 256,
            max_bodies: 256,
            queue_capacity: 4096,
            contact_timeout_s: 0.25,
            clock: ClockMode::default(),
            culling: Some(Culling::NEGLIGIBLE),
            shed_load: true,
            kernel: None,
            threads: 1,
        }
    }
}

impl Config {
    /// Settings for a game that runs now: the device's rate; a clock that follows the game through
    /// pauses, restarts, slow motion and bursts of ticks ([`ClockMode::LIVE`]); levels that are
    /// found when bodies and surfaces are added ([`LevelPolicy::Shared`]), and limiters behind
    /// them, which `AudioBus::default()` and `ActuatorSettings::default()` leave out. The default's
    /// exact clock and levels as given are for offline renders.
    #[must_use]
    pub fn live(sample_rate_hz: f64) -> Self {
        Self {
            sample_rate_hz,
            clock: ClockMode::LIVE,
            levels: LevelPolicy::Shared,
            actuators: vec![ActuatorSettings { limit_peaks: true, ..ActuatorSettings::default() }],
            audio: vec![AudioBus { limit: true, ..AudioBus::default() }],
            ..Self::default()
        }
    }

    /// Rate at which the engine runs inside, Hz: [`Self::oversampling`] times the smallest multiple
    /// of [`Self::sample_rate_hz`] from 32 kHz on, so that what a stroke sounds and feels like
    /// does not depend on the rate of the outputs. Sources that keep time (sand, scales and
    /// crossfades that change) are made for this rate.
    #[must_use]
    pub fn inner_rate_hz(&self) -> f64 {
        self.sample_rate_hz * self.inner_samples() as f64
    }

    /// Inner samples for each that leaves.
    pub(crate) fn inner_samples(&self) -> usize {
        InnerRate::samples(self.sample_rate_hz) * self.oversampling.max(1)
    }

    /// Contacts that can be rendered at the same time: as many again as half of
    /// [`Self::max_contacts`], at least 8, let those that were stolen or have ended fade while new
    /// ones sound.
    #[must_use]
    pub fn voices(&self) -> usize {
        self.max_contacts + self.max_contacts.div_ceil(2).max(8)
    }

    /// Most that can wait to be freed by the game half: what can be alive, and what each message of
    /// a full queue sends home.
    pub(crate) fn most_to_free(&self) -> usize {
        2 * (self.max_surfaces + self.max_bodies) + self.max_ports + self.queue_capacity
    }

    /// The kernel that runs.
    ///
    /// # Errors
    /// When this processor does not have the one that is asked for.
    pub(crate) fn kernel(&self) -> Result<Level, ConfigError> {
        let Some(isa) = self.kernel else { return Ok(Level::detect()) };
        Level::find(isa).ok_or(ConfigError::Kernel { isa: isa.name() })
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        self.kernel()?;
        Ok(self.check_numbers()?)
    }

    fn check_numbers(&self) -> Result<(), DesignError> {
        limits::SAMPLE_RATE_HZ.check("sample_rate_hz", self.sample_rate_hz)?;
        limits::CONTACT_TIMEOUT_S.check("contact_timeout_s", self.contact_timeout_s)?;
        self.probe.check()?;
        for actuator in &self.actuators {
            limits::FULL_SCALE.check("full_scale", actuator.full_scale)?;
            limits::FELT_FORCE_EXPONENT.check("felt_force_exponent", actuator.felt_force_exponent)?;
            limits::HIGHPASS_HZ.check("highpass_hz", actuator.highpass_hz)?;
        }
        for bus in &self.audio {
            limits::AUDIO_GAIN.check("audio.gain", bus.gain)?;
            if let Some(pascals) = bus.pascals_at_full_scale {
                limits::PASCALS.check("audio.pascals_at_full_scale", pascals)?;
            }
        }
        self.pickups.iter().flatten().try_for_each(SensorProfile::check)?;
        DesignError::check("pickups", self.pickups.len() as f64, "at most 1024 channels", |n| n <= 1024.0)?;
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
        count("oversampling", self.oversampling, MAX_OVERSAMPLING, "1–16 inner samples a sample")?;
        count("actuators", self.actuators.len(), 1024, "1–1024 channels")?;
        count("audio", self.audio.len().max(1), MAX_BUSES, "0–64 buses")?;
        count("max_contacts", self.max_contacts, 4096, "1–4096 contacts")?;
        count("max_probes", self.max_probes, 4096, "1–4096 probes")?;
        count("max_ports", self.max_ports, 4096, "1–4096 ports")?;
        count("max_surfaces", self.max_surfaces, 65_536, "1–65536 surfaces")?;
        count("max_bodies", self.max_bodies, 65_536, "1–65536 bodies")?;
        count("threads", self.threads, 64, "1–64 threads")?;
        count("queue_capacity", self.queue_capacity, 1 << 24, "1–16777216 events")
    }
}

/// A table, or the word "none", because text formats have no empty value.
mod culling_or_none {
    use super::Culling;
    use serde::de::value::MapAccessDeserializer;
    use serde::de::{Error, MapAccess, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::fmt;

    #[expect(clippy::ref_option, reason = "serde hands out a reference to the field")]
    pub(super) fn serialize<S: Serializer>(
        culling: &Option<Culling>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        match culling {
            Some(culling) => culling.serialize(serializer),
            None => serializer.serialize_str("none"),
        }
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Option<Culling>, D::Error> {
        deserializer.deserialize_any(TableOrNone)
    }

    struct TableOrNone;

    impl<'de> Visitor<'de> for TableOrNone {
        type Value = Option<Culling>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("\"none\", or a table with level_db, masking and loudest_db_spl")
        }

        fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
            if word == "none" {
                Ok(None)
            } else {
                Err(E::invalid_value(serde::de::Unexpected::Str(word), &self))
            }
        }

        fn visit_unit<E: Error>(self) -> Result<Self::Value, E> {
            Ok(None)
        }

        fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
            Culling::deserialize(MapAccessDeserializer::new(map)).map(Some)
        }
    }
}
