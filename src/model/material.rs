//! Elastic constants of what touches and what is touched.
//!
//! They set how long a Hertz contact lasts and so how bright an impact sounds (Hasti §III-D names
//! Young's modulus, Poisson ratio, mass and radius as its inputs). The presets are rounded
//! room-temperature handbook values; real pieces differ by tens of per cent, which moves a contact
//! time (∝ E^−0.4) by a few per cent.

use crate::model::bad_value::{BadValue, within};
use asperity_dsp::limits::material as limits;

/// Elastic constants of one material.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young_pa: f64,
    /// Poisson ratio, 0–0.5.
    pub poisson: f64,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
}

const fn material(young_pa: f64, poisson: f64, density_kg_m3: f64) -> Material {
    Material { young_pa, poisson, density_kg_m3 }
}

impl Material {
    /// Carbon steel.
    pub const STEEL: Self = material(205e9, 0.29, 7850.0);
    /// Aluminium alloy.
    pub const ALUMINIUM: Self = material(69e9, 0.33, 2700.0);
    /// Brass.
    pub const BRASS: Self = material(105e9, 0.34, 8500.0);
    /// Soda-lime glass.
    pub const GLASS: Self = material(70e9, 0.22, 2500.0);
    /// Glazed stoneware.
    pub const CERAMIC: Self = material(70e9, 0.24, 2400.0);
    /// Granite.
    pub const STONE: Self = material(50e9, 0.25, 2700.0);
    /// Structural concrete.
    pub const CONCRETE: Self = material(30e9, 0.2, 2400.0);
    /// Hardwood along the grain.
    pub const WOOD: Self = material(11e9, 0.35, 700.0);
    /// Printed PLA, the plates of the Hasti study.
    pub const PLA: Self = material(3.5e9, 0.36, 1240.0);
    /// Polycarbonate.
    pub const PLASTIC: Self = material(2.4e9, 0.37, 1200.0);
    /// Soft rubber.
    pub const RUBBER: Self = material(5e6, 0.49, 1100.0);
    /// Fingernail (keratin).
    pub const NAIL: Self = material(3e9, 0.35, 1300.0);

    /// Every preset with its name, as scene files and contact logs spell it.
    pub const PRESETS: [(&'static str, Self); 12] = [
        ("steel", Self::STEEL),
        ("aluminium", Self::ALUMINIUM),
        ("brass", Self::BRASS),
        ("glass", Self::GLASS),
        ("ceramic", Self::CERAMIC),
        ("stone", Self::STONE),
        ("concrete", Self::CONCRETE),
        ("wood", Self::WOOD),
        ("pla", Self::PLA),
        ("plastic", Self::PLASTIC),
        ("rubber", Self::RUBBER),
        ("nail", Self::NAIL),
    ];

    /// The preset of that name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::PRESETS.iter().find(|(known, _)| *known == name).map(|(_, material)| *material)
    }

    /// The names of [`PRESETS`](Self::PRESETS), for messages: `steel, aluminium, …`.
    #[must_use]
    pub fn names() -> String {
        Self::PRESETS.map(|(name, _)| name).join(", ")
    }

    /// # Errors
    /// When a constant is not finite or no solid has it.
    pub fn checked(self) -> Result<Self, BadValue> {
        within("young_pa", self.young_pa, limits::YOUNG_PA)?;
        within("poisson", self.poisson, limits::POISSON)?;
        within("density_kg_m3", self.density_kg_m3, limits::DENSITY_KG_M3)?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_is_found_by_its_name_and_is_a_solid() {
        for (name, preset) in Material::PRESETS {
            assert_eq!(Material::by_name(name), Some(preset));
            assert!(preset.checked().is_ok());
        }
        assert_eq!(Material::by_name("unobtainium"), None);
    }
}
