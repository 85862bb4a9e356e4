//! A body's place on the audio half, or one where a body rings out that has left its own.

use crate::audio::smoothed::Smoothed;
use crate::link::message::{Made, Retired};
use crate::link::ring::Sender;
use crate::model::body::{Body, MAX_SENDS, Sends};
use crate::model::id::BodyId;
use crate::model::stamp::Stamp;
use crate::model::strike_field::StrikePlace;
use crate::resource::bank::ContactKey;
use crate::resource::body::{BodySlot, RenderArgs};
use crate::resource::body_rub::FrictionInput;
use crate::resource::pickup::Pickups;
use crate::resource::strike_point::StrikePoint;
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::micro_contact::Probe;
use std::sync::Arc;

/// A body's place on the audio half.
pub(crate) struct BodySeat {
    current: Option<Box<BodySlot>>,
    /// Maker's data of it.
    of: Option<Arc<Body>>,
    /// The name of what is here; none where a body rings out.
    id: Option<BodyId>,
    bus: usize,
    shares: [Share; SHARES],
    /// It sounds on its own bus and no other, as loud as it is.
    alone: bool,
    /// Linear gain, and the way there.
    gain: f64,
    smoothed: Smoothed,
    /// Samples that are left of being damped.
    damped: Option<u32>,
    /// Samples in which a body that is damped fades.
    fade_samples: u32,
    /// Level of its ringing before its gain, as the last look found.
    rings: f32,
}

/// Buses that a body sounds on at the same time: its own, those it is sent to, and those it is
/// leaving.
const SHARES: usize = 2 * (MAX_SENDS + 1);

/// A bus that a body sounds on: how loud, and the way there.
#[derive(Clone, Copy)]
struct Share {
    bus: usize,
    gain: f64,
    smoothed: Smoothed,
}

/// Time in which a body that is damped fades, s: 4096 samples at 44.1 kHz.
const FADE_S: f64 = 4096.0 / 44_100.0;
impl Share {
    fn go_to(&mut self, gain: f64) {
        self.gain = gain;
    }

    /// Is there at once.
    fn arrive(&mut self) {
        self.smoothed.set(self.gain);
    }

    fn is_over(&self) -> bool {
        self.gain == 0.0 && self.smoothed.settled_at(0.0)
    }

    fn is_whole(&self) -> bool {
        self.gain == 1.0 && self.smoothed.settled_at(1.0)
    }
}

impl BodySeat {
    /// An empty place.
    pub(crate) fn new(sample_rate_hz: f64) -> Self {
        Self {
            current: None,
            of: None,
            id: None,
            bus: 0,
            shares: [Share { bus: 0, gain: 0.0, smoothed: Smoothed::settled(0.0, sample_rate_hz) }; SHARES],
            alone: false,
            gain: 1.0,
            smoothed: Smoothed::new(sample_rate_hz),
            damped: None,
            fade_samples: (FADE_S * sample_rate_hz).round() as u32,
            rings: 0.0,
        }
    }

    /// Tests whether nothing is here.
    pub(crate) fn is_empty(&self) -> bool {
        self.current.is_none()
    }

    /// Tests whether what is here is being damped.
    pub(crate) fn is_damped(&self) -> bool {
        self.damped.is_some()
    }

    /// Level of its ringing.
    pub(crate) fn loudness(&self) -> f32 {
        let fade = self.damped.map_or(1.0, |left| left as f32 / self.fade_samples as f32);
        let shares = self.shares.iter().fold(0.0, |most, share| f64::max(most, share.gain));
        let gain = fade * (self.gain * shares) as f32;
        // A body on its way counts as infinitely loud, unless its gain is zero.
        if gain > 0.0 { self.rings * gain } else { 0.0 }
    }

    /// Puts a body here.
    pub(crate) fn set(&mut self, id: BodyId, body: Made, (bus, sends): (usize, &Sends), gain: f64) {
        if self.id != Some(id) {
            (self.id, self.bus) = (Some(id), bus);
            self.shares.iter_mut().for_each(|share| share.go_to(0.0));
            self.shares.iter_mut().for_each(Share::arrive);
            self.send_to(bus, 1.0);
            sends.iter().flatten().for_each(|(bus, gain)| self.send_to(*bus, *gain));
            self.shares.iter_mut().for_each(Share::arrive);
            self.smoothed.set(gain);
        } else if self.bus != bus {
            self.play_on(bus);
        }
        (self.gain, self.damped) = (gain, None);
        self.alone = self.is_alone();
        (self.current, self.of) = (Some(body.slot), Some(body.of));
    }

    /// The bus it plays on.
    pub(crate) fn bus(&self) -> usize {
        self.bus
    }

    /// Sounds on a bus and no other from now on.
    pub(crate) fn play_on(&mut self, bus: usize) {
        self.shares.iter_mut().for_each(|share| share.go_to(0.0));
        self.bus = bus;
        self.send_to(bus, 1.0);
    }

    /// Sounds so loud on a bus from now on, whatever it does on others.
    pub(crate) fn send_to(&mut self, bus: usize, gain: f64) {
        let place = self.shares.iter().position(|share| share.bus == bus && !share.is_over());
        let place = place.or_else(|| self.shares.iter().position(Share::is_over));
        // If a body goes from bus to bus many times within a fade, the oldest ends at once.
        let share = &mut self.shares[place.unwrap_or(0)];
        if share.bus != bus {
            share.smoothed.set(0.0);
            share.bus = bus;
        }
        share.go_to(gain);
        self.alone = false;
    }

    /// Louder or softer from now on.
    pub(crate) fn set_gain(&mut self, gain: f64) {
        self.gain = gain;
    }

    /// Damps what rings as if a hand were laid on it.
    pub(crate) fn damp(&mut self) {
        self.damped = self.damped.or(self.current.is_some().then_some(self.fade_samples));
    }

    /// Tests whether the body sounds as it is: at a gain of 1, on one bus, neither being damped nor
    /// ringing out.
    pub(crate) fn is_plain(&self) -> bool {
        let keeps = self.id.is_some() && self.damped.is_none() && self.alone;
        keeps && self.gain == 1.0 && self.smoothed.settled_at(1.0)
    }

    /// Applies the gain to the next samples of the body.
    pub(crate) fn scale(&mut self, sound: &mut [f32]) {
        for x in sound.iter_mut() {
            let mut gain = self.smoothed.tick(self.gain) as f32;
            if let Some(left) = &mut self.damped {
                *left = left.saturating_sub(1);
                gain *= *left as f32 / self.fade_samples as f32;
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

    /// Hands its sound to the buses: to `add` each sample of each, by its place.
    pub(crate) fn spread(&mut self, sound: &[f32], mut add: impl FnMut(usize, usize, f32)) {
        for share in self.shares.iter_mut().filter(|share| !share.is_over()) {
            for (i, x) in sound.iter().enumerate() {
                add(share.bus, i, share.smoothed.tick(share.gain) as f32 * x);
            }
        }
        self.alone = self.is_alone();
    }

    fn is_alone(&self) -> bool {
        self.shares.iter().all(|share| share.is_over() || (share.bus == self.bus && share.is_whole()))
    }

    /// The body rings out at another place, as it sounds here.
    pub(crate) fn leave_for(&mut self, tail: &mut Self, position: u64) {
        *tail = Self { current: self.current.take(), of: self.of.take(), id: None, ..*self };
        tail.look(position);
    }

    /// Takes the body away.
    pub(crate) fn take(&mut self) -> Option<Made> {
        self.damped = None;
        let (slot, of) = self.current.take().zip(self.of.take())?;
        Some(Made { slot, of })
    }

    /// Tests whether nothing rings here and nothing is coming.
    pub(crate) fn is_silent(&self, position: u64) -> bool {
        self.current.as_ref().is_none_or(|body| body.is_silent(position))
    }

    /// Adds an impact whose contact begins at `stamp`.
    pub(crate) fn strike(
        &mut self,
        spot: &StrikePoint,
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
    pub(crate) fn press(&mut self, id: BodyId, owner: ContactKey, place: &StrikePlace, probe: &Probe) {
        if let Some(body) = self.current.as_mut().filter(|_| self.id == Some(id)) {
            body.press(owner, place, probe);
        }
    }

    /// A contact rubs the body of that name; false where another one does, or nobody can. A body
    /// that has gone is rubbed in vain.
    pub(crate) fn rub(&mut self, id: BodyId, asked: &FrictionInput<'_>) -> bool {
        self.current.as_mut().filter(|_| self.id == Some(id)).is_none_or(|body| body.rub(asked))
    }

    /// As [`touch`](Self::touch), at a place of its own.
    pub(crate) fn touch_at(
        &mut self,
        id: BodyId,
        owner: ContactKey,
        spot: &StrikePoint,
        impulse_n_s: &[f64],
    ) {
        if let Some(body) = self.current.as_mut().filter(|_| self.id == Some(id)) {
            body.touch_at(owner, spot, impulse_n_s);
        }
    }

    /// Adds the sound of the next `out.len()` samples to `out` and returns how many groups of modes
    /// were left out. `rung` is what the bank has sounded like and left out, where another thread
    /// has rung it already.
    pub(crate) fn render(
        &mut self,
        args: RenderArgs,
        rung: Option<(&[f32], usize)>,
        out: &mut [f32],
    ) -> usize {
        let Some(body) = &mut self.current else { return 0 };
        let Some((sound, left_out)) = rung else { return body.render(args, out) };
        out.iter_mut().zip(sound).for_each(|(sum, x)| *sum += x);
        body.add_strikes(args.position, out);
        left_out
    }

    /// Modes of the body that must be rung from `position` on; 0 where it is silent.
    pub(crate) fn modes_that_ring(&self, position: u64) -> usize {
        self.current.as_ref().map_or(0, |body| body.modes_that_ring(position))
    }

    /// Modes that must be rung from `position` on, and how many of them can be spared.
    pub(crate) fn modes_and_spared(&self, position: u64) -> (usize, usize) {
        self.current.as_ref().map_or((0, 0), |body| body.modes_and_spared(position))
    }

    /// Lends the body for a while; nothing may happen to it until it is [taken
    /// back](Self::take_back).
    pub(crate) fn lend(&mut self) -> Option<Box<BodySlot>> {
        self.current.take()
    }

    /// The body is here again.
    pub(crate) fn take_back(&mut self, body: Option<Box<BodySlot>>) {
        self.current = body;
    }

    /// Its pickups.
    pub(crate) fn pickups(&mut self) -> Option<&mut Pickups> {
        self.current.as_mut()?.pickups()
    }

    fn look(&mut self, position: u64) {
        self.rings = self.current.as_ref().map_or(0.0, |body| body.loudness(position));
    }

    /// Sends a body that has rung out home.
    pub(crate) fn tidy(&mut self, position: u64, home: &mut Sender<Retired>) {
        if self.id.is_none() {
            self.look(position);
        }
        if self.id.is_none() && self.is_silent(position) {
            let kept = self.take().and_then(|body| match home.send(Retired::Body(body)) {
                Err(Retired::Body(body)) => Some(body),
                _ => None,
            });
            (self.current, self.of) = kept.map(|body| (body.slot, body.of)).unzip();
        }
    }
}
