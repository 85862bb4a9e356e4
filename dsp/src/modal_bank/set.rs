//! The hot loop: some groups of modes through one chunk, two samples a step.
#![allow(unsafe_code)]
// `s` counts groups and `p` vectors of each, in several arrays at once.
#![allow(clippy::needless_range_loop)]

use super::LANES;
use super::design::{FIRST, HOT, Lanes, ModeGroup, SECOND, STEP, place};
use super::kernel::Input;
use super::vector::{Row, Vector};
use super::walk::{Chunk, Feed, Job, Part};
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

/// Where the sums of vector `p` of a row begin.
#[inline(always)]
fn lane_of<V: Vector>(row: &mut MaybeUninit<Row>, part: Part, p: usize) -> *mut f32 {
    row.as_mut_ptr().cast::<f32>().wrapping_add(part.lane + p * V::LEN)
}

/// What the sets before this one left in a row.
///
/// # Safety
/// The processor has the instructions of V; there are `P` · LEN lanes from `part.lane` on; the row is written
/// unless this is the first set.
#[inline(always)]
unsafe fn so_far<V: Vector, const P: usize, const K: usize>(
    row: &mut MaybeUninit<Row>,
    part: Part,
) -> [V; P] {
    // SAFETY: the caller's promise.
    from_fn(|p| unsafe {
        if K == SHARED_FIRST || (K != SHARED && part.from == 0) {
            V::splat(0.0)
        } else {
            V::load(lane_of::<V>(row, part, p))
        }
    })
}

/// # Safety
/// As [`so_far`].
#[inline(always)]
unsafe fn keep<V: Vector, const P: usize>(row: &mut MaybeUninit<Row>, part: Part, sum: [V; P]) {
    for (p, sum) in sum.into_iter().enumerate() {
        // SAFETY: the caller's promise.
        unsafe { sum.store(lane_of::<V>(row, part, p)) }
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
    /// Adds to `sum` what group `s` sends to one sample of the pair.
    ///
    /// # Safety
    /// As [`Coefficients::read`]; `of` is an output.
    #[inline(always)]
    unsafe fn hear(&self, s: usize, p: usize, by: &Coefficients<'_, V, P, S>, of: usize, sum: &mut V) {
        // SAFETY: the caller's promise.
        unsafe {
            *sum = self.v[s][p].mul_add(by.get(of, s, p), *sum);
            *sum = self.w[s][p].mul_add(by.get(of + 1, s, p), *sum);
        }
    }

    /// Moves one vector on by the two samples in which it hears x and y.
    ///
    /// # Safety
    /// As [`Coefficients::read`].
    #[inline(always)]
    unsafe fn step(&mut self, s: usize, p: usize, by: &Coefficients<'_, V, P, S>, x: V, both: V) {
        let (v, w) = (self.v[s][p], self.w[s][p]);
        // SAFETY: the caller's promise.
        unsafe {
            let to_v = v.mul_add_near_one(by.get(STEP, s, p), w.mul_add(by.get(STEP + 1, s, p), both));
            // In the order of sizes: v is the smaller one.
            let to_w = v.mul_add(by.get(STEP + 2, s, p), w.mul_add_near_one(by.get(STEP + 3, s, p), x));
            (self.v[s][p], self.w[s][p]) = (to_v, to_w);
        }
    }
}

/// `S` groups of `P` vectors, two samples a step; each row of sums receives the groups in their order.
///
/// # Safety
/// As [`inputs`].
#[inline(always)]
pub(super) unsafe fn set<V: Vector, const P: usize, const S: usize, const K: usize>(
    job: &mut Job<'_>,
    part: Part,
    chunk: Chunk,
    rows: &mut [MaybeUninit<Row>],
) {
    let groups = &job.groups[part.from..part.from + S];
    let states = &mut job.states[part.from..part.from + S];
    let feed = job.feed;
    let pairs = job.pairs.as_ptr();
    // SAFETY: the caller has the instructions of V. Every pointer below goes to a lane of an array of LANES
    // values, or to a row or sample of the chunk.
    unsafe {
        let lane = |p: usize| part.lane + p * V::LEN;
        let read = |lanes: &Lanes, p: usize| V::load(lanes.as_ptr().add(lane(p)));
        let by = Coefficients::<V, P, S>::new(groups, part.lane);
        let mut z = States::<V, P, S> {
            v: from_fn(|s| from_fn(|p| read(&states[s].v, p))),
            w: from_fn(|s| from_fn(|p| read(&states[s].w, p))),
        };

        let (mut n, len) = (0, rows.len());
        if chunk.odd {
            let mut sum = so_far::<V, P, K>(&mut rows[0], part);
            for s in 0..S {
                for p in 0..P {
                    let x = read(&states[s].pending, p);
                    z.hear(s, p, &by, SECOND, &mut sum[p]);
                    let y = heard::<V, K>(feed, part, chunk.at, s, p);
                    z.step(s, p, &by, x, x.add(y));
                    V::splat(0.0).store(states[s].pending.as_mut_ptr().add(lane(p)));
                }
            }
            keep(&mut rows[0], part, sum);
            n = 1;
        }
        while n + 1 < len {
            let mut first = so_far::<V, P, K>(rows.get_unchecked_mut(n), part);
            let mut second = so_far::<V, P, K>(rows.get_unchecked_mut(n + 1), part);
            let shared = K == SHARED_FIRST || K == SHARED;
            let (x, both) = match shared {
                true => (heard::<V, K>(feed, part, chunk.at + n, 0, 0), V::splat(*pairs.add(n / 2))),
                false => (V::splat(0.0), V::splat(0.0)),
            };
            // Both sums and the steps in turn: each waits for itself.
            for s in 0..S {
                for p in 0..P {
                    z.hear(s, p, &by, FIRST, &mut first[p]);
                    z.hear(s, p, &by, SECOND, &mut second[p]);
                    let (x, both) = if shared {
                        (x, both)
                    } else {
                        let x = heard::<V, K>(feed, part, chunk.at + n, s, p);
                        (x, x.add(heard::<V, K>(feed, part, chunk.at + n + 1, s, p)))
                    };
                    z.step(s, p, &by, x, both);
                }
            }
            keep(rows.get_unchecked_mut(n), part, first);
            keep(rows.get_unchecked_mut(n + 1), part, second);
            n += 2;
        }
        if n < len {
            let mut sum = so_far::<V, P, K>(&mut rows[n], part);
            for s in 0..S {
                for p in 0..P {
                    z.hear(s, p, &by, FIRST, &mut sum[p]);
                    let x = heard::<V, K>(feed, part, chunk.at + n, s, p);
                    x.store(states[s].pending.as_mut_ptr().add(lane(p)));
                }
            }
            keep(&mut rows[n], part, sum);
        }
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
