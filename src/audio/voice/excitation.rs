//! Excitation of the touched body: Hertz pulses at micro-collisions and among grains, and the
//! alternating contact force (Hasti §III-D; the force is ours, because a pad that never lifts off would be
//! silent).

use super::{Scratch, Shared, Voice};
use crate::audio::seat::Seat;
use crate::model::surface::Excitation;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::hertz::{self, FORCE_HISTORY, HertzPulse};
use asperity_dsp::micro_contact::Onset;

/// Longest contact of a micro-collision, s, at every rate: the bead against rubber lasts 2 ms, against jelly 20.
pub(super) const LONGEST_COLLISION_S: f64 = 0.04;

impl Voice {
    /// What the contact sends to the body: a Hertz pulse for each micro-collision and each grain, and
    /// the alternating contact force. Pulses and force meet sample by sample, not in the bus, so that
    /// the order of additions depends on no split into blocks.
    pub(super) fn excite(
        &mut self,
        seat: &Seat,
        shared: &Shared,
        position: u64,
        n: usize,
        scratch: &mut Scratch,
    ) {
        let Some(slot) = seat.current() else { return };
        let excitation = slot.surface.excitation;
        let rate = shared.sample_rate_hz;
        (scratch.out.collisions, scratch.out.shortened) = (0, 0);
        let grains = self.reaction.grain_rate_per_s > 0.0;
        for i in 0..n {
            let sample = position + i as u64;
            if let Some(onset) = scratch.pad[i].onset {
                scratch.out.collisions += 1;
                if excitation != Excitation::Force {
                    // An onset is dated within the step that ends at its row.
                    let shortened = self.collide(slot, shared, &onset, sample.saturating_sub(1));
                    scratch.out.shortened += u64::from(shortened);
                }
            }
            if grains {
                self.shift_grain(slot, sample, rate);
            }
        }
        self.empty_bus(position, &mut scratch.out.impulse_n_s[..n]);
        let forces_n_s = &mut scratch.force_impulse_n_s;
        forces_n_s[..FORCE_HISTORY].copy_from_slice(&self.force_history_n_s);
        hertz::spread_force(&forces_n_s[..FORCE_HISTORY + n], &mut scratch.out.impulse_n_s[..n]);
        self.force_history_n_s.copy_from_slice(&forces_n_s[n..n + FORCE_HISTORY]);
        self.sound_as_pressed(position, n, scratch);
        scratch.out.excites = true;
    }

    /// Takes the pulses of the coming samples off the bus, which is empty beyond the last pulse.
    pub(super) fn empty_bus(&mut self, position: u64, out: &mut [f64]) {
        if self.bus_busy_until <= position {
            return out.fill(0.0);
        }
        let mask = self.bus.len() - 1;
        for (i, y) in out.iter_mut().enumerate() {
            *y = std::mem::take(&mut self.bus[(position as usize).wrapping_add(i) & mask]);
        }
    }

    /// Whether the pulse had to be shortened.
    pub(super) fn collide(
        &mut self,
        slot: &SurfaceSlot,
        shared: &Shared,
        onset: &Onset,
        sample: u64,
    ) -> bool {
        let probe = shared.probe(self.role.probe);
        let own_s = slot.stroking.hertz.contact_time_s(onset.closing_m_s);
        let contact_time_s = probe.contact_time_ratio * own_s;
        let pulse = HertzPulse {
            impulse_n_s: probe.collision_mass_kg * onset.closing_m_s,
            contact_time_s: contact_time_s.min(LONGEST_COLLISION_S),
        };
        let rate = shared.sample_rate_hz;
        if let Some(pulse) = self.merge.admit(pulse, sample, onset.offset, rate) {
            self.deposit(&pulse, sample, onset.offset, rate);
        }
        contact_time_s > LONGEST_COLLISION_S
    }

    /// Grains that give way hit each other at random times (a Poisson process drawn sample by sample).
    pub(super) fn shift_grain(&mut self, slot: &SurfaceSlot, sample: u64, sample_rate_hz: f64) {
        let draw = self.grains.uniform();
        let expected = self.reaction.grain_rate_per_s / sample_rate_hz;
        if draw < expected {
            // The part of the draw below `expected` is uniform too: it says when within the sample.
            let pulse = HertzPulse {
                impulse_n_s: self.reaction.grain_impulse_n_s * (0.5 + draw / expected),
                contact_time_s: slot.stroking.hertz.contact_time_s(0.1).min(LONGEST_COLLISION_S),
            };
            self.deposit(&pulse, sample, draw / expected, sample_rate_hz);
        }
    }

    pub(super) fn deposit(&mut self, pulse: &HertzPulse, sample: u64, offset: f64, sample_rate_hz: f64) {
        pulse.deposit(&mut self.bus, sample, offset, sample_rate_hz);
        self.bus_busy_until = self.bus_busy_until.max(pulse.end_sample(sample, sample_rate_hz));
    }
}
