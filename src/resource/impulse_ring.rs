//! Impulse ring: what is on its way to a body, on the absolute sample grid.
//!
//! Pulses are deposited where they fall, also between two samples, and taken out sample by sample;
//! what has been taken is zero for the next turn. It holds until when anything is in it, so that an
//! empty ring costs nothing.

use asperity_dsp::hertz::{self, HertzPulse};

/// Samples that every pulse needs besides its contact time.
const KERNEL_SAMPLES: usize = 16;

/// Values on their way, N·s or what they become.
pub(crate) struct ImpulseRing<T = f64> {
    values: Box<[T]>,
    /// The first sample from which on it is empty.
    busy_until: u64,
}

impl<T: Copy + Default> ImpulseRing<T> {
    /// A ring that holds pulses of up to `longest_s`.
    pub(crate) fn new(longest_s: f64, sample_rate_hz: f64) -> Self {
        let samples = ((longest_s * sample_rate_hz) as usize + KERNEL_SAMPLES).next_power_of_two();
        Self { values: vec![T::default(); samples].into(), busy_until: 0 }
    }

    /// Tests whether nothing comes from `position` on.
    pub(crate) fn is_empty(&self, position: u64) -> bool {
        self.busy_until <= position
    }

    /// The first sample from which on it is empty.
    pub(crate) fn busy_until(&self) -> u64 {
        self.busy_until
    }

    /// Clears everything.
    pub(crate) fn clear(&mut self) {
        self.values.fill(T::default());
        self.busy_until = 0;
    }

    /// Lets `write` add values that end before a sample.
    pub(crate) fn write(&mut self, end: u64, write: impl FnOnce(&mut [T])) {
        write(&mut self.values);
        self.busy_until = self.busy_until.max(end);
    }

    /// Takes the values from `position` on.
    pub(crate) fn take_into(&mut self, position: u64, out: &mut [T]) {
        let at = position as usize & (self.values.len() - 1);
        let (first, rest) = out.split_at_mut(out.len().min(self.values.len() - at));
        for (out, from) in [(first, at), (rest, 0)] {
            let values = &mut self.values[from..from + out.len()];
            out.copy_from_slice(values);
            values.fill(T::default());
        }
    }

    /// Takes the next values, from `position` on, in order.
    pub(crate) fn drain(&mut self, position: u64) -> impl FnMut() -> T {
        let mask = self.values.len() - 1;
        let mut at = position as usize;
        move || {
            let value = std::mem::take(&mut self.values[at & mask]);
            at = at.wrapping_add(1);
            value
        }
    }
}

impl ImpulseRing {
    /// Adds a pulse whose contact begins at a place between two samples.
    pub(crate) fn deposit(&mut self, pulse: &HertzPulse, sample: u64, offset: f64, sample_rate_hz: f64) {
        let end = pulse.end_sample(sample, sample_rate_hz);
        self.write(end, |values| pulse.deposit(values, sample, offset, sample_rate_hz));
    }

    /// Takes the impulses of the coming samples; what is too small to ring anything is zero.
    pub(crate) fn take(&mut self, position: u64, out: &mut [f32]) {
        hertz::take(&mut self.values, position, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_deposited_comes_out_once_and_whole_wherever_it_is_cut() {
        let pulse = HertzPulse::elastic(2e-3, 1e-3);
        let take = |cuts: &[usize]| {
            let mut ring = ImpulseRing::new(0.01, 44_100.0);
            ring.deposit(&pulse, 1_000_000, 0.3, 44_100.0);
            assert!(ring.is_empty(1_000_100) && !ring.is_empty(1_000_000));
            let mut position = 1_000_000;
            let mut all = Vec::new();
            for n in cuts {
                let mut out = vec![0.0; *n];
                ring.take(position, &mut out);
                all.extend(out);
                position += *n as u64;
            }
            let mut next = ring.drain(1_000_000);
            assert!((0..600).all(|_| next() == 0.0), "it is empty for the next turn");
            all
        };
        let whole = take(&[100]);
        assert!(whole == take(&[1, 40, 3, 56]));
        let sum: f64 = whole.iter().map(|x| f64::from(*x)).sum();
        assert!((sum - 2e-3).abs() < 1e-9, "{sum}");
    }
}
