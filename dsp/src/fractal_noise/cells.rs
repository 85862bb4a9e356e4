//! Lattice coordinates of samples in fixed point: 32 bits of index and 32 of fraction.

use super::Octave;
use crate::gradient_noise_2d::{Cell, cell_corners};
use crate::simd::{Vector, Word};

/// Adding and subtracting it rounds to a whole number, the same everywhere.
const TO_WHOLE: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
/// Adding it rounds to 2⁻³². The lower half of its own bits is zero.
const TO_FRACTION: f64 = 1_572_864.0; // 1.5 · 2²⁰
/// Addend for the upper half of such a sum that leaves the whole number that was rounded down.
const FROM_HIGH: u32 = ((TO_FRACTION.to_bits() >> 32) as u32).wrapping_neg();

/// Positions up to here, cells of the coarsest octave, become fixed point by one addition,
/// whichever way their lattice is turned.
pub(super) const NEAR: f64 = 360_000.0; // less than 2¹⁹ / √2

/// N positions along one axis in fixed point, cells of the coarsest octave.
#[derive(Clone, Copy)]
pub(super) struct Cells<W> {
    index: W,
    fraction: W,
}

/// Anywhere.
#[inline(always)]
pub(super) fn cells<const N: usize, V: Vector<N>>(v: V, u: V::Double) -> Cells<V::Word> {
    let (to_whole, to_fraction) = (v.splat_double(TO_WHOLE), v.splat_double(TO_FRACTION));
    let whole = v.add_double(u, to_whole);
    let fraction = v.add_double(v.sub_double(u, v.sub_double(whole, to_whole)), to_fraction);
    // A negative fraction borrows from the index.
    let borrow = v.high_half(fraction) + v.splat_word(FROM_HIGH);
    Cells { index: v.low_half(whole) + borrow, fraction: v.low_half(fraction) }
}

/// Sum within ± 2¹⁹: both halves of one.
#[inline(always)]
pub(super) fn near_cells<const N: usize, V: Vector<N>>(v: V, u: V::Double) -> Cells<V::Word> {
    let sum = v.add_double(u, v.splat_double(TO_FRACTION));
    Cells { index: v.high_half(sum) + v.splat_word(FROM_HIGH), fraction: v.low_half(sum) }
}

impl<W: Word> Cells<W> {
    /// Sums on both counts.
    pub(super) fn at(place: W) -> Self {
        Self { index: place, fraction: place }
    }

    /// Places in the cells of octave `i`, from their centres in 2⁻³² cells.
    #[inline(always)]
    pub(super) fn place<const N: usize, V: Vector<N, Word = W>>(&self, v: V, i: u32, offset: Offset) -> W {
        (self.fraction << i) + v.splat_word(offset.from_centre)
    }

    /// Indices of the cells, given those places.
    #[inline(always)]
    pub(super) fn index<const N: usize, V: Vector<N, Word = W>>(
        &self,
        v: V,
        i: u32,
        offset: Offset,
        from_centre: W,
    ) -> W {
        let from_fraction = (self.fraction >> 1) >> (31 - i);
        let index = (self.index << i) | from_fraction;
        let index = index + v.splat_word(offset.index);
        // The sum of the fractions has wrapped where it is less than what was added.
        v.add_if_less(index, from_centre, v.splat_word(offset.from_centre))
    }

    /// The last position in 2⁻³² cells.
    #[inline(always)]
    pub(super) fn last<const N: usize, V: Vector<N, Word = W>>(&self, v: V) -> i64 {
        (u64::from(v.last(self.index)) << 32 | u64::from(v.last(self.fraction))) as i64
    }
}

/// The bounds of some positions on one lattice, in cells of the coarsest octave:
/// [min x, min y, −max x, −max y].
pub(super) type Bounds = [f64; 4];

/// Origin of an octave's lattice, cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Offset {
    index: u32,
    /// The fraction, less ½.
    from_centre: u32,
}

impl Offset {
    pub(super) fn new(fixed_point: u64) -> Self {
        Self { index: (fixed_point >> 32) as u32, from_centre: fixed_point as u32 ^ (1 << 31) }
    }

    fn fixed_point(self) -> u64 {
        u64::from(self.index) << 32 | u64::from(self.from_centre ^ (1 << 31))
    }
}

/// The cell of an octave that the contact was last in: a slow octave stays in it for many samples,
/// and for many blocks. One number each, which every vector repeats as it loads it: a short block
/// neither lays them out nor gathers them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KnownCell {
    /// Positions within these are in it, however they were rounded.
    bounds: Bounds,
    pub(super) corners: Cell,
}

impl KnownCell {
    /// No cell: nothing is inside.
    pub(super) const NONE: Self = Self { bounds: [f64::INFINITY; 4], corners: [[0; 2]; 4] };

    #[inline(always)]
    pub(super) fn contains<const N: usize, V: Vector<N>>(&self, v: V, bounds: &Bounds) -> bool {
        v.all_reach(bounds, &self.bounds)
    }

    /// Becomes the cell of an octave that a position in 2⁻³² cells of the coarsest one is in.
    /// Tests whether positions within these bounds are in it, by plain numbers: no vector has to
    /// wait until they are stored.
    #[cold]
    pub(super) fn follow(&mut self, octave: &Octave, position: [i64; 2], within: &Bounds) -> bool {
        let Octave { offset, key, index: i, .. } = *octave;
        let mut cell = [0; 2];
        for axis in 0..2 {
            let last = position[axis];
            let there = ((last as u64) << i).wrapping_add(offset[axis].fixed_point());
            let place = there as u32;
            cell[axis] = (there >> 32) as u32;
            self.bounds[axis] = inner(last - i64::from(place >> i));
            self.bounds[axis + 2] = inner(-(last + i64::from(!place >> i)));
        }
        self.corners = cell_corners(cell[0], cell[1], key);
        within.iter().zip(&self.bounds).all(|(within, bound)| within >= bound)
    }
}

/// A lower bound in cells from one in 2⁻³² cells: the next position up that no rounding takes
/// below.
#[inline(always)]
fn inner(bound: i64) -> f64 {
    let cells = (bound + 1) as f64 * (1.0 / 4_294_967_296.0);
    cells + cells.abs() * f64::EPSILON
}

#[cfg(test)]
mod tests {
    use super::super::LONGEST_CELL_M;
    use super::*;
    use crate::simd::{BASE, Eight};

    #[test]
    fn fixed_point_keeps_every_place_to_four_picometres() {
        for u in [0.0, 0.25, -0.25, 1.0 / 3.0, -123_456.789, 8.5e6, -8.5e6 + 0.1] {
            let lanes = Eight(BASE);
            let fixed = cells(lanes, lanes.splat_double(u)).last(lanes);
            assert!((fixed as f64 / 4_294_967_296.0 - u).abs() * LONGEST_CELL_M < 4e-12, "{u}: {fixed}");
        }
    }

    #[test]
    fn near_positions_become_the_fixed_point_that_any_position_does() {
        let lanes = Eight(BASE);
        let same = |u: f64| {
            let u = lanes.splat_double(u);
            assert_eq!(near_cells(lanes, u).last(lanes), cells(lanes, u).last(lanes), "{u:?}");
        };
        let mut rng = crate::rng::Rng::new(5);
        let edge = 524_288.0 - 1.0;
        for u in [
            0.0,
            -0.0,
            0.5,
            -0.5,
            1.5,
            1.0 - 1e-11,
            -1e-11,
            1e-300,
            -1e-300,
            edge,
            -edge,
            1.0 + 0.5f64.powi(33),
        ] {
            same(u);
        }
        for _ in 0..20_000 {
            let scale = libm::exp2(-30.0 + 49.0 * rng.uniform());
            // Halves of the last place too, where rounding has to choose.
            let u = scale * (2.0 * rng.uniform() - 1.0);
            same(u);
            same(libm::rint(u * 4_294_967_296.0 * 2.0) / (4_294_967_296.0 * 2.0));
        }
    }
}
