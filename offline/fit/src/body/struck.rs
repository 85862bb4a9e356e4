//! The struck body: what the engine plays when it strikes these modes once by their own impulse.
//!
//! With c the amplitude of a mode and z its pole, a strike that falls on a sample gives
//!
//! ```text
//! s[0] = 0          s[n] = Re Σ c zⁿ,  n ≥ 1
//! ```
//! The sample of the strike itself is silent: the force has not acted yet. A sound that begins at
//! once is therefore met by a strike one sample before it ([`lead`]). (A striker that is not
//! infinitely hard rounds the first samples off.)

use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::synthesise;

/// `count` samples of the struck body from the strike on; amplitudes of `partials` stand at the
/// strike.
#[must_use]
pub fn struck(partials: &[Partial], count: usize) -> Vec<f64> {
    let mut samples = synthesise(partials, count);
    if let Some(first) = samples.first_mut() {
        *first = 0.0;
    }
    samples
}

/// Number of samples before `samples[onset]` at which the engine should strike `partials`, whose
/// amplitudes stand at the onset: one, where the sound begins with more than half of what the modes
/// do.
#[must_use]
pub fn lead(partials: &[Partial], samples: &[f64], onset: usize) -> usize {
    let begins: f64 = partials.iter().map(|p| p.c.re).sum();
    let silence_errs_more = samples[onset].abs() > (samples[onset] - begins).abs();
    usize::from(onset > 0 && silence_errs_more)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::hertz::{HertzPulse, KERNEL_LATENCY, take};
    use asperity_dsp::modal_bank::{GroupOptions, OnsetCorrection, ReferenceMode, ReferenceState};
    use asperity_dsp::mode::Mode;

    #[test]
    fn reported_strikes_are_what_the_engine_plays() {
        let rate = 44_100.0;
        let modes = [(700.0, 8.0, 0.5, 0.3), (5200.0, 200.0, 0.3, 1.5), (9_000.0, 900.0, 0.4, -2.0)].map(
            |(frequency_hz, decay_per_s, amplitude, phase_rad)| Mode {
                frequency_hz,
                decay_per_s,
                amplitude,
                phase_rad,
            },
        );
        let pulse = HertzPulse::elastic(1.0, 0.0);
        let (mut ring, mut early) = ([0.0; 64], [0.0_f32; 64]);
        pulse.deposit(&mut ring, 4, 0.0, rate);
        OnsetCorrection::new(modes, rate).unwrap().deposit(&pulse, &mut early, 4, 0.0, rate);
        let mut impulses = [0.0_f32; 30];
        take(&mut ring, 0, &mut impulses);
        let mut played: Vec<f64> = early[..30].iter().map(|&x| f64::from(x)).collect();
        for mode in &modes {
            let filter = ReferenceMode::new(mode, rate, &GroupOptions::IMPULSE_RING).unwrap();
            let mut state = ReferenceState::default();
            for (y, x) in played.iter_mut().zip(impulses) {
                *y += filter.tick(&mut state, f64::from(x));
            }
        }
        let partials = modes.map(|mode| crate::body::fitted::partial_of(&mode, rate));
        for (n, (said, played)) in struck(&partials, 20).iter().zip(&played[4 + KERNEL_LATENCY..]).enumerate()
        {
            assert!((said - played).abs() < 5e-3, "{n}: {said} {played}");
        }
    }
}
