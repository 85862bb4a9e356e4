//! Messages of the game half, applied at their samples.

use super::Renderer;
use crate::audio::seat::Change;
use crate::audio::voice::VoiceState;
use crate::link::message::{Felt, Message, Retired};
use crate::link::stats::Counters;
use crate::model::event::ContactEvent;
use crate::model::id::SurfaceId;
use crate::model::stamp::Stamp;
use crate::resource::strike_point::StrikePoint;
use crate::resource::surface::SurfaceSlot;
use asperity_dsp::hertz::HertzPulse;
use asperity_surface::height_field::MAX_BLOCK;
use std::sync::atomic::Ordering::Relaxed;

impl Renderer {
    /// Number of samples that can be rendered before the next event, the grid or the end of the
    /// block.
    pub(super) fn stretch(&mut self, wanted: usize) -> usize {
        let to_grid = MAX_BLOCK - (self.position % MAX_BLOCK as u64) as usize;
        let to_event = match self.from_game.peek() {
            Some(
                Message::Event { stamp, epoch, .. }
                | Message::Strike { stamp, epoch, .. }
                | Message::Motion { stamp, epoch, .. },
            ) => {
                let sample = turn(&self.counters, self.position, *stamp, *epoch).sample();
                usize::try_from(sample.saturating_sub(self.position)).unwrap_or(usize::MAX).max(1)
            }
            _ => usize::MAX,
        };
        wanted.min(to_grid).min(to_event)
    }

    pub(super) fn apply_due(&mut self) {
        loop {
            let ended = self.time_has_ended();
            let Some(message) = self.from_game.peek() else { return };
            let due = match message {
                Message::Event { stamp, epoch, .. }
                | Message::Strike { stamp, epoch, .. }
                | Message::Motion { stamp, epoch, .. } => {
                    ended || turn(&self.counters, self.position, *stamp, *epoch).sample() <= self.position
                }
                Message::Reset => true,
                // Each of these may send something home; it waits until there is room, and there is
                // unless the game collects nothing.
                _ => self.to_game.free() > 0,
            };
            if !due {
                return;
            }
            if let Some(message) = self.from_game.receive() {
                self.apply(message);
            }
        }
    }

    pub(super) fn apply(&mut self, message: Message) {
        if let Message::Strike { ticket, .. } = &message
            && !self.counters.tickets.take(*ticket)
        {
            return Counters::add(&self.counters.withdrawn, 1);
        }
        match message {
            Message::Reset => self.resets += 1,
            // It waited for a time that has ended.
            Message::Event { stamp, .. } | Message::Strike { stamp, .. } | Message::Motion { stamp, .. }
                if self.time_has_ended() && stamp.sample() > self.position =>
            {
                Counters::add(&self.counters.superseded, 1);
            }
            // It is elsewhere by now, and leaps there instead of running after what was missed.
            Message::Event { epoch, event: ContactEvent::Moved { .. }, .. }
                if epoch < self.counters.stale_before.load(Relaxed) =>
            {
                Counters::add(&self.counters.superseded, 1);
            }
            Message::Event { stamp, epoch, event, place } => {
                let stamp = turn(&self.counters, self.position, stamp, epoch);
                self.note_arrival(stamp);
                self.apply_event(&event, stamp);
                self.put(&event, place);
            }
            Message::Strike { epoch, .. } if epoch < self.counters.stale_before.load(Relaxed) => {
                Counters::add(&self.counters.stale, 1);
            }
            Message::Strike { stamp, epoch, body, spot, other, holder, felt, pulse, ticket: _ } => {
                let stamp = turn(&self.counters, self.position, stamp, epoch);
                self.note_arrival(stamp);
                Counters::add(&self.counters.impacts, 1);
                self.strike(body, &spot, &pulse, stamp);
                if let Some(other) = other {
                    self.strike(other, &StrikePoint::FIRST, &pulse, stamp);
                }
                let answer = HertzPulse { impulse_n_s: -pulse.impulse_n_s, ..pulse };
                if let Some(holder) = holder {
                    self.strike(holder, &StrikePoint::FIRST, &answer, stamp);
                }
                if let Some(felt) = felt {
                    self.feel(felt, &pulse, stamp);
                }
            }
            Message::Motion { slot, motion, alpha, over, .. } => {
                if let Some(pickups) = self.bodies[slot].pickups() {
                    pickups.moves(&motion, alpha, over);
                }
            }
            Message::AddProbe { index, probe } => {
                self.change_shared(|shared| shared.probes[index] = Some(probe));
            }
            Message::SetSurface { id, surface } => self.set_surface(id, surface),
            Message::ChangeSurface { slot, change } => {
                if !self.seats[slot].change(&*change, self.position) {
                    Counters::add(&self.counters.quarantined, 1);
                }
                // There is room: the message waited for it.
                let _ = self.to_game.send(Retired::Change(change));
                // A resting finger feels the change.
                self.voices.iter_mut().filter(|voice| voice.surface == slot).for_each(|voice| voice.wake());
            }
            Message::RemoveSurface { slot } => {
                self.seats[slot].remove();
                self.fade_contacts_on(slot);
            }
            Message::SetBody { id, body, bus, sends, gain, stroking } => {
                self.let_ring(id.index());
                self.bodies[id.index()].set(id, body, (bus, &sends), gain);
                self.bodies_used.insert(id.index());
                for seat in self.seats_used.iter() {
                    self.seats[seat].body_changed(id, &stroking);
                }
            }
            Message::SetBodyBus { slot, bus } => self.bodies[slot].play_on(bus),
            Message::SetBodySend { slot, bus, gain } => self.bodies[slot].send_to(bus, gain),
            Message::SetBodyGain { slot, gain } => self.bodies[slot].set_gain(gain),
            Message::PlayClip(clip) => {
                if let Err(clip) = self.clips.add(clip, self.position) {
                    Counters::add(&self.counters.clips_dropped, 1);
                    // There is room: the message waited for it.
                    let _ = self.to_game.send(Retired::Clip(clip));
                }
            }
            Message::SetPitch(scale) => self.tape.set_scale(scale),
            Message::Mute(muted) => self.muted = muted,
            Message::Pause(paused) => {
                self.paused = paused;
                if paused {
                    self.silence_all();
                }
            }
            Message::FadeAll => {
                self.end_all();
                self.bodies_used.iter().for_each(|body| self.bodies[body].damp());
            }
            Message::RemoveBody { slot } => self.let_ring(slot),
            Message::AddOutlet(outlet) => self.outlets.add(outlet),
            Message::SetAudioGain { bus, gain } => self.buses[bus].set_gain(gain),
            Message::SetHapticGain { channel, gain } => self.channels[channel].control.gain = gain,
        }
    }

    /// Tests whether a reset waits behind what is next.
    fn time_has_ended(&self) -> bool {
        self.counters.resets_asked.load(Relaxed) != self.resets
    }

    fn note_arrival(&self, stamp: Stamp) {
        Counters::add(&self.counters.events, 1);
        Counters::add(&self.counters.late, u64::from(stamp.sample() < self.position));
    }

    /// Beginning of what holds at `stamp`: what is late begins at once.
    pub(super) fn due(&self, stamp: Stamp) -> Stamp {
        stamp.max(Stamp::whole(self.position))
    }

    fn set_surface(&mut self, id: SurfaceId, surface: Box<SurfaceSlot>) {
        let (slot, rate) = (id.index(), self.shared.sample_rate_hz);
        self.seats_used.insert(slot);
        if self.seats[slot].set(id, surface, self.position, rate, &mut self.to_game) == Change::Restart {
            for index in 0..self.voices.len() {
                if self.voices[index].surface == slot && self.voices[index].phase == VoiceState::Sounding {
                    self.silence(index, false);
                }
            }
        }
    }

    fn strike(&mut self, body: usize, spot: &StrikePoint, pulse: &HertzPulse, stamp: Stamp) {
        // Impacts pass the same look-ahead as contacts, so that both stay aligned.
        let sounds = self.due(stamp).later(self.shared.row_latency as u64);
        let level = self.governor.mode_level();
        self.bodies[body].strike(spot, pulse, sounds, level, self.shared.sample_rate_hz);
    }

    /// A strike is felt: its pulse goes through the mobility of the hand's probe.
    fn feel(&mut self, felt: Felt, pulse: &HertzPulse, stamp: Stamp) {
        let sounds = self.due(stamp).later(self.shared.row_latency as u64);
        let output = &self.channels[felt.channel].output;
        self.blows.strike(felt, output, pulse, sounds, self.position, self.shared.sample_rate_hz);
    }
}

/// Time at which it is the turn of something stamped so in an epoch of the game's clock, with the
/// audio at `position`: where game time was tied back since, at once.
fn turn(counters: &Counters, position: u64, stamp: Stamp, epoch: u64) -> Stamp {
    let tied_back = epoch < counters.epoch.load(Relaxed);
    if tied_back { stamp.min(Stamp::whole(position)) } else { stamp }
}
