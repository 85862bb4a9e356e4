//! Grains that give way hit each other at random times: a Poisson process drawn sample by sample.

use super::{Excited, LONGEST_COLLISION_S};
use crate::prepared::impulse_ring::ImpulseRing;
use asperity_dsp::hertz::HertzPulse;
use asperity_dsp::rng::Rng;

/// The grains under one contact.
pub(super) struct Grains(Rng);

impl Grains {
    pub(super) fn new(seed: u64) -> Self {
        Self(Rng::new(seed))
    }

    /// Draws what gives way during one sample, as often as the surface says.
    pub(super) fn shift(&mut self, by: &Excited<'_>, sample: u64, pulses: &mut ImpulseRing) {
        let draw = self.0.uniform();
        let expected = by.reaction.grain_rate_per_s / by.sample_rate_hz;
        if draw < expected {
            // The part of the draw below `expected` is uniform too: it says when within the sample.
            let pulse = HertzPulse {
                impulse_n_s: by.reaction.grain_impulse_n_s * (0.5 + draw / expected),
                contact_time_s: by.slot.stroking.hertz.contact_time_s(0.1).min(LONGEST_COLLISION_S),
            };
            pulses.deposit(&pulse, sample, draw / expected, by.sample_rate_hz);
        }
    }
}
