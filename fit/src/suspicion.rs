//! What in a list of modes is not a ringing body: hum, tones that do not decay, decays that are no
//! exponential, pairs that cancel.

use crate::fitted::Warning;
use crate::noise_floor::NoiseFloor;
use crate::partial::Partial;
use asperity_fft::FftPlanner;
use nalgebra::Complex;
use std::f64::consts::PI;

/// Least nepers a mode must lose over the record to count as decaying.
const LEAST_FALL: f64 = 0.35;
/// Highest hum frequency, and how near to a multiple of the mains it must be, Hz.
const HIGHEST_HUM_HZ: f64 = 610.0;
const HUM_WIDTH_HZ: f64 = 0.4;
/// A hum is this far below the strongest mode, in energy.
const HUM_LEVEL: f64 = 0.03;
/// Share of a mode's energy that may remain around its frequency.
const EXPONENTIAL_SHARE: f64 = 0.01;
/// How many of the strongest modes are checked.
const CHECKED: usize = 8;

/// Removes undamped weak partials at multiples of the mains frequency.
pub fn take_hum(partials: &mut Vec<Partial>, count: usize, rate_hz: f64) -> Vec<Warning> {
    let strongest = partials.iter().map(|p| p.energy(count)).fold(0.0, f64::max);
    let mut warnings = Vec::new();
    partials.retain(|partial| {
        let hz = partial.omega * rate_hz / (2.0 * PI);
        let mains = [50.0, 60.0].into_iter().any(|m| {
            let multiple = (hz / m).round();
            multiple >= 1.0 && (hz - multiple * m).abs() < HUM_WIDTH_HZ
        });
        let hum = mains
            && hz < HIGHEST_HUM_HZ
            && partial.delta * (count as f64) < LEAST_FALL
            && partial.energy(count) < HUM_LEVEL * strongest;
        if hum {
            warnings.push(Warning::Hum { frequency_hz: hz });
        }
        !hum
    });
    warnings
}

/// Undamped, cancelling and non-exponential modes among the strongest.
#[must_use]
pub fn doubts(partials: &[Partial], residual: &[f64], noise: &NoiseFloor, rate_hz: f64) -> Vec<Warning> {
    let count = residual.len();
    let hz = |p: &Partial| p.omega * rate_hz / (2.0 * PI);
    let mut ranked: Vec<&Partial> = partials.iter().collect();
    ranked.sort_by(|a, b| b.energy(count).total_cmp(&a.energy(count)));
    let mut warnings: Vec<Warning> = ranked
        .iter()
        .filter(|p| p.delta * (count as f64) < LEAST_FALL)
        .map(|p| Warning::Undamped { frequency_hz: hz(p) })
        .collect();
    let spectrum = energy_spectrum(residual);
    for (rank, partial) in ranked.iter().take(CHECKED).enumerate() {
        if let Some(other) = ranked[rank + 1..].iter().find(|other| cancels(partial, other)) {
            let frequency_hz = hz(if partial.c.norm() > other.c.norm() { partial } else { other });
            warnings.push(Warning::Cancelling { frequency_hz });
        }
        let half_width = 4.0 * partial.delta + 8.0 * PI / count as f64;
        let bins_per_radian = spectrum.len() as f64 / PI;
        let from = ((partial.omega - half_width).max(0.0) * bins_per_radian) as usize;
        let to = (((partial.omega + half_width) * bins_per_radian) as usize + 1).min(spectrum.len());
        let left: f64 = spectrum[from.min(to)..to].iter().sum();
        let expected_noise = noise.variance_at(partial.omega) * count as f64 * (to - from.min(to)) as f64
            / spectrum.len() as f64;
        if partial.energy(count) < 0.1 * ranked[0].energy(count) {
            break;
        }
        let share = (left - 4.0 * expected_noise) / partial.energy(count).max(1e-300);
        if share > EXPONENTIAL_SHARE {
            warnings
                .push(Warning::NotExponential { frequency_hz: hz(partial), left_db: 10.0 * share.log10() });
        }
    }
    warnings
}

/// Whether two partials at nearly the same pole are far louder apart than together.
#[must_use]
pub fn cancels(a: &Partial, b: &Partial) -> bool {
    let near = (a.omega - b.omega).abs() < 0.5 * (a.delta + b.delta);
    near && (a.c + b.c).norm() < 0.15 * a.c.norm().max(b.c.norm())
}

/// Energy of `samples` per frequency bin, 0 to half the rate.
#[must_use]
pub fn energy_spectrum(samples: &[f64]) -> Vec<f64> {
    let size = samples.len().next_power_of_two().max(4);
    let mut buffer = vec![Complex::new(0.0, 0.0); size];
    buffer.iter_mut().zip(samples).for_each(|(b, &x)| b.re = x);
    FftPlanner::new().plan_fft_forward(size).process(&mut buffer);
    buffer[..size / 2].iter().map(|v| 2.0 * v.norm_sqr() / size as f64).collect()
}
