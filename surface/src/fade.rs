//! Changing a value at run time without a click.
//!
//! A change named at an absolute sample takes [`FADE_S`] to arrive: what the old and the new value
//! give is mixed with the weight w(t) = 3t² − 2t³, t from 0 to 1. The steepest step of w is 1.5
//! over the number of samples, −66 dB at 32 kHz and above: no change, however large, puts a step
//! above −60 dB of the signal into the output. A change that comes during a fade waits for its end;
//! of several that wait, the last one counts.
//!
//! The mix at a sample is a function of the sample's absolute index and of the changes made before
//! it, whatever blocks are asked for and by how many contacts.

use crate::height_field::Setup;

/// Length of a fade, seconds: at 22.05 kHz the steepest step is still −63 dB. Ours.
pub const FADE_S: f64 = 0.1;

fn fade_samples(sample_rate_hz: f64) -> u64 {
    (FADE_S * sample_rate_hz).ceil().max(1.0) as u64
}

/// A value, the value it is becoming, and the one it will become after that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fade<T: Copy> {
    values: [T; 3],
    start: u64,
    next_start: u64,
    length: u64,
}

impl<T: Copy> Fade<T> {
    /// A settled value, for the rate of [`Setup::default`] until [`prepare`](Self::prepare) sets
    /// another.
    pub fn new(value: T) -> Self {
        let length = fade_samples(Setup::default().sample_rate_hz);
        Self { values: [value; 3], start: u64::MAX, next_start: u64::MAX, length }
    }

    /// Takes the rate of an engine; a change that is under way has arrived.
    pub fn prepare(&mut self, sample_rate_hz: f64) {
        *self = Self { length: fade_samples(sample_rate_hz), ..Self::new(self.target()) };
    }

    /// Begins to change to `value` at an absolute sample (or when the running fade ends).
    pub fn set(&mut self, value: T, sample: u64) {
        if sample >= self.next_start {
            self.values = [self.values[1], self.values[2], self.values[2]];
            self.start = self.next_start;
            self.next_start = u64::MAX;
        }
        if self.start == u64::MAX || sample >= self.start.saturating_add(self.length) {
            let settled = if self.start == u64::MAX { self.values[0] } else { self.values[1] };
            self.values = [settled, value, value];
            self.start = sample;
        } else {
            self.values[2] = value;
            self.next_start = self.start.saturating_add(self.length);
        }
    }

    /// The values [`Fade::weights`] speaks of.
    pub fn values(&self) -> &[T; 3] {
        &self.values
    }

    /// The weight of each value at a sample; they sum to 1 and at most two are not 0.
    #[must_use]
    pub fn weights(&self, sample: u64) -> [f64; 3] {
        let progress = |start: u64| {
            let t = ((sample.saturating_sub(start)) as f64 / self.length as f64).min(1.0);
            t * t * (3.0 - 2.0 * t)
        };
        if sample < self.start {
            [1.0, 0.0, 0.0]
        } else if sample < self.next_start {
            let w = progress(self.start);
            [1.0 - w, w, 0.0]
        } else {
            let w = progress(self.next_start);
            [0.0, 1.0 - w, w]
        }
    }

    /// The latest value that was asked for.
    pub fn target(&self) -> T {
        if self.start == u64::MAX {
            self.values[0]
        } else if self.next_start == u64::MAX {
            self.values[1]
        } else {
            self.values[2]
        }
    }
}

impl Fade<f64> {
    /// The number itself at a sample.
    #[must_use]
    pub fn at(&self, sample: u64) -> f64 {
        let w = self.weights(sample);
        let mut sum = 0.0;
        for (w, v) in w.iter().zip(&self.values) {
            if *w != 0.0 {
                sum += w * v;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_arrives_after_the_fade_and_never_steps() {
        for rate_hz in [22_050.0, 44_100.0, 192_000.0] {
            let mut fade = Fade::new(0.0);
            fade.prepare(rate_hz);
            fade.set(1.0, 1000);
            let length = (FADE_S * rate_hz) as u64;
            assert_eq!(fade.at(1000), 0.0);
            assert_eq!(fade.at(1000 + length), 1.0);
            let steepest = (0..length + 2000).map(|n| fade.at(n + 1) - fade.at(n)).fold(0.0, f64::max);
            assert!(20.0 * steepest.log10() < -60.0, "{steepest} at {rate_hz} Hz");
        }
    }

    #[test]
    fn a_change_during_a_fade_waits_and_only_the_last_one_counts() {
        let mut fade = Fade::new(0.0);
        fade.set(1.0, 0);
        fade.set(5.0, 100);
        fade.set(2.0, 200);
        assert_eq!(fade.target(), 2.0);
        assert_eq!(fade.at(4410), 1.0);
        assert_eq!(fade.at(8820), 2.0);
        // The past is not rewritten by a later change.
        fade.set(3.0, 6000);
        assert_eq!(fade.at(8820), 2.0);
        assert_eq!(fade.at(8820 + 4410), 3.0);
        fade.set(0.0, 50_000);
        assert_eq!((fade.at(50_000), fade.at(60_000)), (3.0, 0.0));
    }
}
