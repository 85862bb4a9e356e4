//! Contact events at a voice: it lands, appears, goes on.

use super::{PadSample, Phase, Scratch, Shared, Voice};
use crate::audio::seat::Seat;
use crate::model::event::{ContactId, ContactSample};
use crate::model::stamp::Stamp;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::actuator::{ContactOutput, ContactOutputState};
use asperity_dsp::butterworth;
use asperity_dsp::hertz::{FORCE_HISTORY, OnsetMerge};
use asperity_dsp::rng::Rng;
use asperity_dsp::trajectory::{Moved, PathEvent, PathPoint, Trajectory};
use asperity_texture::height_field::{MAX_BLOCK, Reaction};

/// Landings within this distance of the lift-off can be the same touch, m: the width of a fingertip
/// (chosen; a finger at 0.5 m/s moves 8 mm between two reports at 60 Hz).
const SAME_TOUCH_M: f64 = 0.01;

/// A force that is no touch, N: the weight of a tenth of a milligram.
pub(crate) const EMPTY_FORCE_N: f64 = 1e-6;

/// A contact force so many times what presses is a blow: no contact begins in the middle of one.
const LEAD_IN_BLOW: f64 = 10.0;

/// How far back a contact that appears is taken to have slid, s: what a 10 Hz high-pass remembers.
const TREND_S: f64 = 0.025;

impl Voice {
    /// Lands on a surface: at rest on it when the closing speed is zero, otherwise with that speed.
    #[expect(clippy::too_many_arguments, reason = "what is borrowed apart cannot be handed over together")]
    pub(crate) fn begin(
        &mut self,
        contact: ContactId,
        sample: &ContactSample,
        seat: &mut Seat,
        output: &ContactOutput,
        shared: &Shared,
        stamp: Stamp,
        scratch: &mut Scratch,
    ) {
        let Some(slot) = seat.current() else { return };
        let event = path_event(sample, slot, stamp);
        let position = stamp.sample();
        self.contact = contact;
        self.phase = Phase::Sounding;
        (self.begun, self.refreshed) = (position, position);
        self.asleep = false;
        self.ended = false;
        self.left_behind = false;
        self.empty_reports = 0;
        self.rising = None;
        self.role_gain.set(self.role.gain);
        self.landing_m_s = sample.closing_m_s;
        self.fade_in_left = if sample.closing_m_s > 0.0 { 0 } else { shared.fade_samples() };
        self.trajectory = Trajectory::begin(&slot.trajectory, &event);
        // The path may begin behind the event, by the filter's delay.
        let mut path = self.trajectory;
        path.advance(&slot.trajectory, &mut scratch.points[..1]);
        self.last_point = scratch.points[0];
        seat.land(&self.touch_at(position));
        let force_n = event.normal_force_n;
        let lands = sample.closing_m_s > 0.0;
        self.begin_pressed(seat, shared, position, force_n);
        self.skin = None;
        self.soften(shared, output);
        if lands {
            self.profile(seat, shared, position, 1, false, scratch);
            let height_m = scratch.surface.height_m[0];
            // It touches at the stamp; without delay it would one sample before the voice's first.
            let later = 1.0 + stamp.fraction();
            self.pad = self.contact_model.landing_later(height_m, force_n, sample.closing_m_s, later);
            let pad_velocity_m_s = -sample.closing_m_s;
            self.late_row = PadSample { height_m, pad_m: height_m, pad_velocity_m_s, ..PadSample::default() };
            self.feel = ContactOutputState::begin(output, height_m, -sample.closing_m_s);
        } else {
            self.lead_in(seat, output, shared, position, scratch);
        }
        self.resets_told = self.pad.resets();
        // The high-pass starts settled, so that beginning gives no step.
        let pressed_n = if lands { 0.0 } else { force_n };
        self.force_high_pass = butterworth::State::settled_at(pressed_n);
        self.merge = OnsetMerge::default();
        self.reaction = Reaction::default();
        self.grains = Rng::new(contact.0 ^ position.rotate_left(32));
        self.force_history_n_s = [0.0; FORCE_HISTORY];
        if !self.bus.is_empty(position) {
            self.bus.clear();
        }
        self.unshown_n_s = 0.0;
    }

    /// A finger that is suddenly there has been sliding already: the pad is led along the straight line
    /// to where it appears, so that it moves with the surface from its first sample.
    fn lead_in(
        &mut self,
        seat: &mut Seat,
        output: &ContactOutput,
        shared: &Shared,
        position: u64,
        scratch: &mut Scratch,
    ) {
        let [slope_m_s, bend_m_s2] = self.trend(seat, shared, position, scratch);
        self.lay_behind(1, shared, scratch);
        self.profile(seat, shared, position, MAX_BLOCK, false, scratch);
        let (heights_m, forces_n) = (&scratch.surface.height_m, &scratch.force_n);
        // Finger and pad rise as the ground does on the whole: set off from rest they would still swing when they are heard.
        let rise_m_s =
            (heights_m[MAX_BLOCK - 1] - heights_m[0]) * shared.sample_rate_hz / (MAX_BLOCK - 1) as f64;
        let micro_contact = &self.contact_model;
        self.pad = micro_contact.riding(heights_m[0], forces_n[0], rise_m_s);
        micro_contact.run(&mut self.pad, heights_m, forces_n, &mut scratch.pad);
        self.late_row = PadSample { onset: None, ..scratch.pad[MAX_BLOCK - 1] };
        let PadSample { pad_m, pad_velocity_m_s, contact_force_n, .. } = self.late_row;
        let [height_m, force_n] = [heights_m, forces_n].map(|of| of[MAX_BLOCK - 1]);
        if self.pad.resets() > 0 || contact_force_n > LEAD_IN_BLOW * force_n {
            // What never was there cannot have thrown it.
            let rise_m_s = (height_m - heights_m[MAX_BLOCK - 2]) * shared.sample_rate_hz;
            self.pad = micro_contact.riding(height_m, force_n, rise_m_s);
        }
        self.feel = ContactOutputState::begin_sliding(output, pad_m, pad_velocity_m_s, slope_m_s, bend_m_s2);
    }

    /// The straight line that ends where the contact is, a point every `stride` samples.
    fn lay_behind(&self, stride: usize, shared: &Shared, scratch: &mut Scratch) {
        let PathPoint { position_m: end_m, velocity_m_s, normal_force_n } = self.last_point;
        for (i, point) in scratch.points.iter_mut().enumerate() {
            let before_s = ((MAX_BLOCK - i) * stride) as f64 / shared.sample_rate_hz;
            let position_m = [0, 1].map(|axis| end_m[axis] - velocity_m_s[axis] * before_s);
            *point = PathPoint { position_m, velocity_m_s, normal_force_n };
        }
    }

    /// How the profile has risen, m/s, and bent, m/s², during the last [`TREND_S`]: the parabola nearest to it.
    fn trend(&self, seat: &mut Seat, shared: &Shared, position: u64, scratch: &mut Scratch) -> [f64; 2] {
        let stride = ((TREND_S * shared.sample_rate_hz) as usize / MAX_BLOCK).max(1);
        self.lay_behind(stride, shared, scratch);
        self.profile(seat, shared, position, MAX_BLOCK, false, scratch);
        let step_s = stride as f64 / shared.sample_rate_hz;
        let [slope, bend] = parabola(&scratch.surface.height_m);
        // The slope is that of the middle; the contact is half a trend later.
        let bend_m_s2 = bend / (step_s * step_s);
        [slope / step_s + bend_m_s2 * 0.5 * step_s * MAX_BLOCK as f64, bend_m_s2]
    }

    /// Goes on somewhere else; wakes a resting contact. A jump that no stroke makes changes nothing here: it
    /// returns the path that begins where the contact now is, for another voice.
    ///
    /// `stamp` is when the event holds, which may lie before `position` when it arrives late:
    /// the path reckons on from the stamp, so jitter of arrival does not become jitter of motion.
    pub(crate) fn moved(
        &mut self,
        sample: &ContactSample,
        slot: &SurfaceSlot,
        stamp: Stamp,
        position: u64,
    ) -> Option<Trajectory> {
        self.refreshed = position;
        self.asleep = false;
        let mut path = self.trajectory;
        match path.moved(&slot.trajectory, &path_event(sample, slot, stamp)) {
            Moved::Teleported => return Some(path),
            // An event older than the last is dropped.
            Moved::Followed | Moved::Ignored => self.trajectory = path,
        }
        None
    }

    /// Whether a report would be a jump.
    pub(crate) fn would_jump(&self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> bool {
        let mut path = self.trajectory;
        path.moved(&slot.trajectory, &path_event(sample, slot, stamp)) == Moved::Teleported
    }

    /// Fades because its contact goes on in another voice.
    pub(crate) fn leave(&mut self, shared: &Shared) {
        self.fade(shared);
        self.left_behind = true;
    }

    /// Goes on as a path before it, as far as that has learned to know the game.
    pub(crate) fn succeed(&mut self, path: &Trajectory) {
        self.trajectory.succeed(path);
    }

    /// The force to render for a report, or none if the contact has left the surface. Solvers report a step
    /// without force now and then, and some every other step, from a finger that never left: one such report
    /// holds the force before it, because a finger thrown off for a sixtieth of a second is felt as a blow.
    pub(crate) fn pressed_n(&mut self, reported_n: f64) -> Option<f64> {
        if reported_n > EMPTY_FORCE_N {
            self.empty_reports = 0;
            return Some(reported_n);
        }
        self.empty_reports = self.empty_reports.saturating_add(1);
        (self.empty_reports == 1).then(|| self.trajectory.reported_force_n())
    }

    /// Whether a landing is so close that it can be the same touch.
    pub(crate) fn is_near(&self, sample: &ContactSample, slot: &SurfaceSlot) -> bool {
        let event = path_event(sample, slot, Stamp::default());
        let period_m = slot.period_m;
        let apart_m = (0..2).map(|axis| {
            let apart_m = event.position_m[axis] - self.last_point.position_m[axis];
            let turns = if period_m[axis].is_finite() { (apart_m / period_m[axis]).round() } else { 0.0 };
            apart_m - if turns == 0.0 { 0.0 } else { turns * period_m[axis] }
        });
        apart_m.map(|apart_m| apart_m * apart_m).sum::<f64>() <= SAME_TOUCH_M * SAME_TOUCH_M
    }
}

/// Slope a step in the middle, and bend, of the parabola that fits best.
fn parabola(values: &[f64; MAX_BLOCK]) -> [f64; 2] {
    let n = MAX_BLOCK as f64;
    let mean_square = (n * n - 1.0) / 12.0;
    let (mut slope, mut bend, mut squares, mut fourths) = (0.0, 0.0, 0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let x = i as f64 - 0.5 * (n - 1.0);
        let q = x * x - mean_square;
        slope += x * value;
        bend += q * value;
        squares += x * x;
        fourths += q * q;
    }
    [slope / squares, 2.0 * bend / fourths]
}

fn path_event(sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> PathEvent {
    PathEvent {
        sample: stamp.sample(),
        fraction: stamp.fraction(),
        position_m: [sample.uv[0] * slot.surface.width_m, sample.uv[1] * slot.surface.height_m],
        velocity_m_s: sample.velocity_m_s,
        normal_force_n: sample.normal_force_n,
    }
}
