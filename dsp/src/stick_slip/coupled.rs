//! Rub of a whole modal bank: the closed-form step of every sample, with the modes run a cell of 64 samples at a time.
//!
//! ```text
//! v*[n] = ṽ[n] + Σ_i f_i U[n − i] + Σ_m g[n − m] F[m]       m: the samples of the cell before n
//! U[j] = Σ φ_k² Im(q_k zʲ) / ω      q = (z − 1) / Σ_t c_t z^−t      z = R e^(iθ)
//! g[j] = Σ_t c_t U[j − t]  = Σ φ_k² Im(zʲ (z − 1)) / ω               F[n] from v*[n] and g[0], as in the [module](super)
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | ṽ | what a [`place_speed`] output of the bank says ahead of the cell ([`ModalBank::ahead`](crate::modal_bank::ModalBank::ahead)): the free motion |
//! | c_t | the five taps through which a bank hears a force ([`FORCE_TAPS`]) |
//! | f_i | what the bank still has to hear in the cell's sample i of the forces before it |
//! | U, g | [`Answer`], m/s a newton |
//! | F | [`Coupled::run`] |
//!
//! The modes are linear, so what a force does within its own cell is a sum over its few samples, and what it does later is in the states once the
//! bank has heard it. So the bank is rendered once, with the forces, for the sound; before that it tells the free motion of the cell, and a force,
//! once it is known, is added to the speeds of all later samples of the cell at once: what a sample has to wait for is the one product
//! with the force before it. The sum is the plain step's to rounding ([`RubbedBody`](super::RubbedBody)): nothing is a sample late and nothing is
//! iterated.

use super::{Friction, RubState, Sweep};
use crate::DesignError;
use crate::hertz::{FORCE_HISTORY, FORCE_TAPS};
use crate::mode::Mode;
use crate::simd::{Level, Set, at_level};
use core::array::from_fn;
use core::f64::consts::PI;

/// Samples of a cell; cells begin at absolute multiples of it.
pub const CELL: usize = crate::modal_bank::GRID_SAMPLES as usize;
/// Modes side by side while an answer is designed.
const LANES: usize = 16;
/// Speeds side by side.
const CHUNK: usize = 8;

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
    /// U, from a lag of −4 samples on.
    tapped: [f64; FORCE_HISTORY + CELL],
}

impl Answer {
    /// Nothing moves.
    pub const RIGID: Self = Self { tapped: [0.0; FORCE_HISTORY + CELL] };

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
        Ok(())
    }

    /// Adds what other modes answer.
    pub fn add(&mut self, other: &Self) {
        self.tapped.iter_mut().zip(&other.tapped).for_each(|(sum, x)| *sum += x);
    }

    /// g.
    #[inline(always)]
    fn own(&self) -> [f64; CELL] {
        let mut own = [0.0; CELL];
        for (tap, share) in FORCE_TAPS.into_iter().enumerate() {
            let tapped = &self.tapped[FORCE_HISTORY - tap..];
            own.iter_mut().zip(tapped).for_each(|(sum, u)| *sum += share * u);
        }
        own
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

/// A rubbing contact of a bank: whether it sticks, its forces so far, and what they will move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    level: Level,
    state: RubState,
    /// The last forces of the cell before, then those of the present one, N.
    force_n: [f64; FORCE_HISTORY + CELL],
    /// How the place moves in the present cell with all that is known, but for the sample just before: it comes with the sample itself, m/s.
    known_m_s: [f64; CELL],
    /// g at a lag of 1, and what it makes of the sample just before.
    next_m_s_n: f64,
    moved_m_s: f64,
    /// As many zeros as a cell has samples, then g from lag 0 on, with zeros there and at 1.
    later_m_s_n: [f64; 2 * CELL],
}

impl Coupled {
    /// Nothing has rubbed yet.
    #[must_use]
    pub fn begin(level: Level) -> Self {
        Self {
            level,
            state: RubState::default(),
            force_n: [0.0; FORCE_HISTORY + CELL],
            known_m_s: [0.0; CELL],
            next_m_s_n: 0.0,
            moved_m_s: 0.0,
            later_m_s_n: [0.0; 2 * CELL],
        }
    }

    /// Whether it sticks at present.
    #[must_use]
    pub fn sticks(&self) -> bool {
        self.state.sticks
    }

    /// Another cell begins: how its place answers, and `free_m_s`, what the bank says of it ahead.
    pub fn next_cell(&mut self, answer: &Answer, free_m_s: &[f32; CELL]) {
        at_level!(self.level, _token => self.next_cell_in(answer, free_m_s));
    }

    #[inline(always)]
    fn next_cell_in(&mut self, answer: &Answer, free_m_s: &[f32; CELL]) {
        let own = answer.own();
        self.state.yields(own[0]);
        (self.next_m_s_n, self.moved_m_s) = (own[1], 0.0);
        self.later_m_s_n[CELL..].copy_from_slice(&own);
        self.later_m_s_n[CELL..CELL + 2].fill(0.0);
        self.force_n.copy_within(CELL.., 0);
        self.force_n[FORCE_HISTORY..].fill(0.0);
        self.known_m_s = free_m_s.map(f64::from);
        for at in 0..FORCE_HISTORY {
            let unheard_n: f64 = (at + 1..=FORCE_HISTORY)
                .map(|tap| FORCE_TAPS[tap] * self.force_n[FORCE_HISTORY + at - tap])
                .sum();
            let answers = &answer.tapped[FORCE_HISTORY - at..];
            self.known_m_s.iter_mut().zip(answers).for_each(|(sum, u)| *sum += unheard_n * u);
        }
    }

    /// The forces of the coming samples, N, from sample `first` of the cell on: `sweep` is what rubs, `struck_m_s` how the place moves because of what
    /// has struck the bank since the cell began. Lengths: as far as the shortest reaches, within the cell.
    pub fn run(&mut self, friction: &Friction, first: usize, sweep: &[Sweep], struck_m_s: &[f32]) -> &[f64] {
        let n = sweep.len().min(struck_m_s.len()).min(CELL.saturating_sub(first));
        at_level!(self.level, token => self.run_in(token, friction, first, &sweep[..n], struck_m_s));
        &self.force_n[FORCE_HISTORY + first..FORCE_HISTORY + first + n]
    }

    #[inline(always)]
    fn run_in<T: Set>(
        &mut self,
        token: T,
        friction: &Friction,
        first: usize,
        sweep: &[Sweep],
        struck_m_s: &[f32],
    ) {
        let (next_m_s_n, mut moved_m_s) = (self.next_m_s_n, self.moved_m_s);
        let mut known_m_s = self.known_m_s.get(first).copied().unwrap_or(0.0);
        for (at, (sweep, struck_m_s)) in (first..CELL).zip(sweep.iter().zip(struck_m_s)) {
            let behind_m_s = sweep.sweep_m_s - (known_m_s + f64::from(*struck_m_s));
            // Read before this sample's force is added to what lies beside it, or it would wait for that.
            known_m_s = self.known_m_s.get(at + 1).copied().unwrap_or(0.0);
            let pressed_n = sweep.normal_force_n;
            let force_n;
            [force_n, moved_m_s] =
                self.state.solve(token, friction, pressed_n, behind_m_s - moved_m_s, next_m_s_n);
            self.force_n[FORCE_HISTORY + at] = force_n;
            self.moves_later(at, force_n);
        }
        self.moved_m_s = moved_m_s;
    }

    /// Adds what the force of sample `at` moves from the sample after the next on.
    #[inline(always)]
    fn moves_later(&mut self, at: usize, force_n: f64) {
        let from = (at + 2) / CHUNK;
        let answers = self.later_m_s_n[CELL + CHUNK * from - at..].as_chunks::<CHUNK>().0;
        let known = self.known_m_s.as_chunks_mut::<CHUNK>().0;
        for (known, answer) in known[from.min(CELL / CHUNK)..].iter_mut().zip(answers) {
            *known = from_fn(|i| known[i] + force_n * answer[i]);
        }
    }

    /// What the bank hears of the forces so far, from sample `first` of the cell on, N·s.
    pub fn impulses(&self, first: usize, sample_rate_hz: f64, impulse_n_s: &mut [f64]) {
        let step_s = 1.0 / sample_rate_hz;
        impulse_n_s.fill(0.0);
        for (tap, share) in FORCE_TAPS.into_iter().enumerate() {
            let forces_n = self.force_n.get(FORCE_HISTORY + first - tap..).unwrap_or_default();
            impulse_n_s.iter_mut().zip(forces_n).for_each(|(sum, force_n)| *sum += share * step_s * force_n);
        }
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
