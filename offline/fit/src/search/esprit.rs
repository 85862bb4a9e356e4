//! Poles of one band by ESPRIT (Roy & Kailath 1989): the shift of the signal subspace.
//!
//! ```text
//! H[i, m] = y[i + m]   (L × M)         H Hᴴ = U S² Uᴴ         U↑ Φ = U↓         poles = eig Φ
//! ```
//! No singular value decomposition: H Hᴴ of a Hankel matrix costs O(L²) by its recurrence down the
//! diagonals, and its eigenvectors are the left singular vectors (a dynamic range of 1e7 in
//! amplitude remains, far beyond a band's). Φ in closed form, because U↑ᴴ U↑ = I − u uᴴ with u the
//! last row of U.

use crate::search::model_order::order;
use crate::sinusoid::geometric_sum::geometric_sums;
use nalgebra::{Cholesky, Complex, DMatrix, DVector, Schur, SymmetricEigen};

type C = Complex<f64>;

/// Share of the window that is the height of the Hankel matrix, and its largest height: a higher
/// one costs the cube of it and tells no more modes of one band apart that a joint fit would keep.
const HEIGHT: f64 = 0.4;
const HIGHEST: usize = 40;

/// The left singular vectors of a band's Hankel matrix.
struct Subspace {
    vectors: DMatrix<C>,
    /// Columns of `vectors`, and squared singular values, strongest first.
    ranked: Vec<usize>,
    squares: Vec<f64>,
    columns: usize,
}

impl Subspace {
    fn of(band: &[C]) -> Option<Self> {
        let rows = ((HEIGHT * band.len() as f64) as usize).min(HIGHEST);
        if rows < 3 {
            return None;
        }
        let columns = band.len() - rows + 1;
        let eigen = SymmetricEigen::try_new(hankel_gram(band, rows, columns), 1e-14, 60 * rows)?;
        let mut ranked: Vec<usize> = (0..rows).collect();
        ranked.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let squares = ranked.iter().map(|&i| eigen.eigenvalues[i]).collect();
        Some(Self { vectors: eigen.eigenvectors, ranked, squares, columns })
    }

    fn order(&self, noise_std: f64) -> usize {
        order(&self.squares, self.ranked.len(), self.columns, noise_std)
    }
}

/// Number of singular values of `band` above the noise's edge.
#[must_use]
pub fn band_order(band: &[C], noise_std: f64) -> usize {
    Subspace::of(band).map_or(0, |subspace| subspace.order(noise_std))
}

/// The poles of `band` per decimated sample, those within the noise or below `least_share` of the
/// strongest left out.
#[must_use]
pub fn poles(band: &[C], noise_std: f64, least_share: f64) -> Vec<C> {
    let Some(subspace) = Subspace::of(band) else { return Vec::new() };
    let (rows, squares) = (subspace.ranked.len(), &subspace.squares);
    let strong = squares.iter().take_while(|&&s| s > least_share * least_share * squares[0]).count();
    let order = subspace.order(noise_std).min(strong).min(rows - 2);
    if order == 0 {
        return Vec::new();
    }
    let basis = DMatrix::from_fn(rows, order, |i, j| subspace.vectors[(i, subspace.ranked[j])]);
    shift_eigenvalues(&basis)
}

/// Energy of every pole in `band`: least-squares amplitudes of all of them, squared and summed over
/// the window. Says which poles of many bands matter; infinite when the poles cannot be told apart.
#[must_use]
pub fn energies(band: &[C], poles: &[C]) -> Vec<f64> {
    let count = band.len();
    let powers: Vec<C> = poles.iter().map(|z| z.powu(count as u32)).collect();
    let sum = |i: usize, j: usize| {
        geometric_sums(poles[i].conj() * poles[j], powers[i].conj() * powers[j], count)[0]
    };
    let gram =
        DMatrix::from_fn(poles.len(), poles.len(), |i, j| sum(i, j) * if i == j { 1.0 + 1e-10 } else { 1.0 });
    let right = DVector::from_iterator(
        poles.len(),
        poles.iter().map(|z| band.iter().rev().fold(C::new(0.0, 0.0), |sum, y| sum * z.conj() + y)),
    );
    let lengths: Vec<f64> = gram.diagonal().iter().map(|d| d.re).collect();
    let Some(factor) = Cholesky::new(gram) else { return vec![f64::INFINITY; poles.len()] };
    factor.solve(&right).iter().zip(lengths).map(|(b, length)| b.norm_sqr() * length).collect()
}

/// H Hᴴ.
fn hankel_gram(y: &[C], rows: usize, columns: usize) -> DMatrix<C> {
    let mut gram = DMatrix::zeros(rows, rows);
    for lag in 0..rows {
        let mut sum: C = (0..columns).map(|m| y[lag + m] * y[m].conj()).sum();
        for j in 0..rows - lag {
            let i = j + lag;
            gram[(i, j)] = sum;
            gram[(j, i)] = sum.conj();
            if i + columns < y.len() {
                sum += y[i + columns] * y[j + columns].conj() - y[i] * y[j].conj();
            }
        }
    }
    gram
}

/// Eigenvalues of the least-squares Φ of U↑ Φ = U↓.
fn shift_eigenvalues(basis: &DMatrix<C>) -> Vec<C> {
    let rows = basis.nrows();
    let upper = basis.rows(0, rows - 1);
    let cross = upper.adjoint() * basis.rows(1, rows - 1);
    let last = basis.row(rows - 1).adjoint();
    let rest = 1.0 - last.norm_squared();
    if rest < 1e-9 {
        return Vec::new();
    }
    let correction = (last.adjoint() * &cross).map(|v| v / rest);
    let shift = cross + last * correction;
    let Some(schur) = Schur::try_new(shift, 1e-13, 200 * basis.ncols().max(4)) else {
        return Vec::new();
    };
    schur.unpack().1.diagonal().iter().copied().filter(|z| z.re.is_finite() && z.im.is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_of_a_noiseless_sum_come_back() {
        let truth = [C::from_polar(0.99, 0.3), C::from_polar(0.98, 0.35), C::from_polar(0.9, -1.2)];
        let band: Vec<C> = (0..120)
            .map(|m| truth.iter().enumerate().map(|(k, z)| z.powu(m) * (1.0 + k as f64)).sum())
            .collect();
        let found = poles(&band, 1e-5, 0.0);
        assert_eq!(found.len(), 3, "{found:?}");
        for z in truth {
            assert!(found.iter().any(|f| (f - z).norm() < 1e-6), "{z} {found:?}");
        }
    }

    #[test]
    fn silence_has_no_poles() {
        assert!(poles(&[C::new(0.0, 0.0); 100], 1e-6, 0.0).is_empty());
        assert!(poles(&[C::new(0.0, 0.0); 4], 1e-6, 0.0).is_empty());
    }
}
