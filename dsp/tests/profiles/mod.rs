//! Profiles in continuous time, so that any rate samples the same surface. The script
//! `independent/micro_contact_reference.py` has the same formulas.
#![allow(dead_code)]

use std::f64::consts::PI;

/// Seconds of each profile.
pub const DURATION_S: f64 = 0.4;
/// Jumps take this long: the footprint of the skin, two samples at 44.1 kHz.
pub const JUMP_S: f64 = 2.0 / 44_100.0;

/// A height and a force over time, both starting from rest.
#[derive(Debug, Clone, Copy)]
pub struct Profile {
    pub name: &'static str,
    pub shape: Shape,
    pub force: Force,
}

#[derive(Debug, Clone, Copy)]
pub enum Shape {
    /// Amplitude, frequency.
    Sine(f64, f64),
    /// Relief, frequency: rises over a period, then falls at once.
    Sawtooth(f64, f64),
    /// Height, width (s), period (s) of Gaussian ridges.
    Ridge(f64, f64, f64),
    /// Up by this at 0.1 s, down at 0.25 s.
    Step(f64),
    /// α, octave rms at 1 mm, speed m/s, seed.
    Fractal(f64, f64, f64, f64),
    /// Amplitude, wavelength, speed reached at the end.
    Sweep(f64, f64, f64),
    /// Amplitude, frequency: |sine| with kinks below.
    Cusps(f64, f64),
    /// Two sines: amplitude and frequency of each.
    Chord(f64, f64, f64, f64),
}

#[derive(Debug, Clone, Copy)]
pub enum Force {
    Constant(f64),
    /// From, to, at 0.1 s within one 44.1 kHz sample pair.
    Step(f64, f64),
    /// Mean, amplitude, frequency.
    Swing(f64, f64, f64),
}

/// Smooth step from 0 at t = 0 to 1 at t = width.
fn rise(t: f64, width: f64) -> f64 {
    let x = (t / width).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

fn frac(x: f64) -> f64 {
    x - x.floor()
}

fn fractal(alpha: f64, rms_m: f64, speed_m_s: f64, seed: f64, t: f64) -> f64 {
    (0..44)
        .map(|k| {
            let (amplitude, omega, phase) = partial(k, alpha, rms_m, speed_m_s, seed);
            amplitude * (omega * t + phase).sin()
        })
        .sum()
}

/// Amplitude, angular frequency and phase of the k-th of four sines an octave.
fn partial(k: i32, alpha: f64, rms_m: f64, speed_m_s: f64, seed: f64) -> (f64, f64, f64) {
    let octave = f64::from(k) / 4.0;
    let wavelength = 0.032 * (-octave).exp2();
    let amplitude = rms_m * ((octave - 5.0) * (1.0 - alpha) / 2.0).exp2() / 2.0_f64.sqrt();
    let phase = 2.0 * PI * frac((f64::from(k * k) + seed) * 0.618_033_988_749_894_9);
    (amplitude, 2.0 * PI * speed_m_s / wavelength, phase)
}

impl Profile {
    /// Height, m. The first 20 ms fade in.
    pub fn height_m(&self, t: f64) -> f64 {
        let fade = rise(t, 0.02);
        fade * match self.shape {
            Shape::Sine(a, f) => a * (2.0 * PI * f * t).sin(),
            Shape::Sawtooth(a, f) => {
                let x = frac(f * t);
                let fall = f * JUMP_S;
                if x < 1.0 - fall { a * x / (1.0 - fall) } else { a * (1.0 - rise(x - 1.0 + fall, fall)) }
            }
            Shape::Ridge(a, w, period) => {
                let x = (frac(t / period) - 0.5) * period / w;
                a * (-x * x).exp()
            }
            Shape::Step(a) => a * (rise(t - 0.1, JUMP_S) - rise(t - 0.25, JUMP_S)),
            Shape::Fractal(alpha, rms, v, seed) => fractal(alpha, rms, v, seed, t),
            Shape::Sweep(a, wavelength, v) => {
                a * (2.0 * PI * (0.5 * v / DURATION_S * t * t) / wavelength).sin()
            }
            Shape::Cusps(a, f) => a * (PI * f * t).sin().abs(),
            Shape::Chord(a, f, b, g) => a * (2.0 * PI * f * t).sin() + b * (2.0 * PI * g * t).sin(),
        }
    }

    /// Heights at `rate_hz` from t = 0; the sines of a fractal by rotation, which is much faster.
    pub fn heights_m(&self, rate_hz: f64) -> Vec<f64> {
        let count = (DURATION_S * rate_hz) as usize;
        let time = |n: usize| n as f64 / rate_hz;
        let Shape::Fractal(alpha, rms, speed, seed) = self.shape else {
            return (0..count).map(|n| self.height_m(time(n))).collect();
        };
        let mut heights = vec![0.0; count];
        for k in 0..44 {
            let (amplitude, omega, phase) = partial(k, alpha, rms, speed, seed);
            let (turn_sin, turn_cos) = (omega / rate_hz).sin_cos();
            let (mut sin, mut cos) = phase.sin_cos();
            for height in &mut heights {
                *height += amplitude * sin;
                (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
            }
        }
        for (n, height) in heights.iter_mut().enumerate() {
            *height *= rise(time(n), 0.02);
        }
        heights
    }

    /// Forces at `rate_hz` from t = 0.
    pub fn forces_n(&self, rate_hz: f64) -> Vec<f64> {
        (0..(DURATION_S * rate_hz) as usize).map(|n| self.force_n(n as f64 / rate_hz)).collect()
    }

    /// Force, N.
    pub fn force_n(&self, t: f64) -> f64 {
        match self.force {
            Force::Constant(f) => f,
            Force::Step(from, to) => from + (to - from) * rise(t - 0.1, JUMP_S),
            Force::Swing(mean, a, f) => mean + rise(t, 0.02) * a * (2.0 * PI * f * t).sin(),
        }
    }
}

/// The twelve profiles of the specification.
pub const SUITE: [Profile; 12] = [
    Profile { name: "sine 0.1 m/s", shape: Shape::Sine(5e-5, 100.0), force: Force::Constant(0.5) },
    Profile { name: "sine 1 m/s", shape: Shape::Sine(5e-5, 1000.0), force: Force::Constant(0.5) },
    Profile { name: "sawtooth", shape: Shape::Sawtooth(2e-4, 100.0), force: Force::Constant(0.5) },
    Profile { name: "ridge", shape: Shape::Ridge(5e-4, 0.004, 0.05), force: Force::Constant(0.5) },
    Profile { name: "step", shape: Shape::Step(1e-4), force: Force::Constant(0.5) },
    Profile { name: "fractal 1", shape: Shape::Fractal(1.0, 5e-6, 0.2, 0.0), force: Force::Constant(0.5) },
    Profile { name: "fractal 1.5", shape: Shape::Fractal(1.5, 5e-6, 0.2, 1.0), force: Force::Constant(0.5) },
    Profile { name: "fractal 2", shape: Shape::Fractal(2.0, 5e-6, 0.2, 2.0), force: Force::Constant(0.5) },
    Profile { name: "fractal 2.5", shape: Shape::Fractal(2.5, 5e-6, 0.2, 3.0), force: Force::Constant(0.5) },
    Profile {
        name: "fractal 1 light",
        shape: Shape::Fractal(1.0, 5e-6, 0.2, 4.0),
        force: Force::Constant(0.02),
    },
    Profile { name: "force step", shape: Shape::Fractal(2.0, 5e-6, 0.2, 5.0), force: Force::Step(0.0, 5.0) },
    Profile { name: "sweep", shape: Shape::Sweep(5e-5, 1e-3, 1.0), force: Force::Constant(0.5) },
];

/// Twelve others, written down after the integrators and never used to tune them.
pub const HELD_OUT: [Profile; 12] = [
    Profile { name: "sine 3 mm", shape: Shape::Sine(8e-5, 47.0), force: Force::Constant(0.3) },
    Profile { name: "sine fast light", shape: Shape::Sine(2e-5, 1730.0), force: Force::Constant(0.2) },
    Profile { name: "cusps", shape: Shape::Cusps(1e-4, 130.0), force: Force::Constant(0.8) },
    Profile { name: "cusps light", shape: Shape::Cusps(3e-5, 410.0), force: Force::Constant(0.1) },
    Profile { name: "narrow ridges", shape: Shape::Ridge(1e-4, 0.0008, 0.011), force: Force::Constant(0.6) },
    Profile { name: "chord", shape: Shape::Chord(4e-5, 211.0, 6e-6, 2417.0), force: Force::Constant(0.4) },
    Profile {
        name: "fractal 1.25 heavy",
        shape: Shape::Fractal(1.25, 8e-6, 0.1, 6.3),
        force: Force::Constant(2.0),
    },
    Profile {
        name: "fractal 1.75",
        shape: Shape::Fractal(1.75, 4e-6, 0.15, 7.7),
        force: Force::Constant(0.5),
    },
    Profile {
        name: "fractal 2.25 light",
        shape: Shape::Fractal(2.25, 6e-6, 0.18, 8.1),
        force: Force::Constant(0.1),
    },
    Profile {
        name: "force swing",
        shape: Shape::Fractal(1.6, 5e-6, 0.2, 9.9),
        force: Force::Swing(0.6, 0.5, 5.0),
    },
    Profile { name: "fine sawtooth", shape: Shape::Sawtooth(4e-5, 330.0), force: Force::Constant(1.0) },
    Profile { name: "slow sweep", shape: Shape::Sweep(1e-4, 2.3e-3, 0.7), force: Force::Constant(0.7) },
];
