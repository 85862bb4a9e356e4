//! One contact: the signal path of the paper on one screen (Hasti, Fig. 2).
//!
//! ```text
//! path → profile → pad ┬→ AC coupling → skin → felt ───────────┬→ fades → channel, body
//!                      └→ AC coupling, exciters → impulses ────┘
//! ```
//! Each stage is a file: its own state, what it is told, inputs in, outputs out.

mod ac_coupling;
mod between;
mod block;
mod blows;
mod body_path;
mod drag;
mod events;
mod exciters;
mod fades;
mod ground;
mod pad;
mod path;
mod profile;
mod rest;
mod role;
mod rolling;
mod rub_block;
mod scratch;
mod shared;
mod side_by_side;
mod skin;
mod tip;
mod watching;

pub(crate) use block::VoiceBlock;
pub(crate) use events::EMPTY_FORCE_N;
pub(crate) use role::Role;
pub(crate) use scratch::Scratch;
pub(crate) use shared::{At, Shared, Stretch};
pub(crate) use side_by_side::{Company, Member};

use crate::audio::seat::Seat;
use crate::link::tap::Tap;
use crate::model::event::{ContactId, ContactSample};
use crate::model::excitation::Exciter;
use crate::prepared::overlay::TileCells;
use ac_coupling::{AcCoupling, ForceCoupling};
use asperity_dsp::actuator::{ContactOutputState, Quantity};
use asperity_dsp::micro_contact::ContactSample as PadSample;
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::{MAX_BLOCK, Reaction};
use between::Between;
use blows::Blows;
use drag::Drag;
use exciters::{Excited, Exciters};
use fades::Fades;
use pad::Pad;
use path::Path;
use profile::Along;
use rolling::Rolling;
use scratch::Lane;
use shared::Pass;
use skin::ContactSkin;
use tip::Tip;
use watching::Done;

/// Where the sound and feel of a voice stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Nobody's.
    Free,
    /// Touching.
    Sounding,
    /// Going silent within `left` samples.
    Fading { left: u32 },
}

/// One contact.
pub(crate) struct Voice {
    pub(crate) contact: ContactId,
    pub(crate) surface: usize,
    pub(crate) role: Role,
    pub(crate) phase: Phase,
    pub(crate) begun: u64,
    pub(crate) refreshed: u64,
    /// Whether it fades because the game said so, and not because it lapsed or was stolen.
    pub(crate) ended: bool,
    /// Whether it fades because its contact has jumped and goes on in another voice.
    left_behind: bool,
    /// Reports without force in a row.
    empty_reports: u32,
    slot: usize,
    asleep: bool,
    last_row: PadSample,
    /// What the surface does back.
    reaction: Reaction,
    /// Sent to the body since the last row that was shown, N·s.
    unshown_n_s: f64,
    path: Path,
    /// Where in the micro-relief it is.
    cells: TileCells,
    between: Between,
    rolling: Rolling,
    tip: Tip,
    pad: Pad,
    drag: Drag,
    ac: AcCoupling,
    skin: ContactSkin,
    exciters: Exciters,
    blows: Blows,
    fades: Fades,
}

impl Voice {
    /// A voice that nobody uses; `slot` is its place in the renderer. Allocates.
    pub(crate) fn free(slot: usize, shared: &Shared) -> Self {
        Self::idle(slot, shared, shared.sample_rate_hz)
    }

    /// What stands in the place of a voice that another thread renders: it is never rendered itself, and small. Allocates.
    pub(crate) fn stand_in(shared: &Shared) -> Self {
        Self::idle(0, shared, 0.0)
    }

    fn idle(slot: usize, shared: &Shared, sample_rate_hz: f64) -> Self {
        Self {
            contact: ContactId(0),
            surface: 0,
            role: Role::default(),
            phase: Phase::Free,
            begun: 0,
            refreshed: 0,
            ended: false,
            left_behind: false,
            empty_reports: 0,
            slot,
            asleep: false,
            last_row: PadSample::default(),
            reaction: Reaction::default(),
            unshown_n_s: 0.0,
            path: Path::idle(&shared.idle_path),
            cells: TileCells::default(),
            between: Between::default(),
            rolling: Rolling::default(),
            tip: Tip::default(),
            pad: Pad::idle(&shared.own_probe),
            drag: Drag::idle(sample_rate_hz),
            ac: AcCoupling::idle(&shared.idle_output),
            skin: ContactSkin::default(),
            exciters: Exciters::idle(slot as u64, sample_rate_hz),
            blows: Blows::default(),
            fades: Fades::idle(sample_rate_hz),
        }
    }

    /// A report tells what carries its tip, or that it is pressed, and whether it rolls.
    pub(crate) fn carry(&mut self, sample: &ContactSample) {
        self.tip.carry(sample);
        self.rolling.tell(sample);
    }

    /// Whether there is anything to render but rest.
    pub(crate) fn works(&self) -> bool {
        self.phase != Phase::Free && !self.asleep
    }

    /// Something changed under a resting contact.
    pub(crate) fn wake(&mut self) {
        self.asleep = false;
    }

    /// How much would be missed: what presses harder and moves faster is heard and felt more.
    pub(crate) fn priority(&self) -> f64 {
        let [u, v] = self.path.last.velocity_m_s;
        let speed_m_s = (u * u + v * v).sqrt();
        match self.phase {
            Phase::Free | Phase::Fading { .. } => -1.0,
            Phase::Sounding => self.role.importance * self.path.last.normal_force_n * (1e-3 + speed_m_s),
        }
    }

    /// Renders a stretch into `scratch.out`.
    pub(crate) fn render<T: Tap>(
        &mut self,
        stretch: Stretch<'_>,
        seat: &mut Seat,
        scratch: &mut Scratch,
        tap: &mut T,
    ) {
        let pass = self.approach(stretch, (tap.is_watching(), false), seat, scratch, 0);
        if pass.slides {
            scratch.lanes[0].press(&mut self.pad, pass.n);
            self.settle(stretch.shared, pass, &mut scratch.lanes[0]);
        }
        self.finish(stretch, pass, seat, scratch, 0, tap);
    }

    /// Whether it moves through a whole stretch on its surface, whatever that does: its path asks nobody.
    fn sets_out(&self) -> bool {
        self.phase == Phase::Sounding && !self.asleep && !self.path.is_in_body()
    }

    /// The part of a stretch that asks the surface: from reports to the profile under `lane`, whose points are there if it has `set_out`.
    fn approach(
        &mut self,
        stretch: Stretch<'_>,
        (slopes, set_out): (bool, bool),
        seat: &mut Seat,
        scratch: &mut Scratch,
        lane: usize,
    ) -> Pass {
        let (position, wanted) = (stretch.position, stretch.n);
        // Nothing is computed, counted or shown after a fade, wherever the stretch ends.
        let n = match self.phase {
            Phase::Fading { left } => wanted.min(left as usize),
            Phase::Free | Phase::Sounding => wanted,
        };
        // First the touch, then the heights: a surface that gives way answers within the same grid
        // cell wherever it is cut into stretches. Who sleeps still touches, and wakes when the ground stirs.
        if position.is_multiple_of(MAX_BLOCK as u64) {
            self.reaction = seat.react(&self.touch_at(position));
            self.asleep &= !self.reaction.stirs;
        }
        let slides =
            !self.asleep && self.slide_to(Stretch { n, ..stretch }, (slopes, set_out), seat, scratch, lane);
        Pass { n, slides, coupled: false }
    }

    /// Where the contact goes, and what lies there; false where there is no surface.
    fn slide_to(
        &mut self,
        stretch: Stretch<'_>,
        (slopes, set_out): (bool, bool),
        seat: &mut Seat,
        scratch: &mut Scratch,
        lane: usize,
    ) -> bool {
        let Stretch { shared, output, position, n } = stretch;
        if position.is_multiple_of(shared.slow_step) {
            self.take_step(stretch, seat);
        }
        let Some(slot) = seat.current() else { return false };
        let Scratch { lanes, profile, .. } = scratch;
        let own = &mut lanes[lane];
        let points = &mut own.points[..n];
        let dragged = output.quantity() == Quantity::Tangential;
        if !set_out {
            self.path.run(slot, points, &mut profile.at_m);
        }
        let between = self.between.on_the_way(self.path.last.position_m);
        let along = Along { between, ..self.along(shared, position, slopes || dragged) };
        profile.run(seat, along, points, &mut self.cells);
        self.rolling.run(position, shared.slow_step, &mut profile.surface, n, slopes || dragged);
        own.height_m[..n].copy_from_slice(&profile.surface.height_m[..n]);
        own.force_n[..n].copy_from_slice(&profile.force_n[..n]);
        own.looks = self.between.bend(shared, &profile.seen, n, &mut own.bends);
        if let Some(roughness) = profile.surface.roughness[..n].last() {
            self.between.remember(*roughness);
        }
        true
    }

    /// What is slow, at the steps of the absolute grid. By itself, because most short stretches have none.
    #[inline(never)]
    fn take_step(&mut self, stretch: Stretch<'_>, seat: &mut Seat) {
        let Stretch { shared, output, position, .. } = stretch;
        let PathPoint { velocity_m_s, normal_force_n, .. } = self.path.last;
        self.exciters.press(self.loudness(shared, position, seat), velocity_m_s);
        if self.rolling.rolls() {
            self.roll(shared, seat, Rolling::turn);
        }
        let Some(slot) = seat.current() else { return };
        let probe = shared.probe(self.role.probe);
        self.pad.stiffen(probe, slot.stroking.ground, normal_force_n);
        if output.quantity() == Quantity::Tangential {
            self.drag.press(normal_force_n);
        } else {
            self.skin.soften(probe, output, &self.path.last, shared.sample_rate_hz);
        }
        self.look_between(shared, seat);
    }

    /// The rows of the pad's model as they are felt.
    fn settle(&mut self, shared: &Shared, pass: Pass, lane: &mut Lane) {
        let rows = &mut lane.rows[..pass.n];
        lane.resets = self.pad.settle(shared.probe(self.role.probe).waits, rows);
        lane.blows = self.blows.count(rows);
    }

    /// The rest of a stretch, into `scratch.out`.
    fn finish<T: Tap>(
        &mut self,
        stretch: Stretch<'_>,
        pass: Pass,
        seat: &Seat,
        scratch: &mut Scratch,
        lane: usize,
        tap: &mut T,
    ) {
        let (position, wanted) = (stretch.position, stretch.n);
        let Pass { n, slides, coupled } = pass;
        let stretch = Stretch { n, ..stretch };
        scratch.out.silence(n..wanted);
        scratch.out.rub.rubs = false;
        if slides {
            self.let_go(stretch, coupled, seat, scratch, lane);
        } else if self.asleep {
            self.rest(n, scratch, lane);
        }
        self.phase = self.fades.run(self.phase, self.role.gain, stretch.shared, n, &mut scratch.out);
        // A contact that has jumped is shown where it is, and not where it fades.
        if tap.is_watching() && !self.left_behind {
            self.show(stretch, seat, scratch, lane, tap);
        }
        if self.phase == Phase::Free {
            return;
        }
        self.path.last = scratch.lanes[lane].points[n - 1];
        if (position + n as u64).is_multiple_of(MAX_BLOCK as u64) {
            self.fall_asleep_when_still(stretch, scratch, lane);
        }
    }

    /// From the pad's rows to what is felt and what strikes the body.
    fn let_go(
        &mut self,
        stretch: Stretch<'_>,
        coupled: bool,
        seat: &Seat,
        scratch: &mut Scratch,
        lane: usize,
    ) {
        let Stretch { shared, output, position, n } = stretch;
        let Scratch { lanes, coupled: among, profile, force, out, .. } = scratch;
        let Lane { points, rows, resets, blows, .. } = &lanes[lane];
        let (points, rows) = (&points[..n], &rows[..n]);
        let probe = shared.probe(self.role.probe);
        (out.resets, out.blows) = (*resets, *blows);

        let Some(slot) = seat.current() else { return };
        let sounds = slot.surface.excitation.has(Exciter::Force);
        let step_s = if sounds { 1.0 / shared.sample_rate_hz } else { 0.0 };
        let heard = ForceCoupling { high_pass: &slot.stroking.force_high_pass, step_s };
        let dragged = output.quantity() == Quantity::Tangential;
        let felt = if dragged {
            let (rows, from_m) = self.drag.run(points, &profile.surface, rows);
            // A skin that has been dragged for long begins as if it had been there for ever.
            if let Some(from_m) = from_m {
                self.ac.feel = ContactOutputState::begin(output, from_m, 0.0);
            }
            rows
        } else {
            rows
        };
        if coupled {
            self.ac.leave(step_s, lane, among, &mut out.haptic[..n], force.samples(n));
        } else {
            self.ac.run(output, heard, felt, &mut out.haptic[..n], force.samples(n));
        }
        if !dragged {
            self.skin.pass(position, shared.slow_step, &mut out.haptic[..n]);
        }
        let (reaction, sample_rate_hz) = (self.reaction, shared.sample_rate_hz);
        let slow_step = shared.slow_step;
        let by = Excited { slot, probe, reaction, sample_rate_hz, slow_step, position };
        self.exciters.run(&by, rows, force, out);
        let sent = [&mut out.impulse_n_s[..n], &mut out.force_n_s[..n]];
        self.rolling.soften(position, slow_step, sent);
        self.exciters.rub(&by, points, rows, out);
        self.rolling.slow_down(position, slow_step, &mut out.rub.sweep_m_s[..n]);
    }

    fn show<T: Tap>(
        &mut self,
        stretch: Stretch<'_>,
        seat: &Seat,
        scratch: &mut Scratch,
        lane: usize,
        tap: &mut T,
    ) {
        let Some(slot) = seat.current() else { return };
        let Scratch { lanes, profile, shown, out, .. } = scratch;
        let Lane { points, rows, .. } = &lanes[lane];
        let done = Done {
            contact: self.contact,
            role: &self.role,
            begun: self.begun,
            last_point: self.path.last,
            size_m: [slot.surface.width_m, slot.surface.height_m],
            asleep: self.asleep,
            points,
            profile,
            rows,
            impulse_n_s: &out.impulse_n_s,
        };
        shown.show(stretch, &done, &mut self.tip, &mut self.unshown_n_s, tap);
    }
}
