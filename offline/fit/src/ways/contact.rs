//! Striker release: from there on a recording is a free decay.
//!
//! A sum of p damped sinusoids obeys a linear recurrence of order 2p in either direction. Learnt
//! from a stretch some milliseconds after the onset and run *backwards*,
//!
//! ```text
//! e[n] = x[n] − Σ_{k=1…P} a_k x[n + k]
//! ```
//! uses only samples later than n, so it stays small for as long as everything from n on is ringing
//! and jumps where the striker still pushes. (A forward predictor would answer for P samples to
//! every push.) The coefficients are Kumaresan and Tufts' (1983) backward ones by covariance least
//! squares; a ridge of the noise keeps them from modelling it.
//!
//! A recurrence of this order cannot follow more modes than half of it, nor what is no sum of
//! modes: what is found here is a proposal, and `ways` asks the fit whether it is true. The modes
//! of that fit, continued backwards, then show the end itself: they are all of the body, so what
//! they leave before it is the push ([`release_samples`]).
//!
//! Measured: half-sine forces of 0.3–3 ms on bodies of 6–24 modes end within 0.2 ms of where they
//! do.

use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::synthesise;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Longest order; 80 modes at most matter in a tenth of a second.
const ORDER: usize = 160;
/// Beginning of the span the recurrence is learnt from: first this long after the onset; later if
/// the contact lasts until then.
const LEARNT_FROM_S: [f64; 2] = [0.004, 0.02];
/// Length of the stretch.
const LEARNT_FOR_S: f64 = 0.12;
/// Smoothing of the squared error.
const SMOOTHING_S: f64 = 0.0002;
/// A push is this many times what the learnt stretch leaves at its loudest.
const EXCESS: f64 = 10.0;
/// No striker touches longer; what is not ringing yet by then is the room or the instrument's
/// resonator.
pub const LONGEST_S: f64 = 0.005;
/// Ridge relative to the mean square, for files without noise.
const RIDGE: f64 = 1e-10;

/// Samples from `strike`'s first one to the end of the contact; 0 when it rings from the start or
/// when the recording is too short or too noisy to say. `noise_variance` is that of the recording.
#[must_use]
pub fn contact_samples(strike: &[f64], rate_hz: f64, noise_variance: f64) -> usize {
    let mut found = 0;
    for from_s in LEARNT_FROM_S {
        let from = (from_s * rate_hz) as usize;
        let smoothing = ((SMOOTHING_S * rate_hz) as usize).max(2);
        let Some(errors) = backward_errors(strike, from, rate_hz, noise_variance) else { return found };
        let levels = smoothed_squares(&errors, smoothing);
        let usual = usual(&levels[from.min(levels.len())..]);
        let pushed = levels[..from.min(levels.len())].iter().rposition(|&error| error > EXCESS * usual);
        found = pushed.map_or(0, |n| n + smoothing);
        // Well clear of the stretch it was learnt from: that stretch rang freely.
        if 2 * found < from {
            break;
        }
    }
    found.min((LONGEST_S * rate_hz) as usize)
}

/// Samples from `sound`'s first one to where `partials` (amplitudes at sample `late`), continued
/// backwards, leave more than noise of `variance`: where the push ends that was over by `late`.
#[must_use]
pub fn release_samples(
    sound: &[f64],
    late: usize,
    partials: &[Partial],
    variance: f64,
    rate_hz: f64,
) -> usize {
    let smoothing = ((SMOOTHING_S * rate_hz) as usize).max(2);
    let early: Vec<Partial> = partials.iter().map(|p| p.moved(-(late as f64))).collect();
    let mut left = synthesise(&early, (late + smoothing).min(sound.len()));
    left.iter_mut().zip(sound).for_each(|(left, x)| *left = x - *left);
    let pushed = smoothed_squares(&left, smoothing).iter().rposition(|&square| square > EXCESS * variance);
    pushed.map_or(0, |n| (n + smoothing).min(late))
}

/// e of the first samples, learnt from `from` on; `None` when there is too little.
fn backward_errors(strike: &[f64], from: usize, rate_hz: f64, noise_variance: f64) -> Option<Vec<f64>> {
    let learnt = &strike[from.min(strike.len())..];
    let order = ORDER.min(learnt.len() / 4);
    let rows = learnt.len().checked_sub(order)?.min((LEARNT_FOR_S * rate_hz) as usize);
    if order < 8 || rows < 2 * order {
        return None;
    }
    let moments = moments(&learnt[..rows + order], order, rows);
    let ridge = rows as f64 * (noise_variance + RIDGE * mean_square(&learnt[..rows]));
    let inner = moments.view((1, 1), (order, order)) + DMatrix::identity(order, order) * ridge;
    let right = DVector::from_fn(order, |i, _| moments[(i + 1, 0)]);
    let coefficients = Cholesky::new(inner)?.solve(&right);
    let until = (from + rows).min(strike.len() - order - 1);
    let error = |n: usize| {
        let later = &strike[n + 1..=n + order];
        strike[n] - coefficients.iter().zip(later).map(|(a, x)| a * x).sum::<f64>()
    };
    Some((0..until).map(error).collect())
}

/// Σ_n x[n + i] x[n + j] for i, j up to `order`, by the recurrence down the diagonals.
fn moments(x: &[f64], order: usize, rows: usize) -> DMatrix<f64> {
    let mut moments = DMatrix::zeros(order + 1, order + 1);
    for lag in 0..=order {
        let mut sum: f64 = x[..rows].iter().zip(&x[lag..]).map(|(a, b)| a * b).sum();
        for i in 0..=order - lag {
            moments[(i, i + lag)] = sum;
            moments[(i + lag, i)] = sum;
            if i + lag < order {
                sum += x[i + rows] * x[i + lag + rows] - x[i] * x[i + lag];
            }
        }
    }
    moments
}

/// Means of `count` squares from every sample on.
fn smoothed_squares(errors: &[f64], count: usize) -> Vec<f64> {
    errors.windows(count).map(mean_square).collect()
}

/// The 90th percentile over the first sixth: what ringing alone leaves at its loudest.
fn usual(levels: &[f64]) -> f64 {
    let mut first = levels[..levels.len() / 6].to_vec();
    if first.is_empty() {
        return f64::INFINITY;
    }
    let rank = first.len() * 9 / 10;
    *first.select_nth_unstable_by(rank, f64::total_cmp).1
}

fn mean_square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::amplitudes::fit_amplitudes;
    use asperity_dsp::rng::Rng;
    use std::f64::consts::PI;

    const RATE_HZ: f64 = 44_100.0;

    /// The modes of a body, without amplitudes.
    fn bodies(modes: usize, seed: u64) -> Vec<Partial> {
        let mut rng = Rng::new(seed);
        let mut drawn = || Partial {
            omega: 2.0 * PI * 300.0 * 30.0_f64.powf(rng.uniform()) / RATE_HZ,
            delta: (10.0 + 60.0 * rng.uniform()) / RATE_HZ,
            c: nalgebra::Complex::new(0.0, 0.0),
        };
        (0..modes).map(|_| drawn()).collect()
    }

    /// A body of `modes` modes pushed by a half-sine of `contact_s`; an impulse when that is 0.
    fn struck(modes: usize, contact_s: f64, noise: f64, seed: u64) -> Vec<f64> {
        let mut rng = Rng::new(seed + 1000);
        let push = ((contact_s * RATE_HZ) as usize).max(1);
        let force: Vec<f64> = (0..push).map(|n| (PI * (n as f64 + 0.5) / push as f64).sin()).collect();
        let mut out: Vec<f64> = (0..22_050).map(|_| noise * rng.normal()).collect();
        for mode in bodies(modes, seed) {
            let ((sin, cos), radius) = (mode.omega.sin_cos(), (-mode.delta).exp());
            let (mut re, mut im) = (0.0, 0.0);
            for (n, x) in out.iter_mut().enumerate() {
                let pushed = re + force.get(n).copied().unwrap_or(0.0);
                (re, im) = (radius * (pushed * cos - im * sin), radius * (pushed * sin + im * cos));
                *x += 0.02 * im;
            }
        }
        out
    }

    #[test]
    fn a_push_ends_where_recurrence_and_modes_say() {
        for (contact_s, noise) in [(3e-4, 0.0), (7e-4, 1e-5), (1e-3, 1e-4), (3e-3, 1e-5)] {
            for (modes, seed) in [(6, 1), (24, 2)] {
                let sound = struck(modes, contact_s, noise, seed);
                let late = contact_samples(&sound, RATE_HZ, noise * noise);
                let off_s = late as f64 / RATE_HZ - contact_s;
                assert!((-1e-4..2.2e-3).contains(&off_s), "{modes} modes, {contact_s} s: off by {off_s} s");
                let mut after = bodies(modes, seed);
                fit_amplitudes(&sound[late..], &mut after);
                let end = release_samples(&sound, late, &after, (noise * noise).max(1e-14), RATE_HZ);
                let off_s = end as f64 / RATE_HZ - contact_s;
                assert!(off_s.abs() < 1.5e-4, "{modes} modes, {contact_s} s: really off by {off_s} s");
            }
        }
    }

    #[test]
    fn what_rings_from_the_first_sample_has_no_contact() {
        for noise in [0.0, 1e-5, 1e-3, 3e-2] {
            for (modes, seed) in [(1, 3), (6, 4), (24, 5)] {
                let sound = struck(modes, 0.0, noise, seed);
                let late = contact_samples(&sound, RATE_HZ, noise * noise);
                assert!(late <= 60, "{modes} modes, noise {noise}: {late}");
                let mut after = bodies(modes, seed);
                fit_amplitudes(&sound[late..], &mut after);
                let end = release_samples(&sound, late, &after, (noise * noise).max(1e-14), RATE_HZ);
                assert!(end <= 14, "{modes} modes, noise {noise}: {end}");
            }
        }
        assert_eq!(contact_samples(&[0.5; 30], RATE_HZ, 0.0), 0);
    }
}
