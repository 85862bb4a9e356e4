//! Tip law: depth in, force out. What a surface that gives way answers to a device whose tip stands
//! in it.
//!
//! ```text
//! sand     F_z = k_s β (e^{k_c d} − 1),  F_xy = −k_f v F_z          the document's loop, |F| ≤ cap
//! spring   F_z = d / C,                  F_xy = −μ F_z v / max(|v|, 1 mm/s)
//! ```
//!
//! A plain value for the thread that drives the device: it needs no engine, waits for nothing, and
//! gives what the engine's own force rows give for the same depth, without their delay. d is the
//! depth below the surface as it lies, which for sand in its own furrow is lower than it was.

use crate::sand::SandLaw;

/// Below this speed friction grows linearly, so that a resting tip does not chatter, m/s.
const STICK_M_S: f64 = 1e-3;
/// No spring carries more, N.
const MOST_N: f64 = 1e9;

/// Force of a surface to a depth.
#[expect(
    clippy::large_enum_variant,
    reason = "a plain value that a device's thread copies once; boxing it would end that"
)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TipLaw {
    /// Sand.
    Sand(SandLaw),
    /// A spring with Coulomb friction: a soft map, or a wall as stiff as a loop can hold.
    Spring {
        /// Compliance, m/N, above 0.
        compliance_m_n: f64,
        /// Coulomb coefficient.
        friction: f64,
    },
}

impl TipLaw {
    /// Force on the tip along u, v and out of the surface, N; none above the surface, and none of a
    /// depth that is no number. Always finite.
    #[must_use]
    pub fn answer_n(&self, depth_m: f64, velocity_m_s: [f64; 2]) -> [f64; 3] {
        match self {
            Self::Sand(law) => law.answer_n(depth_m, velocity_m_s),
            Self::Spring { compliance_m_n, friction } => {
                // In this order what is no number carries nothing.
                let carried_n = (depth_m.max(0.0) / compliance_m_n).min(MOST_N);
                let [u, v] = velocity_m_s.map(|v| if v.is_finite() { v } else { 0.0 });
                let slide = friction * carried_n / libm::hypot(u, v).max(STICK_M_S);
                [-slide * u, -slide * v, carried_n]
            }
        }
    }

    /// [`answer_n`](Self::answer_n) at a place of the untouched surface, metres: over the [stones
    /// and shells](crate::sand::buried) of sand too.
    #[must_use]
    pub fn answer_at_n(&self, position_m: [f64; 2], depth_m: f64, velocity_m_s: [f64; 2]) -> [f64; 3] {
        match self {
            Self::Sand(law) => law.answer_at_n(position_m, depth_m, velocity_m_s),
            Self::Spring { .. } => self.answer_n(depth_m, velocity_m_s),
        }
    }

    /// Growth of the force with the depth at a place of the untouched surface, N/m:
    /// [`stiffness_n_m`](Self::stiffness_n_m), and over a stone the stone's.
    #[must_use]
    pub fn stiffness_at_n_m(&self, position_m: [f64; 2], depth_m: f64) -> f64 {
        let step_m = 1e-6;
        let depth_m = depth_m.max(step_m);
        let carried_n = |depth_m: f64| self.answer_at_n(position_m, depth_m, [0.0; 2])[2];
        (carried_n(depth_m + step_m) - carried_n(depth_m - step_m)) / (2.0 * step_m)
    }

    /// Growth of the force with the depth, N/m: what a loop of period T can hold with a device that
    /// damps with b is at most 2 b / T.
    #[must_use]
    pub fn stiffness_n_m(&self, depth_m: f64) -> f64 {
        match self {
            Self::Spring { compliance_m_n, .. } => 1.0 / compliance_m_n,
            Self::Sand(law) => {
                let step_m = 1e-6;
                let depth_m = depth_m.max(step_m);
                (law.force_n(depth_m + step_m) - law.force_n(depth_m - step_m)) / (2.0 * step_m)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sand::Buried;

    #[test]
    fn sand_answers_with_the_document_s_two_equations() {
        let law = SandLaw::default();
        for (depth_m, v) in [(0.003, [0.08, 0.0]), (0.006, [-0.02, 0.05]), (0.001, [0.0, 0.0])] {
            let repulse_n = 1000.0 * (f64::exp(depth_m) - 1.0);
            let wanted = [-20.0 * v[0] * repulse_n, -20.0 * v[1] * repulse_n, repulse_n];
            let found = TipLaw::Sand(law).answer_n(depth_m, v);
            assert!((0..3).all(|a| (found[a] - wanted[a]).abs() < 1e-9), "{found:?} {wanted:?}");
        }
        assert_eq!(TipLaw::Sand(law).answer_n(0.0, [0.1, 0.1]), [0.0; 3]);
        assert!((TipLaw::Sand(law).stiffness_n_m(0.003) / 1003.0 - 1.0).abs() < 1e-4);
        // 0.5 m/s at 5 N would drag with 50 N; no device gives more than it can, in the direction
        // of the force.
        let [u, v, z] = TipLaw::Sand(law).answer_n(0.005, [0.5, 0.0]);
        assert!((u.hypot(z) - 20.0).abs() < 1e-9 && v == 0.0 && (u / z + 10.0).abs() < 1e-9);
    }

    #[test]
    fn a_spring_carries_and_rubs() {
        let law = TipLaw::Spring { compliance_m_n: 2e-3, friction: 0.5 };
        assert_eq!(law.answer_n(0.004, [0.3, -0.4]), [-0.6, 0.8, 2.0]);
        assert_eq!(law.answer_n(-0.004, [0.3, -0.4])[2], 0.0);
        assert_eq!(law.stiffness_n_m(0.0), 500.0);
    }

    #[test]
    fn a_sensor_of_rubbish_gets_a_finite_force() {
        let mut steep =
            SandLaw { exponent_per_m: 1e4, stiffness_n: 1e6, drag_s_per_m: 1e4, ..SandLaw::default() };
        let stone =
            Buried { at_m: [0.05; 2], top_m: 0.002, half_m: [0.008; 2], height_m: 0.004, hardness: 1e3 };
        steep.buried[0] = Some(stone);
        let spring = TipLaw::Spring { compliance_m_n: 1e-12, friction: 10.0 };
        let rubbish = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 5e-324, 0.45, 1e3, -0.0];
        for law in [TipLaw::Sand(SandLaw::default()), TipLaw::Sand(steep), spring] {
            for depth_m in rubbish {
                for v in rubbish {
                    for x in rubbish {
                        let forces =
                            [law.answer_n(depth_m, [v, 0.1]), law.answer_at_n([x, 0.05], depth_m, [0.1, v])];
                        for force_n in forces {
                            assert!(force_n.iter().all(|f| f.is_finite()), "{depth_m} {v} {x}: {force_n:?}");
                            let size_n = libm::hypot(libm::hypot(force_n[0], force_n[1]), force_n[2]);
                            assert!(!matches!(law, TipLaw::Sand(_)) || size_n <= 20.0 + 1e-9, "{size_n}");
                            assert!(
                                depth_m > 0.0 || force_n.iter().all(|f| *f == 0.0),
                                "{depth_m}: {force_n:?}"
                            );
                        }
                    }
                }
            }
        }
    }
}
