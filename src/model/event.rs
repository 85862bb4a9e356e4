//! Contact events, as a game or VR physics step reports them: contacts that begin, move and end,
//! and impacts.
//!
//! Events are small `Copy` values in SI units, stamped by the caller in game seconds. The same type
//! serves a live game, a replayed [contact log](crate::files::contact_log) and every test.
//!
//! **Impact or slide?** What strikes and leaves, or strikes with a rigid body, is an [`Impact`]:
//! one pulse into the body. What stays is a contact: its landing sounds through the contact model,
//! by [`closing_m_s`](ContactSample::closing_m_s). Report one or the other for the same landing,
//! not both.
//!
//! **Flicker.** Physics engines lose a contact for a frame and find it again. A begin that comes
//! while the same contact still fades from its end (25 ms, longer than a frame at 60 Hz), on the
//! same surface and actuator and within 10 mm of where it left, is the same touch: it goes on from
//! the level it has faded to, without a landing, and is counted in
//! [`Stats::debounced`](crate::Stats::debounced). A begin of a contact that never ended is a
//! landing.

use crate::model::bad_value::{BadValue, held, within};
pub use crate::model::contact_sample::ContactSample;
use crate::model::id::{BodyId, ProbeId, SurfaceId};
use crate::model::material::Material;
use crate::model::pickup::RigidMotion;
use asperity_dsp::limits;
pub use asperity_dsp::limits::{MAX_NORMAL_FORCE_N as MAX_FORCE_N, MAX_SPEED_M_S, MAX_UV};

/// A contact's name, chosen by the caller and unique among the contacts that are touching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ContactId(pub u64);

/// A haptic channel: the index of an actuator in [`Config::actuators`](crate::Config::actuators).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ChannelId(pub u16);

/// Surface, probe and actuator of a contact: fixed for as long as the contact lasts.
///
/// ```
/// use asperity::{ChannelId, Config, Engine, Surface, Touching, probe_by_name};
///
/// let Engine { mut scene, .. } = Config::default().build()?;
/// let slate = scene.add_surface(Surface::flat(0.3, 0.2)?)?;
/// let stylus = scene.add_probe(probe_by_name("stylus").unwrap())?;
/// // A stylus in a hand that feels it; `held_by` names the body that rings with it.
/// let writing = Touching::on(slate).probe(stylus).felt_by(ChannelId(0)).importance(2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Touching {
    /// Surface that is touched.
    pub surface: SurfaceId,
    /// Probe that touches; none = the engine's own ([`Config::probe`](crate::Config::probe)).
    pub probe: Option<ProbeId>,
    /// Which haptic channel feels it; none = it is heard only.
    pub actuator: Option<ChannelId>,
    /// The body that holds the probe, a pen for instance: it rings too, at its position 0, from the
    /// same impulses with opposite sign.
    pub holder: Option<BodyId>,
    /// Linear gain of what is felt and heard of it, 0–1000.
    pub gain: f64,
    /// Factor of its priority when contacts have to be left out, 0–1e6.
    pub importance: f64,
}

impl Touching {
    /// The engine's own probe on a surface, heard and not felt.
    #[must_use]
    pub fn on(surface: SurfaceId) -> Self {
        Self { surface, probe: None, actuator: None, holder: None, gain: 1.0, importance: 1.0 }
    }

    /// Felt by a haptic channel.
    #[must_use]
    pub fn felt_by(mut self, actuator: ChannelId) -> Self {
        self.actuator = Some(actuator);
        self
    }

    /// Touching with another probe.
    #[must_use]
    pub fn probe(mut self, probe: ProbeId) -> Self {
        self.probe = Some(probe);
        self
    }

    /// The probe is held by a body, which rings too.
    #[must_use]
    pub fn held_by(mut self, holder: BodyId) -> Self {
        self.holder = Some(holder);
        self
    }

    /// Louder or softer than it is.
    #[must_use]
    pub fn gain(mut self, gain: f64) -> Self {
        self.gain = gain;
        self
    }

    /// More or less important than its force and speed say.
    #[must_use]
    pub fn importance(mut self, importance: f64) -> Self {
        self.importance = importance;
        self
    }
}

/// A rigid striker hits a body.
///
/// ```
/// use asperity::{BodyId, Impact, Material};
///
/// # let bell = BodyId::from_bits(1);
/// // 20 g of wood with a tip of 8 mm, at 1.5 m/s.
/// let mallet = Impact::on(bell).striker(Material::WOOD, 0.02, 0.008).at_speed(1.5);
/// // Or what a physics engine reports: 0.03 N·s at 1.5 m/s, half of the speed is left.
/// let tumbling = Impact::from_impulse(bell, 0.03, 1.5, 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// The body that rings.
    pub body: BodyId,
    /// The striker's own body, when it rings too.
    pub other: Option<BodyId>,
    /// Approach speed, m/s.
    pub speed_m_s: f64,
    /// Effective mass of the striker, kg.
    pub mass_kg: f64,
    /// Radius of curvature at the point of contact, m.
    pub radius_m: f64,
    /// Material of the striker.
    pub striker: Material,
    /// Ratio of rebound to approach speed, 0–1; 1 is the loss-free impact of Hertz theory.
    pub restitution: f64,
    /// Which of the body's strike positions is hit; 0 is the one every body has, and one that the
    /// body does not have counts as its last.
    pub position: usize,
    /// Place that is hit, m in the body's frame: the nearest point of its surface counts, instead
    /// of `position`. Only a body whose modes have [shapes](crate::ModeShapes) takes it.
    pub at_m: Option<[f64; 3]>,
    /// Along what it is hit there, in the body's frame; none = the inward normal. Its length does
    /// not count.
    pub direction: Option<[f64; 3]>,
    /// The haptic channel that feels the blow; none = the first one if somebody holds the striker,
    /// else nobody feels it.
    pub actuator: Option<ChannelId>,
    /// The body in the hand, which rings at its position 0 from the same pulse with opposite sign.
    pub holder: Option<BodyId>,
    /// Probe of the hand that feels it; none = the engine's own.
    pub probe: Option<ProbeId>,
    /// Linear gain of what is felt and heard of it, 0–1000.
    pub gain: f64,
}

/// Gain and importance of a contact from now on; none = as it was.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Emphasis {
    /// Linear gain of what is felt and heard of it, 0–1000; reached within some milliseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// Factor of its priority when contacts have to be left out, 0–1e6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub importance: Option<f64>,
}

impl Emphasis {
    /// Fills from an earlier report what this one leaves out.
    pub(crate) fn or(self, earlier: Self) -> Self {
        Self { gain: self.gain.or(earlier.gain), importance: self.importance.or(earlier.importance) }
    }

    /// # Errors
    /// When a factor is outside its range.
    pub fn checked(self) -> Result<Self, BadValue> {
        within("gain", self.gain.unwrap_or(1.0), limits::impact::GAIN)?;
        within("importance", self.importance.unwrap_or(1.0), limits::impact::IMPORTANCE)?;
        Ok(self)
    }
}

/// One report of the physics step.
///
/// ```
/// use asperity::{ChannelId, ContactEvent, ContactId, ContactSample, SurfaceId};
///
/// # let plate = SurfaceId::from_bits(1);
/// let finger = ContactId(1);
/// let sample = ContactSample::new([0.2, 0.5], 0.6).sliding([0.1, 0.0]);
/// let touch = ContactEvent::begin(finger, plate, ChannelId(0), sample.landing(0.05));
/// let slide = ContactEvent::moved(finger, sample);
/// let lift = ContactEvent::end(finger);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactEvent {
    /// A contact lands on a surface.
    Begin {
        /// The contact's name from now on.
        contact: ContactId,
        /// Surface, probe and actuator.
        touching: Touching,
        /// Place and manner.
        sample: ContactSample,
    },
    /// A contact goes on, somewhere else or with another force.
    Moved {
        /// The contact's name.
        contact: ContactId,
        /// Place and manner.
        sample: ContactSample,
        /// Gain and importance.
        emphasis: Emphasis,
    },
    /// A contact lifts off.
    End {
        /// The contact's name, free again from now on.
        contact: ContactId,
    },
    /// A rigid striker hits a body.
    Impact(Impact),
    /// A body moves as a whole, for the accelerometers on it ([`Pickup`](crate::Pickup)).
    Motion {
        /// The body.
        body: BodyId,
        /// Motion at this instant, in its own axes.
        motion: RigidMotion,
    },
}

impl ContactEvent {
    /// A contact lands.
    #[must_use]
    pub fn begin(contact: ContactId, surface: SurfaceId, actuator: ChannelId, sample: ContactSample) -> Self {
        Self::begin_with(contact, Touching::on(surface).felt_by(actuator), sample)
    }

    /// A contact lands: any kind of contact.
    #[must_use]
    pub fn begin_with(contact: ContactId, touching: Touching, sample: ContactSample) -> Self {
        Self::Begin { contact, touching, sample }
    }

    /// A contact goes on: `move` in contact logs, which is no name in Rust.
    #[must_use]
    pub fn moved(contact: ContactId, sample: ContactSample) -> Self {
        Self::moved_with(contact, sample, Emphasis::default())
    }

    /// A contact goes on, louder or softer, or of another importance.
    #[must_use]
    pub fn moved_with(contact: ContactId, sample: ContactSample, emphasis: Emphasis) -> Self {
        Self::Moved { contact, sample, emphasis }
    }

    /// Event in a second of audio during which `pace` seconds of the game go by: in slow motion a
    /// contact moves slowly. Forces and blows stay what they are.
    pub(crate) fn at_pace(mut self, pace: f64) -> Self {
        if let Self::Begin { sample, .. } | Self::Moved { sample, .. } = &mut self {
            sample.velocity_m_s = sample.velocity_m_s.map(|v| v.map(|v| v * pace));
            sample.slip_m_s = sample.slip_m_s.map(|slip| slip * pace);
        }
        self
    }

    /// Event at the place in the body of another one.
    pub(crate) fn at_place_of(mut self, reported: &Self) -> Self {
        if let (
            Self::Begin { sample, .. } | Self::Moved { sample, .. },
            Self::Begin { sample: reported, .. } | Self::Moved { sample: reported, .. },
        ) = (&mut self, reported)
        {
            sample.at_m = reported.at_m;
        }
        self
    }

    /// Event with the velocity of another one, beyond what the models reach too.
    pub(crate) fn with_velocity_of(mut self, reported: &Self) -> Self {
        if let (
            Self::Begin { sample, .. } | Self::Moved { sample, .. },
            Self::Begin { sample: reported, .. } | Self::Moved { sample: reported, .. },
        ) = (&mut self, reported)
        {
            sample.velocity_m_s = reported.velocity_m_s.or(sample.velocity_m_s);
        }
        self
    }

    /// A contact lifts off.
    #[must_use]
    pub fn end(contact: ContactId) -> Self {
        Self::End { contact }
    }
}

impl Impact {
    /// Impulse that it gives, its gain counted, N·s.
    pub(crate) fn impulse_n_s(&self) -> f64 {
        self.gain * (self.mass_kg * self.speed_m_s * (1.0 + self.restitution))
    }

    /// A loss-free blow of a steel ball of 1 cm and 4 g at 1 m/s: a value to begin with, for the
    /// fields that a game does not know.
    #[must_use]
    pub fn on(body: BodyId) -> Self {
        Self {
            body,
            other: None,
            speed_m_s: 1.0,
            mass_kg: 0.004,
            radius_m: 0.005,
            striker: Material::STEEL,
            restitution: 1.0,
            position: 0,
            at_m: None,
            direction: None,
            actuator: None,
            holder: None,
            probe: None,
            gain: 1.0,
        }
    }

    /// From what most physics engines report of a collision: the impulse along the normal, N·s, and
    /// the approach speed. The mass follows from J = m v (1 + e), so that the body receives the
    /// impulse that was reported; the striker stays the small steel ball of [`Impact::on`].
    /// [`striker`](Self::striker) would set the mass anew: another material or radius is a field.
    ///
    /// ```
    /// # use asperity::{BodyId, Impact, Material};
    /// # let floor = BodyId::from_bits(1);
    /// let crate_lands = Impact {
    ///     striker: Material::WOOD,
    ///     radius_m: 0.02,
    ///     ..Impact::from_impulse(floor, 20.0, 4.0, 0.2)
    /// };
    /// ```
    #[must_use]
    pub fn from_impulse(body: BodyId, impulse_n_s: f64, speed_m_s: f64, restitution: f64) -> Self {
        let mass_kg = impulse_n_s / (speed_m_s.max(1e-6) * (1.0 + restitution));
        Self { speed_m_s, mass_kg, restitution, ..Self::on(body) }
    }

    /// By a striker of this material, effective mass (kg) and radius where it strikes (m).
    #[must_use]
    pub fn striker(mut self, material: Material, mass_kg: f64, radius_m: f64) -> Self {
        (self.striker, self.mass_kg, self.radius_m) = (material, mass_kg, radius_m);
        self
    }

    /// At this approach speed, m/s.
    #[must_use]
    pub fn at_speed(mut self, speed_m_s: f64) -> Self {
        self.speed_m_s = speed_m_s;
        self
    }

    /// Leaving with this share of the approach speed, 0–1.
    #[must_use]
    pub fn rebounding(mut self, restitution: f64) -> Self {
        self.restitution = restitution;
        self
    }

    /// At a place of the body, m in its frame.
    #[must_use]
    pub fn at_m(mut self, at_m: [f64; 3]) -> Self {
        self.at_m = Some(at_m);
        self
    }

    /// Felt by a haptic channel.
    #[must_use]
    pub fn felt_by(mut self, actuator: ChannelId) -> Self {
        self.actuator = Some(actuator);
        self
    }

    /// Impact with speed, mass and radius beyond what the models reach held at their limits: 100
    /// m/s, 1e4 kg, 10 m.
    ///
    /// # Errors
    /// When a number is not finite or no striker can have it.
    pub fn checked(self) -> Result<Self, BadValue> {
        self.held().map(|(impact, _)| impact)
    }

    /// Held impact, and true where something was held at its limit.
    pub(crate) fn held(mut self) -> Result<(Self, bool), BadValue> {
        let mut at_limit = false;
        for (field, value, range) in [
            ("speed_m_s", &mut self.speed_m_s, limits::SPEED_M_S),
            ("mass_kg", &mut self.mass_kg, limits::impact::MASS_KG),
            ("radius_m", &mut self.radius_m, limits::impact::RADIUS_M),
        ] {
            *value = held(field, *value, range, &mut at_limit)?;
        }
        within("restitution", self.restitution, limits::impact::RESTITUTION)?;
        within("gain", self.gain, limits::impact::GAIN)?;
        // The nearest point of the body counts: a place far off is as good as the one at the limit.
        for x in self.at_m.iter_mut().flatten() {
            *x = held("at_m", *x, limits::PLACE_M, &mut at_limit)?;
        }
        if let Some(direction) = self.direction {
            within("direction", direction.iter().map(|x| x * x).sum::<f64>().sqrt(), limits::AXIS)?;
        }
        self.striker.checked()?;
        Ok((self, at_limit))
    }
}
