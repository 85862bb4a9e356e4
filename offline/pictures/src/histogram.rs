//! Giving one set of numbers the histogram of another, by rank.
//!
//! ```text
//! i' = F_ref⁻¹(F(i))
//! ```
//! (document 002, paragraph on the histogram conversion unit), F the cumulative distribution of the
//! numbers and F_ref that of the reference. With equally many numbers the k-th smallest simply
//! takes the value of the reference's k-th smallest; with unequal counts the quantile between two
//! neighbours is interpolated.
//!
//! Numbers closer together than [`TIE`] of the range are ordered by a hash of their position:
//! sub-bands of regular patterns hold thousands of values that are equal but for rounding, and
//! ordering those by rounding or by position would write stripes into the result. So matching
//! numbers with themselves gives them back to within [`TIE`] of their range.

use asperity_dsp::rng::hash_u32;

/// Fraction of the range within which two numbers count as tied.
pub const TIE: f64 = 1e-9;

/// Bits sorted in one pass.
const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;
/// Places of the two digits that are sorted by: the upper 22 bits of the 32 of a key, which lie
/// above its position. What these leave together, a few neighbours as a rule, is sorted by
/// comparing.
const DIGIT_SHIFTS: [u32; 2] = [64 - 2 * DIGIT_BITS, 64 - DIGIT_BITS];

/// A sorted set of numbers: a reference's histogram.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    sorted: Vec<f64>,
}

impl Histogram {
    /// The histogram of `values`, which must be finite.
    #[must_use]
    pub fn new(values: &[f64]) -> Self {
        Matcher::default().histogram(values)
    }

    /// The value below which the fraction (rank + ½)/count lies.
    #[must_use]
    pub fn quantile(&self, rank: usize, count: usize) -> f64 {
        let n = self.sorted.len();
        if n == count {
            return self.sorted[rank];
        }
        let at = ((rank as f64 + 0.5) * n as f64 / count as f64 - 0.5).clamp(0.0, (n - 1) as f64);
        let low = at as usize;
        let high = (low + 1).min(n - 1);
        self.sorted[low] + (at - low as f64) * (self.sorted[high] - self.sorted[low])
    }

    /// Standard deviation of the numbers.
    #[must_use]
    pub fn deviation(&self) -> f64 {
        let n = self.sorted.len().max(1) as f64;
        let mean = self.sorted.iter().sum::<f64>() / n;
        (self.sorted.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n).sqrt()
    }

    /// Wasserstein distance of order 1 to `other`: the mean distance between equal quantiles.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let count = self.sorted.len().max(other.sorted.len());
        if self.sorted.len() == other.sorted.len() {
            let both = self.sorted.iter().zip(&other.sorted);
            return both.map(|(a, b)| (a - b).abs()).sum::<f64>() / count.max(1) as f64;
        }
        let sum: f64 = (0..count).map(|k| (self.quantile(k, count) - other.quantile(k, count)).abs()).sum();
        sum / count.max(1) as f64
    }
}

/// Working memory for matching, so that repeated passes do not allocate.
#[derive(Debug, Clone, Default)]
pub struct Matcher {
    keys: Vec<u64>,
    other: Vec<u64>,
}

impl Matcher {
    /// As [`Histogram::new`].
    #[must_use]
    pub fn histogram(&mut self, values: &[f64]) -> Histogram {
        // Keys grow with the values.
        self.order(values, 0.0, |run| {
            run.sort_unstable_by(|&a, &b| value(values, a).total_cmp(&value(values, b)))
        });
        Histogram { sorted: self.keys.iter().map(|&key| value(values, key)).collect() }
    }

    /// Changes `values`, which must be finite, so that they have the histogram of `reference` and
    /// keep their order.
    pub fn run(&mut self, values: &mut [f64], reference: &Histogram) {
        let count = values.len();
        if count == reference.sorted.len() {
            self.by_rank(values, |rank| reference.sorted[rank]);
        } else {
            self.by_rank(values, |rank| reference.quantile(rank, count));
        }
    }

    /// Replaces each of `values` by what its rank says, the smallest first.
    pub(crate) fn by_rank(&mut self, values: &mut [f64], mut value: impl FnMut(usize) -> f64) {
        // What is still equal keeps no trace of its position either.
        self.order(values, TIE, |run| run.sort_unstable_by_key(|&key| (key >> 32, hash_u32(key as u32))));
        for (rank, &key) in self.keys.iter().enumerate() {
            values[position(key)] = value(rank);
        }
    }

    /// Leaves in `keys` the positions of `values` (low halves) in ascending order of value, where
    /// values closer than `tie` of the range come in random order: a radix sort. `sort` brings keys
    /// in order that it leaves together.
    fn order(&mut self, values: &[f64], tie: f64, sort: impl Fn(&mut [u64])) {
        let mut counts = self.make_keys(values, tie);
        self.other.resize(values.len(), 0);
        for (count, shift) in counts.iter_mut().zip(DIGIT_SHIFTS) {
            let mut start = 0;
            for slot in count.iter_mut() {
                start += std::mem::replace(slot, start);
            }
            let sorted = self.other.as_mut_slice();
            for &key in &self.keys {
                let slot = &mut count[(key >> shift) as usize & (DIGITS - 1)];
                sorted[*slot as usize] = key;
                *slot += 1;
            }
            std::mem::swap(&mut self.keys, &mut self.other);
        }
        sort_what_is_left(&mut self.keys, sort);
    }

    /// Makes the keys of `values`, in the order of the values, and counts their digits.
    fn make_keys(&mut self, values: &[f64], tie: f64) -> [[u32; DIGITS]; 2] {
        let (low, high) = range(values);
        let tie_steps = tie * 4_294_967_296.0;
        // The sum of key and jitter stays below 2³².
        let scale = if high > low { (4_294_967_295.0 - tie_steps) / (high - low) } else { 0.0 };
        let mut counts = [[0_u32; DIGITS]; 2];
        self.keys.clear();
        self.keys.extend(values.iter().enumerate().map(|(i, &v)| {
            let jitter = f64::from(hash_u32(i as u32)) * tie;
            let key = u64::from(((v - low) * scale + jitter) as u32) << 32 | i as u64;
            for (count, shift) in counts.iter_mut().zip(DIGIT_SHIFTS) {
                count[(key >> shift) as usize & (DIGITS - 1)] += 1;
            }
            key
        }));
        counts
    }
}

/// Sorts by `sort` all runs of keys with equal digits in which upper halves do not grow from each
/// to the next.
fn sort_what_is_left(keys: &mut [u64], sort: impl Fn(&mut [u64])) {
    let mut at = 1;
    while at < keys.len() {
        if keys[at - 1] >> 32 < keys[at] >> 32 {
            at += 1;
            continue;
        }
        let digits = keys[at] >> DIGIT_SHIFTS[0];
        let same = |key: &&u64| **key >> DIGIT_SHIFTS[0] == digits;
        let start = at - keys[..at].iter().rev().take_while(same).count();
        let end = at + keys[at..].iter().take_while(same).count();
        sort(&mut keys[start..end]);
        at = end + 1;
    }
}

/// Median of values, the upper one of an even number; 0 of none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Smallest and largest of finite values.
fn range(values: &[f64]) -> (f64, f64) {
    // Several at once: one comparison need not wait for the one before.
    let (mut low, mut high) = ([f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
    let (chunks, rest) = values.as_chunks::<8>();
    for chunk in chunks {
        for ((low, high), &v) in low.iter_mut().zip(&mut high).zip(chunk) {
            *low = if v < *low { v } else { *low };
            *high = if v > *high { v } else { *high };
        }
    }
    let low = low.iter().chain(rest).copied().fold(f64::INFINITY, f64::min);
    (low, high.iter().chain(rest).copied().fold(f64::NEG_INFINITY, f64::max))
}

/// The value that a key stands for.
fn value(values: &[f64], key: u64) -> f64 {
    values[position(key)]
}

/// The position in the low half of a key.
fn position(key: u64) -> usize {
    (key & 0xffff_ffff) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn matched_numbers_have_exactly_the_reference_histogram() {
        let mut rng = Rng::new(5);
        let reference = Histogram::new(&(0..5000).map(|_| rng.normal()).collect::<Vec<_>>());
        let mut values: Vec<f64> = (0..5000).map(|_| rng.uniform()).collect();
        let before = values.clone();
        Matcher::default().run(&mut values, &reference);
        assert_eq!(Histogram::new(&values), reference);
        let mut order: Vec<usize> = (0..5000).collect();
        order.sort_by(|&a, &b| before[a].total_cmp(&before[b]));
        assert!(order.windows(2).all(|w| values[w[0]] <= values[w[1]]), "ranks are kept");
    }

    #[test]
    fn a_histogram_is_sorted_to_the_last_bit() {
        let mut rng = Rng::new(7);
        let values: Vec<f64> = (0..9000).map(|i| f64::from(i % 3) + 1e-14 * rng.normal()).collect();
        let histogram = Histogram::new(&values);
        let mut sorted = values;
        sorted.sort_unstable_by(f64::total_cmp);
        assert_eq!(histogram.sorted, sorted);
    }

    #[test]
    fn matching_numbers_with_themselves_changes_them_by_less_than_a_tie() {
        let mut rng = Rng::new(6);
        let values: Vec<f64> = (0..20_000).map(|i| (i % 7) as f64 + 1e-13 * rng.normal()).collect();
        let reference = Histogram::new(&values);
        let mut matched = values.clone();
        Matcher::default().run(&mut matched, &reference);
        for (a, b) in values.iter().zip(&matched) {
            assert!((a - b).abs() < 6.0 * 2.0 * TIE, "{a} became {b}");
        }
    }

    #[test]
    fn unequal_counts_meet_at_equal_quantiles() {
        // Quantiles of the uniform ramp are known in closed form.
        let reference = Histogram::new(&(0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect::<Vec<_>>());
        let mut values: Vec<f64> = (0..333).map(|i| -f64::from(i)).collect();
        Matcher::default().run(&mut values, &reference);
        for (i, v) in values.iter().enumerate() {
            let expected = 1.0 - (i as f64 + 0.5) / 333.0;
            assert!((v - expected).abs() < 1e-12, "{v} should be {expected}");
        }
    }

    #[test]
    fn the_distance_of_a_shifted_set_is_the_shift() {
        let a = Histogram::new(&(0..100).map(f64::from).collect::<Vec<_>>());
        let b = Histogram::new(&(0..100).map(|i| f64::from(i) + 2.5).collect::<Vec<_>>());
        assert!((a.distance(&b) - 2.5).abs() < 1e-12);
        assert!((b.distance(&a) - 2.5).abs() < 1e-12 && a.distance(&a) == 0.0);
    }

    #[test]
    fn a_flat_set_is_spread_without_order() {
        let reference = Histogram::new(&(0..4096).map(f64::from).collect::<Vec<_>>());
        let mut values = vec![1.0; 4096];
        Matcher::default().run(&mut values, &reference);
        // Correlation of value and position: none.
        let mean = 2047.5;
        let r: f64 = values.iter().enumerate().map(|(i, v)| (i as f64 - mean) * (v - mean)).sum::<f64>()
            / (4096.0 * (4096.0_f64.powi(2) - 1.0) / 12.0);
        assert!(r.abs() < 0.05, "correlation {r}");
    }
}
