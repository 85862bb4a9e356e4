//! Reports of the game: checked, stamped, and sent in order; moves wait, and give way to newer
//! ones, when the way is full.

use super::Scene;
use crate::game::silence::SilenceReason;
use crate::game::variation::Varied;
use crate::link::message::{Felt, Message};
use crate::link::stats::Counters;
use crate::model::bad_value::within;
use crate::model::body::Body;
use crate::model::error::{Refusal, ReportError};
use crate::model::event::{ChannelId, ContactEvent, ContactId, ContactSample, Emphasis, Impact};
use crate::model::id::{BodyId, ProbeId, SurfaceId};
use crate::model::stamp::Stamp;
use crate::resource::bank::LONGEST_CONTACT_S;
use crate::resource::strike_point::StrikePoint;

use asperity_dsp::hertz::{HertzContact, HertzPulse};
use asperity_dsp::limits;
use std::sync::atomic::Ordering::Relaxed;

/// Mass behind a probe below which it is a finger, or a tool that is held lightly, kg.
const LIGHT_KG: f64 = 0.5;

impl Scene {
    /// Reports what a contact did at game time `time_s`. Returns at once.
    ///
    /// # Errors
    /// The event is handed back with the reason: a bad number, an unknown name, time running
    /// backwards (with an exact clock), or a full queue. Moves are the last to be refused: when the
    /// queue runs full only the newest move of each contact is kept, and sent with the next report.
    #[expect(
        clippy::result_large_err,
        reason = "the event is handed back whole, without a box on the game thread"
    )]
    pub fn report(&mut self, time_s: f64, event: ContactEvent) -> Result<(), ReportError> {
        self.report_with(time_s, event, 0)
    }

    /// Reports a strike with a ticket; 0 = any event without one.
    #[expect(clippy::result_large_err, reason = "as above")]
    pub(super) fn report_with(
        &mut self,
        time_s: f64,
        event: ContactEvent,
        ticket: u32,
    ) -> Result<(), ReportError> {
        self.try_report(time_s, event, ticket).map_err(|reason| {
            let cell = match reason {
                Refusal::QueueFull => &self.counters.dropped,
                _ => &self.counters.refused,
            };
            Counters::add(cell, 1);
            self.reported.refuse(reason);
            ReportError { event, reason }
        })
    }

    /// Reasons against anything being heard or felt, or against its being right, the likeliest
    /// first; empty when nothing does: reports that contradict themselves are among it. Each reason
    /// says what would be right. To be asked when a scene is silent, or to be logged.
    ///
    /// ```
    /// use asperity::{Config, Engine};
    ///
    /// let Engine { scene, .. } = Config::default().build()?;
    /// assert!(scene.why_silent()[0].to_string().contains("Renderer::render"));
    /// # Ok::<(), asperity::ConfigError>(())
    /// ```
    #[must_use]
    pub fn why_silent(&self) -> Vec<SilenceReason> {
        let contradictions = self.motions.contradictions().into_iter().map(SilenceReason::Contradicts);
        let mut because = self.reported.why_silent(&self.stats(), &self.config);
        because.extend(contradictions);
        because
    }

    fn try_report(&mut self, time_s: f64, event: ContactEvent, ticket: u32) -> Result<(), Refusal> {
        if let ContactEvent::Motion { body, motion } = event {
            return self.report_motion(time_s, body, motion);
        }
        let original = event;
        let (event, held) = self.checked(event)?;
        let goes_back = ticket != 0 && time_s < self.clock.newest_s();
        if goes_back {
            within("time_s", time_s, limits::LIVE_TIME_S)?;
        } else {
            self.checked_time(time_s)?;
        }
        Counters::add(&self.counters.held, u64::from(held));
        self.note_touch(&original);
        let position = self.counters.position.load(Relaxed);
        self.settle_recording(position);
        let stamped = if goes_back {
            self.clock.stamp_back(time_s)
        } else {
            self.clock.stamp(time_s, position, matches!(event, ContactEvent::Impact(_)))
        };
        self.show_epochs();
        Counters::add(&self.counters.clock_jumps, u64::from(stamped.jumped));
        Counters::add(&self.counters.clock_paces, u64::from(stamped.repaced));
        self.counters.ahead.store(stamped.stamp.sample().saturating_sub(position), Relaxed);
        self.flush_held();
        let stamp = stamped.stamp;
        let in_game_time = event.with_velocity_of(&original);
        let event = event.at_pace(self.clock.pace());
        if let ContactEvent::Impact(impact) = &event
            && self.comes_too_soon(stamp, impact)
        {
            Counters::add(&self.counters.too_soon, 1);
            return Ok(());
        }
        let levelled = self.levelled(event);
        let touched = |contact| self.touched.get(&contact).map(|touched| touched.surface);
        self.strongest.note(&levelled, touched);
        let sent = self.spun(stamp.sample() as f64 / self.config.inner_rate_hz(), levelled);
        self.send_stamped(stamp, sent, ticket)?;
        let (rings, is_light) = (self.rings(&sent), self.is_light(&sent));
        self.reported.accept(&sent, (time_s, stamp), rings, is_light);
        let sheet = |surface: SurfaceId| self.surfaces.get(surface.0).map(|known| known.sheet);
        self.motions.note(time_s, &in_game_time, self.config.contact_timeout_s, sheet);
        if let Some(recording) = &mut self.recording {
            let rate_hz = self.config.inner_rate_hz();
            let reported = (self.clock.epoch(), position as f64 / rate_hz);
            recording.note(stamp.samples() / rate_hz, reported, &event.at_place_of(&original), ticket);
        }
        Ok(())
    }

    /// Tests whether an impact comes sooner after the last on its body than the least time, and is
    /// no stronger; it counts as the last if not.
    fn comes_too_soon(&mut self, stamp: Stamp, impact: &Impact) -> bool {
        let least_time_s = self.given.get(&impact.body).map_or(0.0, |body| body.least_time_s);
        if least_time_s == 0.0 {
            return false;
        }
        // Where game time stands, as in a menu, that of the audio goes on.
        let now = stamp.samples().max(self.counters.position.load(Relaxed) as f64);
        let impulse = impact.impulse_n_s();
        let least = least_time_s * self.config.inner_rate_hz();
        let before = self.sounded.get(&impact.body);
        let too_soon =
            before.is_some_and(|(then, strong)| (0.0..least).contains(&(now - then)) && impulse <= *strong);
        if !too_soon {
            self.sounded.insert(impact.body, (now, impulse));
        }
        too_soon
    }

    /// Tests whether a contact begins with a finger, or with a tool that a hand holds lightly.
    fn is_light(&self, event: &ContactEvent) -> bool {
        let ContactEvent::Begin { touching, .. } = event else { return false };
        let own = || Some(&self.config.probe);
        let probe = touching.probe.map_or_else(own, |id| self.probes.get(id.0));
        probe.is_some_and(|probe| probe.finger_mass_kg < LIGHT_KG)
    }

    /// Tests whether what an event touches has modes.
    fn rings(&self, event: &ContactEvent) -> bool {
        let has_modes =
            |id: BodyId| self.bodies.get(id.0).is_some_and(|body| body.lowest_mode_hz.is_finite());
        match event {
            ContactEvent::Begin { touching, .. } => {
                touching.holder.is_some_and(has_modes)
                    || self.surfaces.get(touching.surface.0).is_some_and(|known| known.rings)
            }
            ContactEvent::Impact(impact) => {
                [Some(impact.body), impact.other, impact.holder].into_iter().flatten().any(has_modes)
            }
            ContactEvent::Moved { .. } | ContactEvent::End { .. } | ContactEvent::Motion { .. } => false,
        }
    }

    fn send_stamped(&mut self, stamp: Stamp, event: ContactEvent, ticket: u32) -> Result<(), Refusal> {
        match event {
            ContactEvent::Moved { contact, sample, emphasis } => {
                self.send_move(stamp, contact, sample, emphasis)
            }
            ContactEvent::Begin { contact, .. } | ContactEvent::End { contact } => {
                let before = self.held.len();
                self.held.retain(|(_, held, _)| *held != contact);
                Counters::add(&self.counters.superseded, (before - self.held.len()) as u64);
                self.send_contact(stamp, event)
            }
            ContactEvent::Impact(impact) => self.send_impact(stamp, &impact, ticket),
            // It takes its own way.
            ContactEvent::Motion { .. } => Ok(()),
        }
    }

    pub(super) fn checked_time(&mut self, time_s: f64) -> Result<(), Refusal> {
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

    /// The event as it is sent, and whether a number of it was held at its limit.
    fn checked(&self, event: ContactEvent) -> Result<(ContactEvent, bool), Refusal> {
        Ok(match event {
            ContactEvent::Begin { contact, mut touching, sample } => {
                let known = self.known_surface(touching.surface).map_err(|_| Refusal::UnknownSurface)?;
                let sample = sample.on(&known.place)?;
                self.check_hand(touching.actuator, touching.holder, touching.probe)?;
                within("gain", touching.gain, limits::impact::GAIN)?;
                within("importance", touching.importance, limits::impact::IMPORTANCE)?;
                // What rubs itself rings once: the same impulses back on it would cancel to
                // silence.
                touching.holder = touching.holder.filter(|holder| known.body != Some(*holder));
                let (sample, held) = sample.held()?;
                (ContactEvent::Begin { contact, touching, sample }, held)
            }
            ContactEvent::Moved { contact, sample, emphasis } => {
                let sample = self.on_touched(contact, sample)?;
                let (sample, held) = sample.held()?;
                (ContactEvent::moved_with(contact, sample, emphasis.checked()?), held)
            }
            ContactEvent::End { .. } | ContactEvent::Motion { .. } => (event, false),
            ContactEvent::Impact(impact) => {
                for body in [Some(impact.body), impact.other].into_iter().flatten() {
                    self.known_body(body).map_err(|_| Refusal::UnknownBody)?;
                }
                self.check_hand(impact.actuator, impact.holder, impact.probe)?;
                let (mut impact, held) = impact.held()?;
                for body in [&mut impact.other, &mut impact.holder] {
                    *body = body.filter(|body| *body != impact.body);
                }
                (ContactEvent::Impact(impact), held)
            }
        })
    }

    /// Who feels it, what is held, and what touches have to be in this scene.
    fn check_hand(
        &self,
        actuator: Option<ChannelId>,
        holder: Option<BodyId>,
        probe: Option<ProbeId>,
    ) -> Result<(), Refusal> {
        let channels = self.config.actuators.len();
        if let Some(ChannelId(index)) = actuator.filter(|actuator| usize::from(actuator.0) >= channels) {
            return Err(Refusal::UnknownActuator { index, channels });
        }
        if let Some(holder) = holder {
            self.known_body(holder).map_err(|_| Refusal::UnknownBody)?;
        }
        match probe {
            Some(probe) if self.probes.get(probe.0).is_none() => Err(Refusal::UnknownProbe),
            _ => Ok(()),
        }
    }

    fn send_move(
        &mut self,
        stamp: Stamp,
        contact: ContactId,
        sample: ContactSample,
        emphasis: Emphasis,
    ) -> Result<(), Refusal> {
        let event = ContactEvent::moved_with(contact, sample, emphasis);
        // The last quarter of the queue is kept for landings, lift-offs and impacts.
        if self.to_audio.free() > self.to_audio.capacity() / 4 {
            return self.send_contact(stamp, event);
        }
        if let Some((at, _, held)) = self.held.iter_mut().find(|(_, held, _)| *held == contact) {
            // A place gives way to the next one; a gain that was asked for does not.
            let earlier = if let ContactEvent::Moved { emphasis, .. } = held { *emphasis } else { emphasis };
            (*at, *held) = (stamp, ContactEvent::moved_with(contact, sample, emphasis.or(earlier)));
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
            let _ = self.send_contact(stamp, event);
        }
    }

    /// The pulse of an impact; none where its numbers are no contact.
    pub(super) fn pulse(&self, impact: &Impact) -> Option<HertzPulse> {
        let known = self.bodies.get(impact.body.0);
        let material = known.map_or(Body::DEFAULT_MATERIAL, |body| body.material);
        let contact = HertzContact::new(
            &impact.striker.elastic(),
            &material.elastic(),
            impact.radius_m,
            impact.mass_kg,
        );
        let contact_time_s = contact.ok()?.contact_time_s(impact.speed_m_s).min(LONGEST_CONTACT_S);
        let restitution = impact.restitution;
        Some(HertzPulse { impulse_n_s: impact.impulse_n_s(), contact_time_s, restitution })
    }

    fn send_impact(&mut self, stamp: Stamp, impact: &Impact, ticket: u32) -> Result<(), Refusal> {
        let mut pulse = self.pulse(impact).ok_or(Refusal::UnknownBody)?;
        let varied = self.varied(impact);
        pulse.contact_time_s = (varied.softer * pulse.contact_time_s).min(LONGEST_CONTACT_S);
        let shortened = pulse.contact_time_s == LONGEST_CONTACT_S;
        if pulse.impulse_n_s == 0.0 {
            return Ok(());
        }
        Counters::add(&self.counters.shortened, u64::from(shortened));
        let other = impact.other.map(BodyId::index);
        // What is held is felt; by the first channel, if no other is named.
        let channel = impact.actuator.or(impact.holder.map(|_| ChannelId(0)));
        let felt = channel
            .map(|channel| Felt { channel: usize::from(channel.0), probe: impact.probe.map(ProbeId::index) });
        self.clock.note_strike(stamp);
        if ticket != 0 {
            self.counters.tickets.arm(ticket);
        }
        self.send_event(Message::Strike {
            stamp,
            epoch: self.clock.epoch(),
            body: impact.body.index(),
            spot: self.struck(impact, &varied),
            other,
            holder: impact.holder.map(BodyId::index),
            felt,
            pulse,
            ticket,
        })
    }

    fn send_contact(&mut self, stamp: Stamp, event: ContactEvent) -> Result<(), Refusal> {
        let place = self.touched(&event);
        if let ContactEvent::End { contact } = &event {
            self.touched.remove(contact);
        }
        self.send_event(Message::Event { stamp, epoch: self.clock.epoch(), event, place })
    }

    /// Differences of an impact from what was reported, where those on its body vary.
    fn varied(&mut self, impact: &Impact) -> Varied {
        let variation = self.bodies.get_mut(impact.body.0).and_then(|body| body.variation.as_mut());
        variation.map_or(Varied::NONE, |variation| variation.draw(impact.position))
    }

    /// Place of an impact on its body.
    fn struck(&self, impact: &Impact, varied: &Varied) -> StrikePoint {
        let field = self.bodies.get(impact.body.0).and_then(|body| body.field.as_ref());
        let place = field.and_then(|field| {
            let asked_m =
                impact.at_m.or_else(|| (*varied != Varied::NONE).then(|| field.struck_point_m()))?;
            let at_m = [0, 1, 2].map(|axis| asked_m[axis] + varied.aside_m[axis]);
            field.place(at_m, impact.direction)
        });
        let of = StrikePoint::new(place, impact.position);
        StrikePoint { other: varied.other, seed: varied.seed, ..of }
    }

    pub(super) fn send_event(&mut self, message: Message) -> Result<(), Refusal> {
        self.to_audio.send(message).map_err(|_| Refusal::QueueFull)
    }
}
