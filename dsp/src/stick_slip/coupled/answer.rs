//! Answer of a rubbed place to a force of one sample: the sum of its modes' motions, lag by lag.

use super::CELL;
use crate::DesignError;
use crate::hertz::{FORCE_HISTORY, FORCE_TAPS};
use crate::mode::Mode;
use crate::simd::{Level, at_level};
use core::array::from_fn;
use core::f64::consts::PI;

/// Modes side by side while an answer is designed.
const LANES: usize = 16;

/// A mode that sounds as the speed of a rubbed place, m/s, when it takes impulses of N·s along the
/// motion through the taps of a force. `motion` is the product of its motions where it is pushed
/// and where it is looked at, 1/kg.
///
/// # Errors
/// When a frequency, a decay or the rate is outside what a mode can have.
pub fn place_speed(mode: &Mode, motion: f64, sample_rate_hz: f64) -> Result<Mode, DesignError> {
    let Some(pole) = Pole::new(mode, sample_rate_hz)? else {
        return Ok(Mode { amplitude: 0.0, ..*mode });
    };
    let [re, im] = over(pole.speed, pole.taps());
    let amplitude = motion * sample_rate_hz * libm::hypot(re, im) / pole.omega;
    Ok(Mode { amplitude, phase_rad: libm::atan2(im, re), ..*mode })
}

/// Response of a rubbed place to a force of one sample, m/s a newton.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// U, from a lag of −4 samples on.
    pub(super) tapped: [f64; FORCE_HISTORY + CELL],
    /// g.
    pub(super) own: [f64; CELL],
}

impl Answer {
    /// Nothing moves.
    pub const RIGID: Self = Self { tapped: [0.0; FORCE_HISTORY + CELL], own: [0.0; CELL] };

    /// Adds modes, each of which moves with `motion` 1/kg ([`place_speed`]).
    ///
    /// # Errors
    /// As [`place_speed`].
    pub fn add_modes(
        &mut self,
        level: Level,
        modes: &[(Mode, f64)],
        sample_rate_hz: f64,
    ) -> Result<(), DesignError> {
        for modes in modes.chunks(LANES) {
            let (mut now, mut z) = ([[0.0; LANES]; 2], [[0.0; LANES]; 2]);
            for (lane, (mode, motion)) in modes.iter().enumerate() {
                let Some(pole) = Pole::new(mode, sample_rate_hz)? else { continue };
                let scale = motion / pole.omega;
                let back = (0..FORCE_HISTORY).fold(pole.taps(), |back, _| times(back, pole.z));
                let first = over(pole.speed, back);
                for part in 0..2 {
                    (now[part][lane], z[part][lane]) = (scale * first[part], pole.z[part]);
                }
            }
            at_level!(level, _token => turn(&mut now, &z, &mut self.tapped));
        }
        self.own = [0.0; CELL];
        for (tap, share) in FORCE_TAPS.into_iter().enumerate() {
            let tapped = &self.tapped[FORCE_HISTORY - tap..];
            self.own.iter_mut().zip(tapped).for_each(|(sum, u)| *sum += share * u);
        }
        Ok(())
    }

    /// Adds what other modes answer.
    pub fn add(&mut self, other: &Self) {
        self.tapped.iter_mut().zip(&other.tapped).for_each(|(sum, x)| *sum += x);
        self.own.iter_mut().zip(&other.own).for_each(|(sum, x)| *sum += x);
    }
}

/// Adds the imaginary parts of some numbers that turn by z from sample to sample.
#[inline(always)]
fn turn(now: &mut [[f64; LANES]; 2], z: &[[f64; LANES]; 2], sums: &mut [f64]) {
    for sum in sums {
        let [a, b] = *now;
        // Side by side.
        let eight: [f64; 8] = from_fn(|l| b[l] + b[l + 8]);
        let four: [f64; 4] = from_fn(|l| eight[l] + eight[l + 4]);
        *sum += (four[0] + four[2]) + (four[1] + four[3]);
        now[0] = from_fn(|l| a[l] * z[0][l] - b[l] * z[1][l]);
        now[1] = from_fn(|l| a[l] * z[1][l] + b[l] * z[0][l]);
    }
}

/// A mode at one rate.
struct Pole {
    omega: f64,
    z: Complex,
    /// z − 1.
    speed: Complex,
}

impl Pole {
    /// Pole of a mode; none at or above the Nyquist frequency.
    fn new(mode: &Mode, sample_rate_hz: f64) -> Result<Option<Self>, DesignError> {
        let rate = DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let f = DesignError::check("frequency_hz", mode.frequency_hz, "above 0 Hz", |f| f > 0.0)?;
        let d = DesignError::check("decay_per_s", mode.decay_per_s, "0 or more", |d| d >= 0.0)?;
        if f >= 0.5 * rate {
            return Ok(None);
        }
        let (omega, theta, radius) = (2.0 * PI * f, 2.0 * PI * f / rate, libm::exp(-d / rate));
        let (sin, half) = (libm::sin(theta), libm::sin(0.5 * theta));
        // R cos θ − 1 without cancellation.
        let behind = libm::expm1(-d / rate) - 2.0 * radius * half * half;
        Ok(Some(Self { omega, z: [1.0 + behind, radius * sin], speed: [behind, radius * sin] }))
    }

    /// Response of a force through its taps: Σ tap z^−tap.
    fn taps(&self) -> Complex {
        let back = over([1.0, 0.0], self.z);
        FORCE_TAPS.iter().rev().fold([0.0; 2], |sum, tap| {
            let [re, im] = times(sum, back);
            [re + tap, im]
        })
    }
}

type Complex = [f64; 2];

fn times([a, b]: Complex, [c, d]: Complex) -> Complex {
    [a * c - b * d, a * d + b * c]
}

fn over([a, b]: Complex, [c, d]: Complex) -> Complex {
    let square = c * c + d * d;
    [(a * c + b * d) / square, (b * c - a * d) / square]
}
