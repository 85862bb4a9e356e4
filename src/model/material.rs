//! Materials: what a thing is made of, in one table for the whole project.
//!
//! ```text
//! impact   E, ν          contact time ∝ E^−0.4 (Hasti §III-D)
//! modes    E, ν, ρ       frequency ∝ √(E/ρ) / size
//! ringing  α, η, β       d(ω) = (α + η ω + β ω²) / 2
//! touch    μ, R, relief  friction and micro-relief of its ordinary finish
//! ```
//! The presets are room-temperature values of ordinary pieces, each number with its source in
//! [`Material::PRESETS`]; real pieces differ by tens of per cent in stiffness and by a factor of
//! two in damping.

mod presets;

use crate::model::bad_value::{BadValue, within};
use asperity_dsp::damping::Damping;
use asperity_dsp::hertz::Elastic;
use asperity_dsp::limits::{self, material as range};

/// Material of a thing.
///
/// ```
/// use asperity::Material;
///
/// let glass = Material::by_name("glass").unwrap();
/// assert!(glass.damping().t60_s(2000.0) > 5.0 * Material::WOOD.damping().t60_s(2000.0));
/// // A material of one's own: what is not given is that of the default material.
/// let oak = Material { eta: 0.01, ..Material::new(12e9, 0.35, 720.0) };
/// assert!(oak.checked().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus, Pa; 1e3–1e13.
    pub young_pa: f64,
    /// Poisson ratio, 0–0.5.
    pub poisson: f64,
    /// Density, kg/m³; 1–1e5.
    pub density_kg_m3: f64,
    /// Damping α: the same at every frequency, 1/s; 0–1e6.
    #[serde(default = "default::alpha_per_s")]
    pub alpha_per_s: f64,
    /// Damping η: the loss factor; 0–10.
    #[serde(default = "default::eta")]
    pub eta: f64,
    /// Damping β: viscous, s; 0–1.
    #[serde(default = "default::beta_s")]
    pub beta_s: f64,
    /// Coulomb friction of dry skin that sticks to it, 0–10.
    #[serde(default = "default::mu_static")]
    pub mu_static: f64,
    /// Coulomb friction of dry skin that slides on it, 0–10.
    #[serde(default = "default::mu_kinetic")]
    pub mu_kinetic: f64,
    /// Perceptual roughness R of its ordinary finish, 0–1.
    #[serde(default = "default::roughness")]
    pub roughness: f64,
    /// Micro-relief of its ordinary finish, as a surface's `micro_relief_m`, m; 0–0.01.
    #[serde(default = "default::micro_relief_m")]
    pub micro_relief_m: f64,
}

/// One row of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MaterialPreset {
    /// Its name in scene files, contact logs and on the command line.
    pub name: &'static str,
    /// Material that it stands for.
    pub what: &'static str,
    /// Its numbers.
    pub material: Material,
    /// Source of E, ν and ρ.
    pub elastic_source: &'static str,
    /// Source of α, η and β.
    pub damping_source: &'static str,
    /// Source of the friction coefficients.
    pub friction_source: &'static str,
    /// Source of roughness and micro-relief.
    pub finish_source: &'static str,
}

/// Properties of a material that is given by its elastic constants only.
mod default {
    use super::Material;

    const MATERIAL: Material = Material::PLA;

    pub(super) fn alpha_per_s() -> f64 {
        MATERIAL.alpha_per_s
    }
    pub(super) fn eta() -> f64 {
        MATERIAL.eta
    }
    pub(super) fn beta_s() -> f64 {
        MATERIAL.beta_s
    }
    pub(super) fn mu_static() -> f64 {
        MATERIAL.mu_static
    }
    pub(super) fn mu_kinetic() -> f64 {
        MATERIAL.mu_kinetic
    }
    pub(super) fn roughness() -> f64 {
        MATERIAL.roughness
    }
    pub(super) fn micro_relief_m() -> f64 {
        MATERIAL.micro_relief_m
    }
}

impl Material {
    /// A material by its elastic constants: Young's modulus (Pa), Poisson ratio, density (kg/m³).
    /// Damping, friction and finish are those of [`PLA`](Self::PLA), the default material of
    /// bodies.
    #[must_use]
    pub const fn new(young_pa: f64, poisson: f64, density_kg_m3: f64) -> Self {
        Self { young_pa, poisson, density_kg_m3, ..Self::PLA }
    }

    /// The preset of that name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::PRESETS.iter().find(|preset| preset.name == name).map(|preset| preset.material)
    }

    /// The name of the preset that this is.
    #[must_use]
    pub fn name(&self) -> Option<&'static str> {
        Self::PRESETS.iter().find(|preset| preset.material == *self).map(|preset| preset.name)
    }

    /// The names of [`PRESETS`](Self::PRESETS), for messages: `steel, iron, …`.
    #[must_use]
    pub fn names() -> String {
        Self::PRESETS.iter().map(|preset| preset.name).collect::<Vec<_>>().join(", ")
    }

    /// The elastic constants.
    #[must_use]
    pub const fn elastic(&self) -> Elastic {
        Elastic { young_pa: self.young_pa, poisson: self.poisson }
    }

    /// Decay of its modes.
    #[must_use]
    pub const fn damping(&self) -> Damping {
        Damping { alpha_per_s: self.alpha_per_s, eta: self.eta, beta_s: self.beta_s }
    }

    /// Speed of longitudinal waves in a thin rod of it, √(E/ρ), m/s.
    #[must_use]
    pub fn rod_speed_m_s(&self) -> f64 {
        (self.young_pa / self.density_kg_m3).sqrt()
    }

    /// # Errors
    /// When a number is not finite or no solid has it.
    pub fn checked(self) -> Result<Self, BadValue> {
        within("young_pa", self.young_pa, range::YOUNG_PA)?;
        within("poisson", self.poisson, range::POISSON)?;
        within("density_kg_m3", self.density_kg_m3, range::DENSITY_KG_M3)?;
        within("alpha_per_s", self.alpha_per_s, range::ALPHA_PER_S)?;
        within("eta", self.eta, range::ETA)?;
        within("beta_s", self.beta_s, range::BETA_S)?;
        within("mu_static", self.mu_static, limits::FRICTION)?;
        within("mu_kinetic", self.mu_kinetic, limits::FRICTION)?;
        within("roughness", self.roughness, limits::ROUGHNESS)?;
        within("micro_relief_m", self.micro_relief_m, limits::MICRO_RELIEF_M)?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests;
