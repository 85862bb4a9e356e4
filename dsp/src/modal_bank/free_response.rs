//! Ahead: what a bank would say in the coming 64 samples if nothing struck it, stated as another
//! output of its modes.
//!
//! ```text
//! y[16 j + n] = Σ modes hₙ₊₁ (vⱼ − wⱼ) + hₙ₊₂ wⱼ                                 n = 0…15
//! (v, w)ⱼ₊₁ = J (v, w)ⱼ                      J: the step of 16 samples           j = 0…3
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | v, w | the bank's own states at a multiple of 64 samples, which stay what they are |
//! | hₙ | what an impulse is n samples later in the other output |
//! | J | a lane of [`FreeResponse`] |
//!
//! Five products a mode and four samples, as in the bank itself ([`OUT`](super::design::OUT)), and
//! no chain of states longer than three: less than half of what a rendered bank costs. It is for
//! what needs the free motion before it can find the forces
//! ([`stick_slip`](crate::stick_slip)).
#![allow(unsafe_code)]
// `g` counts groups, `n` samples and `j` sixteenths, in several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::LANES;
use super::design::{GRID_SAMPLES, GroupOptions, GroupState, Lanes, Pole, TURN, free_step, out_of, square};
use super::sums::{SUMS, TurnSums, samples};
use super::vector::{Vector, len, load, mul_add, store};
use crate::DesignError;
use crate::mode::Mode;
use crate::simd::{Level, Set, at_level};
use core::array::from_fn;
use core::mem::MaybeUninit;
use fearless_simd::SimdBase;

/// Samples that are predicted.
const CELL: usize = GRID_SAMPLES as usize;
/// Samples predicted from one state.
const STEP: usize = 16;
/// Turns of it.
const TURNS: usize = STEP / TURN;
/// Groups whose states are kept at once.
const AT_ONCE: usize = 8;

/// Another output of 16 modes, one a lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct FreeResponse {
    output_gains: [[Lanes; SUMS]; TURNS],
    step: [[Lanes; 2]; 2],
}

impl FreeResponse {
    /// Sixteen lanes of which nothing is heard.
    pub const SILENT: Self =
        Self { output_gains: [[[0.0; LANES]; SUMS]; TURNS], step: [[[0.0; LANES]; 2]; 2] };

    /// Up to 16 modes as the other output takes them: frequencies and decays of the bank's, other
    /// amplitudes and phases. Modes at or above the Nyquist frequency are silent.
    ///
    /// # Errors
    /// As [`design_group`](super::design_group).
    pub fn design(modes: &[Mode], sample_rate_hz: f64) -> Result<Self, DesignError> {
        DesignError::check("modes", modes.len() as f64, "16 or fewer a group", |n| n <= LANES as f64)?;
        let mut group = Self::SILENT;
        for (lane, mode) in modes.iter().enumerate() {
            if let Some(pole) = Pole::new(mode, sample_rate_hz, &GroupOptions::default())? {
                group.set_lane(lane, &pole);
            }
        }
        Ok(group)
    }

    fn set_lane(&mut self, lane: usize, pole: &Pole) {
        let radius = libm::exp(-pole.decay);
        let [re, im] = [libm::cos(pole.theta), libm::sin(pole.theta)].map(|x| radius * x);
        let mut h = [libm::cos(pole.phase_rad), libm::sin(pole.phase_rad)].map(|x| pole.amplitude * x);
        let mut next = || {
            h = [h[0] * re - h[1] * im, h[0] * im + h[1] * re];
            h[1]
        };
        let h: [f64; STEP + 1] = from_fn(|_| next());
        for (output_gains, h) in self.output_gains.iter_mut().zip(h.windows(TURN + 1).step_by(TURN)) {
            let by = out_of(from_fn(|n| h[n]));
            output_gains.iter_mut().zip(by).for_each(|(to, by)| to[lane] = by as f32);
        }
        let jump = (0..STEP.ilog2()).fold(free_step(pole), |x, _| square(x));
        for (to, row) in self.step.iter_mut().zip(jump) {
            (to[0][lane], to[1][lane]) = (row[0] as f32, row[1] as f32);
        }
    }
}

/// Says what groups in these states would sound like through `ahead`.
pub(super) fn ahead(level: Level, groups: &[FreeResponse], states: &[GroupState], out: &mut [f32; CELL]) {
    if groups.is_empty() || states.is_empty() {
        return out.fill(0.0);
    }
    at_level!(level, token => ahead_in(token, groups, states, out));
}

#[inline(always)]
fn ahead_in<T: Set>(token: T, groups: &[FreeResponse], states: &[GroupState], out: &mut [f32; CELL]) {
    let mut turns = [const { MaybeUninit::<TurnSums>::uninit() }; CELL / TURN];
    // SAFETY: there are `len` lanes from `lane` on and at most AT_ONCE groups; the first groups
    // write every lane of every turn, and there are some. So turns may be read as what they are, in
    // the same memory.
    let turns = unsafe {
        for (part, (groups, states)) in groups.chunks(AT_ONCE).zip(states.chunks(AT_ONCE)).enumerate() {
            for lane in (0..LANES).step_by(len::<T>()) {
                // One sum a register.
                match len::<T>() {
                    LANES => add_lanes::<T, 4>(token, groups, states, lane, part == 0, &mut turns),
                    8 => add_lanes::<T, 2>(token, groups, states, lane, part == 0, &mut turns),
                    _ => add_lanes::<T, 1>(token, groups, states, lane, part == 0, &mut turns),
                }
            }
        }
        core::slice::from_raw_parts(turns.as_ptr().cast::<TurnSums>(), CELL / TURN)
    };
    for (out, turn) in out.as_chunks_mut::<TURN>().0.iter_mut().zip(turns) {
        *out = samples(token, turn);
    }
}

/// Adds one vector of each group.
///
/// # Safety
/// There are [`len`] lanes from `lane` on, and at most [`AT_ONCE`] groups; these lanes of `turns`
/// are written unless the groups are the first. `TILE` divides [`TURNS`].
#[inline(always)]
unsafe fn add_lanes<T: Set, const TILE: usize>(
    token: T,
    groups: &[FreeResponse],
    states: &[GroupState],
    lane: usize,
    is_first: bool,
    turns: &mut [MaybeUninit<TurnSums>; CELL / TURN],
) {
    let count = groups.len().min(states.len());
    let nothing = Vector::<T>::splat(token, 0.0);
    let mut at = [[const { MaybeUninit::<[Vector<T>; 2]>::uninit() }; AT_ONCE]; CELL / STEP];
    // SAFETY: every pointer goes to lane `lane` of an array of LANES values, and states are read as
    // far as they were written; the caller's promise.
    unsafe {
        let read = |lanes: &Lanes| load(token, lanes.as_ptr().add(lane));
        for g in 0..count {
            let mut now = [read(&states[g].v), read(&states[g].w)];
            let step: [[Vector<T>; 2]; 2] = from_fn(|row| from_fn(|i| read(&groups[g].step[row][i])));
            for j in 0..CELL / STEP {
                at[j][g].write(now);
                now = from_fn(|row| {
                    mul_add::<T>(now[0], step[row][0], mul_add::<T>(now[1], step[row][1], nothing))
                });
            }
        }
        for j in 0..CELL / STEP {
            for tile in (0..TURNS).step_by(TILE) {
                let row = |t: usize, i: usize| {
                    turns.as_ptr().add(j * TURNS + tile + t).cast::<f32>().add(i * LANES + lane)
                };
                let mut sums: [[Vector<T>; SUMS]; TILE] =
                    from_fn(|t| from_fn(|i| if is_first { nothing } else { load(token, row(t, i)) }));
                for g in 0..count {
                    let [v, w] = at[j][g].assume_init();
                    let last = v - w;
                    let products = [last, v, last - w, v + w, w];
                    for t in 0..TILE {
                        for i in 0..SUMS {
                            let by = read(&groups[g].output_gains[tile + t][i]);
                            sums[t][i] = mul_add::<T>(products[i], by, sums[t][i]);
                        }
                    }
                }
                for t in 0..TILE {
                    for i in 0..SUMS {
                        let turn = turns[j * TURNS + tile + t].as_mut_ptr().cast::<f32>();
                        store::<T>(sums[t][i], turn.add(i * LANES + lane));
                    }
                }
            }
        }
    }
}
