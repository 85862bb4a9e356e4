//! Slopes of a surface that does not tile: differences of texels, one-sided at the borders.

use super::{Derivative, Slopes};
use asperity_surface::raster::Raster;

/// Weights of neighbours by the room they have: inside, eighth order for the true derivative.
const ORDERS: [&[f64]; 4] = [
    &[-0.5, 0.0, 0.5],
    &[1.0 / 12.0, -2.0 / 3.0, 0.0, 2.0 / 3.0, -1.0 / 12.0],
    &[-1.0 / 60.0, 3.0 / 20.0, -0.75, 0.0, 0.75, -3.0 / 20.0, 1.0 / 60.0],
    &[1.0 / 280.0, -4.0 / 105.0, 0.2, -0.8, 0.0, 0.8, -0.2, 4.0 / 105.0, -1.0 / 280.0],
];

/// The weights of a difference at position `i` of `n`: (first neighbour, weights).
fn stencil(derivative: Derivative, i: usize, n: usize) -> (usize, Vec<f64>) {
    if n < 3 {
        return (0, if n == 2 { vec![-1.0, 1.0] } else { vec![0.0] });
    }
    if derivative == Derivative::ExactOrCentral {
        return half_way(stencil(Derivative::Exact, i, n), &stencil(Derivative::Central, i, n));
    }
    let exact = derivative == Derivative::Exact;
    let room = i.min(n - 1 - i);
    if room > 0 {
        let order = if exact { room.min(4) } else { 1 };
        return (i - order, ORDERS[order - 1].to_vec());
    }
    match (exact, i) {
        (true, 0) => (0, vec![-1.5, 2.0, -0.5]),
        (true, _) => (n - 3, vec![0.5, -2.0, 1.5]),
        (false, 0) => (0, vec![-1.0, 1.0]),
        (false, _) => (n - 2, vec![-1.0, 1.0]),
    }
}

/// The mean of two stencils, the first of which spans the second.
fn half_way(wide: (usize, Vec<f64>), narrow: &(usize, Vec<f64>)) -> (usize, Vec<f64>) {
    let (first, mut weights) = wide;
    weights.iter_mut().for_each(|weight| *weight *= 0.5);
    for (weight, other) in weights[narrow.0 - first..].iter_mut().zip(&narrow.1) {
        *weight += 0.5 * other;
    }
    (first, weights)
}

/// Slopes of a surface that does not tile.
#[must_use]
pub fn differences(surface: &Raster, derivative: Derivative) -> Slopes {
    Slopes { along_u: along_u(surface, derivative), along_v: along_v(surface, derivative) }
}

/// The slope along u alone.
pub(super) fn along_u(surface: &Raster, derivative: Derivative) -> Raster {
    let (w, h) = (surface.width, surface.height);
    let averaged = if derivative == Derivative::Sobel { averaged_down(surface) } else { surface.clone() };
    let stencils: Vec<_> = (0..w).map(|x| stencil(derivative, x, w)).collect();
    let mut values = Vec::with_capacity(w * h);
    for y in 0..h {
        let row = averaged.row(y);
        let slope = |(first, weights): &(usize, Vec<f64>)| dot(weights, &row[*first..]);
        values.extend(stencils.iter().map(slope));
    }
    Raster { width: w, height: h, values }
}

/// The slope along v alone.
pub(super) fn along_v(surface: &Raster, derivative: Derivative) -> Raster {
    let (w, h) = (surface.width, surface.height);
    let averaged = if derivative == Derivative::Sobel { averaged_across(surface) } else { surface.clone() };
    let mut values = vec![0.0; w * h];
    for (y, slopes) in values.chunks_exact_mut(w.max(1)).enumerate() {
        let (first, weights) = stencil(derivative, y, h);
        for (k, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            for (slope, z) in slopes.iter_mut().zip(averaged.row(first + k)) {
                *slope += weight * z;
            }
        }
    }
    Raster { width: w, height: h, values }
}

fn dot(weights: &[f64], values: &[f64]) -> f64 {
    weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
}

/// ¼, ½, ¼ along u, as Sobel's slope along v is averaged; folded back at the borders.
fn averaged_across(surface: &Raster) -> Raster {
    let last = surface.width - 1;
    Raster::from_fn(surface.width, surface.height, |x, y| {
        let row = surface.row(y);
        0.25 * row[x.saturating_sub(1)] + 0.5 * row[x] + 0.25 * row[(x + 1).min(last)]
    })
}

/// Differences along v.
fn averaged_down(surface: &Raster) -> Raster {
    let last = surface.height - 1;
    Raster::from_fn(surface.width, surface.height, |x, y| {
        let at = |y| surface.at(x, y);
        0.25 * at(y.saturating_sub(1)) + 0.5 * at(y) + 0.25 * at((y + 1).min(last))
    })
}
