//! The probe that touches the surface: a fingertip as two masses, a spring, a damper and a leash.

use super::tip::{HeardTip, hertz_n_m};
use crate::DesignError;
use crate::limits::probe as limits;

/// Mass of the skin that moves with the surface, kg. Range 0.1–0.25 g: 0.1 g in a 2017 fingertip
/// model (ROBOMECH Journal, table 1); 0.11–0.255 g recalled from Wiertlewski & Hayward 2012 (which
/// Hasti §III-C cites, not opened by us: **recalled**).
pub const PAD_MASS_KG: f64 = 0.15e-3;
/// Stiffness of the pad between skin and bone, N/m. 1000 in the same table; range 600–1430
/// **recalled**.
pub const PAD_STIFFNESS_N_M: f64 = 1000.0;
/// Damping of the pad, N·s/m. 1.0 in the same table; 1.45–2.77 **recalled**.
pub const PAD_DAMPING_N_S_M: f64 = 2.0;
/// Mass of the finger behind the pad, kg. **Assumed**: only the order of magnitude is known.
pub const FINGER_MASS_KG: f64 = 20e-3;
/// Stiffness of skin on surface at 1 N, N/m. **Measured here**: above it the contact is chaotic on
/// rough ground, below it micro-collisions are silent (with 8–16 µm of micro-relief, 0.05–0.2 m/s;
/// `docs/lab/feel.md` has the map). The same as F/u of a rough contact (B. Persson 2007: u about
/// 0.4 rms) on 12 µm.
pub const CONTACT_STIFFNESS_N_M: f64 = 2e5;
/// n of k_m ∝ Fⁿ: Hertz, a sphere on a plane.
pub const FORCE_EXPONENT: f64 = 1.0 / 3.0;
/// Width of the part of a ridge of the fingerprint that touches, m. **Chosen**: a fifth of the 0.5
/// mm from one to the next (Scheibert and others 2009).
pub const RIDGE_M: f64 = 0.1e-3;
/// Asperities that share the load of a fingertip. **Assumed**: some hundreds stand on the ridges
/// (0.46 mm apart) of 100 mm²; 16 keeps what strokes of matte and shiny plates differ by.
pub const FINGER_ASPERITIES: f64 = 16.0;
/// Longest gap between skin and surface that the finger's own motion may open, m. **Design
/// choice**: an unloaded finger drifts 88 mm away in one second without it.
pub const LEASH_M: f64 = 1e-3;

/// The mechanical parameters of one probe (Hasti Fig. 6). All SI.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct Probe {
    /// m_s: skin mass, kg; 1e-6 to 1.
    pub pad_mass_kg: f64,
    /// k_s: pad spring between finger and skin, N/m; 1e-3 to 1e7.
    pub pad_stiffness_n_m: f64,
    /// b_s: pad damper, N·s/m; 0 to 1e4.
    pub pad_damping_n_s_m: f64,
    /// m_f: finger mass, kg; 1e-5 to 100.
    pub finger_mass_kg: f64,
    /// k_m: one-sided spring between skin and surface, N/m; 1 to 1e9.
    pub contact_stiffness_n_m: f64,
    /// Separation beyond which upward motion stops, m; 1e-6 to 0.05.
    pub leash_m: f64,
    /// Radius of the sphere that rides on the surface, m; 0 (a point) to 0.1. The contact model
    /// does not see it: it is for the source of the heights.
    pub tip_radius_m: f64,
    /// n of k_m ∝ Fⁿ, F the pressing force in newtons; 0 (always `contact_stiffness_n_m`) to 1.
    pub force_exponent: f64,
    /// Width over which skin averages what an acceleration channel has of the ground
    /// ([`crate::actuator::Skin`]), m; 0 (no skin: a tool) to 0.01. The contact model does not see
    /// it.
    pub ridge_m: f64,
    /// A tip of its own, which is what is heard of a tool; none: the pad is heard.
    #[cfg_attr(feature = "serde", serde(default))]
    pub tip: Option<HeardTip>,
    /// Length of a face along the stroke, m; 0 (none: a tip) to 10. A thing with a face rides a map
    /// as a ball that bridges it ([`Self::ride_radius_m`]).
    #[cfg_attr(feature = "serde", serde(default))]
    pub face_m: f64,
    /// N of the asperities that share the load, each by itself: strokes sound as 1/√N; 1 to 1e6.
    #[cfg_attr(feature = "serde", serde(default = "one"))]
    pub asperities: f64,
}

/// Asperities of a probe that was written down before they were counted.
#[cfg(feature = "serde")]
fn one() -> f64 {
    1.0
}

/// Largest radius with which a face rides, m: ground that is flat but for a hair.
const FLATTEST_M: f64 = 100.0;

/// Modulus of a hard tip on hard ground, Pa: steel on stone.
const HARD_PA: f64 = 5e10;
/// A contact below this share of Hertz' stiffness at 1 N is a spring of the tool. **Chosen**: the
/// stylus lies at 0.002, other presets above.
const OF_THE_TOOL: f64 = 0.03;

impl Default for Probe {
    /// The fingertip preset.
    fn default() -> Self {
        Self {
            pad_mass_kg: PAD_MASS_KG,
            pad_stiffness_n_m: PAD_STIFFNESS_N_M,
            pad_damping_n_s_m: PAD_DAMPING_N_S_M,
            finger_mass_kg: FINGER_MASS_KG,
            contact_stiffness_n_m: CONTACT_STIFFNESS_N_M,
            leash_m: LEASH_M,
            tip_radius_m: 0.0,
            force_exponent: FORCE_EXPONENT,
            ridge_m: RIDGE_M,
            tip: None,
            face_m: 0.0,
            asperities: FINGER_ASPERITIES,
        }
    }
}

impl Probe {
    /// ω_c: the fastest rate of the pressed pad, 1/s: √((k_m + k_s)/m_s + k_s/m_f).
    #[must_use]
    pub fn contact_rate_per_s(&self) -> f64 {
        let pad = (self.contact_stiffness_n_m + self.pad_stiffness_n_m) / self.pad_mass_kg;
        libm::sqrt(pad + self.pad_stiffness_n_m / self.finger_mass_kg)
    }

    /// Tests whether its contact is a spring of the tool, far softer than a ball on hard ground.
    #[must_use]
    pub fn bends(&self) -> bool {
        self.contact_stiffness_n_m < OF_THE_TOOL * hertz_n_m(HARD_PA, self.tip_radius_m)
    }

    /// A tip of its own as a probe on rigid ground, in front of this one's mass and spring. The
    /// spring is the contact of a probe that [bends](Self::bends) there, and otherwise the pad's.
    #[must_use]
    pub fn heard(&self, tip: &HeardTip) -> Self {
        let (finger_mass_kg, pad_stiffness_n_m) = if self.bends() {
            (self.pad_mass_kg, self.contact_stiffness_n_m)
        } else {
            (self.finger_mass_kg, self.pad_stiffness_n_m)
        };
        Self {
            pad_mass_kg: tip.mass_kg,
            pad_stiffness_n_m,
            pad_damping_n_s_m: tip.damping_n_s_m,
            finger_mass_kg,
            contact_stiffness_n_m: tip.stiffness_n_m(f64::INFINITY).clamp(1.0, 1e9),
            tip_radius_m: tip.asperity_radius_m,
            force_exponent: FORCE_EXPONENT,
            ridge_m: 0.0,
            tip: None,
            ..*self
        }
    }

    /// Radius with which it rides a map of this relief, m: that of its tip, or of the ball that a
    /// face of the length L needs to bridge a relief h, L²/8h.
    #[must_use]
    pub fn ride_radius_m(&self, relief_m: f64) -> f64 {
        if self.face_m == 0.0 {
            return self.tip_radius_m;
        }
        let bridging_m = self.face_m * self.face_m / (8.0 * relief_m.max(1e-9));
        self.tip_radius_m.max(bridging_m.min(FLATTEST_M))
    }

    /// Refuses values outside the documented ranges.
    ///
    /// # Errors
    /// Names the first field that is outside.
    pub fn check(&self) -> Result<(), DesignError> {
        limits::PAD_MASS_KG.check("pad_mass_kg", self.pad_mass_kg)?;
        limits::PAD_STIFFNESS_N_M.check("pad_stiffness_n_m", self.pad_stiffness_n_m)?;
        limits::PAD_DAMPING_N_S_M.check("pad_damping_n_s_m", self.pad_damping_n_s_m)?;
        limits::FINGER_MASS_KG.check("finger_mass_kg", self.finger_mass_kg)?;
        limits::CONTACT_STIFFNESS_N_M.check("contact_stiffness_n_m", self.contact_stiffness_n_m)?;
        limits::LEASH_M.check("leash_m", self.leash_m)?;
        limits::TIP_RADIUS_M.check("tip_radius_m", self.tip_radius_m)?;
        limits::FORCE_EXPONENT.check("force_exponent", self.force_exponent)?;
        limits::RIDGE_M.check("ridge_m", self.ridge_m)?;
        limits::FACE_M.check("face_m", self.face_m)?;
        limits::ASPERITIES.check("asperities", self.asperities)?;
        self.tip.as_ref().map_or(Ok(()), HeardTip::check)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hertz::Elastic;

    #[test]
    fn a_bending_tool_stands_behind_its_tip() {
        let tip = HeardTip {
            mass_kg: 5e-4,
            damping_n_s_m: 15.0,
            material: Elastic { young_pa: 200e9, poisson: 0.29 },
            contact_radius_m: 4e-4,
            asperity_radius_m: 5e-5,
        };
        let tool = Probe {
            pad_mass_kg: 0.03,
            contact_stiffness_n_m: 6.5e3,
            tip_radius_m: 1.6e-3,
            tip: Some(tip),
            ..Probe::default()
        };
        let front = tool.heard(&tip);
        assert_eq!((front.finger_mass_kg, front.pad_stiffness_n_m), (0.03, 6.5e3));
        assert_eq!((front.pad_mass_kg, front.pad_damping_n_s_m), (5e-4, 15.0));
        assert_eq!((front.tip_radius_m, front.ridge_m, front.tip), (5e-5, 0.0, None));
        let stiff = Probe { contact_stiffness_n_m: 1e6, ..tool };
        let front = stiff.heard(&tip);
        assert_eq!((front.finger_mass_kg, front.pad_stiffness_n_m), (0.02, 1000.0));
    }

    #[test]
    fn a_face_bridges_as_its_ball_and_never_sharper_than_its_tip() {
        let face = Probe { face_m: 0.3, tip_radius_m: 1e-3, ..Probe::default() };
        // L²/8h: 2.25 m over 5 mm.
        assert!((face.ride_radius_m(5e-3) - 2.25).abs() < 1e-12);
        assert_eq!((face.ride_radius_m(0.0), face.ride_radius_m(1e9)), (100.0, 1e-3));
        assert_eq!(Probe { face_m: 0.0, ..face }.ride_radius_m(5e-3), 1e-3);
    }
}
