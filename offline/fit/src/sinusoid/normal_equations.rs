//! Symmetric positive systems of a few hundred unknowns, scaled and factored block by block.
//!
//! ```text
//! A = [ A11 · ; A21 A22 ]    L11 L11ᵀ = A11    L21 L11ᵀ = A21    A22 − L21 L21ᵀ  is factored next
//! ```
//! The last product carries nearly all the work and is a matrix product, several times as fast as
//! the same sum column by column (400 unknowns: a third of the time).

use nalgebra::{Cholesky, DMatrix, DMatrixView, DVector, Dyn, SMatrix};

/// Columns factored at a time: the triangle of a block stays in the first-level cache.
const BLOCK: usize = 40;

/// A symmetric positive matrix scaled to unit diagonal and factored, with `ridge` added.
pub struct Scaled {
    factor: Cholesky<f64, Dyn>,
    scale: DVector<f64>,
}

impl Scaled {
    /// `None` when the matrix is not positive even with the ridge.
    #[must_use]
    pub fn new(gram: &DMatrix<f64>, ridge: f64) -> Option<Self> {
        let scale = gram.diagonal().map(|d| if d > 1e-280 { 1.0 / d.sqrt() } else { 0.0 });
        let mut scaled = gram.clone();
        for (j, mut column) in scaled.column_iter_mut().enumerate() {
            column.component_mul_assign(&scale);
            column *= scale[j];
            column[j] = 1.0 + ridge;
        }
        Some(Self { factor: Cholesky::pack_dirty(factored(scaled)?), scale })
    }

    /// Solves the unscaled system.
    #[must_use]
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_mul(&self.scale)).component_mul(&self.scale)
    }

    /// The `N` × `N` blocks on the diagonal of the inverse of the unscaled matrix: A⁻¹ = L⁻ᵀ L⁻¹,
    /// of which a block is the products of `N` columns of L⁻¹.
    #[must_use]
    pub fn inverse_blocks<const N: usize>(&self) -> Vec<SMatrix<f64, N, N>> {
        let inverse = inverse_of_lower(self.factor.l_dirty());
        (0..self.scale.len() / N)
            .map(|k| {
                SMatrix::from_fn(|i, j| {
                    let (a, b) = (N * k + i, N * k + j);
                    // Above the diagonal there is nothing.
                    let rows = a.max(b)..self.scale.len();
                    let product = (inverse.view_range(rows.clone(), a)).dot(&inverse.view_range(rows, b));
                    product * self.scale[a] * self.scale[b]
                })
            })
            .collect()
    }
}

/// L⁻¹ of the lower triangle of `factor`, by forward substitution of blocks of rows.
fn inverse_of_lower(factor: &DMatrix<f64>) -> DMatrix<f64> {
    let size = factor.nrows();
    let mut inverse = DMatrix::<f64>::zeros(size, size);
    for at in (0..size).step_by(BLOCK) {
        let width = BLOCK.min(size - at);
        let corner = factor.view((at, at), (width, width)).into_owned().lower_triangle();
        let mut rows = DMatrix::<f64>::zeros(width, at + width);
        rows.view_mut((0, at), (width, width)).fill_with_identity();
        if at > 0 {
            let known = inverse.view((0, 0), (at, at));
            rows.columns_mut(0, at).gemm(-1.0, &factor.view((at, 0), (width, at)), &known, 0.0);
        }
        // The corner's inverse is a small triangle; times the rows it is a product again.
        let mut small = DMatrix::<f64>::identity(width, width);
        corner.solve_lower_triangular_mut(&mut small);
        inverse.view_mut((at, 0), (width, at + width)).copy_from(&(small * rows));
    }
    inverse
}

/// The matrix with L in its lower triangle; above it stays what was there.
fn factored(mut matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    for at in (0..size).step_by(BLOCK) {
        let width = BLOCK.min(size - at);
        let corner = Cholesky::new(matrix.view((at, at), (width, width)).into_owned())?.unpack();
        matrix.view_mut((at, at), (width, width)).copy_from(&corner);
        let next = at + width;
        if next == size {
            break;
        }
        let mut below = matrix.view((next, at), (size - next, width)).into_owned();
        divide(&mut below, &corner);
        matrix.view_mut((next, at), (size - next, width)).copy_from(&below);
        // The transpose is the same numbers, read with the strides exchanged.
        let across =
            DMatrixView::from_slice_with_strides(below.as_slice(), width, size - next, size - next, 1);
        for column in (next..size).step_by(BLOCK) {
            let (wide, high) = (BLOCK.min(size - column), size - column);
            matrix.view_mut((column, column), (high, wide)).gemm(
                -1.0,
                &below.rows(column - next, high),
                &across.columns(column - next, wide),
                1.0,
            );
        }
    }
    Some(matrix)
}

/// Rows of [`divide`] at a time: with all columns of a block they stay in the first-level cache.
const PANEL: usize = 64;

/// `below` L⁻ᵀ in place, L the lower triangle of `corner`.
fn divide(below: &mut DMatrix<f64>, corner: &DMatrix<f64>) {
    let (rows, width) = below.shape();
    let values = below.as_mut_slice();
    for top in (0..rows).step_by(PANEL) {
        let part = top..(top + PANEL).min(rows);
        for j in 0..width {
            let (done, rest) = values.split_at_mut(j * rows);
            let column = &mut rest[part.clone()];
            for (i, earlier) in done.chunks_exact(rows).enumerate() {
                let factor = corner[(j, i)];
                column.iter_mut().zip(&earlier[part.clone()]).for_each(|(x, e)| *x -= factor * e);
            }
            let divisor = corner[(j, j)];
            column.iter_mut().for_each(|x| *x /= divisor);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    fn positive(size: usize) -> DMatrix<f64> {
        let mut rng = Rng::new(size as u64);
        let root = DMatrix::from_fn(size, size + 3, |_, _| rng.normal());
        &root * root.transpose()
    }

    #[test]
    fn systems_of_every_number_of_blocks_are_solved() {
        for size in [1, 4, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 3 * BLOCK + 7] {
            let matrix = positive(size);
            let truth = DVector::from_fn(size, |i, _| (i as f64).sin());
            let system = Scaled::new(&matrix, 0.0).unwrap();
            let solved = system.solve(&(&matrix * &truth));
            assert!((solved - &truth).norm() < 1e-6 * truth.norm().max(1.0), "{size}");
            let inverse = matrix.clone().try_inverse().unwrap();
            for (k, block) in system.inverse_blocks::<1>().iter().enumerate() {
                assert!((block[(0, 0)] / inverse[(k, k)] - 1.0).abs() < 1e-6, "{size}: {k}");
            }
            for (k, block) in system.inverse_blocks::<3>().iter().enumerate() {
                let expected = inverse.fixed_view::<3, 3>(3 * k, 3 * k);
                assert!((block - expected).norm() < 1e-6 * expected.norm(), "{size}: {k}");
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_is_refused() {
        let mut matrix = positive(2 * BLOCK);
        let last = 2 * BLOCK - 1;
        for i in 0..=last {
            matrix[(i, last)] = matrix[(i, 0)];
            matrix[(last, i)] = matrix[(0, i)];
        }
        matrix[(last, last)] = 0.99 * matrix[(0, 0)];
        assert!(Scaled::new(&matrix, 0.0).is_none());
    }
}
