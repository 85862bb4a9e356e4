//! Elastic constants of a uniform, isotropic material, and how size and stiffness move the modes of
//! a shape.
//!
//! With Poisson's ratio and the shape kept, a solved body needs no new solve: f ∝ √(E/ρ)/s and,
//! because the shapes are mass-normalised, φ ∝ (ρ s³)^−½ (dimensional analysis of Navier's
//! equation).

use crate::error::ShapeError;

/// A uniform, isotropic, linear material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus, Pa, 1e3–1e13.
    pub young_pa: f64,
    /// Poisson's ratio, 0 to 0.49: beyond that a displacement element locks.
    pub poisson: f64,
    /// Density, kg/m³, 1–1e5.
    pub density_kg_m3: f64,
}

impl Elastic {
    /// # Errors
    /// When a constant is outside the ranges its field states.
    pub fn checked(self) -> Result<Self, ShapeError> {
        let within = |name: &str, value: f64, low: f64, high: f64| {
            if value >= low && value <= high {
                Ok(())
            } else {
                Err(ShapeError::new(name, format!("{value} is refused"), format!("must be {low} to {high}")))
            }
        };
        within("young_pa", self.young_pa, 1e3, 1e13)?;
        within("poisson", self.poisson, 0.0, 0.49)?;
        within("density_kg_m3", self.density_kg_m3, 1.0, 1e5)?;
        Ok(self)
    }

    /// Lamé's constants λ and μ, Pa.
    #[must_use]
    pub fn lame_pa(&self) -> (f64, f64) {
        let Self { young_pa, poisson, .. } = *self;
        (young_pa * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young_pa / (2.0 * (1.0 + poisson)))
    }

    /// Speed of longitudinal waves in a thin bar, √(E/ρ), m/s.
    #[must_use]
    pub fn bar_speed_m_s(&self) -> f64 {
        (self.young_pa / self.density_kg_m3).sqrt()
    }

    /// Length of a bending wave in a plate, λ = 2π (D / (ρ t ω²))^¼ with D = E t³ / 12(1−ν²), m.
    #[must_use]
    pub fn bending_wave_m(&self, thickness_m: f64, frequency_hz: f64) -> f64 {
        let omega = std::f64::consts::TAU * frequency_hz;
        let rigidity = self.young_pa * thickness_m.powi(3) / (12.0 * (1.0 - self.poisson * self.poisson));
        std::f64::consts::TAU * (rigidity / (self.density_kg_m3 * thickness_m * omega * omega)).powf(0.25)
    }

    /// Length of a shear wave, √(μ/ρ)/f, m.
    #[must_use]
    pub fn shear_wave_m(&self, frequency_hz: f64) -> f64 {
        (self.lame_pa().1 / self.density_kg_m3).sqrt() / frequency_hz
    }
}
