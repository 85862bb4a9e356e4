//! Stationary noise of any colour: nothing rings in it.
//!
//! White noise is shaped in the frequency domain over twice the length asked for, and a part from
//! its middle is cut out: its ends do not meet, as those of a recording do not.

use asperity_dsp::rng::Rng;
use asperity_fft::{FftPlanner, num_complex::Complex};
use std::f64::consts::PI;

/// A power spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Colour {
    /// Flat.
    White,
    /// A one-pole low-pass of this coefficient.
    Pole(f64),
    /// 1/f to this power, flat below a corner in Hz.
    Power(f64, f64),
    /// The running sum of white noise, wherever that leads: not stationary.
    Walk,
    /// The two-pole resonance of this quality: a frequency is drawn from 60 Hz to 6 kHz.
    Hump(f64),
    /// Butterworth filters of this order; a corner is drawn from 60 Hz to 6 kHz.
    LowPass(i32),
    /// See [`Colour::LowPass`].
    HighPass(i32),
}

/// Signal that a fit is tried on.
pub const COLOURS: [(&str, Colour); 18] = [
    ("white", Colour::White),
    ("pink, 1/f to 20 Hz", Colour::Power(1.0, 20.0)),
    ("pink, 1/f to 2 Hz", Colour::Power(1.0, 2.0)),
    ("one-pole 0.25", Colour::Pole(0.25)),
    ("one-pole 0.1", Colour::Pole(0.1)),
    ("one-pole 0.02", Colour::Pole(0.02)),
    ("one-pole 0.005", Colour::Pole(0.005)),
    ("one-pole 0.002", Colour::Pole(0.002)),
    ("brown, 1/f² to 20 Hz", Colour::Power(2.0, 20.0)),
    ("brown, 1/f² to 5 Hz", Colour::Power(2.0, 5.0)),
    ("1/f³ to 20 Hz", Colour::Power(3.0, 20.0)),
    ("1/f³ to 5 Hz", Colour::Power(3.0, 5.0)),
    ("random walk", Colour::Walk),
    ("hump of Q 1", Colour::Hump(1.0)),
    ("hump of Q 3", Colour::Hump(3.0)),
    ("low-pass of order 2", Colour::LowPass(2)),
    ("low-pass of order 4", Colour::LowPass(4)),
    ("high-pass of order 4", Colour::HighPass(4)),
];

/// `count` samples with a peak of 0.9; `bits`: rounded to so many, 0 for none.
pub fn noise(colour: Colour, count: usize, rate_hz: f64, bits: u32, seed: u64) -> Vec<f64> {
    let mut rng = Rng::new(seed);
    let mut samples = match colour {
        Colour::Walk => {
            let mut sum = 0.0;
            let mut next = || {
                sum += rng.normal();
                sum
            };
            (0..count).map(|_| next()).collect()
        }
        _ => shaped(colour, count, rate_hz, &mut rng),
    };
    let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let steps = 2.0_f64.powi(bits as i32 - 1);
    for x in &mut samples {
        *x *= 0.9 / peak;
        if bits > 0 {
            *x = (*x * steps).round() / steps;
        }
    }
    samples
}

fn shaped(colour: Colour, count: usize, rate_hz: f64, rng: &mut Rng) -> Vec<f64> {
    let corner_hz = 60.0 * 100.0_f64.powf(rng.uniform());
    let gain = |hz: f64| {
        let x = hz / corner_hz;
        match colour {
            Colour::White | Colour::Walk => 1.0,
            Colour::Pole(pole) => {
                let z = Complex::from_polar(1.0 - pole, -2.0 * PI * hz / rate_hz);
                pole / (1.0 - z).norm()
            }
            Colour::Power(power, corner_hz) => hz.max(corner_hz).powf(-0.5 * power),
            Colour::Hump(quality) => x / ((1.0 - x * x).powi(2) + (x / quality).powi(2)).sqrt(),
            Colour::LowPass(order) => 1.0 / (1.0 + x.powi(2 * order)).sqrt(),
            Colour::HighPass(order) => 1.0 / (1.0 + x.max(1e-9).powi(-2 * order)).sqrt(),
        }
    };
    let size = (2 * count).next_power_of_two();
    let mut buffer: Vec<Complex<f64>> = (0..size).map(|_| Complex::new(rng.normal(), 0.0)).collect();
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(size).process(&mut buffer);
    for (k, value) in buffer.iter_mut().enumerate() {
        *value *= gain(k.min(size - k) as f64 * rate_hz / size as f64);
    }
    planner.plan_fft_inverse(size).process(&mut buffer);
    buffer[size / 4..size / 4 + count].iter().map(|v| v.re).collect()
}
