//! Smooth coordinates.
//!
//! ```text
//! R = Σ_k Σ_ν ( Σ_{i ∈ N(k) ∪ {k}} c(i, k) ν_i )²        c(i, k) = 1, c(k, k) = −grad(k)        ν = u, v
//! ```
//! The rim lies on a circle as long as it, by its own arc length. What we changed: equation 4.25
//! has ν_k inside the sum, which makes R depend on the degrees of the vertices alone; ν_i is meant,
//! as in 4.24. The conditions of angles and lengths (4.28–4.38) are left to [`super::energy`].

use super::{Sheet, Uv};
use crate::error::ShapeError;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use std::f64::consts::TAU;

/// Vertices whose sum is squared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rows {
    /// All, as the equation has it.
    All,
    /// Vertices inside: each is then the mean of its neighbours, and nothing is turned over.
    Inside,
}

/// Neighbours of each vertex.
fn neighbours(sheet: &Sheet<'_>) -> Vec<Vec<u32>> {
    let mut of = vec![Vec::new(); sheet.mesh.points.len()];
    for &[a, b] in &sheet.edges {
        of[a as usize].push(b);
        of[b as usize].push(a);
    }
    of
}

/// R, m².
pub(super) fn roughness(sheet: &Sheet<'_>, uv: &[Uv]) -> f64 {
    let each = neighbours(sheet).into_iter().enumerate().map(|(k, near)| {
        let sum = |axis: usize| near.iter().map(|&i| uv[i as usize][axis] - uv[k][axis]).sum::<f64>();
        sum(0).powi(2) + sum(1).powi(2)
    });
    each.sum()
}

/// The coordinates of least R.
pub(super) fn solve(sheet: &Sheet<'_>, rows: Rows) -> Result<Vec<Uv>, ShapeError> {
    let mut uv = vec![[0.0; 2]; sheet.mesh.points.len()];
    let mut inside = vec![u32::MAX; uv.len()];
    hold_rim(sheet, &mut uv);
    let is_rim = {
        let mut is_rim = vec![false; uv.len()];
        sheet.rim.iter().for_each(|&i| is_rim[i as usize] = true);
        is_rim
    };
    let mut count = 0;
    for (_, number) in inside.iter_mut().enumerate().filter(|(i, _)| !is_rim[*i]) {
        *number = count;
        count += 1;
    }
    if count == 0 {
        return Ok(uv);
    }
    let (near, mut right) = (neighbours(sheet), Mat::<f64>::zeros(count as usize, 2));
    let mut triplets = Vec::new();
    for (k, near) in near.iter().enumerate().filter(|(k, _)| rows == Rows::All || !is_rim[*k]) {
        let row: Vec<(usize, f64)> =
            near.iter().map(|&i| (i as usize, 1.0)).chain([(k, -(near.len() as f64))]).collect();
        let held = [0, 1]
            .map(|axis| row.iter().filter(|(i, _)| is_rim[*i]).map(|(i, c)| c * uv[*i][axis]).sum::<f64>());
        for &(i, ci) in row.iter().filter(|(i, _)| !is_rim[*i]) {
            for axis in 0..2 {
                right[(inside[i] as usize, axis)] -= ci * held[axis];
            }
            for &(j, cj) in row.iter().filter(|(j, _)| !is_rim[*j] && inside[*j] <= inside[i]) {
                triplets.push(Triplet::new(inside[i] as usize, inside[j] as usize, ci * cj));
            }
        }
    }
    let failed =
        || ShapeError::new("--unwrap", "the smooth coordinates cannot be solved for", "mend the mesh first");
    let n = count as usize;
    let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &triplets).map_err(|_| failed())?;
    let factor = matrix.sp_cholesky(Side::Lower).map_err(|_| failed())?;
    factor.solve_in_place(&mut right);
    for (i, uv) in uv.iter_mut().enumerate().filter(|(i, _)| !is_rim[*i]) {
        *uv = [0, 1].map(|axis| right[(inside[i] as usize, axis)]);
    }
    Ok(uv)
}

/// Puts the rim on its circle, counter-clockwise.
fn hold_rim(sheet: &Sheet<'_>, uv: &mut [Uv]) {
    let rim = &sheet.rim;
    let steps: Vec<f64> =
        (0..rim.len()).map(|n| sheet.length_m([rim[n], rim[(n + 1) % rim.len()]])).collect();
    let whole: f64 = steps.iter().sum();
    let (radius, mut way) = (whole / TAU, 0.0);
    for (&vertex, step) in rim.iter().zip(steps) {
        let angle = TAU * way / whole;
        uv[vertex as usize] = [radius * angle.cos(), radius * angle.sin()];
        way += step;
    }
}
