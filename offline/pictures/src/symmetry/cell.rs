//! The averaged primitive, the symmetric part of a picture, and what is left of it.
//!
//! Thesis §7.2.2: the primitive is the mean over all cells of the picture, the symmetric part
//! repeats it along the lattice (integers m, n in ℤ; print says ℕ), the residual is picture −
//! symmetric part. Cells are read at fractional texels by cubic interpolation, because translations
//! are no whole numbers of texels. **Changed:** slow light is taken out before averaging and left
//! in the residual: cells at the border are cut, so with a gradient each place in the cell would
//! average different light.

use super::detrend::detrended;
use super::lattice::{Lattice, length};
use super::minima::cubic_weights;
use asperity_surface::raster::Raster;

/// The cell is sampled on a square whose side is a multiple of this, so that rotation centres,
/// mirrors and glides at halves and thirds fall on samples.
const SIDE_MULTIPLE: usize = 12;

/// Largest side of a sampled cell.
const LARGEST_SIDE: usize = 240;

/// The mean of all cells of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct AveragedCell {
    /// The cell in lattice coordinates: sample (i, j) of N × N lies at (i/N)·t1 + (j/N)·t2 from the
    /// centre of the picture's first texel. Mean 0.
    pub cell: Raster,
    /// Share of the mean cell's variance that is pattern and not noise, 0–1, from the agreement of
    /// two halves of the cells (odd and even along t1, along t2, or both: the worst).
    pub reliability: f64,
    /// Least number of cells that each sample averages.
    pub repeats: usize,
}

/// A picture taken apart.
#[derive(Debug, Clone, PartialEq)]
pub struct Separation {
    /// The averaged cell in lattice coordinates, with the picture's mean.
    pub primitive: Raster,
    /// The cell repeated along the lattice, as large as the picture.
    pub symmetric: Raster,
    /// Picture − symmetric part.
    pub residual: Raster,
}

/// Averages all cells of a picture.
#[must_use]
pub fn averaged_cell(picture: &Raster, lattice: &Lattice) -> AveragedCell {
    averaged_even_cell(&detrended(picture), lattice)
}

/// [`averaged_cell`] of a picture without its slow light.
pub(crate) fn averaged_even_cell(even: &Raster, lattice: &Lattice) -> AveragedCell {
    let longest = length(lattice.t1_px).max(length(lattice.t2_px)).ceil() as usize;
    let side = (longest.div_ceil(SIDE_MULTIPLE).max(2) * SIDE_MULTIPLE).min(LARGEST_SIDE);
    // Four kinds of cells by the parity of m and n: their agreement separates pattern from noise,
    // whichever way it differs.
    let mut kinds = [(); 4].map(|()| (vec![0.0; side * side], vec![0_usize; side * side]));
    for (m, n) in cells(lattice, even.width, even.height) {
        let (sums, counts) = &mut kinds[(m.rem_euclid(2) + 2 * n.rem_euclid(2)) as usize];
        for j in 0..side {
            for i in 0..side {
                let (u, v) = (i as f64 / side as f64 + m as f64, j as f64 / side as f64 + n as f64);
                if let Some(value) = read(even, lattice.translation(u, v)) {
                    sums[j * side + i] += value;
                    counts[j * side + i] += 1;
                }
            }
        }
    }
    let count = |members: &[usize], k: usize| members.iter().map(|&kind| kinds[kind].1[k]).sum::<usize>();
    let mean = |members: &[usize]| {
        let sum = |k: usize| members.iter().map(|&kind| kinds[kind].0[k]).sum::<f64>();
        centred(Raster::from_fn(side, side, |i, j| {
            let k = j * side + i;
            sum(k) / count(members, k).max(1) as f64
        }))
    };
    let everything = [0, 1, 2, 3];
    let agreement = [([0, 2], [1, 3]), ([0, 1], [2, 3]), ([0, 3], [1, 2])]
        .map(|(one, other)| correlation(&mean(&one), &mean(&other)).max(0.0))
        .into_iter()
        .fold(1.0, f64::min);
    AveragedCell {
        cell: mean(&everything),
        // Spearman and Brown: the mean of both halves is more reliable than either.
        reliability: 2.0 * agreement / (1.0 + agreement),
        repeats: (0..side * side).map(|k| count(&everything, k)).min().unwrap_or(0),
    }
}

/// Faithfulness of a pattern to its lattice all over the picture, 0–1: the variance of its mean
/// cell over what texels have in common with those one translation on. 1 for a strict pattern,
/// however noisy or unevenly lit; near 0 when cells are like their neighbours but drift, as scales
/// on a bent skin do, and the mean of all of them is a blur. The picture comes without its slow
/// light.
pub(crate) fn even_steadiness(even: &Raster, lattice: &Lattice, averaged: &AveragedCell) -> f64 {
    let [one, other] = [lattice.t1_px, lattice.t2_px].map(|t| {
        let (mut product, mut count) = (0.0, 0.0);
        for y in 0..even.height {
            for x in 0..even.width {
                if let Some(next) = read(even, [x as f64 + t[0], y as f64 + t[1]]) {
                    product += even.at(x, y) * next;
                    count += 1.0;
                }
            }
        }
        product / f64::max(count, 1.0)
    });
    let cell = &averaged.cell.values;
    let kept = cell.iter().map(|v| v * v).sum::<f64>() / cell.len().max(1) as f64;
    let common = 0.5 * (one + other);
    if common > kept { kept / common } else { 1.0 }
}

/// Takes a picture apart into its averaged cell, the repeated cell and the rest.
#[must_use]
pub fn separate(picture: &Raster, lattice: &Lattice) -> Separation {
    with_cell(picture, lattice, &averaged_cell(picture, lattice).cell)
}

/// Takes a picture apart with a cell of one's own (mean 0), such as one averaged within its
/// fundamental domain.
#[must_use]
pub fn with_cell(picture: &Raster, lattice: &Lattice, cell: &Raster) -> Separation {
    let mean = picture.mean();
    let symmetric = Raster::from_fn(picture.width, picture.height, |x, y| {
        mean + periodic(cell, lattice.coordinates([x as f64, y as f64]))
    });
    let values = picture.values.iter().zip(&symmetric.values).map(|(p, s)| p - s).collect();
    let residual = Raster { width: picture.width, height: picture.height, values };
    Separation { primitive: cell.map(|v| v + mean), symmetric, residual }
}

/// All (m, n) whose cell may touch the picture.
fn cells(lattice: &Lattice, width: usize, height: usize) -> impl Iterator<Item = (i64, i64)> + use<> {
    let corners = [[0.0, 0.0], [width as f64, 0.0], [0.0, height as f64], [width as f64, height as f64]]
        .map(|corner| lattice.coordinates(corner));
    let range = |axis: usize| {
        let low = corners.iter().map(|c| c[axis]).fold(f64::INFINITY, f64::min).floor() as i64;
        let high = corners.iter().map(|c| c[axis]).fold(f64::NEG_INFINITY, f64::max).ceil() as i64;
        low - 1..=high
    };
    let (columns, rows) = (range(0), range(1));
    columns.flat_map(move |m| rows.clone().map(move |n| (m, n)))
}

/// Value between texels by cubic interpolation; nothing where the four texels are not all there.
pub(super) fn read(picture: &Raster, point: [f64; 2]) -> Option<f64> {
    let (left, top) = (point[0].floor(), point[1].floor());
    if left < 1.0 || top < 1.0 || left + 2.0 >= picture.width as f64 || top + 2.0 >= picture.height as f64 {
        return None;
    }
    let (across, down) = (cubic_weights(point[0] - left), cubic_weights(point[1] - top));
    let (i, j) = (left as usize - 1, top as usize - 1);
    let row = |j: usize| {
        let texels = &picture.row(j)[i..i + 4];
        texels.iter().zip(across).map(|(v, w)| v * w).sum::<f64>()
    };
    Some((0..4).map(|k| down[k] * row(j + k)).sum())
}

/// Value of a repeated cell at lattice coordinates.
fn periodic(cell: &Raster, [u, v]: [f64; 2]) -> f64 {
    let side = cell.width as f64;
    let (x, y) = (u.rem_euclid(1.0) * side, v.rem_euclid(1.0) * side);
    let (left, top) = (x.floor(), y.floor());
    let (across, down) = (cubic_weights(x - left), cubic_weights(y - top));
    let wrap = |i: f64, k: usize| (i as usize + cell.width + k - 1) % cell.width;
    (0..4)
        .map(|k| {
            let row = cell.row(wrap(top, k));
            down[k] * (0..4).map(|l| across[l] * row[wrap(left, l)]).sum::<f64>()
        })
        .sum()
}

fn centred(raster: Raster) -> Raster {
    let mean = raster.mean();
    raster.map(|v| v - mean)
}

/// Correlation of two rasters of mean 0.
fn correlation(a: &Raster, b: &Raster) -> f64 {
    let product = |a: &Raster, b: &Raster| a.values.iter().zip(&b.values).map(|(x, y)| x * y).sum::<f64>();
    let energy = (product(a, a) * product(b, b)).sqrt();
    if energy > 0.0 { product(a, b) / energy } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(lattice: &Lattice, x: f64, y: f64) -> f64 {
        let [u, v] = lattice.coordinates([x, y]);
        (TAU * u).cos() + 0.5 * (TAU * (u + v) + 1.0).sin() + 0.3 * (2.0 * TAU * v).cos()
    }

    #[test]
    fn the_symmetric_part_of_a_noisy_pattern_is_the_pattern() {
        let lattice = Lattice { t1_px: [17.3, 2.1], t2_px: [-4.4, 21.7], confidence: 1.0 };
        let mut rng = asperity_dsp::rng::Rng::new(9);
        let noise = Raster::from_fn(200, 160, |_, _| 0.5 * rng.normal());
        let picture = Raster::from_fn(200, 160, |x, y| {
            0.4 + wave(&lattice, x as f64, y as f64) + noise.at(x, y) + 0.01 * x as f64
        });
        let parts = separate(&picture, &lattice);
        let (mut error, mut back) = (0.0, 0.0_f64);
        for y in 0..160 {
            for x in 0..200 {
                let truth = wave(&lattice, x as f64, y as f64) + picture.mean();
                error += (parts.symmetric.at(x, y) - truth).powi(2) / 32_000.0;
                back =
                    back.max((parts.symmetric.at(x, y) + parts.residual.at(x, y) - picture.at(x, y)).abs());
            }
        }
        // 80 cells average the noise to 0.5/√80 = 0.056.
        assert!(error.sqrt() < 0.07 && back < 1e-12, "{} {back}", error.sqrt());
        let cell = averaged_cell(&picture, &lattice);
        assert!(cell.reliability > 0.98 && cell.repeats > 60 && cell.cell.width.is_multiple_of(12));
    }

    #[test]
    fn a_strict_pattern_is_steady_and_a_drifting_one_is_not() {
        let lattice = Lattice { t1_px: [17.3, 2.1], t2_px: [-4.4, 21.7], confidence: 1.0 };
        let mut rng = asperity_dsp::rng::Rng::new(11);
        let mut seen = |noise: f64, light: f64, drift: f64| {
            let picture = Raster::from_fn(200, 200, |x, y| {
                let bend = drift * (TAU * y as f64 / 200.0).sin();
                wave(&lattice, x as f64 + bend, y as f64) + noise * rng.normal() + light * x as f64
            });
            even_steadiness(&detrended(&picture), &lattice, &averaged_cell(&picture, &lattice))
        };
        for (noise, light) in [(0.0, 0.0), (1.5, 0.0), (0.3, 0.02)] {
            assert!(seen(noise, light, 0.0) > 0.9);
        }
        assert!(seen(0.2, 0.0, 8.0) < 0.5);
    }

    #[test]
    fn a_cell_of_noise_is_not_reliable() {
        let lattice = Lattice { t1_px: [16.0, 0.0], t2_px: [0.0, 16.0], confidence: 1.0 };
        let mut rng = asperity_dsp::rng::Rng::new(10);
        let noise = Raster::from_fn(128, 128, |_, _| rng.normal());
        assert!(averaged_cell(&noise, &lattice).reliability < 0.4);
    }
}
