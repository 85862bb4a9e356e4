//! Ground: what a contact asks of its surface beside the profile, and what it presses on it.

use super::events::EMPTY_FORCE_N;
use super::rolling::{RolledOver, Rolling};
use super::shared::{Shared, Stretch};
use super::{Phase, Voice};
use crate::audio::seat::Seat;
use crate::prepared::area::{loudness, nestling};
use crate::prepared::stiffness::stiffness_n_m;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::micro_contact::Probe;
use asperity_texture::height_field::{MAX_BLOCK, SurfaceBlock, Touch, TouchKind};

impl Voice {
    /// Probe that presses on the touched body from here on; none within a cell of the absolute
    /// grid, where nobody asks. Before a stretch is rendered: how it presses at the end of one
    /// would depend on where the blocks are cut.
    pub(super) fn pressing_at(&self, stretch: Stretch<'_>, seat: &Seat) -> Option<Probe> {
        let on_grid = stretch.position.is_multiple_of(MAX_BLOCK as u64);
        seat.current().filter(|_| on_grid).and_then(|slot| self.pressing(stretch.shared, slot))
    }

    /// Probe that presses on the touched body, as stiff as its ground and the force make it, to a
    /// quarter of an octave. None while nothing presses.
    fn pressing(&self, shared: &Shared, slot: &SurfaceSlot) -> Option<Probe> {
        let force_n = self.path.last.normal_force_n;
        if self.phase != Phase::Sounding || force_n <= EMPTY_FORCE_N {
            return None;
        }
        let probe = shared.probe(self.role.probe).micro_contact.probe();
        let stiffness_n_m = stiffness_n_m(probe, &slot.stroking.ground, force_n);
        let contact_stiffness_n_m = libm::exp2((4.0 * libm::log2(stiffness_n_m)).round() / 4.0);
        Some(Probe { contact_stiffness_n_m, ..*probe })
    }

    /// Loudness of the contact: the harder it is pressed and the closer it nestles to the ground,
    /// the more of it sounds.
    pub(super) fn loudness(
        &self,
        shared: &Shared,
        position: u64,
        seat: &mut Seat,
        room: &mut SurfaceBlock,
    ) -> f64 {
        let tip_radius_m = shared.probe(self.role.probe).tip_radius_m();
        let touch = self.touch_at(position);
        let hollow_m = |reach_m| seat.hollow_m(&touch, (reach_m, tip_radius_m), room);
        loudness(self.path.last.normal_force_n) * nestling(tip_radius_m, hollow_m)
    }

    /// Over what it rolls at its last sample, to whoever minds.
    pub(super) fn roll(
        &mut self,
        shared: &Shared,
        seat: &mut Seat,
        room: &mut SurfaceBlock,
        then: impl FnOnce(&mut Rolling, RolledOver<'_>),
    ) {
        let source_power_m2 = seat.power_m2(&self.touch_at(0), room);
        let Some(slot) = seat.current() else { return };
        let over = RolledOver {
            slot,
            source_power_m2,
            probe: shared.probe(self.role.probe).micro_contact.probe(),
            at: &self.path.last,
            sample_rate_hz: shared.sample_rate_hz,
        };
        then(&mut self.rolling, over);
    }

    /// Pressing of the contact at its last sample.
    pub(super) fn touch_at(&self, position: u64) -> Touch {
        Touch {
            kind: TouchKind::Presses,
            contact: self.slot,
            sample: position,
            position_m: self.path.last.position_m,
            velocity_m_s: self.path.last.velocity_m_s,
            normal_force_n: self.path.last.normal_force_n,
        }
    }
}
