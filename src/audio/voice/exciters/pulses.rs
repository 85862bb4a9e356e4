//! Pulses on their way to a body: spread for its bank, and as they are for what the bank leaves out of their first samples.

use crate::prepared::impulse_ring::ImpulseRing;
use asperity_dsp::hertz::HertzPulse;

/// The pulses of one contact.
pub(super) struct Pulses {
    spread: ImpulseRing,
    steps: ImpulseRing,
}

impl Pulses {
    /// For pulses of up to `longest_s`. Allocates.
    pub(super) fn new(longest_s: f64, sample_rate_hz: f64) -> Self {
        let ring = || ImpulseRing::new(longest_s, sample_rate_hz);
        Self { spread: ring(), steps: ring() }
    }

    /// Adds a pulse whose contact begins at a place between two samples.
    pub(super) fn deposit(&mut self, pulse: &HertzPulse, sample: u64, offset: f64, sample_rate_hz: f64) {
        self.spread.deposit(pulse, sample, offset, sample_rate_hz);
        let end = pulse.end_sample(sample, sample_rate_hz);
        self.steps.write(end, |steps| pulse.deposit_steps(steps, sample, offset, sample_rate_hz));
    }

    /// Takes those of the coming samples, if there are any; both rings are empty beyond the last pulse, and leave what they are given as it is.
    pub(super) fn take(&mut self, position: u64, spread: &mut [f64], steps: &mut [f64]) -> bool {
        let any = !self.is_empty(position);
        if any {
            for (ring, out) in [(&mut self.spread, spread), (&mut self.steps, steps)] {
                let mut next = ring.drain(position);
                out.iter_mut().for_each(|y| *y = next());
            }
        }
        any
    }

    /// Whether nothing comes from `position` on.
    pub(super) fn is_empty(&self, position: u64) -> bool {
        self.spread.is_empty(position)
    }

    /// Forgets what comes from `position` on.
    pub(super) fn clear(&mut self, position: u64) {
        if !self.is_empty(position) {
            self.spread.clear();
            self.steps.clear();
        }
    }
}
