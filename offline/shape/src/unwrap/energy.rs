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
//! a circle of the surface's area. Steps are those of limited-memory BFGS (Nocedal 1980) over the
//! positive part of the second derivatives (of an edge by its two directions, of a triangle by
//! Gauss and Newton), taken anew every few steps; each is halved until E falls, or goes half as far
//! again while E falls on. Where only short steps do, vertices are held more stiffly (Levenberg):
//! mean coordinates of a deep piece are squeezed to nothing in its middle.

use super::{Sheet, Uv, det, smooth};
use crate::error::ShapeError;
use crate::triangle_tree::area_vector;
use crate::vector::length;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Mat, Side};

/// Weight of lengths unless said.
pub const PHI: f64 = 0.2;
/// Most steps.
const MOST_STEPS: usize = 150;
/// Steps after which the second derivatives are taken anew.
const ANEW: usize = 8;
/// Part of E by which so many steps lower it when the search ends.
const ENOUGH: (f64, usize) = (1e-4, 8);

/// Stiffness that holds each vertex, and the most of it.
const HELD: (f64, f64) = (1e-9, 1.0);
/// Part of a step that is short.
const SHORT: f64 = 0.02;

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
    let (mut patterns, mut factor, mut known) = (None, None, Vec::new());
    let (mut slope, mut energies) = (problem.slope(&uv), vec![problem.energy(&uv)]);
    let mut held = HELD.0;
    while energies.len() <= MOST_STEPS {
        if known.len() % ANEW == 0 {
            known.clear();
            let (places, values) = problem.bends(&uv, held);
            if patterns.is_none() {
                let n = 2 * uv.len();
                let pattern = SymbolicSparseColMat::try_new_from_indices(n, n, &places).ok();
                patterns = pattern.and_then(|(pattern, order)| {
                    let symbolic = SymbolicLlt::try_new(pattern.as_ref(), Side::Lower).ok()?;
                    Some((pattern, order, symbolic))
                });
            }
            let (pattern, order, symbolic) = patterns.as_ref().ok_or_else(failed)?;
            let matrix = SparseColMat::new_from_argsort(pattern.clone(), order, &values);
            let matrix = matrix.map_err(|_| failed())?;
            let fresh = Llt::try_new_with_symbolic(symbolic.clone(), matrix.as_ref(), Side::Lower);
            factor = Some(fresh.map_err(|_| failed())?);
        }
        let way = way(factor.as_ref().ok_or_else(failed)?, &known, &slope);
        let energy = energies[energies.len() - 1];
        let Some((part, lower, better)) = problem.along(&uv, energy, &way) else {
            if known.is_empty() {
                if held >= HELD.1 {
                    break;
                }
                held *= 100.0;
            }
            known.clear();
            continue;
        };
        let steeper = problem.slope(&better);
        let apart = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        known.push([apart(better.as_flattened(), uv.as_flattened()), apart(&steeper, &slope)]);
        held = (held * if part < SHORT { 100.0 } else { 0.1 }).clamp(HELD.0, HELD.1);
        // A bend downwards teaches nothing.
        if part < SHORT || known.last().is_some_and(|[step, bend]| dot(step, bend) <= 0.0) {
            known.clear();
        }
        (uv, slope) = (better, steeper);
        energies.push(lower);
        let before = energies.len().checked_sub(1 + ENOUGH.1).map(|i| energies[i]);
        if before.is_some_and(|before| before - lower <= ENOUGH.0 * lower) {
            break;
        }
    }
    Ok((uv, energies[energies.len() - 1]))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Way uphill: the slope over the second derivatives, mended by known steps and what they did to
/// the slope.
fn way(factor: &Llt<usize, f64>, known: &[[Vec<f64>; 2]], slope: &[f64]) -> Vec<f64> {
    let add = |to: &mut [f64], share: f64, what: &[f64]| {
        to.iter_mut().zip(what).for_each(|(to, what)| *to += share * what);
    };
    let mut way = slope.to_vec();
    let mut shares = Vec::new();
    for [step, bend] in known.iter().rev() {
        let share = dot(step, &way) / dot(step, bend);
        add(&mut way, -share, bend);
        shares.push(share);
    }
    let mut column = Mat::from_fn(way.len(), 1, |i, _| way[i]);
    factor.solve_in_place(&mut column);
    (0..way.len()).for_each(|i| way[i] = column[(i, 0)]);
    for ([step, bend], share) in known.iter().zip(shares.into_iter().rev()) {
        let back = dot(bend, &way) / dot(step, bend);
        add(&mut way, share - back, step);
    }
    way
}

impl Problem<'_> {
    /// Part of a way that goes down furthest, the energy there, and the place; none where it rises.
    fn along(&self, uv: &[Uv], energy: f64, way: &[f64]) -> Option<(f64, f64, Vec<Uv>)> {
        let tried = |part: f64| {
            let moved = uv.iter().zip(way.as_chunks::<2>().0);
            let uv: Vec<Uv> = moved.map(|(uv, way)| [0, 1].map(|axis| uv[axis] - part * way[axis])).collect();
            (part, self.energy(&uv), uv)
        };
        let mut best = (0..30).map(|halved| tried(0.5f64.powi(halved))).find(|tried| tried.1 < energy)?;
        while best.0 >= 1.0 {
            let further = tried(1.5 * best.0);
            // What is no number does not fall either.
            if further.1 < best.1 {
                best = further;
            } else {
                break;
            }
        }
        Some(best)
    }

    fn energy(&self, uv: &[Uv]) -> f64 {
        let edges = self.sheet.edges.iter().zip(&self.lengths2);
        let edges = edges.map(|(edge, whole)| (away(uv, *edge).1 - whole).powi(2) / whole);
        let triangles = self.sheet.mesh.triangles.iter().zip(&self.areas);
        let areas = triangles.map(|(&triangle, whole)| (det(uv, triangle) - whole).powi(2) / whole);
        self.phi * edges.sum::<f64>() + (1.0 - self.phi) * areas.sum::<f64>()
    }

    /// First derivatives.
    fn slope(&self, uv: &[Uv]) -> Vec<f64> {
        let mut slope = vec![[0.0; 2]; uv.len()];
        for (&[a, b], whole) in self.sheet.edges.iter().zip(&self.lengths2) {
            let (away, square) = away(uv, [a, b]);
            for axis in 0..2 {
                let pull = 4.0 * self.phi / whole * (square - whole) * away[axis];
                slope[a as usize][axis] += pull;
                slope[b as usize][axis] -= pull;
            }
        }
        for (&triangle, whole) in self.sheet.mesh.triangles.iter().zip(&self.areas) {
            let pull = 2.0 * (1.0 - self.phi) / whole * (det(uv, triangle) - whole);
            for (corner, gradient) in triangle.iter().zip(gradients(uv, triangle)) {
                (0..2).for_each(|axis| slope[*corner as usize][axis] += pull * gradient[axis]);
            }
        }
        slope.into_flattened()
    }

    /// Positive second derivatives, below the diagonal: places, the same at every call, and values.
    fn bends(&self, uv: &[Uv], held: f64) -> (Vec<Pair<usize, usize>>, Vec<f64>) {
        let (mut places, mut values) = (Vec::new(), Vec::new());
        let mut put = |row: usize, col: usize, value: f64| {
            if row >= col {
                places.push(Pair { row, col });
                values.push(value);
            }
        };
        for (&[a, b], whole) in self.sheet.edges.iter().zip(&self.lengths2) {
            let ends = [a as usize, b as usize];
            let (away, square) = away(uv, [a, b]);
            let scale = 4.0 * self.phi / whole;
            let (along, across) = ((3.0 * square - whole).max(0.0), (square - whole).max(0.0));
            for (i, j) in (0..2).flat_map(|i| (0..2).map(move |j| (i, j))) {
                let line = if square > 0.0 { away[i] * away[j] / square } else { 0.0 };
                let unit = f64::from(u8::from(i == j));
                let value = scale * (along * line + across * (unit - line));
                for (p, q) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    put(2 * ends[p] + i, 2 * ends[q] + j, if p == q { value } else { -value });
                }
            }
        }
        for (&triangle, whole) in self.sheet.mesh.triangles.iter().zip(&self.areas) {
            let (gradient, scale) = (gradients(uv, triangle), 2.0 * (1.0 - self.phi) / whole);
            for (p, i) in (0..3).flat_map(|p| (0..2).map(move |i| (p, i))) {
                for (q, j) in (0..3).flat_map(|q| (0..2).map(move |j| (q, j))) {
                    let (row, column) = (2 * triangle[p] as usize + i, 2 * triangle[q] as usize + j);
                    put(row, column, scale * gradient[p][i] * gradient[q][j]);
                }
            }
        }
        // Moving and turning as a whole cost nothing.
        (0..2 * uv.len()).for_each(|i| put(i, i, held));
        (places, values)
    }
}

/// Vector along an edge in the plane, and its square.
fn away(uv: &[Uv], edge: [u32; 2]) -> (Uv, f64) {
    let [a, b] = edge.map(|end| uv[end as usize]);
    let away = [a[0] - b[0], a[1] - b[1]];
    (away, away[0] * away[0] + away[1] * away[1])
}

/// ∇det by each corner: the opposite edge, turned.
fn gradients(uv: &[Uv], triangle: [u32; 3]) -> [Uv; 3] {
    let corners = triangle.map(|i| uv[i as usize]);
    [0, 1, 2].map(|i| {
        let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
        [from[1] - to[1], to[0] - from[0]]
    })
}
