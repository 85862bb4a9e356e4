//! Signals between their samples, and the part of a stroke that is compared.

use super::cases::STROKE_S;
use std::ops::Range;

/// Time after the finger's coming and before its going that is not compared, s.
const MARGIN_S: f64 = 0.1;

/// The samples of a case that are compared, of at most `count`.
pub fn after_the_lead_in(count: usize, rate_hz: f64) -> Range<usize> {
    let at = |time_s: f64| ((time_s * rate_hz) as usize).min(count);
    at(STROKE_S.0 + MARGIN_S)..at(STROKE_S.1 - MARGIN_S)
}

/// A signal at a place between its samples, by the polynomial of degree 5 through the six about it:
/// −100 dB up to a twentieth of its rate.
pub fn between(signal: &[f64], at: f64) -> f64 {
    let first = at.floor() as i64 - 2;
    let x = at - first as f64;
    (0..6)
        .map(|i| {
            let weight: f64 = (0..6)
                .filter(|j| *j != i)
                .map(|j| (x - f64::from(j)) / (f64::from(i) - f64::from(j)))
                .product();
            let index = usize::try_from(first + i64::from(i)).ok();
            weight * index.and_then(|index| signal.get(index)).copied().unwrap_or(0.0)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_of_twenty_samples_is_known_between_them_within_100_db() {
        let sine = |at: f64| (at * std::f64::consts::TAU / 20.0).sin();
        let samples: Vec<f64> = (0..100).map(|n| sine(f64::from(n))).collect();
        for n in 0..80 {
            let at = 10.0 + 0.97 * f64::from(n);
            assert!((between(&samples, at) - sine(at)).abs() < 1e-5, "{at}");
        }
    }
}
