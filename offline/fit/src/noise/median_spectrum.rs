//! The spectrum of what is steady in a signal: in every bin the median over time, which a click or
//! a mode that dies away touches little, and what a percentile of such medians is of the noise they
//! come from.

use asperity_fft::PowerSpectra;
use std::f64::consts::PI;

/// The percentile over frequency.
pub(crate) const PERCENTILE: f64 = 0.3;
/// Bins beside 0 Hz and half the rate that the window's main lobe reaches.
const EDGE_BINS: usize = 5;

/// Median over time of the normalised power in every bin from 0 Hz to half the rate.
pub(crate) fn medians(samples: &[f64], length: usize, starts: &[usize]) -> Vec<f64> {
    let window: Vec<f64> = (0..length).map(|i| blackman_harris(i as f64 / length as f64)).collect();
    let spectra = PowerSpectra::new(window, length);
    let norm = spectra.energy();
    let mut powers = vec![Vec::with_capacity(starts.len()); length / 2 + 1];
    for &start in starts {
        for (bin, power) in powers.iter_mut().zip(spectra.of(samples[start..].iter().copied())) {
            bin.push(power / norm);
        }
    }
    let middle = median_rank(starts.len()) - 1;
    let mut medians: Vec<f64> =
        powers.iter_mut().map(|bin| *bin.select_nth_unstable_by(middle, f64::total_cmp).1).collect();
    let last = medians.len() - 1;
    for bin in 0..EDGE_BINS.min(last / 4) {
        medians[bin] = medians[2 * EDGE_BINS.min(last / 4) - bin];
        medians[last - bin] = medians[last - (2 * EDGE_BINS.min(last / 4) - bin)];
    }
    medians
}

fn blackman_harris(x: f64) -> f64 {
    let c = |k: f64| (2.0 * PI * k * x).cos();
    0.358_75 - 0.488_29 * c(1.0) + 0.141_28 * c(2.0) - 0.011_68 * c(3.0)
}

/// The rank (from 1) taken as the median of `count` values.
fn median_rank(count: usize) -> usize {
    count.div_ceil(2)
}

/// The 30th percentile of the median of `count` unit exponentials: the median is below x when at
/// least its rank of them are, each with probability p = 1 − e^(−x).
pub(crate) fn percentile_of_median(count: usize) -> f64 {
    let least = median_rank(count);
    let below = |p: f64| {
        // Σ C(count, j) p^j (1 − p)^(count − j), j < least, from the logarithm of each term.
        let (mut term, mut sum) = (count as f64 * (1.0 - p).ln(), 0.0);
        for j in 0..least {
            sum += term.exp();
            term += ((count - j) as f64 / (j + 1) as f64 * p / (1.0 - p)).ln();
        }
        1.0 - sum
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if below(middle) < PERCENTILE {
            low = middle;
        } else {
            high = middle;
        }
    }
    -(-low).ln_1p()
}

pub(crate) fn previous_power_of_two(n: usize) -> usize {
    if n == 0 { 1 } else { 1 << n.ilog2() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figures of scipy 1.17: −ln(1 − beta.ppf(0.3, k, M − k + 1)).
    #[test]
    fn the_percentile_of_the_median_is_the_one_scipy_computes() {
        for (count, theirs) in
            [(1, 0.356_674_943_9), (4, 0.317_981_762_9), (9, 0.537_178_846_7), (100, 0.632_786_936_2)]
        {
            let ours = percentile_of_median(count);
            assert!((ours / theirs - 1.0).abs() < 1e-9, "{count}: {ours} {theirs}");
        }
    }
}
