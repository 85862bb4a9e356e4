//! Stock bodies: the modes of simple free shapes by size and material, so that a scene sounds
//! before anything is recorded.
//!
//! ```text
//! y(t) = J/m · Σ φₙ(x) Gₙ e^(−dₙ t) sin ωₙ t          pressure at 1 m, Pa, after an impulse J at x
//! ωₙ     the shape's own table, from E, ν, ρ and size;  dₙ = (α + η ω + β ω²) / 2
//! φₙ(x)  mode shape with a mean square of 1;            m the mass
//! Gₙ     ρ₀ c √(A/4π) · (ka)² / √(4 + (ka)⁴)            radiation of a swinging sphere of the same surface A = 4π a²
//! ```
//! Frequencies are those of thin or slender bodies that nobody holds; what a support does is in α.
//! The radiation is an estimate: it has the level right within some 10 dB, and makes the lowest
//! modes of small things as weak as they are.
//!
//! | shape | proportions | modes from |
//! |---|---|---|
//! | bar | 30 : 3 : 1 | Euler–Bernoulli's free bar, shear and rotary inertia to first order (Timoshenko 1921) |
//! | tube | length 20 outer diameters, wall 1/16 of the diameter | the same |
//! | ring | diameter 20 thicknesses, square | Hoppe 1871 (Love, *Theory of elasticity*, §293): bending in the plane |
//! | plate | square, 50 thicknesses | Rayleigh–Ritz; Leissa 1973 |
//! | disc | diameter 50 thicknesses | Bessel functions; Leissa 1969 |
//! | bowl | hemisphere, diameter 40 thicknesses | Rayleigh, *Theory of sound*, §235 |
//! | block | 4 : 2 : 1 | Rayleigh–Ritz in three dimensions (Visscher et al. 1991) |
//! | box, door; can, bottle, pan, barrel | [`solved`] | tetrahedra; thin shells of revolution |
//! | sheet, cushion | 300 thicknesses; 3 : 3 : 1 | [`soft`]: bands of noise for modes that overlap |
//!
//! Measured against `tests/independent/stock_modes.py`: bar within 0.9 % of the exact Timoshenko
//! bar (10 modes).

mod soft;
mod solved;
mod tables;

use crate::model::bad_value::{BadValue, within};
use crate::model::body::Body;
use crate::model::material::Material;
use crate::model::modal_model::ModalModel;
use crate::model::mode_shapes::Unit;
use asperity_dsp::limits::material::{MASS_KG, SIZE_M};
use asperity_dsp::mode::Mode;
use libm::{cos, cosh, exp, sin, sinh};
use std::f64::consts::{PI, TAU};

/// Highest mode of a stock body, Hz: the end of hearing.
const HIGHEST_HZ: f64 = 20e3;
/// Lowest, Hz: below it nothing is heard, and a soft body would only sway.
const LOWEST_HZ: f64 = 16.0;
/// Most modes of the shapes that have a closed form.
const MOST_MODES: usize = 24;
/// ρ₀ c of air at 20 °C, Pa·s/m.
const AIR_PA_S_M: f64 = 413.0;
/// Speed of sound in air at 20 °C, m/s.
const AIR_M_S: f64 = 343.0;
/// Shear coefficient of a rectangular bar, and of a thin tube (Cowper 1966, at ν = 0.3).
const SHEAR: (f64, f64) = (5.0 / 6.0, 0.53);
/// Strike positions of a bar or tube, in lengths: near an end, in the middle, between.
const ALONG: [f64; 3] = [0.06, 0.5, 0.3];

/// A simple free body. `size_m` is its longest side or its diameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Stock {
    /// A flat bar, as of a glockenspiel: struck near an end (position 0), in the middle (1),
    /// between (2).
    Bar,
    /// A tube, as of a chime: struck near an end (0), in the middle (1), between (2).
    Tube,
    /// A ring of square wire, struck from the side.
    Ring,
    /// A square plate: struck near a corner (0), in the middle (1), between (2).
    Plate,
    /// A round plate: struck near the edge (0), in the middle (1), halfway (2).
    Disc,
    /// A hemispherical bowl, struck at its rim.
    Bowl,
    /// A block 4 : 2 : 1, struck on its largest face: near a corner (0), in the middle (1), between
    /// (2).
    Block,
    /// A hollow box 4 : 3 : 2, as a crate, struck on its largest face: beside the middle (0), in it
    /// (1), towards a corner (2).
    Box,
    /// A can or a mug, open above: struck at its rim (0), on the wall (1), on the bottom (2).
    Can,
    /// An empty bottle: struck on its side (0), at its mouth (1), on the bottom (2).
    Bottle,
    /// A pan without its handle: struck at its rim (0), in the middle of the bottom (1), beside it
    /// (2).
    Pan,
    /// A barrel with both heads: struck on the bulge (0), on a head (1), near an end of the wall
    /// (2).
    Barrel,
    /// A door leaf that hangs free: struck near a corner (0), in the middle (1), between (2).
    Door,
    /// A square sheet of what does not ring: cloth, leather, cardboard.
    Sheet,
    /// A cushion, 3 : 3 : 1, of what does not ring: foam, carpet, soil.
    Cushion,
}

/// A shape in a size and a material.
struct Shape {
    /// Its mass, kg.
    mass_kg: f64,
    /// Its surface, m².
    surface_m2: f64,
    /// Undamped angular frequency of each mode, rad/s, and its shape at each strike position.
    modes: Vec<(f64, Vec<f64>)>,
}

impl Stock {
    /// Every shape with its name in scene files.
    pub const ALL: [(&'static str, Self); 15] = [
        ("bar", Self::Bar),
        ("tube", Self::Tube),
        ("ring", Self::Ring),
        ("plate", Self::Plate),
        ("disc", Self::Disc),
        ("bowl", Self::Bowl),
        ("block", Self::Block),
        ("box", Self::Box),
        ("can", Self::Can),
        ("bottle", Self::Bottle),
        ("pan", Self::Pan),
        ("barrel", Self::Barrel),
        ("door", Self::Door),
        ("sheet", Self::Sheet),
        ("cushion", Self::Cushion),
    ];

    /// The shape of that name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, shape)| *shape)
    }

    /// The names of [`ALL`](Self::ALL), for messages.
    #[must_use]
    pub fn names() -> String {
        Self::ALL.map(|(name, _)| name).join(", ")
    }

    /// Usual material and size, m, of such a thing.
    ///
    /// ```
    /// use asperity::{Body, Material, Stock};
    ///
    /// let (material, size_m) = Stock::Bowl.usual();
    /// assert_eq!((material, size_m), (Material::CERAMIC, 0.14));
    /// Body::stock(Stock::Bowl, material, size_m)?;
    /// # Ok::<(), asperity::BadValue>(())
    /// ```
    #[must_use]
    pub fn usual(self) -> (Material, f64) {
        match self {
            Self::Bar => (Material::STEEL, 0.2),
            Self::Tube => (Material::ALUMINIUM, 0.4),
            Self::Ring => (Material::STEEL, 0.15),
            Self::Plate => (Material::CERAMIC, 0.2),
            Self::Disc => (Material::BRASS, 0.3),
            Self::Bowl => (Material::CERAMIC, 0.14),
            Self::Block => (Material::WOOD, 0.2),
            Self::Box => (Material::SOFTWOOD, 0.4),
            Self::Can => (Material::STEEL, 0.11),
            Self::Bottle => (Material::GLASS, 0.3),
            Self::Pan => (Material::STEEL, 0.28),
            Self::Barrel => (Material::WOOD, 0.9),
            Self::Door => (Material::WOOD, 2.0),
            Self::Sheet => (Material::CLOTH, 0.5),
            Self::Cushion => (Material::FOAM, 0.4),
        }
    }

    /// The modes of this shape in a material, `size_m` (1 mm–100 m) along its longest side or
    /// across its diameter: the answer in pascals at 1 m to an impulse of 1 N·s, from 16 Hz to 20
    /// kHz. A thing so small that it rings above that has no mode and is silent.
    ///
    /// # Errors
    /// When the size or a number of the material is outside its range.
    pub fn modes(self, material: &Material, size_m: f64) -> Result<ModalModel, BadValue> {
        let (material, size_m) = (material.checked()?, within("size_m", size_m, SIZE_M)?);
        let shape = self.shape(&material, size_m);
        let name = Self::ALL.iter().find(|(_, shape)| *shape == self).map_or("", |(name, _)| name);
        let source =
            format!("stock {name}, {size_m} m, {}", material.name().unwrap_or("a material of its own"));
        let mut model = shape.model(&material, source);
        model.diffuse = soft::diffuse(self, &shape, &material, size_m);
        Ok(model)
    }

    /// Its mass in a material, kg, within what a body may have: 1e-6 to 1e6 kg.
    #[must_use]
    pub fn mass_kg(self, material: &Material, size_m: f64) -> f64 {
        self.shape(material, size_m).mass_kg.clamp(MASS_KG.low, MASS_KG.high)
    }

    fn shape(self, material: &Material, size_m: f64) -> Shape {
        match self {
            Self::Bar => bar(material, size_m),
            Self::Tube => tube(material, size_m),
            Self::Ring => ring(material, size_m),
            Self::Plate => plate(material, size_m),
            Self::Disc => disc(material, size_m),
            Self::Bowl => bowl(material, size_m),
            Self::Block => block(material, size_m),
            Self::Box => solved::shape(&solved::BOX, material, size_m),
            Self::Can => solved::shape(&solved::CAN, material, size_m),
            Self::Bottle => solved::shape(&solved::BOTTLE, material, size_m),
            Self::Pan => solved::shape(&solved::PAN, material, size_m),
            Self::Barrel => solved::shape(&solved::BARREL, material, size_m),
            Self::Door => solved::shape(&solved::DOOR, material, size_m),
            Self::Sheet => soft::sheet(material, size_m),
            Self::Cushion => soft::cushion(material, size_m),
        }
    }
}

impl Body {
    /// A body of a simple shape: its modes and its material.
    ///
    /// ```
    /// use asperity::{Body, Config, Engine, Material, Stock};
    ///
    /// let Engine { mut scene, .. } = Config::default().build()?;
    /// scene.add_body(Body::stock(Stock::Bowl, Material::CERAMIC, 0.14)?)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Stock::modes`].
    pub fn stock(shape: Stock, material: Material, size_m: f64) -> Result<Self, BadValue> {
        let modes = shape.modes(&material, size_m)?;
        Ok(Self::new(modes).material(material).mass_kg(shape.mass_kg(&material, size_m)))
    }
}

impl Shape {
    /// Pressure at 1 m over the velocity of its surface: a sphere of that surface.
    fn pa_per_m_s(&self, omega: f64) -> f64 {
        let radius_m = (self.surface_m2 / (4.0 * PI)).sqrt();
        let ka2 = (omega / AIR_M_S * radius_m).powi(2);
        AIR_PA_S_M * radius_m * ka2 / (4.0 + ka2 * ka2).sqrt()
    }

    fn model(&self, material: &Material, source: String) -> ModalModel {
        let (mut modes, mut positions) = (Vec::new(), Vec::<Vec<f64>>::new());
        for (omega, at) in &self.modes {
            let decay_per_s = material.damping().decay_per_s(omega / TAU);
            // The damped frequency; a mode that creeps back has none.
            let frequency_hz = (omega * omega - decay_per_s * decay_per_s).max(0.0).sqrt() / TAU;
            if !(LOWEST_HZ..=HIGHEST_HZ).contains(&frequency_hz) {
                continue;
            }
            let amplitude = |shape: f64| shape * self.pa_per_m_s(*omega) / self.mass_kg;
            modes.push(Mode { frequency_hz, decay_per_s, amplitude: amplitude(at[0]), phase_rad: 0.0 });
            positions.resize(at.len() - 1, Vec::new());
            positions.iter_mut().zip(&at[1..]).for_each(|(list, shape)| list.push(amplitude(*shape)));
        }
        let unit = Unit::PascalsAtOneMetre;
        ModalModel { source, impulse_n_s: 1.0, modes, positions, unit, ..ModalModel::silent() }
    }
}

/// D of a plate: E h³ / (12 (1 − ν²)).
fn plate_stiffness_n_m(material: &Material, thickness_m: f64) -> f64 {
    material.young_pa * thickness_m.powi(3) / (12.0 * (1.0 - material.poisson * material.poisson))
}

/// Modes of a free slender body of length L whose sections have the radius of gyration r: ω = (β
/// L)² r c / L², less what shear and rotary inertia take.
fn slender(material: &Material, length_m: f64, gyration_m: f64, shear: f64) -> Vec<(f64, Vec<f64>)> {
    (1..=MOST_MODES)
        .map(|n| {
            let turns = bending_root(n);
            let wavenumber = turns / length_m;
            let soft = 1.0 + 2.0 * (1.0 + material.poisson) / shear;
            let slow = (1.0 + (wavenumber * gyration_m).powi(2) * soft).sqrt();
            let omega = wavenumber * wavenumber * gyration_m * material.rod_speed_m_s() / slow;
            (omega, ALONG.map(|x| bending_shape(turns, x)).to_vec())
        })
        .collect()
}

/// The n-th root of cosh x cos x = 1 above 0.
fn bending_root(n: usize) -> f64 {
    // From the asymptote, which errs by 0.02 at the first.
    let mut x = (n as f64 + 0.5) * PI;
    for _ in 0..4 {
        // cos x = 1 / cosh x, whose right side changes slowly.
        let side = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        x = (n as f64 + 0.5) * PI - side * libm::asin(1.0 / cosh(x));
    }
    x
}

/// Shape of a free bar at x lengths from one end, its mean square 1.
fn bending_shape(root: f64, x: f64) -> f64 {
    let z = root * x;
    let span = sinh(root) - sin(root);
    let sigma = (cosh(root) - cos(root)) / span;
    // cosh z − σ sinh z without the difference of two large numbers.
    let rest = (cos(root) - sin(root) - exp(-root)) / span;
    0.5 * (rest * exp(z) + (1.0 + sigma) * exp(-z)) + cos(z) - sigma * sin(z)
}

fn bar(material: &Material, length_m: f64) -> Shape {
    let (width_m, thickness_m) = (length_m / 10.0, length_m / 30.0);
    Shape {
        mass_kg: material.density_kg_m3 * length_m * width_m * thickness_m,
        surface_m2: 2.0 * (length_m * (width_m + thickness_m) + width_m * thickness_m),
        modes: slender(material, length_m, thickness_m / 12f64.sqrt(), SHEAR.0),
    }
}

fn tube(material: &Material, length_m: f64) -> Shape {
    let outer_m = length_m / 40.0;
    let inner_m = outer_m * (1.0 - 1.0 / 8.0);
    let section_m2 = PI * (outer_m * outer_m - inner_m * inner_m);
    Shape {
        mass_kg: material.density_kg_m3 * length_m * section_m2,
        // What is outside; the inside radiates into itself.
        surface_m2: TAU * outer_m * length_m,
        modes: slender(material, length_m, 0.5 * libm::hypot(outer_m, inner_m), SHEAR.1),
    }
}

fn ring(material: &Material, diameter_m: f64) -> Shape {
    let thickness_m = diameter_m / 20.0;
    let radius_m = 0.5 * (diameter_m - thickness_m);
    let gyration_m = thickness_m / 12f64.sqrt();
    let modes = (2..MOST_MODES + 2).map(|m| {
        let m2 = (m * m) as f64;
        let omega = (m2 * (m2 - 1.0).powi(2) / (m2 + 1.0)).sqrt() * gyration_m * material.rod_speed_m_s()
            / (radius_m * radius_m);
        // It moves 1/m as far along as across.
        (omega, vec![(2.0 / (1.0 + 1.0 / m2)).sqrt()])
    });
    Shape {
        mass_kg: material.density_kg_m3 * TAU * radius_m * thickness_m * thickness_m,
        surface_m2: TAU * radius_m * 4.0 * thickness_m,
        modes: modes.collect(),
    }
}

fn plate(material: &Material, side_m: f64) -> Shape {
    let thickness_m = side_m / 50.0;
    let areal_kg_m2 = material.density_kg_m3 * thickness_m;
    let unit = (plate_stiffness_n_m(material, thickness_m) / areal_kg_m2).sqrt() / (side_m * side_m);
    Shape {
        mass_kg: areal_kg_m2 * side_m * side_m,
        surface_m2: 2.0 * side_m * side_m,
        modes: tabled(&tables::PLATE, unit),
    }
}

fn disc(material: &Material, diameter_m: f64) -> Shape {
    let (radius_m, thickness_m) = (0.5 * diameter_m, diameter_m / 50.0);
    let areal_kg_m2 = material.density_kg_m3 * thickness_m;
    let unit = (plate_stiffness_n_m(material, thickness_m) / areal_kg_m2).sqrt() / (radius_m * radius_m);
    let area_m2 = PI * radius_m * radius_m;
    Shape { mass_kg: areal_kg_m2 * area_m2, surface_m2: 2.0 * area_m2, modes: tabled(&tables::DISC, unit) }
}

fn bowl(material: &Material, diameter_m: f64) -> Shape {
    let (radius_m, thickness_m) = (0.5 * diameter_m, diameter_m / 40.0);
    let areal_kg_m2 = material.density_kg_m3 * thickness_m;
    let twisting_n_m = plate_stiffness_n_m(material, thickness_m) * (1.0 - material.poisson);
    let unit = (twisting_n_m / areal_kg_m2).sqrt() / (radius_m * radius_m);
    let area_m2 = TAU * radius_m * radius_m;
    Shape { mass_kg: areal_kg_m2 * area_m2, surface_m2: 2.0 * area_m2, modes: tabled(&tables::BOWL, unit) }
}

fn block(material: &Material, length_m: f64) -> Shape {
    let (width_m, height_m) = (length_m / 2.0, length_m / 4.0);
    Shape {
        mass_kg: material.density_kg_m3 * length_m * width_m * height_m,
        surface_m2: 2.0 * (length_m * width_m + length_m * height_m + width_m * height_m),
        modes: tabled(&tables::BLOCK, material.rod_speed_m_s() / length_m),
    }
}

fn tabled<const POSITIONS: usize>(table: &[(f64, [f64; POSITIONS])], unit: f64) -> Vec<(f64, Vec<f64>)> {
    table.iter().map(|(factor, shape)| (factor * unit, shape.to_vec())).collect()
}

#[cfg(test)]
mod tests;
