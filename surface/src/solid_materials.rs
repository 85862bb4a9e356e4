//! The seven materials of the solid-noise paper, in physical units.
//!
//! | material | M | N | f | per | cell | A | what is ours |
//! |---|---|---|---|---|---|---|---|
//! | sandpaper | 3 | 1 | 50 | 1 | 0.2 mm | 10 µm | |
//! | granite | 6 | 2 | 1 | 0.5 | 10 mm | 10 µm | |
//! | rough glass | 3 | 1 | 4 | 1 | 2.5 mm | 10 µm | friction 0.1 ("very small friction") |
//! | wood | 1 + 2 | 1 + 1 | 40 + 1 | 1 | 0.25 mm + 10 mm | 10 µm | rings beside grain, see below |
//! | sand | 2 | 2 | 10 | 0.5 | 1 mm | 50 µm | |
//! | gravel | 6 | 2 | 5 | 0.5 | 2 mm | 50 µm | |
//! | pebbles | 8 | 2 | 1 | 0.5 | 10 mm | 100 µm | viscous medium, b = 5 N·s/m |
//! | ridged, billow, turbulence, Voronoi | 2 | 3 (Voronoi 1) | 5 | 0.5 | 2 mm | 50 µm | all: the paper names the modules only |
//!
//! M, N, f, per: the paper's Table 1. Its unit of length is not given; ours is 10 mm (T = 100 m⁻¹),
//! which makes sandpaper's cell 0.2 mm and pebbles' 10 mm. The lacunarity is not given either; ours
//! is 2. Wood: the text has two modules (low rings, high grain) and the magnitude of sandpaper and
//! glass, the table one row with M = 1; the preset is the table's row as grain and rings that bring
//! the magnitude to 3, and [`SolidMaterial::WoodAsPrinted`] is the row alone. A is ours: hard
//! ground or grown surfaces stay within ±50 µm, loose grains reach the size of what is lying there
//! (sand 0.1 mm, gravel 0.4 mm, pebbles 1 mm). L = 0.1 N per unit of magnitude keeps pebbles, the
//! strongest, at the 1 N cap; the seven keep the proportions of Table 1. The paper's pebbles lie
//! "in a viscous cube" whose viscosity is not printed; in Table 1 they differ from granite by the
//! magnitude alone.

use crate::solid_noise::{ForceDirection, NoiseKind, NoiseModule, SolidNoiseParameters};

/// 1 / (10 mm): the length unit of Table 1 (ours; the paper does not give it).
pub const TEXTURE_FACTOR_PER_M: f64 = 100.0;
/// Force per unit of magnitude, N (ours).
pub const LIMIT_N: f64 = 0.1;
/// Largest texture force, N (ours; the paper only says that there is one).
pub const CAP_N: f64 = 1.0;
/// Viscosity of the medium around the pebbles, N·s/m (ours). It was chosen on the strokes of the
/// test `seven_materials`: 0.99 of them are named rightly by their force alone, with 2 only 0.93,
/// without 0.84. On strokes and pieces that it was not chosen by (example `materials_blind`) it is
/// 0.97.
pub const PEBBLES_VISCOSITY_N_S_M: f64 = 5.0;
/// Friction of rough glass (ours: the paper says "very small").
pub const GLASS_FRICTION: f64 = 0.1;
/// Friction of the other materials (ours; a dry finger).
pub const FRICTION: f64 = 0.4;

/// A material of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum SolidMaterial {
    Sandpaper,
    Granite,
    RoughGlass,
    Wood,
    Sand,
    Gravel,
    Pebbles,
    /// Wood exactly as the paper's table has it: grain without rings.
    WoodAsPrinted,
    Ridged,
    Billow,
    Turbulence,
    Voronoi,
}

impl SolidMaterial {
    /// The seven of the paper's experiment, in its order.
    pub const SEVEN: [Self; 7] = [
        Self::Sandpaper,
        Self::Granite,
        Self::RoughGlass,
        Self::Wood,
        Self::Sand,
        Self::Gravel,
        Self::Pebbles,
    ];

    /// Noises of other kinds.
    pub const KINDS: [Self; 4] = [Self::Ridged, Self::Billow, Self::Turbulence, Self::Voronoi];

    /// Every one but the printed wood.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::SEVEN.into_iter().chain(Self::KINDS)
    }

    /// Its name in scene files and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sandpaper => "sandpaper",
            Self::Granite => "granite",
            Self::RoughGlass => "rough_glass",
            Self::Wood => "wood",
            Self::Sand => "sand",
            Self::Gravel => "gravel",
            Self::Pebbles => "pebbles",
            Self::WoodAsPrinted => "wood_as_printed",
            Self::Ridged => "ridged",
            Self::Billow => "billow",
            Self::Turbulence => "turbulence",
            Self::Voronoi => "voronoi",
        }
    }

    /// The material of a name; `-` and spaces count as `_`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.trim().to_ascii_lowercase().replace(['-', ' '], "_");
        Self::all().chain([Self::WoodAsPrinted]).find(|m| m.name() == name)
    }

    /// Its parameters.
    #[must_use]
    pub fn parameters(self) -> SolidNoiseParameters {
        let kind = match self {
            Self::Ridged => NoiseKind::Ridged,
            Self::Billow => NoiseKind::Billow,
            Self::Turbulence => NoiseKind::Turbulence,
            Self::Voronoi => NoiseKind::Voronoi,
            _ => NoiseKind::Gradient,
        };
        let module = |magnitude, octaves, frequency, persistence| NoiseModule {
            kind,
            magnitude,
            octaves,
            frequency,
            lacunarity: 2.0,
            persistence,
        };
        let (first, second, amplitude_m) = match self {
            Self::Sandpaper => (module(3.0, 1, 50.0, 1.0), NoiseModule::SILENT, 1e-5),
            Self::Granite => (module(6.0, 2, 1.0, 0.5), NoiseModule::SILENT, 1e-5),
            Self::RoughGlass => (module(3.0, 1, 4.0, 1.0), NoiseModule::SILENT, 1e-5),
            Self::Wood => (module(1.0, 1, 40.0, 1.0), module(2.0, 1, 1.0, 1.0), 1e-5),
            Self::WoodAsPrinted => (module(1.0, 1, 40.0, 1.0), NoiseModule::SILENT, 1e-5),
            Self::Sand => (module(2.0, 2, 10.0, 0.5), NoiseModule::SILENT, 5e-5),
            Self::Gravel => (module(6.0, 2, 5.0, 0.5), NoiseModule::SILENT, 5e-5),
            Self::Pebbles => (module(8.0, 2, 1.0, 0.5), NoiseModule::SILENT, 1e-4),
            Self::Voronoi => (module(2.0, 1, 5.0, 0.5), NoiseModule::SILENT, 5e-5),
            _ => (module(2.0, 3, 5.0, 0.5), NoiseModule::SILENT, 5e-5),
        };
        SolidNoiseParameters {
            modules: [first, second],
            texture_factor_per_m: TEXTURE_FACTOR_PER_M,
            amplitude_m,
            limit_n: LIMIT_N,
            cap_n: CAP_N,
            direction: ForceDirection::X,
            proportional_to_contact: false,
            viscosity_n_s_m: if self == Self::Pebbles { PEBBLES_VISCOSITY_N_S_M } else { 0.0 },
            flow_m_s: [0.0; 3],
            friction: if self == Self::RoughGlass { GLASS_FRICTION } else { FRICTION },
        }
    }
}
