//! A struck body no louder than its recording.
//!
//! Modes that begin all at once are louder together than a striker that gives way, or strings of strikes, ever was: a
//! vibraphone's bar 3.3 dB, a glissando over bells 5.1 dB. Where the struck body would exceed the recording's peak by more than
//! a limit L, the amplitudes c of its modes (not their poles) are fitted anew,
//!
//! ```text
//! min_c  Σ_n w[n] (y[n] − Σ_k Re c_k z_kⁿ)²          w = 1, and W where the body was too loud
//! ```
//! to what they played themselves, y, clipped to L where it was louder; W is tripled, and the places where the body still
//! is too loud are added, until none is left. What rings on after the last sample that was too loud has 100 times the
//! weight, so that what gives way is the attack's. If that does not end, all are made quieter alike, so
//! that the limit holds whatever the recording is.

use crate::body::struck::struck;
use crate::sinusoid::amplitudes::amplitude_gram;
use crate::sinusoid::normal_equations::Scaled;
use crate::sinusoid::partial::Partial;
use nalgebra::{Complex, DMatrix, DVector};

/// Weight of a sample that is too loud, at first, and its growth a round.
const WEIGHT: f64 = 10.0;
const HEAVIER: f64 = 3.0;
/// Weight of what rings on after the last sample that is too loud.
const LATE: f64 = 100.0;
/// Most rounds.
const ROUNDS: usize = 14;
/// What is clipped is clipped to this part of the limit.
const AIM: f64 = 0.97;
/// Weight of what the amplitudes are, against what the samples say: modes that coincide stay as they are.
const RIDGE: f64 = 1e-9;

/// Makes `partials`, struck at the first sample of `sound`, no louder than `limit` times its peak; says by what factor they
/// were louder than it, if they were.
pub fn no_louder(sound: &[f64], partials: &mut [Partial], limit: f64) -> Option<f64> {
    let most = peak(sound);
    let before = peak(&struck(partials, sound.len())) / most.max(1e-300);
    if before <= limit || partials.is_empty() {
        return None;
    }
    if !refitted(sound.len(), partials, limit * most) {
        let now = peak(&struck(partials, sound.len()));
        let quieter = (limit * most / now.max(1e-300)).min(1.0);
        partials.iter_mut().for_each(|p| p.c *= quieter);
    }
    Some(before)
}

/// Whether amplitudes were found with which nothing exceeds `most`; `partials` gets those nearest to it.
fn refitted(count: usize, partials: &mut [Partial], most: f64) -> bool {
    let gram = amplitude_gram(partials, count);
    let now = DVector::from_iterator(2 * partials.len(), partials.iter().flat_map(|p| [p.c.re, p.c.im]));
    let right = &gram * now;
    let (gram, right) = held_after(last_loud(partials, count, most), &gram, &right, partials, count);
    let mut loud: Vec<Option<f64>> = vec![None; count];
    let mut weight = WEIGHT;
    for _ in 0..ROUNDS {
        let mut exceeded = false;
        for (loud, y) in loud.iter_mut().zip(struck(partials, count)) {
            if y.abs() > most {
                *loud = Some(AIM * most * y.signum());
                exceeded = true;
            }
        }
        if !exceeded {
            return true;
        }
        let (mut gram, mut right) = (gram.clone(), right.clone());
        weigh(&mut gram, &mut right, partials, &loud, weight);
        let Some(system) = Scaled::new(&gram, RIDGE) else { return false };
        let solution = system.solve(&right);
        for (k, partial) in partials.iter_mut().enumerate() {
            partial.c = Complex::new(solution[2 * k], solution[2 * k + 1]);
        }
        weight *= HEAVIER;
    }
    peak(&struck(partials, count)) <= most
}

/// Where the struck body is louder than `most` for the last time.
fn last_loud(partials: &[Partial], count: usize, most: f64) -> usize {
    struck(partials, count).iter().rposition(|y| y.abs() > most).unwrap_or(0)
}

/// The normal equations with `LATE` times the weight on what rings on after the sample `from`.
fn held_after(
    from: usize,
    gram: &DMatrix<f64>,
    right: &DVector<f64>,
    partials: &[Partial],
    count: usize,
) -> (DMatrix<f64>, DVector<f64>) {
    let there: Vec<Partial> = partials.iter().map(|p| p.moved(from as f64)).collect();
    let late = amplitude_gram(&there, count - from);
    // An amplitude there is the one of the first sample, turned and damped.
    let mut turned = DMatrix::zeros(gram.nrows(), gram.ncols());
    for (k, z) in partials.iter().map(|p| p.power(from as f64)).enumerate() {
        let (re, im) = (2 * k, 2 * k + 1);
        turned[(re, re)] = z.re;
        turned[(re, im)] = -z.im;
        turned[(im, re)] = z.im;
        turned[(im, im)] = z.re;
    }
    let now = DVector::from_iterator(2 * partials.len(), partials.iter().flat_map(|p| [p.c.re, p.c.im]));
    let late = turned.transpose() * late * &turned * LATE;
    (gram + &late, right + late * now)
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

    #[test]
    fn a_body_that_began_softly_is_no_louder_when_it_is_struck_and_rings_on_alike() {
        // Twelve modes in step, faded in over 3 ms as a mallet does.
        let modes: Vec<Partial> =
            (0..12).map(|k| partial(0.02 * 1.35_f64.powi(k), 2e-4 * 1.4_f64.powi(k), 0.1)).collect();
        let mut sound = synthesise(&modes, 22_050);
        sound[..132].iter_mut().enumerate().for_each(|(n, x)| *x *= n as f64 / 132.0);
        let mut played = modes.clone();
        // The modes by themselves reach 1.079 of the recording.
        let limit = 1.03;
        let before = no_louder(&sound, &mut played, limit).unwrap();
        assert!(before > limit, "{before}");
        let now = struck(&played, sound.len());
        assert!(peak(&now) <= limit * peak(&sound) * (1.0 + 1e-9), "{}", peak(&now) / peak(&sound));
        let late = |x: &[f64]| x[4410..].iter().map(|x| x * x).sum::<f64>();
        // To half a decibel.
        assert!((late(&now) / late(&sound) - 1.0).abs() < 0.12, "{}", late(&now) / late(&sound));
        // What is quiet enough is not touched.
        let same = played.clone();
        assert_eq!(no_louder(&sound, &mut played, 2.0), None);
        assert_eq!(played, same);
    }

    #[test]
    fn what_no_amplitudes_make_quiet_enough_is_made_quieter_as_a_whole() {
        let mut one = vec![partial(0.3, 1e-4, 1.0)];
        let mut sound = vec![0.0; 2000];
        sound[1500..].iter_mut().enumerate().for_each(|(n, x)| *x = (0.3 * n as f64).sin());
        one[0].c *= 50.0;
        assert!(no_louder(&sound, &mut one, 1.2).is_some());
        assert!(peak(&struck(&one, 2000)) <= 1.2 * peak(&sound) * (1.0 + 1e-9));
    }
}
