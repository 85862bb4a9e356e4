//! Ground: what a contact asks of its surface beside the profile, and what it presses on it; where
//! nothing of it moves or sounds it falls asleep, and costs nothing until something stirs.

use super::profile::Along;
use super::rolling::Rolling;
use super::{EMPTY_FORCE_N, PadSample, PathPoint, Scratch, Voice, VoiceState};
use crate::audio::seat::Seat;
use crate::audio::shared::{Segment, Shared};
use crate::resource::area::{loudness, nestling};
use crate::resource::rolled_over::RolledOver;
use asperity_dsp::micro_contact::Probe;
use asperity_surface::height_field::{PathBlock, SurfaceBlock, Touch, TouchKind};

impl Voice {
    /// Probe that presses on the touched body from a step of the absolute grid on, as stiff as
    /// ground and force make it, to a quarter of an octave; none while nothing presses.
    pub(super) fn pressing_at(&self, stretch: Segment<'_>, seat: &Seat) -> Option<Probe> {
        let force_n = self.path.last.normal_force_n;
        if !stretch.is_on_grid() || self.phase != VoiceState::Sounding || force_n <= EMPTY_FORCE_N {
            return None;
        }
        let slot = seat.current()?;
        let probe = stretch.shared.probe(self.role.probe).touching();
        let stiffness_n_m = probe.stiffness_n_m(&slot.stroking.ground, force_n);
        let contact_stiffness_n_m = libm::exp2((4.0 * libm::log2(stiffness_n_m)).round() / 4.0);
        Some(Probe { contact_stiffness_n_m, ..*probe.described() })
    }

    /// Loudness: grows with force and with how closely the tip nestles to the ground; a face spans
    /// it.
    pub(super) fn loudness(
        &self,
        shared: &Shared,
        position: u64,
        seat: &mut Seat,
        room: &mut SurfaceBlock,
    ) -> f64 {
        let probe = shared.probe(self.role.probe);
        let loudness = loudness(self.path.last.normal_force_n) * probe.heard_share();
        if probe.described().face_m > 0.0 {
            return loudness;
        }
        let (tip_radius_m, touch) = (probe.tip_radius_m(), self.touch_at(position));
        let local_concavity_m = |reach_m| seat.local_concavity_m(&touch, (reach_m, tip_radius_m), room);
        loudness * nestling(tip_radius_m, local_concavity_m)
    }

    /// Hands the ground under its last sample to what rolls.
    pub(super) fn roll(
        &mut self,
        shared: &Shared,
        seat: &mut Seat,
        room: &mut SurfaceBlock,
        then: impl FnOnce(&mut Rolling, RolledOver<'_>),
    ) {
        let source_power_m2 = seat.power_m2(&self.touch_at(0), room);
        let Some(slot) = seat.current() else { return };
        let probe = shared.probe(self.role.probe).micro_contact.probe();
        let (at, sample_rate_hz) = (&self.path.last, shared.sample_rate_hz);
        then(&mut self.rolling, RolledOver { slot, source_power_m2, probe, at, sample_rate_hz });
    }

    /// Decides what of the ground is sampled between samples: as it begins, and on the grid.
    pub(super) fn sample_between(&mut self, shared: &Shared, seat: &mut Seat) {
        if self.path.is_in_body() || self.rolling.rolls() {
            return self.between.leave();
        }
        let probe = shared.probe(self.role.probe);
        self.between.decide(shared, seat, probe, self.pad.probe(), &self.path.last);
    }

    /// Request for its profile.
    pub(super) fn along<'a>(
        &self,
        shared: &'a Shared,
        position: u64,
        seat: &Seat,
        slopes: bool,
    ) -> Along<'a> {
        let (contact, first_sample) = (self.slot, position);
        let probe = shared.probe(self.role.probe).described();
        let relief_m = seat.current().map_or(0.0, |slot| slot.properties.reach_m);
        let tip_radius_m = probe.ride_radius_m(relief_m);
        let block = PathBlock { contact, first_sample, slopes, tip_radius_m, ..PathBlock::default() };
        let micro_radius_m = probe.tip_radius_m;
        Along { shared, block, micro_radius_m, in_body: self.path.is_in_body(), between: None, tip: None }
    }

    /// Tests whether its probe is heard by a tip of its own.
    pub(super) fn has_tip(&self, shared: &Shared) -> bool {
        shared.probe(self.role.probe).tip.is_some()
    }

    /// Touch at its last sample.
    pub(super) fn touch_at(&self, position: u64) -> Touch {
        let PathPoint { position_m, velocity_m_s, normal_force_n } = self.path.last;
        let (kind, contact, sample) = (TouchKind::Presses, self.slot, position);
        Touch { kind, contact, sample, position_m, velocity_m_s, normal_force_n }
    }

    /// A resting contact: the rows stay as they were.
    pub(super) fn rest(&self, n: usize, scratch: &mut Scratch) {
        scratch.points[..n].fill(self.path.last);
        scratch.rows[..n].fill(self.last_row);
        let out = &mut scratch.out;
        out.haptic[..n].fill(self.ac.last_felt);
        out.impulse_n_s[..n].fill(0.0);
        (out.excites, out.counts) = (false, Default::default());
    }

    /// Falls asleep where nothing of it moves or sounds any more; called at the ends of grid cells.
    pub(super) fn fall_asleep_when_still(&mut self, stretch: Segment<'_>, scratch: &Scratch) {
        let Segment { output, position, n, .. } = stretch;
        let row = PadSample { onset: None, ..scratch.rows[n - 1] };
        self.last_row = row;
        if self.asleep {
            return;
        }
        self.asleep = self.ac.feels_still(output, &row)
            && self.path.is_still()
            && self.skin.is_still()
            && self.pad.is_settled(&row)
            && (!self.has_tip(stretch.shared) || self.tip.is_settled(&scratch.tip_rows[n - 1]))
            && self.reaction.grain_rate_per_s == 0.0
            && !self.reaction.wakes_contact
            && !scratch.out.rub.rubs
            && self.exciters.are_still(scratch.out.impulse_n_s[n - 1], position + n as u64);
        if self.asleep {
            self.ac.settle(output);
            self.exciters.settle();
        }
    }
}
