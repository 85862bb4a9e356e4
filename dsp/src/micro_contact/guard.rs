//! Input guard of the contact model: bad numbers are held out, and a lost contact is brought back.
//!
//! | seen | done | counted |
//! |---|---|---|
//! | height or force not finite or beyond the [`limits`](crate::limits) | the last good one is held | yes |
//! | a bend not finite or beyond the limits of a height, or missing | no bend | no |
//! | force below zero | zero: a surface does not pull | no |
//! | gap above the leash | velocities become at most that of the rising ground, zero on any other | no |
//! | gap beyond 0.1 m, penetration beyond 20 mm and twice what the force presses in | the contact rests on the surface again | yes |
//! | magnitudes below 1e-100 | zero, so that no denormal ever slows a kernel | no |

use super::quartic_correction::{QuarticCorrection, SubSampleProfile, are_valid};
use super::{ContactState, MicroContact};
pub(super) use crate::limits::{MAX_HEIGHT_M, MAX_NORMAL_FORCE_N as MAX_FORCE_N};

/// Rows between two looks at vanishing magnitudes, on the contact's own clock.
pub(super) const GRID: usize = 64;
/// Gap beyond which the contact has lost its surface, m.
pub(super) const MAX_GAP_M: f64 = 0.1;
/// Penetration beyond which the surface has swallowed the contact, m, on top of
/// [`PRESSED_OVERSHOOT`] times what the pressing force explains.
pub(super) const MAX_PENETRATION_M: f64 = 0.02;
/// A force that sets in at once presses a spring in to twice its static depth.
const PRESSED_OVERSHOOT: f64 = 2.0;
/// Time constant of the mean over the ground's rise, s (chosen: many ridges of a relief, so that
/// its own flanks are no ramp).
const RISE_S: f64 = 0.2;
/// Magnitudes below this are zero.
pub(super) const VANISHING: f64 = 1e-100;

/// Inputs of up to [`GRID`] rows that a kernel can trust.
pub(super) struct CleanBlock {
    pub height_m: [f64; GRID],
    pub force_n: [f64; GRID],
}

impl CleanBlock {
    pub const EMPTY: Self = Self { height_m: [0.0; GRID], force_n: [0.0; GRID] };

    /// Copies and repairs; at most [`GRID`] values.
    #[inline(always)]
    pub fn fill(&mut self, state: &mut ContactState, height_m: &[f64], force_n: &[f64]) {
        let mut good = true;
        let inputs = height_m.iter().zip(force_n);
        for ((h, f), (&height, &force)) in self.height_m.iter_mut().zip(&mut self.force_n).zip(inputs) {
            good &= is_height(height) & is_force(force);
            (*h, *f) = flush_denormals(height, force);
        }
        if !good {
            self.repair(state, height_m, force_n);
        }
    }

    #[cold]
    #[inline(never)]
    fn repair(&mut self, state: &mut ContactState, height_m: &[f64], force_n: &[f64]) {
        let (mut last_height, mut last_force) = (state.heights_m[2], state.forces_n[1]);
        let inputs = height_m.iter().zip(force_n);
        for ((h, f), (&height, &force)) in self.height_m.iter_mut().zip(&mut self.force_n).zip(inputs) {
            if !(is_height(height) && is_force(force)) {
                state.resets = state.resets.saturating_add(1);
            }
            if !is_height(height) {
                *h = last_height;
            }
            if !is_force(force) {
                *f = last_force;
            }
            (last_height, last_force) = (*h, *f);
        }
    }
}

/// Height and force without denormals, force without its negative part.
#[inline(always)]
pub(super) fn flush_denormals(height_m: f64, force_n: f64) -> (f64, f64) {
    let force_n = if force_n > 0.0 { force_n } else { 0.0 };
    ((height_m + VANISHING) - VANISHING, (force_n + VANISHING) - VANISHING)
}

#[inline(always)]
pub(super) fn is_height(height_m: f64) -> bool {
    height_m.abs() <= MAX_HEIGHT_M
}

#[inline(always)]
pub(super) fn is_force(force_n: f64) -> bool {
    force_n.abs() <= MAX_FORCE_N
}

/// Corrections of up to [`GRID`] rows that a kernel can trust: what cannot be one is none.
pub(super) struct CleanGround {
    halves: [[QuarticCorrection; 2]; GRID],
    quartic_correction: [QuarticCorrection; GRID],
}

impl CleanGround {
    #[cold]
    #[inline(never)]
    pub fn of(ground: SubSampleProfile<'_>) -> Self {
        let mut clean = Self { halves: [[[0.0; 4]; 2]; GRID], quartic_correction: [[0.0; 4]; GRID] };
        match ground {
            SubSampleProfile::AtSamples => {}
            SubSampleProfile::Midway(quartic_correction) => clean
                .quartic_correction
                .iter_mut()
                .zip(quartic_correction)
                .for_each(|(to, from)| *to = is_valid(from)),
            SubSampleProfile::Quarters(halves) => {
                let each = clean.halves.as_flattened_mut().iter_mut().zip(halves.as_flattened());
                each.for_each(|(to, from)| *to = is_valid(from));
            }
        }
        clean
    }

    /// The first so many of them, as many as `ground` holds.
    pub fn ground(&self, ground: SubSampleProfile<'_>, count: usize) -> SubSampleProfile<'_> {
        match ground {
            SubSampleProfile::AtSamples => SubSampleProfile::AtSamples,
            SubSampleProfile::Midway(_) => SubSampleProfile::Midway(&self.quartic_correction[..count]),
            SubSampleProfile::Quarters(_) => SubSampleProfile::Quarters(&self.halves[..count]),
        }
    }
}

fn is_valid(bend: &QuarticCorrection) -> QuarticCorrection {
    if are_valid(&[*bend]) { *bend } else { [0.0; 4] }
}

/// A height or force that a contact can start from.
pub(super) fn start_or_zero(value: f64, good: bool, resets: &mut u32) -> f64 {
    if good {
        return value;
    }
    *resets += 1;
    0.0
}

/// Called when the gap is outside −[`MAX_PENETRATION_M`] … leash: pulls the leash, leaves alone
/// what the pressing force explains, or puts a lost contact back at rest on the surface. Returns
/// whether it was lost.
#[cold]
#[inline(never)]
pub(super) fn rescue(
    design: &MicroContact,
    y: &mut [f64; 4],
    gap_m: f64,
    force_n: f64,
    rise_m_s: f64,
) -> bool {
    let pressed_m = PRESSED_OVERSHOOT * force_n / design.probe.contact_stiffness_n_m;
    if !(gap_m <= MAX_GAP_M && gap_m >= -MAX_PENETRATION_M - pressed_m) {
        *y = design.resting(force_n);
        return true;
    }
    if gap_m > design.leash_m {
        y[2] = y[2].min(rise_m_s);
        y[3] = y[3].min(rise_m_s);
    }
    false
}

/// Zero in place of what has decayed beyond any meaning.
#[inline(always)]
pub(super) fn flushed(x: f64) -> f64 {
    if x.abs() < VANISHING { 0.0 } else { x }
}

/// Flushes a contact's state and follows the rise of its ground; called once a grid step.
#[inline(always)]
pub(super) fn end_of_grid(state: &mut ContactState, step_s: f64) {
    state.y = state.y.map(flushed);
    let grid_s = GRID as f64 * step_s;
    let height_m = state.heights_m[2];
    let rise_m_s = (height_m - state.grid_height_m) / grid_s;
    state.rise_m_s += (rise_m_s - state.rise_m_s) * (grid_s / RISE_S).min(1.0);
    state.grid_height_m = height_m;
}
