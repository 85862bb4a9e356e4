//! A body's place on the audio half, where one body can follow another while both ring.

use crate::audio::smoothed::Smoothed;
use crate::link::message::Dead;
use crate::link::ring::Sender;
use crate::model::id::BodyId;
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::prepared::body::{BodySlot, Spot, Terms};
use crate::prepared::body_field::Owner;
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::micro_contact::Probe;

/// A body's place on the audio half. A replaced or removed body rings on without input and fades.
pub(crate) struct BodySeat {
    current: Option<Box<BodySlot>>,
    /// The name of what is here.
    id: Option<BodyId>,
    bus: usize,
    /// The bus it comes from, and how many samples of the way are left.
    moving: Option<(usize, u32)>,
    /// Linear gain, and the way there.
    gain: f64,
    smoothed: Smoothed,
    /// How many samples are left of being damped.
    damped: Option<u32>,
    leaving: [Option<Leaving>; LEAVING],
}

/// Replacements of one body that may still be fading at the same time; more wait in the queue.
const LEAVING: usize = 4;
/// How many samples a body that leaves takes to fade.
const LEAVING_SAMPLES: u32 = 4096;
/// How many samples a body takes from one bus to another.
const MOVING_SAMPLES: u32 = 1024;

/// A body between two buses during a stretch.
pub(crate) struct BetweenBuses {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// Samples left at the first of the stretch.
    left: u32,
}

impl BetweenBuses {
    /// On one bus alone.
    pub(crate) fn one(bus: usize) -> Self {
        Self { from: bus, to: bus, left: 0 }
    }

    /// Share of the new bus at sample `i` of the stretch.
    pub(crate) fn weight(&self, i: usize) -> f32 {
        let left = self.left.saturating_sub(i as u32 + 1);
        1.0 - left as f32 / MOVING_SAMPLES as f32
    }
}

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
            self.moving = Some((from, MOVING_SAMPLES));
        }
    }

    /// Louder or softer from now on.
    pub(crate) fn set_gain(&mut self, gain: f64) {
        self.gain = gain;
    }

    /// What rings fades as if a hand were laid on it.
    pub(crate) fn damp(&mut self) {
        self.damped = self.damped.or(self.current.is_some().then_some(LEAVING_SAMPLES));
        self.leaving
            .iter_mut()
            .flatten()
            .for_each(|leaving| leaving.left = leaving.left.min(LEAVING_SAMPLES));
    }

    /// Whether the body sounds as it is: at a gain of 1, and not being damped.
    pub(crate) fn is_plain(&self) -> bool {
        self.damped.is_none() && self.gain == 1.0 && self.smoothed.settled_at(1.0)
    }

    /// Applies the gain to the next samples of the body.
    pub(crate) fn scale(&mut self, sound: &mut [f32]) {
        for x in sound.iter_mut() {
            let mut gain = self.smoothed.tick(self.gain) as f32;
            if let Some(left) = &mut self.damped {
                *left = left.saturating_sub(1);
                gain *= *left as f32 / LEAVING_SAMPLES as f32;
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

    /// The two buses that share the next `n` samples, while it changes from one to the other.
    pub(crate) fn moves_between(&mut self, n: usize) -> Option<BetweenBuses> {
        let (from, left) = self.moving?;
        let rest = left.saturating_sub(n as u32);
        self.moving = (rest > 0).then_some((from, rest));
        Some(BetweenBuses { from, to: self.bus, left })
    }

    /// Lets the body ring out.
    pub(crate) fn remove(&mut self) {
        if let Some(place) = self.leaving.iter_mut().find(|place| place.is_none()) {
            let (bus, gain, left) = (self.bus, self.gain as f32, self.damped.unwrap_or(LEAVING_SAMPLES));
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

    /// As [`touch`](Self::touch), at a place of its own.
    pub(crate) fn touch_at(&mut self, id: BodyId, owner: Owner, spot: &Spot, impulse_n_s: &[f64]) {
        if let Some(body) = self.current.as_mut().filter(|_| self.id == Some(id)) {
            body.touch_at(owner, spot, impulse_n_s);
        }
    }

    /// Adds the sound of the next `out.len()` samples to `out` and returns how many groups of modes were
    /// left out.
    pub(crate) fn render(&mut self, terms: Terms, out: &mut [f32]) -> usize {
        self.current.as_mut().map_or(0, |body| body.render(terms, out))
    }

    /// Renders each body that rings out to `tail` and hands it to its bus.
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
                *x *= leaving.gain * (leaving.left as f32 / LEAVING_SAMPLES as f32);
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
