//! Loudness: the more a contact is pressed, the more of it sounds.
//!
//! It is worked out at the steps of the absolute sample grid, so that it depends on no split into blocks, and goes along a straight line
//! between two of them.

use crate::prepared::stiffness::loudness;
use asperity_texture::height_field::MAX_BLOCK;

/// How loud a contact is.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Loudness {
    /// The force that it was worked out for, N.
    pressed_n: Option<f64>,
    /// At the last step of the grid, and at the next.
    ends: [f64; 2],
}

impl Loudness {
    /// Of a contact that begins.
    pub(super) fn pressed(force_n: f64) -> Self {
        Self { pressed_n: Some(force_n), ends: [loudness(force_n); 2] }
    }

    /// Sets out for the loudness of another force.
    pub(super) fn press(&mut self, force_n: f64) {
        self.ends[0] = self.ends[1];
        if self.pressed_n != Some(force_n) {
            self.pressed_n = Some(force_n);
            self.ends[1] = loudness(force_n);
        }
    }

    /// Weighs what the contact sends to the body.
    pub(super) fn weigh(&self, position: u64, impulse_n_s: &mut [f64]) {
        let [from, to] = self.ends;
        let first = position as usize % MAX_BLOCK;
        for (i, impulse_n_s) in impulse_n_s.iter_mut().enumerate() {
            let part = (first + i + 1) as f64 / MAX_BLOCK as f64;
            *impulse_n_s *= from + part * (to - from);
        }
    }
}
