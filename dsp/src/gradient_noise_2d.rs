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
