//! Upkeep once every [`MAX_BLOCK`](asperity_surface::height_field::MAX_BLOCK) samples, and the end.

use super::Renderer;
use crate::audio::voice::VoiceState;
use crate::link::stats::Counters;
use crate::model::id::SurfaceId;
use std::any::Any;
use std::sync::atomic::Ordering::Relaxed;

impl Renderer {
    /// Results of the surfaces' sources, at the end of a render.
    pub(crate) fn finish(&mut self) -> Vec<(SurfaceId, Box<dyn Any>)> {
        let position = self.position;
        let named = self.seats.iter_mut().filter_map(|seat| Some((seat.id()?, seat)));
        named
            .flat_map(|(id, seat)| seat.finish(position).into_iter().map(move |result| (id, result)))
            .collect()
    }

    /// Once every [`MAX_BLOCK`] samples: contacts that lapsed, modes that rang out, memory to free.
    pub(super) fn tidy(&mut self) {
        self.show_levels();
        self.outlets.tidy(&mut self.to_game);
        self.clips.tidy(self.position, &mut self.to_game);
        self.voices_used.retain(|voice| self.voices[voice].phase != VoiceState::Free);
        for at in 0..self.voices_used.len() {
            let index = self.voices_used.at(at);
            let voice = &self.voices[index];
            let lapsed = self.position.saturating_sub(voice.refreshed) > self.timeout_samples;
            if voice.phase == VoiceState::Sounding && lapsed {
                Counters::add(&self.counters.lapsed, 1);
                self.silence(index, false);
            }
        }
        self.seats_used.retain(|index| {
            let sounds = |voice: usize| self.voices[voice].phase != VoiceState::Free;
            let in_use = || self.voices_used.iter().any(|v| self.voices[v].surface == index && sounds(v));
            self.seats[index].tidy(self.position, in_use, &mut self.to_game);
            !self.seats[index].is_empty()
        });
        self.bodies_used.retain(|index| {
            self.bodies[index].tidy(self.position, &mut self.to_game);
            !self.bodies[index].is_empty()
        });
        let sounding = self.sounding_count() as u64;
        Counters::add(&self.counters.shed, self.groups_shed as u64);
        self.counters.contacts.store(sounding, Relaxed);
    }
}
