//! The two passes over the samples: correlating a signal with damped sinusoids, and making them.
//!
//! ```text
//! P_p(k) = Σ_n n^p s[n] z_kⁿ  (p = 0, 1)          x[n] = Re Σ_k c_k z_kⁿ
//! ```
//! Both are matrix products when n is split into n = b·B + m: the powers z^m are one small table, the
//! signal is its own matrix (no copy), and z^(bB) is applied afterwards, B times more rarely. This is
//! what makes joint refinement of 100 modes over 2 s cost milliseconds a step.

use crate::partial::Partial;
use nalgebra::{Complex, DMatrix, DMatrixView};

type C = Complex<f64>;

/// Samples in a block; the table of powers of 100 modes then fits into the second-level cache.
const BLOCK: usize = 128;

/// `[P_0, P_1]` for every partial; amplitudes are not used.
#[must_use]
pub fn correlate(signal: &[f64], partials: &[Partial]) -> Vec<[C; 2]> {
    let modes = partials.len();
    if modes == 0 {
        return Vec::new();
    }
    let blocks = signal.len() / BLOCK;
    let table = DMatrix::from_fn(4 * modes, BLOCK, |_, _| 0.0);
    let table = fill_table(table, partials);
    let view = DMatrixView::from_slice(&signal[..blocks * BLOCK], BLOCK, blocks);
    let products = table * view;
    partials
        .iter()
        .enumerate()
        .map(|(k, partial)| {
            let leap = partial.power(BLOCK as f64);
            let (mut power, mut p0, mut p1) = (C::new(1.0, 0.0), C::new(0.0, 0.0), C::new(0.0, 0.0));
            for (block, column) in products.column_iter().enumerate() {
                let s0 = C::new(column[4 * k], column[4 * k + 1]);
                let s1 = C::new(column[4 * k + 2], column[4 * k + 3]);
                p0 += power * s0;
                p1 += power * (s1 + s0 * (block * BLOCK) as f64);
                power *= leap;
            }
            let pole = partial.pole();
            for (n, &sample) in signal.iter().enumerate().skip(blocks * BLOCK) {
                p0 += power * sample;
                p1 += power * (sample * n as f64);
                power *= pole;
            }
            [p0, p1]
        })
        .collect()
}

/// Rows Re z^m, Im z^m, m Re z^m, m Im z^m of every partial.
fn fill_table(mut table: DMatrix<f64>, partials: &[Partial]) -> DMatrix<f64> {
    for (k, partial) in partials.iter().enumerate() {
        let pole = partial.pole();
        let mut power = C::new(1.0, 0.0);
        for m in 0..BLOCK {
            table[(4 * k, m)] = power.re;
            table[(4 * k + 1, m)] = power.im;
            table[(4 * k + 2, m)] = power.re * m as f64;
            table[(4 * k + 3, m)] = power.im * m as f64;
            power *= pole;
        }
    }
    table
}

/// The sum of the partials over `count` samples.
#[must_use]
pub fn synthesise(partials: &[Partial], count: usize) -> Vec<f64> {
    let modes = partials.len();
    if modes == 0 {
        return vec![0.0; count];
    }
    let blocks = count.div_ceil(BLOCK);
    let mut table = DMatrix::<f64>::zeros(BLOCK, 2 * modes);
    let mut amplitudes = DMatrix::<f64>::zeros(2 * modes, blocks);
    for (k, partial) in partials.iter().enumerate() {
        let pole = partial.pole();
        let mut power = C::new(1.0, 0.0);
        for m in 0..BLOCK {
            table[(m, 2 * k)] = power.re;
            table[(m, 2 * k + 1)] = -power.im;
            power *= pole;
        }
        let leap = partial.power(BLOCK as f64);
        let mut amplitude = partial.c;
        for block in 0..blocks {
            amplitudes[(2 * k, block)] = amplitude.re;
            amplitudes[(2 * k + 1, block)] = amplitude.im;
            amplitude *= leap;
        }
    }
    let mut samples: Vec<f64> = (table * amplitudes).data.into();
    samples.truncate(count);
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    fn partials() -> Vec<Partial> {
        (0..5)
            .map(|k| Partial {
                omega: 0.1 + 0.4 * f64::from(k),
                delta: 1e-4 * f64::from(k * k),
                c: C::from_polar(1.0 / f64::from(k + 1), f64::from(k)),
            })
            .collect()
    }

    #[test]
    fn blocks_make_the_same_sinusoids_as_the_formula() {
        let count = 3 * BLOCK + 17;
        let made = synthesise(&partials(), count);
        assert_eq!(made.len(), count);
        for (n, sample) in made.iter().enumerate() {
            let direct: f64 = partials().iter().map(|p| p.moved(n as f64).c.re).sum();
            assert!((sample - direct).abs() < 1e-11);
        }
    }

    #[test]
    fn blocks_correlate_like_the_formula() {
        let signal: Vec<f64> = (0..2 * BLOCK + 5).map(|n| ((n * n) as f64 * 0.37).sin()).collect();
        for (found, partial) in correlate(&signal, &partials()).iter().zip(partials()) {
            for (p, found) in found.iter().enumerate() {
                let direct: C = signal
                    .iter()
                    .enumerate()
                    .map(|(n, s)| partial.power(n as f64) * s * (n as f64).powi(p as i32))
                    .sum();
                assert!((found - direct).norm() < 1e-8 * (1.0 + direct.norm()));
            }
        }
    }
}
