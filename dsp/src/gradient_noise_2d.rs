//! One octave of two-dimensional gradient noise, on many samples at once.
//!
//! ```text
//! n(x, y) = Σ over the 4 corners of the cell   (g · d) · w(d_x) · w(d_y)
//! w(d)    = 1 − fade(|d|)      fade(t) = 6t⁵ − 15t⁴ + 10t³     d: from the corner, cells
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | x, y | [`Cells`]: fixed point, 32 bits of fraction and 32 of cell index, wrapping |
//! | g | a diagonal (±1, ±1) from two bits of the corner's hash |
//!
//! Source: K. Perlin, "Improving Noise", SIGGRAPH 2002 (quintic fade). What we changed: gradients are
//! the four diagonals, picked by flipping sign bits. The power spectrum depends on their covariance
//! alone, which is that of uniform directions of length √2, so nothing is lost but a multiplication.
//!
//! Coordinates are fixed point because it is exact: octaves are shifts of one number, the cell and the
//! place in it never disagree, and there is no far-away where precision runs out. Everything else is
//! `f32` additions and multiplications in one written order, never fused, so that every instruction
//! set gives the same bits. The variance is [`VARIANCE`] and the spectrum peaks at
//! [`PEAK_WAVELENGTH_CELLS`] (both computed from the equation, `tests/independent/noise_spectrum.py`).

/// Mean square of the noise.
pub const VARIANCE: f64 = 0.092_94;

/// Wavelength at which a straight cut through the noise has most power per octave, cells.
pub const PEAK_WAVELENGTH_CELLS: f64 = 1.92;

/// Positions along one axis, in cells: the index in the upper 32 bits, the fraction in the lower.
pub type Cells<const N: usize> = [u64; N];

/// Odd constants that spread neighbouring cell indices over 32 bits (2³²/φ and a prime of xxHash's
/// avalanche family), and the multipliers of the finishing step (C. Wellons, "hash-prospector").
const SPREAD_X: u32 = 0x9E37_79B1;
const SPREAD_Y: u32 = 0x85EB_CA77;
const FINISH_X: u32 = 0x2C1B_3C6D;
const FINISH_Y: u32 = 0x297A_2D39;

/// Sign bits.
const SIGN: u32 = 0x8000_0000;

/// Hash of a corner from what its column and its row contribute.
#[inline(always)]
fn corner(column: u32, row: u32) -> u32 {
    let h = column ^ row;
    h ^ (h >> 15)
}

/// ±x ± y, signs from the top bits of two products of the hash.
#[inline(always)]
fn along(hash: u32, x: f32, y: f32) -> f32 {
    let (a, b) = (hash.wrapping_mul(FINISH_X), hash.wrapping_mul(FINISH_Y));
    f32::from_bits(x.to_bits() ^ (a & SIGN)) + f32::from_bits(y.to_bits() ^ (b & SIGN))
}

/// fade(t + ½) for t in [−½, ½].
#[inline(always)]
fn centred_fade(t: f32) -> f32 {
    let q = t * t;
    0.5 + t * (1.875 + q * (6.0 * q - 5.0))
}

/// Place in the cell, −½ to ½ about its centre, from the fraction's 32 bits.
#[inline(always)]
fn place(fraction: u32) -> f32 {
    ((fraction ^ SIGN) as i32) as f32 * (1.0 / 4_294_967_296.0)
}

/// The noise at N positions; `key` tells lattices apart.
#[inline(always)]
pub fn gradient_noise<const N: usize>(x: &Cells<N>, y: &Cells<N>, key: u32) -> [f32; N] {
    // 64-bit work apart from 32-bit work, so that each fills its vectors.
    let (mut column, mut row, mut u, mut v) = ([0; N], [0; N], [0; N], [0; N]);
    for n in 0..N {
        (column[n], u[n]) = ((x[n] >> 32) as u32, x[n] as u32);
        (row[n], v[n]) = ((y[n] >> 32) as u32, y[n] as u32);
    }
    let mut out = [0.0; N];
    for n in 0..N {
        out[n] = in_cell(column[n], row[n], place(u[n]), place(v[n]), key);
    }
    out
}

/// The noise at a place of the cell in a column and a row.
#[inline(always)]
fn in_cell(column: u32, row: u32, x: f32, y: f32, key: u32) -> f32 {
    let column = column.wrapping_mul(SPREAD_X).wrapping_add(key);
    let row = row.wrapping_mul(SPREAD_Y);
    let (next_column, next_row) = (column.wrapping_add(SPREAD_X), row.wrapping_add(SPREAD_Y));
    let (left, right, top, bottom) = (x + 0.5, x - 0.5, y + 0.5, y - 0.5);
    let a = along(corner(column, row), left, top);
    let b = along(corner(next_column, row), right, top);
    let c = along(corner(column, next_row), left, bottom);
    let d = along(corner(next_column, next_row), right, bottom);
    let (fx, fy) = (centred_fade(x), centred_fade(y));
    let upper = a + fx * (b - a);
    let lower = c + fx * (d - c);
    upper + fy * (lower - upper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn at(x: f64, y: f64, key: u32) -> f64 {
        let cells = |t: f64| (t * 4_294_967_296.0) as i64 as u64;
        f64::from(gradient_noise::<1>(&[cells(x)], &[cells(y)], key)[0])
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
    fn its_variance_is_the_one_of_the_equation_and_its_mean_is_zero() {
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

    /// Signs of 128 × 128 corners against each other at every small distance: 5 sigma of chance.
    #[test]
    fn neighbouring_gradients_are_unrelated() {
        const N: usize = 128;
        for key in [1, 0x1234_5678, 0x8000_0000] {
            let sign = |x: usize, y: usize, finish: u32| {
                let column = (x as u32).wrapping_mul(SPREAD_X).wrapping_add(key);
                let h = corner(column, (y as u32).wrapping_mul(SPREAD_Y)).wrapping_mul(finish);
                1 - 2 * (h >> 31) as i32
            };
            let field = |finish| -> Vec<i32> { (0..N * N).map(|i| sign(i % N, i / N, finish)).collect() };
            let (a, b) = (field(FINISH_X), field(FINISH_Y));
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
