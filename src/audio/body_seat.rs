//! A body's place on the audio half, where one body can follow another while both ring.

use crate::link::message::Dead;
use crate::link::ring::Sender;
use crate::model::stamp::Stamp;
use crate::prepared::body::{BodySlot, Terms};
use asperity_dsp::hertz::HertzPulse;
use asperity_texture::height_field::MAX_BLOCK;

/// A body's place on the audio half. A replaced or removed body rings on without input and fades.
#[derive(Default)]
pub(crate) struct BodySeat {
    current: Option<Box<BodySlot>>,
    leaving: [Option<Leaving>; LEAVING],
}

/// Replacements of one body that may still be fading at the same time; more wait in the queue.
const LEAVING: usize = 4;
/// How many samples a body that leaves takes to fade.
const LEAVING_SAMPLES: u32 = 4096;

struct Leaving {
    body: Box<BodySlot>,
    left: u32,
}

impl BodySeat {
    /// Whether the body can be replaced now.
    pub(crate) fn can_change(&self) -> bool {
        self.leaving.iter().any(Option::is_none)
    }

    /// Whether nothing is here and nothing fades.
    pub(crate) fn is_empty(&self) -> bool {
        self.current.is_none() && self.leaving.iter().all(Option::is_none)
    }

    /// Puts a body here; the one before it rings out.
    pub(crate) fn set(&mut self, body: Box<BodySlot>) {
        self.remove();
        self.current = Some(body);
    }

    /// Lets the body ring out.
    pub(crate) fn remove(&mut self) {
        if let Some(place) = self.leaving.iter_mut().find(|place| place.is_none()) {
            *place = self.current.take().map(|body| Leaving { body, left: LEAVING_SAMPLES });
        }
    }

    /// Adds an impact whose contact begins at `stamp`.
    pub(crate) fn strike(
        &mut self,
        position: usize,
        pulse: &HertzPulse,
        stamp: Stamp,
        mode_level: usize,
        sample_rate_hz: f64,
    ) {
        if let Some(body) = &mut self.current {
            body.strike(position, pulse, stamp, mode_level, sample_rate_hz);
        }
    }

    /// Adds what one contact sends.
    pub(crate) fn touch(&mut self, position: usize, impulse_n_s: &[f64]) {
        if let Some(body) = &mut self.current {
            body.touch(position, impulse_n_s);
        }
    }

    /// Adds the sound of the next `out.len()` samples to `out` and returns how many groups of modes were
    /// left out.
    pub(crate) fn render(&mut self, terms: Terms, out: &mut [f32]) -> usize {
        let n = out.len();
        let shed = self.current.as_mut().map_or(0, |body| body.render(terms, out));
        for leaving in self.leaving.iter_mut().flatten() {
            let mut tail = [0.0f32; MAX_BLOCK];
            leaving.body.render(terms, &mut tail[..n]);
            for (sum, x) in out.iter_mut().zip(&tail) {
                leaving.left = leaving.left.saturating_sub(1);
                *sum += x * (leaving.left as f32 / LEAVING_SAMPLES as f32);
            }
        }
        shed
    }

    /// Sends bodies that have left home.
    pub(crate) fn tidy(&mut self, position: u64, home: &mut Sender<Dead>) {
        for place in &mut self.leaving {
            let gone = place.as_ref().is_some_and(|l| l.left == 0 || l.body.is_silent(position));
            if let Some(Leaving { body, left }) = gone.then(|| place.take()).flatten()
                && let Err(Dead::Body(body)) = home.send(Dead::Body(body))
            {
                *place = Some(Leaving { body, left });
            }
        }
    }
}
