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
/// avalanche family), and the multiplier of the finishing step.
const SPREAD_X: u32 = 0x9E37_79B1;
const SPREAD_Y: u32 = 0x85EB_CA77;
const FINISH: u32 = 0x2C1B_3C6D;

/// Sign bits.
const SIGN: u32 = 0x8000_0000;

/// Hash of a corner from what its column and its row contribute. Two random bits per corner at the
/// top; tested in `tests/noise_lattice.rs`.
#[inline(always)]
fn corner(column: u32, row: u32) -> u32 {
    let h = column ^ row;
    (h ^ (h >> 15)).wrapping_mul(FINISH)
}

/// ±x ± y, signs from the hash's top two bits.
#[inline(always)]
fn along(hash: u32, x: f32, y: f32) -> f32 {
    f32::from_bits(x.to_bits() ^ (hash & SIGN)) + f32::from_bits(y.to_bits() ^ ((hash << 1) & SIGN))
}

/// fade(t + ½) − ½ for t in [−½, ½].
#[inline(always)]
fn centred_fade(t: f32) -> f32 {
    let q = t * t;
    t * (1.875 + q * (6.0 * q - 5.0))
}

/// Place in the cell, −½ to ½ about its centre.
#[inline(always)]
fn place(position: u64) -> f32 {
    (((position as u32) ^ SIGN) as i32) as f32 * (1.0 / 4_294_967_296.0)
}

/// The noise at one position; `key` tells lattices apart.
#[inline(always)]
pub fn gradient_noise(x: u64, y: u64, key: u32) -> f32 {
    let (tx, ty) = (place(x), place(y));
    let column = ((x >> 32) as u32).wrapping_mul(SPREAD_X).wrapping_add(key);
    let row = ((y >> 32) as u32).wrapping_mul(SPREAD_Y);
    let (next_column, next_row) = (column.wrapping_add(SPREAD_X), row.wrapping_add(SPREAD_Y));
    let (left, right, top, bottom) = (tx + 0.5, tx - 0.5, ty + 0.5, ty - 0.5);
    let a = along(corner(column, row), left, top);
    let b = along(corner(next_column, row), right, top);
    let c = along(corner(column, next_row), left, bottom);
    let d = along(corner(next_column, next_row), right, bottom);
    let (fx, fy) = (centred_fade(tx) + 0.5, centred_fade(ty) + 0.5);
    let upper = a + fx * (b - a);
    let lower = c + fx * (d - c);
    upper + fy * (lower - upper)
}

/// The noise at N positions.
#[inline(always)]
pub fn gradient_noise_lanes<const N: usize>(x: &Cells<N>, y: &Cells<N>, key: u32) -> [f32; N] {
    let mut out = [0.0; N];
    for n in 0..N {
        out[n] = gradient_noise(x[n], y[n], key);
    }
    out
}
