//! Two-dimensional discrete Fourier transforms with plans that are made once and used again.
//!
//! ```text
//! X(kx, ky) = Σ_x Σ_y image(x, y) e^(−2πi (kx x / width + ky y / height))
//! ```
//! The image is stored row by row; **the spectrum is stored column by column**: `kx · height + ky`.
//! That saves a transposition each way. The forward transform is not scaled, the inverse divides by
//! `width · height`, so that one after the other gives the image back.

use crate::raster::Raster;
use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// Side of the square that is transposed at once: 16 × 16 complex numbers are 4 KiB.
const TRANSPOSE_TILE: usize = 16;

/// Plans and scratch memory for images of one size.
#[derive(Clone)]
pub struct Fft2 {
    width: usize,
    height: usize,
    rows: [Arc<dyn Fft<f64>>; 2],
    columns: [Arc<dyn Fft<f64>>; 2],
    scratch: Vec<Complex64>,
}

impl std::fmt::Debug for Fft2 {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Fft2({} × {})", self.width, self.height)
    }
}

impl Fft2 {
    /// Plans transforms of `width` × `height` images, both at least 1; any size, fastest when both
    /// have small prime factors.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let mut planner = FftPlanner::new();
        let rows = [planner.plan_fft_forward(width), planner.plan_fft_inverse(width)];
        let columns = [planner.plan_fft_forward(height), planner.plan_fft_inverse(height)];
        let needed = rows.iter().chain(&columns).map(|plan| plan.get_inplace_scratch_len()).max();
        let scratch = vec![Complex64::default(); needed.unwrap_or(0)];
        Self { width, height, rows, columns, scratch }
    }

    /// Texels in a row.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Number of values in the image and in the spectrum.
    #[must_use]
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Whether the image has no value at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Transforms `image` (which is used as working memory and left undefined) into `spectrum`.
    ///
    /// # Panics
    /// When a slice does not hold [`Fft2::len`] values.
    pub fn forward(&mut self, image: &mut [Complex64], spectrum: &mut [Complex64]) {
        self.forward_low(image, spectrum, self.width);
    }

    /// As [`Fft2::forward`], but only for the `kept` columns of lowest frequency along u: the others are left as
    /// they are.
    pub(crate) fn forward_low(&mut self, image: &mut [Complex64], spectrum: &mut [Complex64], kept: usize) {
        self.rows[0].process_with_scratch(image, &mut self.scratch);
        for columns in low_columns(kept, self.width) {
            let part = &mut spectrum[columns.start * self.height..columns.end * self.height];
            transpose(image, self.width, self.height, columns, part);
            self.columns[0].process_with_scratch(part, &mut self.scratch);
        }
    }

    /// Transforms `spectrum` (which is left undefined) back into `image`.
    ///
    /// # Panics
    /// When a slice does not hold [`Fft2::len`] values.
    pub fn inverse(&mut self, spectrum: &mut [Complex64], image: &mut [Complex64]) {
        self.inverse_unscaled(spectrum, image);
        let scale = 1.0 / self.len() as f64;
        image.iter_mut().for_each(|value| *value *= scale);
    }

    /// As [`Fft2::inverse`] without the division, for callers that scale their filters instead.
    ///
    /// # Panics
    /// When a slice does not hold [`Fft2::len`] values.
    pub fn inverse_unscaled(&mut self, spectrum: &mut [Complex64], image: &mut [Complex64]) {
        self.inverse_low_unscaled(spectrum, image, self.width);
    }

    /// As [`Fft2::inverse_unscaled`] for a spectrum that is zero but for the `kept` columns of lowest frequency along u.
    pub(crate) fn inverse_low_unscaled(
        &mut self,
        spectrum: &mut [Complex64],
        image: &mut [Complex64],
        kept: usize,
    ) {
        for columns in low_columns(kept, self.width) {
            let part = &mut spectrum[columns.start * self.height..columns.end * self.height];
            self.columns[1].process_with_scratch(part, &mut self.scratch);
        }
        transpose(spectrum, self.height, self.width, 0..self.height, image);
        self.rows[1].process_with_scratch(image, &mut self.scratch);
    }

    /// The spectrum of a real image.
    ///
    /// # Panics
    /// When `values` does not hold [`Fft2::len`] values.
    #[must_use]
    pub fn spectrum(&mut self, values: &[f64]) -> Vec<Complex64> {
        let mut image: Vec<Complex64> = values.iter().map(|&v| Complex64::new(v, 0.0)).collect();
        let mut spectrum = vec![Complex64::default(); self.len()];
        self.forward(&mut image, &mut spectrum);
        spectrum
    }

    /// The real part of the image with this spectrum (which is left undefined).
    ///
    /// # Panics
    /// When `spectrum` does not hold [`Fft2::len`] values.
    #[must_use]
    pub fn image(&mut self, spectrum: &mut [Complex64]) -> Raster {
        let mut image = vec![Complex64::default(); self.len()];
        self.inverse(spectrum, &mut image);
        Raster {
            width: self.width,
            height: self.height,
            values: image.iter().map(|value| value.re).collect(),
        }
    }
}

/// The signed frequency of bin `k` of `n`: −(n−1)/2 … n/2, cycles per image.
#[must_use]
pub fn signed_bin(k: usize, n: usize) -> isize {
    if k > n / 2 { k as isize - n as isize } else { k as isize }
}

/// The angular frequency of bin `k` of `n`, radians per texel, in (−π, π].
#[must_use]
pub fn angular_frequency(k: usize, n: usize) -> f64 {
    TAU * signed_bin(k, n) as f64 / n as f64
}

/// The columns of a spectrum `width` wide that hold its `kept` lowest frequencies along u: from zero up, and the negative ones.
fn low_columns(kept: usize, width: usize) -> [Range<usize>; 2] {
    let up = if kept < width { kept / 2 + 1 } else { width };
    [0..up, width - kept.saturating_sub(up)..width]
}

/// Writes some columns of the `width` × `height` matrix `from`, stored row by row, one after the other into `to`.
fn transpose(from: &[Complex64], width: usize, height: usize, columns: Range<usize>, to: &mut [Complex64]) {
    for y0 in (0..height).step_by(TRANSPOSE_TILE) {
        for x0 in columns.clone().step_by(TRANSPOSE_TILE) {
            let y1 = (y0 + TRANSPOSE_TILE).min(height);
            for x in x0..(x0 + TRANSPOSE_TILE).min(columns.end) {
                let start = (x - columns.start) * height;
                for (y, value) in (y0..y1).zip(&mut to[start + y0..start + y1]) {
                    *value = from[y * width + x];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn the_spectrum_is_the_sum_that_defines_it_at_any_size() {
        let mut rng = Rng::new(3);
        for (width, height) in [(1, 1), (8, 8), (7, 5), (12, 9), (1, 6)] {
            let image = Raster::from_fn(width, height, |_, _| rng.normal());
            let spectrum = Fft2::new(width, height).spectrum(&image.values);
            for kx in 0..width {
                for ky in 0..height {
                    let mut sum = Complex64::default();
                    for y in 0..height {
                        for x in 0..width {
                            let turns = (kx * x) as f64 / width as f64 + (ky * y) as f64 / height as f64;
                            sum += image.at(x, y) * Complex64::cis(-TAU * turns);
                        }
                    }
                    assert!((sum - spectrum[kx * height + ky]).norm() < 1e-11);
                }
            }
        }
    }

    #[test]
    fn there_and_back_again_is_the_image_to_rounding() {
        let mut rng = Rng::new(4);
        for (width, height) in [(256, 256), (255, 129), (97, 64)] {
            let image = Raster::from_fn(width, height, |_, _| rng.uniform());
            let mut fft = Fft2::new(width, height);
            let mut spectrum = fft.spectrum(&image.values);
            let back = fft.image(&mut spectrum);
            for (a, b) in image.values.iter().zip(&back.values) {
                assert!((a - b).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn low_frequencies_alone_are_those_of_the_whole_transform() {
        let mut rng = Rng::new(5);
        for (width, height, kept) in [(32, 12, 16), (33, 12, 17), (15, 8, 4), (16, 8, 1), (9, 9, 9)] {
            let image: Vec<_> =
                (0..width * height).map(|_| Complex64::new(rng.normal(), rng.normal())).collect();
            let mut fft = Fft2::new(width, height);
            let (mut whole, mut low) = (image.clone(), image.clone());
            fft.forward(&mut image.clone(), &mut whole);
            low.fill(Complex64::default());
            fft.forward_low(&mut image.clone(), &mut low, kept);
            let inside = |k: usize| low_columns(kept, width).iter().any(|range| range.contains(&k));
            assert_eq!((0..width).filter(|&k| inside(k)).count(), kept);
            for (place, value) in whole.iter_mut().enumerate().filter(|(place, _)| !inside(place / height)) {
                *value = low[place];
            }
            assert_eq!(whole, low);
            let (mut all, mut few) = (image.clone(), image);
            fft.inverse_unscaled(&mut whole, &mut all);
            fft.inverse_low_unscaled(&mut low, &mut few, kept);
            assert!(all.iter().zip(&few).all(|(a, b)| (a - b).norm() < 1e-12));
        }
    }

    #[test]
    fn bins_above_the_half_are_negative_frequencies() {
        assert_eq!((0..5).map(|k| signed_bin(k, 5)).collect::<Vec<_>>(), [0, 1, 2, -2, -1]);
        assert_eq!((0..4).map(|k| signed_bin(k, 4)).collect::<Vec<_>>(), [0, 1, 2, -1]);
        assert!((angular_frequency(3, 4) + TAU / 4.0).abs() < 1e-15);
    }
}
