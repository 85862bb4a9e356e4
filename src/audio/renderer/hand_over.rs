//! Hand-over between two renderers of one scene, on the game thread: what the old one holds that
//! cannot be made again.

use super::Renderer;
use super::contacts::SilentContact;
use super::tape::Tape;
use crate::audio::voice::VoiceState;
use crate::link::message::Message;
use crate::link::stats::Counters;
use crate::model::id::SurfaceId;
use crate::model::stamp::Stamp;
use crate::resource::surface::SurfaceSlot;
use asperity_dsp::actuator::ChannelControl;
use std::sync::atomic::Ordering::Relaxed;

/// Parts that one renderer leaves to the next.
pub(crate) struct HandedOver {
    pub(crate) surfaces: Vec<(SurfaceId, Box<SurfaceSlot>)>,
    /// Contacts that touch: they come back with their next move.
    contacts: Vec<SilentContact>,
    /// Events that wait for their time.
    waiting: Vec<Message>,
    haptic: Vec<ChannelControl>,
    muted: bool,
    paused: bool,
    /// Samples rendered, at the old rate inside.
    position: u64,
    rate_hz: f64,
    outer_hz: f64,
    resets: u64,
    given: u64,
    scale: f64,
}

impl Renderer {
    /// Takes everything out that the next renderer needs.
    pub(crate) fn hand_over(mut self) -> HandedOver {
        let mut waiting = Vec::new();
        while let Some(message) = self.from_game.receive() {
            match message {
                Message::Event { .. } | Message::Strike { .. } => waiting.push(message),
                edit => self.apply(edit),
            }
        }
        let touching = self.voices.iter().filter(|voice| voice.phase == VoiceState::Sounding);
        let touching = touching.map(|voice| SilentContact::of(voice));
        let contacts = self.silent.iter().copied().chain(touching).collect();
        HandedOver {
            contacts,
            surfaces: self.seats.iter_mut().filter_map(crate::audio::seat::Seat::take).collect(),
            waiting,
            haptic: self.channels.iter().map(|channel| channel.control).collect(),
            muted: self.muted,
            paused: self.paused,
            position: self.position,
            rate_hz: self.shared.sample_rate_hz,
            outer_hz: self.sample_rate_hz(),
            resets: self.resets,
            given: self.given,
            scale: self.tape.scale(),
        }
    }

    /// Goes on where another renderer has stopped: at the same second, with the same contacts.
    pub(crate) fn take_over(&mut self, old: HandedOver) -> Vec<Message> {
        let every = self.shared.inner.every as u64;
        let ratio = self.shared.sample_rate_hz / old.rate_hz;
        self.position = (old.position as f64 * ratio / every as f64).round() as u64 * every;
        self.counters.position.store(self.position, Relaxed);
        self.resets = old.resets;
        self.given = (old.given as f64 * self.sample_rate_hz() / old.outer_hz).round() as u64;
        let channels = self.channels.len() + self.buses.len() + self.pickups.len();
        self.tape = Tape::new(channels, self.game_position());
        self.tape.set_scale(old.scale);
        (self.muted, self.paused) = (old.muted, old.paused);
        self.silent.extend(old.contacts.into_iter().take(self.max_contacts));
        for (channel, control) in self.channels.iter_mut().zip(old.haptic) {
            channel.control = control;
        }
        Counters::add(&self.counters.clock_jumps, 1);
        let at_rate = |stamp: Stamp| Stamp::at(stamp.samples() * ratio);
        old.waiting
            .into_iter()
            .map(|message| match message {
                Message::Event { stamp, epoch, event, place } => {
                    Message::Event { stamp: at_rate(stamp), epoch, event, place }
                }
                Message::Strike { stamp, epoch, body, spot, other, holder, felt, pulse, ticket } => {
                    let stamp = at_rate(stamp);
                    Message::Strike { stamp, epoch, body, spot, other, holder, felt, pulse, ticket }
                }
                other => other,
            })
            .collect()
    }

    /// Puts a resource in its place before anything is rendered.
    pub(crate) fn install(&mut self, resource: Message) {
        self.apply(resource);
    }
}
