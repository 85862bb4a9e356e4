//! One row of a tile slides against itself and against the row below.
//!
//! In this order: straight down, the two diagonals down, and along the row in two halves (cell 0 with 1,
//! 2 with 3, …; then 1 with 2, 3 with 4, …), one before the others and one after. Within each of these
//! steps no cell belongs to two pairs, so that the order of the pairs does not matter and any number of
//! them can be worked on at once: the vectors of AVX2 give the same sand as one pair after another.
//!
//! A wall is so low that its difference to any sand, wrapped to 32 bits, is above that of any sand to
//! any other: one comparison tells both that a slope is too steep and that it is one of sand.
#![allow(unsafe_code)]

use super::TILE;
use crate::sand::grid::{SPAN, SandGrid};

/// Differences of height along an edge and along a diagonal: the one that sand slides to, and the one
/// above which it slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Steepness {
    pub axis: (i32, i32),
    pub diagonal: (i32, i32),
}

/// What comes first in a pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Order {
    /// The lowest row, and the diagonal to the left.
    pub upwards: bool,
    /// The pairs that begin with an odd cell.
    odd: usize,
}

/// What a row did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Moved {
    /// Anything moved.
    pub any: bool,
    /// Sand moved to or from the row below.
    pub below: bool,
    /// A cell at the tile's left border moved, one at its right border or beyond.
    pub left: bool,
    pub right: bool,
}

/// Which instructions work on a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rows {
    /// Any processor.
    Portable,
    /// Eight pairs at once.
    #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
    Avx2,
}

/// The cells of a row that a tile owns, and one to the right.
type Row = [i32; TILE + 1];

impl Order {
    pub fn of(pass: u32) -> Self {
        Self { upwards: pass & 1 != 0, odd: (pass >> 2 & 1) as usize }
    }
}

impl Rows {
    pub fn detect() -> Self {
        #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
        if std::arch::is_x86_feature_detected!("avx2") {
            return Self::Avx2;
        }
        Self::Portable
    }

    /// Lets the tile's row that begins at `at` slide.
    #[inline]
    pub fn slide(self, grid: &mut SandGrid, at: usize, steepness: &Steepness, order: Order) -> Moved {
        let stride = grid.stride();
        let nothing = Moved { any: false, below: false, left: false, right: false };
        let Some(cells) = grid.heights.get_mut(at..=at + stride + TILE) else { return nothing };
        let (here, below) = cells.split_at_mut(stride);
        let (Some(here), Some(below)) = (here.first_chunk_mut(), below.first_chunk_mut()) else {
            return nothing;
        };
        match self {
            Self::Portable => portable::row(here, below, steepness, order),
            #[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
            // SAFETY: `Avx2` is chosen only where the processor was found to have it.
            Self::Avx2 => unsafe { avx2::row(here, below, steepness, order) },
        }
    }
}

mod portable {
    use super::{Moved, Order, Row, SPAN, Steepness, TILE};

    pub(super) fn row(here: &mut Row, below: &mut Row, steepness: &Steepness, order: Order) -> Moved {
        let mut moved = Moved { any: false, below: false, left: false, right: false };
        along(here, steepness.axis, order.odd, &mut moved);
        across(here, below, [0, 0], steepness.axis, &mut moved);
        let diagonals = if order.upwards { [[1, 0], [0, 1]] } else { [[0, 1], [1, 0]] };
        for offsets in diagonals {
            across(here, below, offsets, steepness.diagonal, &mut moved);
        }
        along(here, steepness.axis, 1 - order.odd, &mut moved);
        moved
    }

    /// What goes from a cell to another.
    #[inline]
    fn given(from: i32, to: i32, (limit, steep): (i32, i32)) -> i32 {
        let difference = from.wrapping_sub(to);
        let size = difference.unsigned_abs();
        if size > steep.unsigned_abs() && size < SPAN {
            let half = ((size - limit.unsigned_abs()) >> 1) as i32;
            if difference < 0 { -half } else { half }
        } else {
            0
        }
    }

    fn along(row: &mut Row, steepness: (i32, i32), odd: usize, moved: &mut Moved) {
        let (pairs, _) = row[odd..].as_chunks_mut::<2>();
        let mut all = 0;
        let mut part = [0; TILE / 2];
        for (pair, part) in pairs.iter_mut().zip(&mut part) {
            *part = given(pair[0], pair[1], steepness);
            pair[0] -= *part;
            pair[1] += *part;
            all |= *part;
        }
        moved.any |= all != 0;
        moved.left |= odd == 0 && part[0] != 0;
        moved.right |= odd == 1 && part[TILE / 2 - 1] != 0;
    }

    fn across(
        here: &mut Row,
        below: &mut Row,
        offsets: [usize; 2],
        steepness: (i32, i32),
        moved: &mut Moved,
    ) {
        let (upper, lower) = (&mut here[offsets[0]..][..TILE], &mut below[offsets[1]..][..TILE]);
        let mut part = [0; TILE];
        for ((upper, lower), part) in upper.iter_mut().zip(lower).zip(&mut part) {
            *part = given(*upper, *lower, steepness);
            *upper -= *part;
            *lower += *part;
        }
        let all = part.iter().fold(0, |all, p| all | p) != 0;
        moved.any |= all;
        moved.below |= all;
        moved.left |= part[0] != 0;
        moved.right |= offsets != [0, 0] && part[TILE - 1] != 0;
    }
}

#[cfg(any(target_arch = "x86_64", target_arch = "x86"))]
mod avx2 {
    use super::{Moved, Order, Row, SPAN, Steepness, TILE};
    #[cfg(target_arch = "x86")]
    use core::arch::x86::*;
    #[cfg(target_arch = "x86_64")]
    use core::arch::x86_64::*;

    const LANES: usize = 8;

    /// One [`Steepness`] in registers.
    #[derive(Clone, Copy)]
    struct Limits {
        limit: __m256i,
        /// Brings the range above `steep` and below [`SPAN`] to the lowest signed numbers.
        shift: __m256i,
        end: __m256i,
    }

    /// Everything given, by where it was given.
    struct Given {
        along: __m256i,
        across: __m256i,
        first: __m256i,
        last: __m256i,
    }

    #[target_feature(enable = "avx2")]
    pub(super) fn row(here: &mut Row, below: &mut Row, steepness: &Steepness, order: Order) -> Moved {
        let (axis, diagonal) = (limits(steepness.axis), limits(steepness.diagonal));
        let none = _mm256_setzero_si256();
        let mut given = Given { along: none, across: none, first: none, last: none };
        along(here, axis, order.odd, &mut given);
        across(here, below, [0, 0], axis, &mut given);
        let diagonals = if order.upwards { [[1, 0], [0, 1]] } else { [[0, 1], [1, 0]] };
        for offsets in diagonals {
            across(here, below, offsets, diagonal, &mut given);
        }
        along(here, axis, 1 - order.odd, &mut given);
        let below = lanes(given.across) != 0;
        Moved {
            any: below || lanes(given.along) != 0,
            below,
            left: lanes(given.first) & 1 != 0,
            right: lanes(given.last) >> (LANES - 1) != 0,
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn limits((limit, steep): (i32, i32)) -> Limits {
        let shift = i32::MIN.wrapping_sub(steep).wrapping_sub(1);
        Limits {
            limit: _mm256_set1_epi32(limit),
            shift: _mm256_set1_epi32(shift),
            end: _mm256_set1_epi32((SPAN as i32).wrapping_add(shift)),
        }
    }

    /// As the portable function of this name.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn given(from: __m256i, to: __m256i, limits: Limits) -> __m256i {
        let difference = _mm256_sub_epi32(from, to);
        let size = _mm256_abs_epi32(difference);
        let slides = _mm256_cmpgt_epi32(limits.end, _mm256_add_epi32(size, limits.shift));
        let half = _mm256_srli_epi32::<1>(_mm256_sub_epi32(size, limits.limit));
        _mm256_sign_epi32(_mm256_and_si256(half, slides), difference)
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn along(row: &mut Row, limits: Limits, odd: usize, given_to: &mut Given) {
        let (vectors, _) = row[odd..].as_chunks_mut::<LANES>();
        for (i, vector) in vectors.iter_mut().enumerate() {
            let heights = load(vector);
            let part = given(heights, _mm256_shuffle_epi32::<0b10_11_00_01>(heights), limits);
            store(vector, _mm256_sub_epi32(heights, part));
            given_to.along = _mm256_or_si256(given_to.along, part);
            if i == 0 && odd == 0 {
                given_to.first = _mm256_or_si256(given_to.first, part);
            }
            if i == TILE / LANES - 1 && odd == 1 {
                given_to.last = _mm256_or_si256(given_to.last, part);
            }
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn across(here: &mut Row, below: &mut Row, offsets: [usize; 2], limits: Limits, given_to: &mut Given) {
        let (upper, _) = here[offsets[0]..].as_chunks_mut::<LANES>();
        let (lower, _) = below[offsets[1]..].as_chunks_mut::<LANES>();
        for (i, (upper, lower)) in upper.iter_mut().zip(lower).enumerate() {
            let (from, to) = (load(upper), load(lower));
            let part = given(from, to, limits);
            store(upper, _mm256_sub_epi32(from, part));
            store(lower, _mm256_add_epi32(to, part));
            given_to.across = _mm256_or_si256(given_to.across, part);
            if i == 0 {
                given_to.first = _mm256_or_si256(given_to.first, part);
            }
            if i == TILE / LANES - 1 && offsets != [0, 0] {
                given_to.last = _mm256_or_si256(given_to.last, part);
            }
        }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn load(from: &[i32; LANES]) -> __m256i {
        // SAFETY: the array holds the 32 bytes that are read; no alignment is needed.
        unsafe { _mm256_loadu_si256(from.as_ptr().cast()) }
    }

    #[inline]
    #[target_feature(enable = "avx2")]
    fn store(to: &mut [i32; LANES], heights: __m256i) {
        // SAFETY: the array holds the 32 bytes that are written; no alignment is needed.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), heights) }
    }

    /// Lanes that are not zero, one bit a lane.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn lanes(vector: __m256i) -> i32 {
        let zero = _mm256_cmpeq_epi32(vector, _mm256_setzero_si256());
        !_mm256_movemask_ps(_mm256_castsi256_ps(zero)) & 0xFF
    }
}
