//! Tap: rows of the trace, and the 3-D force on the tip: contact, friction and what the surface
//! answers beside them.

use super::block::Scratch;
use super::{PadSample, PathPoint, Voice};
use crate::audio::seat::Seat;
use crate::audio::shared::Stretch;
use crate::link::tap::Tap;
use crate::model::event::{Actuator, ContactSample};
use asperity_texture::answer::{AnswerAt, capped};
use asperity_texture::height_field::SurfaceBlock;

/// Below this speed friction no longer jumps, m/s.
const STICK_M_S: f64 = 1e-3;

impl Voice {
    /// Shows the stretch to a tap that watches, a row for each sample that leaves; a contact that
    /// has jumped is shown where it is, and not where it fades. Rows describe the instant
    /// `row_latency` samples back, so the path's points are delayed by as much.
    pub(super) fn show<T: Tap>(
        &mut self,
        stretch: Stretch<'_>,
        seat: &Seat,
        scratch: &mut Scratch,
        tap: &mut T,
    ) {
        let Some(slot) = seat.current().filter(|_| tap.is_watching() && !self.left_behind) else { return };
        let Stretch { shared, position, n, .. } = stretch;
        let Scratch { points, rows, profile, shown, out, .. } = scratch;
        let latency = shared.row_latency;
        let (mut count, mut first_sample) = (0, 0);
        let all = tap.wants_inner_samples();
        let every = if all { 1 } else { shared.inner.every as u64 };
        for i in 0..n {
            let sample = position + i as u64;
            self.unshown_n_s += out.impulse_n_s[i];
            // The first rows of a contact would describe instants before it began.
            if !(all || shared.inner.leaves(sample)) || sample < self.begun + latency as u64 {
                continue;
            }
            if count == 0 {
                first_sample = (sample - latency as u64) / every;
            }
            let point = if i >= latency { points[i - latency] } else { self.path.last };
            let [u_m, v_m] = point.position_m;
            // The profile of a resting contact is none of its own.
            let before = self.asleep || i < latency;
            let ground = if before { self.tip.ground } else { Ground::at(&profile.surface, i - latency) };
            shown.position_m[count] = point.position_m;
            shown.velocity_m_s[count] = point.velocity_m_s;
            shown.uv[count] = [u_m / slot.surface.width_m, v_m / slot.surface.height_m];
            shown.contact_samples[count] = rows[i];
            shown.impulse_n_s[count] = std::mem::take(&mut self.unshown_n_s);
            shown.force_n[count] = self.tip.force_n(&point, &rows[i], &ground);
            shown.cap_n[count] = ground.answer.cap_n;
            count += 1;
        }
        if !self.asleep && n > 0 {
            self.tip.ground = Ground::at(&profile.surface, n - 1);
        }
        let actuator = self.role.actuator.map(|channel| Actuator(channel as u16));
        tap.contact(&shown.block(self.contact, actuator, first_sample, count));
    }
}

/// The tip of one contact.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Tip {
    /// Force that carries it, if it stands at a depth, N.
    carried_n: Option<f64>,
    /// Coming down through the air.
    falls: bool,
    /// Ground under the last sample.
    ground: Ground,
}

/// Force of the ground under a sample.
#[derive(Debug, Clone, Copy)]
struct Ground {
    gradient: [f64; 2],
    friction: f64,
    answer: AnswerAt,
}

impl Ground {
    fn at(surface: &SurfaceBlock, i: usize) -> Self {
        Self { gradient: surface.gradient[i], friction: surface.friction[i], answer: surface.answer.at(i) }
    }
}

impl Default for Ground {
    fn default() -> Self {
        Self { gradient: [0.0; 2], friction: 0.0, answer: AnswerAt::NONE }
    }
}

impl Tip {
    /// Lands, or appears.
    pub(super) fn begin(sample: &ContactSample) -> Self {
        let mut tip = Self { falls: sample.closing_m_s > 0.0, ..Self::default() };
        tip.carry(sample);
        tip
    }

    /// Takes from a report what carries it, or that it is pressed.
    pub(super) fn carry(&mut self, sample: &ContactSample) {
        self.carried_n = sample.depth_m.map(|_| sample.normal_force_n);
    }

    /// The force on it along u, v and out of the surface, N; nothing before it touches.
    fn force_n(&mut self, point: &PathPoint, row: &PadSample, ground: &Ground) -> [f64; 3] {
        self.falls &= row.contact_force_n == 0.0;
        let pressed_n = self.carried_n.unwrap_or(row.contact_force_n);
        if self.falls || self.carried_n == Some(0.0) {
            return [0.0; 3];
        }
        let AnswerAt { force_n, push_per_n, cap_n } = ground.answer;
        let velocity = point.velocity_m_s;
        // Below 1 mm/s friction grows linearly, so that a resting finger does not chatter.
        let slide = ground.friction / libm::hypot(velocity[0], velocity[1]).max(STICK_M_S);
        let along =
            |a: usize| force_n[a] + pressed_n * (push_per_n[a] - ground.gradient[a] - slide * velocity[a]);
        capped([along(0), along(1), force_n[2] + pressed_n], cap_n)
    }
}
