//! Exact free flow with a discrete-gradient contact: passive however stiff the contact.
//!
//! The contact force is constant over the step and equals the discrete gradient of the spring's
//! energy V(g) = ½ k_m max(0, g)², g = x_m − x_s:
//!
//! ```text
//! f = (V(g₁) − V(g₀)) / (g₁ − g₀),      g₁ = b − κ f
//! ```
//! where b is where the gap would end without contact and κ the exact response of the skin to a
//! force held over the step. The work of f on the masses is exactly f·Δx_s and the spring stores
//! exactly f·(Δx_m − Δx_s), so that energy changes only by what damper, finger and surface do. With
//! K = κ k_m / 2 each of the four cases has one closed-form root (no iteration):
//!
//! | g₀ | g₁ | root |
//! |---|---|---|
//! | out | out | g₁ = b |
//! | in | in | g₁ = (b − K g₀)/(1 + K) |
//! | out | in | (1 + K) g₁² − (b + g₀) g₁ + b g₀ = 0, the positive root |
//! | in | out | g₁² − (b + g₀) g₁ + b g₀ − K g₀² = 0, the negative root |
//!
//! The profile is linear over the step, the force the mean of both ends: no latency.

use super::flow::Regime;
use super::guard::{CleanBlock, MAX_PENETRATION_M, rescue};
use super::quad::F64x4;
use super::{ContactSample, ContactState, MicroContact, Onset, Probe};

/// Coefficients of the scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EnergyConserving {
    free: Regime,
    /// k_m/2, N/m.
    half_stiffness_n_m: f64,
    /// k_m/2 / (1 + K): f = this · (b + g₀) while pressed at both ends.
    pressed_stiffness_n_m: f64,
    /// K = κ k_m/2.
    ratio: f64,
    rate_hz: f64,
}

impl EnergyConserving {
    pub fn new(probe: &Probe, step_s: f64) -> Self {
        let free = Regime::new(probe, 0.0, step_s);
        let half_stiffness_n_m = 0.5 * probe.contact_stiffness_n_m;
        let ratio = free.push[0] * half_stiffness_n_m;
        let pressed_stiffness_n_m = half_stiffness_n_m / (1.0 + ratio);
        Self { free, half_stiffness_n_m, pressed_stiffness_n_m, ratio, rate_hz: 1.0 / step_s }
    }

    /// Probe on another contact.
    pub fn set_stiffness(&mut self, contact_stiffness_n_m: f64) {
        self.half_stiffness_n_m = 0.5 * contact_stiffness_n_m;
        self.ratio = self.free.push[0] * self.half_stiffness_n_m;
        self.pressed_stiffness_n_m = self.half_stiffness_n_m / (1.0 + self.ratio);
    }

    /// Runs one clean block; row n describes input n.
    #[inline(always)]
    pub fn run<Q: F64x4>(
        &self,
        quad: Q,
        design: &MicroContact,
        state: &mut ContactState,
        block: &CleanBlock,
        out: &mut [ContactSample],
    ) {
        let (mut h_old, mut f_old) = (state.heights_m[2], state.forces_n[1]);
        let mut y = quad.load(&state.y);
        let mut before = state.y[0];
        for ((out, &height_m), &force_n) in out.iter_mut().zip(&block.height_m).zip(&block.force_n) {
            let rise = height_m - h_old;
            let free = self.free.maps[0].apply_straight(y, rise, 0.5 * (f_old + force_n));
            let after = free.first();
            let contact_force_n = self.force(-before, -after);
            let onset = if before >= 0.0 && after < 0.0 { Some(self.onset(before, after)) } else { None };
            y = quad.load(&self.free.push).times_plus(quad.splat(contact_force_n), free);
            let gap_m = y.first();
            if !(gap_m <= design.leash_m && gap_m >= -MAX_PENETRATION_M) {
                let mut lost = y.array();
                if rescue(design, &mut lost, gap_m, force_n, state.rise_m_s.max(0.0)) {
                    state.resets = state.resets.saturating_add(1);
                }
                y = quad.load(&lost);
            }
            before = y.first();
            let [gap_m, stretch_m, pad_velocity_m_s, _] = y.array();
            let pad_m = height_m + gap_m;
            *out = ContactSample {
                height_m,
                normal_force_n: force_n,
                pad_m,
                pad_velocity_m_s,
                finger_m: pad_m - stretch_m,
                contact_force_n,
                onset,
            };
            (h_old, f_old) = (height_m, force_n);
        }
        // The profile is linear here: the last input is all that counts.
        state.heights_m = [h_old; 3];
        state.forces_n = [f_old; 2];
        state.y = y.array();
        state.gap_m = before;
    }

    /// The discrete-gradient force for penetration g₀ before and b after a free step.
    #[inline(always)]
    fn force(&self, g0: f64, b: f64) -> f64 {
        let k = self.ratio;
        if g0 >= 0.0 && b >= k * g0 {
            // In, in.
            return self.pressed_stiffness_n_m * (b + g0);
        }
        if g0 <= 0.0 && b <= 0.0 {
            return 0.0;
        }
        self.crossing_force(g0, b)
    }

    #[inline(never)]
    fn crossing_force(&self, g0: f64, b: f64) -> f64 {
        let k = self.ratio;
        let sum = b + g0;
        if g0 < 0.0 {
            let root = libm::sqrt(sum * sum - 4.0 * (1.0 + k) * b * g0);
            // The form of the positive root that does not cancel.
            let g1 = if sum >= 0.0 { (sum + root) / (2.0 * (1.0 + k)) } else { 2.0 * b * g0 / (sum - root) };
            self.half_stiffness_n_m * g1 * (g1 / (g1 - g0))
        } else {
            let root = libm::sqrt((b - g0) * (b - g0) + 4.0 * k * g0 * g0);
            let g1 = 0.5 * (sum - root);
            self.half_stiffness_n_m * g0 * (g0 / (g0 - g1))
        }
    }

    #[inline(never)]
    fn onset(&self, before: f64, after: f64) -> Onset {
        Onset { offset: before / (before - after), closing_m_s: (before - after) * self.rate_hz }
    }
}
