//! Differences of texels that do not tile, put together by mirroring: no iteration, and rounding weighed as in [`super::rounded`].
//!
//! An image that goes on mirrored tiles, and its slopes are those of the map with their signs turned. At the border a central difference
//! of the mirrored image is half the difference to the only neighbour (mirrored beyond the last texel), or none (mirrored at the last
//! texel). Converters take the one, the other, or the whole difference, which is twice the first: in each case one Fourier transform of
//! four times the size solves the least squares exactly. Which it was is read from the field, by regression of the border's
//! slopes on those expected from the two next to them, 3/2 s₁ − 1/2 s₂.

use super::{Derivative, Slopes, integrate_rounded};
use crate::raster::Raster;

/// What a field's borders hold of the difference to the only neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BorderShare {
    None,
    Half,
    Whole,
}

impl BorderShare {
    pub(super) fn of(field: &Slopes) -> Self {
        let (w, h) = (field.along_u.width, field.along_u.height);
        if w.min(h) < 6 {
            return Self::Whole;
        }
        let (mut both, mut expected) = (0.0, 0.0);
        let mut regress = |border: f64, next: f64, after: f64| {
            let slope = 1.5 * next - 0.5 * after;
            both += border * slope;
            expected += slope * slope;
        };
        for y in 0..h {
            let row = field.along_u.row(y);
            regress(row[0], row[1], row[2]);
            regress(row[w - 1], row[w - 2], row[w - 3]);
        }
        for x in 0..w {
            let at = |y| field.along_v.at(x, y);
            regress(at(0), at(1), at(2));
            regress(at(h - 1), at(h - 2), at(h - 3));
        }
        match both / expected {
            share if share < 0.25 => Self::None,
            share if share < 0.75 => Self::Half,
            _ => Self::Whole,
        }
    }
}

/// The surface whose slopes by `derivative` (differences of neighbours) these are but for a noise of variance `noise` at the most, mean 0.
pub(super) fn integrate_mirrored(field: &Slopes, derivative: Derivative, noise: f64) -> Raster {
    let (w, h) = (field.along_u.width, field.along_u.height);
    let share = BorderShare::of(field);
    // The last texel is there twice, or once.
    let twice = usize::from(share != BorderShare::None);
    let (wide, high) = (2 * (w - 1 + twice), 2 * (h - 1 + twice));
    let gain =
        |i: usize, n: usize| if share == BorderShare::Whole && (i == 0 || i == n - 1) { 0.5 } else { 1.0 };
    let mirror = |i: usize, n: usize, size: usize| if i < n { (i, 1.0) } else { (size - twice - i, -1.0) };
    let along = |slope: &Raster, across: bool| {
        Raster::from_fn(wide, high, |x, y| {
            let ((x, right), (y, down)) = (mirror(x, w, wide), mirror(y, h, high));
            slope.at(x, y) * if across { down * gain(y, h) } else { right * gain(x, w) }
        })
    };
    let mirrored = Slopes { along_u: along(&field.along_u, false), along_v: along(&field.along_v, true) };
    let made = integrate_rounded(&mirrored, derivative, noise);
    let cut = Raster::from_fn(w, h, |x, y| made.at(x, y));
    cut.map(|z| z - cut.mean())
}
