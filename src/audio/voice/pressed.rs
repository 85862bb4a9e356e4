//! What pressing harder changes: the contact stiffens and more of it sounds; and more of it sounds in a hollow than on a crest.
//!
//! Both follow the reported force and the ground, smoothed as the path is, at the steps of the absolute sample grid, so that they depend on no split into
//! blocks; between two steps the loudness goes along a straight line.

use super::{Scratch, Shared, Voice};
use crate::audio::seat::Seat;
use crate::prepared::area::{loudness, nestling};
use crate::prepared::stiffness::{Ground, stiffness_n_m};
use asperity_texture::height_field::MAX_BLOCK;

/// How a contact is pressed at present.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pressed {
    /// What the stiffness was worked out for.
    of: Option<(f64, Ground)>,
    /// Loudness at the last step of the grid, and at the next.
    loudness: [f64; 2],
}

impl Voice {
    /// The contact becomes as stiff as probe, ground and force make it; the loudness sets out for its new place.
    pub(super) fn stiffen(&mut self, seat: &mut Seat, shared: &Shared, position: u64, force_n: f64) {
        let tip_radius_m = shared.probe(self.role.probe).tip_radius_m();
        let touch = self.touch_at(position);
        let hollow = |reach_m| seat.hollow_m(&touch, reach_m, tip_radius_m);
        let loudness = loudness(force_n) * nestling(tip_radius_m, hollow);
        self.pressed.loudness = [self.pressed.loudness[1], loudness];
        let Some(slot) = seat.current() else { return };
        let now = (force_n, slot.stroking.ground);
        if self.pressed.of == Some(now) {
            return;
        }
        self.pressed.of = Some(now);
        let probe = shared.probe(self.role.probe);
        let stiffness_n_m = stiffness_n_m(probe.micro_contact.probe(), &now.1, force_n);
        probe.ladder.set(&mut self.contact_model, stiffness_n_m);
    }

    /// The contact begins as it is pressed.
    pub(super) fn begin_pressed(&mut self, seat: &mut Seat, shared: &Shared, position: u64, force_n: f64) {
        self.pressed = Pressed::default();
        self.stiffen(seat, shared, position, force_n);
        self.pressed.loudness[0] = self.pressed.loudness[1];
    }

    /// Weighs what the contact sends to the body by its loudness.
    pub(super) fn sound_as_pressed(&self, position: u64, n: usize, scratch: &mut Scratch) {
        let [from, to] = self.pressed.loudness;
        let first = position as usize % MAX_BLOCK;
        for (i, impulse_n_s) in scratch.out.impulse_n_s[..n].iter_mut().enumerate() {
            let part = (first + i + 1) as f64 / MAX_BLOCK as f64;
            *impulse_n_s *= from + part * (to - from);
        }
    }
}
