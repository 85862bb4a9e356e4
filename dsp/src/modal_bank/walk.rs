//! The walk over the 64-sample grid, and how many groups go at once.
#![allow(unsafe_code)]

use super::design::{GRID_SAMPLES, TURN};
use super::direct::Direct;
use super::job::{Chunk, Job, Part};
use super::set::{ANY, SHARED, SHARED_FIRST, set};
use super::sums::{self, TurnSums};
use super::vector::{groups_at_once, len};
use crate::simd::Set;
use core::mem::MaybeUninit;

/// Chunks never cross the grid, so they touch no more turns than this.
pub(super) const TURNS: usize = GRID_SAMPLES as usize / TURN;

/// Walks the block in chunks that end on the absolute grid. `P` vectors make a group, and at most
/// `MAX` groups are interleaved.
///
/// # Safety
/// `out` is no longer than any input; there is at least one group, and
/// as many states, and gains of every input unless it is shared.
#[inline(always)]
pub(super) unsafe fn walk<T: Set, const P: usize, const MAX: usize>(
    token: T,
    first_sample: u64,
    job: &mut Job<'_>,
    out: &mut [f32],
) {
    let mut sums: [MaybeUninit<TurnSums>; TURNS] = [const { MaybeUninit::uninit() }; TURNS];
    let (mut at, samples) = (0, out.len());
    // SAFETY: passed on from the caller.
    let direct = unsafe { Direct::new::<T, P>(token, job) };
    while at < samples {
        let now = first_sample.wrapping_add(at as u64);
        let len = ((GRID_SAMPLES - now % GRID_SAMPLES) as usize).min(samples - at);
        let ends_on_grid = now.wrapping_add(len as u64).is_multiple_of(GRID_SAMPLES);
        let chunk = Chunk { at, len, phase: (now % TURN as u64) as usize, ends_on_grid };
        job.add_pairs(chunk);
        let mut turns = [[0.0; TURN]; TURNS];
        let turns = &mut turns[..(chunk.phase + len).div_ceil(TURN)];
        // SAFETY: `at + len` is inside every input. The first set writes the sums of every turn,
        // and there is one. So they may be read as what they are, in the same memory.
        unsafe {
            sets::<T, P, MAX>(token, job, chunk, &mut sums[..turns.len()]);
            let written = core::slice::from_raw_parts(sums.as_ptr().cast::<TurnSums>(), turns.len());
            for (turn, sums) in turns.iter_mut().zip(written) {
                *turn = sums::samples(token, sums);
            }
        }
        direct.add(job.feed.inputs, &mut job.states[0].carried, chunk, turns);
        for (y, heard) in out[at..at + len].iter_mut().zip(&turns.as_flattened()[chunk.phase..]) {
            *y += heard;
        }
        at += len;
    }
}

/// Cuts the groups into sets of nearly equal size, at most `MAX` each: a set that is too small
/// waits for its own results, one that is too large spills its registers.
///
/// # Safety
/// As [`walk`]; `turns` are those the chunk touches.
#[inline(always)]
unsafe fn sets<T: Set, const P: usize, const MAX: usize>(
    token: T,
    job: &mut Job<'_>,
    chunk: Chunk,
    turns: &mut [MaybeUninit<TurnSums>],
) {
    let count = job.groups.len();
    let mut from = 0;
    // Gained inputs need registers too.
    let most = if job.feed.shared { MAX } else { MAX.min(3) };
    let mut left = count.div_ceil(most).max(count / groups_at_once::<T>());
    while left > 0 {
        let size = (count - from).div_ceil(left);
        // SAFETY: passed on from the caller; `from + size` is at most the number of groups.
        unsafe {
            match size {
                1 => parts::<T, P, 1>(token, job, from, chunk, turns),
                2 if const { MAX >= 2 } => parts::<T, P, 2>(token, job, from, chunk, turns),
                3 if const { MAX >= 3 } => parts::<T, P, 3>(token, job, from, chunk, turns),
                _ if const { MAX >= 4 } => parts::<T, P, 4>(token, job, from, chunk, turns),
                _ => {}
            }
        }
        from += size;
        left -= 1;
    }
}

/// Most vectors at once: more have no room for their states beside the sums.
const MOST_VECTORS: usize = 4;

/// Whole groups where there is room for all their vectors; otherwise the first lanes of all, then
/// the next.
///
/// # Safety
/// As [`sets`]; there are `S` groups from `from` on.
#[inline(always)]
unsafe fn parts<T: Set, const P: usize, const S: usize>(
    token: T,
    job: &mut Job<'_>,
    from: usize,
    chunk: Chunk,
    turns: &mut [MaybeUninit<TurnSums>],
) {
    // SAFETY: passed on from the caller; P · `len` lanes make a group.
    unsafe {
        if const { P * S <= MOST_VECTORS } {
            inputs::<T, P, S>(token, job, Part { from, lane: 0 }, chunk, turns);
        } else {
            for p in 0..P {
                inputs::<T, 1, S>(token, job, Part { from, lane: p * len::<T>() }, chunk, turns);
            }
        }
    }
}

/// # Safety
/// As [`parts`]; there are `P` · [`len`] lanes from `part.lane` on.
#[inline(always)]
unsafe fn inputs<T: Set, const P: usize, const S: usize>(
    token: T,
    job: &mut Job<'_>,
    part: Part,
    chunk: Chunk,
    turns: &mut [MaybeUninit<TurnSums>],
) {
    // SAFETY: passed on from the caller.
    unsafe {
        match job.feed.inputs.len() {
            _ if job.feed.shared && part.from == 0 => {
                set_apart::<T, P, S, SHARED_FIRST>(token, job, part, chunk, turns)
            }
            _ if job.feed.shared => set_apart::<T, P, S, SHARED>(token, job, part, chunk, turns),
            1 => set_apart::<T, P, S, 1>(token, job, part, chunk, turns),
            2 => set_apart::<T, P, S, 2>(token, job, part, chunk, turns),
            _ => set_apart::<T, P, S, ANY>(token, job, part, chunk, turns),
        }
    }
}

/// [`set`] as a function of its own, once for a level: a compiler that sees all of them in one
/// function takes ten times as long.
///
/// # Safety
/// As [`inputs`].
#[inline(never)]
unsafe fn set_apart<T: Set, const P: usize, const S: usize, const K: usize>(
    token: T,
    job: &mut Job<'_>,
    part: Part,
    chunk: Chunk,
    turns: &mut [MaybeUninit<TurnSums>],
) {
    // SAFETY: passed on from the caller.
    token.vectorize(
        #[inline(always)]
        || unsafe { set::<T, P, S, K>(token, job, part, chunk, turns) },
    );
}
