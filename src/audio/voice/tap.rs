//! Tap: rows of the trace, with the 3-D force on the tip.

use super::Voice;
use super::block::Scratch;
use crate::audio::seat::Seat;
use crate::audio::shared::Segment;
use crate::link::tap::Tap;
use crate::model::event::ChannelId;
use crate::resource::tip_force::Ground;

impl Voice {
    /// Shows the stretch to a tap that watches, a row for each sample that leaves; a contact that
    /// has jumped is shown where it is, and not where it fades. Rows describe the instant
    /// `row_latency` samples back, so the path's points are delayed by as much.
    pub(super) fn show(
        &mut self,
        stretch: Segment<'_>,
        seat: &Seat,
        scratch: &mut Scratch,
        tap: &mut dyn Tap,
    ) {
        let Some(slot) = seat.current().filter(|_| tap.is_watching() && !self.left_behind) else { return };
        let Segment { shared, position, n, .. } = stretch;
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
            let ground =
                if before { self.tip_force.ground } else { Ground::at(&profile.surface, i - latency) };
            shown.position_m[count] = point.position_m;
            shown.velocity_m_s[count] = point.velocity_m_s;
            shown.uv[count] = [u_m / slot.surface.width_m, v_m / slot.surface.height_m];
            shown.contact_samples[count] = rows[i];
            shown.impulse_n_s[count] = std::mem::take(&mut self.unshown_n_s);
            shown.force_n[count] = self.tip_force.force_n(&point, &rows[i], &ground);
            shown.cap_n[count] = ground.answer.cap_n;
            count += 1;
        }
        if !self.asleep && n > 0 {
            self.tip_force.ground = Ground::at(&profile.surface, n - 1);
        }
        let actuator = self.role.actuator.map(|channel| ChannelId(channel as u16));
        tap.contact(&shown.block(self.contact, actuator, first_sample, count));
    }
}
