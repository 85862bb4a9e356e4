//! The tap of a contact: rows of the trace and the 3-D force.

use super::{PadSample, Scratch, Shared, Voice};
use crate::audio::seat::Seat;
use crate::link::tap::{ContactBlock, Tap};
use crate::model::event::Actuator;
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::Reaction;

/// Below this speed friction no longer jumps, m/s.
const STICK_M_S: f64 = 1e-3;

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
            let (slope, friction) = (scratch.surface.gradient[i], scratch.surface.friction[i]);
            scratch.output_force_n[count] =
                output_force(&point, &scratch.pad[i], slope, friction, &self.reaction);
            count += 1;
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
}

/// 3-D force on the finger: contact + friction + texture (along the surface's slope) + what the
/// surface does by itself.
fn output_force(
    point: &PathPoint,
    row: &PadSample,
    gradient: [f64; 2],
    friction: f64,
    reaction: &Reaction,
) -> [f64; 3] {
    let [u, v] = point.velocity_m_s;
    let pressed_n = row.contact_force_n;
    // Below 1 mm/s friction grows linearly, so that a resting finger does not chatter.
    let slide = friction * pressed_n / (u * u + v * v).sqrt().max(STICK_M_S);
    let [fx, fy, fz] = reaction.force_n;
    [fx - slide * u - pressed_n * gradient[0], fy - slide * v - pressed_n * gradient[1], fz + pressed_n]
}
