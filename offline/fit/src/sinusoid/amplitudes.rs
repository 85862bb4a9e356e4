//! Linear least squares of the complex amplitudes when the poles are known.
//!
//! The columns are Re zⁿ and −Im zⁿ, so the normal equations are the (Re c, Im c) rows of the joint
//! Gram matrix, again without touching samples; the right side is one pass over the signal.

use crate::sinusoid::geometric_sum::geometric_sums;
use crate::sinusoid::normal_equations::Scaled;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::correlate_values;
use nalgebra::{Complex, DMatrix, DVector, Vector2};

/// Relative weight of keeping amplitudes small: decides between modes that coincide to rounding.
const RIDGE: f64 = 1e-11;

/// Sets every `c` to the least-squares amplitude at `signal[0]`.
pub fn fit_amplitudes(signal: &[f64], partials: &mut [Partial]) {
    fit_amplitudes_at_cost(signal, partials, RIDGE);
}

/// Amplitudes beside a `cost` of each partial's own energy, as a part of it, which keeps pairs from
/// growing against each other.
pub fn fit_amplitudes_at_cost(signal: &[f64], partials: &mut [Partial], cost: f64) {
    let right = DVector::from_iterator(
        2 * partials.len(),
        correlate_values(signal, partials).into_iter().flat_map(|p0| [p0.re, -p0.im]),
    );
    let Some(system) = factored(partials, signal.len(), cost) else { return };
    let solution = system.solve(&right);
    for (k, partial) in partials.iter_mut().enumerate() {
        partial.c = Complex::new(solution[2 * k], solution[2 * k + 1]);
    }
}

/// By how much the squared residual would rise if a partial were taken out and the other amplitudes
/// refitted. Never more than its energy, and next to nothing for one of two giants that cancel.
#[must_use]
pub fn contributions(partials: &[Partial], count: usize) -> Vec<f64> {
    let Some(system) = factored(partials, count, RIDGE) else {
        return partials.iter().map(|p| p.energy(count)).collect();
    };
    let inverse = system.inverse_blocks::<2>();
    partials
        .iter()
        .enumerate()
        .map(|(k, partial)| {
            let c = Vector2::new(partial.c.re, partial.c.im);
            inverse[k].try_inverse().map_or(0.0, |inverse| c.dot(&(inverse * c)))
        })
        .collect()
}

fn factored(partials: &[Partial], count: usize, ridge: f64) -> Option<Scaled> {
    let gram = amplitude_gram(partials, count);
    (0..4).find_map(|power| Scaled::new(&gram, ridge * 1e3_f64.powi(power)))
}

/// The (Re c, Im c) rows and columns of the Gram matrix.
pub(crate) fn amplitude_gram(partials: &[Partial], count: usize) -> DMatrix<f64> {
    let size = 2 * partials.len();
    let mut gram = DMatrix::zeros(size, size);
    let poles: Vec<_> = partials.iter().map(|p| (p.pole(), p.power(count as f64))).collect();
    for j in 0..partials.len() {
        for i in 0..=j {
            let ((zi, zi_n), (zj, zj_n)) = (poles[i], poles[j]);
            let sum = geometric_sums(zi * zj, zi_n * zj_n, count)[0];
            let difference = geometric_sums(zi * zj.conj(), zi_n * zj_n.conj(), count)[0];
            // Rows (1, j) of partial i against columns (1, j) of partial j.
            let values = [
                [0.5 * (sum + difference).re, 0.5 * (-sum.im + difference.im)],
                [0.5 * (-sum.im - difference.im), 0.5 * (difference - sum).re],
            ];
            for (a, row) in values.iter().enumerate() {
                for (b, &value) in row.iter().enumerate() {
                    gram[(2 * i + a, 2 * j + b)] = value;
                    gram[(2 * j + b, 2 * i + a)] = value;
                }
            }
        }
    }
    gram
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;

    #[test]
    fn amplitudes_of_known_poles_come_back_exactly() {
        let truth: Vec<Partial> = (0..6)
            .map(|k| Partial {
                omega: 0.02 + 0.3 * f64::from(k) + if k == 3 { -0.299 } else { 0.0 },
                delta: 1e-4 * f64::from(k + 1),
                c: Complex::from_polar(1.0 / f64::from(k + 1), f64::from(k)),
            })
            .collect();
        let signal = synthesise(&truth, 4000);
        let mut found: Vec<Partial> =
            truth.iter().map(|p| Partial { c: Complex::new(0.0, 0.0), ..*p }).collect();
        fit_amplitudes(&signal, &mut found);
        for (found, truth) in found.iter().zip(&truth) {
            assert!((found.c - truth.c).norm() < 1e-7, "{found:?} {truth:?}");
        }
    }
}
