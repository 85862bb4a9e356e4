//! Timing on machines that do other things too: many repetitions, each shorter than a time slice, and the quickest tenth
//! of them.

use std::time::{Duration, Instant};

/// Length of one repetition: long against the clock, short against a time slice.
const REPETITION: Duration = Duration::from_micros(500);
/// Repetitions (fewer where one call of the work is long), and the share of them that other work did not disturb.
const REPETITIONS: std::ops::RangeInclusive<usize> = 5..=120;
const UNDISTURBED: f64 = 0.1;

/// Nanoseconds of one item when `work` does `items` of them.
pub fn ns_per_item(items: usize, mut work: impl FnMut()) -> f64 {
    work();
    let once = Instant::now();
    work();
    let once_s = once.elapsed().as_secs_f64().max(1e-9);
    let calls = (REPETITION.as_secs_f64() / once_s).ceil().clamp(1.0, 1e6);
    let most = *REPETITIONS.end();
    let repetitions = (REPETITION.as_secs_f64() * most as f64 / (calls * once_s)) as usize;
    let mut times: Vec<f64> = (0..repetitions.clamp(*REPETITIONS.start(), most))
        .map(|_| {
            let began = Instant::now();
            for _ in 0..calls as usize {
                work();
            }
            began.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    quantile(&times, UNDISTURBED) * 1e9 / (calls * items as f64)
}

/// The value below which a share of the sorted values lies.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let index = (share * sorted.len() as f64) as usize;
    sorted.get(index.min(sorted.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

/// What the machine calls its processor.
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
}
