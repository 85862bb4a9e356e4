//! The two passes over the samples: correlating a signal with damped sinusoids, and making them.
//!
//! ```text
//! P_p(k) = Σ_n n^p s[n] z_kⁿ  (p = 0, 1)          x[n] = Re Σ_k c_k z_kⁿ
//! ```
//! Both are matrix products when n is split into n = b·B + m: the powers z^m are one small table,
//! the signal is its own matrix (no copy), and z^(bB) is applied afterwards, B times more rarely.
//! This is what makes joint refinement of 100 modes over 2 s cost milliseconds a step.

use crate::sinusoid::partial::Partial;
use nalgebra::{Complex, DMatrix, DMatrixView};

type C = Complex<f64>;

/// Samples in a block; the table of powers of 100 modes then fits into the second-level cache.
const BLOCK: usize = 128;

/// Rest of a partial at which it is taken as over: 1e-12, far below the rounding of any recording.
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
    let poles: Vec<C> = order.iter().map(|&k| partials[k].pole()).collect();
    let mut powers = vec![C::new(1.0, 0.0); order.len()];
    for (m, column) in table.as_mut_slice().chunks_exact_mut(ROWS * order.len()).enumerate() {
        for ((power, pole), rows) in powers.iter_mut().zip(&poles).zip(column.chunks_exact_mut(ROWS)) {
            let values = [power.re, power.im, power.re * m as f64, power.im * m as f64];
            rows.copy_from_slice(&values[..ROWS]);
            *power *= pole;
        }
    }
    let view = DMatrixView::from_slice(&signal[..blocks * BLOCK], BLOCK, blocks);
    for stretch in stretches.iter().filter(|stretch| stretch.sounding > 0) {
        let rows = table.rows(0, ROWS * stretch.sounding);
        let products = rows * view.columns(stretch.from, stretch.to - stretch.from);
        let sounding = &order[..stretch.sounding];
        let from = (stretch.from * BLOCK) as f64;
        // Of each: the sums so far, z to the block's first sample, and what takes that to the next
        // block.
        let mut sums: Vec<([C; 2], C, C)> = sounding
            .iter()
            .map(|&k| (out[k], partials[k].power(from), partials[k].power(BLOCK as f64)))
            .collect();
        for (column, block) in products.as_slice().chunks_exact(ROWS * stretch.sounding).zip(stretch.from..) {
            for (([p0, p1], power, leap), rows) in sums.iter_mut().zip(column.chunks_exact(ROWS)) {
                let s0 = C::new(rows[0], rows[1]);
                *p0 += *power * s0;
                if ROWS == 4 {
                    let s1 = C::new(rows[2], rows[3]);
                    *p1 += *power * (s1 + s0 * (block * BLOCK) as f64);
                }
                *power *= *leap;
            }
        }
        sounding.iter().zip(&sums).for_each(|(&k, (sum, ..))| out[k] = *sum);
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
    for (columns, &k) in table.as_mut_slice().chunks_exact_mut(2 * BLOCK).zip(&order) {
        let (cosines, sines) = columns.split_at_mut(BLOCK);
        let pole = partials[k].pole();
        let mut power = C::new(1.0, 0.0);
        for (cosine, sine) in cosines.iter_mut().zip(sines) {
            (*cosine, *sine) = (power.re, -power.im);
            power *= pole;
        }
    }
    let mut amplitudes = DMatrix::<f64>::zeros(2 * modes, blocks);
    let mut now: Vec<(C, C)> =
        order.iter().map(|&k| (partials[k].c, partials[k].power(BLOCK as f64))).collect();
    let mut columns = amplitudes.as_mut_slice().chunks_exact_mut(2 * modes);
    for stretch in &stretches {
        for column in columns.by_ref().take(stretch.to - stretch.from) {
            for ((amplitude, leap), rows) in
                now[..stretch.sounding].iter_mut().zip(column.chunks_exact_mut(2))
            {
                (rows[0], rows[1]) = (amplitude.re, amplitude.im);
                *amplitude *= *leap;
            }
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
