//! The tap of a contact: rows of the trace and the 3-D force.

use super::PadSample;
use super::profile::Profile;
use super::role::Role;
use super::shared::Stretch;
use super::tip::{Ground, Tip};
use crate::link::tap::{ContactBlock, Tap};
use crate::model::event::{Actuator, ContactId};
use asperity_dsp::trajectory::PathPoint;
use asperity_texture::height_field::MAX_BLOCK;

/// The rows that a tap is shown.
pub(super) struct Shown {
    position_m: [[f64; 2]; MAX_BLOCK],
    velocity_m_s: [[f64; 2]; MAX_BLOCK],
    uv: [[f64; 2]; MAX_BLOCK],
    rows: [PadSample; MAX_BLOCK],
    impulse_n_s: [f64; MAX_BLOCK],
    force_n: [[f64; 3]; MAX_BLOCK],
    cap_n: [f64; MAX_BLOCK],
}

/// Results of one contact in a stretch.
pub(super) struct Done<'a> {
    pub(super) contact: ContactId,
    pub(super) role: &'a Role,
    /// Beginning, absolute sample.
    pub(super) begun: u64,
    /// Place before the stretch.
    pub(super) last_point: PathPoint,
    /// Size of the surface, m.
    pub(super) size_m: [f64; 2],
    /// It rests: the profile is none of its own.
    pub(super) asleep: bool,
    pub(super) points: &'a [PathPoint],
    pub(super) profile: &'a Profile,
    pub(super) rows: &'a [PadSample],
    pub(super) impulse_n_s: &'a [f64],
}

impl Shown {
    pub(super) fn new() -> Self {
        Self {
            position_m: [[0.0; 2]; MAX_BLOCK],
            velocity_m_s: [[0.0; 2]; MAX_BLOCK],
            uv: [[0.0; 2]; MAX_BLOCK],
            rows: [PadSample::default(); MAX_BLOCK],
            impulse_n_s: [0.0; MAX_BLOCK],
            force_n: [[0.0; 3]; MAX_BLOCK],
            cap_n: [0.0; MAX_BLOCK],
        }
    }

    /// Shows the stretch to the tap, a row for each sample that leaves. Rows describe the instant
    /// `latency` samples back, so the path's points are delayed by as much. `unshown_n_s` is what
    /// was sent to the body since the last row.
    pub(super) fn show<T: Tap>(
        &mut self,
        stretch: Stretch<'_>,
        done: &Done<'_>,
        tip: &mut Tip,
        unshown_n_s: &mut f64,
        tap: &mut T,
    ) {
        let Stretch { shared, position, n, .. } = stretch;
        let [width_m, height_m] = done.size_m;
        let latency = shared.row_latency;
        let (mut count, mut first_sample) = (0, 0);
        let all = tap.wants_inner_samples();
        let every = if all { 1 } else { shared.inner.every as u64 };
        for i in 0..n {
            let sample = position + i as u64;
            *unshown_n_s += done.impulse_n_s[i];
            // The first rows of a contact would describe instants before it began.
            if !(all || shared.inner.leaves(sample)) || sample < done.begun + latency as u64 {
                continue;
            }
            if count == 0 {
                first_sample = (sample - latency as u64) / every;
            }
            let point = if i >= latency { done.points[i - latency] } else { done.last_point };
            self.position_m[count] = point.position_m;
            self.velocity_m_s[count] = point.velocity_m_s;
            self.uv[count] = [point.position_m[0] / width_m, point.position_m[1] / height_m];
            self.rows[count] = done.rows[i];
            self.impulse_n_s[count] = std::mem::take(unshown_n_s);
            let before = done.asleep || i < latency;
            let ground = if before { tip.ground } else { Ground::at(&done.profile.surface, i - latency) };
            self.force_n[count] = tip.force_n(&point, &done.rows[i], &ground);
            self.cap_n[count] = ground.cap_n();
            count += 1;
        }
        if !done.asleep && n > 0 {
            tip.ground = Ground::at(&done.profile.surface, n - 1);
        }
        tap.contact(&ContactBlock {
            first_sample,
            contact: done.contact,
            actuator: done.role.actuator.map(|channel| Actuator(channel as u16)),
            position_m: &self.position_m[..count],
            uv: &self.uv[..count],
            velocity_m_s: &self.velocity_m_s[..count],
            contact_samples: &self.rows[..count],
            impulse_n_s: &self.impulse_n_s[..count],
            force_n: &self.force_n[..count],
            cap_n: &self.cap_n[..count],
        });
    }
}
