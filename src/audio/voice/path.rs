//! Path: sparse reports become a point every sample (`dsp::trajectory`).

use super::body_path::BodyPath;
use crate::model::event::ContactSample;
use crate::model::stamp::Stamp;
use crate::prepared::surface::SurfaceSlot;
use asperity_dsp::trajectory::{Moved, PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use asperity_texture::height_field::MAX_BLOCK;

/// Landings within this distance of the lift-off can be the same touch, m: the width of a fingertip
/// (chosen; a finger at 0.5 m/s moves 8 mm between two reports at 60 Hz).
const SAME_TOUCH_M: f64 = 0.01;

/// Place of a contact that is unused.
const IDLE: PathEvent =
    PathEvent { sample: 0, fraction: 0.0, position_m: [0.0; 2], velocity_m_s: None, normal_force_n: 0.0 };

/// Path of a contact.
pub(super) struct Path {
    trajectory: Trajectory,
    /// Place at the last sample that was rendered.
    pub(super) last: PathPoint,
    /// Its way through the body, where that is no plane.
    body: Option<BodyPath>,
}

impl Path {
    /// State of an unused voice.
    pub(super) fn idle(design: &TrajectoryDesign) -> Self {
        Self { trajectory: Trajectory::begin(design, &IDLE), last: PathPoint::default(), body: None }
    }

    /// Begins where a report says; the force it presses with, N.
    pub(super) fn begin(&mut self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> f64 {
        let event = path_event(sample, slot, stamp);
        self.trajectory = Trajectory::begin(&slot.trajectory, &event);
        self.body = BodyPath::begin(&slot.place_trajectory, sample, stamp);
        // The path may begin behind the event, by the filter's delay.
        let mut ahead = self.trajectory;
        ahead.advance(&slot.trajectory, std::slice::from_mut(&mut self.last));
        event.normal_force_n
    }

    /// The next points, and the places in the body where those are told.
    pub(super) fn run(
        &mut self,
        slot: &SurfaceSlot,
        points: &mut [PathPoint],
        at_m: &mut [[f64; 3]; MAX_BLOCK],
    ) {
        self.trajectory.advance(&slot.trajectory, points);
        if let Some(body) = &mut self.body {
            body.advance(&slot.place_trajectory, &mut at_m[..points.len()]);
        }
    }

    /// Tests whether places in the body are told.
    pub(super) fn is_in_body(&self) -> bool {
        self.body.is_some()
    }

    /// A report. A jump that no stroke makes changes nothing here: it returns the path that begins
    /// where the contact now is.
    pub(super) fn moved(
        &mut self,
        sample: &ContactSample,
        slot: &SurfaceSlot,
        stamp: Stamp,
    ) -> Option<Trajectory> {
        if let Some(body) = &mut self.body {
            body.moved(&slot.place_trajectory, sample, stamp);
        }
        let mut path = self.trajectory;
        match path.moved(&slot.trajectory, &path_event(sample, slot, stamp)) {
            Moved::Teleported => return Some(path),
            // An event older than the last is dropped.
            Moved::Followed | Moved::Ignored => self.trajectory = path,
        }
        None
    }

    /// Tests whether a report would be a jump.
    pub(super) fn would_jump(&self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> bool {
        let mut path = self.trajectory;
        path.moved(&slot.trajectory, &path_event(sample, slot, stamp)) == Moved::Teleported
    }

    /// Tests whether a landing is so close that it can be the same touch.
    pub(super) fn is_near(&self, sample: &ContactSample, slot: &SurfaceSlot) -> bool {
        let event = path_event(sample, slot, Stamp::default());
        let period_m = slot.period_m;
        let apart_m = (0..2).map(|axis| {
            let apart_m = event.position_m[axis] - self.last.position_m[axis];
            let turns = if period_m[axis].is_finite() { (apart_m / period_m[axis]).round() } else { 0.0 };
            apart_m - if turns == 0.0 { 0.0 } else { turns * period_m[axis] }
        });
        apart_m.map(|apart_m| apart_m * apart_m).sum::<f64>() <= SAME_TOUCH_M * SAME_TOUCH_M
    }

    /// Goes on as a path before it, as far as that has learned to know the game.
    pub(super) fn succeed(&mut self, path: &Trajectory) {
        self.trajectory.succeed(path);
    }

    /// Presses from now on as it did at its last sample.
    pub(super) fn hold_force(&mut self) {
        self.trajectory.hold_force(self.last.normal_force_n);
    }

    /// The force of the last report, N.
    pub(super) fn reported_force_n(&self) -> f64 {
        self.trajectory.reported_force_n()
    }

    /// Tests whether it has come to rest.
    pub(super) fn is_still(&self) -> bool {
        self.trajectory.is_still() && self.body.as_ref().is_none_or(BodyPath::is_still)
    }

    /// The straight line that ends where the contact is: points a step of `step_s` apart, of which
    /// the first is `steps` before it.
    pub(super) fn lay_behind(&self, steps: usize, step_s: f64, points: &mut [PathPoint]) {
        let PathPoint { position_m: end_m, velocity_m_s, normal_force_n } = self.last;
        for (i, point) in points.iter_mut().enumerate() {
            let before_s = (steps - i) as f64 * step_s;
            let position_m = [0, 1].map(|axis| end_m[axis] - velocity_m_s[axis] * before_s);
            *point = PathPoint { position_m, velocity_m_s, normal_force_n };
        }
    }
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
