//! Suspicious modes, which no ringing body has: hum, tones that do not decay, decays that are no
//! exponential, pairs that cancel.

use crate::noise::noise_floor::NoiseFloor;
use crate::proof::warning::Warning;
use crate::sinusoid::partial::Partial;
use asperity_fft::FftPlanner;
use nalgebra::Complex;
use std::f64::consts::PI;

/// Least nepers a mode must lose over the sound to count as decaying. A mode that loses just these
/// has a T60 of 6.9 / 0.345 = 20 times the length of the sound: nothing is known to ring longer.
const LEAST_FALL: f64 = 3.0 * std::f64::consts::LN_10 / 20.0;
/// Highest hum frequency, and how near to a multiple of the mains it must be, Hz.
const HIGHEST_HUM_HZ: f64 = 610.0;
const HUM_WIDTH_HZ: f64 = 0.4;
/// Resolution of a frequency over the length of the sound, in periods: shorter sounds cannot tell
/// hum from partials.
const RESOLUTION: f64 = 0.5;
/// A tone of the mains that does not decay is hum if it is fainter than this part of the loudest
/// mode, in amplitude.
const HUM_AMPLITUDE: f64 = 0.5;
/// Any other that does not decay is no mode if it is this far below the strongest one, in energy.
const FAINT: f64 = 0.03;
/// Share of a mode's energy that may remain around its frequency.
const EXPONENTIAL_SHARE: f64 = 0.01;
/// Number of the strongest modes that are checked.
const CHECKED: usize = 8;

/// Removes tones of the mains and other faint ones that do not decay within `count` samples, and
/// lets the rest ring for at most twenty times these.
pub fn remove_undamped(partials: &mut Vec<Partial>, count: usize, rate_hz: f64) -> Vec<Warning> {
    let strongest = partials.iter().map(|p| p.energy(count)).fold(0.0, f64::max);
    let loudest = partials.iter().map(|p| p.c.norm()).fold(0.0, f64::max);
    let hz = |p: &Partial| p.omega * rate_hz / (2.0 * PI);
    let slowest = LEAST_FALL / count as f64;
    let told_apart = RESOLUTION * rate_hz / (count as f64) < HUM_WIDTH_HZ;
    let of_mains = |p: &Partial| {
        let near = |mains: f64| {
            let multiple = (hz(p) / mains).round();
            multiple >= 1.0 && (hz(p) - multiple * mains).abs() < HUM_WIDTH_HZ
        };
        told_apart && hz(p) < HIGHEST_HUM_HZ && (near(50.0) || near(60.0))
    };
    let mut tones = [Group::default(), Group::default(), Group::default()];
    partials.retain_mut(|partial| {
        if partial.delta >= slowest {
            return true;
        }
        let energy = partial.energy(count);
        // A tone that goes on outweighs in energy modes that are far louder while they ring.
        let hum = of_mains(partial) && partial.c.norm() < HUM_AMPLITUDE * loudest;
        let kind = if hum { 2 } else { usize::from(energy < FAINT * strongest) };
        tones[kind].add(hz(partial), energy);
        partial.delta = slowest;
        kind == 0
    });
    let [undamped, steady, hum] = tones;
    [
        undamped.to_warning(|count, frequency_hz| Warning::Undamped { count, frequency_hz }),
        steady.to_warning(|count, frequency_hz| Warning::Steady { count, frequency_hz }),
        hum.to_warning(|count, frequency_hz| Warning::Hum { count, frequency_hz }),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Number of a kind, and the one that weighs most.
#[derive(Default)]
struct Group {
    count: usize,
    most: f64,
    frequency_hz: f64,
}

impl Group {
    fn add(&mut self, frequency_hz: f64, weight: f64) {
        if self.count == 0 || weight > self.most {
            (self.most, self.frequency_hz) = (weight, frequency_hz);
        }
        self.count += 1;
    }

    fn to_warning(&self, warning: impl Fn(usize, f64) -> Warning) -> Option<Warning> {
        (self.count > 0).then(|| warning(self.count, self.frequency_hz))
    }
}

/// Cancelling and non-exponential modes among the strongest.
#[must_use]
pub fn doubts(partials: &[Partial], residual: &[f64], noise: &NoiseFloor, rate_hz: f64) -> Vec<Warning> {
    let count = residual.len();
    let hz = |p: &Partial| p.omega * rate_hz / (2.0 * PI);
    let mut ranked: Vec<&Partial> = partials.iter().collect();
    ranked.sort_by(|a, b| b.energy(count).total_cmp(&a.energy(count)));
    let (mut cancelling, mut crooked) = (Group::default(), Group::default());
    let spectrum = energy_spectrum(residual);
    for (rank, partial) in ranked.iter().take(CHECKED).enumerate() {
        if let Some(other) = ranked[rank + 1..].iter().find(|other| cancels(partial, other)) {
            let (louder, size) = if partial.c.norm() > other.c.norm() {
                (partial, partial.c.norm())
            } else {
                (other, other.c.norm())
            };
            cancelling.add(hz(louder), size);
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
            crooked.add(hz(partial), share);
        }
    }
    let left_db = 10.0 * crooked.most.log10();
    let cancelling = cancelling.to_warning(|count, frequency_hz| Warning::Cancelling { count, frequency_hz });
    let crooked =
        crooked.to_warning(|count, frequency_hz| Warning::NotExponential { count, frequency_hz, left_db });
    cancelling.into_iter().chain(crooked).collect()
}

/// Tests whether two partials at nearly the same pole are far louder apart than together.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hum_that_outlasts_a_short_body_is_no_mode_of_it() {
        // 26 dB under a body that is over in 60 ms it has half its energy in 2 s, and was once kept
        // to ring for 40 s.
        let partial = |hz: f64, decay_per_s: f64, c: f64| Partial {
            omega: 2.0 * PI * hz / 44_100.0,
            delta: decay_per_s / 44_100.0,
            c: Complex::new(c, 0.0),
        };
        let body = partial(900.0, 100.0, 1.0);
        let mut partials = vec![body, partial(50.01, 0.001, 0.05), partial(149.98, 0.01, 0.01)];
        let warnings = remove_undamped(&mut partials, 88_200, 44_100.0);
        assert_eq!(partials, [body]);
        let [Warning::Hum { count: 2, frequency_hz }] = warnings[..] else { panic!("{warnings:?}") };
        assert!((frequency_hz - 50.01).abs() < 1e-6, "{frequency_hz}");
    }
}
