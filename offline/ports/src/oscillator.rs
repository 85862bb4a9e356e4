//! Oscillator: what is left of a clip, as the device plays it.
//!
//! ```text
//! y(n) = a(n) sin(2π φ(n))      φ(n + 1) = φ(n) + f(n)/rate
//! ```
//! with a and f in straight lines between their points. A stroke adds a wave of its own, from the
//! dull shape to the sharp one by its frequency, and lowers the envelope meanwhile. This is the
//! rule of Meta's public renderer, in `f64`.

use crate::clip::{Clip, Emphasis};
use crate::device::Device;
use std::f64::consts::TAU;

/// Renders a clip at `rate_hz`; it begins at time 0 and ends with its last amplitude point.
#[must_use]
pub fn rendered(clip: &Clip, device: &Device, rate_hz: f64) -> Vec<f64> {
    let mut strokes = clip.amplitude.iter().filter_map(|p| p.emphasis.map(|e| (p.time_s, e))).peekable();
    let mut stroke: Option<Sounding> = None;
    let mut phase = 0.0_f64;
    clip.sampled(rate_hz)
        .enumerate()
        .map(|(n, (amplitude, frequency))| {
            let time_s = n as f64 / rate_hz;
            while let Some((_, emphasis)) = strokes.next_if(|(begins_s, _)| *begins_s <= time_s) {
                stroke = Some(Sounding::new(emphasis, device, rate_hz));
            }
            let extra = stroke.as_mut().and_then(Sounding::next);
            let ducking = if extra.is_some() { device.emphasis.ducking } else { 1.0 };
            let y = amplitude * ducking * (TAU * phase).sin();
            phase = (phase + device.hz(frequency) / rate_hz).fract();
            y + extra.unwrap_or(0.0)
        })
        .collect()
}

/// A stroke on its way.
struct Sounding {
    left: usize,
    phase: f64,
    step: f64,
    amplitude: f64,
    sharpness: f64,
    square: [bool; 2],
}

impl Sounding {
    fn new(emphasis: Emphasis, device: &Device, rate_hz: f64) -> Self {
        let (dull, sharp, part) = (device.emphasis.dull, device.emphasis.sharp, emphasis.frequency);
        let between = |a: f64, b: f64| a + part * (b - a);
        Self {
            left: (between(dull.duration_s, sharp.duration_s) * rate_hz) as usize,
            phase: 0.0,
            step: between(dull.hz, sharp.hz) / rate_hz,
            amplitude: emphasis.amplitude,
            sharpness: part,
            square: [dull.square, sharp.square],
        }
    }

    fn next(&mut self) -> Option<f64> {
        self.left = self.left.checked_sub(1)?;
        let wave = |square: bool| match square {
            true => {
                if self.phase < 0.5 {
                    1.0
                } else {
                    -1.0
                }
            }
            false => (TAU * self.phase).sin(),
        };
        let y = (1.0 - self.sharpness) * wave(self.square[0]) + self.sharpness * wave(self.square[1]);
        self.phase = (self.phase + self.step).fract();
        Some(self.amplitude * y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::{AmplitudePoint, FrequencyPoint};

    fn flat(amplitude: f64, frequency: f64, emphasis: Option<Emphasis>) -> Clip {
        let point = |time_s, emphasis| AmplitudePoint { time_s, amplitude, emphasis };
        Clip {
            amplitude: vec![point(0.0, None), point(0.1, emphasis), point(0.5, None)],
            frequency: vec![FrequencyPoint { time_s: 0.0, frequency }],
            ..Clip::default()
        }
    }

    #[test]
    fn two_flat_envelopes_are_a_sine() {
        let y = rendered(&flat(0.4, 1.0, None), &Device::quest(), 8000.0);
        assert_eq!(y.len(), 4000);
        for (n, y) in y.iter().enumerate() {
            assert!((y - 0.4 * (TAU * 200.0 * n as f64 / 8000.0).sin()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_stroke_lasts_by_its_sharpness_and_lowers_the_envelope() {
        for (frequency, samples) in [(0.0, 291), (1.0, 96)] {
            let stroke = Some(Emphasis { amplitude: 1.0, frequency });
            let plain = rendered(&flat(0.4, 1.0, None), &Device::quest(), 8000.0);
            let struck = rendered(&flat(0.4, 1.0, stroke), &Device::quest(), 8000.0);
            let differ: Vec<usize> = (0..4000).filter(|n| (plain[*n] - struck[*n]).abs() > 1e-9).collect();
            assert!(*differ.first().unwrap() >= 800 && *differ.last().unwrap() < 800 + samples, "{differ:?}");
        }
    }
}
