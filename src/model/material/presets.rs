//! The table of materials. A new one is one row here.
//!
//! Sources: **[KleinPAT]** Wang and James, "KleinPAT: optimal mode conflation for time-domain
//! precomputation of acoustic transfer", ACM Transactions on Graphics 38(4), 2019, table 4.
//! **[Cremer]** Cremer and Heckl, "Structure-borne sound", 2nd ed. 1988, tables of loss factors.
//! **[Seo]** Seo et al., "Friction coefficients in a longitudinal direction between the finger pad
//! and selected materials for different normal forces and curvatures", Ergonomics 52(5), 2009.
//! **[Handbook]** values that handbooks of materials agree on within some per cent. **Assumed**:
//! our own, from no measurement. **Recalled**: not read again in the source. **Measured**: decays
//! of recorded pieces, listed in `docs/materials.md`.
//!
//! β is 0 throughout: next to η no piece at hand shows it.

use super::{Material, MaterialPreset};
use crate::model::surface::DEFAULT_MICRO_RELIEF_M;

/// One row each: a constant of [`Material`] and an entry of [`Material::PRESETS`].
macro_rules! materials {
    ($($constant:ident, $name:literal, $what:literal:
        E $young_pa:literal, nu $poisson:literal, rho $density_kg_m3:literal, $elastic_source:literal;
        alpha $alpha_per_s:literal, eta $eta:literal, beta $beta_s:literal, $damping_source:literal;
        mu $mu_static:literal, $mu_kinetic:literal, $friction_source:literal;
        R $roughness:literal, relief $relief:literal, $finish_source:literal;
    )+) => {
        impl Material {
            $(
                #[doc = $what]
                pub const $constant: Self = Self {
                    young_pa: $young_pa,
                    poisson: $poisson,
                    density_kg_m3: $density_kg_m3,
                    alpha_per_s: $alpha_per_s,
                    eta: $eta,
                    beta_s: $beta_s,
                    mu_static: $mu_static,
                    mu_kinetic: $mu_kinetic,
                    roughness: $roughness,
                    micro_relief_m: $relief * DEFAULT_MICRO_RELIEF_M,
                };
            )+

            /// Every preset with its name, as scene files and contact logs spell it, and the
            /// sources of its numbers.
            pub const PRESETS: &'static [MaterialPreset] = &[$(MaterialPreset {
                name: $name,
                what: $what,
                material: Self::$constant,
                elastic_source: $elastic_source,
                damping_source: $damping_source,
                friction_source: $friction_source,
                finish_source: $finish_source,
            }),+];
        }
    };
}

// The micro-relief is in units of the engine's default one: how rough a finish is, R says; only
// what was cast against boards or cut from clay is coarser than that.
materials! {
    STEEL, "steel", "Carbon steel, ground.":
        E 200e9, nu 0.29, rho 7850.0, "[KleinPAT]";
        alpha 2.0, eta 2e-4, beta 0.0, "η [Cremer] 0.2–3e-4; α measured on a glockenspiel bar";
        mu 0.7, 0.5, "assumed";
        R 0.3, relief 1.0, "assumed";
    IRON, "iron", "Grey cast iron.":
        E 110e9, nu 0.26, rho 7200.0, "[Handbook]";
        alpha 3.0, eta 2e-3, beta 0.0, "assumed, between wrought iron [Cremer] 2–6e-4 and heavily damping grey iron, 1e-2";
        mu 0.7, 0.5, "assumed";
        R 0.6, relief 1.0, "assumed";
    ALUMINIUM, "aluminium", "Aluminium alloy.":
        E 69e9, nu 0.33, rho 2700.0, "[Handbook]";
        alpha 2.0, eta 3e-4, beta 0.0, "η above the pure metal's 1e-4 [Cremer]; α measured on a vibraphone bar";
        mu 0.8, 0.6, "sliding [Seo]; sticking assumed";
        R 0.35, relief 1.0, "assumed";
    BRASS, "brass", "Brass.":
        E 105e9, nu 0.34, rho 8500.0, "[Handbook]";
        alpha 2.0, eta 6e-4, beta 0.0, "η [Cremer] 0.2–1e-3; α assumed";
        mu 0.7, 0.5, "assumed";
        R 0.3, relief 1.0, "assumed";
    COPPER, "copper", "Copper.":
        E 125e9, nu 0.35, rho 8900.0, "[Cremer]";
        alpha 2.0, eta 2e-3, beta 0.0, "η [Cremer]; α assumed";
        mu 0.7, 0.5, "assumed";
        R 0.3, relief 1.0, "assumed";
    GLASS, "glass", "Soda-lime glass.":
        E 70e9, nu 0.22, rho 2500.0, "[Handbook]";
        alpha 1.0, eta 1e-3, beta 0.0, "η [Cremer, recalled] 0.6–2e-3; α [KleinPAT]";
        mu 0.9, 0.7, "assumed";
        R 0.05, relief 1.0, "assumed";
    CERAMIC, "ceramic", "Glazed stoneware.":
        E 72e9, nu 0.19, rho 2700.0, "[KleinPAT]; 1.75 % below the pitches of a real bowl";
        alpha 0.5, eta 1.1e-3, beta 0.0, "η measured on that bowl, 52 modes; α assumed";
        mu 0.8, 0.6, "assumed";
        R 0.15, relief 1.0, "assumed";
    STONE, "stone", "Granite.":
        E 50e9, nu 0.25, rho 2700.0, "[Handbook]";
        alpha 2.0, eta 6e-3, beta 0.0, "η measured on a struck stone; α assumed";
        mu 0.6, 0.5, "assumed";
        R 0.6, relief 1.0, "assumed";
    CONCRETE, "concrete", "Structural concrete.":
        E 30e9, nu 0.2, rho 2400.0, "[Handbook]";
        alpha 5.0, eta 6e-3, beta 0.0, "η [Cremer, recalled] 4–8e-3; α assumed";
        mu 0.7, 0.6, "assumed";
        R 0.9, relief 1.5, "assumed";
    BRICK, "brick", "Fired clay brick.":
        E 15e9, nu 0.2, rho 1900.0, "[Handbook]";
        alpha 5.0, eta 0.015, beta 0.0, "η [Cremer, recalled] 1–2e-2; α assumed";
        mu 0.7, 0.6, "assumed";
        R 0.9, relief 1.5, "assumed";
    WOOD, "wood", "Hardwood along the grain, planed.":
        E 11e9, nu 0.25, rho 750.0, "[KleinPAT]";
        alpha 5.0, eta 8e-3, beta 0.0, "η measured on struck wood, claves and a wood block; oak [Cremer, recalled] 1e-2; α assumed";
        mu 0.6, 0.5, "assumed";
        R 0.6, relief 1.0, "assumed";
    SOFTWOOD, "softwood", "Spruce or fir along the grain, planed.":
        E 10.8e9, nu 0.37, rho 430.0, "[Handbook]";
        alpha 5.0, eta 0.008, beta 0.0, "η of fir [Cremer, recalled]; α assumed";
        mu 0.6, 0.5, "assumed";
        R 0.65, relief 1.0, "assumed";
    PLA, "pla", "Printed PLA, as the plates of the Hasti study; the default of bodies.":
        E 3.5e9, nu 0.36, rho 1240.0, "[Handbook]";
        alpha 10.0, eta 0.02, beta 0.0, "measured on three printed bodies, 286–375 Hz";
        mu 0.6, 0.5, "assumed";
        R 0.5, relief 1.0, "assumed: the middle of the scale";
    PLASTIC, "plastic", "Polycarbonate.":
        E 2.4e9, nu 0.37, rho 1190.0, "[KleinPAT]";
        alpha 5.0, eta 0.012, beta 0.0, "assumed; [KleinPAT] loses less";
        mu 0.7, 0.5, "assumed";
        R 0.3, relief 1.0, "assumed";
    ACRYLIC, "acrylic", "Acrylic glass.":
        E 3.2e9, nu 0.37, rho 1190.0, "[Handbook]";
        alpha 5.0, eta 0.03, beta 0.0, "η [Cremer, recalled] 2–4e-2; α assumed";
        mu 0.8, 0.6, "assumed";
        R 0.1, relief 1.0, "assumed";
    RUBBER, "rubber", "Soft rubber.":
        E 5e6, nu 0.49, rho 1100.0, "[Handbook]";
        alpha 20.0, eta 0.2, beta 0.0, "assumed";
        mu 1.1, 0.9, "sliding [Seo]; sticking assumed";
        R 0.7, relief 1.0, "assumed";
    NAIL, "nail", "Fingernail (keratin).":
        E 3e9, nu 0.35, rho 1300.0, "[Handbook]";
        alpha 20.0, eta 0.1, beta 0.0, "assumed";
        mu 0.5, 0.4, "assumed";
        R 0.3, relief 1.0, "assumed";
    CLOTH, "cloth", "Woven cotton, several layers.":
        E 5e6, nu 0.3, rho 400.0, "assumed";
        alpha 60.0, eta 0.3, beta 0.0, "assumed";
        mu 0.6, 0.5, "assumed";
        R 0.7, relief 2.0, "assumed";
    DENIM, "denim", "Denim.":
        E 2e7, nu 0.3, rho 600.0, "assumed";
        alpha 60.0, eta 0.25, beta 0.0, "assumed";
        mu 0.6, 0.5, "assumed";
        R 0.8, relief 2.0, "assumed";
    LEATHER, "leather", "Vegetable-tanned leather.":
        E 5e7, nu 0.4, rho 900.0, "[Handbook] 20–200 MPa; ν assumed";
        alpha 60.0, eta 0.15, beta 0.0, "assumed";
        mu 0.7, 0.6, "assumed";
        R 0.5, relief 1.5, "assumed";
    SKIN, "skin", "Skin over soft tissue.":
        E 4e5, nu 0.48, rho 1100.0, "assumed, within the 0.1–1 MPa of indentation";
        alpha 80.0, eta 0.4, beta 0.0, "assumed";
        mu 0.8, 0.6, "assumed";
        R 0.5, relief 1.5, "assumed";
    FOAM, "foam", "Upholstery foam.":
        E 1e5, nu 0.3, rho 30.0, "[Handbook]; ν assumed";
        alpha 80.0, eta 0.3, beta 0.0, "assumed";
        mu 0.9, 0.7, "assumed";
        R 0.8, relief 2.0, "assumed";
    CARPET, "carpet", "Cut-pile carpet.":
        E 2e5, nu 0.2, rho 200.0, "assumed";
        alpha 80.0, eta 0.4, beta 0.0, "assumed";
        mu 0.6, 0.5, "assumed";
        R 1.0, relief 3.0, "assumed";
    CARDBOARD, "cardboard", "Corrugated board, taken as one piece.":
        E 3e8, nu 0.3, rho 150.0, "assumed, from the stiffness of single-wall board";
        alpha 60.0, eta 0.1, beta 0.0, "assumed";
        mu 0.5, 0.4, "assumed";
        R 0.5, relief 1.5, "assumed";
    PAPER, "paper", "Stacked paper.":
        E 1e9, nu 0.3, rho 800.0, "assumed, a fifth of a single sheet's [Handbook] along its fibres";
        alpha 60.0, eta 0.1, beta 0.0, "assumed";
        mu 0.5, 0.4, "assumed";
        R 0.4, relief 1.0, "assumed";
    CORK, "cork", "Pressed cork.":
        E 2e7, nu 0.05, rho 180.0, "[Handbook]";
        alpha 60.0, eta 0.15, beta 0.0, "assumed";
        mu 0.6, 0.5, "assumed";
        R 0.7, relief 1.5, "assumed";
    SOIL, "soil", "Moist soil.":
        E 1e7, nu 0.3, rho 1600.0, "[Handbook] 5–50 MPa";
        alpha 80.0, eta 0.2, beta 0.0, "assumed";
        mu 0.6, 0.5, "assumed";
        R 1.0, relief 3.0, "assumed";
}
