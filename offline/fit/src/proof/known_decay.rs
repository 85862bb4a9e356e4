//! Known decays: modes whose decay the sound does not show ring no longer than it supports.
//!
//! With σ the standard deviation of a mode's decay δ and N the samples of the sound,
//!
//! | a mode with | becomes |
//! |---|---|
//! | σ > δ / 2, of a recording that is no sum of modes | part of its neighbours, or nothing |
//! | δ + 2 σ over, δ under 6.9 / 3 N | one with δ = 6.9 / 3 N: 60 dB in three times the sound |
//!
//! The least known of a neighbourhood goes first, then deviations and amplitudes are taken anew,
//! since of a crowd within one bandwidth each is unknown and one of them is not: a water glass of
//! 3.3 s had 20 modes within 6 Hz, three with deviations of 3 to 10 times the decay, and rang for
//! 65 s. What the body misses stays (`body::solved`). A mode that is proven to ring longer keeps
//! its decay.

use crate::noise::noise_floor::NoiseFloor;
use crate::proof::pruning::{neighbours, uncertainties};
use crate::proof::suspicion::energy_spectrum;
use crate::proof::warning::Warning;
use crate::sinusoid::partial::Partial;
use std::f64::consts::{LN_10, PI};

/// A decay is known whose standard deviation is at most this part of it.
const KNOWN: f64 = 0.5;
/// Nepers of 60 dB in so many times the sound.
const LONGEST: f64 = 3.0;
/// Deviations within which a decay must be slower than that to stay.
const DEVIATIONS: f64 = 2.0;

/// The partials of unknown decay that are least known among their neighbours, the least known
/// first.
pub(crate) fn least_known(partials: &[Partial], noise: &NoiseFloor, count: usize) -> Vec<Partial> {
    let unknown: Vec<f64> = uncertainties(partials, noise, count)
        .iter()
        .zip(partials)
        .map(|(u, p)| u.delta / p.delta.max(1e-300))
        .collect();
    let mut least: Vec<usize> = (0..partials.len())
        .filter(|&k| {
            let worst = |j: usize| j == k || (unknown[j], j) < (unknown[k], k);
            unknown[k] > KNOWN && neighbours(partials, k, count).into_iter().all(worst)
        })
        .collect();
    least.sort_by(|&a, &b| unknown[b].total_cmp(&unknown[a]));
    least.into_iter().map(|k| partials[k]).collect()
}

/// The slowest decay that the sound supports, nepers a sample.
fn slowest(count: usize) -> f64 {
    3.0 * LN_10 / (LONGEST * count as f64)
}

/// Lets what is not proven to ring longer ring for three times `residual`, which `partials` leave.
/// What is left around a mode is what its decay is known in: beats and a room are no noise, but
/// they bend it as noise does.
pub(crate) fn bound_rings(partials: &mut [Partial], residual: &[f64], noise: &NoiseFloor) {
    let count = residual.len();
    let slowest = slowest(count);
    if partials.iter().all(|p| p.delta >= slowest) {
        return;
    }
    let spectrum = energy_spectrum(residual);
    let known = uncertainties(partials, noise, count);
    for (partial, known) in partials.iter_mut().zip(known) {
        let left = left_around(partial, &spectrum, count) / noise.variance_of(partial).max(f64::MIN_POSITIVE);
        let deviation = known.delta * left.max(1.0).sqrt();
        if partial.delta + DEVIATIONS * deviation > slowest {
            partial.delta = partial.delta.max(slowest);
        }
    }
}

/// Warning of the modes that ring for three times the sound since they are not known to ring
/// longer.
pub(crate) fn bounded(partials: &[Partial], count: usize, rate_hz: f64) -> Option<Warning> {
    let at_the_bound = |p: &&Partial| (p.delta / slowest(count) - 1.0).abs() < 1e-12;
    let strongest =
        partials.iter().filter(at_the_bound).max_by(|a, b| a.energy(count).total_cmp(&b.energy(count)))?;
    Some(Warning::UnknownDecay {
        count: partials.iter().filter(at_the_bound).count(),
        frequency_hz: strongest.omega * rate_hz / (2.0 * PI),
    })
}

/// Variance, as if it were white, of what is left within some bandwidths of a partial.
fn left_around(partial: &Partial, spectrum: &[f64], count: usize) -> f64 {
    let half_width = 4.0 * partial.delta + 8.0 * PI / count as f64;
    let bin = |omega: f64| ((omega.clamp(0.0, PI) / PI) * spectrum.len() as f64) as usize;
    let (from, to) = (bin(partial.omega - half_width), bin(partial.omega + half_width).min(spectrum.len()));
    let width = to.saturating_sub(from).max(1) as f64;
    let left: f64 = spectrum[from.min(to)..to].iter().sum();
    left * spectrum.len() as f64 / (width * count as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;
    use crate::ways::analysis::subtract;
    use asperity_dsp::rng::Rng;
    use nalgebra::Complex;

    const RATE_HZ: f64 = 44_100.0;
    const COUNT: usize = 22_050;

    fn partial(hz: f64, t60_s: f64, c: f64) -> Partial {
        Partial {
            omega: 2.0 * PI * hz / RATE_HZ,
            delta: 3.0 * LN_10 / (t60_s * RATE_HZ),
            c: Complex::new(c, 0.0),
        }
    }

    /// The partials in noise, and what is left without them.
    fn heard(partials: &[Partial], noise: f64) -> (Vec<f64>, NoiseFloor) {
        let mut rng = Rng::new(5);
        let mut sound = synthesise(partials, COUNT);
        sound.iter_mut().for_each(|x| *x += noise * rng.normal());
        let floor = NoiseFloor::by_time(&subtract(&sound, partials), RATE_HZ, 0.0);
        (sound, floor)
    }

    #[test]
    fn a_glass_rings_over_three_times_as_long_only_with_evidence() {
        let longest_s = |noise: f64, t60_s: f64| {
            let (sound, floor) = heard(&[partial(1065.0, t60_s, 0.1)], noise);
            let mut partials = [partial(1065.0, t60_s, 0.1)];
            let left = subtract(&sound, &partials);
            bound_rings(&mut partials, &left, &floor);
            let limited = bounded(&partials, COUNT, RATE_HZ).is_some();
            (3.0 * LN_10 / (partials[0].delta * RATE_HZ), limited)
        };
        // Of δ N, with N samples of noise σ and a mode of amplitude A, the deviation is √(24 / N) σ
        // / A or more: 0.1 for σ = 0.3, 0.5 for 1.5 and 1.3 for 4. At the bound δ N is 2.3; of 2 s
        // it is 1.73, of 10 s 0.35.
        for (noise, t60_s) in [(1.5, 2.0), (4.0, 10.0)] {
            let (unknown_s, limited) = longest_s(noise, t60_s);
            assert!((unknown_s - 1.5).abs() < 1e-6 && limited, "{noise} {t60_s}: {unknown_s}");
        }
        for (noise, t60_s) in [(0.03, 2.0), (0.3, 10.0), (1e-5, 10.0)] {
            let (known_s, limited) = longest_s(noise, t60_s);
            assert!((known_s - t60_s).abs() < 1e-6 && !limited, "{noise} {t60_s}: {known_s}");
        }
        // What the sound supports is not asked.
        assert!(!longest_s(0.3, 1.2).1);
    }

    #[test]
    fn of_a_crowd_the_least_known_mode_goes_first() {
        let (_, floor) = heard(&[partial(1065.0, 0.8, 0.1)], 1e-3);
        let crowd: Vec<Partial> =
            (0..5).map(|k| partial(1064.6 + 0.2 * f64::from(k), 0.6 + 0.1 * f64::from(k), 0.02)).collect();
        let doomed = least_known(&crowd, &floor, COUNT);
        assert!(doomed.len() == 1 && crowd.contains(&doomed[0]), "{doomed:?}");
        // A doublet that beats stays two.
        let two = [partial(700.0, 2.0, 0.1), partial(704.0, 2.0, 0.08)];
        assert_eq!(least_known(&two, &heard(&two, 1e-3).1, COUNT), []);
    }
}
