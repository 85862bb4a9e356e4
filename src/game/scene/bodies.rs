//! Bodies of a scene: added, replaced, moved from bus to bus, taken away.

use super::{KnownBody, Scene};
use crate::files::contact_log::LogEdit;
use crate::game::levels::{BodyLevel, Levels};
use crate::game::variation::{Variation, with_takes};
use crate::link::message::{Made, Message, Retired};
use crate::model::bad_value::within;
use crate::model::body::{Body, MAX_SENDS, Sends};
use crate::model::bus::BusId;
use crate::model::error::AddError;
use crate::model::id::BodyId;
use crate::model::strike_field::StrikeField;
use crate::resource::body::BodySlot;
use crate::resource::probe::colliding_kg;
use crate::resource::stroking::Stroking;
use asperity_dsp::modal_bank::LOUDEST_DB_SPL;
use asperity_dsp::{DesignError, limits};
use std::sync::Arc;

/// Levels at which the order of modes is asked for, dB SPL: between a whisper and what hurts.
const HEARD_DB_SPL: (f64, f64) = (30.0, 100.0);

/// Number of bodies that have rung out and are kept.
const MOST_RESTED: usize = 16;

impl Scene {
    /// Adds a body that rings: a [`Body`]; or a [`ModalModel`](crate::ModalModel), which becomes a
    /// body of PLA on the first bus.
    ///
    /// # Errors
    /// When every place is taken, the modes cannot be rendered at this rate, the material is
    /// impossible, or there is no such bus.
    pub fn add_body(&mut self, body: impl Into<Body>) -> Result<BodyId, AddError> {
        self.collect();
        let (id, body) = (BodyId(self.bodies.free()?), body.into());
        self.set_body(id, &body)?;
        self.given.insert(id, body.clone());
        self.note(|names| LogEdit::AddBody { body: names.body(id), is: (&body).into() });
        for (bus, gain) in body.sends.into_iter().flatten() {
            self.note(|names| LogEdit::BodySend { body: names.body(id), bus, gain });
        }
        Ok(id)
    }

    /// Gives a body other modes, another material and another bus while it sounds; the old modes
    /// ring out under the new ones until they sleep (64 bodies at a time; beyond that the quietest
    /// fades), and strokes on its surfaces take the new material at once. What it sends to further
    /// buses stays, unless its own bus is another.
    ///
    /// # Errors
    /// As [`add_body`](Self::add_body), or when the body is not in this scene.
    pub fn replace_body(&mut self, id: BodyId, body: impl Into<Body>) -> Result<(), AddError> {
        self.collect();
        self.known_body(id)?;
        let mut body = body.into();
        body.sends =
            self.given.get(&id).filter(|old| old.bus == body.bus).map_or(body.sends, |old| old.sends);
        self.set_body(id, &body)?;
        self.given.insert(id, body.clone());
        self.note(|names| LogEdit::ReplaceBody { body: names.body(id), is: (&body).into() });
        Ok(())
    }

    /// [`replace_body`](Self::replace_body), and what it sends to further buses is the new one's.
    pub(crate) fn replace_body_and_sends(&mut self, id: BodyId, body: Body) -> Result<(), AddError> {
        let sends = body.sends;
        self.replace_body(id, body)?;
        let Some(given) = self.given.get(&id) else { return Ok(()) };
        let (own, old) = (given.bus, given.sends);
        let gone =
            old.iter().flatten().filter(|(bus, _)| !sends.iter().flatten().any(|(kept, _)| kept == bus));
        let gone: Vec<(usize, f64)> = gone.map(|(bus, _)| (*bus, 0.0)).collect();
        for (bus, gain) in gone.into_iter().chain(sends.into_iter().flatten()).filter(|(bus, _)| *bus != own)
        {
            self.set_body_send(id, BusId(bus), gain)?;
        }
        Ok(())
    }

    /// Gain of impacts on a body beside strokes, whether its own [`Body::strike_gain`], the scene
    /// file or the level policy has said it.
    ///
    /// # Errors
    /// When the body is not in this scene.
    pub fn strike_gain_of(&self, id: BodyId) -> Result<f64, AddError> {
        self.known_body(id).map(|body| body.level.strike_gain)
    }

    /// Lets a body sound on another bus from now on, and on no other, without a click.
    ///
    /// # Errors
    /// When the body is not in this scene, there is no such bus, or the queue is full.
    pub fn set_body_bus(&mut self, id: BodyId, bus: BusId) -> Result<(), AddError> {
        self.known_body(id)?;
        let bus = self.checked_bus(bus.0)?;
        self.send(Message::SetBodyBus { slot: id.index(), bus })?;
        if let Some(given) = self.given.get_mut(&id) {
            (given.bus, given.sends) = (bus, Sends::default());
        }
        self.note(|names| LogEdit::BodyBus { body: names.body(id), bus });
        Ok(())
    }

    /// Lets a body sound on a further bus as well, so loud, linear, without a step; 0 for no
    /// longer. For several listeners, as on a split screen: a bus each, and how near the body is to
    /// each of them. The gain of the body counts on all of them.
    ///
    /// ```
    /// use asperity::{AudioBus, Body, BusId, Config, Engine, Material, Stock};
    ///
    /// let config = Config { audio: vec![AudioBus::default(); 2], ..Config::default() };
    /// let Engine { mut scene, .. } = config.build()?;
    /// let bell = scene.add_body(Body::stock(Stock::Bowl, Material::BRASS, 0.1)?)?;
    /// // The second player stands further away.
    /// scene.set_body_send(bell, BusId(1), 0.25)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the body is not in this scene, there is no such bus or it is the body's own (whose gain
    /// is the body's), the gain is not in 0–1000, the body is sent to four others already, or the
    /// queue is full.
    pub fn set_body_send(&mut self, id: BodyId, bus: BusId, gain: f64) -> Result<(), AddError> {
        self.known_body(id)?;
        let bus = self.checked_bus(bus.0)?;
        let gain = within("gain", gain, limits::impact::GAIN)?;
        let Some(given) = self.given.get(&id).filter(|given| given.bus != bus) else {
            return Err(AddError::Unknown("further bus"));
        };
        let mut sends = given.sends;
        let at = |wanted: Option<usize>| sends.iter().position(|send| send.map(|(bus, _)| bus) == wanted);
        let full = AddError::Full { kind: "sends of a body", capacity: MAX_SENDS };
        let place = at(Some(bus)).or_else(|| at(None)).ok_or(full)?;
        sends[place] = (gain > 0.0).then_some((bus, gain));
        self.send(Message::SetBodySend { slot: id.index(), bus, gain })?;
        if let Some(given) = self.given.get_mut(&id) {
            given.sends = sends;
        }
        self.note(|names| LogEdit::BodySend { body: names.body(id), bus, gain });
        Ok(())
    }

    pub(super) fn checked_bus(&self, bus: usize) -> Result<usize, AddError> {
        let buses = self.config.audio.len();
        if bus < buses.max(1) { Ok(bus) } else { Err(AddError::UnknownBus { bus, buses }) }
    }

    fn set_body(&mut self, id: BodyId, body: &Body) -> Result<(), AddError> {
        let rested = self.rested.iter().rposition(|rested| *rested.of == *body);
        let rested = rested.map(|index| self.rested.remove(index));
        self.checked_bus(body.bus)?;
        let level = self.levels.body(&self.config, body)?;
        let (message, known) = self.prepared_body(id, body, level, rested)?;
        self.send(message)?;
        self.bodies.set(id.0, known);
        Ok(())
    }

    /// A body as the audio half takes it, at its level; `rested` is one of the same kind that has
    /// rung out.
    pub(crate) fn prepared_body(
        &self,
        id: BodyId,
        body: &Body,
        level: BodyLevel,
        rested: Option<Made>,
    ) -> Result<(Message, KnownBody), AddError> {
        let (model, material, bus) = (&body.model, body.material.checked()?, self.checked_bus(body.bus)?);
        let gain = within("gain", body.gain, limits::impact::GAIN)?;
        within("least_time_s", body.least_time_s, limits::impact::LEAST_TIME_S)?;
        let amount = within("variation", body.variation, limits::impact::VARIATION)?;
        let sends = body.sends;
        let strike_gain = within("strike_gain", level.strike_gain, limits::impact::GAIN)?;
        let (rate, inner) = (self.config.sample_rate_hz, self.config.inner_rate_hz());
        // A pickup may read what is inaudible.
        let audible = self.config.culling.filter(|_| rested.is_none() && body.pickups.is_empty());
        let audible = audible.map(|culling| model.audible(rate, &culling));
        let mass_kg = body.mass_kg.map(|kg| within("mass_kg", kg, limits::material::MASS_KG)).transpose()?;
        let rubs_on = self.surfaces.iter().any(|(_, known)| known.body == Some(id) && known.rubs);
        let heard = audible.as_ref().unwrap_or(model);
        let field = heard.shapes.as_ref().map(|shapes| Arc::new(StrikeField::new(Arc::clone(shapes))));
        let pickups = self.placed_pickups(body, field.as_deref())?;
        let variation = Variation::new(amount, model, self.config.seed);
        let body = if let Some(Made { slot, of }) = rested {
            Made { slot: slot.rested(), of }
        } else {
            let loudest_db_spl = self.loudest_db_spl(body, strike_gain);
            let heard = with_takes(heard, amount, self.config.seed);
            let at_level = Levels::model_at(&heard, level.gain)?;
            let seeded = (self.kernel, self.config.seed);
            let slot = BodySlot::new(&at_level, mass_kg, loudest_db_spl, seeded, (rate, inner), &pickups)?;
            Made {
                slot: Box::new(slot.struck_with(strike_gain, model.position_count())),
                of: Arc::new(body.clone()),
            }
        };
        let frequencies = model.modes.iter().filter(|m| m.amplitude != 0.0).map(|m| m.frequency_hz);
        let lowest_mode_hz = frequencies.fold(f64::INFINITY, f64::min);
        let known =
            KnownBody { material, lowest_mode_hz, field, weighs: mass_kg.is_some(), level, variation };
        if rubs_on && !known.can_be_rubbed() {
            return Err(AddError::CannotRub);
        }
        let stroking = self.stroking(&known)?;
        Ok((Message::SetBody { id, body, bus, sends, gain, stroking }, known))
    }

    /// Sound pressure level of a body's loudest mode under the strike that its modes stand for, dB;
    /// where it is unknown, that of speech.
    fn loudest_db_spl(&self, body: &Body, strike_gain: f64) -> f64 {
        let loudest = body.model.modes.iter().fold(0.0, |most, mode| f64::max(most, mode.amplitude.abs()));
        let known =
            self.config.audio.get(body.bus).and_then(|bus| bus.db_spl(loudest * body.gain * strike_gain));
        known.map_or(LOUDEST_DB_SPL, |db| db.clamp(HEARD_DB_SPL.0, HEARD_DB_SPL.1))
    }

    /// Excitation of a body by strokes.
    pub(super) fn stroking(&self, body: &KnownBody) -> Result<Stroking, DesignError> {
        let (mass_kg, rate_hz) = (colliding_kg(&self.config.probe), self.config.inner_rate_hz());
        Stroking::new(body.material, body.lowest_mode_hz, mass_kg, rate_hz)
    }

    /// Takes a body away; it rings out until it sleeps. Of bodies that were removed or replaced 64
    /// ring at a time: beyond that the quietest fades within a tenth of a second, and is counted
    /// ([`Stats::given_way`](crate::Stats::given_way)).
    ///
    /// # Errors
    /// When it is not in this scene or the queue is full.
    pub fn remove_body(&mut self, body: BodyId) -> Result<(), AddError> {
        self.known_body(body)?;
        self.send(Message::RemoveBody { slot: body.index() })?;
        self.bodies.remove(body.0);
        self.given.remove(&body);
        self.sounded.remove(&body);
        self.strongest.blows_n_s.remove(&body);
        self.moved.remove(&body);
        self.note(|names| LogEdit::RemoveBody { body: names.body(body) });
        Ok(())
    }

    /// Frees surfaces, bodies and ports that the audio half no longer needs; whatever edits the
    /// scene does it too. Returns how many came home. A few bodies are kept for the next of the
    /// same kind, which is added within microseconds.
    pub fn collect(&mut self) -> usize {
        let mut freed = 0;
        while let Some(dead) = self.from_audio.receive() {
            self.open_ports -= usize::from(matches!(dead, Retired::Outlet(_)));
            freed += 1;
            if let Retired::Body(body) = dead
                && body.of.model.shapes.is_none()
            {
                if self.rested.len() == MOST_RESTED {
                    self.rested.remove(0);
                }
                self.rested.push(body);
            }
        }
        freed
    }
}
