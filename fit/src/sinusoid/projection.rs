//! The two passes over the samples: correlating a signal with damped sinusoids, and making them.
//!
//! ```text
//! P_p(k) = Σ_n n^p s[n] z_kⁿ  (p = 0, 1)          x[n] = Re Σ_k c_k z_kⁿ
//! ```
//! Both are matrix products when n is split into n = b·B + m: the powers z^m are one small table, the
//! signal is its own matrix (no copy), and z^(bB) is applied afterwards, B times more rarely. This is
//! what makes joint refinement of 100 modes over 2 s cost milliseconds a step.

use crate::sinusoid::partial::Partial;
use nalgebra::{Complex, DMatrix, DMatrixView};

type C = Complex<f64>;

/// Samples in a block; the table of powers of 100 modes then fits into the second-level cache.
const BLOCK: usize = 128;

/// What is left of a partial when it is taken as over: 1e-12, far below the rounding of any recording.
const OVER_NEPERS: f64 = 27.6;

/// Blocks of samples in which the same partials still sound, when these are sorted by damping.
struct Stretch {
    from: usize,
    to: usize,
    sounding: usize,
}

/// Indices of the partials, longest first, and the stretches of `blocks` blocks.
fn stretches(partials: &[Partial], blocks: usize) -> (Vec<usize>, Vec<Stretch>) {
    let mut order: Vec<usize> = (0..partials.len()).collect();
    order.sort_by(|&a, &b| partials[a].delta.total_cmp(&partials[b].delta));
    let ends = |k: usize| OVER_NEPERS / (partials[k].delta.max(1e-12) * BLOCK as f64);
    let (mut stretches, mut from) = (Vec::new(), 0);
    while from < blocks {
        // Longer ones the later they are: a product of few columns is not worth its call.
        let to = (from + (from / 2).max(16)).min(blocks);
        let sounding = order.partition_point(|&k| ends(k) > from as f64);
        stretches.push(Stretch { from, to, sounding });
        from = to;
    }
    (order, stretches)
}

/// `[P_0, P_1]` for every partial; amplitudes are not used.
#[must_use]
pub fn correlate(signal: &[f64], partials: &[Partial]) -> Vec<[C; 2]> {
    correlate_rows::<4>(signal, partials)
}

/// P_0 for every partial; amplitudes are not used.
#[must_use]
pub fn correlate_values(signal: &[f64], partials: &[Partial]) -> Vec<C> {
    correlate_rows::<2>(signal, partials).into_iter().map(|[p0, _]| p0).collect()
}

/// Rows Re z^m, Im z^m and, when there are four, m Re z^m, m Im z^m of every partial.
fn correlate_rows<const ROWS: usize>(signal: &[f64], partials: &[Partial]) -> Vec<[C; 2]> {
    let zero = C::new(0.0, 0.0);
    let mut out = vec![[zero; 2]; partials.len()];
    if partials.is_empty() {
        return out;
    }
    let blocks = signal.len() / BLOCK;
    let (order, stretches) = stretches(partials, blocks);
    let mut table = DMatrix::<f64>::zeros(ROWS * order.len(), BLOCK);
    for (row, &k) in order.iter().enumerate() {
        let pole = partials[k].pole();
        let mut power = C::new(1.0, 0.0);
        for m in 0..BLOCK {
            let values = [power.re, power.im, power.re * m as f64, power.im * m as f64];
            for (i, value) in values.into_iter().take(ROWS).enumerate() {
                table[(ROWS * row + i, m)] = value;
            }
            power *= pole;
        }
    }
    let view = DMatrixView::from_slice(&signal[..blocks * BLOCK], BLOCK, blocks);
    for stretch in stretches {
        let rows = table.rows(0, ROWS * stretch.sounding);
        let products = rows * view.columns(stretch.from, stretch.to - stretch.from);
        for (row, &k) in order[..stretch.sounding].iter().enumerate() {
            let leap = partials[k].power(BLOCK as f64);
            let mut power = partials[k].power((stretch.from * BLOCK) as f64);
            let [mut p0, mut p1] = out[k];
            for (column, block) in products.column_iter().zip(stretch.from..) {
                let s0 = C::new(column[ROWS * row], column[ROWS * row + 1]);
                p0 += power * s0;
                if ROWS == 4 {
                    let s1 = C::new(column[ROWS * row + 2], column[ROWS * row + 3]);
                    p1 += power * (s1 + s0 * (block * BLOCK) as f64);
                }
                power *= leap;
            }
            out[k] = [p0, p1];
        }
    }
    for (out, partial) in out.iter_mut().zip(partials) {
        let (pole, mut power) = (partial.pole(), partial.power((blocks * BLOCK) as f64));
        for (n, &sample) in signal.iter().enumerate().skip(blocks * BLOCK) {
            out[0] += power * sample;
            out[1] += power * (sample * n as f64);
            power *= pole;
        }
    }
    out
}

/// The sum of the partials over `count` samples.
#[must_use]
pub fn synthesise(partials: &[Partial], count: usize) -> Vec<f64> {
    let modes = partials.len();
    if modes == 0 {
        return vec![0.0; count];
    }
    let blocks = count.div_ceil(BLOCK);
    let (order, stretches) = stretches(partials, blocks);
    let mut table = DMatrix::<f64>::zeros(BLOCK, 2 * modes);
    let mut amplitudes = DMatrix::<f64>::zeros(2 * modes, blocks);
    for (row, &k) in order.iter().enumerate() {
        let partial = &partials[k];
        let pole = partial.pole();
        let mut power = C::new(1.0, 0.0);
        for m in 0..BLOCK {
            table[(m, 2 * row)] = power.re;
            table[(m, 2 * row + 1)] = -power.im;
            power *= pole;
        }
        let leap = partial.power(BLOCK as f64);
        let mut amplitude = partial.c;
        for block in 0..blocks {
            amplitudes[(2 * row, block)] = amplitude.re;
            amplitudes[(2 * row + 1, block)] = amplitude.im;
            amplitude *= leap;
        }
    }
    let mut samples = DMatrix::<f64>::zeros(BLOCK, blocks);
    for stretch in stretches {
        let (from, length, rows) = (stretch.from, stretch.to - stretch.from, 2 * stretch.sounding);
        let sounding = amplitudes.view((0, from), (rows, length));
        samples.columns_mut(from, length).gemm(1.0, &table.columns(0, rows), &sounding, 0.0);
    }
    let mut samples: Vec<f64> = samples.data.into();
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
