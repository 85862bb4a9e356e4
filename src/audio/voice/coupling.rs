//! AC coupling: high-passes of the pad's motion (felt) and of the contact force (heard).

use super::PadSample;
use asperity_dsp::actuator::{ContactOutput, ContactOutputState, Quantity};
use asperity_dsp::butterworth::{Butterworth, State, Two};
use asperity_dsp::pair::Pair;

/// Rounding error of a pad that does not move, m or m/s².
const ROUNDING: f64 = 1e-13;
/// Rounding error of a force that does not change, N.
const ROUNDING_N: f64 = 1e-11;
/// High-passed pad displacement that counts as still, m: −160 dB of 0.1 mm.
const STILL_M: f64 = 1e-12;
/// Contact force that counts as none, N: −120 dB of what a finger presses with.
const STILL_N: f64 = 1e-6;
/// Pad acceleration that counts as still, m/s²: −120 dB of what a fingertip just feels.
pub(super) const STILL_M_S2: f64 = 1e-6;

/// The two high-passes of a contact.
pub(super) struct AcCoupling {
    pub(super) feel: ContactOutputState,
    pub(super) force: State,
    /// Haptic output of a resting contact, too.
    pub(super) last_felt: f64,
}

impl AcCoupling {
    pub(super) fn idle(output: &ContactOutput) -> Self {
        let feel = ContactOutputState::begin(output, 0.0, 0.0);
        Self { feel, force: State::default(), last_felt: 0.0 }
    }

    /// Displacement or acceleration of the pad about the mean surface, or its force, which the
    /// actuator is to reproduce, and the alternating contact force as impulses, N·s; `step_s` is
    /// the time of a sample, 0 for a force that is not to sound. Rows of what is felt and of what
    /// sounds: the same, but where a tool sounds by its tip or a skin is dragged.
    pub(super) fn run(
        &mut self,
        output: &ContactOutput,
        (force_high_pass, step_s): (&Butterworth, f64),
        (moving, pressing): (&[PadSample], &[PadSample]),
        felt: &mut [f64],
        impulse_n_s: &mut [f64],
    ) {
        let (rounding, factors) = (Pair::from([ROUNDING, ROUNDING_N]), Pair::from([1.0, step_s]));
        let finish = |passed: Pair| passed.or_zero_below(rounding) * factors;
        let Some(filter) = output.high_pass() else {
            let rows = moving.iter().zip(pressing);
            for ((row, pressed), (felt, impulse_n_s)) in rows.zip(felt.iter_mut().zip(impulse_n_s)) {
                let moved = self.feel.tick(output, played(output, row), row.pad_velocity_m_s);
                let passed_n = self.force.tick(force_high_pass, pressed.contact_force_n).high;
                [*felt, *impulse_n_s] = finish([moved, passed_n].into()).into();
            }
            self.last_felt = felt.last().copied().unwrap_or(self.last_felt);
            return;
        };
        // Side by side, because each waits for itself most of the time.
        let mut feel = self.feel;
        let mut two = Two::new([filter, force_high_pass], [feel.highpass, self.force]);
        let mut pass = |row: &PadSample, pressed: &PadSample| {
            let moved = feel.quantity(output, played(output, row), row.pad_velocity_m_s);
            finish(two.tick([moved, pressed.contact_force_n].into()).high)
        };
        // Two samples at a time, so that the next stage finds whole vectors in memory.
        let (moving_twos, last_moving) = moving.as_chunks::<2>();
        let (pressing_twos, last_pressing) = pressing.as_chunks::<2>();
        let twos = moving_twos.iter().zip(pressing_twos);
        let (felt_twos, last_felt) = felt.as_chunks_mut::<2>();
        let (impulse_twos, last_impulse) = impulse_n_s.as_chunks_mut::<2>();
        for ((moving, pressing), (felt, impulse_n_s)) in twos.zip(felt_twos.iter_mut().zip(impulse_twos)) {
            let both = Pair::transposed([pass(&moving[0], &pressing[0]), pass(&moving[1], &pressing[1])]);
            [*felt, *impulse_n_s] = both.map(Into::into);
        }
        let last = last_moving.iter().zip(last_pressing);
        for ((row, pressed), (felt, impulse_n_s)) in last.zip(last_felt.iter_mut().zip(last_impulse)) {
            [*felt, *impulse_n_s] = pass(row, pressed).into();
        }
        [feel.highpass, self.force] = two.states();
        self.feel = feel;
        self.last_felt = felt.last().copied().unwrap_or(self.last_felt);
    }

    /// Tests whether nothing of a pad at this row is felt to move. Without a high-pass a resting
    /// pad is felt as its constant displacement, or force.
    pub(super) fn feels_still(&self, output: &ContactOutput, row: &PadSample) -> bool {
        let resting = played(output, row);
        self.last_felt.abs() < still(output) || (self.last_felt - resting).abs() < still(output)
    }

    /// Drops what is left of a contact that has come to rest.
    pub(super) fn settle(&mut self, output: &ContactOutput) {
        if self.last_felt.abs() < still(output) {
            self.last_felt = 0.0;
        }
    }
}

/// Place or force of a pad that the output is made of, m or N.
fn played(output: &ContactOutput, row: &PadSample) -> f64 {
    if output.quantity() == Quantity::Force { row.contact_force_n } else { row.pad_m }
}

fn still(output: &ContactOutput) -> f64 {
    match output.quantity() {
        Quantity::Displacement | Quantity::Tangential => STILL_M,
        Quantity::Acceleration => STILL_M_S2,
        Quantity::Force => STILL_N,
    }
}
