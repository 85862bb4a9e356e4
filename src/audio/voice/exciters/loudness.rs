//! Loudness: the more of a contact touches, the more of it sounds.
//!
//! It is worked out at the steps of the absolute sample grid, so that it depends on no split into
//! blocks, and goes along a straight line between two of them.

/// Loudness of a contact.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::audio::voice) struct Loudness {
    /// At the last step of the grid, and at the next.
    ends: [f64; 2],
}

impl Loudness {
    /// Loudness of a contact that begins.
    pub(in crate::audio::voice) fn of(loudness: f64) -> Self {
        Self { ends: [loudness; 2] }
    }

    /// Sets out for another.
    pub(in crate::audio::voice) fn set_out(&mut self, loudness: f64) {
        self.ends = [self.ends[1], loudness];
    }

    /// Weighs what a contact gives, of which the first sample has this place; `slow_step` samples
    /// lie between two steps of the grid.
    pub(in crate::audio::voice) fn weigh(&self, position: u64, slow_step: u64, samples: &mut [f64]) {
        let [from, to] = self.ends;
        let first = (position % slow_step) as u32 + 1;
        let steps = slow_step as f64;
        for (i, sample) in (first..).zip(samples) {
            let part = f64::from(i) / steps;
            *sample *= from + part * (to - from);
        }
    }
}
