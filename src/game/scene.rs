//! The game half: takes resources and events, checks them, sends them, frees what comes back.
//!
//! Every call returns at once. Nothing here waits for the audio thread.

use crate::files::contact_log::{ContactLog, Names};
use crate::game::clock::Clock;
use crate::game::recording::Recording;
use crate::game::silence::{Reported, SilentBecause};
use crate::link::message::{Dead, Message};
use crate::link::ring::{Receiver, Sender};
use crate::link::stats::{Counters, Stats};
use crate::model::bad_value::within;
use crate::model::config::Config;
use crate::model::error::{AddError, Refusal, ReportError};
use crate::model::event::{Actuator, BodyId, ContactEvent, ContactId, Impact, SurfaceId};
use crate::model::inner_rate::InnerRate;
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use crate::model::stamp::Stamp;
use crate::model::surface::Surface;
use crate::prepared::body::{BodySlot, LONGEST_CONTACT_S};
use crate::prepared::overlay::Overlay;
use crate::prepared::stroking::{Stroking, elastic};
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::hertz::{HertzContact, HertzPulse};
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_dsp::{DesignError, limits};
use asperity_texture::change::SurfaceChange;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

/// The game half of an engine.
pub struct Scene {
    config: Config,
    clock: Clock,
    last_time_s: f64,
    surfaces: Vec<bool>,
    bodies: Vec<Option<KnownBody>>,
    /// The newest move of each contact that did not fit into the queue.
    held: Vec<(Stamp, ContactId, ContactEvent)>,
    to_audio: Sender<Message>,
    from_audio: Receiver<Dead>,
    counters: Arc<Counters>,
    recording: Option<Recording>,
    /// For [`Scene::why_silent`].
    reported: Reported,
    /// Whether the contacts on each surface ring something.
    rings: Vec<bool>,
}

/// What the game half remembers of a body.
#[derive(Clone, Copy)]
struct KnownBody {
    material: Material,
    lowest_mode_hz: f64,
}

/// What a body, or a surface without one, is made of unless told otherwise.
const DEFAULT_MATERIAL: Material = Material::PLA;

impl Scene {
    pub(crate) fn new(
        config: Config,
        clock: Clock,
        to_audio: Sender<Message>,
        from_audio: Receiver<Dead>,
        counters: Arc<Counters>,
    ) -> Self {
        Self {
            surfaces: vec![false; config.max_surfaces],
            rings: vec![false; config.max_surfaces],
            reported: Reported::default(),
            bodies: vec![None; config.max_bodies],
            held: Vec::new(),
            config,
            clock,
            last_time_s: f64::NEG_INFINITY,
            to_audio,
            from_audio,
            counters,
            recording: None,
        }
    }

    /// How the engine was built.
    #[must_use]
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// Adds a body that rings, of PLA; [`add_body_of`](Self::add_body_of) sets the material.
    ///
    /// # Errors
    /// When every place is taken or the modes cannot be rendered at this rate.
    pub fn add_body(&mut self, model: ModalModel) -> Result<BodyId, AddError> {
        self.add_body_of(model, DEFAULT_MATERIAL)
    }

    /// Adds a body of a material, which decides how long impacts on it last.
    ///
    /// # Errors
    /// As [`add_body`](Self::add_body), or when the material is impossible.
    pub fn add_body_of(&mut self, model: ModalModel, material: Material) -> Result<BodyId, AddError> {
        self.collect();
        let slot = free_place(self.bodies.iter().map(Option::is_some), "bodies")?;
        self.set_body(slot, &model, material)?;
        Ok(BodyId(slot as u32))
    }

    /// Gives a body other modes and another material while it sounds; the old modes ring out under the new ones, and strokes
    /// on its surfaces take the new material at once.
    ///
    /// # Errors
    /// As [`add_body_of`](Self::add_body_of), or when the body is not in this scene.
    pub fn replace_body(
        &mut self,
        body: BodyId,
        model: ModalModel,
        material: Material,
    ) -> Result<(), AddError> {
        self.collect();
        self.known_body(body)?;
        self.set_body(body.0 as usize, &model, material)
    }

    fn set_body(&mut self, slot: usize, model: &ModalModel, material: Material) -> Result<(), AddError> {
        let material = material.checked()?;
        let (rate, inner) = (self.config.sample_rate_hz, self.config.inner_rate_hz());
        let audible = self.config.culling.map(|culling| model.audible(rate, &culling));
        let body = Box::new(BodySlot::new(audible.as_ref().unwrap_or(model), rate, inner)?);
        let frequencies = model.modes.iter().filter(|m| m.amplitude != 0.0).map(|m| m.frequency_hz);
        let lowest_mode_hz = frequencies.fold(f64::INFINITY, f64::min);
        let known = KnownBody { material, lowest_mode_hz };
        let stroking = self.stroking(known)?;
        self.send(Message::SetBody { slot, body, stroking })?;
        self.bodies[slot] = Some(known);
        Ok(())
    }

    /// How strokes excite a body.
    fn stroking(&self, body: KnownBody) -> Result<Stroking, DesignError> {
        let (mass_kg, rate_hz) = (self.config.probe.pad_mass_kg, self.config.inner_rate_hz());
        Stroking::new(body.material, body.lowest_mode_hz, mass_kg, rate_hz)
    }

    /// Takes a body away; it rings out.
    ///
    /// # Errors
    /// When it is not in this scene or the queue is full.
    pub fn remove_body(&mut self, body: BodyId) -> Result<(), AddError> {
        self.known_body(body)?;
        self.send(Message::RemoveBody { slot: body.0 as usize })?;
        self.bodies[body.0 as usize] = None;
        Ok(())
    }

    /// Adds a surface.
    ///
    /// # Errors
    /// When every place is taken, its body is not in this scene, or a number is impossible.
    pub fn add_surface(&mut self, surface: Surface) -> Result<SurfaceId, AddError> {
        self.collect();
        let slot = free_place(self.surfaces.iter().copied(), "surfaces")?;
        self.set_surface(slot, surface)?;
        Ok(SurfaceId(slot as u32))
    }

    /// Changes a surface under the contacts that slide on it, without a click.
    ///
    /// # Errors
    /// As [`add_surface`](Self::add_surface), or when the surface is not in this scene.
    pub fn replace_surface(&mut self, id: SurfaceId, surface: Surface) -> Result<(), AddError> {
        self.collect();
        self.known_surface(id)?;
        self.set_surface(id.0 as usize, surface)
    }

    fn set_surface(&mut self, slot: usize, surface: Surface) -> Result<(), AddError> {
        let surface = surface.checked()?.tiled();
        let silent = KnownBody { material: DEFAULT_MATERIAL, lowest_mode_hz: f64::INFINITY };
        let body = surface.body.map_or(Ok(silent), |body| self.known_body(body))?;
        let stroking = self.stroking(body)?;
        let config = &self.config;
        let period_m = surface.wrap_period_m();
        let trajectory =
            TrajectoryDesign::new(config.path, config.path_cutoff_hz, config.inner_rate_hz(), period_m)?;
        let overlay = Overlay::new(period_m, surface.source.band().shortest_m);
        let rings = body.lowest_mode_hz.is_finite();
        let surface = Box::new(SurfaceSlot { surface, trajectory, stroking, overlay, period_m });
        self.send(Message::SetSurface { slot, surface })?;
        self.surfaces[slot] = true;
        self.rings[slot] = rings;
        Ok(())
    }

    /// Changes parameters of a surface's source while it is touched, without a click. A change the
    /// source does not take (another kind, or impossible numbers) is counted as quarantined.
    ///
    /// # Errors
    /// When the surface is not in this scene or the queue is full.
    pub fn change_surface(&mut self, id: SurfaceId, change: SurfaceChange) -> Result<(), AddError> {
        self.known_surface(id)?;
        self.send(Message::ChangeSurface { slot: id.0 as usize, change })
    }

    /// Takes a surface away; contacts on it fade.
    ///
    /// # Errors
    /// When it is not in this scene or the queue is full.
    pub fn remove_surface(&mut self, id: SurfaceId) -> Result<(), AddError> {
        self.known_surface(id)?;
        self.send(Message::RemoveSurface { slot: id.0 as usize })?;
        self.surfaces[id.0 as usize] = false;
        Ok(())
    }

    /// Sets the user's gain of one haptic channel, 0 = mute; it is reached within a few milliseconds.
    ///
    /// # Errors
    /// When there is no such channel, the gain is not in 0–10, or the queue is full.
    pub fn set_haptic_gain(&mut self, actuator: Actuator, gain: f64) -> Result<(), AddError> {
        let channel = usize::from(actuator.0);
        if channel >= self.config.actuators.len() {
            return Err(AddError::Unknown("actuator"));
        }
        let gain = within("gain", gain, limits::output::HAPTIC_GAIN)?;
        self.send(Message::SetHapticGain { channel, gain })
    }

    /// Reports what a contact did at game time `time_s`. Returns at once.
    ///
    /// # Errors
    /// The event is handed back with the reason: a bad number, an unknown name, time running
    /// backwards (with an exact clock), or a full queue. Moves are the last to be refused: when the queue runs full only the
    /// newest move of each contact is kept, and sent with the next report.
    #[expect(
        clippy::result_large_err,
        reason = "the event is handed back whole, without a box on the game thread"
    )]
    pub fn report(&mut self, time_s: f64, event: ContactEvent) -> Result<(), ReportError> {
        self.try_report(time_s, event).map_err(|reason| {
            let cell = match reason {
                Refusal::QueueFull => &self.counters.dropped,
                _ => &self.counters.refused,
            };
            Counters::add(cell, 1);
            self.reported.refuse(reason);
            ReportError { event, reason }
        })
    }

    fn try_report(&mut self, time_s: f64, event: ContactEvent) -> Result<(), Refusal> {
        let event = self.checked(event)?;
        self.checked_time(time_s)?;
        let position = self.counters.position.load(Relaxed);
        let stamped = self.clock.stamp(time_s, position);
        Counters::add(&self.counters.clock_jumps, u64::from(stamped.jumped));
        Counters::add(&self.counters.clock_paces, u64::from(stamped.repaced));
        self.counters.ahead.store(stamped.stamp.sample().saturating_sub(position), Relaxed);
        self.flush_held();
        let stamp = stamped.stamp;
        let event = event.at_pace(self.clock.pace());
        self.send_stamped(stamp, event)?;
        self.reported.accept(&event, stamp, self.rings(&event));
        if let Some(recording) = &mut self.recording {
            recording.note(stamp.samples() / self.config.inner_rate_hz(), &event);
        }
        Ok(())
    }

    /// Whether what an event touches has modes.
    fn rings(&self, event: &ContactEvent) -> bool {
        let has_modes =
            |body: BodyId| self.bodies[body.0 as usize].is_some_and(|body| body.lowest_mode_hz.is_finite());
        match event {
            ContactEvent::Begin { surface, .. } => self.rings[surface.0 as usize],
            ContactEvent::Impact(impact) => {
                [Some(impact.body), impact.other].into_iter().flatten().any(has_modes)
            }
            ContactEvent::Moved { .. } | ContactEvent::End { .. } => false,
        }
    }

    fn send_stamped(&mut self, stamp: Stamp, event: ContactEvent) -> Result<(), Refusal> {
        match event {
            ContactEvent::Moved { contact, .. } => self.send_move(stamp, contact, event),
            ContactEvent::Begin { contact, .. } | ContactEvent::End { contact } => {
                let before = self.held.len();
                self.held.retain(|(_, held, _)| *held != contact);
                Counters::add(&self.counters.superseded, (before - self.held.len()) as u64);
                self.send_event(Message::Event { stamp, event })
            }
            ContactEvent::Impact(impact) => self.send_impact(stamp, &impact),
        }
    }

    fn checked_time(&mut self, time_s: f64) -> Result<(), Refusal> {
        if self.clock.is_live() {
            within("time_s", time_s, limits::LIVE_TIME_S)?;
            return Ok(());
        }
        let time_s = within("time_s", time_s, limits::TIME_S)?;
        if time_s < self.last_time_s {
            return Err(Refusal::TimeBackwards { time_s, before_s: self.last_time_s });
        }
        self.last_time_s = time_s;
        Ok(())
    }

    fn checked(&self, event: ContactEvent) -> Result<ContactEvent, Refusal> {
        Ok(match event {
            ContactEvent::Begin { contact, surface, actuator, sample } => {
                self.known_surface(surface).map_err(|_| Refusal::UnknownSurface)?;
                let channels = self.config.actuators.len();
                if usize::from(actuator.0) >= channels {
                    return Err(Refusal::UnknownActuator { index: actuator.0, channels });
                }
                ContactEvent::Begin { contact, surface, actuator, sample: sample.checked()? }
            }
            ContactEvent::Moved { contact, sample } => {
                ContactEvent::Moved { contact, sample: sample.checked()? }
            }
            ContactEvent::End { .. } => event,
            ContactEvent::Impact(impact) => {
                for body in [Some(impact.body), impact.other].into_iter().flatten() {
                    self.known_body(body).map_err(|_| Refusal::UnknownBody)?;
                }
                ContactEvent::Impact(impact.checked()?)
            }
        })
    }

    fn send_move(&mut self, stamp: Stamp, contact: ContactId, event: ContactEvent) -> Result<(), Refusal> {
        // The last quarter of the queue is kept for landings, lift-offs and impacts.
        if self.to_audio.free() > self.to_audio.capacity() / 4 {
            return self.send_event(Message::Event { stamp, event });
        }
        if let Some(held) = self.held.iter_mut().find(|(_, held, _)| *held == contact) {
            *held = (stamp, contact, event);
            Counters::add(&self.counters.superseded, 1);
        } else if self.held.len() < 4 * self.config.max_contacts {
            self.held.push((stamp, contact, event));
        } else {
            return Err(Refusal::QueueFull);
        }
        Ok(())
    }

    fn flush_held(&mut self) {
        while self.to_audio.free() > self.to_audio.capacity() / 4 {
            let oldest = (0..self.held.len()).min_by_key(|&index| self.held[index].0);
            let Some(oldest) = oldest else { return };
            let (stamp, _, event) = self.held.swap_remove(oldest);
            // There is room: checked just above.
            let _ = self.to_audio.send(Message::Event { stamp, event });
        }
    }

    fn send_impact(&mut self, stamp: Stamp, impact: &Impact) -> Result<(), Refusal> {
        let known = self.bodies[impact.body.0 as usize];
        let material = known.map_or(DEFAULT_MATERIAL, |body| body.material);
        let contact =
            HertzContact::new(&elastic(impact.striker), &elastic(material), impact.radius_m, impact.mass_kg)
                .map_err(|_| Refusal::UnknownBody)?;
        let pulse = HertzPulse {
            impulse_n_s: impact.mass_kg * impact.speed_m_s * (1.0 + impact.restitution),
            contact_time_s: contact.contact_time_s(impact.speed_m_s).min(LONGEST_CONTACT_S),
        };
        let shortened = pulse.contact_time_s == LONGEST_CONTACT_S;
        if pulse.impulse_n_s == 0.0 {
            return Ok(());
        }
        Counters::add(&self.counters.shortened, u64::from(shortened));
        let other = impact.other.map(|other| other.0 as usize);
        self.send_event(Message::Strike {
            stamp,
            body: impact.body.0 as usize,
            position: impact.position,
            other,
            pulse,
        })
    }

    fn send_event(&mut self, message: Message) -> Result<(), Refusal> {
        self.to_audio.send(message).map_err(|_| Refusal::QueueFull)
    }

    fn send(&mut self, message: Message) -> Result<(), AddError> {
        self.to_audio.send(message).map_err(|_| AddError::QueueFull)
    }

    /// Records from now on what is reported, with the time at which the engine applies it, so that
    /// [`offline::render`](crate::offline::render) gives the same samples. Ids that `names` does not
    /// name are recorded by number. Recording allocates on the game thread as it grows.
    pub fn start_recording(&mut self, names: &Names) {
        self.recording = Some(Recording::new(names));
    }

    /// Ends the recording and hands it over; empty if there was none.
    pub fn stop_recording(&mut self) -> ContactLog {
        self.recording.take().map(Recording::into_log).unwrap_or_default()
    }

    /// Frees surfaces and bodies that the audio half no longer needs; `add_…` and `replace_…` do it
    /// too. Returns how many were freed.
    pub fn collect(&mut self) -> usize {
        std::iter::from_fn(|| self.from_audio.receive()).count()
    }

    /// Whether another move might be held back because the audio half lags behind.
    pub(crate) fn is_filling(&self) -> bool {
        self.to_audio.free() <= self.to_audio.capacity() / 4 + 1
    }

    /// What speaks against anything being heard or felt, the likeliest reason first; empty when nothing
    /// does. Each reason says what would be right. To be asked when a scene is silent, or to be logged.
    #[must_use]
    pub fn why_silent(&self) -> Vec<SilentBecause> {
        self.reported.why_silent(&self.stats(), &self.config)
    }

    /// Game time begins anew: the next report holds at the sample that is rendered next, whatever its time, and
    /// later ones keep their exact distance to it. For a level that restarts, a game that was loaded or that was
    /// paused under [`ClockMode::Exact`](crate::ClockMode::Exact); a live clock finds out by itself, within a report.
    /// Events that still wait for their time are dropped and counted as superseded. Contacts that touch go on until their next
    /// report, their end or the time-out.
    ///
    /// # Errors
    /// When the queue is full.
    pub fn reset(&mut self) -> Result<(), AddError> {
        self.send(Message::Reset)?;
        self.counters.resets_asked.fetch_add(1, Relaxed);
        Counters::add(&self.counters.superseded, self.held.len() as u64);
        self.held.clear();
        self.clock.reset(self.counters.position.load(Relaxed));
        self.last_time_s = f64::NEG_INFINITY;
        Ok(())
    }

    /// What the engine did so far.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let stats = self.counters.snapshot();
        Stats { position: stats.position / InnerRate::samples(self.config.sample_rate_hz) as u64, ..stats }
    }

    fn known_surface(&self, id: SurfaceId) -> Result<(), AddError> {
        let known = self.surfaces.get(id.0 as usize).copied().unwrap_or(false);
        known.then_some(()).ok_or(AddError::Unknown("surface"))
    }

    fn known_body(&self, id: BodyId) -> Result<KnownBody, AddError> {
        self.bodies.get(id.0 as usize).copied().flatten().ok_or(AddError::Unknown("body"))
    }
}

fn free_place(mut taken: impl ExactSizeIterator<Item = bool>, kind: &'static str) -> Result<usize, AddError> {
    let capacity = taken.len();
    taken.position(|taken| !taken).ok_or(AddError::Full { kind, capacity })
}
