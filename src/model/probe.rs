//! Probe presets, each number with its source.

use asperity_dsp::micro_contact::Probe;

/// Names of the probes that a scene file may ask for, with what each is and where its numbers come
/// from.
///
/// | probe | what moves with the surface | source |
/// |---|---|---|
/// | `fingertip` | 0.15 g of skin on a pad of 1 kN/m; an acceleration channel has what skin and tissue let through | `Probe::default()`: fingertip models of the literature |
/// | `fingernail` | 0.5 g of nail, tied to the bone | Stiffness of keratin on a hard surface; masses **assumed** |
/// | `stylus` | 30 g of tool in a hand of 0.3 kg behind 1 kN/m and 39 N·s/m, on 6.5 kN/m | Fitted to published accelerations of a steel-tipped tool (Culbertson, Lopez Delgado, Kuchenbecker 2014); one point of a valley of 20–60 g, 1.3–12 kN/m, 15–39 N·s/m |
/// | `sole` | 50 g of rubber under a leg of 5 kg | Rubber of 5 MPa under a heel of 5 cm², 1 cm thick: E A / t = 250 kN/m; masses and damping **assumed** |
/// | `rigid` | 20 g, tied to 0.5 kg | A hard thing that is pushed along; all **assumed** |
pub const PROBE_PRESETS: [(&str, Probe); 5] = [
    (
        "fingertip",
        Probe {
            pad_mass_kg: asperity_dsp::micro_contact::PAD_MASS_KG,
            pad_stiffness_n_m: asperity_dsp::micro_contact::PAD_STIFFNESS_N_M,
            pad_damping_n_s_m: asperity_dsp::micro_contact::PAD_DAMPING_N_S_M,
            finger_mass_kg: asperity_dsp::micro_contact::FINGER_MASS_KG,
            contact_stiffness_n_m: asperity_dsp::micro_contact::CONTACT_STIFFNESS_N_M,
            leash_m: asperity_dsp::micro_contact::LEASH_M,
            tip_radius_m: 0.0,
            force_exponent: asperity_dsp::micro_contact::FORCE_EXPONENT,
            ridge_m: asperity_dsp::micro_contact::RIDGE_M,
        },
    ),
    ("fingernail", held(0.5e-3, 5e3, 5.0, 20e-3, 1e6, (0.3e-3, 1.0 / 3.0))),
    ("stylus", held(30e-3, 1e3, 39.0, 0.3, 6.5e3, (1.6e-3, 0.25))),
    ("sole", held(50e-3, 2.5e5, 100.0, 5.0, 2.5e5, (20e-3, 1.0 / 3.0))),
    ("rigid", held(20e-3, 1e4, 20.0, 0.5, 1e6, (1e-3, 1.0 / 3.0))),
];

const fn held(
    pad_mass_kg: f64,
    pad_stiffness_n_m: f64,
    pad_damping_n_s_m: f64,
    finger_mass_kg: f64,
    contact_stiffness_n_m: f64,
    (tip_radius_m, force_exponent): (f64, f64),
) -> Probe {
    let leash_m = asperity_dsp::micro_contact::LEASH_M;
    Probe {
        pad_mass_kg,
        pad_stiffness_n_m,
        pad_damping_n_s_m,
        finger_mass_kg,
        contact_stiffness_n_m,
        leash_m,
        tip_radius_m,
        force_exponent,
        ridge_m: 0.0,
    }
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
