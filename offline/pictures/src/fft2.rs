//! Two-dimensional discrete Fourier transforms with plans that are made once and used again.
//!
//! ```text
//! X(kx, ky) = Σ_x Σ_y image(x, y) e^(−2πi (kx x / width + ky y / height))
//! ```
//! The image is stored row by row; **the spectrum is stored column by column**: `kx · height + ky`.
//! That saves a transposition each way. The forward transform is not scaled, the inverse divides by
//! `width · height`, so that one after the other gives the image back.

mod real;

pub(crate) use real::{RealFft2, Workspace};

use asperity_fft::num_complex::Complex64;
use asperity_fft::{Fft, FftPlanner};
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Columns that are transposed and transformed at once: 8 of 256 complex numbers are 32 KiB.
const BLOCK: usize = 8;

/// Plans and scratch memory for images of one size.
#[derive(Clone)]
pub struct Fft2 {
    width: usize,
    height: usize,
    rows: [Arc<dyn Fft<f64>>; 2],
    columns: [Arc<dyn Fft<f64>>; 2],
    scratch: Vec<Complex64>,
    real: RealFft2,
    work: Workspace,
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
        let real = RealFft2::new(&mut planner, width, height);
        Self { width, height, rows, columns, scratch, real, work: Workspace::default() }
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

    /// Tests whether the image has no value at all.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Transforms `image` (which is used as working memory and left undefined) into `spectrum`.
    ///
    /// # Panics
    /// When a slice does not hold [`Fft2::len`] values.
    pub fn forward(&mut self, image: &mut [Complex64], spectrum: &mut [Complex64]) {
        assert_eq!(spectrum.len(), self.len(), "a spectrum of the size that was planned");
        self.rows[0].process_with_scratch(image, &mut self.scratch);
        // Columns are transformed while they are still in the cache.
        for (block, columns) in spectrum.chunks_mut(BLOCK * self.height).enumerate() {
            for (y, row) in image.chunks_exact(self.width).enumerate() {
                for (column, &value) in columns.chunks_exact_mut(self.height).zip(&row[block * BLOCK..]) {
                    column[y] = value;
                }
            }
            self.columns[0].process_with_scratch(columns, &mut self.scratch);
        }
    }

    /// Transforms `spectrum` (which is left undefined) back into `image`.
    ///
    /// # Panics
    /// When a slice does not hold [`Fft2::len`] values.
    pub fn inverse(&mut self, spectrum: &mut [Complex64], image: &mut [Complex64]) {
        assert_eq!(spectrum.len(), self.len(), "a spectrum of the size that was planned");
        for (block, columns) in spectrum.chunks_mut(BLOCK * self.height).enumerate() {
            self.columns[1].process_with_scratch(columns, &mut self.scratch);
            for (y, row) in image.chunks_exact_mut(self.width).enumerate() {
                for (value, column) in row[block * BLOCK..].iter_mut().zip(columns.chunks_exact(self.height))
                {
                    *value = column[y];
                }
            }
        }
        self.rows[1].process_with_scratch(image, &mut self.scratch);
        let scale = 1.0 / self.len() as f64;
        image.iter_mut().for_each(|value| *value *= scale);
    }

    /// The spectrum of a real image.
    ///
    /// # Panics
    /// When `values` does not hold [`Fft2::len`] values.
    #[must_use]
    pub fn spectrum(&mut self, values: &[f64]) -> Vec<Complex64> {
        let (height, half) = (self.height, self.real.half_columns());
        let mut spectrum = Vec::with_capacity(self.len());
        self.real.forward(values, half, &mut self.work, |_, column| spectrum.extend_from_slice(column));
        // X(−kx, −ky) = conj X(kx, ky).
        for kx in half..self.width {
            let mirrored = (self.width - kx) * height;
            spectrum.push(spectrum[mirrored].conj());
            for ky in 1..height {
                spectrum.push(spectrum[mirrored + height - ky].conj());
            }
        }
        spectrum
    }

    /// The real part of the image with this spectrum, which may be used as working memory.
    ///
    /// # Panics
    /// When `spectrum` does not hold [`Fft2::len`] values.
    #[must_use]
    pub fn image(&mut self, spectrum: &mut [Complex64]) -> Raster {
        assert_eq!(spectrum.len(), self.len(), "a spectrum of the size that was planned");
        let (width, height) = (self.width, self.height);
        let scale = 0.5 / self.len() as f64;
        let mut values = Vec::with_capacity(self.len());
        self.real.inverse_unscaled(self.real.half_columns(), &mut self.work, &mut values, |kx, column| {
            // The real part has the spectrum (X(k) + conj X(−k)) / 2.
            let own = &spectrum[kx * height..][..height];
            let mirrored = &spectrum[(width - kx) % width * height..][..height];
            column[0] = (own[0] + mirrored[0].conj()) * scale;
            let both = own[1..].iter().zip(mirrored[1..].iter().rev());
            for (to, (own, mirrored)) in column[1..].iter_mut().zip(both) {
                *to = (own + mirrored.conj()) * scale;
            }
        });
        Raster { width, height, values }
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
    fn bins_above_the_half_are_negative_frequencies() {
        assert_eq!((0..5).map(|k| signed_bin(k, 5)).collect::<Vec<_>>(), [0, 1, 2, -2, -1]);
        assert_eq!((0..4).map(|k| signed_bin(k, 4)).collect::<Vec<_>>(), [0, 1, 2, -1]);
        assert!((angular_frequency(3, 4) + TAU / 4.0).abs() < 1e-15);
    }
}
