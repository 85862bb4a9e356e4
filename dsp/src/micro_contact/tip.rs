//! Tip of a tool, for what is heard of it: a light end on Hertz' spring in front of the tool.
//!
//! ```text
//! m_t x'' = k_H max(0, z − x) − b_t (x' − y') − k (x − y)        k_H = (6 E*² r)^⅓ F^⅓
//! M y''   = b_t (x' − y') + k (x − y) − F
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | m_t, b_t, r | [`HeardTip`]: mass, damping, radius of contact |
//! | E* | of the pair: 1/E* = (1 − ν²)/E of the tip + (1 − ν²)/E of the ground |
//! | k, M, y | spring and mass of the tool behind it ([`heard`](super::Probe::heard)) |
//! | z | the ground, its micro-relief ridden with [`HeardTip::asperity_radius_m`] |
//!
//! The equations are those of the pad, so the same integrator runs them. A shaft sends what its
//! impedance lets through, F ≈ (b + jωm) ż, and not the weight of the tool: the one spring of 6.5
//! kN/m that feels right for a stylus is a low-pass at 74 Hz for its sound.

use crate::DesignError;
use crate::hertz::Elastic;
use crate::limits::probe as limits;

/// A tip of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct HeardTip {
    /// m_t, kg; 1e-6 to 1.
    pub mass_kg: f64,
    /// b_t: resistance of the shaft, N·s/m; 0 to 1e4.
    pub damping_n_s_m: f64,
    /// Material.
    pub material: Elastic,
    /// r: radius of its contact, m; 1e-6 to 0.1.
    pub contact_radius_m: f64,
    /// Radius of the asperities that ride the micro-relief, m; 0 (points) to 0.1.
    pub asperity_radius_m: f64,
}

impl HeardTip {
    /// k_H at 1 N on ground of this E/(1 − ν²), Pa.
    #[must_use]
    pub fn stiffness_n_m(&self, ground_pa: f64) -> f64 {
        let modulus_pa = 1.0 / (1.0 / self.material.modulus_pa() + 1.0 / ground_pa);
        hertz_n_m(modulus_pa, self.contact_radius_m)
    }

    pub(super) fn check(&self) -> Result<(), DesignError> {
        limits::PAD_MASS_KG.check("tip_mass_kg", self.mass_kg)?;
        limits::PAD_DAMPING_N_S_M.check("tip_damping_n_s_m", self.damping_n_s_m)?;
        let Elastic { young_pa, poisson } = self.material;
        crate::limits::material::YOUNG_PA.check("tip_material: young_pa", young_pa)?;
        crate::limits::material::POISSON.check("tip_material: poisson", poisson)?;
        limits::TIP_CONTACT_RADIUS_M.check("tip_contact_radius_m", self.contact_radius_m)?;
        limits::TIP_RADIUS_M.check("asperity_radius_m", self.asperity_radius_m).map(|_| ())
    }
}

/// Slope of Hertz' law at 1 N, N/m.
pub(super) fn hertz_n_m(modulus_pa: f64, radius_m: f64) -> f64 {
    libm::cbrt(6.0 * modulus_pa * modulus_pa * radius_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: Elastic = Elastic { young_pa: 200e9, poisson: 0.29 };
    const TIP: HeardTip = HeardTip {
        mass_kg: 5e-4,
        damping_n_s_m: 15.0,
        material: STEEL,
        contact_radius_m: 4e-4,
        asperity_radius_m: 5e-5,
    };

    // k = 3/2 δ^½ · 4/3 E* √r where 4/3 E* √r δ^1.5 = 1 N, in numpy.
    #[test]
    fn a_steel_tip_is_as_stiff_as_hertz_says() {
        let on = |young_pa, poisson| TIP.stiffness_n_m(Elastic { young_pa, poisson }.modulus_pa());
        for (found, numpy) in [(on(200e9, 0.29), 3.058e6), (on(11e9, 0.25), 6.676e5)] {
            assert!((found / numpy - 1.0).abs() < 1e-3, "{found} for {numpy}");
        }
    }
}
