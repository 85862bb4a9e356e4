//! Ahead: what a bank would say in the coming 64 samples if nothing struck it, told as another output of its modes.
//!
//! ```text
//! y[16 j + n] = Σ modes aₙ vⱼ + bₙ wⱼ        aₙ = hₙ₊₁    bₙ = hₙ₊₂ − hₙ₊₁        n = 0…15
//! (v, w)ⱼ₊₁ = J (v, w)ⱼ                      J: the step of 16 samples           j = 0…3
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | v, w | the bank's own states at a multiple of 64 samples, which stay what they are |
//! | hₙ | what an impulse is n samples later in the other output |
//! | aₙ, bₙ, J | a lane of [`AheadGroup`] |
//!
//! Two products a mode and sample, and no chain of states longer than three: less than half of what a rendered bank costs. It is
//! for what has to know the free motion before it can tell the forces ([`stick_slip`](crate::stick_slip)).
#![allow(unsafe_code)]
// `g` counts groups, `n` samples and `j` sixteenths, in several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::LANES;
use super::design::{GRID_SAMPLES, GroupOptions, GroupState, Lanes, Pole, free_step, square};
use super::sums::{Row, four_rows};
use super::vector::{Vector, len, load, mul_add, store};
use crate::DesignError;
use crate::mode::Mode;
use crate::simd::{Level, Set, at_level};
use core::array::from_fn;
use core::mem::MaybeUninit;
use fearless_simd::SimdBase;

/// Samples that are told.
const CELL: usize = GRID_SAMPLES as usize;
/// Samples told from one state.
const STEP: usize = 16;
/// Samples whose sums stay in registers.
const TILE: usize = 8;
/// Groups whose states are kept at once.
const AT_ONCE: usize = 8;

/// Another output of 16 modes, one a lane.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct AheadGroup {
    hears: [[Lanes; 2]; STEP],
    step: [[Lanes; 2]; 2],
}

impl AheadGroup {
    /// Sixteen lanes of which nothing is heard.
    pub const SILENT: Self = Self { hears: [[[0.0; LANES]; 2]; STEP], step: [[[0.0; LANES]; 2]; 2] };

    /// Up to 16 modes as the other output hears them: frequencies and decays of the bank's, other amplitudes and phases. Modes at or above the
    /// Nyquist frequency are silent.
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
        let mut now = next();
        for hears in &mut self.hears {
            let later = next();
            (hears[0][lane], hears[1][lane]) = (now as f32, (later - now) as f32);
            now = later;
        }
        let jump = (0..STEP.ilog2()).fold(free_step(pole), |x, _| square(x));
        for (to, row) in self.step.iter_mut().zip(jump) {
            (to[0][lane], to[1][lane]) = (row[0] as f32, row[1] as f32);
        }
    }
}

/// Says what groups in these states would sound like through `ahead`.
pub(super) fn ahead(level: Level, groups: &[AheadGroup], states: &[GroupState], out: &mut [f32; CELL]) {
    if groups.is_empty() || states.is_empty() {
        return out.fill(0.0);
    }
    at_level!(level, token => ahead_in(token, groups, states, out));
}

#[inline(always)]
fn ahead_in<T: Set>(token: T, groups: &[AheadGroup], states: &[GroupState], out: &mut [f32; CELL]) {
    let mut rows = [const { MaybeUninit::<Row>::uninit() }; CELL];
    // SAFETY: there are `len` lanes from `lane` on and at most AT_ONCE groups; the first groups write every lane of every row, and there are some. So
    // rows may be read as what they are, in the same memory.
    let rows = unsafe {
        for (part, (groups, states)) in groups.chunks(AT_ONCE).zip(states.chunks(AT_ONCE)).enumerate() {
            for lane in (0..LANES).step_by(len::<T>()) {
                add_lanes(token, groups, states, lane, part == 0, &mut rows);
            }
        }
        core::slice::from_raw_parts(rows.as_ptr().cast::<Row>(), CELL)
    };
    for (out, rows) in out.as_chunks_mut::<4>().0.iter_mut().zip(rows.as_chunks::<4>().0) {
        *out = four_rows(token, rows);
    }
}

/// Adds one vector of each group.
///
/// # Safety
/// There are [`len`] lanes from `lane` on, and at most [`AT_ONCE`] groups; these lanes of `rows` are written unless the groups are the first.
#[inline(always)]
unsafe fn add_lanes<T: Set>(
    token: T,
    groups: &[AheadGroup],
    states: &[GroupState],
    lane: usize,
    is_first: bool,
    rows: &mut [MaybeUninit<Row>; CELL],
) {
    let count = groups.len().min(states.len());
    let nothing = Vector::<T>::splat(token, 0.0);
    let mut at = [[const { MaybeUninit::<[Vector<T>; 2]>::uninit() }; AT_ONCE]; CELL / STEP];
    // SAFETY: every pointer goes to lane `lane` of an array of LANES values, and states are read as far as they were written; the caller's promise.
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
            for tile in (0..STEP).step_by(TILE) {
                let row = |n: usize| rows.as_ptr().add(j * STEP + tile + n).cast::<f32>().add(lane);
                let mut sums: [Vector<T>; TILE] =
                    from_fn(|n| if is_first { nothing } else { load(token, row(n)) });
                for g in 0..count {
                    let [v, w] = at[j][g].assume_init();
                    for n in 0..TILE {
                        let [of_v, of_w] = &groups[g].hears[tile + n];
                        sums[n] = mul_add::<T>(v, read(of_v), mul_add::<T>(w, read(of_w), sums[n]));
                    }
                }
                for n in 0..TILE {
                    store::<T>(sums[n], rows[j * STEP + tile + n].as_mut_ptr().cast::<f32>().add(lane));
                }
            }
        }
    }
}
