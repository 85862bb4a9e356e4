//! The wallpaper group of an averaged cell, and averaging within its fundamental domain.
//!
//! Thesis §7.1.2 stops at the lattice; the group is ours. In lattice coordinates every symmetry is
//! x → M·x + w with an integer matrix M, which maps an N × N sampling of the cell onto itself
//! without interpolation.
//!
//! 1. The holohedry: all M with entries in {−1, 0, 1} that keep the lattice's lengths and angles.
//!    Its rotations have orders 1, 2, 3, 4 and 6 only (crystallographic restriction, Satz 7.2).
//! 2. For each M the w that fits best is the peak of the correlation of the cell with its image,
//!    found by FFT over all w at once; its height, over the reliability of the cell, says whether
//!    (M, w) is a symmetry.
//! 3. The point group is the largest subgroup of which every M is a symmetry.
//! 4. Rotation order, kind of the mirror axes' lattice (primitive or centred), and whether
//!    reflections are mirrors or glides name one of the 17 groups.
//! 5. With the origin at a rotation centre (or on an axis) all w snap to sixths; the mean of the
//!    cell over the group is exactly symmetric.

use super::cell::AveragedCell;
use super::lattice::{Lattice, dot, length};
use super::operation::{Matrix, Operation, closure, holohedry};
use asperity_fft::{FftPlanner, num_complex::Complex};
use asperity_surface::raster::Raster;

/// A symmetry of a perfectly known cell correlates at least this much. Clean motifs of four blobs
/// reach up to 0.989 under a false one, true ones at least 0.997 (`analysis_table groups`).
const SYMMETRY_LIMIT: f64 = 0.99;

/// Discount for a cell that is not perfectly known, per unit of missing reliability.
const DOUBT: f64 = 2.0;

/// Reliability of a cell that is known badly: what is asked for falls from here, and slower.
const NOISY_LIMIT: f64 = 0.97;
const NOISY_DOUBT: f64 = 0.7;

/// Least that is asked for.
const LEAST_LIMIT: f64 = 0.85;

/// Largest change by a symmetry of the lattice's lengths and angles, relative: nearly square
/// lattices are tried as square.
const METRIC_TOLERANCE: f64 = 0.08;

/// One of the 17 ways in which a pattern can repeat.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "these are the names")]
pub enum WallpaperGroup {
    P1,
    P2,
    Pm,
    Pg,
    Cm,
    Pmm,
    Pmg,
    Pgg,
    Cmm,
    P4,
    P4m,
    P4g,
    P3,
    P3m1,
    P31m,
    P6,
    P6m,
}

impl WallpaperGroup {
    /// All 17.
    pub const ALL: [Self; 17] = [
        Self::P1,
        Self::P2,
        Self::Pm,
        Self::Pg,
        Self::Cm,
        Self::Pmm,
        Self::Pmg,
        Self::Pgg,
        Self::Cmm,
        Self::P4,
        Self::P4m,
        Self::P4g,
        Self::P3,
        Self::P3m1,
        Self::P31m,
        Self::P6,
        Self::P6m,
    ];

    /// The short international name, such as "p4m".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::P1 => "p1",
            Self::P2 => "p2",
            Self::Pm => "pm",
            Self::Pg => "pg",
            Self::Cm => "cm",
            Self::Pmm => "pmm",
            Self::Pmg => "pmg",
            Self::Pgg => "pgg",
            Self::Cmm => "cmm",
            Self::P4 => "p4",
            Self::P4m => "p4m",
            Self::P4g => "p4g",
            Self::P3 => "p3",
            Self::P3m1 => "p3m1",
            Self::P31m => "p31m",
            Self::P6 => "p6",
            Self::P6m => "p6m",
        }
    }
}

/// The symmetry of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellSymmetry {
    /// Its wallpaper group.
    pub group: WallpaperGroup,
    /// Number of point symmetries: the fundamental domain is this fraction of the cell.
    pub order: usize,
    /// Correlation of the cell with its image under the worst symmetry, over the cell's
    /// reliability; 1 for p1.
    pub agreement: f64,
    /// The cell averaged within its fundamental domain, sampled as the averaged cell was.
    pub cell: Raster,
}

/// Finds the group of an averaged cell.
#[must_use]
pub fn wallpaper_group(averaged: &AveragedCell, lattice: &Lattice) -> CellSymmetry {
    let basis = [lattice.t1_px, lattice.t2_px];
    let spectrum = Spectrum::new(&averaged.cell);
    let reliability = averaged.reliability.max(1e-6);
    let fits: Vec<Fit> = holohedry(basis, METRIC_TOLERANCE)
        .into_iter()
        .map(|matrix| spectrum.best_image(&averaged.cell, matrix, reliability))
        .collect();
    let doubt = 1.0 - averaged.reliability;
    let limit = (SYMMETRY_LIMIT - DOUBT * doubt).max(NOISY_LIMIT - NOISY_DOUBT * doubt).max(LEAST_LIMIT);
    let point_group = largest_symmetric_subgroup(&fits, limit);
    let agreement = point_group.iter().map(|fit| fit.agreement).fold(1.0, f64::min);
    CellSymmetry {
        group: name(&point_group, basis),
        order: point_group.len(),
        agreement,
        cell: domain_average(&averaged.cell, &spectrum, &point_group),
    }
}

/// A point symmetry with the translation that fits best.
#[derive(Debug, Clone, Copy)]
struct Fit {
    matrix: Matrix,
    /// In lattice coordinates, 0–1.
    translation: [f64; 2],
    /// Correlation over reliability.
    agreement: f64,
}

/// The largest subgroup of the holohedry all of whose members agree; of equals the one that agrees
/// better.
fn largest_symmetric_subgroup(fits: &[Fit], limit: f64) -> Vec<Fit> {
    let good: Vec<&Fit> = fits.iter().filter(|fit| fit.agreement >= limit).collect();
    let mut best: Vec<Fit> = fits.iter().filter(|fit| fit.matrix == Matrix::IDENTITY).copied().collect();
    let mut best_agreement = 0.0;
    for (i, a) in good.iter().enumerate() {
        for b in &good[..=i] {
            let members = closure(&[a.matrix, b.matrix]);
            let found: Vec<Fit> =
                members.iter().filter_map(|m| good.iter().find(|f| f.matrix == *m)).map(|f| **f).collect();
            let agreement = found.iter().map(|fit| fit.agreement).sum::<f64>() / found.len().max(1) as f64;
            let better =
                found.len() > best.len() || (found.len() == best.len() && agreement > best_agreement);
            if found.len() == members.len() && better {
                best = found;
                best_agreement = agreement;
            }
        }
    }
    best
}

/// Names the group that a point group and its translations make.
fn name(point_group: &[Fit], basis: [[f64; 2]; 2]) -> WallpaperGroup {
    use WallpaperGroup as G;
    let rotation = point_group.iter().map(|fit| fit.matrix.rotation_order()).max().unwrap_or(1);
    let reflections: Vec<&Fit> = point_group.iter().filter(|fit| fit.matrix.determinant() < 0).collect();
    let centred = reflections.iter().any(|fit| fit.matrix.axes_are_centred());
    let primitive: Vec<&&Fit> = reflections.iter().filter(|fit| !fit.matrix.axes_are_centred()).collect();
    let mirrors = primitive.iter().filter(|fit| is_mirror(fit)).count();
    match (rotation, reflections.is_empty()) {
        (1, true) => G::P1,
        (1, false) if centred => G::Cm,
        (1, false) if mirrors > 0 => G::Pm,
        (1, false) => G::Pg,
        (2, true) => G::P2,
        (2, false) if centred => G::Cmm,
        (2, false) => [G::Pgg, G::Pmg, G::Pmm][mirrors.min(2)],
        (3, true) => G::P3,
        (3, false) => {
            // Mirrors along the shortest translations leave some of the threefold centres off them.
            let axis = reflections[0].matrix.axes().0;
            let along = [0, 1].map(|k| axis[0] as f64 * basis[0][k] + axis[1] as f64 * basis[1][k]);
            if length(along) < 1.3 * length(basis[0]) { G::P31m } else { G::P3m1 }
        }
        (4, true) => G::P4,
        (4, false) if mirrors > 0 => G::P4m,
        (4, false) => G::P4g,
        (_, true) => G::P6,
        (_, false) => G::P6m,
    }
}

/// Tests whether a reflection about an axis of a primitive lattice needs no translation along that
/// axis.
fn is_mirror(fit: &Fit) -> bool {
    let axis = fit.matrix.axes().0.map(|a| a as f64);
    let image = fit.matrix.apply(fit.translation);
    let twice = [fit.translation[0] + image[0], fit.translation[1] + image[1]];
    // twice = s·axis, and s is known up to an even number: 0 for a mirror, 1 for a glide.
    let half = 0.5 * dot(twice, axis) / dot(axis, axis);
    (half - half.round()).abs() < 0.25
}

/// The mean of a cell over its group, exactly symmetric.
fn domain_average(cell: &Raster, spectrum: &Spectrum, point_group: &[Fit]) -> Raster {
    let Some((origin, operations)) = super::operation::snapped(
        &point_group
            .iter()
            .map(|fit| Operation { matrix: fit.matrix, translation: fit.translation })
            .collect::<Vec<_>>(),
    ) else {
        return cell.clone();
    };
    let side = cell.width;
    let moved = spectrum.shifted(origin);
    let steps = |t: f64| (t * side as f64).round() as i64;
    let mean = Raster::from_fn(side, side, |x, y| {
        let sum: f64 = operations
            .iter()
            .map(|op| {
                let [u, v] = op.matrix.apply_whole([x as i64, y as i64]);
                let wrap = |a: i64, t: f64| (a + steps(t)).rem_euclid(side as i64) as usize;
                moved.at(wrap(u, op.translation[0]), wrap(v, op.translation[1]))
            })
            .sum();
        sum / operations.len() as f64
    });
    Spectrum::new(&mean).shifted([-origin[0], -origin[1]])
}

/// The Fourier transform of a cell.
struct Spectrum {
    side: usize,
    values: Vec<Complex<f64>>,
}

impl Spectrum {
    fn new(cell: &Raster) -> Self {
        let mut values: Vec<Complex<f64>> = cell.values.iter().map(|&v| Complex::new(v, 0.0)).collect();
        transform(&mut values, cell.width, false);
        Self { side: cell.width, values }
    }

    /// The translation w that makes cell(M·x + w) most like cell(x).
    fn best_image(&self, cell: &Raster, matrix: Matrix, reliability: f64) -> Fit {
        let side = self.side;
        let inverse = matrix.inverse();
        // With y = M·x the correlation is Σ cell(M⁻¹y) cell(y + w).
        let image = Raster::from_fn(side, side, |x, y| {
            let [u, v] =
                inverse.apply_whole([x as i64, y as i64]).map(|a| a.rem_euclid(side as i64) as usize);
            cell.at(u, v)
        });
        let mut products = Self::new(&image).values;
        for (product, value) in products.iter_mut().zip(&self.values) {
            *product = product.conj() * value;
        }
        transform(&mut products, side, true);
        let scale = 1.0 / (side * side) as f64;
        let energy: f64 = cell.values.iter().map(|v| v * v).sum();
        let peak = (0..side * side).max_by(|&a, &b| products[a].re.total_cmp(&products[b].re)).unwrap_or(0);
        let (x, y) = (peak % side, peak / side);
        let at = |i: usize, j: usize| products[j % side * side + i % side].re;
        let vertex = |below: f64, here: f64, above: f64| {
            let bend = below - 2.0 * here + above;
            if bend < 0.0 { (0.5 * (below - above) / bend).clamp(-0.5, 0.5) } else { 0.0 }
        };
        let dx = vertex(at(x + side - 1, y), at(x, y), at(x + 1, y));
        let dy = vertex(at(x, y + side - 1), at(x, y), at(x, y + 1));
        // The vertex of the parabola in each direction raises the peak by half slope times offset.
        let raised = at(x, y)
            + 0.25 * dx * (at(x + 1, y) - at(x + side - 1, y))
            + 0.25 * dy * (at(x, y + 1) - at(x, y + side - 1));
        let agreement = if energy > 0.0 { raised * scale / energy / reliability } else { 0.0 };
        let translation = [(x as f64 + dx) / side as f64, (y as f64 + dy) / side as f64];
        let identity = matrix == Matrix::IDENTITY;
        Fit {
            matrix,
            translation: if identity { [0.0; 2] } else { translation },
            agreement: if identity { 1.0 } else { agreement },
        }
    }

    /// cell(x + offset), offset in lattice coordinates, by Fourier phases.
    fn shifted(&self, offset: [f64; 2]) -> Raster {
        let side = self.side;
        let mut values = self.values.clone();
        let wave = |k: usize| if 2 * k < side { k as f64 } else { k as f64 - side as f64 };
        for (i, value) in values.iter_mut().enumerate() {
            let (kx, ky) = (i % side, i / side);
            // The highest frequency has no partner: it cannot move and stay real.
            let phase = |k: usize, o: f64| if 2 * k == side { 0.0 } else { wave(k) * o };
            let turn = std::f64::consts::TAU * (phase(kx, offset[0]) + phase(ky, offset[1]));
            *value *= Complex::from_polar(1.0, turn);
        }
        transform(&mut values, side, true);
        let scale = 1.0 / (side * side) as f64;
        Raster { width: side, height: side, values: values.iter().map(|v| v.re * scale).collect() }
    }
}

/// Unscaled Fourier transform of a square, in place.
fn transform(square: &mut [Complex<f64>], side: usize, inverse: bool) {
    let mut planner = FftPlanner::new();
    let fft = if inverse { planner.plan_fft_inverse(side) } else { planner.plan_fft_forward(side) };
    for _ in 0..2 {
        fft.process(square);
        for y in 0..side {
            for x in 0..y {
                square.swap(y * side + x, x * side + y);
            }
        }
    }
}
