//! Heights from slopes: the surface whose derivatives are nearest to a given field, in the mean
//! square.
//!
//! ```text
//! Z(k) = (D_x* P + D_y* Q) / (|D_x|² + |D_y|²)        Z(0) = 0
//! ```
//! | symbol | here |
//! |---|---|
//! | P, Q | spectra of the slopes along u and v, height per texel |
//! | D_x, D_y | the derivative that made them, [`Derivative`] |
//!
//! Source: R. T. Frankot and R. Chellappa, "A method for enforcing integrability in shape from
//! shading algorithms", IEEE PAMI 10, 1988. Changed: the paper divides by i ω; slopes that somebody
//! computed by differences of texels are put together by the same differences. Which ones they were
//! can be read from the slopes ([`SlopeSpectrum::possible_derivatives`]): only with the right ones
//! is D_y P = D_x Q. Slopes that have a noise are put together by `tiling`.
//!
//! A field that does not tile is not taken to repeat but to go on mirrored ([`integrate_open`]).

mod bands;
mod blind;
mod border_share;
mod differences;
mod mirror_transform;
mod noise;
mod open;
mod periodic;
mod spectrum;
mod steps;
#[cfg(test)]
mod tests;
mod tiling;
mod turning;
mod walls;
mod wiener;

pub use differences::differences;
pub use open::{integrate_open, integrate_open_rounded};
pub use periodic::{Projection, integrate_periodic, slopes};
pub use spectrum::SlopeSpectrum;
pub use turning::curl;
pub use walls::Walls;

use crate::fft2::angular_frequency;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// Operator that took slopes from heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivative {
    /// The true derivative, as normals baked from geometry are.
    Exact,
    /// Half the difference of the neighbours on both sides.
    Central,
    /// Central difference averaged across with weights ¼, ½, ¼, as many height-to-normal converters
    /// have it.
    Sobel,
    /// Half way between [`Derivative::Exact`] and [`Derivative::Central`]: for slopes that either
    /// may have made. With D_x the smaller of two symbols and D_x' the larger, (D_x' − D_x)/(D_x' +
    /// D_x) is the least relative error of a wave's height that can be had in the worse case. Waves
    /// shorter than six texels, which central differences hardly see, are not raised above 1.1
    /// times what they are if true slopes made them, a fifth more power.
    ExactOrCentral,
}

/// Every [`Derivative`] that makes slopes.
pub const DERIVATIVES: [Derivative; 3] = [Derivative::Exact, Derivative::Central, Derivative::Sobel];

/// |D|² below which a frequency in the upper half of the spectrum is left at zero: a difference that
/// does not see a wave (neighbours two apart are equal) cannot tell its height.
const BLIND: f64 = 0.004;
/// Limit for [`Derivative::Sobel`], which is nearly blind to many more.
const SOBEL_BLIND: f64 = 0.01;
/// By how much [`Derivative::ExactOrCentral`] may raise waves above those of true slopes: a fifth
/// more power.
const MOST_RAISED: f64 = 1.1;

impl Derivative {
    /// D_x / i and D_y / i at one frequency, radians per texel.
    #[must_use]
    pub fn symbol(self, [wx, wy]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Exact => [wx, wy],
            Self::Central => [wx.sin(), wy.sin()],
            Self::Sobel => [wx.sin() * 0.5 * (1.0 + wy.cos()), wy.sin() * 0.5 * (1.0 + wx.cos())],
            Self::ExactOrCentral => [wx, wy].map(half_way),
        }
    }

    /// [`Derivative::symbol`] in a `width` × `height` transform: the exact derivative of the
    /// highest frequency of an even side is zero at every texel.
    fn at_bin(self, place: usize, width: usize, height: usize) -> [f64; 2] {
        let (kx, ky) = (place / height, place % height);
        let [mut dx, mut dy] = self.symbol([angular_frequency(kx, width), angular_frequency(ky, height)]);
        if 2 * kx == width {
            dx = 0.0;
        }
        if 2 * ky == height {
            dy = 0.0;
        }
        [dx, dy]
    }

    fn square_at(self, place: usize, width: usize, height: usize) -> f64 {
        self.at_bin(place, width, height).iter().map(|d| d * d).sum()
    }

    /// 1/|D|², or 0 where the derivative is blind.
    fn inverse_square(self, place: usize, width: usize, height: usize) -> f64 {
        let square = self.square_at(place, width, height);
        let (wx, wy) = (angular_frequency(place / height, width), angular_frequency(place % height, height));
        let upper_half = wx.hypot(wy) > std::f64::consts::FRAC_PI_2;
        let blind = if self == Self::Sobel { SOBEL_BLIND } else { BLIND };
        if square == 0.0 || (upper_half && square < blind) { 0.0 } else { 1.0 / square }
    }
}

/// Half way between a true derivative's and a central difference's symbol, and at least 1/1.1 of
/// the former.
fn half_way(omega: f64) -> f64 {
    let half = 0.5 * (omega + omega.sin());
    if half.abs() < omega.abs() / MOST_RAISED { omega / MOST_RAISED } else { half }
}

/// A field of slopes: dz/du and dz/dv, height per texel, equally large.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// Along u (to the right).
    pub along_u: Raster,
    /// Along v (downwards).
    pub along_v: Raster,
}

impl Slopes {
    /// p + i q, so that one transform serves both.
    fn packed(&self) -> Vec<Complex64> {
        let both = self.along_u.values.iter().zip(&self.along_v.values);
        both.map(|(&p, &q)| Complex64::new(p, q)).collect()
    }

    /// Mean squared length of the slopes.
    #[must_use]
    pub fn power(&self) -> f64 {
        let square = |r: &Raster| r.values.iter().map(|v| v * v).sum::<f64>();
        (square(&self.along_u) + square(&self.along_v)) / self.along_u.values.len().max(1) as f64
    }
}

/// The spectra of both slopes from that of p + i q, at one place.
fn unpack(packed: &[Complex64], place: usize, width: usize, height: usize) -> [Complex64; 2] {
    let (kx, ky) = (place / height, place % height);
    let mirror = (width - kx) % width * height + (height - ky) % height;
    let (a, b) = (packed[place], packed[mirror].conj());
    [(a + b) * 0.5, (a - b) * Complex64::new(0.0, -0.5)]
}
