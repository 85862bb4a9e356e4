//! A knuckle that knocks: on what rings, and on what hardly does.

use super::demo_scene::DemoScene;
use super::scenes::LEAD_S;
use super::strokes::{log, strike};
use asperity::Material;

/// A thing that is knocked on.
struct Thing {
    name: &'static str,
    stock: &'static str,
    size_m: f64,
    material: &'static str,
    /// Mass that the knock feels, kg: of 60 g behind the knuckle and the thing, or the piece of
    /// cloth that it moves (assumed).
    mass_kg: f64,
    /// Gain that brings the four near each other.
    strike_gain: f64,
}

/// Things in the order of the knocks.
const THINGS: [Thing; 4] = [
    Thing { name: "door", stock: "door", size_m: 2.0, material: "wood", mass_kg: 0.06, strike_gain: 4.0 },
    Thing { name: "can", stock: "can", size_m: 0.11, material: "steel", mass_kg: 0.027, strike_gain: 8.0 },
    Thing { name: "box", stock: "box", size_m: 0.4, material: "cardboard", mass_kg: 0.03, strike_gain: 0.6 },
    Thing {
        name: "curtain",
        stock: "sheet",
        size_m: 0.5,
        material: "cloth",
        mass_kg: 0.0005,
        strike_gain: 1.2,
    },
];
/// Number of knocks on each, and the time from one to the next, s.
const KNOCKS: (usize, f64) = (5, 0.13);
/// Skin over bone (assumed): Young's modulus in pascals, Poisson's ratio, kg/m³.
const SKIN_OVER_BONE: (f64, f64, f64) = (1e8, 0.45, 1200.0);
/// Radius of a knuckle, m (assumed).
const RADIUS_M: f64 = 0.01;
const SPEED_M_S: f64 = 0.8;

/// The scene.
pub fn scene() -> DemoScene {
    let mut toml = "# A knuckle on four things. Knocks are equal in the log; `variation` lets each sound a little different,\n\
                    # `strike_gain` brings the four near each other.\n\
                    contacts = \"knuckle.jsonl\"\ntail_s = 0.8\n\n"
        .to_owned();
    let (young_pa, poisson, density_kg_m3) = SKIN_OVER_BONE;
    let knuckle = Material::new(young_pa, poisson, density_kg_m3);
    let mut lines = Vec::new();
    let mut t = LEAD_S;
    for Thing { name, stock, size_m, material, mass_kg, strike_gain } in THINGS {
        toml += &format!(
            "[[body]]\nname = \"{name}\"\nstock = \"{stock}\"\nsize_m = {size_m:?}\nmaterial = \"{material}\"\n\
             strike_gain = {strike_gain:?}\nvariation = 0.5\n\n"
        );
        for _ in 0..KNOCKS.0 {
            lines.push(strike(t, (name, None), SPEED_M_S, knuckle, (mass_kg, RADIUS_M)));
            t += KNOCKS.1;
        }
        t += 0.5;
    }
    toml += "[audio]\ngain = 0.05\n";
    DemoScene {
        name: "knuckle",
        title: "A knuckle on wood, a can, cardboard and cloth",
        notice: "Five equal knocks each on a wooden door, a tin can, a cardboard box and a curtain. Door and can ring, the box hardly, \
                 the curtain not at all: it is noise that is gone at once. No knock is quite the one before (`variation`).",
        toml,
        log: log(lines),
        assets: Vec::new(),
    }
}
