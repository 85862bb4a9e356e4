//! Body path: the way of a contact through the space of a body that is no plane, a sphere cut from
//! a block of stone for instance.
//!
//! The three coordinates go through the same filter as the path on the surface, two by two.

use crate::model::event::ContactSample;
use crate::model::stamp::Stamp;
use asperity_dsp::trajectory::{Moved, PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use asperity_texture::height_field::MAX_BLOCK;

/// Place of a contact in its body.
pub(super) struct BodyPath {
    /// x with y, and z.
    parts: [Trajectory; 2],
}

impl BodyPath {
    /// The path that begins with a report, if that tells a place.
    pub(super) fn begin(design: &TrajectoryDesign, sample: &ContactSample, stamp: Stamp) -> Option<Self> {
        let events = events(sample, stamp)?;
        Some(Self { parts: events.map(|event| Trajectory::begin(design, &event)) })
    }

    /// Goes on with a report; one without a place leaves it on its way.
    pub(super) fn moved(&mut self, design: &TrajectoryDesign, sample: &ContactSample, stamp: Stamp) {
        let Some(events) = events(sample, stamp) else { return };
        for (part, event) in self.parts.iter_mut().zip(&events) {
            if part.moved(design, event) == Moved::Teleported {
                *part = Trajectory::begin(design, event);
            }
        }
    }

    /// The next places, m.
    pub(super) fn advance(&mut self, design: &TrajectoryDesign, at_m: &mut [[f64; 3]]) {
        let mut points = [[PathPoint::default(); MAX_BLOCK]; 2];
        for (part, points) in self.parts.iter_mut().zip(&mut points) {
            part.advance(design, &mut points[..at_m.len()]);
        }
        for (i, at_m) in at_m.iter_mut().enumerate() {
            let ([x, y], [z, _]) = (points[0][i].position_m, points[1][i].position_m);
            *at_m = [x, y, z];
        }
    }

    pub(super) fn is_still(&self) -> bool {
        self.parts.iter().all(Trajectory::is_still)
    }
}

fn events(sample: &ContactSample, stamp: Stamp) -> Option<[PathEvent; 2]> {
    let [x, y, z] = sample.at_m?;
    Some([[x, y], [z, 0.0]].map(|position_m| PathEvent {
        sample: stamp.sample(),
        fraction: stamp.fraction(),
        position_m,
        velocity_m_s: None,
        normal_force_n: sample.normal_force_n,
    }))
}
