//! Probe presets, each number with its source.
//!
//! A tool is two chains: felt, its mass on its own bending and grip; heard, the [tip](HeardTip) in
//! front of it on Hertz' spring.

use crate::model::material::Material;
use asperity_dsp::micro_contact::{self as contact, HeardTip, Probe};

/// Tip of a pen, and of a probe that gives no more than a mass.
///
/// Half a gram and 15 N·s/m are the impedance at 4 kHz of the free end of a shaft tilted by 35°
/// from the normal, m′ c_B (1 + j)/2 (Cremer and Heckl): a plastic pen of 8 mm has 14 N·s/m and 0.4
/// g, a pencil of 7 mm 15 and 0.5, **computed**. 0.4 mm is the radius of a worn point and 50 µm
/// that of its asperities, **chosen**.
pub(crate) const TIP: HeardTip = HeardTip {
    mass_kg: 0.5e-3,
    damping_n_s_m: 15.0,
    material: Material::PLASTIC.elastic(),
    contact_radius_m: 0.4e-3,
    asperity_radius_m: 50e-6,
};

/// Asperities that share the load of a face. **Assumed**: many times those of a tip; 64 brings a
/// crate on bricks of 5 mm from 120 to 102 dB SPL.
pub(crate) const FACE_ASPERITIES: f64 = 64.0;

/// Names of the probes that a scene file may ask for, with what each is and where its numbers come
/// from.
///
/// | probe | what moves with the surface | source |
/// |---|---|---|
/// | `fingertip` | 0.15 g of skin on a pad of 1 kN/m; an acceleration channel has what skin and tissue let through; 16 asperities share what is heard | `Probe::default()`: fingertip models of the literature |
/// | `fingertip-soft` | The same behind a skin of 20 kN/m with asperities of 50 µm, which makes no collisions | Chosen among 5 to 200 kN/m for its sound: centroid 1.1 kHz |
/// | `fingernail` | 0.5 g of nail, tied to the bone; heard by a tip of 0.5 g and 10 N·s/m, 0.3 mm | Stiffness of keratin on a hard surface; masses and damping **assumed** |
/// | `stylus` | 30 g of tool in a hand and forearm of 1 kg behind 0.47 kN/m and 26 N·s/m, on 6 kN/m; heard by a plastic tip of 0.5 g and 15 N·s/m, 0.4 mm | Felt: fitted to published accelerations of a steel-tipped tool (Culbertson, Lopez Delgado, Kuchenbecker 2014); one point of a valley of 20–60 g, 1.3–12 kN/m, 15–39 N·s/m. Heard: impedance of a shaft |
/// | `stylus-steel`, `stylus-wood` | The same with a tip of steel, of wood | as `stylus` |
/// | `steel-rod` | The same tool; heard by 1 g of steel, 25 N·s/m, 0.5 mm | A rod of 3 mm has 26 N·s/m and 0.9 g at 4 kHz, **computed** |
/// | `sole` | 50 g of rubber under a leg of 5 kg | Rubber of 5 MPa under a heel of 5 cm², 1 cm thick: E A / t = 250 kN/m; masses and damping **assumed** |
/// | `rigid` | 20 g, tied to 0.5 kg; heard by 1 g of plastic, 20 N·s/m, 1 mm | A hard thing that is pushed along; all **assumed** |
pub const PROBE_PRESETS: [(&str, Probe); 9] = [
    ("fingertip", FINGERTIP),
    (
        "fingertip-soft",
        Probe { contact_stiffness_n_m: 2e4, tip_radius_m: 50e-6, asperities: 1.0, ..FINGERTIP },
    ),
    ("fingernail", Probe { tip: tip(Material::NAIL, 0.5e-3, 10.0, 0.3e-3), ..NAIL }),
    ("stylus", Probe { tip: Some(TIP), ..STYLUS }),
    ("stylus-steel", Probe { tip: Some(HeardTip { material: Material::STEEL.elastic(), ..TIP }), ..STYLUS }),
    ("stylus-wood", Probe { tip: Some(HeardTip { material: Material::WOOD.elastic(), ..TIP }), ..STYLUS }),
    ("steel-rod", Probe { tip: tip(Material::STEEL, 1e-3, 25.0, 0.5e-3), ..STYLUS }),
    ("sole", held(50e-3, 2.5e5, 100.0, 5.0, 2.5e5, (20e-3, 1.0 / 3.0))),
    ("rigid", Probe { tip: tip(Material::PLASTIC, 1e-3, 20.0, 1e-3), ..RIGID }),
];

/// Probe of a thing that a physics engine moves: `rigid` without a tip, so that it is heard as one
/// body of its own mass. With the tip, 8 dB softer, a barrel rolled louder than it slid.
pub const THING_PROBE: Probe = RIGID;

/// Probe of a thing that lies with a face of this length along the stroke, m: `rigid` with
/// [`face_m`](Probe::face_m), whose asperities share the load.
#[must_use]
pub const fn thing_with_face(face_m: f64) -> Probe {
    Probe { tip: tip(Material::PLASTIC, 1e-3, 20.0, 1e-3), face_m, asperities: FACE_ASPERITIES, ..RIGID }
}

const FINGERTIP: Probe = Probe {
    pad_mass_kg: contact::PAD_MASS_KG,
    pad_stiffness_n_m: contact::PAD_STIFFNESS_N_M,
    pad_damping_n_s_m: contact::PAD_DAMPING_N_S_M,
    finger_mass_kg: contact::FINGER_MASS_KG,
    contact_stiffness_n_m: contact::CONTACT_STIFFNESS_N_M,
    leash_m: contact::LEASH_M,
    tip_radius_m: 0.0,
    force_exponent: contact::FORCE_EXPONENT,
    ridge_m: contact::RIDGE_M,
    tip: None,
    face_m: 0.0,
    asperities: contact::FINGER_ASPERITIES,
};
const NAIL: Probe = held(0.5e-3, 5e3, 5.0, 20e-3, 1e6, (0.3e-3, 1.0 / 3.0));
const STYLUS: Probe = held(30e-3, 470.0, 26.0, 1.0, 6e3, (1.6e-3, 0.22));
const RIGID: Probe = held(20e-3, 1e4, 20.0, 0.5, 1e6, (1e-3, 1.0 / 3.0));

const fn held(
    pad_mass_kg: f64,
    pad_stiffness_n_m: f64,
    pad_damping_n_s_m: f64,
    finger_mass_kg: f64,
    contact_stiffness_n_m: f64,
    (tip_radius_m, force_exponent): (f64, f64),
) -> Probe {
    Probe {
        pad_mass_kg,
        pad_stiffness_n_m,
        pad_damping_n_s_m,
        finger_mass_kg,
        contact_stiffness_n_m,
        tip_radius_m,
        force_exponent,
        ridge_m: 0.0,
        asperities: 1.0,
        ..FINGERTIP
    }
}

const fn tip(
    material: Material,
    mass_kg: f64,
    damping_n_s_m: f64,
    contact_radius_m: f64,
) -> Option<HeardTip> {
    Some(HeardTip { mass_kg, damping_n_s_m, material: material.elastic(), contact_radius_m, ..TIP })
}

/// The preset of that name.
///
/// ```
/// let sole = asperity::probe_by_name("sole").unwrap();
/// assert!(sole.finger_mass_kg > 1.0 && asperity::probe_by_name("broom").is_none());
/// ```
#[must_use]
pub fn probe_by_name(name: &str) -> Option<Probe> {
    PROBE_PRESETS.iter().find(|(known, _)| *known == name).map(|(_, probe)| *probe)
}
