//! The hot loop: some groups of modes through one chunk, four samples a turn.
#![allow(unsafe_code)]
// `s` counts groups, `p` vectors of each and `i` rows, in several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::LANES;
use super::design::{HOT, Lanes, ModeGroup, OUT, STEP, TURN, place};
use super::job::{Chunk, Feed, Input, Job, Part};
use super::sums::{SUMS, TurnSums};
use super::vector::Vector;
use core::array::from_fn;
use core::hint::black_box;
use core::marker::PhantomData;
use core::mem::MaybeUninit;

/// What a loop is compiled for: a number of gained inputs, any number of them, or the shared input (apart for the
/// first set, so that its rows begin at nothing without a branch).
pub(super) const ANY: usize = usize::MAX;
pub(super) const SHARED: usize = usize::MAX - 1;
pub(super) const SHARED_FIRST: usize = 0;

/// What vector `p` of group `s` of a set hears in sample `at`.
///
/// # Safety
/// As [`inputs`]; `at` is a sample of every input.
#[inline(always)]
unsafe fn heard<V: Vector, const K: usize>(feed: Feed<'_>, part: Part, at: usize, s: usize, p: usize) -> V {
    // SAFETY: every pointer goes to a lane of an array of LANES values, or to sample `at`.
    unsafe {
        let impulse = |input: &Input<'_>| V::splat(*input.impulses.as_ptr().add(at));
        if K == SHARED_FIRST || K == SHARED {
            return impulse(feed.inputs.get_unchecked(0));
        }
        let mut x = V::splat(0.0);
        let count = if K == ANY { feed.inputs.len() } else { K };
        for input in feed.inputs.get_unchecked(..count) {
            let gains = input.gains.get_unchecked(part.from + s).0.as_ptr();
            x = V::load(gains.add(part.lane + p * V::LEN)).mul_add(impulse(input), x);
        }
        x
    }
}

/// What the sets before this one sent to a turn: one vector column of [`TurnSums`].
///
/// # Safety
/// The processor has the instructions of V; there are LEN lanes from `lane` on; `turn` is written unless this is the
/// first set.
#[inline(always)]
unsafe fn so_far<V: Vector>(turn: &MaybeUninit<TurnSums>, lane: usize, is_first: bool) -> [V; SUMS] {
    // SAFETY: the caller's promise; the rows of a turn lie one after the other.
    unsafe {
        let mut sums = [V::splat(0.0); SUMS];
        if !is_first {
            for i in 0..SUMS {
                sums[i] = V::load(turn.as_ptr().cast::<f32>().add(i * LANES + lane));
            }
        }
        sums
    }
}

/// # Safety
/// As [`so_far`].
#[inline(always)]
unsafe fn keep<V: Vector>(turn: &mut MaybeUninit<TurnSums>, lane: usize, sums: [V; SUMS]) {
    for i in 0..SUMS {
        // SAFETY: the caller's promise; the rows of a turn lie one after the other.
        unsafe { sums[i].store(turn.as_mut_ptr().cast::<f32>().add(i * LANES + lane)) }
    }
}

/// The coefficients of `S` groups, [`HOT`] vectors for each vector of modes.
struct Coefficients<'a, V, const P: usize, const S: usize> {
    /// Where the first lane lies in coefficient 0 of the first group, and in coefficient 1 but for the 16 lanes between.
    lanes: [*const f32; 2],
    groups: PhantomData<&'a [ModeGroup]>,
    /// Only where V keeps them.
    kept: [[[V; P]; S]; HOT],
}

impl<'a, V: Vector, const P: usize, const S: usize> Coefficients<'a, V, P, S> {
    /// # Safety
    /// The processor has the instructions of V; there are `S` groups, and `P` · LEN lanes from `lane` on.
    #[inline(always)]
    unsafe fn new(groups: &'a [ModeGroup], lane: usize) -> Self {
        let first = groups.as_ptr().cast::<f32>();
        // One register each: an address of a base and an index costs another operation at every use.
        let lanes = [0, 1].map(|i| black_box(first.wrapping_add(place(i, lane))));
        // SAFETY: the caller's promise.
        unsafe {
            let mut all = Self { lanes, groups: PhantomData, kept: [[[V::splat(0.0); P]; S]; HOT] };
            if V::KEEPS_COEFFICIENTS {
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
    unsafe fn read(&self, i: usize, s: usize, p: usize) -> V {
        const { assert!(core::mem::offset_of!(ModeGroup, hot) == 0) };
        let group = s * (size_of::<ModeGroup>() / size_of::<f32>()) + i * LANES;
        // Whole groups begin with lane 0, halves have one vector.
        let vector = if P > 1 { place(i, p * V::LEN).wrapping_sub(place(i, 0)) } else { 0 };
        let from = self.lanes[i % 2].wrapping_add(group).wrapping_add(vector);
        // SAFETY: the caller's promise.
        unsafe {
            if V::LEN == LANES && i % 2 == 1 {
                V::load_swapped(from.wrapping_sub(place(1, 0)))
            } else {
                V::load(from)
            }
        }
    }

    /// # Safety
    /// As [`Self::read`].
    #[inline(always)]
    unsafe fn get(&self, i: usize, s: usize, p: usize) -> V {
        // SAFETY: the caller's promise.
        if V::KEEPS_COEFFICIENTS { self.kept[i][s][p] } else { unsafe { self.read(i, s, p) } }
    }
}

/// What `S` groups remember, v and w.
struct States<V, const P: usize, const S: usize> {
    v: [[V; P]; S],
    w: [[V; P]; S],
}

impl<V: Vector, const P: usize, const S: usize> States<V, P, S> {
    /// Adds what a vector sends to a turn.
    ///
    /// # Safety
    /// As [`Coefficients::read`].
    #[inline(always)]
    unsafe fn hear(&self, s: usize, p: usize, by: &Coefficients<'_, V, P, S>, sums: &mut [V; SUMS]) {
        let (v, w) = (self.v[s][p], self.w[s][p]);
        // SAFETY: the caller's promise.
        unsafe {
            let last = v.sub(w);
            for (i, x) in [last, v, last.sub(w), v.add(w), w].into_iter().enumerate() {
                sums[i] = x.mul_add(by.get(OUT + i, s, p), sums[i]);
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
        by: &Coefficients<'_, V, P, S>,
        turn: &mut MaybeUninit<TurnSums>,
        lane: usize,
        is_first: bool,
    ) {
        for p in 0..P {
            // SAFETY: the caller's promise.
            unsafe {
                let mut sums = so_far(turn, lane + p * V::LEN, is_first);
                for s in 0..S {
                    self.hear(s, p, by, &mut sums);
                }
                keep(turn, lane + p * V::LEN, sums);
            }
        }
    }

    /// Moves one vector on by a turn; `heard` is each pair's first impulse and the sum of both.
    ///
    /// # Safety
    /// As [`Coefficients::read`].
    #[inline(always)]
    unsafe fn step(&mut self, s: usize, p: usize, by: &Coefficients<'_, V, P, S>, heard: [[V; 2]; TURN / 2]) {
        let (mut v, mut w) = (self.v[s][p], self.w[s][p]);
        // SAFETY: the caller's promise.
        unsafe {
            let c =
                [by.get(STEP, s, p), by.get(STEP + 1, s, p), by.get(STEP + 2, s, p), by.get(STEP + 3, s, p)];
            for [x, both] in heard {
                let to_v = v.mul_add_near_one(c[0], w.mul_add(c[1], both));
                // In the order of sizes: v is the smaller one.
                let to_w = v.mul_add(c[2], w.mul_add_near_one(c[3], x));
                (v, w) = (to_v, to_w);
            }
        }
        (self.v[s][p], self.w[s][p]) = (v, w);
    }
}

/// `S` groups of `P` vectors, four samples a turn; each row of sums receives the groups in their order.
///
/// # Safety
/// As [`inputs`].
#[inline(always)]
pub(super) unsafe fn set<V: Vector, const P: usize, const S: usize, const K: usize>(
    job: &mut Job<'_>,
    part: Part,
    chunk: Chunk,
    turns: &mut [MaybeUninit<TurnSums>],
) {
    // SAFETY: the caller has the instructions of V. Every pointer below goes to a lane of an array of LANES
    // values, or to a turn or sample of the chunk.
    unsafe {
        let lane = |p: usize| part.lane + p * V::LEN;
        let by = Coefficients::<V, P, S>::new(&job.groups[part.from..part.from + S], part.lane);
        let states = &job.states[part.from..part.from + S];
        let read = |lanes: &Lanes, p: usize| V::load(lanes.as_ptr().add(lane(p)));
        let mut z = States::<V, P, S> {
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
            z = cut::<V, P, S, K>(job, part, (chunk.at, chunk.phase, head), &by, z);
        }
        let mut n = head;
        for t in whole.clone() {
            z.send(&by, turns.get_unchecked_mut(t), part.lane, is_first);
            let mut hears = [[V::splat(0.0); 2]; TURN / 2];
            if shared {
                for (i, [first, both]) in hears.iter_mut().enumerate() {
                    *first = heard::<V, K>(feed, part, chunk.at + n + 2 * i, 0, 0);
                    *both = V::splat(*pairs.add((n - head) / 2 + i));
                }
            }
            for s in 0..S {
                for p in 0..P {
                    if !shared {
                        for (i, [first, both]) in hears.iter_mut().enumerate() {
                            *first = heard::<V, K>(feed, part, chunk.at + n + 2 * i, s, p);
                            *both = first.add(heard::<V, K>(feed, part, chunk.at + n + 2 * i + 1, s, p));
                        }
                    }
                    z.step(s, p, &by, hears);
                }
            }
            n += TURN;
        }
        if n < chunk.len {
            z.send(&by, &mut turns[whole.end], part.lane, is_first);
            z = cut::<V, P, S, K>(job, part, (chunk.at + n, 0, chunk.len - n), &by, z);
        }
        let groups = &job.groups[part.from..part.from + S];
        let states = &mut job.states[part.from..part.from + S];
        for s in 0..S {
            for p in 0..P {
                if chunk.ends_on_grid {
                    trim(&groups[s], lane(p), &mut z.v[s][p], &mut z.w[s][p]);
                }
                z.v[s][p].store(states[s].v.as_mut_ptr().add(lane(p)));
                z.w[s][p].store(states[s].w.as_mut_ptr().add(lane(p)));
            }
        }
    }
}

/// What the modes hear in a turn of which the block has only `count` samples, from `phase` on, the first of them being
/// sample `at` of the block: when they complete the turn, the states move on; until then it is kept.
///
/// # Safety
/// As [`set`].
#[inline(always)]
unsafe fn cut<V: Vector, const P: usize, const S: usize, const K: usize>(
    job: &mut Job<'_>,
    part: Part,
    (at, phase, count): (usize, usize, usize),
    by: &Coefficients<'_, V, P, S>,
    mut z: States<V, P, S>,
) -> States<V, P, S> {
    for s in 0..S {
        for p in 0..P {
            let lane = part.lane + p * V::LEN;
            let pending = &mut job.states[part.from + s].pending;
            // SAFETY: the caller's promise.
            unsafe {
                let mut hears = [V::splat(0.0); TURN];
                for (hears, pending) in hears.iter_mut().zip(pending.iter()) {
                    *hears = V::load(pending.as_ptr().add(lane));
                }
                for i in 0..count {
                    hears[phase + i] = heard::<V, K>(job.feed, part, at + i, s, p);
                }
                if phase + count == TURN {
                    let [a, b, c, d] = hears;
                    z.step(s, p, by, [[a, a.add(b)], [c, c.add(d)]]);
                    hears = [V::splat(0.0); TURN];
                }
                for (hears, pending) in hears.into_iter().zip(pending) {
                    hears.store(pending.as_mut_ptr().add(lane));
                }
            }
        }
    }
    z
}

/// Gives every lane the decay and the phase that `f32` could not store.
///
/// # Safety
/// The processor has the instructions of V; `lane` + LEN is at most LANES.
#[inline(always)]
unsafe fn trim<V: Vector>(group: &ModeGroup, lane: usize, v: &mut V, w: &mut V) {
    // SAFETY: the caller's promise.
    unsafe {
        let read = |lanes: &Lanes| V::load(lanes.as_ptr().add(lane));
        // The small parts are added up before they meet the large one.
        let nothing = V::splat(0.0);
        let to_v = v.mul_add(read(&group.trim[0][0]), w.mul_add(read(&group.trim[0][1]), nothing));
        let to_w = v.mul_add(read(&group.trim[1][0]), w.mul_add(read(&group.trim[1][1]), nothing));
        (*v, *w) = (v.add(to_v), w.add(to_w));
    }
}
