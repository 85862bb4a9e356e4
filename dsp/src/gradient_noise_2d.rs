//! One octave of two-dimensional gradient noise, on many samples at once.
//!
//! ```text
//! n(x, y) = Σ over the 4 corners of the cell   (g · d) · w(d_x) · w(d_y)
//! w(d)    = 1 − fade(|d|)      fade(t) = 6t⁵ − 15t⁴ + 10t³     d: from the corner, cells
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | x, y | fixed point, 32 bits of fraction and 32 of cell index, wrapping |
//! | g | a diagonal (±1, ±1) from two bits of the corner's hash |
//!
//! Source: K. Perlin, "Improving Noise", SIGGRAPH 2002 (quintic fade). What we changed: gradients
//! are the four diagonals, picked by flipping sign bits. The power spectrum depends on their
//! covariance alone, which is that of uniform directions of length √2, so nothing is lost but a
//! multiplication.
//!
//! Coordinates are fixed point because it is exact: octaves are shifts of one number, the cell and
//! the place in it never disagree, and there is no far-away where precision runs out. Everything
//! else is `f32` additions and multiplications in one written order, never fused, so that every
//! instruction set gives the same bits. The variance is [`VARIANCE`] and the spectrum peaks at
//! [`PEAK_WAVELENGTH_CELLS`] (both computed from the equation,
//! `tests/independent/noise_spectrum.py`).

use crate::simd::{Single, Vector};

/// Mean square of the noise.
pub const VARIANCE: f64 = 0.092_94;

/// Wavelength at which a straight cut through the noise has most power per octave, cells.
pub const PEAK_WAVELENGTH_CELLS: f64 = 1.92;

/// Odd constants that spread neighbouring cell indices over 32 bits (2³²/φ and a prime of xxHash's
/// avalanche family), and the multipliers of the finishing step (C. Wellons, "hash-prospector").
const SPREAD_X: u32 = 0x9E37_79B1;
const SPREAD_Y: u32 = 0x85EB_CA77;
const FINISH_X: u32 = 0x2C1B_3C6D;
const FINISH_Y: u32 = 0x297A_2D39;

/// Sign bits.
const SIGN: u32 = 0x8000_0000;

/// The sign bits of the two components of a gradient.
type Gradient<W> = [W; 2];

/// The gradients at the four corners of a cell: upper left, upper right, lower left, lower right.
pub(crate) type Cell = [[u32; 2]; 4];

/// The noise at N places in cells of N columns and rows; `key` tells lattices apart. Places are
/// measured from the centre of the cell, in 2⁻³² cells, signed.
#[inline(always)]
pub(crate) fn gradient_noise<const N: usize, V: Vector<N>>(
    v: V,
    [column, row]: [V::Word; 2],
    key: u32,
    from_centre: [V::Word; 2],
) -> V::Single {
    let place = Place::new(v, from_centre);
    let (spread_x, spread_y) = (v.splat_word(SPREAD_X), v.splat_word(SPREAD_Y));
    let column = column * spread_x + v.splat_word(key);
    let row = row * spread_y;
    let next_column = column + spread_x;
    let a = along(v, gradient(v, column, row), place.left, place.top);
    let b = along(v, gradient(v, next_column, row), place.right, place.top);
    let row = row + spread_y;
    let c = along(v, gradient(v, column, row), place.left, place.bottom);
    let d = along(v, gradient(v, next_column, row), place.right, place.bottom);
    place.between(v, [a, b, c, d])
}

/// Noise where all places are in one cell.
#[inline(always)]
pub(crate) fn gradient_noise_in<const N: usize, V: Vector<N>>(
    v: V,
    cell: &Cell,
    from_centre: [V::Word; 2],
) -> V::Single {
    let place = Place::new(v, from_centre);
    let [a, b, c, d] = cell;
    let a = along(v, [v.splat_word(a[0]), v.splat_word(a[1])], place.left, place.top);
    let b = along(v, [v.splat_word(b[0]), v.splat_word(b[1])], place.right, place.top);
    let c = along(v, [v.splat_word(c[0]), v.splat_word(c[1])], place.left, place.bottom);
    let d = along(v, [v.splat_word(d[0]), v.splat_word(d[1])], place.right, place.bottom);
    place.between(v, [a, b, c, d])
}

/// The gradients of one cell: those that [`gradient_noise`] finds in each lane.
pub(crate) fn cell_corners(column: u32, row: u32, key: u32) -> Cell {
    let column = column.wrapping_mul(SPREAD_X).wrapping_add(key);
    let row = row.wrapping_mul(SPREAD_Y);
    let (next_column, next_row) = (column.wrapping_add(SPREAD_X), row.wrapping_add(SPREAD_Y));
    [(column, row), (next_column, row), (column, next_row), (next_column, next_row)].map(|(column, row)| {
        let h = column ^ row;
        let h = h ^ (h >> 15);
        [h.wrapping_mul(FINISH_X) & SIGN, h.wrapping_mul(FINISH_Y) & SIGN]
    })
}

/// Places in their cells.
struct Place<F> {
    x: F,
    y: F,
    /// From the corners.
    left: F,
    right: F,
    top: F,
    bottom: F,
}

impl<F: Single> Place<F> {
    #[inline(always)]
    fn new<const N: usize, V: Vector<N, Single = F>>(v: V, from_centre: [V::Word; 2]) -> Self {
        let (half, cell) = (v.splat(0.5), v.splat(1.0 / 4_294_967_296.0));
        let x = v.signed_to_single(from_centre[0]) * cell;
        let y = v.signed_to_single(from_centre[1]) * cell;
        Self { x, y, left: x + half, right: x - half, top: y + half, bottom: y - half }
    }

    /// Values of the corners, faded into each other.
    #[inline(always)]
    fn between<const N: usize, V: Vector<N, Single = F>>(&self, v: V, [a, b, c, d]: [F; 4]) -> F {
        let (fx, fy) = (centred_fade(v, self.x), centred_fade(v, self.y));
        let between = |a, b, f| a + f * (b - a);
        between(between(a, b, fx), between(c, d, fx), fy)
    }
}

/// The gradient of a corner from what its column and its row contribute: the top bits of two
/// products of their hash.
#[inline(always)]
fn gradient<const N: usize, V: Vector<N>>(v: V, column: V::Word, row: V::Word) -> Gradient<V::Word> {
    let h = column ^ row;
    let h = h ^ (h >> 15);
    let (a, b) = (h * v.splat_word(FINISH_X), h * v.splat_word(FINISH_Y));
    [a & v.splat_word(SIGN), b & v.splat_word(SIGN)]
}

/// g · d
#[inline(always)]
fn along<const N: usize, V: Vector<N>>(
    v: V,
    gradient: Gradient<V::Word>,
    x: V::Single,
    y: V::Single,
) -> V::Single {
    v.flip(x, gradient[0]) + v.flip(y, gradient[1])
}

/// fade(t + ½) for t in [−½, ½].
#[inline(always)]
fn centred_fade<const N: usize, V: Vector<N>>(v: V, t: V::Single) -> V::Single {
    let q = t * t;
    let slope = v.splat(6.0) * q - v.splat(5.0);
    v.splat(0.5) + t * (v.splat(1.875) + q * slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{BASE, Base, Eight};
    use std::vec::Vec;

    const LANES: Eight<Base> = Eight(BASE);

    fn at(x: f64, y: f64, key: u32) -> f64 {
        let [x, y] = [x, y].map(|t| (t * 4_294_967_296.0) as i64 as u64);
        let cell = [x, y].map(|t| LANES.splat_word((t >> 32) as u32));
        f64::from(gradient_noise(LANES, cell, key, [x, y].map(|t| LANES.splat_word(t as u32 ^ SIGN)))[0])
    }

    #[test]
    fn the_noise_vanishes_on_its_lattice_points() {
        for (x, y) in [(0.0, 0.0), (3.0, -7.0), (-1e6, 5.0)] {
            assert_eq!(at(x, y, 9), 0.0);
        }
    }

    #[test]
    fn height_and_slope_are_continuous_across_cells() {
        for y in [0.1, 0.5, 0.93] {
            let d = 1e-3;
            let (before, after) = (at(4.0 - d, y, 2), at(4.0 + d, y, 2));
            let (slope_before, slope_after) =
                (before - at(4.0 - 2.0 * d, y, 2), at(4.0 + 2.0 * d, y, 2) - after);
            assert!((after - before).abs() < 4.0 * d);
            assert!((slope_after - slope_before).abs() < 0.02 * d, "{slope_before} {slope_after}");
        }
    }

    #[test]
    fn variance_is_that_of_the_equation_and_mean_is_zero() {
        let (mut mean, mut square, mut count) = (0.0, 0.0, 0.0);
        for n in 0..200_000 {
            let value = at(f64::from(n) * 0.737, f64::from(n % 1013) * 1.371, 77);
            mean += value;
            square += value * value;
            count += 1.0;
        }
        assert!((mean / count).abs() < 2e-3, "{}", mean / count);
        assert!((square / count / VARIANCE - 1.0).abs() < 0.02, "{}", square / count);
    }

    #[test]
    fn a_known_cell_says_at_every_place_what_a_hashed_one_says() {
        let mut rng = crate::rng::Rng::new(3);
        for _ in 0..1000 {
            let [column, row, key] = [0; 3].map(|_| rng.next_u32());
            let from_centre = [0; 2].map(|_| LANES.splat_word(rng.next_u32()));
            let known = gradient_noise_in(LANES, &cell_corners(column, row, key), from_centre)[0];
            let cell = [column, row].map(|cell| LANES.splat_word(cell));
            assert_eq!(known, gradient_noise(LANES, cell, key, from_centre)[0], "{column}, {row}, {key}");
        }
    }

    /// Signs of 128 × 128 corners against each other at every small distance: 5 sigma of chance.
    #[test]
    fn neighbouring_gradients_are_unrelated() {
        const N: usize = 128;
        for key in [1, 0x1234_5678, 0x8000_0000] {
            let sign = |x: usize, y: usize, axis: usize| {
                1 - 2 * (cell_corners(x as u32, y as u32, key)[0][axis] >> 31) as i32
            };
            let field = |axis| -> Vec<i32> { (0..N * N).map(|i| sign(i % N, i / N, axis)).collect() };
            let (a, b) = (field(0), field(1));
            for (dx, dy) in (0..6).flat_map(|dx| (0..6).map(move |dy| (dx, dy))) {
                for (from, to) in [(&a, &a), (&b, &b), (&a, &b)] {
                    if dx == 0 && dy == 0 && core::ptr::eq(from, to) {
                        continue;
                    }
                    let pairs = (0..N - dy).flat_map(|y| (0..N - dx).map(move |x| (x, y)));
                    let sum: i32 = pairs.map(|(x, y)| from[y * N + x] * to[(y + dy) * N + x + dx]).sum();
                    let chance = ((N - dx) * (N - dy)) as f64;
                    assert!(
                        f64::from(sum).abs() < 5.0 * libm::sqrt(chance),
                        "key {key}, ({dx}, {dy}): {sum}"
                    );
                }
            }
        }
    }
}
