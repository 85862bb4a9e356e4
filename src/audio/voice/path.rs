//! Path: sparse reports become a point every sample (`dsp::trajectory`).
//!
//! A contact with a body that is no plane, a sphere of solid noise for instance, reports its place
//! there too; those three coordinates go through the same filter, two by two.

use crate::model::event::ContactSample;
use crate::model::stamp::Stamp;
use crate::resource::surface::SurfaceSlot;
use asperity_dsp::trajectory::{Moved, PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use asperity_surface::height_field::MAX_BLOCK;

/// Landings within this distance of the lift-off can be the same touch, m: a fingertip's width.
const SAME_TOUCH_M: f64 = 0.01;

/// Event of an unused path.
const IDLE: PathEvent =
    PathEvent { sample: 0, fraction: 0.0, position_m: [0.0; 2], velocity_m_s: None, normal_force_n: 0.0 };

/// Path of a contact.
pub(super) struct Path {
    trajectory: Trajectory,
    /// Point of the last sample.
    pub(super) last: PathPoint,
    /// Place in the body, where that is reported: x with y, and z.
    in_body: Option<[Trajectory; 2]>,
}

impl Path {
    pub(super) fn idle(design: &TrajectoryDesign) -> Self {
        Self { trajectory: Trajectory::begin(design, &IDLE), last: PathPoint::default(), in_body: None }
    }

    /// Begins with a report; returns its force, N.
    pub(super) fn begin(&mut self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> f64 {
        let event = path_event(sample, slot, stamp);
        self.trajectory = Trajectory::begin(&slot.trajectory, &event);
        let begun = |event: PathEvent| Trajectory::begin(&slot.place_trajectory, &event);
        self.in_body = body_events(sample, stamp).map(|events| events.map(begun));
        // The path may begin behind the event, by the filter's delay.
        let mut ahead = self.trajectory;
        ahead.advance(&slot.trajectory, std::slice::from_mut(&mut self.last));
        event.normal_force_n
    }

    /// The next points, and the places in the body where those are reported.
    pub(super) fn run(
        &mut self,
        slot: &SurfaceSlot,
        points: &mut [PathPoint],
        at_m: &mut [[f64; 3]; MAX_BLOCK],
    ) {
        self.trajectory.advance(&slot.trajectory, points);
        if let Some(parts) = &mut self.in_body {
            advance_in_body(parts, &slot.place_trajectory, &mut at_m[..points.len()]);
        }
    }

    /// Tests whether places in the body are reported.
    pub(super) fn is_in_body(&self) -> bool {
        self.in_body.is_some()
    }

    /// Follows a report; a jump that no stroke makes returns the path that begins there instead.
    pub(super) fn moved(
        &mut self,
        sample: &ContactSample,
        slot: &SurfaceSlot,
        stamp: Stamp,
    ) -> Option<Trajectory> {
        if let (Some(parts), Some(events)) = (&mut self.in_body, body_events(sample, stamp)) {
            for (part, event) in parts.iter_mut().zip(&events) {
                if part.moved(&slot.place_trajectory, event) == Moved::Teleported {
                    *part = Trajectory::begin(&slot.place_trajectory, event);
                }
            }
        }
        let (path, moved) = self.after(sample, slot, stamp);
        if moved == Moved::Teleported {
            return Some(path);
        }
        // An event older than the last has changed nothing.
        self.trajectory = path;
        None
    }

    fn after(&self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> (Trajectory, Moved) {
        let mut path = self.trajectory;
        let moved = path.moved(&slot.trajectory, &path_event(sample, slot, stamp));
        (path, moved)
    }

    /// Tests whether a landing is so close that it can be the same touch, and no jump.
    pub(super) fn goes_on_at(&self, sample: &ContactSample, slot: &SurfaceSlot, stamp: Stamp) -> bool {
        let (at_m, period_m) = (path_event(sample, slot, stamp).position_m, slot.period_m);
        let apart_m = [0, 1].map(|axis| {
            let apart_m = at_m[axis] - self.last.position_m[axis];
            let turns = if period_m[axis].is_finite() { (apart_m / period_m[axis]).round() } else { 0.0 };
            apart_m - if turns == 0.0 { 0.0 } else { turns * period_m[axis] }
        });
        apart_m.map(|apart_m| apart_m * apart_m).iter().sum::<f64>() <= SAME_TOUCH_M * SAME_TOUCH_M
            && self.after(sample, slot, stamp).1 != Moved::Teleported
    }

    /// Takes over the report rate of a path before it.
    pub(super) fn inherit_rate(&mut self, path: &Trajectory) {
        self.trajectory.inherit_rate(path);
    }

    /// Presses from now on as at its last sample.
    pub(super) fn hold_force(&mut self) {
        self.trajectory.hold_force(self.last.normal_force_n);
    }

    /// The force of the last report, N.
    pub(super) fn reported_force_n(&self) -> f64 {
        self.trajectory.reported_force_n()
    }

    /// Tests whether it has come to rest.
    pub(super) fn is_still(&self) -> bool {
        self.trajectory.is_still() && self.in_body.iter().flatten().all(Trajectory::is_still)
    }

    /// The straight line that ends where the contact is: points a step of `step_s` apart, of which
    /// the first is `steps` before it.
    pub(super) fn extend_back(&self, steps: usize, step_s: f64, points: &mut [PathPoint]) {
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

fn body_events(sample: &ContactSample, stamp: Stamp) -> Option<[PathEvent; 2]> {
    let [x, y, z] = sample.at_m?;
    let (at, fraction, normal_force_n) = (stamp.sample(), stamp.fraction(), sample.normal_force_n);
    let event = PathEvent { sample: at, fraction, normal_force_n, ..IDLE };
    Some([[x, y], [z, 0.0]].map(|position_m| PathEvent { position_m, ..event }))
}

/// The next places in the body, m. By itself, for the memory that it takes.
#[inline(never)]
fn advance_in_body(parts: &mut [Trajectory; 2], design: &TrajectoryDesign, at_m: &mut [[f64; 3]]) {
    let mut points = [[PathPoint::default(); MAX_BLOCK]; 2];
    for (part, points) in parts.iter_mut().zip(&mut points) {
        part.advance(design, &mut points[..at_m.len()]);
    }
    for (i, at_m) in at_m.iter_mut().enumerate() {
        let ([x, y], [z, _]) = (points[0][i].position_m, points[1][i].position_m);
        *at_m = [x, y, z];
    }
}
