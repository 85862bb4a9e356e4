//! The hot loop: which instructions, how many groups at once, and the walk over the 64-sample grid.
#![allow(unsafe_code)]

use super::design::{GRID_SAMPLES, GroupState, LaneGains, ModeGroup};
use super::vector::{Baseline, Row, Vector};
use super::{LANES, sleep};
use core::array::from_fn;
use core::mem::MaybeUninit;

/// An instruction set the bank has code for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// Plain Rust at the baseline of the build target; multiplication and addition round apart.
    Portable,
    /// 64-bit ARM.
    Neon,
    /// x86-64 with AVX2 and FMA.
    Avx2,
    /// x86-64 with AVX-512F.
    Avx512,
}

/// Permission to run one instruction set; exists only for sets this processor has.
///
/// All sets with a fused multiply-add give the same bits; [`Isa::Portable`] differs from them in the
/// last digits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kernel(Isa);

/// One of several inputs of a bank.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// Impulse of each sample, N·s.
    pub impulses: &'a [f32],
    /// What each lane takes from it, one entry a group.
    pub gains: &'a [LaneGains],
}

/// Chunks never cross the grid, so this many rows of lane sums are enough.
const ROWS: usize = GRID_SAMPLES as usize;

impl Kernel {
    /// Runs everywhere.
    pub const PORTABLE: Self = Self(Isa::Portable);

    /// The fastest set of this processor. Without the feature `std`, the set of the build target.
    #[must_use]
    pub fn detect() -> Self {
        [Isa::Avx512, Isa::Avx2, Isa::Neon].into_iter().find_map(Self::find).unwrap_or(Self::PORTABLE)
    }

    /// The kernel for `isa`, if this processor has it.
    #[must_use]
    pub fn find(isa: Isa) -> Option<Self> {
        let present = match isa {
            Isa::Portable => true,
            Isa::Neon => cfg!(target_arch = "aarch64"),
            Isa::Avx2 => has_avx2(),
            Isa::Avx512 => has_avx2() && has_avx512(),
        };
        present.then_some(Self(isa))
    }

    /// Which instruction set this is.
    #[must_use]
    pub const fn isa(self) -> Isa {
        self.0
    }

    /// Adds the bank's response to `impulses_n_s` to `out`; sample 0 of both is the absolute sample
    /// `first_sample`. Every lane hears the one input at gain 1. Slices of unequal length are used as far
    /// as the shortest reaches.
    pub fn render(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        impulses_n_s: &[f32],
        out: &mut [f32],
    ) {
        let input = [Input { impulses: impulses_n_s, gains: &[] }];
        self.walk(first_sample, groups, states, Feed { inputs: &input, shared: true }, out);
    }

    /// As [`Kernel::render`] for several inputs, each with a gain for every lane. Two inputs cost two
    /// more operations a mode and sample than the shared one.
    pub fn render_mixed(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        inputs: &[Input<'_>],
        out: &mut [f32],
    ) {
        self.walk(first_sample, groups, states, Feed { inputs, shared: false }, out);
    }

    fn walk(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        feed: Feed<'_>,
        out: &mut [f32],
    ) {
        let samples = feed.inputs.iter().fold(out.len(), |n, input| n.min(input.impulses.len()));
        let mut count = groups.len().min(states.len());
        if !feed.shared {
            count = feed.inputs.iter().fold(count, |n, input| n.min(input.gains.len()));
        }
        if feed.inputs.is_empty() || count == 0 || samples == 0 {
            return;
        }
        let mut job = Job { groups: &groups[..count], states: &mut states[..count], feed };
        let out = &mut out[..samples];
        match self.0 {
            // SAFETY: the plain vector needs no instruction beyond the baseline.
            Isa::Portable => unsafe { walk::<Baseline, 4, 1>(first_sample, &mut job, out) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a Kernel of this set exists only where the processor has it.
            Isa::Avx2 => unsafe { walk_avx2(first_sample, &mut job, out) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Isa::Avx512 => unsafe { walk_avx512(first_sample, &mut job, out) },
            #[cfg(target_arch = "aarch64")]
            // SAFETY: NEON is part of the base of this architecture.
            Isa::Neon => unsafe { walk::<super::vector::neon::Neon, 4, 2>(first_sample, &mut job, out) },
            // Sets of other architectures: `find` never makes such a kernel.
            #[allow(unreachable_patterns)]
            _ => {}
        }
    }

    /// Puts lanes whose amplitude is below `threshold` (output units) exactly to rest and returns how
    /// many leading groups still ring; the rest need no rendering until the next input. Lanes that
    /// hold no finite number are put to rest as well.
    ///
    /// Call it at absolute multiples of [`GRID_SAMPLES`], or the output depends on the split into blocks.
    pub fn settle(self, groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: a Kernel of these sets exists only where the processor has them.
            Isa::Avx2 | Isa::Avx512 => unsafe { settle_avx2(groups, states, threshold) },
            _ => sleep::settle(groups, states, threshold),
        }
    }
}

#[cfg(all(target_arch = "x86_64", feature = "std"))]
fn has_avx2() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}
#[cfg(all(target_arch = "x86_64", feature = "std"))]
fn has_avx512() -> bool {
    std::is_x86_feature_detected!("avx512f")
}
#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
fn has_avx2() -> bool {
    cfg!(all(target_arch = "x86_64", target_feature = "avx2", target_feature = "fma"))
}
#[cfg(not(all(target_arch = "x86_64", feature = "std")))]
fn has_avx512() -> bool {
    cfg!(all(target_arch = "x86_64", target_feature = "avx512f"))
}

/// The inputs of one call; `shared` means one input, gain 1.
#[derive(Clone, Copy)]
struct Feed<'a> {
    inputs: &'a [Input<'a>],
    shared: bool,
}

struct Job<'a> {
    groups: &'a [ModeGroup],
    states: &'a mut [GroupState],
    feed: Feed<'a>,
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn walk_avx2(first_sample: u64, job: &mut Job<'_>, out: &mut [f32]) {
    // SAFETY: this function is only called where AVX2 and FMA are present.
    unsafe { walk::<super::vector::x86::Avx2, 2, 3>(first_sample, job, out) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
unsafe fn walk_avx512(first_sample: u64, job: &mut Job<'_>, out: &mut [f32]) {
    // SAFETY: this function is only called where AVX-512F is present.
    unsafe { walk::<super::vector::x86::Avx512, 1, 6>(first_sample, job, out) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn settle_avx2(groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
    sleep::settle(groups, states, threshold)
}

/// Walks the block in chunks that end on the absolute grid. `P` vectors make a group, and at most
/// `MAX` groups are interleaved.
#[inline(always)]
unsafe fn walk<V: Vector, const P: usize, const MAX: usize>(
    first_sample: u64,
    job: &mut Job<'_>,
    out: &mut [f32],
) {
    let mut sums: [MaybeUninit<Row>; ROWS] = [const { MaybeUninit::uninit() }; ROWS];
    let (mut at, samples) = (0, out.len());
    while at < samples {
        let now = first_sample.wrapping_add(at as u64);
        let len = ((GRID_SAMPLES - now % GRID_SAMPLES) as usize).min(samples - at);
        let rows = &mut sums[..len];
        // SAFETY: the caller has the instructions of V; `at + len` is inside every input. The first set
        // writes every row, and there is one: `walk` is not called without groups. So the rows may be read
        // as what they are, in the same memory.
        unsafe {
            sets::<V, P, MAX>(job, at, rows);
            let written = core::slice::from_raw_parts(rows.as_ptr().cast::<Row>(), len);
            V::add_sums(written, &mut out[at..at + len]);
        }
        if now.wrapping_add(len as u64).is_multiple_of(GRID_SAMPLES) {
            for (group, state) in job.groups.iter().zip(job.states.iter_mut()) {
                // SAFETY: the caller has the instructions of V.
                unsafe { trim::<V, P>(group, state) };
            }
        }
        at += len;
    }
}

/// Gives every lane the decay and the phase that `f32` could not store.
#[inline(always)]
unsafe fn trim<V: Vector, const P: usize>(group: &ModeGroup, state: &mut GroupState) {
    for p in 0..P {
        let lane = p * V::LEN;
        // SAFETY: `lane` and the LEN − 1 after it are inside arrays of LANES = P · LEN values.
        unsafe {
            let read = |lanes: &[f32; LANES]| V::load(lanes.as_ptr().add(lane));
            let (y, d) = (read(&state.y), read(&state.d));
            // The small parts are added up before they meet the large one.
            let to_y = y.mul_add(read(&group.trim_yy), d.mul_add(read(&group.trim_yd), V::splat(0.0)));
            let to_d = y.mul_add(read(&group.trim_dy), d.mul_add(read(&group.trim_dd), V::splat(0.0)));
            y.add(to_y).store(state.y.as_mut_ptr().add(lane));
            d.add(to_d).store(state.d.as_mut_ptr().add(lane));
        }
    }
}

/// Cuts the groups into sets of nearly equal size, at most `MAX` each: a set that is too small waits
/// for its own results, one that is too large spills its registers.
#[inline(always)]
unsafe fn sets<V: Vector, const P: usize, const MAX: usize>(
    job: &mut Job<'_>,
    at: usize,
    rows: &mut [MaybeUninit<Row>],
) {
    let count = job.groups.len();
    let mut from = 0;
    let mut left = count.div_ceil(MAX);
    while left > 0 {
        let size = (count - from).div_ceil(left);
        // SAFETY: passed on from the caller; `from + size` is at most the number of groups.
        unsafe {
            match size {
                1 => inputs::<V, P, 1>(job, from, at, rows),
                2 if MAX >= 2 => inputs::<V, P, 2>(job, from, at, rows),
                3 if MAX >= 3 => inputs::<V, P, 3>(job, from, at, rows),
                4 if MAX >= 4 => inputs::<V, P, 4>(job, from, at, rows),
                5 if MAX >= 5 => inputs::<V, P, 5>(job, from, at, rows),
                6 if MAX >= 6 => inputs::<V, P, 6>(job, from, at, rows),
                7 if MAX >= 7 => inputs::<V, P, 7>(job, from, at, rows),
                _ if MAX >= 8 => inputs::<V, P, 8>(job, from, at, rows),
                _ => {}
            }
        }
        from += size;
        left -= 1;
    }
}

/// How many gained inputs a loop is compiled for; 0 is the shared input.
const ANY: usize = usize::MAX;

#[inline(always)]
unsafe fn inputs<V: Vector, const P: usize, const S: usize>(
    job: &mut Job<'_>,
    from: usize,
    at: usize,
    rows: &mut [MaybeUninit<Row>],
) {
    // SAFETY: passed on from the caller.
    unsafe {
        match job.feed.inputs.len() {
            _ if job.feed.shared => set::<V, P, S, 0>(job, from, at, rows),
            1 => set::<V, P, S, 1>(job, from, at, rows),
            2 => set::<V, P, S, 2>(job, from, at, rows),
            _ => set::<V, P, S, ANY>(job, from, at, rows),
        }
    }
}

/// `S` groups of `P` vectors, sample by sample; each row of sums receives the groups in their order.
#[inline(always)]
unsafe fn set<V: Vector, const P: usize, const S: usize, const K: usize>(
    job: &mut Job<'_>,
    from: usize,
    at: usize,
    rows: &mut [MaybeUninit<Row>],
) {
    let groups = &job.groups[from..from + S];
    let feed = job.feed.inputs;
    // SAFETY: the caller has the instructions of V. Every pointer below goes to lane p · LEN of an array
    // of LANES = P · LEN values, or to sample `at + n` of an input that has `at + rows.len()` of them.
    unsafe {
        let mut y = [[V::splat(0.0); P]; S];
        let mut d = y;
        for s in 0..S {
            let state = &job.states[from + s];
            for p in 0..P {
                y[s][p] = V::load(state.y.as_ptr().add(p * V::LEN));
                d[s][p] = V::load(state.d.as_ptr().add(p * V::LEN));
            }
        }
        // Read before the loop: the compiler cannot know that storing sums leaves them as they are.
        let read = |lanes: &[f32; LANES], p: usize| V::load(lanes.as_ptr().add(p * V::LEN));
        let r2: [[V; P]; S] = from_fn(|s| from_fn(|p| read(&groups[s].r2, p)));
        let m: [[V; P]; S] = from_fn(|s| from_fn(|p| read(&groups[s].m, p)));
        let out_y: [[V; P]; S] = from_fn(|s| from_fn(|p| read(&groups[s].out_y, p)));
        let out_d: [[V; P]; S] = from_fn(|s| from_fn(|p| read(&groups[s].out_d, p)));
        let shared = feed[0].impulses.as_ptr().add(at);
        for (n, row) in rows.iter_mut().enumerate() {
            let row = row.as_mut_ptr().cast::<f32>();
            let mut sum = [V::splat(0.0); P];
            if from > 0 {
                for (p, sum) in sum.iter_mut().enumerate() {
                    *sum = V::load(row.add(p * V::LEN));
                }
            }
            let u = V::splat(if K == 0 { *shared.add(n) } else { 0.0 });
            for s in 0..S {
                for p in 0..P {
                    let lane = p * V::LEN;
                    let mut x = u;
                    if K != 0 {
                        let count = if K == ANY { feed.len() } else { K };
                        for input in feed.get_unchecked(..count) {
                            let gains = input.gains.get_unchecked(from + s).0.as_ptr().add(lane);
                            let impulse = V::splat(*input.impulses.as_ptr().add(at + n));
                            x = V::load(gains).mul_add(impulse, x);
                        }
                    }
                    let kept = d[s][p].mul_add(r2[s][p], x);
                    d[s][p] = y[s][p].neg_mul_add(m[s][p], kept);
                    y[s][p] = y[s][p].add(d[s][p]);
                    sum[p] = y[s][p].mul_add(out_y[s][p], sum[p]);
                    sum[p] = d[s][p].mul_add(out_d[s][p], sum[p]);
                }
            }
            for (p, sum) in sum.into_iter().enumerate() {
                sum.store(row.add(p * V::LEN));
            }
        }
        for s in 0..S {
            let state = &mut job.states[from + s];
            for p in 0..P {
                y[s][p].store(state.y.as_mut_ptr().add(p * V::LEN));
                d[s][p].store(state.d.as_mut_ptr().add(p * V::LEN));
            }
        }
    }
}
