//! Friction rubs the touched body: how fast and how hard, for the body's own coupled step
//! (`prepared::body_rub`).
//!
//! A contact rubs along the line on which it moves. The line turns with the motion, but not round:
//! a bow that goes back rubs along the same line with a negative speed.

use super::PadSample;
use crate::audio::voice::rub_block::RubBlock;
use asperity_dsp::trajectory::PathPoint;

/// Below this speed a motion has no direction, m/s.
const AIMLESS_M_S: f64 = 1e-3;

/// The line of one contact.
#[derive(Clone, Copy)]
pub(super) struct Rubbing {
    along: [f64; 2],
}

impl Default for Rubbing {
    fn default() -> Self {
        Self { along: RubBlock::STILL.along }
    }
}

impl Rubbing {
    /// The line turns to where it moves: called at the steps of the absolute sample grid, and when
    /// it begins.
    pub(super) fn turn(&mut self, velocity_m_s: [f64; 2]) {
        let [u, v] = velocity_m_s;
        let speed_m_s = libm::hypot(u, v);
        if speed_m_s > AIMLESS_M_S {
            let back = self.along[0] * u + self.along[1] * v < 0.0;
            let length = if back { -speed_m_s } else { speed_m_s };
            self.along = [u / length, v / length];
        }
    }

    /// Speeds along the line, and what presses.
    pub(super) fn run(&self, points: &[PathPoint], rows: &[PadSample], out: &mut RubBlock) {
        (out.rubs, out.along) = (true, self.along);
        for (i, (point, row)) in points.iter().zip(rows).enumerate() {
            let [u, v] = point.velocity_m_s;
            out.sweep_m_s[i] = u * self.along[0] + v * self.along[1];
            out.normal_force_n[i] = row.contact_force_n.max(0.0);
        }
    }
}
