//! Contacts come, go on, are stolen, revived and let go.

use super::Renderer;
use crate::clock::Stamp;
use crate::event::{ContactEvent, ContactId, ContactSample};
use crate::stats::Counters;
use crate::voice::{Phase, Voice};

/// A contact that goes on without a voice: it lapsed, or its voice was stolen. A later move revives it.
#[derive(Clone, Copy)]
pub(super) struct SilentContact {
    contact: ContactId,
    surface: usize,
    actuator: usize,
    stolen: bool,
}

impl Renderer {
    pub(super) fn apply_event(&mut self, event: &ContactEvent, stamp: Stamp) {
        match *event {
            ContactEvent::Begin { contact, surface, actuator, sample } => {
                let (surface, actuator) = (surface.0 as usize, usize::from(actuator.0));
                if !self.resume(contact, surface, actuator, &sample, stamp) {
                    self.end(contact);
                    self.begin(contact, surface, actuator, &sample, stamp);
                }
            }
            ContactEvent::Moved { contact, sample } => self.moved(contact, &sample, stamp),
            ContactEvent::End { contact } => {
                if !self.end(contact) {
                    Counters::add(&self.counters.orphaned, 1);
                }
            }
            // The scene turns impacts into strikes before they are sent.
            ContactEvent::Impact(_) => {}
        }
    }

    /// A landing right after a lift-off of the same contact at the same place is the physics engine's
    /// flicker, not the finger's: while the contact still fades it goes on as if it had never ended,
    /// its closing speed unheard. Whether it was so.
    fn resume(
        &mut self,
        contact: ContactId,
        surface: usize,
        actuator: usize,
        sample: &ContactSample,
        stamp: Stamp,
    ) -> bool {
        let Some(slot) = self.seats[surface].current().filter(|_| self.seats[surface].is_open()) else {
            return false;
        };
        // A contact that has landed again meanwhile sounds once, not twice.
        if sounding(&mut self.voices, contact).is_some() || self.sounding_count() >= self.contact_limit() {
            return false;
        }
        let Some(voice) = self.voices.iter_mut().find(|voice| {
            voice.contact == contact
                && (voice.surface, voice.actuator) == (surface, actuator)
                && voice.ended
                && matches!(voice.phase, Phase::Fading { .. })
                && voice.is_near(sample, slot)
        }) else {
            return false;
        };
        voice.resume(&self.shared);
        voice.moved(sample, slot, stamp, self.position);
        self.silent.retain(|silent| silent.contact != contact);
        Counters::add(&self.counters.debounced, 1);
        true
    }

    fn begin(
        &mut self,
        contact: ContactId,
        surface: usize,
        actuator: usize,
        sample: &ContactSample,
        stamp: Stamp,
    ) {
        if !self.seats[surface].is_open() {
            Counters::add(&self.counters.orphaned, 1);
            return;
        }
        let due = self.due(stamp);
        let voice = self.take_voice();
        self.voices_used.insert(voice);
        let voice = &mut self.voices[voice];
        (voice.surface, voice.actuator) = (surface, actuator);
        voice.begin(
            contact,
            sample,
            &mut self.seats[surface],
            &self.channels[actuator].output,
            &self.shared,
            due,
            &mut self.scratch,
        );
    }

    fn moved(&mut self, contact: ContactId, sample: &ContactSample, stamp: Stamp) {
        if let Some(voice) = sounding(&mut self.voices, contact) {
            if let Some(slot) = self.seats[voice.surface].current() {
                voice.moved(sample, slot, stamp, self.position);
            }
            return;
        }
        let Some(index) = self.silent.iter().position(|silent| silent.contact == contact) else {
            Counters::add(&self.counters.orphaned, 1);
            return;
        };
        let silent = self.silent[index];
        if silent.stolen && self.sounding_count() >= self.contact_limit() {
            Counters::add(&self.counters.orphaned, 1);
            return;
        }
        self.silent.swap_remove(index);
        let landed = ContactSample { closing_m_s: 0.0, ..*sample };
        self.begin(contact, silent.surface, silent.actuator, &landed, stamp);
    }

    /// Whether there was such a contact.
    fn end(&mut self, contact: ContactId) -> bool {
        let known_silent = self.silent.iter().position(|silent| silent.contact == contact);
        if let Some(index) = known_silent {
            self.silent.swap_remove(index);
        }
        let sounding = sounding(&mut self.voices, contact).map(|voice| {
            voice.fade(&self.shared);
            voice.ended = true;
        });
        sounding.is_some() || known_silent.is_some()
    }

    pub(super) fn sounding_count(&self) -> usize {
        self.voices_used.iter().filter(|&voice| self.voices[voice].phase == Phase::Sounding).count()
    }

    /// A voice for a new contact: a free one, after stealing the least important when all are taken.
    fn take_voice(&mut self) -> usize {
        if self.sounding_count() >= self.contact_limit() {
            Counters::add(&self.counters.stolen, 1);
            self.silence_least();
        }
        let remaining = |voice: &Voice| match voice.phase {
            Phase::Free => 0,
            Phase::Fading { left } => left,
            Phase::Sounding => u32::MAX,
        };
        (0..self.voices.len()).min_by_key(|&i| remaining(&self.voices[i])).unwrap_or(0)
    }

    /// Fades the least important contact.
    pub(super) fn silence_least(&mut self) {
        let priority = |i: &usize| self.voices[*i].priority();
        let sounding = self.voices_used.iter().filter(|&i| self.voices[i].phase == Phase::Sounding);
        if let Some(least) = sounding.min_by(|a, b| priority(a).total_cmp(&priority(b))) {
            self.silence(least, true);
        }
    }

    /// Fades a contact but remembers it, so that its next move can revive it.
    pub(super) fn silence(&mut self, voice: usize, stolen: bool) {
        let voice = &mut self.voices[voice];
        voice.fade(&self.shared);
        if self.silent.len() == self.silent.capacity() {
            self.silent.swap_remove(0);
        }
        self.silent.push(SilentContact {
            contact: voice.contact,
            surface: voice.surface,
            actuator: voice.actuator,
            stolen,
        });
    }

    pub(super) fn fade_contacts_on(&mut self, slot: usize) {
        for voice in self.voices.iter_mut().filter(|voice| voice.surface == slot) {
            voice.fade(&self.shared);
        }
        self.silent.retain(|silent| silent.surface != slot);
    }
}

fn sounding(voices: &mut [Voice], contact: ContactId) -> Option<&mut Voice> {
    voices.iter_mut().find(|voice| voice.contact == contact && voice.phase == Phase::Sounding)
}
