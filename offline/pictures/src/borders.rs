//! Images that do not tile, for tools that work in the Fourier domain.
//!
//! A Fourier transform takes an image to repeat; a photograph's opposite borders then meet in steps
//! that leak into every frequency. The image is split into a periodic component p and a smooth one
//! s,
//! ```text
//! image = p + s        Δs = (jumps across the borders)        mean s = 0
//! ```
//! p has the detail of the image and tiles; s is harmonic inside and takes the steps. Source: L.
//! Moisan, "Periodic plus smooth image decomposition", J. Math. Imaging Vis. 39, 2011.

use crate::fft2::{RealFft2, Workspace, angular_frequency};
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// Ratio of the mean step across a seam to the mean step inside up to which an image tiles. Source:
/// ours; tileable maps of the corpus stay below 1.3, photographs are above 2.
pub const SEAM_LIMIT: f64 = 1.6;
/// Part of the step across a seam within which two neighbours inside must equal the two at the seam
/// for it to be one of the pattern's own edges. Source: ours; strips of photographs differ by the
/// step itself.
const SAME_STRIP: f64 = 0.25;

/// Decision whether an image tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Borders {
    /// Look at the seams: [`seam_ratio`] against [`SEAM_LIMIT`], unless the same step is met
    /// inside, too: the edge of a tile may lie on the border.
    #[default]
    Detect,
    /// It tiles.
    Periodic,
    /// It does not; work on the periodic component.
    Smooth,
}

impl Borders {
    /// [`Borders::Periodic`] or [`Borders::Smooth`] for this image.
    #[must_use]
    pub fn decide(self, image: &Raster) -> Self {
        match self {
            Self::Detect if seam_ratio(image) <= SEAM_LIMIT || has_ordinary_seams(image) => Self::Periodic,
            Self::Detect => Self::Smooth,
            decided => decided,
        }
    }
}

/// Mean absolute step across the borders over that between neighbours one texel further inside, the
/// larger of the two directions. About 1 for an image that tiles; 1 for one that has no steps at
/// all.
#[must_use]
pub fn seam_ratio(image: &Raster) -> f64 {
    let (w, h) = (image.width, image.height);
    if w < 4 || h < 4 {
        return 1.0;
    }
    let across_x: f64 = (0..h).map(|y| (image.at(0, y) - image.at(w - 1, y)).abs()).sum();
    let across_y: f64 = (0..w).map(|x| (image.at(x, 0) - image.at(x, h - 1)).abs()).sum();
    // The steps near both borders, so that a pattern that varies over the image does not matter.
    let inside_x: f64 = (0..h)
        .map(|y| (image.at(1, y) - image.at(0, y)).abs() + (image.at(w - 1, y) - image.at(w - 2, y)).abs())
        .sum();
    let inside_y: f64 = (0..w)
        .map(|x| (image.at(x, 1) - image.at(x, 0)).abs() + (image.at(x, h - 1) - image.at(x, h - 2)).abs())
        .sum();
    let ratio = |across: f64, inside: f64| if across == 0.0 { 1.0 } else { 2.0 * across / inside };
    ratio(across_x, inside_x).max(ratio(across_y, inside_y))
}

/// Tests whether the steps across both seams are no larger than others or are met inside.
fn has_ordinary_seams(image: &Raster) -> bool {
    let (w, h) = (image.width, image.height);
    let turned = || Raster::from_fn(h, w, |x, y| image.at(y, x));
    w >= 4 && h >= 4 && seam_is_met_inside(image) && seam_is_met_inside(&turned())
}

/// Tests whether two neighbouring rows inside are those that meet at the seam, the last one and the
/// first one.
fn seam_is_met_inside(image: &Raster) -> bool {
    let last = image.height - 1;
    let distance = |a: usize, b: usize| -> f64 {
        image.row(a).iter().zip(image.row(b)).map(|(a, b)| (a - b).abs()).sum()
    };
    let across = distance(last, 0);
    let inside = distance(0, 1) + distance(last - 1, last);
    2.0 * across <= SEAM_LIMIT * inside
        || (0..last).any(|row| distance(row, last) + distance(row + 1, 0) <= SAME_STRIP * across)
}

/// An image split at its borders.
#[derive(Debug, Clone, PartialEq)]
pub struct SplitBorders {
    /// The component that tiles.
    pub periodic: Raster,
    /// The rest; nothing for an image that tiles.
    pub smooth: Option<Raster>,
}

impl SplitBorders {
    /// Splits an image that does not tile; leaves one that does as it is.
    #[must_use]
    pub fn of(image: &Raster, borders: Borders) -> Self {
        if borders.decide(image) == Borders::Periodic {
            return Self { periodic: image.clone(), smooth: None };
        }
        let smooth = smooth_component(image);
        let values = image.values.iter().zip(&smooth.values).map(|(v, s)| v - s).collect();
        let periodic = Raster { width: image.width, height: image.height, values };
        Self { periodic, smooth: Some(smooth) }
    }

    /// This image's smooth component, as strong as the one of `reference`; none where either tiles.
    pub(crate) fn seam_like(&self, reference: &Self) -> Option<Raster> {
        let (Some(ours), Some(theirs)) = (&self.smooth, &reference.smooth) else { return None };
        let rms = |r: &Raster| (r.values.iter().map(|v| v * v).sum::<f64>() / r.values.len() as f64).sqrt();
        let (ours_rms, theirs_rms) = (rms(ours), rms(theirs));
        (ours_rms > 0.0).then(|| ours.map(|v| v * (theirs_rms / ours_rms)))
    }
}

/// The smooth component s.
fn smooth_component(image: &Raster) -> Raster {
    let (w, h) = (image.width, image.height);
    let mut planner = FftPlanner::new();
    let down = transformed((0..w).map(|x| image.at(x, 0) - image.at(x, h - 1)), &mut planner);
    let across = transformed((0..h).map(|y| image.at(0, y) - image.at(w - 1, y)), &mut planner);
    // A step stands in the first row (column) and, negative, in the last: 1 − e^(iω) of its
    // spectrum.
    let pairs = |n: usize| {
        let pair = |k| Complex64::new(1.0, 0.0) - Complex64::cis(angular_frequency(k, n));
        (0..n).map(pair).collect::<Vec<_>>()
    };
    let (along_x, along_y) = (pairs(w), pairs(h));
    let fft = RealFft2::new(&mut planner, w, h);
    let scale = 1.0 / (w * h) as f64;
    let mut values = Vec::new();
    fft.inverse_unscaled(fft.half_columns(), &mut Workspace::default(), &mut values, |kx, column| {
        for ((to, step), pair) in column.iter_mut().zip(&across).zip(&along_y) {
            // Eigenvalue of the periodic five-point Laplacian, 4 − 2 cos ω_x − 2 cos ω_y.
            let laplacian = 2.0 * (along_x[kx].re + pair.re);
            *to = (down[kx] * pair + step * along_x[kx]) * (scale / laplacian);
        }
        if kx == 0 {
            // The mean of s is zero.
            column[0] = Complex64::default();
        }
    });
    Raster { width: w, height: h, values }
}

/// The spectrum of a line.
fn transformed(line: impl Iterator<Item = f64>, planner: &mut FftPlanner) -> Vec<Complex64> {
    let mut spectrum: Vec<Complex64> = line.map(|v| Complex64::new(v, 0.0)).collect();
    planner.plan_fft_forward(spectrum.len()).process(&mut spectrum);
    spectrum
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn a_ramp_is_almost_all_smooth_and_a_wave_is_all_periodic() {
        let ramp = Raster::from_fn(64, 48, |x, y| 0.1 * x as f64 + 0.05 * y as f64);
        let split = SplitBorders::of(&ramp, Borders::Detect);
        assert!(seam_ratio(&ramp) > 20.0);
        let left = split.periodic.range();
        assert!(left.1 - left.0 < 0.2 * (ramp.range().1 - ramp.range().0));
        let wave = Raster::from_fn(64, 48, |x, y| {
            (TAU * 3.0 * x as f64 / 64.0).cos() + (TAU * 2.0 * y as f64 / 48.0).sin()
        });
        assert!(seam_ratio(&wave) < SEAM_LIMIT);
        assert_eq!(SplitBorders::of(&wave, Borders::Detect).periodic, wave);
    }

    #[test]
    fn an_edge_of_the_pattern_on_the_border_is_no_seam() {
        let bars =
            |width| Raster::from_fn(width, 96, |x, y| if x % 32 < 6 || y % 32 < 6 { 1.0 } else { 0.0 });
        let squares = Raster::from_fn(64, 64, |x, y| ((x / 16 + y / 16) % 2) as f64);
        for tile in [bars(96), squares] {
            assert!(seam_ratio(&tile) > SEAM_LIMIT);
            assert_eq!(Borders::Detect.decide(&tile), Borders::Periodic);
        }
        let hill = Raster::from_fn(64, 64, |x, y| (x as f64 * 0.1).exp() + ((x * 7 + y * 13) % 5) as f64);
        assert_eq!(Borders::Detect.decide(&hill), Borders::Smooth);
    }

    #[test]
    fn the_smooth_component_solves_its_equation() {
        let image = Raster::from_fn(9, 7, |x, y| (x * x) as f64 * 0.3 + (y as f64).exp().ln_1p());
        let s = smooth_component(&image);
        let (w, h) = (9, 7);
        for y in 0..h {
            for x in 0..w {
                let laplacian = s.at((x + 1) % w, y)
                    + s.at((x + w - 1) % w, y)
                    + s.at(x, (y + 1) % h)
                    + s.at(x, (y + h - 1) % h)
                    - 4.0 * s.at(x, y);
                let mut step = 0.0;
                if y == 0 || y == h - 1 {
                    step += image.at(x, h - 1 - y) - image.at(x, y);
                }
                if x == 0 || x == w - 1 {
                    step += image.at(w - 1 - x, y) - image.at(x, y);
                }
                assert!((laplacian - step).abs() < 1e-10, "({x}, {y}): {laplacian} against {step}");
            }
        }
        assert!(s.mean().abs() < 1e-12);
    }
}
