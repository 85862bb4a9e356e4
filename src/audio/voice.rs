//! One contact: the signal path of the paper on one screen (Hasti, Fig. 2).
//!
//! ```text
//! path → profile, rolling → pad ┬→ coupling → skin → felt ─────────────────┬→ fades, level → channel, body
//!                         (tip) └→ coupling, exciters, rolling → impulses ─┘
//! ```
//! [`Voice::render`] names the stages in their order; each is a file.

mod between;
mod block;
mod coupling;
mod events;
mod exciters;
mod fades;
mod ground;
mod pad;
mod path;
mod profile;
mod rolling;
mod skin;
mod tap;
mod tip;

pub(crate) use block::{Scratch, VoiceBlock};
pub(crate) use events::EMPTY_FORCE_N;

use crate::audio::binding::Binding;
use crate::audio::seat::Seat;
use crate::audio::shared::{Segment, Shared};
use crate::link::tap::Tap;
use crate::model::event::{ContactId, ContactSample};
use crate::model::excitation::Exciter;
use crate::resource::overlay::TileCells;
use crate::resource::tip_force::TipForce;
use asperity_dsp::actuator::{ContactOutputState, Quantity};
use asperity_dsp::hertz::FORCE_HISTORY;
use asperity_dsp::micro_contact::{ContactSample as PadSample, Probe};
use asperity_dsp::trajectory::PathPoint;
use asperity_surface::height_field::{MAX_BLOCK, Reaction};
use between::Between;
use coupling::AcCoupling;
use exciters::{Excited, Exciters};
use fades::Fades;
use pad::Pad;
use path::Path;
use profile::Along;
use rolling::Rolling;
use skin::{ContactSkin, Drag};
use tip::Tip;

/// State of a voice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum VoiceState {
    Free,
    Sounding,
    /// Going silent within `left` samples.
    Fading {
        left: u32,
    },
}

/// One contact.
pub(crate) struct Voice {
    pub(crate) contact: ContactId,
    pub(crate) surface: usize,
    pub(crate) role: Binding,
    pub(crate) phase: VoiceState,
    pub(crate) begun: u64,
    pub(crate) refreshed: u64,
    /// True where it fades because the game said so, and not because it lapsed or was stolen.
    pub(crate) ended: bool,
    /// True where it fades because its contact has jumped and goes on in another voice.
    left_behind: bool,
    /// Reports without force in a row.
    empty_reports: u32,
    slot: usize,
    asleep: bool,
    last_row: PadSample,
    reaction: Reaction,
    /// Sent to the body since the last row that was shown, N·s.
    unshown_n_s: f64,
    path: Path,
    cells: TileCells,
    between: Between,
    rolling: Rolling,
    tip_force: TipForce,
    pad: Pad,
    tip: Tip,
    drag: Drag,
    ac: AcCoupling,
    skin: ContactSkin,
    exciters: Exciters,
    fades: Fades,
}

impl Voice {
    /// A voice that nobody uses; `slot` is its place in the renderer. Allocates.
    pub(crate) fn free(slot: usize, shared: &Shared) -> Self {
        Self::idle(slot, shared, shared.sample_rate_hz)
    }

    /// Stands for one that another thread renders; never rendered itself. Allocates.
    pub(crate) fn placeholder(shared: &Shared) -> Self {
        Self::idle(0, shared, 0.0)
    }

    fn idle(slot: usize, shared: &Shared, sample_rate_hz: f64) -> Self {
        Self {
            contact: ContactId(0),
            surface: 0,
            role: Binding::default(),
            phase: VoiceState::Free,
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
            tip_force: TipForce::default(),
            pad: Pad::idle(&shared.own_probe),
            tip: Tip::idle(&shared.own_probe),
            drag: Drag::idle(sample_rate_hz),
            ac: AcCoupling::idle(&shared.idle_output),
            skin: ContactSkin::default(),
            exciters: Exciters::idle(sample_rate_hz),
            fades: Fades::idle(sample_rate_hz),
        }
    }

    /// A report states what carries its tip, or that it is pressed, and whether it rolls.
    pub(crate) fn carry(&mut self, sample: &ContactSample) {
        self.tip_force.carry(sample);
        self.rolling.report(sample);
    }

    /// Tests whether there is anything to render but rest.
    pub(crate) fn works(&self) -> bool {
        self.phase != VoiceState::Free && !self.asleep
    }

    /// Something changed under a resting contact.
    pub(crate) fn wake(&mut self) {
        self.asleep = false;
    }

    /// Priority: what presses harder and moves faster is heard and felt more.
    pub(crate) fn priority(&self) -> f64 {
        let [u, v] = self.path.last.velocity_m_s;
        let speed_m_s = (u * u + v * v).sqrt();
        match self.phase {
            VoiceState::Free | VoiceState::Fading { .. } => -1.0,
            VoiceState::Sounding => self.role.importance * self.path.last.normal_force_n * (1e-3 + speed_m_s),
        }
    }

    /// Renders a stretch into `scratch.out`; returns what presses on the touched body, at the steps
    /// of the absolute grid.
    pub(crate) fn render(
        &mut self,
        stretch: Segment<'_>,
        seat: &mut Seat,
        scratch: &mut Scratch,
        tap: &mut dyn Tap,
    ) -> Option<Probe> {
        let pressing = self.pressing_at(stretch, seat);
        let now = self.until_silent(stretch);
        scratch.out.begin(now.n..stretch.n);
        self.touch(now, seat);
        if self.asleep {
            self.rest(now.n, scratch);
        } else if seat.current().is_some() {
            self.take_slow_step(now, seat, scratch);
            self.follow_path(now, seat, scratch);
            self.sample_profile(now, tap.is_watching(), seat, scratch);
            self.run_pad(now, scratch);
            self.couple(now, seat, scratch);
            self.excite(now, seat, scratch);
        }
        self.phase = self.fades.run(self.phase, self.role.gain, now.shared, now.n, &mut scratch.out);
        if let Some(level) = seat.current().and_then(|slot| slot.levels.of(self.role.probe)) {
            scratch.out.level(now.n, level.factors(self.role.actuator));
        }
        self.show(now, seat, scratch, tap);
        self.finish(now, scratch);
        pressing
    }

    /// The part of a stretch before a fade ends: nothing is computed, counted or shown after it.
    fn until_silent<'a>(&self, stretch: Segment<'a>) -> Segment<'a> {
        match self.phase {
            VoiceState::Fading { left } => Segment { n: stretch.n.min(left as usize), ..stretch },
            VoiceState::Free | VoiceState::Sounding => stretch,
        }
    }

    /// Touches the surface at the steps of the absolute grid, before its heights are sampled. A
    /// sleeping contact still touches, and wakes when the ground stirs.
    fn touch(&mut self, stretch: Segment<'_>, seat: &mut Seat) {
        if stretch.is_on_grid() {
            self.reaction = seat.touch(&self.touch_at(stretch.position));
            self.asleep &= !self.reaction.wakes_contact;
        }
    }

    /// Updates what is slow, at the steps of the absolute grid; most short stretches have none.
    #[inline(never)]
    fn take_slow_step(&mut self, stretch: Segment<'_>, seat: &mut Seat, scratch: &mut Scratch) {
        let Segment { shared, output, position, .. } = stretch;
        if !position.is_multiple_of(shared.slow_step) {
            return;
        }
        let PathPoint { velocity_m_s, normal_force_n, .. } = self.path.last;
        let room = &mut scratch.profile.rough;
        self.exciters.press(self.loudness(shared, position, seat, room), velocity_m_s);
        if self.rolling.rolls() {
            self.roll(shared, seat, room, Rolling::turn);
        }
        let Some(slot) = seat.current() else { return };
        let probe = shared.probe(self.role.probe);
        self.pad.stiffen(probe, slot.stroking.ground, normal_force_n);
        if output.quantity() == Quantity::Tangential {
            self.drag.press(normal_force_n);
        } else {
            self.skin.soften(probe, output, &self.path.last, shared.sample_rate_hz);
        }
        self.sample_between(shared, seat);
        if let Some(tip) = &probe.tip {
            let leaves = self.path.is_in_body() || self.rolling.rolls();
            self.tip.take_slow_step(shared, seat, tip, &self.path.last, leaves);
        }
    }

    /// Path: reports become a point every sample.
    fn follow_path(&mut self, stretch: Segment<'_>, seat: &Seat, scratch: &mut Scratch) {
        let Some(slot) = seat.current() else { return };
        let Scratch { points, profile, .. } = scratch;
        self.path.run(slot, &mut points[..stretch.n], &mut profile.at_m);
    }

    /// Profile: the height under each point, micro-relief included, as what rolls rides it.
    fn sample_profile(
        &mut self,
        stretch: Segment<'_>,
        is_watched: bool,
        seat: &mut Seat,
        scratch: &mut Scratch,
    ) {
        let Segment { shared, output, position, n } = stretch;
        let Scratch { points, profile, .. } = scratch;
        let slopes = is_watched || output.quantity() == Quantity::Tangential;
        let from_m = self.path.last.position_m;
        let between = self.between.on_the_way(from_m);
        let tip = shared.probe(self.role.probe).tip.as_deref();
        let tip = tip.map(|tip| (tip.tip_radius_m(), self.tip.between.on_the_way(from_m)));
        let along = Along { between, tip, ..self.along(shared, position, seat, slopes) };
        profile.run(seat, along, &points[..n], &mut self.cells);
        let tip_height_m = tip.map(|_| &mut profile.tip.height_m);
        self.rolling.run((position, shared.slow_step), (&mut profile.surface, tip_height_m), n, slopes);
    }

    /// Pad: heights and forces become rows; the tip of a tool has rows of its own.
    fn run_pad(&mut self, Segment { shared, n, .. }: Segment<'_>, scratch: &mut Scratch) {
        let Scratch { profile, quartic_correction, rows, tip_rows, out, .. } = scratch;
        let probe = shared.probe(self.role.probe);
        let ground = self.between.ground(shared, &profile.short, n, quartic_correction);
        let (heights_m, rows) = (&profile.surface.height_m[..n], &mut rows[..n]);
        self.pad.run(heights_m, &profile.force_n[..n], ground, rows);
        if let Some(roughness) = profile.surface.roughness[..n].last() {
            self.between.roughness = *roughness;
        }
        self.pad.settle(probe.waits, rows, &mut out.counts);
        if let Some(tip) = &probe.tip {
            let (forces_n, rows) = (&profile.force_n[..n], &mut tip_rows[..n]);
            self.tip.run((shared, tip), &profile.tip, forces_n, quartic_correction, rows, &mut out.counts);
        }
    }

    /// Coupling: the pad's motion becomes what is felt, the contact force what is heard.
    fn couple(&mut self, stretch: Segment<'_>, seat: &Seat, scratch: &mut Scratch) {
        let Segment { shared, output, position, n } = stretch;
        let Some(slot) = seat.current() else { return };
        let Scratch { points, rows, tip_rows, profile, force_n_s, out, .. } = scratch;
        let has_tip = self.has_tip(shared);
        // The force of a tip holds its collisions.
        let excitation = &slot.surface.excitation;
        let sounds = excitation.has(Exciter::Force) || has_tip && excitation.has(Exciter::Collisions);
        let step_s = if sounds { 1.0 / shared.sample_rate_hz } else { 0.0 };
        let dragged = output.quantity() == Quantity::Tangential;
        let (mut felt, rows) = (&rows[..n], if has_tip { &tip_rows[..n] } else { &rows[..n] });
        if dragged {
            let (skin, from_m) = self.drag.run(&points[..n], &profile.surface, felt);
            // A skin that has been dragged for long begins as if it had been there for ever.
            if let Some(from_m) = from_m {
                self.ac.feel = ContactOutputState::begin(output, from_m, 0.0);
            }
            felt = skin;
        }
        let impulse_n_s = &mut force_n_s[FORCE_HISTORY..][..n];
        let force_filter = (&slot.stroking.force_high_pass, step_s);
        self.ac.run(output, force_filter, (felt, rows), &mut out.haptic[..n], impulse_n_s);
        if !dragged {
            self.skin.pass(position, shared.slow_step, &mut out.haptic[..n]);
        }
    }

    /// Exciters: rows, coupled force and the ground's grains become impulses on the body, friction
    /// what rubs it.
    fn excite(&mut self, stretch: Segment<'_>, seat: &Seat, scratch: &mut Scratch) {
        let Segment { shared, position, n, .. } = stretch;
        let Some(slot) = seat.current() else { return };
        let Scratch { points, rows, tip_rows, force_n_s, out, .. } = scratch;
        let (points, rows) = (&points[..n], &rows[..n]);
        let (slow_step, sample_rate_hz) = (shared.slow_step, shared.sample_rate_hz);
        let (probe, reaction) = (shared.probe(self.role.probe), self.reaction);
        let by = Excited { slot, probe, reaction, sample_rate_hz, slow_step, position };
        let sounding = if probe.tip.is_some() { &tip_rows[..n] } else { rows };
        self.exciters.run(&by, sounding, force_n_s, out);
        self.rolling.soften(position, slow_step, &mut out.impulse_n_s[..n]);
        self.exciters.rub(slot, points, rows, &mut out.rub);
        if out.rub.rubs {
            self.rolling.slow_down(position, slow_step, &mut out.rub.sweep_m_s[..n]);
        }
    }

    /// State in which the stretch leaves the contact.
    fn finish(&mut self, stretch: Segment<'_>, scratch: &Scratch) {
        if self.phase == VoiceState::Free {
            return;
        }
        self.path.last = scratch.points[stretch.n - 1];
        if (stretch.position + stretch.n as u64).is_multiple_of(MAX_BLOCK as u64) {
            self.fall_asleep_when_still(stretch, scratch);
        }
    }
}
