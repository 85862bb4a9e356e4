//! One row of a tile slides against itself and against the row below.
//!
//! In this order: straight down, the two diagonals down, and along the row in two halves (cell 0
//! with 1, 2 with 3, …; then 1 with 2, 3 with 4, …), one before the others and one after. Within
//! each of these steps no cell belongs to two pairs, so that the order of the pairs does not matter
//! and any number of them can be worked on at once: vectors, which the compiler makes of the loops,
//! give the same sand as one pair after another.
//!
//! A wall is so low that its difference to any sand, wrapped to 32 bits, is above that of any sand
//! to any other: one comparison shows both that a slope is too steep and that it is one of sand.
use super::TILE;
use crate::sand::grid::{SPAN, SandGrid};
use asperity_dsp::simd::{Level, at_level};

/// Differences of height along an edge and along a diagonal: the one that sand slides to, and the
/// one above which it slides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Steepness {
    pub axis: (i32, i32),
    pub diagonal: (i32, i32),
}

/// First step of a pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Order {
    /// The lowest row, and the diagonal to the left.
    pub upwards: bool,
    /// The pairs that begin with an odd cell.
    odd: usize,
}

/// Result of a row.
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

/// The cells of a row that a tile owns, and one to the right.
type Row = [i32; TILE + 1];

impl Order {
    pub fn of(pass: u32) -> Self {
        Self { upwards: pass & 1 != 0, odd: (pass >> 2 & 1) as usize }
    }
}

/// Lets the tile's row that begins at `at` slide, in the instructions of `level`.
#[inline]
pub(super) fn slide(
    level: Level,
    grid: &mut SandGrid,
    at: usize,
    steepness: &Steepness,
    order: Order,
) -> Moved {
    let stride = grid.stride();
    let nothing = Moved { any: false, below: false, left: false, right: false };
    let Some(cells) = grid.heights.get_mut(at..=at + stride + TILE) else { return nothing };
    let (here, below) = cells.split_at_mut(stride);
    let (Some(here), Some(below)) = (here.first_chunk_mut(), below.first_chunk_mut()) else {
        return nothing;
    };
    at_level!(level.at_most_256_bits(), _s => row(here, below, steepness, order))
}

#[inline(always)]
fn row(here: &mut Row, below: &mut Row, steepness: &Steepness, order: Order) -> Moved {
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

/// Sand that goes from a cell to another.
#[inline(always)]
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

#[inline(always)]
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

#[inline(always)]
fn across(here: &mut Row, below: &mut Row, offsets: [usize; 2], steepness: (i32, i32), moved: &mut Moved) {
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
