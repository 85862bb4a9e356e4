//! Lattice coordinates of samples in fixed point: 32 bits of index and 32 of fraction.

use crate::gradient_noise_2d::Corners;
use crate::simd::Vector;

/// Adding and subtracting it rounds to a whole number, the same everywhere.
const TO_WHOLE: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
/// Adding it rounds to 2⁻³². The lower half of its own bits is zero.
const TO_FRACTION: f64 = 1_572_864.0; // 1.5 · 2²⁰

/// N positions along one axis in fixed point, cells of the coarsest octave.
#[derive(Clone, Copy)]
pub(super) struct Cells<W> {
    index: W,
    fraction: W,
}

#[inline(always)]
pub(super) fn cells<const N: usize, V: Vector<N>>(v: V, u: V::Double) -> Cells<V::Word> {
    let (to_whole, to_fraction) = (v.splat_double(TO_WHOLE), v.splat_double(TO_FRACTION));
    let whole = v.add_double(u, to_whole);
    let fraction = v.add_double(v.sub_double(u, v.sub_double(whole, to_whole)), to_fraction);
    // A negative fraction borrows from the index.
    let borrow = v
        .add_word(v.high_half(fraction), v.splat_word(((TO_FRACTION.to_bits() >> 32) as u32).wrapping_neg()));
    Cells { index: v.add_word(v.low_half(whole), borrow), fraction: v.low_half(fraction) }
}

impl<W: Copy> Cells<W> {
    /// Places in the cells of octave `i`, from their centres in 2⁻³² cells.
    #[inline(always)]
    pub(super) fn place<const N: usize, V: Vector<N, Word = W>>(&self, v: V, i: u32, offset: Offset) -> W {
        v.add_word(v.left(self.fraction, i), v.splat_word(offset.from_centre))
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
        let from_fraction = v.right(v.right(self.fraction, 1), 31 - i);
        let index = v.or(v.left(self.index, i), from_fraction);
        let index = v.add_word(index, v.splat_word(offset.index));
        // The sum of the fractions has wrapped where it is less than what was added.
        v.add_if_less(index, from_centre, v.splat_word(offset.from_centre))
    }

    /// The last position in 2⁻³² cells.
    #[inline(always)]
    fn last<const N: usize, V: Vector<N, Word = W>>(&self, v: V) -> i64 {
        (u64::from(v.last(self.index)) << 32 | u64::from(v.last(self.fraction))) as i64
    }
}

/// The bounds of some positions on one lattice, in cells of the coarsest octave:
/// [min x, min y, −max x, −max y].
pub(super) type Bounds = [f64; 4];

/// Where an octave's lattice begins, cells.
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
}

/// The cell of an octave that the contact was last in: a slow octave stays in it for many samples, and for many blocks. One number each, which
/// every vector repeats as it loads it: a short block neither lays them out nor gathers them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KnownCell {
    /// Positions within these are in it, however they were rounded.
    bounds: Bounds,
    corners: [[u32; 2]; 4],
}

impl KnownCell {
    /// No cell: nothing is inside.
    pub(super) const NONE: Self = Self { bounds: [f64::INFINITY; 4], corners: [[0; 2]; 4] };

    #[inline(always)]
    pub(super) fn contains<const N: usize, V: Vector<N>>(&self, v: V, bounds: &Bounds) -> bool {
        v.all_reach(bounds, &self.bounds)
    }

    /// The gradients about it.
    #[inline(always)]
    pub(super) fn corners<const N: usize, V: Vector<N>>(&self, v: V) -> Corners<V::Word> {
        Corners::splat(v, &self.corners)
    }

    /// Becomes the cell of octave `i` that the last of some samples is in.
    #[inline(always)]
    pub(super) fn follow<const N: usize, V: Vector<N>>(
        &mut self,
        v: V,
        i: u32,
        position: &[Cells<V::Word>; 2],
        from_centre: [V::Word; 2],
        corners: &Corners<V::Word>,
    ) {
        for axis in 0..2 {
            let place = v.last(from_centre[axis]) ^ (1 << 31);
            let last = position[axis].last(v);
            self.bounds[axis] = inner(last - i64::from(place >> i));
            self.bounds[axis + 2] = inner(-(last + i64::from(!place >> i)));
        }
        self.corners = corners.last(v);
    }
}

/// A lower bound in cells from one in 2⁻³² cells: the next position up that no rounding takes below.
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
}
