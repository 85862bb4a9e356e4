//! Smoothed gains: factors that follow their target without a step, by one pole a sample or along a
//! straight line.
//!
//! ```text
//! g[n+1] = g[n] + (1 − e^(−1/(τ rate))) (target − g[n])          τ = 5 ms
//! ```
//!
//! It ends exactly on its target, so that a gain of 1 that was left and taken again changes no bit
//! afterwards.

/// Time constant, s: a fade of some 20 ms, no click and no wait.
const TIME_CONSTANT_S: f64 = 0.005;
/// Rest of the way at which it counts as done: −120 dB.
const THERE: f64 = 1e-6;

/// A gain, and where it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Smoothed {
    now: f64,
    share: f64,
}

impl Smoothed {
    /// A gain of 1.
    pub(crate) fn new(sample_rate_hz: f64) -> Self {
        Self { now: 1.0, share: 1.0 - libm::exp(-1.0 / (TIME_CONSTANT_S * sample_rate_hz)) }
    }

    /// A gain that has been `gain` for ever.
    pub(crate) fn settled(gain: f64, sample_rate_hz: f64) -> Self {
        Self { now: gain, ..Self::new(sample_rate_hz) }
    }

    /// Is there at once.
    pub(crate) fn set(&mut self, gain: f64) {
        self.now = gain;
    }

    /// Tests whether the gain is `target`, and stays it.
    pub(crate) fn settled_at(&self, target: f64) -> bool {
        self.now == target
    }

    /// The next gain on the way to `target`.
    pub(crate) fn tick(&mut self, target: f64) -> f64 {
        let left = target - self.now;
        let there = left.abs() <= THERE * target.abs().max(1.0);
        self.now = if there { target } else { self.now + self.share * left };
        self.now
    }
}

/// A factor that is worked out at the steps of the absolute sample grid, so that it depends on no
/// split into blocks, and goes along a straight line between two of them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Ramp {
    /// At the last step of the grid, and at the next.
    ends: [f64; 2],
}

impl Ramp {
    /// A factor that has been this for ever.
    pub(crate) fn at(factor: f64) -> Self {
        Self { ends: [factor; 2] }
    }

    /// Sets out for another.
    pub(crate) fn aim(&mut self, factor: f64) {
        self.ends = [self.ends[1], factor];
    }

    /// Multiplies samples of which the first has this place; `slow_step` samples lie between two
    /// steps of the grid.
    pub(crate) fn weigh(&self, position: u64, slow_step: u64, samples: &mut [f64]) {
        let [from, to] = self.ends;
        let first = (position % slow_step) as u32 + 1;
        let steps = slow_step as f64;
        for (i, sample) in (first..).zip(samples) {
            let part = f64::from(i) / steps;
            *sample *= from + part * (to - from);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_arrives_within_a_tenth_of_a_second_without_a_step() {
        for rate_hz in [22_050.0, 44_100.0, 192_000.0] {
            let mut gain = Smoothed::new(rate_hz);
            for target in [0.0, 1.0, 3.0] {
                let (mut before, mut steps) = (gain.now, 0);
                while !gain.settled_at(target) {
                    let now = gain.tick(target);
                    // The steepest of one pole from where it was.
                    assert!((now - before).abs() < 2.0 / (TIME_CONSTANT_S * rate_hz) + 1e-5);
                    (before, steps) = (now, steps + 1);
                }
                assert!(f64::from(steps) < 0.1 * rate_hz && gain.tick(target) == target);
            }
        }
    }
}
