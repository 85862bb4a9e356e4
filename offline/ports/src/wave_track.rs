//! Wave track: the wave inside the device's range, followed by its phase.
//!
//! Between two nodes an oscillator whose frequency goes in a straight line advances by h (f_i +
//! f_{i+1})/2 turns. The frequency of the next node is that of the wave there, corrected by a part
//! of the phase that is missing, and kept inside the range.

use crate::felt::{RATE_HZ, analytic};
use asperity_fft::num_complex::Complex;
use std::f64::consts::TAU;

/// Part of the missing phase that a step makes up for.
const PULL: f64 = 0.7;

/// Amplitude and frequency at every node.
pub(crate) struct Wave {
    pub(crate) amplitude: Vec<f64>,
    pub(crate) hz: Vec<f64>,
}

pub(crate) fn track(samples: &[f64], time_s: &[f64], [lowest, highest]: [f64; 2]) -> Wave {
    // Edges of a fifth of an octave, outside the range.
    let edge = 2f64.powf(0.2);
    let z = analytic(samples, RATE_HZ, |hz| {
        let below = ((hz / (lowest / edge)).log2() / 0.2).clamp(0.0, 1.0);
        let above = (((highest * edge) / hz).log2() / 0.2).clamp(0.0, 1.0);
        below.min(above)
    });
    let at = |t: f64| {
        z.get((t * RATE_HZ).round() as usize).or(z.last()).copied().unwrap_or(Complex::new(0.0, 0.0))
    };
    let step_s = if time_s.len() > 1 { time_s[1] - time_s[0] } else { 1.0 };
    let own_hz = |t: f64| mean_hz(&z, t, step_s).clamp(lowest, highest);
    let mut hz = Vec::with_capacity(time_s.len());
    let mut phase = 0.0;
    let mut before = own_hz(0.0);
    for (i, &t) in time_s.iter().enumerate() {
        let mut next = own_hz(t);
        if i > 0 {
            // sin(2π φ) is the real part of z: φ = arg z / 2π + 1/4.
            let wanted = at(t).arg() / TAU + 0.25;
            let coming = phase + 0.5 * step_s * (before + next);
            let missing = (wanted - coming + 0.5).rem_euclid(1.0) - 0.5;
            next = (next + PULL * missing * 2.0 / step_s * 0.5).clamp(lowest, highest);
            phase = (phase + 0.5 * step_s * (before + next)).fract();
        }
        before = next;
        hz.push(next);
    }
    Wave { amplitude: time_s.iter().map(|t| at(*t).norm()).collect(), hz }
}

/// Frequency of the wave about a time, weighed by its power.
fn mean_hz(z: &[Complex<f64>], time_s: f64, step_s: f64) -> f64 {
    let middle = (time_s * RATE_HZ).round() as usize;
    let half = ((0.5 * step_s * RATE_HZ) as usize).max(4);
    let (first, last) = (middle.saturating_sub(half), (middle + half).min(z.len().saturating_sub(1)));
    let turning: Complex<f64> = (first..last).map(|n| z[n + 1] * z[n].conj()).sum();
    if turning.norm() > 0.0 { turning.arg() / TAU * RATE_HZ } else { 0.0 }
}
