//! The hot loop: some groups of modes through one chunk, four samples a turn.
#![allow(unsafe_code)]
// `s` counts groups, `p` vectors of each and `i` rows, in several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::LANES;
use super::design::{HOT, Lanes, ModeGroup, OUT, STEP, TURN, place};
use super::job::{Chunk, Feed, Input, Job, Part};
use super::sums::{SUMS, TurnSums};
use super::vector::{Vector, keeps_coefficients, len, load, load_swapped, mul_add, mul_add_near_one, store};
use crate::simd::Set;
use core::array::from_fn;
use core::hint::black_box;
use core::marker::PhantomData;
use core::mem::MaybeUninit;
use fearless_simd::SimdBase;

/// Variants that a loop is compiled for: a number of gained inputs, any number of them, or the
/// shared input (apart for the first set, so that its rows begin at nothing without a branch).
pub(super) const ANY: usize = usize::MAX;
pub(super) const SHARED: usize = usize::MAX - 1;
pub(super) const SHARED_FIRST: usize = 0;

/// Input of vector `p` of group `s` of a set in sample `at`.
///
/// # Safety
/// As [`inputs`]; `at` is a sample of every input.
#[inline(always)]
unsafe fn heard<T: Set, const K: usize>(
    token: T,
    feed: Feed<'_>,
    part: Part,
    at: usize,
    s: usize,
    p: usize,
) -> Vector<T> {
    // SAFETY: every pointer goes to a lane of an array of LANES values, or to sample `at`.
    unsafe {
        let impulse = |input: &Input<'_>| Vector::<T>::splat(token, *input.impulses.as_ptr().add(at));
        if K == SHARED_FIRST || K == SHARED {
            return impulse(feed.inputs.get_unchecked(0));
        }
        let mut x = Vector::<T>::splat(token, 0.0);
        let count = if K == ANY { feed.inputs.len() } else { K };
        for input in feed.inputs.get_unchecked(..count) {
            let gains = input.gains.get_unchecked(part.from + s).0.as_ptr();
            x = mul_add::<T>(load(token, gains.add(part.lane + p * len::<T>())), impulse(input), x);
        }
        x
    }
}

/// Sums that the sets before this one sent to a turn: one vector column of [`TurnSums`].
///
/// # Safety
/// There are [`len`] lanes from `lane` on; `turn` is written unless this is the
/// first set.
#[inline(always)]
unsafe fn so_far<T: Set>(
    token: T,
    turn: &MaybeUninit<TurnSums>,
    lane: usize,
    is_first: bool,
) -> [Vector<T>; SUMS] {
    // SAFETY: the caller's promise; the rows of a turn lie one after the other.
    unsafe {
        let mut sums = [Vector::<T>::splat(token, 0.0); SUMS];
        if !is_first {
            for i in 0..SUMS {
                sums[i] = load(token, turn.as_ptr().cast::<f32>().add(i * LANES + lane));
            }
        }
        sums
    }
}

/// # Safety
/// As [`so_far`].
#[inline(always)]
unsafe fn keep<T: Set>(turn: &mut MaybeUninit<TurnSums>, lane: usize, sums: [Vector<T>; SUMS]) {
    for i in 0..SUMS {
        // SAFETY: the caller's promise; the rows of a turn lie one after the other.
        unsafe { store::<T>(sums[i], turn.as_mut_ptr().cast::<f32>().add(i * LANES + lane)) }
    }
}

/// The coefficients of `S` groups, [`HOT`] vectors for each vector of modes.
struct Coefficients<'a, T: Set, const P: usize, const S: usize> {
    token: T,
    /// Place of the first lane in coefficient 0 of the first group, and in coefficient 1 but for
    /// the 16 lanes between.
    lanes: [*const f32; 2],
    groups: PhantomData<&'a [ModeGroup]>,
    /// Only where they are kept.
    kept: [[[Vector<T>; P]; S]; HOT],
}

impl<'a, T: Set, const P: usize, const S: usize> Coefficients<'a, T, P, S> {
    /// # Safety
    /// There are `S` groups, and `P` · [`len`] lanes from `lane` on.
    #[inline(always)]
    unsafe fn new(token: T, groups: &'a [ModeGroup], lane: usize) -> Self {
        let first = groups.as_ptr().cast::<f32>();
        // One register each: an address of a base and an index costs another operation at every
        // use.
        let lanes = [0, 1].map(|i| black_box(first.wrapping_add(place(i, lane))));
        // SAFETY: the caller's promise.
        unsafe {
            let nothing = Vector::<T>::splat(token, 0.0);
            let mut all = Self { token, lanes, groups: PhantomData, kept: [[[nothing; P]; S]; HOT] };
            if keeps_coefficients::<T>() {
                // The compiler cannot know that storing sums leaves them as they are.
                for i in 0..HOT {
                    for s in 0..S {
                        for p in 0..P {
                            all.kept[i][s][p] = all.read(i, s, p);
                        }
                    }
                }
            }
            all
        }
    }

    /// # Safety
    /// As [`Self::new`]; `i` is below [`HOT`], `s` and `p` below `S` and `P`.
    #[inline(always)]
    unsafe fn read(&self, i: usize, s: usize, p: usize) -> Vector<T> {
        const { assert!(core::mem::offset_of!(ModeGroup, hot) == 0) };
        let group = s * (size_of::<ModeGroup>() / size_of::<f32>()) + i * LANES;
        // Whole groups begin with lane 0, halves have one vector.
        let vector = if P > 1 { place(i, p * len::<T>()).wrapping_sub(place(i, 0)) } else { 0 };
        let from = self.lanes[i % 2].wrapping_add(group).wrapping_add(vector);
        // SAFETY: the caller's promise.
        unsafe {
            if len::<T>() == LANES && i % 2 == 1 {
                load_swapped(self.token, from.wrapping_sub(place(1, 0)))
            } else {
                load(self.token, from)
            }
        }
    }

    /// # Safety
    /// As [`Self::read`].
    #[inline(always)]
    unsafe fn get(&self, i: usize, s: usize, p: usize) -> Vector<T> {
        // SAFETY: the caller's promise.
        if keeps_coefficients::<T>() { self.kept[i][s][p] } else { unsafe { self.read(i, s, p) } }
    }
}

/// State of `S` groups, v and w.
struct States<T: Set, const P: usize, const S: usize> {
    v: [[Vector<T>; P]; S],
    w: [[Vector<T>; P]; S],
}

impl<T: Set, const P: usize, const S: usize> States<T, P, S> {
    /// Adds what a vector sends to a turn.
    ///
    /// # Safety
    /// As [`Coefficients::read`].
    #[inline(always)]
    unsafe fn accumulate_outputs(
        &self,
        s: usize,
        p: usize,
        by: &Coefficients<'_, T, P, S>,
        sums: &mut [Vector<T>; SUMS],
    ) {
        let (v, w) = (self.v[s][p], self.w[s][p]);
        // SAFETY: the caller's promise.
        unsafe {
            let last = v - w;
            let products = [last, v, last - w, v + w, w];
            for i in 0..SUMS {
                sums[i] = mul_add::<T>(products[i], by.get(OUT + i, s, p), sums[i]);
            }
        }
    }

    /// Adds what all vectors send to the sums of a turn.
    ///
    /// # Safety
    /// As [`so_far`].
    #[inline(always)]
    unsafe fn send(
        &self,
        by: &Coefficients<'_, T, P, S>,
        turn: &mut MaybeUninit<TurnSums>,
        lane: usize,
        is_first: bool,
    ) {
        for p in 0..P {
            // SAFETY: the caller's promise.
            unsafe {
                let mut sums = so_far(by.token, turn, lane + p * len::<T>(), is_first);
                for s in 0..S {
                    self.accumulate_outputs(s, p, by, &mut sums);
                }
                keep::<T>(turn, lane + p * len::<T>(), sums);
            }
        }
    }

    /// Moves one vector on by a turn; `heard` is each pair's first impulse and the sum of both.
    ///
    /// # Safety
    /// As [`Coefficients::read`].
    #[inline(always)]
    unsafe fn step(
        &mut self,
        s: usize,
        p: usize,
        by: &Coefficients<'_, T, P, S>,
        heard: [[Vector<T>; 2]; TURN / 2],
    ) {
        let (mut v, mut w) = (self.v[s][p], self.w[s][p]);
        // SAFETY: the caller's promise.
        unsafe {
            let c =
                [by.get(STEP, s, p), by.get(STEP + 1, s, p), by.get(STEP + 2, s, p), by.get(STEP + 3, s, p)];
            for [x, both] in heard {
                let to_v = mul_add_near_one(by.token, v, c[0], mul_add::<T>(w, c[1], both));
                // In the order of sizes: v is the smaller one.
                let to_w = mul_add::<T>(v, c[2], mul_add_near_one(by.token, w, c[3], x));
                (v, w) = (to_v, to_w);
            }
        }
        (self.v[s][p], self.w[s][p]) = (v, w);
    }
}

/// `S` groups of `P` vectors, four samples a turn; each row of sums receives the groups in their
/// order.
///
/// # Safety
/// As [`inputs`].
#[inline(always)]
pub(super) unsafe fn set<T: Set, const P: usize, const S: usize, const K: usize>(
    token: T,
    job: &mut Job<'_>,
    part: Part,
    chunk: Chunk,
    turns: &mut [MaybeUninit<TurnSums>],
) {
    // SAFETY: every pointer below goes to a lane of an array of LANES
    // values, or to a turn or sample of the chunk.
    unsafe {
        let lane = |p: usize| part.lane + p * len::<T>();
        let by = Coefficients::<T, P, S>::new(token, &job.groups[part.from..part.from + S], part.lane);
        let states = &job.states[part.from..part.from + S];
        let read = |lanes: &Lanes, p: usize| load(token, lanes.as_ptr().add(lane(p)));
        let mut z = States::<T, P, S> {
            v: from_fn(|s| from_fn(|p| read(&states[s].v, p))),
            w: from_fn(|s| from_fn(|p| read(&states[s].w, p))),
        };
        let (feed, pairs) = (job.feed, job.pairs.as_ptr());
        let shared = K == SHARED_FIRST || K == SHARED;
        let is_first = K == SHARED_FIRST || (K != SHARED && part.from == 0);
        let head = chunk.skipped();
        let whole = usize::from(chunk.phase > 0)..(chunk.phase + chunk.len) / TURN;
        if chunk.phase > 0 {
            z.send(&by, &mut turns[0], part.lane, is_first);
            z = cut::<T, P, S, K>(job, part, (chunk.at, chunk.phase, head), &by, z);
        }
        let mut n = head;
        for t in whole.clone() {
            z.send(&by, turns.get_unchecked_mut(t), part.lane, is_first);
            let mut output_gains = [[Vector::<T>::splat(token, 0.0); 2]; TURN / 2];
            if shared {
                for (i, [first, both]) in output_gains.iter_mut().enumerate() {
                    *first = heard::<T, K>(token, feed, part, chunk.at + n + 2 * i, 0, 0);
                    *both = Vector::<T>::splat(token, *pairs.add((n - head) / 2 + i));
                }
            }
            for s in 0..S {
                for p in 0..P {
                    if !shared {
                        for (i, [first, both]) in output_gains.iter_mut().enumerate() {
                            *first = heard::<T, K>(token, feed, part, chunk.at + n + 2 * i, s, p);
                            *both = *first + heard::<T, K>(token, feed, part, chunk.at + n + 2 * i + 1, s, p);
                        }
                    }
                    z.step(s, p, &by, output_gains);
                }
            }
            n += TURN;
        }
        if n < chunk.len {
            z.send(&by, &mut turns[whole.end], part.lane, is_first);
            z = cut::<T, P, S, K>(job, part, (chunk.at + n, 0, chunk.len - n), &by, z);
        }
        let groups = &job.groups[part.from..part.from + S];
        let states = &mut job.states[part.from..part.from + S];
        for s in 0..S {
            for p in 0..P {
                if chunk.ends_on_grid {
                    trim(token, &groups[s], lane(p), &mut z.v[s][p], &mut z.w[s][p]);
                }
                store::<T>(z.v[s][p], states[s].v.as_mut_ptr().add(lane(p)));
                store::<T>(z.w[s][p], states[s].w.as_mut_ptr().add(lane(p)));
            }
        }
    }
}

/// Inputs of the modes in a turn of which the block has only `count` samples, from `phase` on, the
/// first of them being sample `at` of the block: when they complete the turn, the states move on;
/// until then it is kept.
///
/// # Safety
/// As [`set`].
#[inline(always)]
unsafe fn cut<T: Set, const P: usize, const S: usize, const K: usize>(
    job: &mut Job<'_>,
    part: Part,
    (at, phase, count): (usize, usize, usize),
    by: &Coefficients<'_, T, P, S>,
    mut z: States<T, P, S>,
) -> States<T, P, S> {
    let token = by.token;
    for s in 0..S {
        for p in 0..P {
            let lane = part.lane + p * len::<T>();
            let pending = &mut job.states[part.from + s].pending;
            // SAFETY: the caller's promise.
            unsafe {
                let mut output_gains = [Vector::<T>::splat(token, 0.0); TURN];
                for (output_gains, pending) in output_gains.iter_mut().zip(pending.iter()) {
                    *output_gains = load(token, pending.as_ptr().add(lane));
                }
                for i in 0..count {
                    output_gains[phase + i] = heard::<T, K>(token, job.feed, part, at + i, s, p);
                }
                if phase + count == TURN {
                    let [a, b, c, d] = output_gains;
                    z.step(s, p, by, [[a, a + b], [c, c + d]]);
                    output_gains = [Vector::<T>::splat(token, 0.0); TURN];
                }
                // Not by value: an iterator that owns the vectors lies across their alignment, and
                // waits for itself.
                for i in 0..TURN - 1 {
                    store::<T>(output_gains[i], pending[i].as_mut_ptr().add(lane));
                }
            }
        }
    }
    z
}

/// Gives every lane the decay and the phase that `f32` could not store.
///
/// # Safety
/// `lane` + [`len`] is at most LANES.
#[inline(always)]
unsafe fn trim<T: Set>(token: T, group: &ModeGroup, lane: usize, v: &mut Vector<T>, w: &mut Vector<T>) {
    // SAFETY: the caller's promise.
    unsafe {
        let read = |lanes: &Lanes| load(token, lanes.as_ptr().add(lane));
        // The small parts are added up before they meet the large one.
        let nothing = Vector::<T>::splat(token, 0.0);
        let row =
            |[of_v, of_w]: &[Lanes; 2]| mul_add::<T>(*v, read(of_v), mul_add::<T>(*w, read(of_w), nothing));
        let (to_v, to_w) = (row(&group.trim[0]), row(&group.trim[1]));
        (*v, *w) = (*v + to_v, *w + to_w);
    }
}
