//! Tails: bodies that were removed or replaced ring out until they sleep.
//!
//! Each rings at a place behind those that the game names, as it rang at its own: same gain, same
//! bus. So many ring at a time; beyond that the quietest is damped, and where even those that are
//! damped find no place, the quietest of them ends within one or two blocks.
//!
//! ```text
//! places of the game │ RINGING + FADING places: ring out → (too many) damped → home
//!                                                                          └ (no place) cut → the buses' endings
//! ```

use super::Renderer;
use crate::link::message::{Made, Retired};
use crate::link::stats::Counters;
use asperity_surface::height_field::MAX_BLOCK;

/// Bodies that ring out at the same time.
const RINGING: usize = 64;
/// Bodies that may fade beside them.
const FADING: usize = 32;
/// Places where bodies ring out.
pub(super) const TAILS: usize = RINGING + FADING;

impl Renderer {
    /// The body at a place rings out, elsewhere.
    pub(super) fn let_ring(&mut self, slot: usize) {
        if self.bodies[slot].is_silent(self.position) {
            return self.send_home(slot, Retired::Body);
        }
        let first = self.bodies.len() - TAILS;
        let tails = first..self.bodies.len();
        let rings = |seat: &usize| !self.bodies[*seat].is_empty() && !self.bodies[*seat].is_damped();
        if tails.clone().filter(rings).count() >= RINGING
            && let Some(quietest) = self.quietest(tails.clone().filter(rings))
        {
            self.bodies[quietest].damp();
            Counters::add(&self.counters.given_way, 1);
        }
        let free = tails.clone().find(|seat| self.bodies[*seat].is_empty()).or_else(|| {
            let quietest = self.quietest(tails.filter(|seat| self.bodies[*seat].is_damped()))?;
            self.cut(quietest);
            Some(quietest)
        });
        let Some(free) = free else { return };
        let (places, tails) = self.bodies.split_at_mut(first);
        places[slot].leave_for(&mut tails[free - first], self.position);
        self.bodies_used.insert(free);
    }

    fn quietest(&self, seats: impl Iterator<Item = usize>) -> Option<usize> {
        seats.min_by(|a, b| self.bodies[*a].loudness().total_cmp(&self.bodies[*b].loudness()))
    }

    /// Ends a body at once: what is left of it, faded, goes into the endings of its buses.
    fn cut(&mut self, seat: usize) {
        let to_grid = MAX_BLOCK - (self.position % MAX_BLOCK as u64) as usize;
        let n = to_grid + MAX_BLOCK;
        let mut sound = [0.0; 2 * MAX_BLOCK];
        for (from, to) in [(0, to_grid), (to_grid, n)] {
            let args = self.body_args(self.position + from as u64);
            self.bodies[seat].render(args, None, &mut sound[from..to]);
        }
        let body = &mut self.bodies[seat];
        body.scale(&mut sound[..n]);
        body.spread(&sound[..n], |bus, i, x| {
            // Without a corner at either end.
            let left = 1.0 - (i + 1) as f32 / n as f32;
            if let Some(bus) = self.buses.get_mut(bus) {
                bus.end_with(self.position + i as u64, left * left * (3.0 - 2.0 * left) * x);
            }
        });
        self.send_home(seat, Retired::Cut);
    }

    /// Sends the body at a place home; every message waits until there is room for it.
    fn send_home(&mut self, seat: usize, as_dead: fn(Made) -> Retired) {
        if let Some(body) = self.bodies[seat].take() {
            let _ = self.to_game.send(as_dead(body));
        }
    }
}
