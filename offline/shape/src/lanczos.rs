//! Shift-invert block Lanczos: the lowest modes of K φ = ω² M φ.
//!
//! The operator A = (K − σM)⁻¹ M has the eigenvalues θ = 1/(ω² − σ), largest for the lowest modes,
//! and is symmetric in the inner product of M. Blocks of several vectors find modes that coincide;
//! every new block is made orthogonal to the whole basis, twice, so the projection H = Vᵀ M A V is
//! exact to rounding (Grimes, Lewis & Simon 1994). The six rigid motions are known and kept out
//! from the beginning.

use crate::error::ShapeError;
use crate::factor::Factor;
use crate::system::System;
use faer::dyn_stack::MemBuffer;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par, Side};

/// Vectors a block: modes that coincide come in twos and threes, on a ball in fives and sevens, of
/// which rounding and the count of modes find the rest.
const BLOCK: usize = 4;
/// A mode is found when its residual is below this part of its θ.
const CONVERGED: f64 = 1e-10;

/// The Krylov basis and its projection, which can be made longer until every mode is found.
pub struct Lanczos<'a> {
    system: &'a System,
    factor: &'a Factor<'a>,
    scratch: MemBuffer,
    rigid: Mat<f64>,
    /// Orthonormal in M, `used` columns so far.
    basis: Mat<f64>,
    used: usize,
    /// Columns of H = Vᵀ M A V from the top to their block.
    projection: Vec<Vec<f64>>,
    /// Coupling of the last block to the next one.
    coupling: Mat<f64>,
    seed: u64,
}

/// Ritz values θ, largest first, with their vectors in the basis and their residuals.
pub struct Ritz {
    /// 1/(ω² − σ), s².
    pub theta: Vec<f64>,
    /// Columns: coefficients of the basis.
    pub vectors: Mat<f64>,
    /// True for each that has converged.
    pub converged: Vec<bool>,
}

impl<'a> Lanczos<'a> {
    /// Begins with a block of random motions.
    ///
    /// # Errors
    /// When memory runs out.
    pub fn new(system: &'a System, factor: &'a Factor<'a>) -> Result<Self, ShapeError> {
        let rigid = rigid_motions(system);
        let n = system.unknowns();
        let mut this = Self {
            system,
            factor,
            scratch: factor.scratch(BLOCK)?,
            rigid,
            basis: Mat::zeros(n, 0),
            used: 0,
            projection: Vec::new(),
            coupling: Mat::zeros(BLOCK, BLOCK),
            seed: 0x2545_F491_4F6C_DD1D,
        };
        let start = this.random_block();
        let _ = this.append(start);
        Ok(this)
    }

    /// Vectors in the basis.
    pub fn len(&self) -> usize {
        self.used
    }

    /// Adds the next block: A times the last one, made orthogonal to all before.
    pub fn step(&mut self) {
        let first = self.used - BLOCK;
        let mut block = Mat::zeros(self.system.unknowns(), BLOCK);
        for j in 0..BLOCK {
            self.system.times_mass(self.basis.col_as_slice(first + j), block.col_as_slice_mut(j));
        }
        self.factor.solve(block.as_mut(), &mut self.scratch);
        let (coefficients, coupling) = self.append(block);
        for j in 0..BLOCK {
            self.projection.push(coefficients.col_as_slice(j).to_vec());
        }
        self.coupling = coupling;
    }

    /// The modes as the basis has them.
    ///
    /// # Errors
    /// When the small eigenvalue problem does not converge.
    pub fn ritz(&self) -> Result<Ritz, ShapeError> {
        let m = self.projection.len();
        // Brought to about 1: the library's eigenvalues of a matrix of 1e-13 come out wrong.
        let scale = self.projection.first().map_or(1.0, |column| column[0].abs());
        let h = Mat::from_fn(m, m, |i, j| {
            let (i, j) = (i.min(j), i.max(j));
            self.projection[j].get(i).map_or(0.0, |x| x / scale)
        });
        let eigen = h.self_adjoint_eigen(Side::Upper).map_err(|error| {
            ShapeError::new("", format!("the eigenvalues do not settle ({error:?})"), "mesh it anew")
        })?;
        let values = eigen.S().column_vector();
        let order: Vec<usize> = (0..m).rev().collect();
        let vectors = Mat::from_fn(m, m, |i, j| eigen.U()[(i, order[j])]);
        let theta: Vec<f64> = order.iter().map(|&i| values[i] * scale).collect();
        let converged = (0..m)
            .map(|j| {
                let last = |b: usize| vectors[(m - BLOCK + b, j)];
                let residual: f64 = (0..BLOCK)
                    .map(|a| (0..BLOCK).map(|b| self.coupling[(a, b)] * last(b)).sum::<f64>().powi(2))
                    .sum();
                residual.sqrt() <= CONVERGED * theta[j].abs()
            })
            .collect();
        Ok(Ritz { theta, vectors, converged })
    }

    /// The first `count` Ritz vectors as motions of the nodes, mass-normalised.
    ///
    /// Each is V s + W C s_last / θ with the block W that follows the basis, which is A V s / θ:
    /// one more inverse iteration at the cost of a product (Nour-Omid, Parlett, Ericsson & Jensen
    /// 1987). It takes the fast waves out of what is left.
    pub fn motions(&self, ritz: &Ritz, count: usize) -> Mat<f64> {
        let m = ritz.theta.len();
        let mut motions = Mat::zeros(self.system.unknowns(), count);
        let with_next = Mat::from_fn(m + BLOCK, count, |i, j| match i.checked_sub(m) {
            None => ritz.vectors[(i, j)],
            Some(a) => {
                let coupled = |b: usize| self.coupling[(a, b)] * ritz.vectors[(m - BLOCK + b, j)];
                (0..BLOCK).map(coupled).sum::<f64>() / ritz.theta[j]
            }
        });
        let basis = self.vectors(m + BLOCK);
        matmul(motions.as_mut(), Accum::Replace, basis, with_next.as_ref(), 1.0, Par::Seq);
        motions
    }

    fn vectors(&self, count: usize) -> MatRef<'_, f64> {
        self.basis.as_ref().subcols(0, count)
    }

    /// Adds a block, made orthonormal; gives C and R of block = V C + W R, where W is what was
    /// added to the basis V.
    ///
    /// Orthogonal to the basis, then in itself, and both again: where the columns of a block have
    /// become alike, taking them apart brings back what the first pass has taken away.
    fn append(&mut self, mut block: Mat<f64>) -> (Mat<f64>, Mat<f64>) {
        let n = self.system.unknowns();
        if self.basis.ncols() < self.used + BLOCK {
            self.basis.resize_with(n, self.used + 8 * BLOCK, |_, _| 0.0);
        }
        let mut coefficients = self.make_orthogonal(&mut block);
        let mut coupling = self.make_orthonormal(&mut block);
        coefficients += self.make_orthogonal(&mut block) * &coupling;
        coupling = self.make_orthonormal(&mut block) * coupling;
        for j in 0..BLOCK {
            self.basis.col_as_slice_mut(self.used + j).copy_from_slice(block.col_as_slice(j));
        }
        self.used += BLOCK;
        (coefficients, coupling)
    }

    /// Makes a block orthogonal to rigid motions and basis; gives its coefficients in the basis.
    fn make_orthogonal(&self, block: &mut Mat<f64>) -> Mat<f64> {
        let columns = block.ncols();
        let mut weighted = Mat::zeros(block.nrows(), columns);
        for j in 0..columns {
            self.system.times_mass(block.col_as_slice(j), weighted.col_as_slice_mut(j));
        }
        let [_, coefficients] = [self.rigid.as_ref(), self.vectors(self.used)].map(|against| {
            let mut c = Mat::zeros(against.ncols(), columns);
            matmul(c.as_mut(), Accum::Replace, against.transpose(), weighted.as_ref(), 1.0, Par::Seq);
            matmul(block.as_mut(), Accum::Add, against, c.as_ref(), -1.0, Par::Seq);
            c
        });
        coefficients
    }

    /// Makes the columns of a block orthonormal; gives the triangle R of block = W R.
    fn make_orthonormal(&mut self, block: &mut Mat<f64>) -> Mat<f64> {
        let mut r = Mat::zeros(BLOCK, BLOCK);
        let mut weighted = vec![0.0; self.system.unknowns()];
        // M times the columns that are done, which is dearer than a product of two vectors.
        let mut done: Vec<Vec<f64>> = Vec::with_capacity(BLOCK);
        for j in 0..BLOCK {
            let mut column = block.col_as_slice(j).to_vec();
            let begun = self.norm(&column, &mut weighted);
            for (i, heavy) in done.iter().enumerate() {
                let c: f64 = column.iter().zip(heavy).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(block.col_as_slice(i)).for_each(|(x, v)| *x -= c * v);
                r[(i, j)] = c;
            }
            let mut norm = self.norm(&column, &mut weighted);
            r[(j, j)] = norm;
            if norm <= 1e-13 * begun || begun == 0.0 {
                // Nothing new in this direction: another one takes its place, without coupling.
                r[(j, j)] = 0.0;
                column = self.random_block().col_as_slice(j).to_vec();
                norm = self.norm(&column, &mut weighted);
            }
            block.col_as_slice_mut(j).iter_mut().zip(&column).for_each(|(t, x)| *t = x / norm);
            done.push(weighted.iter().map(|x| x / norm).collect());
        }
        r
    }

    fn norm(&self, v: &[f64], weighted: &mut [f64]) -> f64 {
        self.system.times_mass(v, weighted);
        v.iter().zip(weighted.iter()).map(|(a, b)| a * b).sum::<f64>().max(0.0).sqrt()
    }

    /// Random motions, orthogonal to the basis; the same in every run.
    fn random_block(&mut self) -> Mat<f64> {
        let mut block = Mat::from_fn(self.system.unknowns(), BLOCK, |_, _| {
            self.seed ^= self.seed << 13;
            self.seed ^= self.seed >> 7;
            self.seed ^= self.seed << 17;
            (self.seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        });
        self.make_orthogonal(&mut block);
        block
    }
}

/// Three shifts and three turns, orthonormal in M.
fn rigid_motions(system: &System) -> Mat<f64> {
    let n = system.unknowns();
    let count = system.nodes.len() as f64;
    let centre: [f64; 3] = std::array::from_fn(|c| system.nodes.iter().map(|p| p[c]).sum::<f64>() / count);
    let mut motions: Mat<f64> = Mat::zeros(n, 6);
    for (node, point) in system.nodes.iter().enumerate() {
        let at: [f64; 3] = std::array::from_fn(|c| point[c] - centre[c]);
        for c in 0..3 {
            motions[(3 * node + c, c)] = 1.0;
            let (i, j) = ((c + 1) % 3, (c + 2) % 3);
            motions[(3 * node + j, 3 + c)] = at[i];
            motions[(3 * node + i, 3 + c)] = -at[j];
        }
    }
    let mut weighted = vec![0.0; n];
    for j in 0..6 {
        for _ in 0..2 {
            for i in 0..j {
                let other = motions.col_as_slice(i).to_vec();
                system.times_mass(&other, &mut weighted);
                let column = motions.col_as_slice_mut(j);
                let c: f64 = column.iter().zip(&weighted).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(&other).for_each(|(x, o)| *x -= c * o);
            }
        }
        let column = motions.col_as_slice_mut(j);
        system.times_mass(column, &mut weighted);
        let norm = column.iter().zip(&weighted).map(|(a, b)| a * b).sum::<f64>().sqrt();
        column.iter_mut().for_each(|x| *x /= norm);
    }
    motions
}
