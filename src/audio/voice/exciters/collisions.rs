//! Collisions: each time the pad meets the surface anew, a Hertz pulse (`dsp::hertz`).

use super::{Excited, LONGEST_COLLISION_S};
use crate::model::excitation::Exciter;
use crate::prepared::impulse_ring::ImpulseRing;
use asperity_dsp::hertz::{HertzPulse, OnsetMerge};
use asperity_dsp::micro_contact::Onset;

/// The micro-collisions of one contact.
#[derive(Default)]
pub(super) struct Collisions {
    merge: OnsetMerge,
}

impl Collisions {
    /// Sends a collision's pulse on its way, where collisions sound; whether it had to be
    /// shortened.
    pub(super) fn strike(
        &mut self,
        by: &Excited<'_>,
        onset: &Onset,
        row: u64,
        pulses: &mut ImpulseRing,
    ) -> bool {
        if !by.slot.surface.excitation.has(Exciter::Collisions) {
            return false;
        }
        // An onset is dated within the step that ends at its row, and a force is heard as if that
        // step's middle were the row: both are half a step late.
        let half = onset.offset + 0.5;
        let (sample, offset) = if half < 1.0 { (row.saturating_sub(1), half) } else { (row, half - 1.0) };
        let own_s = by.slot.stroking.hertz.contact_time_s(onset.closing_m_s);
        let contact_time_s = by.probe.contact_time_ratio * own_s;
        let pulse = HertzPulse {
            impulse_n_s: by.probe.collision_mass_kg * onset.closing_m_s,
            contact_time_s: contact_time_s.min(LONGEST_COLLISION_S),
        };
        let rate_hz = by.sample_rate_hz;
        if let Some(pulse) = self.merge.admit(pulse, sample, offset, rate_hz) {
            pulses.deposit(&pulse, sample, offset, rate_hz);
        }
        contact_time_s > LONGEST_COLLISION_S
    }
}
