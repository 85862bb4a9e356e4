//! Coordinates of least change of lengths and areas.
//!
//! ```text
//! E = φ Σ_edges (d² − D²)²/D² + (1 − φ) Σ_triangles (det − A)²/A
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | d, D | length of an edge in the plane and on the surface, each edge once |
//! | det, A | twice the area of a triangle in the plane, with its sign, and on the surface |
//! | φ | weight of lengths, [`PHI`] unless said |
//!
//! A large φ turns triangles over by itself: lengths know no side. Begun from mean coordinates on
//! a circle of the surface's area; each step solves with the positive part of the second
//! derivatives (of an edge by its two directions, of a triangle by Gauss and Newton) and is halved
//! until E falls, or goes half as far again while E falls on: where E is flat such steps are short.

use super::{Sheet, Uv, det, smooth};
use crate::error::ShapeError;
use crate::triangle_tree::area_vector;
use crate::vector::length;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

/// Weight of lengths unless said.
pub const PHI: f64 = 0.2;
/// Most steps.
const MOST_STEPS: usize = 80;
/// Part of E by which a step lowers it when the search ends.
const ENOUGH: f64 = 1e-5;

struct Problem<'a> {
    sheet: &'a Sheet<'a>,
    phi: f64,
    /// D² of each edge.
    lengths2: Vec<f64>,
    /// A of each triangle.
    areas: Vec<f64>,
}

/// The coordinates, and E, m².
pub(super) fn solve(sheet: &Sheet<'_>, phi: f64) -> Result<(Vec<Uv>, f64), ShapeError> {
    let lengths2 = sheet.edges.iter().map(|&edge| sheet.length_m(edge).powi(2)).collect();
    let areas: Vec<f64> =
        sheet.mesh.all_corners().into_iter().map(|t| 2.0 * length(area_vector(t))).collect();
    let mut uv = smooth::solve(sheet, smooth::Rows::Inside)?;
    let flat: f64 = sheet.mesh.triangles.iter().map(|&triangle| det(&uv, triangle)).sum();
    let scale = (areas.iter().sum::<f64>() / flat.max(f64::MIN_POSITIVE)).sqrt();
    uv.iter_mut().for_each(|uv| *uv = uv.map(|x| scale * x));
    let problem = Problem { sheet, phi, lengths2, areas };
    let failed =
        || ShapeError::new("--unwrap", "the least energy cannot be solved for", "mend the mesh first");
    let (mut energy, mut symbolic) = (problem.energy(&uv), None);
    for _ in 0..MOST_STEPS {
        let (matrix, mut step) = problem.system(&uv).ok_or_else(failed)?;
        let symbolic = match &symbolic {
            Some(known) => known,
            None => {
                symbolic.insert(SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).map_err(|_| failed())?)
            }
        };
        let factor = Llt::try_new_with_symbolic(symbolic.clone(), matrix.as_ref(), Side::Lower)
            .map_err(|_| failed())?;
        factor.solve_in_place(&mut step);
        let moved = |part: f64| -> Vec<Uv> {
            uv.iter()
                .enumerate()
                .map(|(i, uv)| [0, 1].map(|axis| uv[axis] - part * step[(2 * i + axis, 0)]))
                .collect()
        };
        let tried = |part: f64| {
            let uv = moved(part);
            (part, problem.energy(&uv), uv)
        };
        let mut parts = (0..30).map(|halved| tried(0.5f64.powi(halved)));
        let Some(mut best) = parts.find(|(_, tried, _)| *tried < energy) else { break };
        while best.0 >= 1.0 {
            let further = tried(1.5 * best.0);
            // What is no number does not fall either.
            if further.1 < best.1 {
                best = further;
            } else {
                break;
            }
        }
        let (_, lower, better) = best;
        let done = energy - lower <= ENOUGH * energy;
        (energy, uv) = (lower, better);
        if done {
            break;
        }
    }
    Ok((uv, energy))
}

impl Problem<'_> {
    fn energy(&self, uv: &[Uv]) -> f64 {
        let edges = self.sheet.edges.iter().zip(&self.lengths2).map(|(edge, whole)| {
            let [a, b] = edge.map(|i| uv[i as usize]);
            ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) - whole).powi(2) / whole
        });
        let triangles = self.sheet.mesh.triangles.iter().zip(&self.areas);
        let areas = triangles.map(|(&triangle, whole)| (det(uv, triangle) - whole).powi(2) / whole);
        self.phi * edges.sum::<f64>() + (1.0 - self.phi) * areas.sum::<f64>()
    }

    /// The positive second derivatives, below the diagonal, and the first ones.
    fn system(&self, uv: &[Uv]) -> Option<(SparseColMat<usize, f64>, Mat<f64>)> {
        let n = 2 * uv.len();
        let (mut slope, mut triplets) = (Mat::<f64>::zeros(n, 1), Vec::new());
        let mut put = |row: usize, column: usize, value: f64| {
            if row >= column {
                triplets.push(Triplet::new(row, column, value));
            }
        };
        for (&[a, b], whole) in self.sheet.edges.iter().zip(&self.lengths2) {
            let ends = [a as usize, b as usize];
            let away = [0, 1].map(|axis| uv[ends[0]][axis] - uv[ends[1]][axis]);
            let square = away[0] * away[0] + away[1] * away[1];
            let scale = 4.0 * self.phi / whole;
            let (along, across) = ((3.0 * square - whole).max(0.0), (square - whole).max(0.0));
            for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
                let line = if square > 0.0 { away[i] * away[j] / square } else { 0.0 };
                let unit = f64::from(u8::from(i == j));
                let value = scale * (along * line + across * (unit - line));
                for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    put(2 * ends[p] + i, 2 * ends[q] + j, if p == q { value } else { -value });
                }
                if j == 0 {
                    let pull = scale * (square - whole) * away[i];
                    slope[(2 * ends[0] + i, 0)] += pull;
                    slope[(2 * ends[1] + i, 0)] -= pull;
                }
            }
        }
        for (&triangle, whole) in self.sheet.mesh.triangles.iter().zip(&self.areas) {
            let corners = triangle.map(|i| uv[i as usize]);
            // ∇det by each corner: the opposite edge, turned.
            let turned = |i: usize| {
                let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                [from[1] - to[1], to[0] - from[0]]
            };
            let gradient = [turned(0), turned(1), turned(2)];
            let scale = 2.0 * (1.0 - self.phi) / whole;
            let off = det(uv, triangle) - whole;
            for (p, i) in (0..3).flat_map(|p| (0..2).map(move |i| (p, i))) {
                slope[(2 * triangle[p] as usize + i, 0)] += scale * off * gradient[p][i];
                for (q, j) in (0..3).flat_map(|q| (0..2).map(move |j| (q, j))) {
                    let (row, column) = (2 * triangle[p] as usize + i, 2 * triangle[q] as usize + j);
                    put(row, column, scale * gradient[p][i] * gradient[q][j]);
                }
            }
        }
        // Moving and turning as a whole cost nothing; the smallest stiffness holds them.
        (0..n).for_each(|i| put(i, i, 1e-9));
        let matrix = SparseColMat::try_new_from_triplets(n, n, &triplets).ok()?;
        Some((matrix, slope))
    }
}
