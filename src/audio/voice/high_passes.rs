//! AC coupling: high-pass the pad motion (felt) and the contact force (heard).

use super::{Scratch, Shared, Voice};
use crate::audio::seat::Seat;
use crate::model::excitation::Exciter;
use asperity_dsp::actuator::ContactOutput;
use asperity_dsp::hertz::FORCE_HISTORY;

/// What rounding leaves of a pad that does not move, m or m/s².
const ROUNDING: f64 = 1e-13;
/// What rounding leaves of a force that does not change, N.
const ROUNDING_N: f64 = 1e-11;

impl Voice {
    /// The two high-passes of a contact side by side, because each waits for itself most of the time: the
    /// pad's displacement or acceleration about the mean surface, which the actuator is to reproduce, and
    /// the alternating contact force, which sounds.
    pub(super) fn filter(
        &mut self,
        seat: &Seat,
        shared: &Shared,
        output: &ContactOutput,
        n: usize,
        scratch: &mut Scratch,
    ) {
        let Some(slot) = seat.current() else { return };
        let high_pass = slot.stroking.force_high_pass;
        // A force that is not to sound counts as 0 N.
        let sounds = slot.surface.excitation.has(Exciter::Force);
        let step_s = if sounds { 1.0 / shared.sample_rate_hz } else { 0.0 };
        let rows = scratch.pad[..n].iter();
        let input = rows.map(|row| ([row.pad_m, row.pad_velocity_m_s], row.contact_force_n));
        let impulse_n_s = &mut scratch.force_impulse_n_s[FORCE_HISTORY..][..n];
        let haptic = &mut scratch.out.haptic[..n];
        let (mut force, mut feel) = (self.force_high_pass, self.feel);
        feel.run_beside(output, (&high_pass, &mut force), input, |i, felt, alternating_n| {
            haptic[i] = felt;
            impulse_n_s[i] = alternating_n;
        });
        (self.force_high_pass, self.feel) = (force, feel);
        for (impulse_n_s, felt) in impulse_n_s.iter_mut().zip(haptic) {
            *impulse_n_s = if impulse_n_s.abs() < ROUNDING_N { 0.0 } else { *impulse_n_s * step_s };
            *felt = if felt.abs() < ROUNDING { 0.0 } else { *felt };
        }
        self.feel_through_skin(&mut scratch.out.haptic[..n]);
        self.last_felt = scratch.out.haptic[n - 1];
    }
}
