//! Whitened sound: what the past of a recording does not predict, which is its strikes.
//!
//! A ringing body obeys a linear recurrence, a strike does not: in the error of a linear predictor
//! of the whole recording
//!
//! ```text
//! e[n] = x[n] − Σ_{k=1…P} a_k x[n − k]        Σ e² least  (autocorrelation method, Levinson 1947, Durbin 1960)
//! ```
//! the ringing is low, beats and hum are gone, and a second strike of a body that still rings
//! stands out as the first does.

/// Order of the predictor: sixteen resonances, more than are loud for long.
const ORDER: usize = 32;
/// White noise beside the sound, as a part of its power, so that silence is no reason for a perfect
/// prediction.
const RIDGE: f64 = 1e-9;

/// The prediction error of every sample, as many as there are.
#[must_use]
pub(super) fn whitened(samples: &[f64]) -> Vec<f64> {
    let coefficients = predictor(samples);
    let error = |n: usize| {
        let past = samples[n.saturating_sub(ORDER)..n].iter().rev();
        samples[n] - past.zip(&coefficients).map(|(x, a)| x * a).sum::<f64>()
    };
    (0..samples.len()).map(error).collect()
}

/// a of the best predictor; 0 of silence.
fn predictor(samples: &[f64]) -> Vec<f64> {
    let lagged = |lag: usize| -> f64 {
        samples.iter().zip(samples.get(lag..).unwrap_or_default()).map(|(a, b)| a * b).sum()
    };
    let mut r: Vec<f64> = (0..=ORDER).map(lagged).collect();
    r[0] *= 1.0 + RIDGE;
    let mut a: Vec<f64> = Vec::with_capacity(ORDER);
    let mut left = r[0];
    for order in 0..ORDER {
        if left <= 0.0 {
            break;
        }
        let known: f64 = a.iter().enumerate().map(|(k, a)| a * r[order - k]).sum();
        let reflection = (r[order + 1] - known) / left;
        let mirrored: Vec<f64> = a.iter().rev().copied().collect();
        a.iter_mut().zip(mirrored).for_each(|(a, b)| *a -= reflection * b);
        a.push(reflection);
        left *= 1.0 - reflection * reflection;
    }
    a.resize(ORDER, 0.0);
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_predictor_of_a_pole_is_that_pole() {
        let samples: Vec<f64> = (0..4000).map(|n| 0.9_f64.powi(n)).collect();
        let a = predictor(&samples);
        assert!((a[0] - 0.9).abs() < 1e-6 && a[1..].iter().all(|a| a.abs() < 1e-6), "{a:?}");
        assert!(predictor(&[0.0; 100]).iter().all(|a| *a == 0.0));
    }

    #[test]
    fn of_a_decay_only_its_first_sample_is_left() {
        let samples: Vec<f64> = (0..20_000)
            .map(f64::from)
            .map(|n| (-3e-4 * n).exp() * ((0.1 * n).sin() + (0.7 * n).cos()))
            .collect();
        let left = whitened(&samples);
        let peak = left[..40].iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        assert!(left[2000..].iter().all(|x| x.abs() < 0.05 * peak), "{peak}");
    }
}
