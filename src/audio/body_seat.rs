//! A body's place on the audio half, where one body can follow another while both ring.

use crate::audio::smoothed::Smoothed;
use crate::link::message::Dead;
use crate::link::ring::Sender;
use crate::model::id::BodyId;
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::prepared::bank::Owner;
use crate::prepared::body::{BodySlot, Terms};
use crate::prepared::body_rub::RubAsked;
use crate::prepared::spot::Spot;
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::micro_contact::Probe;

/// A body's place on the audio half. A replaced or removed body rings on without input and fades.
pub(crate) struct BodySeat {
    current: Option<Box<BodySlot>>,
    /// The name of what is here.
    id: Option<BodyId>,
    bus: usize,
    /// The bus it comes from, and how much of it plays on its own by now.
    moving: Option<(usize, Smoothed)>,
    /// Linear gain, and the way there.
    gain: f64,
    smoothed: Smoothed,
    /// How many samples are left of being damped.
    damped: Option<u32>,
    /// How many samples a body that leaves takes to fade.
    leaving_samples: u32,
    sample_rate_hz: f64,
    leaving: [Option<Leaving>; LEAVING],
}

/// Replacements of one body that may still be fading at the same time; more wait in the queue.
const LEAVING: usize = 4;
/// How long a body that leaves takes to fade, s: 4096 samples at 44.1 kHz.
const LEAVING_S: f64 = 4096.0 / 44_100.0;

struct Leaving {
    body: Box<BodySlot>,
    bus: usize,
    gain: f32,
    left: u32,
}

impl BodySeat {
    /// An empty place.
    pub(crate) fn new(sample_rate_hz: f64) -> Self {
        Self {
            current: None,
            id: None,
            bus: 0,
            moving: None,
            gain: 1.0,
            smoothed: Smoothed::new(sample_rate_hz),
            damped: None,
            leaving_samples: (LEAVING_S * sample_rate_hz).round() as u32,
            sample_rate_hz,
            leaving: Default::default(),
        }
    }

    /// Whether the body can be replaced now.
    pub(crate) fn can_change(&self) -> bool {
        self.leaving.iter().any(Option::is_none)
    }

    /// Whether nothing is here and nothing fades.
    pub(crate) fn is_empty(&self) -> bool {
        self.current.is_none() && self.leaving.iter().all(Option::is_none)
    }

    /// Puts a body here; the one before it rings out.
    pub(crate) fn set(&mut self, id: BodyId, body: Box<BodySlot>, bus: usize, gain: f64) {
        self.remove();
        if self.id == Some(id) {
            self.play_on(bus);
        } else {
            (self.id, self.bus, self.moving) = (Some(id), bus, None);
            self.smoothed.set(gain);
        }
        (self.gain, self.damped) = (gain, None);
        self.current = Some(body);
    }

    /// The bus it plays on.
    pub(crate) fn bus(&self) -> usize {
        self.bus
    }

    /// Sounds on another bus from now on.
    pub(crate) fn play_on(&mut self, bus: usize) {
        if bus != self.bus {
            let from = std::mem::replace(&mut self.bus, bus);
            self.moving = Some((from, Smoothed::settled(0.0, self.sample_rate_hz)));
        }
    }

    /// Louder or softer from now on.
    pub(crate) fn set_gain(&mut self, gain: f64) {
        self.gain = gain;
    }

    /// What rings fades as if a hand were laid on it.
    pub(crate) fn damp(&mut self) {
        self.damped = self.damped.or(self.current.is_some().then_some(self.leaving_samples));
        self.leaving
            .iter_mut()
            .flatten()
            .for_each(|leaving| leaving.left = leaving.left.min(self.leaving_samples));
    }

    /// Whether the body sounds as it is: at a gain of 1, on one bus, and not being damped.
    pub(crate) fn is_plain(&self) -> bool {
        let keeps = self.damped.is_none() && self.moving.is_none();
        keeps && self.gain == 1.0 && self.smoothed.settled_at(1.0)
    }

    /// Applies the gain to the next samples of the body.
    pub(crate) fn scale(&mut self, sound: &mut [f32]) {
        for x in sound.iter_mut() {
            let mut gain = self.smoothed.tick(self.gain) as f32;
            if let Some(left) = &mut self.damped {
                *left = left.saturating_sub(1);
                gain *= *left as f32 / self.leaving_samples as f32;
            }
            *x *= gain;
        }
        if self.damped == Some(0) {
            self.damped = None;
            if let Some(body) = &mut self.current {
                body.silence();
            }
        }
    }

    /// The bus it comes from and its own; the same when it does not move.
    pub(crate) fn between(&self) -> (usize, usize) {
        (self.moving.map_or(self.bus, |(from, _)| from), self.bus)
    }

    /// Share of its own bus in the next sample.
    pub(crate) fn arrive(&mut self) -> f32 {
        let Some((_, arrived)) = &mut self.moving else { return 1.0 };
        let share = arrived.tick(1.0);
        if arrived.settled_at(1.0) {
            self.moving = None;
        }
        share as f32
    }

    /// Lets the body ring out.
    pub(crate) fn remove(&mut self) {
        if let Some(place) = self.leaving.iter_mut().find(|place| place.is_none()) {
            let (bus, gain, left) = (self.bus, self.gain as f32, self.damped.unwrap_or(self.leaving_samples));
            *place = self.current.take().map(|body| Leaving { body, bus, gain, left });
        }
    }

    /// Adds an impact whose contact begins at `stamp`.
    pub(crate) fn strike(
        &mut self,
        spot: &Spot,
        pulse: &HertzPulse,
        stamp: Stamp,
        mode_level: usize,
        sample_rate_hz: f64,
    ) {
        if let Some(body) = &mut self.current {
            body.strike(spot, pulse, stamp, mode_level, sample_rate_hz);
        }
    }

    /// Adds what one contact sends to the body of that name; to nobody, if it has gone.
    pub(crate) fn touch(&mut self, id: BodyId, position: usize, impulse_n_s: &[f64], sign: f64) {
        if let Some(body) = self.current.as_mut().filter(|_| self.id == Some(id)) {
            body.touch(position, impulse_n_s, sign);
        }
    }

    /// A contact presses on the body of that name.
    pub(crate) fn press(&mut self, id: BodyId, owner: Owner, place: &StrikePlace, probe: &Probe) {
        if let Some(body) = self.current.as_mut().filter(|_| self.id == Some(id)) {
            body.press(owner, place, probe);
        }
    }

    /// A contact rubs the body of that name; false where another one does, or nobody can. A body that has gone is rubbed in vain.
    pub(crate) fn rub(&mut self, id: BodyId, asked: &RubAsked<'_>) -> bool {
        self.current.as_mut().filter(|_| self.id == Some(id)).is_none_or(|body| body.rub(asked))
    }

    /// As [`touch`](Self::touch), at a place of its own.
    pub(crate) fn touch_at(&mut self, id: BodyId, owner: Owner, spot: &Spot, impulse_n_s: &[f64]) {
        if let Some(body) = self.current.as_mut().filter(|_| self.id == Some(id)) {
            body.touch_at(owner, spot, impulse_n_s);
        }
    }

    /// Adds the sound of the next `out.len()` samples to `out` and returns how many groups of modes were
    /// left out. `rung` is what the bank has sounded like and left out, where another thread has rung it already.
    pub(crate) fn render(&mut self, terms: Terms, rung: Option<(&[f32], usize)>, out: &mut [f32]) -> usize {
        let Some(body) = &mut self.current else { return 0 };
        let Some((sound, left_out)) = rung else { return body.render(terms, out) };
        out.iter_mut().zip(sound).for_each(|(sum, x)| *sum += x);
        body.add_strikes(terms.position, out);
        left_out
    }

    /// Modes of the body that must be rung from `position` on; 0 where it is silent.
    pub(crate) fn modes_that_ring(&self, position: u64) -> usize {
        self.current.as_ref().map_or(0, |body| body.modes_that_ring(position))
    }

    /// Lends the body for a while; nothing may happen to it until it is [taken back](Self::take_back).
    pub(crate) fn lend(&mut self) -> Option<Box<BodySlot>> {
        self.current.take()
    }

    /// The body is here again.
    pub(crate) fn take_back(&mut self, body: Option<Box<BodySlot>>) {
        self.current = body;
    }

    /// Whether any body rings out.
    pub(crate) fn anything_leaves(&self) -> bool {
        self.leaving.iter().any(Option::is_some)
    }

    /// Renders each body that rings out to `tail` and hands it to its bus.
    #[cold]
    #[inline(never)]
    pub(crate) fn render_leaving(
        &mut self,
        terms: Terms,
        tail: &mut [f32],
        mut add: impl FnMut(usize, &[f32]),
    ) {
        for leaving in self.leaving.iter_mut().flatten() {
            tail.fill(0.0);
            leaving.body.render(terms, tail);
            for x in tail.iter_mut() {
                leaving.left = leaving.left.saturating_sub(1);
                *x *= leaving.gain * (leaving.left as f32 / self.leaving_samples as f32);
            }
            add(leaving.bus, tail);
        }
    }

    /// Sends bodies that have left home.
    pub(crate) fn tidy(&mut self, position: u64, home: &mut Sender<Dead>) {
        for place in &mut self.leaving {
            let gone = place.as_ref().is_some_and(|l| l.left == 0 || l.body.is_silent(position));
            if let Some(Leaving { body, bus, gain, left }) = gone.then(|| place.take()).flatten()
                && let Err(Dead::Body(body)) = home.send(Dead::Body(body))
            {
                *place = Some(Leaving { body, bus, gain, left });
            }
        }
    }
}
