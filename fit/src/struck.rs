//! The struck body: what the engine plays when it strikes these modes once by their own impulse.
//!
//! The engine deposits an impulse under a cubic B-spline, whose weights 1/6, 4/6, 1/6 come one to three samples after the
//! strike, and undoes the kernel's response G and its latency of two samples mode by mode (`asperity_dsp::hertz`). So
//! with c the amplitude of a mode and z its pole
//!
//! ```text
//! G = (z + 4 + z⁻¹) / 6        s[0] = 0    s[1] = Re Σ c z²/6G    s[2] = Re Σ c (z³ + 4 z²)/6G    s[n] = Re Σ c zⁿ,  n ≥ 3
//! ```
//! (Where in its sample a strike falls changes modes above a third of the rate by up to 1.3 dB; this is its mean.)
//! A sound that begins at once is therefore met best by a strike that comes a sample or two before it ([`lead`]).

use crate::partial::Partial;
use crate::projection::synthesise;

/// Samples in which the kernel is heard.
pub(crate) const KERNEL: usize = 3;

/// `count` samples of the struck body from the strike on; amplitudes of `partials` stand at the strike.
#[must_use]
pub fn struck(partials: &[Partial], count: usize) -> Vec<f64> {
    let mut samples = synthesise(partials, count);
    for (sample, begins) in samples.iter_mut().zip(beginning(partials)) {
        *sample = begins;
    }
    samples
}

/// The first samples.
fn beginning(partials: &[Partial]) -> [f64; KERNEL] {
    let mut begins = [0.0; KERNEL];
    for partial in partials {
        let z = partial.pole();
        let scaled = partial.c * z * z / (z + 4.0 + z.inv());
        begins[1] += scaled.re;
        begins[2] += (scaled * (z + 4.0)).re;
    }
    begins
}

/// How many samples before `samples[onset]` the engine should strike `partials`, whose amplitudes stand at the onset, so
/// that the beginning errs least.
#[must_use]
pub fn lead(partials: &[Partial], samples: &[f64], onset: usize) -> usize {
    let window = &samples[onset.saturating_sub(KERNEL)..(onset + KERNEL).min(samples.len())];
    let error = |lead: usize| {
        let moved: Vec<Partial> = partials.iter().map(|p| p.moved(-(lead as f64))).collect();
        let silent = onset.min(KERNEL) - lead;
        let body = struck(&moved, window.len() - silent);
        let played = std::iter::repeat_n(0.0, silent).chain(body);
        window.iter().zip(played).map(|(x, y)| (x - y) * (x - y)).sum::<f64>()
    };
    let errors: Vec<f64> = (0..=onset.min(KERNEL)).map(error).collect();
    (0..errors.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::hertz::{HertzPulse, take};
    use asperity_dsp::modal_bank::{GroupOptions, ReferenceMode, ReferenceState};
    use asperity_dsp::mode::Mode;

    #[test]
    fn the_first_samples_are_those_of_the_engine_s_bank() {
        let rate = 44_100.0;
        let modes = [(700.0, 8.0, 0.5, 0.3), (5200.0, 200.0, 0.3, 1.5), (9_000.0, 900.0, 0.4, -2.0)].map(
            |(frequency_hz, decay_per_s, amplitude, phase_rad)| Mode {
                frequency_hz,
                decay_per_s,
                amplitude,
                phase_rad,
            },
        );
        let mut ring = [0.0; 64];
        HertzPulse { impulse_n_s: 1.0, contact_time_s: 0.0 }.deposit(&mut ring, 4, 0.0, rate);
        let mut impulses = [0.0_f32; 30];
        take(&mut ring, 0, &mut impulses);
        let mut played = [0.0; 30];
        for mode in &modes {
            let filter = ReferenceMode::new(mode, rate, &GroupOptions::IMPULSE_RING).unwrap();
            let mut state = ReferenceState::default();
            for (y, x) in played.iter_mut().zip(impulses) {
                *y += filter.tick(&mut state, f64::from(x));
            }
        }
        let partials = modes.map(|mode| crate::fitted::partial_of(&mode, rate));
        for (n, (said, played)) in struck(&partials, 20).iter().zip(&played[4..]).enumerate() {
            assert!((said - played).abs() < 5e-3, "{n}: {said} {played}");
        }
    }
}
