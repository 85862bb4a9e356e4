//! Semi-implicit Euler: forces at the old positions, then positions with the new velocities.
//!
//! ```text
//! f   = k_m max(0, x_m − x_s)                       S = k_s p + b_s w̄,   p = x_s − x_f
//! v_f⁺ = v_f + (h/m_f)(S − F)                       w̄ = (w + w⁺)/2 centred, or w explicit; w = v_s − v_f
//! v_s⁺ = v_s + (h/m_s)(f − S)
//! x⁺  = x + h v⁺
//! ```
//! Everything but f is linear, so that the centred damper is solved at design time and costs
//! nothing: y⁺ = M y + g F + w f. The state carries positions one drift ahead (x⁺), which shortens
//! the chain from one contact force to the next. A row's positions and force hold at the row's
//! time; its velocity is the mean of the two half-step velocities around it.

use super::guard::{CleanBlock, MAX_PENETRATION_M, rescue};
use super::quad::F64x4;
use super::{ContactSample, ContactState, MicroContact, Onset, Probe};

/// Columns of one (sub-)step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SemiImplicit {
    pub stretch: [f64; 4],
    pub pad_velocity: [f64; 4],
    pub finger_velocity: [f64; 4],
    pub force: [f64; 4],
    /// Per metre of penetration.
    pub contact: [f64; 4],
    pub contact_stiffness_n_m: f64,
    /// (Sub-)steps a second.
    pub rate_hz: f64,
    pub substeps: usize,
}

impl SemiImplicit {
    pub fn new(probe: &Probe, explicit_damper: bool, step_s: f64, substeps: usize) -> Self {
        let h = step_s / substeps as f64;
        let column = |p, vs, vf, force, contact| step(probe, explicit_damper, h, [p, vs, vf], force, contact);
        Self {
            stretch: column(1.0, 0.0, 0.0, 0.0, 0.0),
            pad_velocity: column(0.0, 1.0, 0.0, 0.0, 0.0),
            finger_velocity: column(0.0, 0.0, 1.0, 0.0, 0.0),
            force: column(0.0, 0.0, 0.0, 1.0, 0.0),
            contact: column(0.0, 0.0, 0.0, 0.0, probe.contact_stiffness_n_m),
            contact_stiffness_n_m: probe.contact_stiffness_n_m,
            rate_hz: 1.0 / h,
            substeps,
        }
    }

    /// y⁺ for the gap `d` at the row's time; lane 0 of y is not used. The sums are grouped so that
    /// what is known late is added last.
    #[inline(always)]
    fn advance<Q: F64x4>(&self, d: f64, penetration: f64, y: Q, force_n: f64) -> Q {
        let springs = y.load(&self.force).times_plus(y.splat(force_n), y.load(&[d, 0.0, 0.0, 0.0]));
        let springs = y.load(&self.stretch).times_plus(y.spread::<1>(), springs);
        let dampers = y.load(&self.pad_velocity).mul(y.spread::<2>());
        let dampers = y.load(&self.finger_velocity).times_plus(y.spread::<3>(), dampers);
        y.load(&self.contact).times_plus(y.splat(penetration), springs.add(dampers))
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
        if self.substeps > 1 {
            self.run_steps(quad, design, state, block, out, self.substeps);
        } else {
            self.run_steps(quad, design, state, block, out, 1);
        }
    }

    #[inline(always)]
    fn run_steps<Q: F64x4>(
        &self,
        quad: Q,
        design: &MicroContact,
        state: &mut ContactState,
        block: &CleanBlock,
        out: &mut [ContactSample],
        substeps: usize,
    ) {
        let share = 1.0 / substeps as f64;
        let (mut h_old, mut f_old) = (state.heights_m[2], state.forces_n[1]);
        let (mut y, mut gap) = (quad.load(&state.y), state.gap_m);
        for ((out, &height_m), &force_n) in out.iter_mut().zip(&block.height_m).zip(&block.force_n) {
            let rise = (height_m - h_old) * share;
            let (mut mean, mut onset) = (0.0, None);
            for k in 1..=substeps {
                let force =
                    if k == substeps { force_n } else { f_old + (force_n - f_old) * share * k as f64 };
                let short = rise - y.first();
                let (d, penetration) = (0.0 - short, if short > 0.0 { short } else { 0.0 });
                mean += penetration;
                if (d < 0.0) & (gap >= 0.0) {
                    onset = self.onset(onset, gap, d, (k - 1) as f64, share);
                }
                gap = d;
                let next = self.advance(d, penetration, y, force);
                let (velocity, stretch) = (0.5 * (y.array()[2] + next.array()[2]), y.array()[1]);
                y = next;
                if k == substeps {
                    let pad_m = height_m + d;
                    *out = ContactSample {
                        height_m,
                        normal_force_n: force_n,
                        pad_m,
                        pad_velocity_m_s: velocity,
                        finger_m: pad_m - stretch,
                        contact_force_n: mean * share * self.contact_stiffness_n_m,
                        onset,
                    };
                }
            }
            let carried = y.first();
            if !(carried <= design.leash_m && carried >= -MAX_PENETRATION_M) {
                let mut lost = y.array();
                if rescue(design, &mut lost, carried, force_n, state.rise_m_s.max(0.0)) {
                    gap = lost[0];
                    state.resets = state.resets.saturating_add(1);
                }
                y = quad.load(&lost);
            }
            (h_old, f_old) = (height_m, force_n);
        }
        // The Euler scheme looks at the last input only.
        state.heights_m = [h_old; 3];
        state.forces_n = [f_old; 2];
        state.y = y.array();
        state.gap_m = gap;
    }

    #[inline(never)]
    fn onset(&self, known: Option<Onset>, gap: f64, d: f64, steps: f64, share: f64) -> Option<Onset> {
        let new = Onset { offset: (steps + gap / (gap - d)) * share, closing_m_s: (gap - d) * self.rate_hz };
        match known {
            Some(known) if known.closing_m_s >= new.closing_m_s => Some(known),
            _ => Some(new),
        }
    }
}

/// One step of the scheme from (p, v_s, v_f) at gap 0 under force F and contact force f: the next
/// (d, p, v_s, v_f).
fn step(probe: &Probe, explicit: bool, h: f64, [p, vs, vf]: [f64; 3], force: f64, contact: f64) -> [f64; 4] {
    let Probe { pad_mass_kg, pad_stiffness_n_m, pad_damping_n_s_m, finger_mass_kg, .. } = *probe;
    let both = h * (1.0 / pad_mass_kg + 1.0 / finger_mass_kg);
    let drive = h * (contact / pad_mass_kg + force / finger_mass_kg) - both * pad_stiffness_n_m * p;
    let half = 0.5 * both * pad_damping_n_s_m;
    let w = vs - vf;
    let damped = if explicit { w } else { (w + 0.5 * drive) / (1.0 + half) };
    let strut = pad_stiffness_n_m * p + pad_damping_n_s_m * damped;
    let vs = vs + h / pad_mass_kg * (contact - strut);
    let vf = vf + h / finger_mass_kg * (strut - force);
    [h * vs, p + h * (vs - vf), vs, vf]
}
