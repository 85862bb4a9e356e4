//! The tap of a contact: rows of the trace and the 3-D force.

use super::{PadSample, Scratch, Shared, Voice};
use crate::audio::seat::Seat;
use crate::link::tap::{ContactBlock, Tap};
use crate::model::event::Actuator;
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::answer::AnswerAt;
use asperity_texture::height_field::SurfaceBlock;
use asperity_texture::sand::law::capped;

/// Below this speed friction no longer jumps, m/s.
const STICK_M_S: f64 = 1e-3;

/// What the ground under a sample pushes with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground {
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

impl Voice {
    /// Shows the stretch to the tap, a row for each sample that leaves. Rows describe the instant `latency` samples back, so the
    /// path's points are delayed by as much.
    pub(super) fn show<T: Tap>(
        &mut self,
        seat: &Seat,
        shared: &Shared,
        position: u64,
        n: usize,
        scratch: &mut Scratch,
        tap: &mut T,
    ) {
        // A contact that has jumped is shown where it is, and not where it fades.
        let watched = tap.is_watching() && !self.left_behind;
        let Some(slot) = seat.current().filter(|_| watched) else { return };
        let size_m = [slot.surface.width_m, slot.surface.height_m];
        let latency = shared.row_latency;
        let (mut count, mut first_sample) = (0, 0);
        for i in 0..n {
            let sample = position + i as u64;
            self.unshown_n_s += scratch.out.impulse_n_s[i];
            // The first rows of a contact would describe instants before it began.
            if !shared.inner.leaves(sample) || sample < self.begun + latency as u64 {
                continue;
            }
            if count == 0 {
                first_sample = (sample - latency as u64) / shared.inner.every as u64;
            }
            let point = if i >= latency { scratch.points[i - latency] } else { self.last_point };
            scratch.position_m[count] = point.position_m;
            scratch.velocity_m_s[count] = point.velocity_m_s;
            scratch.uv[count] = [point.position_m[0] / size_m[0], point.position_m[1] / size_m[1]];
            scratch.shown[count] = scratch.pad[i];
            scratch.shown_n_s[count] = std::mem::take(&mut self.unshown_n_s);
            let ground = if self.asleep || i < latency {
                self.last_ground
            } else {
                Ground::at(&scratch.surface, i - latency)
            };
            scratch.output_force_n[count] = self.output_force(&point, &scratch.pad[i], &ground);
            count += 1;
        }
        if !self.asleep && n > 0 {
            self.last_ground = Ground::at(&scratch.surface, n - 1);
        }
        tap.contact(&ContactBlock {
            first_sample,
            contact: self.contact,
            actuator: self.role.actuator.map(|channel| Actuator(channel as u16)),
            position_m: &scratch.position_m[..count],
            uv: &scratch.uv[..count],
            velocity_m_s: &scratch.velocity_m_s[..count],
            contact_samples: &scratch.shown[..count],
            impulse_n_s: &scratch.shown_n_s[..count],
            force_n: &scratch.output_force_n[..count],
        });
    }

    /// 3-D force on the finger: contact + friction + what the surface answers beside them, which is nothing before it touches.
    fn output_force(&mut self, point: &PathPoint, row: &PadSample, ground: &Ground) -> [f64; 3] {
        self.falls &= row.contact_force_n == 0.0;
        let pressed_n = self.carried_n.unwrap_or(row.contact_force_n);
        if self.falls || self.carried_n == Some(0.0) {
            return [0.0; 3];
        }
        let AnswerAt { force_n, push_per_n, cap_n } = ground.answer;
        let velocity = point.velocity_m_s;
        // Below 1 mm/s friction grows linearly, so that a resting finger does not chatter.
        let slide = ground.friction / velocity[0].hypot(velocity[1]).max(STICK_M_S);
        let along =
            |a: usize| force_n[a] + pressed_n * (push_per_n[a] - ground.gradient[a] - slide * velocity[a]);
        capped([along(0), along(1), force_n[2] + pressed_n], cap_n)
    }
}
