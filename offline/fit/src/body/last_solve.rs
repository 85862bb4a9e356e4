//! Last solve: amplitudes and phases of the struck body by least squares on the recording, their
//! poles as they are.
//!
//! Stages that are fitted one after the other leave each mode the amplitude that suited its own
//! stage, and modes that begin all at once are louder together than a striker that gives way, or
//! strings of strikes, ever was: a vibraphone's bar 3.3 dB, a brass bowl that swells 26 dB. With y
//! the recording from the strike on,
//!
//! ```text
//! min_c  Σ_{n ≥ 1} w[n] (y[n] − Re Σ_k c_k z_kⁿ)² + ε Σ_k |c_k|² Σ_n w[n] |z_kⁿ|² / 2        ε = 1e-4
//! ```
//!
//! w = 1 before the peak of the recording and 3 from there on: what swells or begins softly is no
//! business of modes that begin at once, and without that weight what rings on pays for it (twelve
//! modes faded in over 3 ms: 0.8 dB too weak later, and 0.3 with it). Where the body would exceed a
//! limit L, w is raised by W and y is held at L; W is tripled, and the places where the body still
//! is too loud are added, until none is left. If that does not end, or a smaller gain of the free
//! solution leaves less, that one is taken; of either, as much is played as leaves least, and not
//! so much that silence would leave less. ε keeps pairs from growing against each other, as in the
//! stages.
//!
//! Against amplitudes fitted to what the modes played themselves, held at the limit: a brass bowl
//! −4.5 → 2.9 dB from the onset, a frying pan −2.1 → 2.9, tower bells −4.0 → 4.2 and −6.5 → 3.4.

use crate::body::struck::struck;
use crate::options::LARGEST_AMPLITUDE;
use crate::sinusoid::amplitudes::amplitude_gram;
use crate::sinusoid::normal_equations::Scaled;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::correlate_values;
use nalgebra::{Complex, DMatrix, DVector};

/// Weight of what follows the peak of the recording.
const LATE: f64 = 3.0;
/// Most gain over the one that leaves least of all: at 1.5, three quarters of what that explains
/// are.
const OVER_BEST: f64 = 1.5;
/// Weight of a sample that is too loud, at first, and its growth a round.
const WEIGHT: f64 = 10.0;
const HEAVIER: f64 = 3.0;
/// Most rounds.
const ROUNDS: usize = 14;
/// A sample that is too loud is pulled to this part of the limit.
const AIM: f64 = 0.97;
/// Cost of a mode's own energy, as a part of it.
const ENERGY_COST: f64 = 1e-4;

/// Fits amplitudes and phases of `partials`, struck at the first sample of `sound`, to it; no
/// sample exceeds `limit` times its peak.
pub fn last_solve(sound: &[f64], partials: &mut Vec<Partial>, limit: f64) {
    if partials.is_empty() || sound.len() < 2 {
        return;
    }
    let most = limit * peak(sound);
    let late = late_from(sound);
    let equations = Equations::new(sound, late, partials);
    let Some(free) = equations.solved(partials, &[], 0.0) else { return };
    let mut best = played(sound, late, free.clone(), most);
    if peak(&struck(&free, sound.len())) > most
        && let Some(held) = held(sound, &equations, free, most)
    {
        let held = played(sound, late, held, most);
        if held.left < best.left {
            best = held;
        }
    }
    *partials = best.partials;
}

/// Peak of `partials`, struck at the first sample of `sound`, over its own.
pub fn peak_ratio(sound: &[f64], partials: &[Partial]) -> f64 {
    peak(&struck(partials, sound.len())) / peak(sound).max(1e-300)
}

/// Partials and the weighted squared residual that they leave.
struct Played {
    partials: Vec<Partial>,
    left: f64,
}

/// As much of `partials` as leaves least of `sound` and nowhere exceeds `most`; none where silence
/// leaves less.
fn played(sound: &[f64], late: usize, mut partials: Vec<Partial>, most: f64) -> Played {
    let body = struck(&partials, sound.len());
    let weighted = |a: &[f64], b: &[f64]| product(a, b) + (LATE - 1.0) * product(&a[late..], &b[late..]);
    let (both, own) = (weighted(sound, &body), weighted(&body, &body));
    let least_left = product(sound, &body) / product(&body, &body).max(1e-300);
    let gain = (both / own.max(1e-300))
        .min(OVER_BEST * least_left)
        .min(most / peak(&body).max(1e-300))
        .clamp(0.0, 1.0);
    partials.iter_mut().for_each(|p| p.c *= gain);
    if gain == 0.0 {
        partials.clear();
    }
    Played { partials, left: weighted(sound, sound) - 2.0 * gain * both + gain * gain * own }
}

/// First sample of what follows the peak, that of the strike excepted.
fn late_from(sound: &[f64]) -> usize {
    let most = peak(sound);
    sound.iter().position(|x| x.abs() == most).unwrap_or(0).max(1)
}

/// The solution with what exceeds `most` held at it; `None` if that does not end.
fn held(sound: &[f64], equations: &Equations, mut partials: Vec<Partial>, most: f64) -> Option<Vec<Partial>> {
    let mut loud: Vec<Option<f64>> = vec![None; sound.len()];
    let mut weight = WEIGHT;
    for _ in 0..ROUNDS {
        let mut exceeded = false;
        for (loud, y) in loud.iter_mut().zip(struck(&partials, sound.len())) {
            if y.abs() > most {
                *loud = Some(AIM * most * y.signum());
                exceeded = true;
            }
        }
        if !exceeded {
            return Some(partials);
        }
        partials = equations.solved(&partials, &loud, weight)?;
        weight *= HEAVIER;
    }
    None
}

/// Normal equations of the amplitudes at the strike.
struct Equations {
    gram: DMatrix<f64>,
    right: DVector<f64>,
    /// Largest amplitude.
    largest: f64,
}

impl Equations {
    /// The first sample, silent in every struck body, is left out.
    fn new(sound: &[f64], late: usize, partials: &[Partial]) -> Self {
        let mut weighted = sound.to_vec();
        weighted[0] = 0.0;
        weighted[late..].iter_mut().for_each(|y| *y *= LATE);
        let right = correlate_values(&weighted, partials);
        let right = DVector::from_iterator(2 * partials.len(), right.iter().flat_map(|p| [p.re, -p.im]));
        Self {
            gram: weighted_gram(partials, late, sound.len()),
            right,
            largest: LARGEST_AMPLITUDE * peak(sound),
        }
    }

    /// Amplitudes of least squares, with the `loud` samples at their aims.
    fn solved(&self, partials: &[Partial], loud: &[Option<f64>], weight: f64) -> Option<Vec<Partial>> {
        let (mut gram, mut right) = (self.gram.clone(), self.right.clone());
        weigh(&mut gram, &mut right, partials, loud, weight);
        let solution = Scaled::new(&gram, ENERGY_COST)?.solve(&right);
        let solved = partials.iter().enumerate().map(|(k, partial)| {
            let c = Complex::new(solution[2 * k], solution[2 * k + 1]);
            Partial { c: c * (self.largest / c.norm().max(1e-300)).min(1.0), ..*partial }
        });
        Some(solved.collect())
    }
}

/// The Gram matrix of zⁿ over n = 1 … `count` − 1, from `late` on weighted.
fn weighted_gram(partials: &[Partial], late: usize, count: usize) -> DMatrix<f64> {
    let early = amplitude_gram(partials, late);
    let mut gram = LATE * amplitude_gram(partials, count) - (LATE - 1.0) * early;
    let first = DVector::from_iterator(2 * partials.len(), partials.iter().flat_map(|_| [1.0, 0.0]));
    gram.ger(-1.0, &first, &first, 1.0);
    gram
}

/// Adds what a `loud` sample should be, with its `weight`, to the normal equations.
fn weigh(
    gram: &mut DMatrix<f64>,
    right: &mut DVector<f64>,
    partials: &[Partial],
    loud: &[Option<f64>],
    weight: f64,
) {
    for (n, aim) in loud.iter().enumerate().filter_map(|(n, loud)| loud.map(|aim| (n, aim))) {
        let row = DVector::from_iterator(
            2 * partials.len(),
            partials.iter().map(|p| p.power(n as f64)).flat_map(|z| [z.re, -z.im]),
        );
        gram.ger(weight, &row, &row, 1.0);
        right.axpy(weight * aim, &row, 1.0);
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn peak(samples: &[f64]) -> f64 {
    samples.iter().fold(0.0, |peak, x| peak.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;

    fn partial(omega: f64, delta: f64, c: f64) -> Partial {
        Partial { omega, delta, c: Complex::new(0.0, -c) }
    }

    fn left(sound: &[f64], partials: &[Partial]) -> f64 {
        let body = struck(partials, sound.len());
        let squares: f64 = sound.iter().zip(body).map(|(y, s)| (y - s).powi(2)).sum();
        squares / sound.iter().map(|y| y * y).sum::<f64>()
    }

    #[test]
    fn wrong_amplitudes_in_a_file_become_the_recordings() {
        let truth: Vec<Partial> =
            (0..6).map(|k| partial(0.05 * 1.6_f64.powi(k), 3e-4, 0.3 / f64::from(k + 1))).collect();
        let sound = synthesise(&truth, 20_000);
        let mut found: Vec<Partial> =
            truth.iter().map(|p| Partial { c: p.c * Complex::new(0.3, 0.4), ..*p }).collect();
        last_solve(&sound, &mut found, 1.3);
        for (found, truth) in found.iter().zip(&truth) {
            assert!((found.c - truth.c).norm() < 1e-3 * truth.c.norm(), "{found:?} {truth:?}");
        }
    }

    #[test]
    fn a_body_that_began_softly_rings_on_alike_when_struck() {
        // Twelve modes in step, faded in over 3 ms as a mallet does.
        let modes: Vec<Partial> =
            (0..12).map(|k| partial(0.02 * 1.35_f64.powi(k), 2e-4 * 1.4_f64.powi(k), 0.1)).collect();
        let mut sound = synthesise(&modes, 22_050);
        sound[..132].iter_mut().enumerate().for_each(|(n, x)| *x *= n as f64 / 132.0);
        let mut played = modes.clone();
        let limit = 1.03;
        assert!(peak_ratio(&sound, &played) > limit);
        last_solve(&sound, &mut played, limit);
        assert!(peak_ratio(&sound, &played) <= limit * (1.0 + 1e-9), "{}", peak_ratio(&sound, &played));
        let late = |x: &[f64]| x[4410..].iter().map(|x| x * x).sum::<f64>();
        // To half a decibel.
        let now = struck(&played, sound.len());
        assert!((late(&now) / late(&sound) - 1.0).abs() < 0.12, "{}", late(&now) / late(&sound));
        assert!(left(&sound, &played) <= left(&sound, &modes), "{}", left(&sound, &played));
    }

    #[test]
    fn what_no_amplitudes_explain_is_never_worse_than_silence() {
        // A sound that begins 1500 samples late, and its mode.
        let mut one = vec![partial(0.3, 1e-4, 50.0)];
        let mut sound = vec![0.0; 2000];
        sound[1500..].iter_mut().enumerate().for_each(|(n, x)| *x = (0.3 * n as f64).sin());
        last_solve(&sound, &mut one, 1.2);
        assert!(left(&sound, &one) <= 1.0 + 1e-12, "{}", left(&sound, &one));
        assert!(peak_ratio(&sound, &one) <= 1.2 * (1.0 + 1e-9));
        // Amplitudes held at a limit that is far too low.
        let mut modes: Vec<Partial> = (0..8).map(|k| partial(0.1 + 0.05 * f64::from(k), 1e-3, 1.0)).collect();
        let sound = synthesise(&modes, 4000);
        last_solve(&sound, &mut modes, 0.2);
        assert!(left(&sound, &modes) < 1.0 && peak_ratio(&sound, &modes) <= 0.2 * (1.0 + 1e-9));
    }
}
