//! Contacts come, go on, are stolen, revived and let go.

use super::Renderer;
use crate::audio::binding::Binding;
use crate::audio::shared::Segment;
use crate::audio::voice::{EMPTY_FORCE_N, Voice, VoiceState};
use crate::link::stats::Counters;
use crate::model::event::{ContactEvent, ContactId, ContactSample, Emphasis, MAX_FORCE_N};
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use asperity_dsp::trajectory::Trajectory;

/// A contact that goes on without a voice: it lapsed, or its voice was stolen. A later move revives
/// it.
#[derive(Clone, Copy)]
pub(super) struct SilentContact {
    pub(super) contact: ContactId,
    pub(super) surface: usize,
    pub(super) role: Binding,
    pub(super) stolen: bool,
}

impl SilentContact {
    /// A contact whose voice goes away.
    pub(super) fn of(voice: &Voice) -> Self {
        let (contact, surface, role) = (voice.contact, voice.surface, voice.role);
        Self { contact, surface, role, stolen: false }
    }
}

impl Renderer {
    /// The contact of an event that was applied is at a place of a body from now on.
    pub(super) fn put(&mut self, event: &ContactEvent, place: Option<StrikePlace>) {
        let (ContactEvent::Begin { contact, .. } | ContactEvent::Moved { contact, .. }) = *event else {
            return;
        };
        if let Some(voice) = sounding(&self.voices, contact) {
            self.placed[voice] = place;
        }
    }

    pub(super) fn apply_event(&mut self, event: &ContactEvent, stamp: Stamp) {
        match *event {
            ContactEvent::Begin { contact, touching, sample } => {
                let (surface, role) = (touching.surface.index(), Binding::from(&touching));
                let sample = self.carried(surface, &sample);
                if !self.resume(contact, surface, role, &sample, stamp) {
                    self.end(contact);
                    self.land(contact, surface, role, &sample, stamp);
                }
            }
            ContactEvent::Moved { contact, sample, emphasis } => {
                self.emphasise(contact, emphasis);
                self.moved(contact, &sample, stamp);
            }
            ContactEvent::End { contact } => {
                if !self.end(contact) {
                    Counters::add(&self.counters.orphaned, 1);
                }
            }
            // The scene turns impacts into strikes before they are sent.
            ContactEvent::Impact(_) | ContactEvent::Motion { .. } => {}
        }
    }

    /// A tip that stands at a depth presses as hard as the surface carries it there.
    fn carried(&mut self, surface: usize, sample: &ContactSample) -> ContactSample {
        let carried_n = sample.depth_m.map(|depth_m| self.seats[surface].support_force_n(sample.uv, depth_m));
        let normal_force_n = carried_n.map_or(sample.normal_force_n, |n| n.min(MAX_FORCE_N));
        ContactSample { normal_force_n, ..*sample }
    }

    /// A landing right after a lift-off of the same contact at the same place is the physics
    /// engine's flicker, not the finger's: while the contact still fades it goes on as if it had
    /// never ended, its closing speed unheard. Whether it was so.
    fn resume(
        &mut self,
        contact: ContactId,
        surface: usize,
        role: Binding,
        sample: &ContactSample,
        stamp: Stamp,
    ) -> bool {
        let Some(slot) = self.seats[surface].current().filter(|_| self.seats[surface].is_open()) else {
            return false;
        };
        // A contact that has landed again meanwhile sounds once, not twice.
        if sounding(&self.voices, contact).is_some() || self.sounding_count() >= self.contact_limit() {
            return false;
        }
        let Some(voice) = self.voices.iter_mut().find(|voice| {
            voice.contact == contact
                && (voice.surface, voice.role) == (surface, role)
                && voice.ended
                && matches!(voice.phase, VoiceState::Fading { .. })
                && voice.goes_on_at(sample, slot, stamp)
        }) else {
            return false;
        };
        voice.resume(&self.shared);
        voice.carry(sample);
        // It does not jump: see above.
        let _: Option<Trajectory> = voice.moved(sample, slot, stamp, self.position);
        self.silent.retain(|silent| silent.contact != contact);
        Counters::add(&self.counters.debounced, 1);
        true
    }

    /// A contact lands. One that neither presses nor falls is not there yet: its first force begins
    /// it.
    fn land(
        &mut self,
        contact: ContactId,
        surface: usize,
        role: Binding,
        sample: &ContactSample,
        stamp: Stamp,
    ) {
        let silent = SilentContact { contact, surface, role, stolen: false };
        if sample.normal_force_n > EMPTY_FORCE_N || sample.closing_m_s > 0.0 {
            self.begin(contact, surface, role, sample, stamp);
        } else if self.seats[surface].is_open() {
            Counters::add(&self.counters.unpressed, 1);
            self.remember(silent);
        } else {
            Counters::add(&self.counters.orphaned, 1);
        }
    }

    /// Takes a voice for a contact that begins, if its surface is there, and returns which.
    fn begin(
        &mut self,
        contact: ContactId,
        surface: usize,
        role: Binding,
        sample: &ContactSample,
        stamp: Stamp,
    ) -> Option<usize> {
        if !self.seats[surface].is_open() {
            Counters::add(&self.counters.orphaned, 1);
            return None;
        }
        let due = self.due(stamp);
        // Its voice of before may still fade: from now on it is shown here alone.
        self.voices
            .iter_mut()
            .filter(|voice| voice.contact == contact)
            .for_each(|voice| voice.leave(&self.shared));
        let index = self.take_voice();
        self.voices_used.insert(index);
        let voice = &mut self.voices[index];
        (voice.surface, voice.role) = (surface, role);
        let output = role.actuator.map_or(&self.shared.idle_output, |channel| &self.channels[channel].output);
        let at = Segment { shared: &self.shared, output, position: due.sample(), n: 1 };
        voice.begin(contact, sample, due, at, &mut self.seats[surface], &mut self.scratch);
        Some(index)
    }

    /// Another gain or importance from now on, of a contact that sounds or waits.
    fn emphasise(&mut self, contact: ContactId, emphasis: Emphasis) {
        if let Some(index) = sounding(&self.voices, contact) {
            self.voices[index].role.emphasise(emphasis);
        } else if let Some(silent) = self.silent.iter_mut().find(|silent| silent.contact == contact) {
            silent.role.emphasise(emphasis);
        }
    }

    fn moved(&mut self, contact: ContactId, sample: &ContactSample, stamp: Stamp) {
        if let Some(index) = sounding(&self.voices, contact) {
            let mut sample = self.carried(self.voices[index].surface, sample);
            let voice = &mut self.voices[index];
            voice.carry(&sample);
            let Some(normal_force_n) = voice.pressed_n(sample.normal_force_n) else {
                Counters::add(&self.counters.unpressed, 1);
                return self.silence(index, false);
            };
            Counters::add(&self.counters.unpressed, u64::from(normal_force_n != sample.normal_force_n));
            sample.normal_force_n = normal_force_n;
            if let Some(slot) = self.seats[voice.surface].current()
                && let Some(path) = voice.moved(&sample, slot, stamp, self.position)
            {
                self.jump(index, &sample, &path, stamp);
            }
            return;
        }
        let Some(index) = self.silent.iter().position(|silent| silent.contact == contact) else {
            Counters::add(&self.counters.orphaned, 1);
            return;
        };
        let silent = self.silent[index];
        let sample = self.carried(silent.surface, sample);
        if sample.normal_force_n <= EMPTY_FORCE_N {
            Counters::add(&self.counters.unpressed, 1);
            return;
        }
        if silent.stolen && self.sounding_count() >= self.contact_limit() {
            Counters::add(&self.counters.orphaned, 1);
            return;
        }
        self.silent.retain(|other| other.contact != contact);
        let landed = ContactSample { closing_m_s: 0.0, ..sample };
        self.begin(contact, silent.surface, silent.role, &landed, stamp);
    }

    /// A contact that is suddenly elsewhere fades where it was and rises where it is, each over the
    /// relief of its own place: a profile that steps from one to the other would strike the pad.
    fn jump(&mut self, index: usize, sample: &ContactSample, path: &Trajectory, stamp: Stamp) {
        Counters::add(&self.counters.jumps, 1);
        let voice = &mut self.voices[index];
        let (contact, surface, role) = (voice.contact, voice.surface, voice.role);
        voice.leave(&self.shared);
        let Some(slot) = self.seats[surface].current() else { return };
        // A late report holds where the contact was; it begins where it is by now.
        let late_s = (self.due(stamp).samples() - stamp.samples()) / self.shared.sample_rate_hz;
        let velocity_m_s = path.believed_velocity_m_s();
        let uv = [
            sample.uv[0] + velocity_m_s[0] * late_s / slot.surface.width_m,
            sample.uv[1] + velocity_m_s[1] * late_s / slot.surface.height_m,
        ];
        let landed = ContactSample { uv, velocity_m_s: Some(velocity_m_s), closing_m_s: 0.0, ..*sample };
        let voice = self.begin(contact, surface, role, &landed, stamp);
        if let Some(voice) = voice {
            self.voices[voice].inherit_rate(path);
        }
    }

    /// Tests whether there was such a contact.
    fn end(&mut self, contact: ContactId) -> bool {
        let known_silent = self.silent.iter().position(|silent| silent.contact == contact);
        if let Some(index) = known_silent {
            self.silent.swap_remove(index);
        }
        let sounding = sounding(&self.voices, contact).map(|index| {
            let voice = &mut self.voices[index];
            voice.fade(&self.shared);
            voice.ended = true;
        });
        sounding.is_some() || known_silent.is_some()
    }

    pub(super) fn sounding_count(&self) -> usize {
        self.voices_used.iter().filter(|&voice| self.voices[voice].phase == VoiceState::Sounding).count()
    }

    /// A voice for a new contact: a free one, after stealing the least important when all are
    /// taken.
    fn take_voice(&mut self) -> usize {
        if self.sounding_count() >= self.contact_limit() {
            Counters::add(&self.counters.stolen, 1);
            self.silence_least();
        }
        let remaining = |voice: &Voice| match voice.phase {
            VoiceState::Free => 0,
            VoiceState::Fading { left } => left,
            VoiceState::Sounding => u32::MAX,
        };
        (0..self.voices.len()).min_by_key(|&i| remaining(&self.voices[i])).unwrap_or(0)
    }

    /// Fades the least important contact.
    pub(super) fn silence_least(&mut self) {
        let priority = |i: &usize| self.voices[*i].priority();
        let sounding = self.voices_used.iter().filter(|&i| self.voices[i].phase == VoiceState::Sounding);
        if let Some(least) = sounding.min_by(|a, b| priority(a).total_cmp(&priority(b))) {
            self.silence(least, true);
        }
    }

    /// Fades a contact but remembers it, so that its next move can revive it.
    pub(super) fn silence(&mut self, voice: usize, stolen: bool) {
        let voice = &mut self.voices[voice];
        voice.fade(&self.shared);
        let silent = SilentContact { stolen, ..SilentContact::of(voice) };
        self.remember(silent);
    }

    /// Remembers a contact without a voice; the oldest is forgotten when there are too many.
    pub(super) fn remember(&mut self, silent: SilentContact) {
        if self.silent.len() == self.silent.capacity() {
            self.silent.remove(0);
        }
        self.silent.push(silent);
    }

    /// Every contact waits for its next report.
    pub(super) fn silence_all(&mut self) {
        for at in 0..self.voices_used.len() {
            let voice = self.voices_used.at(at);
            if self.voices[voice].phase == VoiceState::Sounding {
                self.silence(voice, false);
            }
        }
    }

    /// Every contact ends.
    pub(super) fn end_all(&mut self) {
        self.voices.iter_mut().for_each(|voice| voice.fade(&self.shared));
        self.silent.clear();
    }

    pub(super) fn fade_contacts_on(&mut self, slot: usize) {
        for voice in self.voices.iter_mut().filter(|voice| voice.surface == slot) {
            voice.fade(&self.shared);
        }
        self.silent.retain(|silent| silent.surface != slot);
    }
}

fn sounding(voices: &[Box<Voice>], contact: ContactId) -> Option<usize> {
    voices.iter().position(|voice| voice.contact == contact && voice.phase == VoiceState::Sounding)
}
