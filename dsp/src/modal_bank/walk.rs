//! The walk over the 64-sample grid, what inputs send past the modes, and how many groups go at once.
#![allow(unsafe_code)]

use super::LANES;
use super::design::{FIRST, GRID_SAMPLES, GroupState, LaneGains, ModeGroup};
use super::kernel::Input;
use super::set::{ANY, SHARED, SHARED_FIRST, set};
use super::sleep::MAX_INPUTS;
use super::vector::{Row, Vector};
use core::mem::MaybeUninit;

/// Chunks never cross the grid, so this many rows of lane sums are enough.
pub(super) const ROWS: usize = GRID_SAMPLES as usize;

/// The inputs of one call; `shared` means one input, gain 1.
#[derive(Clone, Copy)]
pub(super) struct Feed<'a> {
    pub inputs: &'a [Input<'a>],
    pub shared: bool,
}

pub(super) struct Job<'a> {
    pub groups: &'a [ModeGroup],
    pub states: &'a mut [GroupState],
    pub feed: Feed<'a>,
    /// The two impulses of each whole pair of the chunk, added; of the shared input only.
    pub pairs: [f32; ROWS / 2],
}

impl Job<'_> {
    /// Once for all modes what each would add up again.
    #[inline(always)]
    fn add_pairs(&mut self, chunk: Chunk) {
        if let (true, [input]) = (self.feed.shared, self.feed.inputs) {
            let heard = &input.impulses[chunk.at + usize::from(chunk.odd)..chunk.at + chunk.len];
            for (sum, pair) in self.pairs.iter_mut().zip(heard.as_chunks::<2>().0) {
                *sum = pair[0] + pair[1];
            }
        }
    }
}

/// Some samples within one turn of the grid.
#[derive(Clone, Copy)]
pub(super) struct Chunk {
    /// Where in the block it begins.
    pub at: usize,
    pub len: usize,
    /// It begins with the second sample of a pair.
    pub odd: bool,
    /// It ends on the grid, where states are trimmed.
    pub ends_on_grid: bool,
}

/// Walks the block in chunks that end on the absolute grid. `P` vectors make a group, and at most
/// `MAX` groups are interleaved.
///
/// # Safety
/// The processor has the instructions of V; `out` is no longer than any input; there is at least one group, and
/// as many states, and gains of every input unless it is shared.
#[inline(always)]
pub(super) unsafe fn walk<V: Vector, const P: usize, const MAX: usize>(
    first_sample: u64,
    job: &mut Job<'_>,
    out: &mut [f32],
) {
    let mut sums: [MaybeUninit<Row>; ROWS] = [const { MaybeUninit::uninit() }; ROWS];
    let (mut at, samples) = (0, out.len());
    // SAFETY: the caller has the instructions of V.
    let direct = unsafe { Direct::new::<V, P>(job) };
    while at < samples {
        let now = first_sample.wrapping_add(at as u64);
        let len = ((GRID_SAMPLES - now % GRID_SAMPLES) as usize).min(samples - at);
        let ends_on_grid = now.wrapping_add(len as u64).is_multiple_of(GRID_SAMPLES);
        let chunk = Chunk { at, len, odd: !now.is_multiple_of(2), ends_on_grid };
        job.add_pairs(chunk);
        // SAFETY: `at + len` is inside every input. The first set writes every row, and there is one. So the
        // rows may be read as what they are, in the same memory.
        unsafe {
            sets::<V, P, MAX>(job, chunk, &mut sums[..len]);
            let written = core::slice::from_raw_parts(sums.as_ptr().cast::<Row>(), len);
            V::add_sums(written, &mut out[at..at + len]);
        }
        direct.add(job, chunk, &mut out[at..at + len]);
        at += len;
    }
}

/// What inputs send past the states: to the output of their own sample and, in the first sample of a pair, to
/// that of the second. The same for all modes together, so it costs nothing a mode.
struct Direct {
    own: [f32; MAX_INPUTS],
    next: [f32; MAX_INPUTS],
}

impl Direct {
    /// # Safety
    /// As [`walk`].
    #[inline(always)]
    unsafe fn new<V: Vector, const P: usize>(job: &Job<'_>) -> Self {
        let mut direct = Self { own: [0.0; MAX_INPUTS], next: [0.0; MAX_INPUTS] };
        for (k, input) in job.feed.inputs.iter().enumerate().take(MAX_INPUTS) {
            let gains = if job.feed.shared { &[] } else { input.gains };
            // SAFETY: passed on from the caller.
            [direct.own[k], direct.next[k]] = unsafe { lane_sums::<V, P>(job.groups, gains) };
        }
        direct
    }

    /// Adds its share to the output of a chunk, and keeps what a pair that is cut in two needs.
    #[inline(always)]
    fn add(&self, job: &mut Job<'_>, chunk: Chunk, out: &mut [f32]) {
        let inputs = job.feed.inputs;
        // The sum over the inputs, each with its weight, of sample `n` of the chunk.
        let sum = |weights: &[f32], n: usize| {
            inputs.iter().zip(weights).fold(0.0, |sum, (input, to)| sum + to * input.impulses[chunk.at + n])
        };
        let carried = &mut job.states[0].carried;
        let odd = usize::from(chunk.odd);
        if let (true, Some(y)) = (chunk.odd, out.first_mut()) {
            *y += sum(&self.own, 0) + core::mem::take(carried);
        }
        let (eights, rest) = out[odd..].as_chunks_mut::<8>();
        let after = odd + 8 * eights.len();
        for (e, y) in eights.iter_mut().enumerate() {
            let (mut own, mut next) = ([0.0; 8], [0.0; 8]);
            for ((input, to_own), to_next) in inputs.iter().zip(self.own).zip(self.next) {
                let Some(u) = input.impulses[chunk.at + odd + 8 * e..].first_chunk::<8>() else { continue };
                for i in 0..8 {
                    own[i] += to_own * u[i];
                    // Whole vectors of which every other weight is zero are faster than every other sample.
                    next[i] += if i % 2 == 1 { to_next } else { 0.0 } * u[i & !1];
                }
            }
            for i in 0..8 {
                y[i] += own[i] + next[i];
            }
        }
        for (i, y) in rest.iter_mut().enumerate() {
            let next = if i % 2 == 1 { sum(&self.next, after + i - 1) } else { 0.0 };
            *y += sum(&self.own, after + i) + next;
        }
        if rest.len() % 2 == 1 {
            *carried = sum(&self.next, chunk.len - 1);
        }
    }
}

/// The sums over all lanes of what an impulse sends to its own and to the next sample, times the gains, which
/// are 1 where there are none.
///
/// # Safety
/// The processor has the instructions of V; there are no gains or those of all groups.
#[inline(always)]
unsafe fn lane_sums<V: Vector, const P: usize>(groups: &[ModeGroup], gains: &[LaneGains]) -> [f32; 2] {
    let mut rows = [Row([0.0; LANES]); 2];
    // SAFETY: every pointer goes to lane p · LEN of an array of LANES = P · LEN values.
    unsafe {
        // Two sums each, of even and odd groups: one alone waits for itself.
        let (mut own, mut next) = ([[V::splat(0.0); P]; 2], [[V::splat(0.0); P]; 2]);
        for (i, group) in groups.iter().enumerate() {
            for p in 0..P {
                let lane = p * V::LEN;
                let to_own = V::load(group.now[0].as_ptr().add(lane));
                let to_next = V::load(group.hot[FIRST].as_ptr().add(lane));
                let (own, next) = (&mut own[i % 2][p], &mut next[i % 2][p]);
                (*own, *next) = match gains.get(i) {
                    Some(gains) => {
                        let gains = V::load(gains.0.as_ptr().add(lane));
                        (to_own.mul_add(gains, *own), to_next.mul_add(gains, *next))
                    }
                    None => (to_own.add(*own), to_next.add(*next)),
                };
            }
        }
        for (row, [even, odd]) in rows.iter_mut().zip([own, next]) {
            for p in 0..P {
                even[p].add(odd[p]).store(row.0.as_mut_ptr().add(p * V::LEN));
            }
        }
    }
    rows.map(|row| super::vector::sum_row(&row))
}

/// Cuts the groups into sets of nearly equal size, at most `MAX` each: a set that is too small waits
/// for its own results, one that is too large spills its registers.
///
/// # Safety
/// As [`walk`]; `rows` are the chunk's.
#[inline(always)]
unsafe fn sets<V: Vector, const P: usize, const MAX: usize>(
    job: &mut Job<'_>,
    chunk: Chunk,
    rows: &mut [MaybeUninit<Row>],
) {
    let count = job.groups.len();
    let mut from = 0;
    // Gained inputs need registers too.
    let most = if job.feed.shared { MAX } else { MAX.min(3) };
    let mut left = count.div_ceil(most);
    while left > 0 {
        let size = (count - from).div_ceil(left);
        // SAFETY: passed on from the caller; `from + size` is at most the number of groups.
        unsafe {
            match size {
                1 => parts::<V, P, 1>(job, from, chunk, rows),
                2 if MAX >= 2 => parts::<V, P, 2>(job, from, chunk, rows),
                3 if MAX >= 3 => parts::<V, P, 3>(job, from, chunk, rows),
                _ if MAX >= 4 => parts::<V, P, 4>(job, from, chunk, rows),
                _ => {}
            }
        }
        from += size;
        left -= 1;
    }
}

/// Most vectors at once: more have no room for their states beside the sums.
const MOST_VECTORS: usize = 4;

/// Whole groups where there is room for all their vectors; otherwise the first lanes of all, then the next.
///
/// # Safety
/// As [`sets`]; there are `S` groups from `from` on.
#[inline(always)]
unsafe fn parts<V: Vector, const P: usize, const S: usize>(
    job: &mut Job<'_>,
    from: usize,
    chunk: Chunk,
    rows: &mut [MaybeUninit<Row>],
) {
    // SAFETY: passed on from the caller; P · LEN lanes make a group.
    unsafe {
        if P * S <= MOST_VECTORS {
            inputs::<V, P, S>(job, Part { from, lane: 0 }, chunk, rows);
        } else {
            for p in 0..P {
                inputs::<V, 1, S>(job, Part { from, lane: p * V::LEN }, chunk, rows);
            }
        }
    }
}

/// Which group and which lane of it a set begins with.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub from: usize,
    pub lane: usize,
}

/// # Safety
/// As [`parts`]; there are `P` · LEN lanes from `part.lane` on.
#[inline(always)]
unsafe fn inputs<V: Vector, const P: usize, const S: usize>(
    job: &mut Job<'_>,
    part: Part,
    chunk: Chunk,
    rows: &mut [MaybeUninit<Row>],
) {
    // SAFETY: passed on from the caller.
    unsafe {
        match job.feed.inputs.len() {
            _ if job.feed.shared && part.from == 0 => set::<V, P, S, SHARED_FIRST>(job, part, chunk, rows),
            _ if job.feed.shared => set::<V, P, S, SHARED>(job, part, chunk, rows),
            1 => set::<V, P, S, 1>(job, part, chunk, rows),
            2 => set::<V, P, S, 2>(job, part, chunk, rows),
            _ => set::<V, P, S, ANY>(job, part, chunk, rows),
        }
    }
}
