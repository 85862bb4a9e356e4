//! What a tap is shown of a contact: rows of the trace and the 3-D force.

use super::{PadSample, Scratch, Shared, Voice};
use crate::seat::Seat;
use crate::tap::{ContactBlock, Tap};
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::Reaction;

/// Below this speed friction no longer jumps, m/s.
const STICK_M_S: f64 = 1e-3;

impl Voice {
    /// Shows the stretch to the tap. Rows describe the instant `latency` samples back, so the path's
    /// points are delayed by as much.
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
        let latency = shared.micro_contact.latency_samples();
        for i in 0..n {
            let point = if i >= latency { scratch.points[i - latency] } else { self.last_point };
            scratch.position_m[i] = point.position_m;
            scratch.velocity_m_s[i] = point.velocity_m_s;
            scratch.uv[i] = [point.position_m[0] / size_m[0], point.position_m[1] / size_m[1]];
            scratch.output_force_n[i] = output_force(
                &point,
                &scratch.pad[i],
                scratch.surface.gradient[i],
                scratch.surface.friction[i],
                &self.reaction,
            );
        }
        // The first rows of a contact would describe instants before it began.
        let skip = latency.saturating_sub((position - self.begun) as usize).min(n);
        tap.contact(&ContactBlock {
            first_sample: position + skip as u64 - latency as u64,
            contact: self.contact,
            position_m: &scratch.position_m[skip..n],
            uv: &scratch.uv[skip..n],
            velocity_m_s: &scratch.velocity_m_s[skip..n],
            contact_samples: &scratch.pad[skip..n],
            impulse_n_s: &scratch.out.impulse_n_s[skip..n],
            force_n: &scratch.output_force_n[skip..n],
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
