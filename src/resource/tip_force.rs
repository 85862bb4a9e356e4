//! Force on the tip of one contact: contact, friction, and what the surface answers beside them.

use crate::model::event::ContactSample;
use asperity_dsp::micro_contact::ContactSample as PadSample;
use asperity_dsp::trajectory::PathPoint;
use asperity_surface::force_output::{ForceAt, capped};
use asperity_surface::height_field::SurfaceBlock;

/// Below this speed friction no longer jumps, m/s.
const STICK_M_S: f64 = 1e-3;

/// Force on the tip of one contact.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TipForce {
    /// Force that carries it, if it stands at a depth, N.
    carried_n: Option<f64>,
    /// Coming down through the air.
    falls: bool,
    /// Ground under the last sample.
    pub(crate) ground: Ground,
}

/// Force of the ground under a sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ground {
    gradient: [f64; 2],
    friction: f64,
    pub(crate) answer: ForceAt,
}

impl Ground {
    pub(crate) fn at(surface: &SurfaceBlock, i: usize) -> Self {
        Self { gradient: surface.gradient[i], friction: surface.friction[i], answer: surface.answer.at(i) }
    }
}

impl Default for Ground {
    fn default() -> Self {
        Self { gradient: [0.0; 2], friction: 0.0, answer: ForceAt::NONE }
    }
}

impl TipForce {
    /// Lands, or appears.
    pub(crate) fn begin(sample: &ContactSample) -> Self {
        let mut tip = Self { falls: sample.closing_m_s > 0.0, ..Self::default() };
        tip.carry(sample);
        tip
    }

    /// Takes from a report what carries it, or that it is pressed.
    pub(crate) fn carry(&mut self, sample: &ContactSample) {
        self.carried_n = sample.depth_m.map(|_| sample.normal_force_n);
    }

    /// The force on it along u, v and out of the surface, N; nothing before it touches.
    pub(crate) fn force_n(&mut self, point: &PathPoint, row: &PadSample, ground: &Ground) -> [f64; 3] {
        self.falls &= row.contact_force_n == 0.0;
        let pressed_n = self.carried_n.unwrap_or(row.contact_force_n);
        if self.falls || self.carried_n == Some(0.0) {
            return [0.0; 3];
        }
        let ForceAt { force_n, push_per_n, cap_n } = ground.answer;
        let velocity = point.velocity_m_s;
        // Below 1 mm/s friction grows linearly, so that a resting finger does not chatter.
        let slide = ground.friction / libm::hypot(velocity[0], velocity[1]).max(STICK_M_S);
        let along =
            |a: usize| force_n[a] + pressed_n * (push_per_n[a] - ground.gradient[a] - slide * velocity[a]);
        capped([along(0), along(1), force_n[2] + pressed_n], cap_n)
    }
}
