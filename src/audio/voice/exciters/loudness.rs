//! Loudness: the more of a contact touches, the more of it sounds.
//!
//! It is worked out at the steps of the absolute sample grid, so that it depends on no split into blocks, and goes along a straight line
//! between two of them.

/// How loud a contact is.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Loudness {
    /// At the last step of the grid, and at the next.
    ends: [f64; 2],
}

impl Loudness {
    /// Of a contact that begins.
    pub(super) fn of(loudness: f64) -> Self {
        Self { ends: [loudness; 2] }
    }

    /// Sets out for another.
    pub(super) fn set_out(&mut self, loudness: f64) {
        self.ends = [self.ends[1], loudness];
    }

    /// Weighs what the contact sends to the body, spread and as it is; `slow_step` samples lie between two steps of the grid.
    pub(super) fn weigh(&self, position: u64, slow_step: u64, spread: &mut [f64], unspread: &mut [f64]) {
        let [from, to] = self.ends;
        let first = (position % slow_step) as u32 + 1;
        let steps = slow_step as f64;
        for (i, (spread, unspread)) in (first..).zip(spread.iter_mut().zip(unspread)) {
            let part = f64::from(i) / steps;
            let weight = from + part * (to - from);
            *spread *= weight;
            *unspread *= weight;
        }
    }
}
