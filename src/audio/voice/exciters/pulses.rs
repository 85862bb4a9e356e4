//! Pulses of collisions and grains on their way to the body, without their mean.
//!
//! A collision pushes and never pulls, so that a stroke of many holds the body bent: inaudible, but
//! of the sound's energy and head room. A high-pass of second order takes the bend and leaves each
//! pulse its shape.

use super::{LONGEST_COLLISION_S, STILL_N_S};
use crate::prepared::impulse_ring::ImpulseRing;
use asperity_dsp::butterworth::{Butterworth, State};
use asperity_texture::height_field::MAX_BLOCK;

/// Pulses of one contact.
pub(super) struct Pulses {
    pub(super) ring: ImpulseRing,
    /// Their mean of late; zero where it has died away.
    mean: State,
}

impl Pulses {
    /// An empty ring. Allocates.
    pub(super) fn new(sample_rate_hz: f64) -> Self {
        Self { ring: ImpulseRing::new(LONGEST_COLLISION_S, sample_rate_hz), mean: State::default() }
    }

    /// Empties it for another contact.
    pub(super) fn begin(&mut self, position: u64) {
        self.mean = State::default();
        if !self.ring.is_empty(position) {
            self.ring.clear();
        }
    }

    /// Takes the impulses of the samples from `position` on, N·s; false, and nothing written, where
    /// there are none.
    pub(super) fn take(&mut self, high_pass: &Butterworth, position: u64, out: &mut [f64]) -> bool {
        // At the steps of the absolute grid, so that it depends on no split into blocks.
        if position.is_multiple_of(MAX_BLOCK as u64) && self.are_still(position) {
            self.mean = State::default();
        }
        if self.ring.is_empty(position) && self.mean == State::default() {
            return false;
        }
        let mut next = self.ring.drain(position);
        out.iter_mut().for_each(|y| *y = self.mean.tick(high_pass, next()).high);
        true
    }

    /// Tests whether no pulse comes from `end` on, and their mean has died away.
    pub(super) fn are_still(&self, end: u64) -> bool {
        self.ring.is_empty(end) && self.mean.is_within(STILL_N_S)
    }

    /// Drops the rest of the mean.
    pub(super) fn settle(&mut self) {
        self.mean = State::default();
    }
}
