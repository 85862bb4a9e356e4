//! Bodies that do not ring: their modes decay within a few periods and overlap, so that only their
//! density and their mean count (Cremer and Heckl, "Structure-borne sound", statistical energy
//! analysis).
//!
//! ```text
//! sheet     n(f) = S/2 √(ρ h / D)                          bending waves
//! cushion   n(f) = 4π V f² (1/c_L³ + 2/c_T³)               waves in a solid (Debye)
//! band      E = n Δf · (Z(f) / m)² / (4 d(f))              ∫ p² dt at 1 m after 1 N·s
//! ```
//! with Z the pressure over velocity of every stock body, d the material's damping, m the mass. The
//! shapes' proportions are assumed.

use super::{HIGHEST_HZ, Shape, Stock, plate_stiffness_n_m};
use crate::model::diffuse::{Diffuse, DiffuseBand, DiffusePart};
use crate::model::material::Material;
use asperity_dsp::diffuse::band_edges_hz;
use std::f64::consts::{PI, TAU};

/// Thicknesses along a side of a sheet, and of a cushion.
const SHEET: f64 = 300.0;
const CUSHION: f64 = 3.0;
/// Lowest band, Hz, and the slowest decay, 1/s.
const LOWEST_HZ: f64 = 60.0;
const SLOWEST_PER_S: f64 = 0.1;
const SOURCE: &str = "the density of overlapping modes, Cremer and Heckl; the damping of the material";

pub(super) fn sheet(material: &Material, side_m: f64) -> Shape {
    let mass_kg = material.density_kg_m3 * side_m * side_m * side_m / SHEET;
    Shape { mass_kg, surface_m2: 2.0 * side_m * side_m, modes: Vec::new() }
}

pub(super) fn cushion(material: &Material, side_m: f64) -> Shape {
    let mass_kg = material.density_kg_m3 * side_m * side_m * side_m / CUSHION;
    Shape { mass_kg, surface_m2: (2.0 + 4.0 / CUSHION) * side_m * side_m, modes: Vec::new() }
}

/// Bands of a soft shape; none of any other.
pub(super) fn diffuse(stock: Stock, shape: &Shape, material: &Material, side_m: f64) -> Option<Diffuse> {
    let per_hz = |hz: f64| match stock {
        Stock::Sheet => {
            let thickness_m = side_m / SHEET;
            let areal_kg_m2 = material.density_kg_m3 * thickness_m;
            let stiffness_n_m = plate_stiffness_n_m(material, thickness_m);
            Some(0.5 * side_m * side_m * (areal_kg_m2 / stiffness_n_m).sqrt())
        }
        Stock::Cushion => {
            let nu = material.poisson;
            let shear_m_s = material.rod_speed_m_s() / (2.0 * (1.0 + nu)).sqrt();
            let along_m_s = shear_m_s * ((2.0 - 2.0 * nu) / (1.0 - 2.0 * nu).max(1e-6)).sqrt();
            let slow = along_m_s.powi(-3) + 2.0 * shear_m_s.powi(-3);
            Some(4.0 * PI * side_m.powi(3) / CUSHION * hz * hz * slow)
        }
        _ => None,
    };
    per_hz(LOWEST_HZ)?;
    let edges: Vec<f64> = band_edges_hz(LOWEST_HZ, HIGHEST_HZ).collect();
    let band = |edges: &[f64]| {
        let (centre_hz, width_hz) = (0.5 * (edges[0] + edges[1]), edges[1] - edges[0]);
        let decay_per_s = material.damping().decay_per_s(centre_hz).max(SLOWEST_PER_S);
        let of_one = (shape.pa_per_m_s(TAU * centre_hz) / shape.mass_kg).powi(2) / (4.0 * decay_per_s);
        let energy = per_hz(centre_hz)? * width_hz * of_one;
        Some(DiffuseBand { centre_hz, width_hz, parts: vec![DiffusePart { energy, decay_per_s }] })
    };
    Some(Diffuse { source: SOURCE.to_owned(), bands: edges.windows(2).filter_map(band).collect() })
}
