//! Quadratic tetrahedron: stiffness and mass of a straight-sided element with ten nodes.
//!
//! With the barycentric coordinates λ_i and their constant gradients g_i, corner nodes have N_i =
//! λ_i(2λ_i − 1) and mid-edge nodes N_ij = 4 λ_i λ_j. Stiffness couples nodes a and b by ∫ λ ∇N_a
//! ∇N_bᵀ + μ (∇N_b ∇N_aᵀ + (∇N_a·∇N_b) 1) dV, which the four-point rule integrates exactly because
//! gradients are linear; mass by ρ ∫ N_a N_b dV from ∫ Π λ_i^e_i dV = 6 V Π e_i! / (Σ e_i + 3)!.
//! Source: Zienkiewicz & Taylor, The Finite Element Method, vol. 1, ch. 4 and 6. Linear tetrahedra
//! lock in bending and are not offered.

use crate::elastic::Elastic;
use crate::vector::{Vec3, cross, dot, sub};
use crate::volume_mesh::{EDGES, tet_volume_m3};

/// Nodes of an element.
pub const NODES: usize = 10;

/// Stiffness of one element, N/m: a 3 × 3 block for each pair of nodes.
pub type ElementStiffness = [[[[f64; 3]; 3]; NODES]; NODES];

/// Gradients of the four barycentric coordinates, 1/m, and the volume, m³.
fn gradients(corners: [Vec3; 4]) -> ([Vec3; 4], f64) {
    let volume_m3 = tet_volume_m3(corners);
    let [a, b, c, d] = corners;
    let (ab, ac, ad) = (sub(b, a), sub(c, a), sub(d, a));
    let scaled = |v: Vec3| v.map(|x| x / (6.0 * volume_m3));
    let (gb, gc, gd) = (scaled(cross(ac, ad)), scaled(cross(ad, ab)), scaled(cross(ab, ac)));
    let ga = std::array::from_fn(|i| -gb[i] - gc[i] - gd[i]);
    ([ga, gb, gc, gd], volume_m3)
}

/// Gradients of the ten shape functions where the barycentric coordinates are `at`.
fn shape_gradients(g: &[Vec3; 4], at: [f64; 4]) -> [Vec3; NODES] {
    std::array::from_fn(|n| {
        if n < 4 {
            g[n].map(|x| (4.0 * at[n] - 1.0) * x)
        } else {
            let [i, j] = EDGES[n - 4];
            std::array::from_fn(|c| 4.0 * (at[i] * g[j][c] + at[j] * g[i][c]))
        }
    })
}

/// Stiffness of a tetrahedron of the material.
#[must_use]
pub fn stiffness(corners: [Vec3; 4], material: &Elastic) -> ElementStiffness {
    let (g, volume_m3) = gradients(corners);
    let (lambda, mu) = material.lame_pa();
    // The four points of the rule that is exact for degree 2.
    let (near, far) = ((5.0 + 3.0 * 5.0_f64.sqrt()) / 20.0, (5.0 - 5.0_f64.sqrt()) / 20.0);
    let mut k = [[[[0.0; 3]; 3]; NODES]; NODES];
    for point in 0..4 {
        let mut at = [far; 4];
        at[point] = near;
        let gradient = shape_gradients(&g, at);
        let weight = volume_m3 / 4.0;
        for a in 0..NODES {
            for b in a..NODES {
                let (ga, gb) = (gradient[a], gradient[b]);
                let shear = mu * dot(ga, gb);
                for i in 0..3 {
                    for j in 0..3 {
                        let diagonal = if i == j { shear } else { 0.0 };
                        k[a][b][i][j] += weight * (lambda * ga[i] * gb[j] + mu * gb[i] * ga[j] + diagonal);
                    }
                }
            }
        }
    }
    let upper = k;
    for (a, row) in k.iter_mut().enumerate() {
        for (b, block) in row.iter_mut().enumerate().take(a) {
            *block = std::array::from_fn(|i| std::array::from_fn(|j| upper[b][a][j][i]));
        }
    }
    k
}

/// Mass of two nodes of an element over its mass, times 420.
#[must_use]
pub fn mass_share_420(a: usize, b: usize) -> f64 {
    match (a.checked_sub(4), b.checked_sub(4)) {
        (None, None) => {
            if a == b {
                6.0
            } else {
                1.0
            }
        }
        (None, Some(edge)) | (Some(edge), None) => {
            if EDGES[edge].contains(&a.min(b)) {
                -4.0
            } else {
                -6.0
            }
        }
        (Some(e), Some(f)) if e == f => 32.0,
        (Some(e), Some(f)) if EDGES[e].iter().any(|i| EDGES[f].contains(i)) => 16.0,
        _ => 8.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Vec3; 4] = [[0.1, 0.0, 0.0], [1.3, 0.1, -0.2], [0.2, 1.1, 0.3], [0.0, -0.1, 0.9]];
    const STEEL: Elastic = Elastic { young_pa: 200e9, poisson: 0.29, density_kg_m3: 7850.0 };

    /// Places of the ten nodes.
    fn nodes() -> [Vec3; NODES] {
        std::array::from_fn(|n| {
            if n < 4 {
                CORNERS[n]
            } else {
                let [i, j] = EDGES[n - 4];
                std::array::from_fn(|c| 0.5 * (CORNERS[i][c] + CORNERS[j][c]))
            }
        })
    }

    fn energy_j(k: &ElementStiffness, u: &[Vec3; NODES]) -> f64 {
        let mut sum = 0.0;
        for a in 0..NODES {
            for b in 0..NODES {
                for i in 0..3 {
                    for j in 0..3 {
                        sum += 0.5 * u[a][i] * k[a][b][i][j] * u[b][j];
                    }
                }
            }
        }
        sum
    }

    #[test]
    fn turning_and_shifting_an_element_costs_no_energy() {
        let k = stiffness(CORNERS, &STEEL);
        let turned = nodes().map(|p| [0.3 - 0.2 * p[1], 0.2 * p[0] - 0.7 * p[2], 0.7 * p[1] + 1.0]);
        let stretched = nodes().map(|p| [0.2 * p[0], 0.0, 0.0]);
        assert!(energy_j(&k, &turned).abs() < 1e-12 * energy_j(&k, &stretched));
    }

    #[test]
    fn a_linear_strain_stores_what_the_closed_integral_says() {
        // u = (x², 0, 0)/2 has the strain ε_xx = x alone: energy = (λ/2 + μ) ∫ x² dV.
        let k = stiffness(CORNERS, &STEEL);
        let u = nodes().map(|p| [0.5 * p[0] * p[0], 0.0, 0.0]);
        let (lambda, mu) = STEEL.lame_pa();
        let x = CORNERS.map(|p| p[0]);
        let sum: f64 = x.iter().sum();
        let squares: f64 = x.iter().map(|x| x * x).sum();
        let integral = tet_volume_m3(CORNERS) * (sum * sum + squares) / 20.0;
        let expected = (0.5 * lambda + mu) * integral;
        assert!((energy_j(&k, &u) / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_mass_of_a_quadratic_motion_is_the_closed_integral() {
        // ∫ (λ₀ λ₁)² dV = 6 V · 2!·2!/7! = V/210; λ₀λ₁ is a quarter of the shape function of edge
        // 0–1.
        assert!((mass_share_420(4, 4) / 420.0 / 16.0 - 1.0 / 210.0).abs() < 1e-15);
        let total: f64 = (0..NODES).flat_map(|a| (0..NODES).map(move |b| mass_share_420(a, b))).sum();
        assert_eq!(total, 420.0);
    }
}
