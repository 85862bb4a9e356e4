//! Pitch and decay of a ringing sine, from how the phase and the level of its complex envelope run.

use std::f64::consts::TAU;

/// Length of the response that is looked at, s.
pub const LENGTH_S: f64 = 5.0;
const WINDOW_S: f64 = 1.0;
const HOP_S: f64 = 0.05;

pub struct Ring {
    pub frequency_hz: f64,
    pub decay_per_s: f64,
}

impl Ring {
    /// Frequency and decay of a ring at about `near_hz` (within 5 Hz).
    pub fn of(response: &[f32], rate_hz: f64, near_hz: f64) -> Self {
        let window = (WINDOW_S * rate_hz) as usize;
        let hop = (HOP_S * rate_hz) as usize;
        let starts: Vec<usize> = (0..response.len().saturating_sub(window)).step_by(hop).collect();
        let (mut phase, mut turns, mut phases, mut levels) = (0.0, 0.0, Vec::new(), Vec::new());
        for start in &starts {
            let (re, im) = envelope(&response[*start..start + window], *start, rate_hz, near_hz);
            let now = im.atan2(re);
            turns -= ((now - phase) / TAU).round();
            phase = now;
            phases.push(now + TAU * turns);
            levels.push(0.5 * (re * re + im * im).ln());
        }
        let hop_s = hop as f64 / rate_hz;
        Self { frequency_hz: near_hz + slope(&phases) / hop_s / TAU, decay_per_s: -slope(&levels) / hop_s }
    }
}

/// The response times e^(−jωn), under a Hann window squared: what is not near ω is gone.
fn envelope(response: &[f32], start: usize, rate_hz: f64, near_hz: f64) -> (f64, f64) {
    let (mut re, mut im) = (0.0, 0.0);
    for (n, y) in response.iter().enumerate() {
        let hann = (std::f64::consts::PI * (n as f64 + 0.5) / response.len() as f64).sin().powi(4);
        let angle = TAU * near_hz * (start + n) as f64 / rate_hz;
        re += f64::from(*y) * hann * angle.cos();
        im -= f64::from(*y) * hann * angle.sin();
    }
    (re, im)
}

/// Slope of the straight line through equally spaced values, a step.
fn slope(values: &[f64]) -> f64 {
    let middle = 0.5 * (values.len() as f64 - 1.0);
    let at = |i: usize| i as f64 - middle;
    let products: f64 = values.iter().enumerate().map(|(i, v)| at(i) * v).sum();
    products / (0..values.len()).map(|i| at(i) * at(i)).sum::<f64>()
}
