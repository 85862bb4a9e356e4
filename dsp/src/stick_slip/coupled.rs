//! Rub of a whole modal bank: the closed-form step of every sample, with the modes run a cell of 64 samples at a time.
//!
//! ```text
//! v*[n] = ṽ[n] + Σ_m g[n − m] F[m]            m: the samples of the cell before n
//! g[j] = Σ φ_k² Im(zʲ (z − 1)) / ω            z = R e^(iθ)            F[n] from v*[n] and g[0], as in the [module](super)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | ṽ | what a bank of [`place_speed`] modes says from the states of the cell's beginning: everything but this cell's forces |
//! | g | [`Answer`], m/s a newton |
//! | F | [`Coupled::run`] |
//!
//! The modes are linear, so what a force does within its own cell is a sum over its few samples, and what it does later is in the states once the
//! bank has heard it. So the bank runs in its own instructions, twice: once for the speed of the place, on a copy of its states, and once with the
//! forces, for the sound. The sum is the plain step's to rounding ([`RubbedBody`](super::RubbedBody)): nothing is a sample late and nothing is
//! iterated.
//!
//! The bank hears forces through five taps ([`FORCE_TAPS`](crate::hertz::FORCE_TAPS)); the speed's modes undo them exactly, and what is missing
//! of their first four samples is added from [`Answer`].

use super::{Friction, RubState, Sweep};
use crate::DesignError;
use crate::hertz::{FORCE_HISTORY, FORCE_TAPS};
use crate::mode::Mode;
use core::array::from_fn;
use core::f64::consts::PI;

/// Samples of a cell; cells begin at absolute multiples of it.
pub const CELL: usize = crate::modal_bank::GRID_SAMPLES as usize;

/// A mode that sounds as the speed of a rubbed place, m/s, when it hears impulses of N·s along the motion through the taps of a force.
/// `motion` is the product of its motions where it is pushed and where it is looked at, 1/kg.
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

/// How a rubbed place answers a force of one sample, m/s a newton.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// g, the latest lag first: a sum over past forces runs along both.
    own: [f64; CELL],
    /// What the bank lacks of it in the first samples, where the force is of the cell before.
    lacks: [f64; FORCE_HISTORY],
}

impl Answer {
    /// Nothing moves.
    pub const RIGID: Self = Self { own: [0.0; CELL], lacks: [0.0; FORCE_HISTORY] };

    /// Adds a mode that moves with `motion` 1/kg ([`place_speed`]).
    ///
    /// # Errors
    /// As [`place_speed`].
    pub fn add_mode(&mut self, mode: &Mode, motion: f64, sample_rate_hz: f64) -> Result<(), DesignError> {
        let Some(pole) = Pole::new(mode, sample_rate_hz)? else { return Ok(()) };
        let scale = motion / pole.omega;
        // Im(zʲ (z − 1)), and the same of the mode that undoes the taps.
        let (mut now, mut tapped) = (pole.speed, over(pole.speed, pole.taps()));
        let mut heard = [0.0; FORCE_HISTORY];
        for lag in 0..CELL {
            self.own[CELL - 1 - lag] += scale * now[1];
            if lag < FORCE_HISTORY {
                heard[lag] = tapped[1];
                let risen: f64 = (0..=lag).map(|tap| FORCE_TAPS[tap] * heard[lag - tap]).sum();
                self.lacks[lag] += scale * (now[1] - risen);
            }
            (now, tapped) = (times(now, pole.z), times(tapped, pole.z));
        }
        Ok(())
    }

    /// Adds what other modes answer.
    pub fn add(&mut self, other: &Self) {
        self.own.iter_mut().zip(&other.own).for_each(|(sum, x)| *sum += x);
        self.lacks.iter_mut().zip(&other.lacks).for_each(|(sum, x)| *sum += x);
    }

    /// g at lag 0: what a place moves with in the sample of the force itself.
    #[must_use]
    pub fn mobility_m_s_n(&self) -> f64 {
        self.own[CELL - 1]
    }
}

/// A rubbing contact of a bank: whether it sticks, and its forces so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    state: RubState,
    /// Of the present cell, N.
    force_n: [f64; CELL],
    /// The last of the cell before.
    before_n: [f64; FORCE_HISTORY],
}

impl Coupled {
    /// Nothing has rubbed yet.
    #[must_use]
    pub fn begin() -> Self {
        Self { state: RubState::default(), force_n: [0.0; CELL], before_n: [0.0; FORCE_HISTORY] }
    }

    /// Whether it sticks at present.
    #[must_use]
    pub fn sticks(&self) -> bool {
        self.state.sticks
    }

    /// Another cell begins.
    pub fn next_cell(&mut self) {
        self.before_n.copy_from_slice(&self.force_n[CELL - FORCE_HISTORY..]);
        self.force_n = [0.0; CELL];
    }

    /// What the bank still has to hear of the forces before the cell, sample by sample from `first` of the cell on, N·s: to be rendered before
    /// [`run`](Self::run).
    pub fn under_way(&self, first: usize, sample_rate_hz: f64, impulse_n_s: &mut [f32]) {
        for (i, out) in impulse_n_s.iter_mut().enumerate() {
            let older =
                (first + i + 1..=FORCE_HISTORY).map(|tap| FORCE_TAPS[tap] * self.past(first + i, tap));
            *out = (older.sum::<f64>() / sample_rate_hz) as f32;
        }
    }

    /// The forces of the coming samples, N, from sample `first` of the cell on: `free_m_s` is ṽ, `sweep` what rubs. Lengths: as far as the
    /// shortest reaches, within the cell.
    pub fn run(
        &mut self,
        answer: &Answer,
        friction: &Friction,
        first: usize,
        sweep: &[Sweep],
        free_m_s: &[f32],
    ) -> &[f64] {
        let n = sweep.len().min(free_m_s.len()).min(CELL.saturating_sub(first));
        self.state.mobility_m_s_n = answer.mobility_m_s_n();
        for (at, (sweep, free_m_s)) in (first..first + n).zip(sweep.iter().zip(free_m_s)) {
            let own = dot(&answer.own[CELL - 1 - at..], &self.force_n[..at]);
            let lacks: f64 = (at + 1..FORCE_HISTORY).map(|lag| answer.lacks[lag] * self.past(at, lag)).sum();
            let free_m_s = f64::from(*free_m_s) + own + lacks;
            self.force_n[at] = self.state.solve(friction, sweep, free_m_s);
        }
        &self.force_n[first..first + n]
    }

    /// What the bank hears of the forces so far, from sample `first` of the cell on, N·s.
    pub fn impulses(&self, first: usize, sample_rate_hz: f64, impulse_n_s: &mut [f64]) {
        for (i, out) in impulse_n_s.iter_mut().enumerate() {
            let at = first + i;
            let heard = |tap: usize| {
                FORCE_TAPS[tap] * if tap <= at { self.force_n[at - tap] } else { self.past(at, tap) }
            };
            *out = (0..=FORCE_HISTORY).map(heard).sum::<f64>() / sample_rate_hz;
        }
    }

    /// The force `lag` samples before sample `at` of the cell, which lies in the cell before.
    fn past(&self, at: usize, lag: usize) -> f64 {
        self.before_n[FORCE_HISTORY + at - lag]
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
    /// None where the mode is at or above the Nyquist frequency.
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

    /// What the taps of a force make of it: Σ tap z^−tap.
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

/// Σ x y as far as `y` reaches, four at a time; its order depends on the length alone.
fn dot(x: &[f64], y: &[f64]) -> f64 {
    let (x, y) = (x.chunks(4), y.chunks(4));
    let mut sums = [0.0; 4];
    for (x, y) in x.zip(y) {
        match (x, y) {
            ([a, b, c, d], [e, f, g, h]) => {
                let products = [a * e, b * f, c * g, d * h];
                sums = from_fn(|i| sums[i] + products[i]);
            }
            _ => x.iter().zip(y).zip(&mut sums).for_each(|((x, y), sum)| *sum += x * y),
        }
    }
    sums.iter().sum()
}
