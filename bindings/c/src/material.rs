//! Materials by number, so that an event can name one without a text.

use crate::entry::{enter, out};
use crate::status::{ASP_REFUSED, ASP_UNKNOWN, Failure};
use crate::text;
use asperity::Material;
use std::ffi::c_char;

/// As the call says: steel for a striker, the engine's default material for a body.
pub const ASP_MATERIAL_DEFAULT: u32 = 0;

/// Carbon steel, ground.
pub const ASP_MATERIAL_STEEL: u32 = 1;
/// Grey cast iron.
pub const ASP_MATERIAL_IRON: u32 = 2;
/// Aluminium alloy.
pub const ASP_MATERIAL_ALUMINIUM: u32 = 3;
/// Brass.
pub const ASP_MATERIAL_BRASS: u32 = 4;
/// Copper.
pub const ASP_MATERIAL_COPPER: u32 = 5;
/// Soda-lime glass.
pub const ASP_MATERIAL_GLASS: u32 = 6;
/// Glazed stoneware.
pub const ASP_MATERIAL_CERAMIC: u32 = 7;
/// Granite.
pub const ASP_MATERIAL_STONE: u32 = 8;
/// Structural concrete.
pub const ASP_MATERIAL_CONCRETE: u32 = 9;
/// Fired clay brick.
pub const ASP_MATERIAL_BRICK: u32 = 10;
/// Hardwood along the grain, planed.
pub const ASP_MATERIAL_WOOD: u32 = 11;
/// Spruce or fir along the grain, planed.
pub const ASP_MATERIAL_SOFTWOOD: u32 = 12;
/// Printed PLA; the default of bodies.
pub const ASP_MATERIAL_PLA: u32 = 13;
/// Polycarbonate.
pub const ASP_MATERIAL_PLASTIC: u32 = 14;
/// Acrylic glass.
pub const ASP_MATERIAL_ACRYLIC: u32 = 15;
/// Soft rubber.
pub const ASP_MATERIAL_RUBBER: u32 = 16;
/// Fingernail.
pub const ASP_MATERIAL_NAIL: u32 = 17;
/// Woven cotton, several layers.
pub const ASP_MATERIAL_CLOTH: u32 = 18;
/// Denim.
pub const ASP_MATERIAL_DENIM: u32 = 19;
/// Vegetable-tanned leather.
pub const ASP_MATERIAL_LEATHER: u32 = 20;
/// Skin over soft tissue.
pub const ASP_MATERIAL_SKIN: u32 = 21;
/// Upholstery foam.
pub const ASP_MATERIAL_FOAM: u32 = 22;
/// Cut-pile carpet.
pub const ASP_MATERIAL_CARPET: u32 = 23;
/// Corrugated board, taken as one piece.
pub const ASP_MATERIAL_CARDBOARD: u32 = 24;
/// Stacked paper.
pub const ASP_MATERIAL_PAPER: u32 = 25;
/// Pressed cork.
pub const ASP_MATERIAL_CORK: u32 = 26;
/// Moist soil.
pub const ASP_MATERIAL_SOIL: u32 = 27;

/// A striker whose elastic constants stand in the event.
pub const ASP_MATERIAL_CUSTOM: u32 = 255;

/// The name of a number, none for the default.
pub(crate) fn name(number: u32) -> Result<Option<&'static str>, Failure> {
    if number == ASP_MATERIAL_DEFAULT {
        return Ok(None);
    }
    // The engine's presets are numbered in their order, from 1.
    Material::PRESETS.get(number as usize - 1).map(|preset| Some(preset.name)).ok_or_else(|| {
        let right = format!(
            "must be ASP_MATERIAL_DEFAULT to ASP_MATERIAL_NAIL, or what asp_material gives: {}",
            Material::names()
        );
        Failure::new(ASP_REFUSED, format!("material: {number} is unknown; {right}"))
    })
}

/// The material of a number, none for the default.
pub(crate) fn material(number: u32) -> Result<Option<Material>, Failure> {
    Ok(name(number)?.and_then(Material::by_name))
}

/// The number of a material, by the name that scene files use: "steel", "wood", …
#[unsafe(no_mangle)]
pub unsafe extern "C" fn asp_material(name: *const c_char, number: *mut u32) -> i32 {
    enter(|| {
        let (name, number) = (text::needed(name, "name")?, out(number, "number")?);
        let found = Material::PRESETS.iter().position(|preset| preset.name == name);
        *number = found.map(|index| index as u32 + 1).ok_or_else(|| {
            let known = Material::names();
            Failure::new(ASP_UNKNOWN, format!("material: \"{name}\" is unknown; must be one of: {known}"))
        })?;
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_of_the_engine_has_one_number() {
        let constants = include_str!("material.rs").lines().filter_map(|line| {
            let (name, number) = line.strip_prefix("pub const ASP_MATERIAL_")?.split_once(": u32 = ")?;
            Some((name.to_lowercase(), number.trim_end_matches(';').parse().unwrap()))
        });
        let constants: Vec<(String, u32)> = constants
            .filter(|(_, number)| ![ASP_MATERIAL_DEFAULT, ASP_MATERIAL_CUSTOM].contains(number))
            .collect();
        let named: Vec<&str> = constants.iter().map(|(name, _)| name.as_str()).collect();
        let presets: Vec<&str> = Material::PRESETS.iter().map(|preset| preset.name).collect();
        assert_eq!(named, presets);
        for (name, number) in &constants {
            assert_eq!(material(*number).unwrap(), Material::by_name(name));
        }
        assert_eq!(material(ASP_MATERIAL_DEFAULT).unwrap(), None);
        assert!(material(254).unwrap_err().sentence.contains("254 is unknown"));
    }
}
