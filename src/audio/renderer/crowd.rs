//! Crowds: which contacts of a surface are computed, and which are spoken for ([`StandIns`](crate::audio::stand_in::StandIns)).
//!
//! Only what nobody feels or holds is spoken for, on ground that remembers nothing and rubs nothing. Half of the contacts that are computed are those that
//! came first, a sample of the crowd as chance draws it; the other half are its loudest: who is half as loud again as the least of them takes its
//! place with its next report.

use super::Renderer;
use super::contacts::SilentContact;
use crate::audio::stand_in::Stroke;
use crate::audio::voice::{Phase, Role, Voice};
use crate::link::stats::Counters;
use crate::model::event::ContactSample;
use crate::model::stamp::Stamp;
use crate::prepared::early::Sent;
use crate::prepared::surface::SurfaceSlot;
use asperity_texture::height_field::HeightField;

/// How much louder than the least of the loudest a contact must be to take its place.
const LOUDER: f64 = 1.5;

/// A contact that is spoken for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpokenFor {
    stroke: Stroke,
    refreshed: u64,
    /// Where it was reported last, and when, samples.
    uv: [f64; 2],
    at: f64,
    velocity_m_s: [f64; 2],
}

impl Renderer {
    /// Whether a contact that is not computed at present goes on being spoken for, or is from now on.
    pub(super) fn is_spoken_for(&mut self, surface: usize, role: Role, sample: &ContactSample) -> bool {
        if !self.stand_ins.are_on() || role.actuator.is_some() || role.holder.is_some() {
            return false;
        }
        // What gives way under a tip remembers it.
        let gives_way = |source: &mut dyn HeightField| source.carries_n([0.0; 2], 1e-3).is_some();
        if self.seats[surface].source().is_none_or(gives_way) {
            return false;
        }
        let alone = |slot: &SurfaceSlot| slot.surface.rubs().is_some() || slot.surface.body.is_none();
        if self.seats[surface].current().is_none_or(alone) {
            return false;
        }
        let (mut computed, mut least) = (0, None::<(usize, f64)>);
        for index in self.voices_used.iter() {
            let voice = &self.voices[index];
            if !speaks(voice) || voice.surface != surface {
                continue;
            }
            computed += 1;
            let priority = voice.priority();
            if !self.came_first[index] && least.is_none_or(|(_, least)| priority < least) {
                least = Some((index, priority));
            }
        }
        if computed < self.stand_ins.exact() || !self.stand_ins.open(surface) {
            return false;
        }
        let [u, v] = sample.velocity_m_s.unwrap_or([0.0; 2]);
        let priority = role.importance * sample.normal_force_n * (1e-3 + libm::sqrt(u * u + v * v));
        match least {
            Some((index, least)) if priority > LOUDER * least => {
                self.stand_back(index);
                false
            }
            _ => true,
        }
    }

    /// What is reported of a contact that has no voice, with a velocity: where none is reported, it is what leads from the last place to this one.
    pub(super) fn with_velocity(
        &self,
        silent: &SilentContact,
        sample: ContactSample,
        stamp: Stamp,
    ) -> ContactSample {
        let slot = self.seats[silent.surface].current().filter(|_| self.stand_ins.are_on());
        let (Some(slot), Some(before), None) = (slot, silent.spoken_for, sample.velocity_m_s) else {
            return sample;
        };
        let seconds = (stamp.samples() - before.at) / self.shared.sample_rate_hz;
        if seconds <= 0.0 {
            return ContactSample { velocity_m_s: Some(before.velocity_m_s), ..sample };
        }
        let per_s = |axis: usize, size_m: f64| {
            let way = sample.uv[axis] - before.uv[axis];
            // The short way round, where the surface repeats.
            let way = if slot.period_m[axis].is_finite() { way - way.round() } else { way };
            way * size_m / seconds
        };
        let velocity_m_s = Some([per_s(0, slot.surface.width_m), per_s(1, slot.surface.height_m)]);
        ContactSample { velocity_m_s, ..sample }
    }

    /// Remembers a contact, or what it does now, that is spoken for.
    pub(super) fn speak_for(&mut self, silent: SilentContact, sample: &ContactSample, stamp: Stamp) {
        let velocity_m_s = sample.velocity_m_s.unwrap_or([0.0; 2]);
        let stroke = Stroke::new(sample.normal_force_n, velocity_m_s, silent.role.gain);
        let (refreshed, uv, at) = (self.position, sample.uv, stamp.samples());
        let spoken_for = Some(SpokenFor { stroke, refreshed, uv, at, velocity_m_s });
        self.remember(SilentContact { spoken_for, ..silent });
    }

    /// Fades a contact that is computed and has it spoken for.
    fn stand_back(&mut self, index: usize) {
        let voice = &mut self.voices[index];
        let (stroke, (_, velocity_m_s)) = (stroke(voice), voice.going());
        voice.fade(&self.shared);
        let (refreshed, at) = (voice.refreshed, self.position as f64);
        let size_m =
            self.seats[voice.surface].current().map(|slot| [slot.surface.width_m, slot.surface.height_m]);
        let uv = voice.uv(size_m.unwrap_or([1.0; 2]));
        let spoken_for = Some(SpokenFor { stroke, refreshed, uv, at, velocity_m_s });
        let silent = SilentContact { spoken_for, ..SilentContact::of(voice) };
        self.remember(silent);
    }

    /// A contact has a voice from now on: one of the crowd that came first, or one of its loudest.
    pub(super) fn note_crowd(&mut self, index: usize) {
        if !self.stand_ins.are_on() {
            return;
        }
        self.stand_ins.begin(index);
        let surface = self.voices[index].surface;
        let first = |other: &usize| {
            let voice = &self.voices[*other];
            *other != index && speaks(voice) && voice.surface == surface && self.came_first[*other]
        };
        self.came_first[index] = self.voices_used.iter().filter(first).count() < self.stand_ins.exact() / 2;
    }

    /// Now and then: who speaks for whom.
    pub(super) fn look_at_crowds(&mut self) {
        if !self.stand_ins.looks(self.position) {
            return;
        }
        let Self { stand_ins, silent, voices, voices_used, seats, .. } = self;
        stand_ins.forget();
        let (position, timeout) = (self.position, self.timeout_samples);
        for silent in silent.iter_mut() {
            let Some(SpokenFor { stroke: of, refreshed, .. }) = silent.spoken_for else { continue };
            let lapsed = position.saturating_sub(refreshed) > timeout;
            if lapsed || !seats[silent.surface].is_open() {
                Counters::add(&self.counters.lapsed, u64::from(lapsed));
                silent.spoken_for = None;
                continue;
            }
            stand_ins.open(silent.surface);
            let speakers = voices_used.iter().filter(|index| {
                let voice = &voices[*index];
                speaks(voice) && voice.surface == silent.surface
            });
            stand_ins.speak(&of, speakers.map(|index| (index, stroke(&voices[index]))));
        }
        stand_ins.said();
    }

    /// What stands in for those that are spoken for reaches the bodies.
    pub(super) fn render_crowds(&mut self, n: usize) {
        let Self { stand_ins, seats, bodies, .. } = self;
        let place = |surface: usize| {
            let slot: &SurfaceSlot = seats[surface].current()?;
            Some((slot.surface.body?, slot.surface.strike_position))
        };
        stand_ins.render(self.position, n, place, |(body, position), [impulse_n_s, force_n_s]| {
            bodies[body.index()].touch(body, position, Sent { impulse_n_s, force_n_s }, 1.0);
        });
    }

    /// Contacts that are spoken for.
    pub(super) fn spoken_for(&self) -> usize {
        self.silent.iter().filter(|silent| silent.spoken_for.is_some()).count()
    }
}

/// Whether a voice is computed for a crowd.
fn speaks(voice: &Voice) -> bool {
    voice.phase == Phase::Sounding && voice.role.actuator.is_none() && voice.role.holder.is_none()
}

fn stroke(voice: &Voice) -> Stroke {
    let (force_n, velocity_m_s) = voice.going();
    Stroke::new(force_n, velocity_m_s, voice.role.gain)
}
