//! Rubbed body, plainly: the modes one after the other, a sample at a time.
//!
//! The work of `Coupled` (beside) on a whole [modal bank](crate::modal_bank) cell by cell, written
//! as the equations of the [module](super) stand, with an energy that can be asked for.

use super::{Friction, Law, Rub, RubState, Sweep};
use crate::DesignError;
use crate::mode::Mode;
use crate::simd::BASE;
use core::f64::consts::PI;

/// Modes of one lane row: what the loops are unrolled for.
const LANES: usize = 8;
type Row = [f32; LANES];

/// Eight modes of a body that can be rubbed: coefficients and what they remember.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub struct RubbedModes {
    decay: Row,
    stiffness: Row,
    kick: Row,
    phi: Row,
    /// φ β, what a force moves.
    pushed: Row,
    place: Row,
    step: Row,
}

impl RubbedModes {
    /// Number of modes that one holds.
    pub const LANES: usize = LANES;

    /// Eight modes at one rate, at rest and not touched anywhere. Modes at or above the Nyquist
    /// frequency, and lanes beyond the modes, stay still.
    ///
    /// # Errors
    /// When a frequency, a decay or the rate is outside what a mode can have.
    pub fn new(modes: &[Mode], sample_rate_hz: f64) -> Result<Self, DesignError> {
        DesignError::check("sample_rate_hz", sample_rate_hz, "above 0 Hz", |r| r > 0.0)?;
        let step_s = 1.0 / sample_rate_hz;
        let zero = [0.0; LANES];
        let mut all = Self {
            decay: zero,
            stiffness: zero,
            kick: zero,
            phi: zero,
            pushed: zero,
            place: zero,
            step: zero,
        };
        for (lane, mode) in modes.iter().take(LANES).enumerate() {
            let f = DesignError::check("frequency_hz", mode.frequency_hz, "above 0 Hz", |f| f > 0.0)?;
            let d = DesignError::check("decay_per_s", mode.decay_per_s, "0 or more", |d| d >= 0.0)?;
            if f >= 0.5 * sample_rate_hz {
                continue;
            }
            let (theta, radius) = (2.0 * PI * f * step_s, libm::exp(-d * step_s));
            let (gap, half) = (-libm::expm1(-d * step_s), libm::sin(0.5 * theta));
            all.decay[lane] = (radius * radius) as f32;
            all.stiffness[lane] = (gap * gap + 4.0 * radius * half * half) as f32;
            all.kick[lane] = (step_s * radius * libm::sin(theta) / (2.0 * PI * f)) as f32;
        }
        Ok(all)
    }

    /// Comes to rest.
    pub fn silence(&mut self) {
        (self.place, self.step) = ([0.0; LANES], [0.0; LANES]);
    }
}

/// A body that is rubbed at one place.
#[derive(Debug)]
pub struct RubbedBody<'a> {
    modes: &'a mut [RubbedModes],
    step_s: f64,
}

impl<'a> RubbedBody<'a> {
    /// The modes at the rate they were made for.
    pub fn new(modes: &'a mut [RubbedModes], sample_rate_hz: f64) -> Self {
        Self { modes, step_s: 1.0 / sample_rate_hz }
    }

    /// The place is here now: `phi(k)` is its motion along the sweep in mode k, kg^−½.
    pub fn touch_at(&mut self, state: &mut RubState, mut phi: impl FnMut(usize) -> f32) {
        let mut sum = 0.0;
        for (row, modes) in self.modes.iter_mut().enumerate() {
            for lane in 0..LANES {
                let phi = if modes.kick[lane] == 0.0 { 0.0 } else { phi(row * LANES + lane) };
                modes.phi[lane] = phi;
                modes.pushed[lane] = phi * modes.kick[lane];
                sum += f64::from(phi * modes.pushed[lane]);
            }
        }
        state.mobility_m_s_n = sum / self.step_s;
    }

    /// One sample. `friction` may change from sample to sample.
    #[inline]
    pub fn tick(&mut self, state: &mut RubState, friction: &Friction, now: &Sweep) -> Rub {
        let free_m_s = self.free_step() / self.step_s;
        let other_n = now.other_n_s / self.step_s;
        let free_m_s = free_m_s + state.mobility_m_s_n * other_n;
        let law = Law::new(friction, state.mobility_m_s_n);
        let pressed = law.pressed(now.normal_force_n);
        let force_n = state.solve(BASE, &law, &pressed, now.sweep_m_s - free_m_s).force_n;
        self.push((force_n + other_n) as f32);
        Rub { force_n, body_m_s: free_m_s + state.mobility_m_s_n * force_n, sticks: state.sticks }
    }

    /// Free motion of the modes, and of the place by it, m.
    #[inline]
    #[expect(clippy::needless_range_loop, reason = "a lane of several arrays at once")]
    fn free_step(&mut self) -> f64 {
        let mut sums = [0.0; LANES];
        for modes in self.modes.iter_mut() {
            for l in 0..LANES {
                let step = modes.decay[l] * modes.step[l] - modes.stiffness[l] * modes.place[l];
                modes.step[l] = step;
                sums[l] += modes.phi[l] * step;
            }
        }
        sums.iter().map(|x| f64::from(*x)).sum()
    }

    /// Motion that the force adds.
    #[inline]
    fn push(&mut self, force_n: f32) {
        for modes in self.modes.iter_mut() {
            for l in 0..LANES {
                let step = modes.step[l] + modes.pushed[l] * force_n;
                modes.step[l] = step;
                modes.place[l] += step;
            }
        }
    }

    /// Energy of the modes, J: kinetic over the coming sample, potential in the middle of it. Kept
    /// by modes without damping that nobody touches.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        let mut sum = 0.0;
        for modes in self.modes.iter() {
            for l in (0..LANES).filter(|&l| modes.kick[l] > 0.0) {
                let [y, d, m, kick] =
                    [modes.place[l], modes.step[l], modes.stiffness[l], modes.kick[l]].map(f64::from);
                sum += 0.5 * (d * d + m * y * (y - d)) / kick;
            }
        }
        sum
    }
}
