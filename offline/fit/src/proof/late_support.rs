//! Late support: modes that go on after the recording has gone silent at their frequency.
//!
//! A short burst of noise is fitted well by modes of any decay: over 5 ms none of them is known,
//! and where the body would be too loud its long ones are bent a little for the attack's sake. What
//! the recording has later tells them apart. With r what the body leaves of the recording from 50
//! ms after the strike on, c the amplitude of a mode there and z its pole,
//!
//! ```text
//! p = 2 Σ r[n] z̄ⁿ / Σ |z|²ⁿ        |c + p| < |c| / 2: not supported
//! ```
//! c + p is what the recording has of the mode if all others are as they are.

use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::correlate_values;
use std::f64::consts::LN_10;

/// Time from the strike on after which the recording is asked, s.
const LATE_S: f64 = 0.05;
/// Nepers by which a mode that is asked falls at most in the sound: 60 dB. Shorter ones bend as the
/// attack and the room have it, and are silent in the end.
const FALLS: f64 = 3.0 * LN_10;
/// Least part of a mode that the recording has.
const SUPPORTED: f64 = 0.5;

/// The partials, at the first sample of `residual`, that the recording does not have later.
pub(crate) fn unsupported(partials: &[Partial], residual: &[f64], rate_hz: f64) -> Vec<Partial> {
    let from = ((LATE_S * rate_hz) as usize).min(residual.len() / 2);
    let late: Vec<Partial> = partials.iter().map(|p| p.moved(from as f64)).collect();
    let residual = &residual[from..];
    let missing = correlate_values(residual, &late);
    let found = partials.iter().zip(&late).zip(missing);
    let unsupported = found.filter(|((partial, late), missing)| {
        // Σ |z|²ⁿ / 2 is the energy of the mode over its amplitude squared.
        let missing = missing.conj() * late.c.norm_sqr() / late.energy(residual.len());
        partial.delta * (residual.len() as f64) < FALLS
            && (late.c + missing).norm() < SUPPORTED * late.c.norm()
    });
    unsupported.map(|((partial, _), _)| *partial).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sinusoid::projection::synthesise;
    use asperity_dsp::rng::Rng;
    use nalgebra::Complex;
    use std::f64::consts::PI;

    const RATE_HZ: f64 = 44_100.0;

    fn partial(hz: f64, t60_s: f64, c: f64) -> Partial {
        let delta = 6.9 / (t60_s * RATE_HZ);
        Partial { omega: 2.0 * PI * hz / RATE_HZ, delta, c: Complex::from_polar(c, 0.8) }
    }

    #[test]
    fn a_line_over_a_recording_that_is_silent_there_is_not_supported() {
        let mut rng = Rng::new(3);
        let real = [partial(523.0, 1.15, 0.5), partial(2000.0, 0.3, 0.05), partial(2003.0, 0.5, 0.04)];
        let mut sound = synthesise(&real, 80_000);
        for (n, x) in sound.iter_mut().enumerate() {
            let burst = if n < 220 { 0.3 } else { 2e-4 };
            *x += burst * rng.normal();
        }
        let phantom = partial(18_000.0, 6.3, 1e-4);
        let quick = partial(9000.0, 0.005, 1.0);
        let all = [&real[..], &[phantom, quick]].concat();
        let body = synthesise(&all, sound.len());
        let residual: Vec<f64> = sound.iter().zip(body).map(|(x, y)| x - y).collect();
        let found = unsupported(&all, &residual, RATE_HZ);
        assert!(found.len() == 1 && found[0].omega == phantom.omega, "{found:?}");
    }
}
