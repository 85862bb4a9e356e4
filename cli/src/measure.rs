//! Timing on machines that do other things too: many repetitions, each shorter than a time slice;
//! their median, and the range of the middle eight tenths. A mean counts what else the machine did,
//! a minimum what it never does twice.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Length of one repetition: long against the clock, short against a time slice.
const REPETITION: Duration = Duration::from_micros(500);
/// Repetitions; fewer where one call of the work is long.
const REPETITIONS: std::ops::RangeInclusive<usize> = 5..=120;

/// Durations, in the same unit throughout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Half of all took longer.
    pub median: f64,
    /// A tenth took less.
    pub p10: f64,
    /// A tenth took longer.
    pub p90: f64,
}

impl Timing {
    /// Median of many timings.
    pub fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        Self { median: quantile(&times, 0.5), p10: quantile(&times, 0.1), p90: quantile(&times, 0.9) }
    }

    /// In another unit.
    pub fn times(self, factor: f64) -> Self {
        Self { median: self.median * factor, p10: self.p10 * factor, p90: self.p90 * factor }
    }
}

/// Median nanoseconds of one item when `work` does `items` of them.
pub fn ns_per_item(items: usize, work: impl FnMut()) -> f64 {
    ns_spread(items, work).median
}

/// Nanoseconds of one item when `work` does `items` of them.
pub fn ns_spread(items: usize, mut work: impl FnMut()) -> Timing {
    work();
    let once = Instant::now();
    work();
    let once_s = once.elapsed().as_secs_f64().max(1e-9);
    let calls = (REPETITION.as_secs_f64() / once_s).ceil().clamp(1.0, 1e6);
    let most = *REPETITIONS.end();
    let repetitions = (REPETITION.as_secs_f64() * most as f64 / (calls * once_s)) as usize;
    let times: Vec<f64> = (0..repetitions.clamp(*REPETITIONS.start(), most))
        .map(|_| {
            let began = Instant::now();
            for _ in 0..calls as usize {
                work();
            }
            began.elapsed().as_secs_f64()
        })
        .collect();
    Timing::of(times).times(1e9 / (calls * items as f64))
}

/// The value below which a share of the sorted values lies.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let index = (share * sorted.len() as f64) as usize;
    sorted.get(index.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

/// Seconds since this was first asked.
pub fn seconds() -> f64 {
    static BEGAN: OnceLock<Instant> = OnceLock::new();
    BEGAN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Name that the machine gives its processor.
pub fn cpu_name() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    info.lines()
        .find(|line| line.starts_with("model name"))
        .and_then(|line| line.split_once(':'))
        .map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}

/// Rms of the difference over the rms of the reference about its mean.
pub fn relative_error(values: impl IntoIterator<Item = f64>, reference: &[f64]) -> f64 {
    let count = reference.len().max(1) as f64;
    let mean = reference.iter().sum::<f64>() / count;
    let alternating = reference.iter().map(|r| (r - mean).powi(2)).sum::<f64>();
    let wrong = values.into_iter().zip(reference).map(|(v, r)| (v - r).powi(2)).sum::<f64>();
    (wrong / alternating.max(f64::MIN_POSITIVE)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_constant_offset_is_measured_against_the_alternating_part() {
        let reference: Vec<f64> = (0..1000).map(|n| 5.0 + (f64::from(n) * 0.1).sin()).collect();
        let shifted = reference.iter().map(|r| r + 0.1);
        let error = relative_error(shifted, &reference);
        assert!((error - 0.1 / 0.5f64.sqrt()).abs() < 2e-3, "{error}");
        assert_eq!(relative_error(reference.iter().copied(), &reference), 0.0);
    }

    #[test]
    fn quantiles_of_short_lists_exist() {
        assert_eq!(quantile(&[], 0.5), 0.0);
        assert_eq!(quantile(&[1.0, 2.0, 3.0], 0.5), 2.0);
        assert_eq!(quantile(&[1.0, 2.0, 3.0], 0.999), 3.0);
    }

    #[test]
    fn one_disturbed_block_moves_a_mean_and_no_median() {
        let mut times = vec![6.0; 99];
        times.push(6000.0);
        assert_eq!(Timing::of(times), Timing { median: 6.0, p10: 6.0, p90: 6.0 });
        let spread = Timing::of((0..=100).map(f64::from).collect());
        assert_eq!((spread.p10, spread.median, spread.p90), (10.0, 50.0, 90.0));
        assert_eq!(spread.times(2.0).p90, 180.0);
    }
}
