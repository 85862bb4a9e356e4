//! Ranking of partials by loudness, for when there are more than places.
//!
//! Energy alone prefers the attack. A partial counts by the larger of two shares: of all energy,
//! and of all energy after a tenth of a second, where the attack is over and what rings is heard
//! alone.

use crate::sinusoid::amplitudes::contributions;
use crate::sinusoid::partial::Partial;

/// From here on what rings is heard alone, s after the start.
const LATE_S: f64 = 0.1;

/// Keeps the `most` partials that are heard best in `count` samples.
pub fn keep_heard(partials: &mut Vec<Partial>, count: usize, most: usize, rate_hz: f64) {
    if partials.len() <= most {
        return;
    }
    let late = (LATE_S * rate_hz) as usize;
    let all = shares(contributions(partials, count));
    let after = if late < count {
        let moved: Vec<Partial> = partials.iter().map(|p| p.moved(late as f64)).collect();
        shares(contributions(&moved, count - late))
    } else {
        vec![0.0; partials.len()]
    };
    let mut ranked: Vec<(f64, Partial)> =
        all.into_iter().zip(after).map(|(a, b)| a.max(b)).zip(partials.drain(..)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    partials.extend(ranked.into_iter().take(most).map(|(_, p)| p));
}

fn shares(mut energies: Vec<f64>) -> Vec<f64> {
    let sum: f64 = energies.iter().sum();
    energies.iter_mut().for_each(|e| *e /= sum.max(1e-300));
    energies
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Complex;

    #[test]
    fn a_long_quiet_partial_is_kept_before_a_loud_short_one() {
        let partial = |omega, delta, c| Partial { omega, delta, c: Complex::new(c, 0.0) };
        let quiet = partial(0.3, 3e-5, 0.02);
        let mut partials = vec![
            partial(0.1, 2e-4, 1.0),
            partial(0.5, 2e-2, 0.5),
            partial(0.7, 1e-2, 0.4),
            partial(0.9, 3e-2, 0.6),
            quiet,
        ];
        keep_heard(&mut partials, 44_100, 2, 44_100.0);
        assert!(partials.contains(&quiet) && partials.len() == 2, "{partials:?}");
    }
}
