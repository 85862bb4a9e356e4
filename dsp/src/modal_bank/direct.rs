//! Direct feed-through: the share of an input that reaches the outputs of its own turn without
//! passing the states.
//!
//! One term for all modes together, so it costs nothing a mode: the states of a turn's beginning do
//! not know yet what is heard in it, and h₀…h₃, summed over the modes, are all that is missing.
#![allow(unsafe_code)]

use super::LANES;
use super::design::{LaneGains, ModeGroup, OUT, TURN};
use super::job::{Chunk, Input, Job, MAX_INPUTS};
use super::sums::{Row, SUMS, outputs, sum_row};
use super::vector::{Vector, len, load, load_placed, mul_add, store};
use crate::simd::Set;
use core::array::from_fn;
use fearless_simd::SimdBase;

pub(super) struct Direct {
    /// h₀…h₃ of each input, summed over the modes.
    heard_as: [[f32; TURN]; MAX_INPUTS],
}

impl Direct {
    /// # Safety
    /// There are gains of all groups for every input unless it is shared.
    #[inline(always)]
    pub unsafe fn new<T: Set, const P: usize>(token: T, job: &Job<'_>) -> Self {
        let mut direct = Self { heard_as: [[0.0; TURN]; MAX_INPUTS] };
        if job.feed.shared {
            for group in job.groups {
                for (sum, h) in direct.heard_as[0].iter_mut().zip(group.heard_as) {
                    *sum += h;
                }
            }
            return direct;
        }
        for (heard_as, input) in direct.heard_as.iter_mut().zip(job.feed.inputs) {
            // SAFETY: passed on from the caller.
            *heard_as = unsafe { gained::<T, P>(token, job.groups, input.gains) };
        }
        direct
    }

    /// Adds its share to the outputs of the turns that a chunk touches, and keeps what a turn that
    /// is cut needs.
    #[inline(always)]
    pub fn add(
        &self,
        inputs: &[Input<'_>],
        carried: &mut [f32; TURN],
        chunk: Chunk,
        turns: &mut [[f32; TURN]],
    ) {
        let (at, end) = (chunk.at + chunk.skipped(), chunk.at + chunk.len);
        let (first, turns) = turns.split_at_mut(usize::from(chunk.phase > 0));
        if let [first] = first {
            self.add_cut(inputs, carried, chunk.at..at, &mut first[chunk.phase..]);
        }
        let (whole, cut) = turns.split_at_mut((end - at) / TURN);
        match inputs {
            [only] => self.add_one(&only.impulses[at..at + whole.len() * TURN], whole),
            _ => self.add_whole(inputs, at, whole),
        }
        if let [last] = cut {
            self.add_cut(inputs, carried, at + whole.len() * TURN..end, last);
        }
    }

    /// Some samples of a turn, whose outputs `heard` are, and what they send to the turn's later
    /// ones: the oldest first, so that a cut changes no bit.
    fn add_cut(
        &self,
        inputs: &[Input<'_>],
        carried: &mut [f32; TURN],
        samples: core::ops::Range<usize>,
        heard: &mut [f32],
    ) {
        let phase = TURN - heard.len();
        for ((at, i), y) in samples.zip(phase..).zip(heard) {
            for (later, sum) in carried[i..].iter_mut().enumerate() {
                let each = inputs.iter().zip(&self.heard_as);
                *sum += each.fold(0.0, |sum, (input, heard_as)| sum + heard_as[later] * input.impulses[at]);
            }
            *y += core::mem::take(&mut carried[i]);
        }
    }

    /// Whole turns of the only input.
    #[inline(always)]
    fn add_one(&self, impulses: &[f32], turns: &mut [[f32; TURN]]) {
        // Contribution of each sample to the turn: nothing to those before it.
        let columns: [[f32; TURN]; TURN] =
            from_fn(|sample| from_fn(|i| if i >= sample { self.heard_as[0][i - sample] } else { 0.0 }));
        for (u, turn) in impulses.as_chunks::<TURN>().0.iter().zip(turns) {
            let mut sent = [0.0; TURN];
            for (column, u) in columns.iter().zip(u) {
                for (sent, h) in sent.iter_mut().zip(column) {
                    *sent += h * u;
                }
            }
            for (y, sent) in turn.iter_mut().zip(sent) {
                *y += sent;
            }
        }
    }

    /// Whole turns of several inputs, from sample `at` of the block on.
    #[inline(always)]
    fn add_whole(&self, inputs: &[Input<'_>], at: usize, turns: &mut [[f32; TURN]]) {
        for (t, turn) in turns.iter_mut().enumerate() {
            let mut sent = [[0.0; TURN]; TURN];
            for (input, heard_as) in inputs.iter().zip(&self.heard_as) {
                let Some(u) = input.impulses[at + t * TURN..].first_chunk::<TURN>() else { continue };
                for (sent, h) in sent.iter_mut().zip(heard_as) {
                    for (sent, u) in sent.iter_mut().zip(u) {
                        *sent += h * u;
                    }
                }
            }
            let [own, next, second, third] = sent;
            let (next, second, third) = (later::<1>(next), later::<2>(second), later::<3>(third));
            for (i, y) in turn.iter_mut().enumerate() {
                *y += third[i] + second[i] + next[i] + own[i];
            }
        }
    }
}

/// Moves what samples send on by `BY` samples, as far as their turn goes.
#[inline(always)]
fn later<const BY: usize>(sent: [f32; TURN]) -> [f32; TURN] {
    from_fn(|i| if i >= BY { sent[i - BY] } else { 0.0 })
}

/// h₀…h₃ times the gains of an input, summed over the lanes.
///
/// # Safety
/// There are gains of all groups.
#[inline(always)]
unsafe fn gained<T: Set, const P: usize>(token: T, groups: &[ModeGroup], gains: &[LaneGains]) -> [f32; TURN] {
    let mut rows = [Row([0.0; LANES]); 1 + SUMS];
    // SAFETY: every pointer goes to lane p · LEN, or where it lies, of an array of LANES = P · LEN
    // values.
    unsafe {
        for p in 0..P {
            let lane = p * len::<T>();
            let mut sums = [Vector::<T>::splat(token, 0.0); 1 + SUMS];
            for (group, gains) in groups.iter().zip(gains) {
                let gains = load(token, gains.0.as_ptr().add(lane));
                let direct = load(token, group.direct.as_ptr().add(lane));
                sums[SUMS] = mul_add::<T>(direct, gains, sums[SUMS]);
                for (i, sum) in sums[..SUMS].iter_mut().enumerate() {
                    *sum = mul_add::<T>(load_placed(token, &group.hot, OUT + i, lane), gains, *sum);
                }
            }
            for (row, sum) in rows.iter_mut().zip(sums) {
                store::<T>(sum, row.0.as_mut_ptr().add(lane));
            }
        }
    }
    // The turn after an impulse of 1 in the last sample, v = 1 and w = 0.
    let [last, one, minus, two, _, own] = rows.map(|row| sum_row(&row));
    let [next, second, third, _] = outputs([last, one, minus, two, 0.0]);
    [own, next, second, third]
}
