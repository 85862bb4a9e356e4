//! Images on other grids, by their spectra: nothing is lost that the coarser grid can hold, and
//! nothing above its Nyquist frequency is folded back.

use crate::fft2::{Fft2, signed_bin};
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;

/// The image on `width` × `height` texels, taken to repeat.
#[must_use]
pub fn resample(image: &Raster, width: usize, height: usize) -> Raster {
    let from = Fft2::new(image.width, image.height).spectrum(&image.values);
    let mut to = vec![Complex64::default(); width * height];
    let scale = (width * height) as f64 / (image.width * image.height) as f64;
    // The Nyquist bin of an even side has no partner of the other sign on a finer grid: left out.
    let kept = |n: usize, m: usize| (n.min(m) as isize - 1) / 2;
    let (kept_x, kept_y) = (kept(image.width, width), kept(image.height, height));
    for kx in -kept_x..=kept_x {
        let column = kx.rem_euclid(image.width as isize) as usize * image.height;
        let new_column = kx.rem_euclid(width as isize) as usize * height;
        for ky in -kept_y..=kept_y {
            let row = ky.rem_euclid(image.height as isize) as usize;
            let new_row = ky.rem_euclid(height as isize) as usize;
            to[new_column + new_row] = from[column + row] * scale;
        }
    }
    Fft2::new(width, height).image(&mut to)
}

/// The image on `width` × `height` texels, taken to end at its borders: it is resampled together
/// with its mirror images, which meet it without a step.
#[must_use]
pub fn resample_mirrored(image: &Raster, width: usize, height: usize) -> Raster {
    let (w, h) = (image.width, image.height);
    let folded = |i: usize, n: usize| if i < n { i } else { 2 * n - 1 - i };
    let four = Raster::from_fn(2 * w, 2 * h, |x, y| image.at(folded(x, w), folded(y, h)));
    let made = resample(&four, 2 * width, 2 * height);
    Raster::from_fn(width, height, |x, y| made.at(x, y))
}

/// The amplitude spectrum the image would have on `width` × `height` texels of the same size: power
/// per frequency interval is kept. Exact when the sizes are equal. Stored as [`Fft2`] spectra are;
/// the entry at frequency 0 is 0.
#[must_use]
pub fn resample_spectrum(image: &Raster, width: usize, height: usize) -> Vec<f64> {
    let mean = image.mean();
    let (w, h) = (image.width, image.height);
    let centred: Vec<f64> = image.values.iter().map(|v| v - mean).collect();
    let spectrum = Fft2::new(w, h).spectrum(&centred);
    // Variance is Σ|X|²/N² over N bins; a grid with N' bins needs |X'|² = |X|² N'/N.
    let gain = (width * height) as f64 / (w * h) as f64;
    let power = |kx: isize, ky: isize| {
        spectrum[kx.rem_euclid(w as isize) as usize * h + ky.rem_euclid(h as isize) as usize].norm_sqr()
    };
    let mut out = Vec::with_capacity(width * height);
    for kx in 0..width {
        let fx = signed_bin(kx, width) as f64 * w as f64 / width as f64;
        for ky in 0..height {
            let fy = signed_bin(ky, height) as f64 * h as f64 / height as f64;
            let (x, y) = (fx.floor(), fy.floor());
            let (ax, ay) = (fx - x, fy - y);
            let (x, y) = (x as isize, y as isize);
            let low = (1.0 - ax) * power(x, y) + ax * power(x + 1, y);
            let high = if ay == 0.0 { 0.0 } else { (1.0 - ax) * power(x, y + 1) + ax * power(x + 1, y + 1) };
            out.push((gain * ((1.0 - ay) * low + ay * high)).sqrt());
        }
    }
    out[0] = 0.0;
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(width: usize, height: usize) -> Raster {
        Raster::from_fn(width, height, |x, y| {
            let (u, v) = (x as f64 / width as f64, y as f64 / height as f64);
            0.4 + (TAU * 3.0 * u).cos() + 0.5 * (TAU * (2.0 * v - u)).sin()
        })
    }

    #[test]
    fn a_band_limited_image_is_the_same_on_any_grid() {
        for (width, height) in [(96, 40), (33, 17), (64, 64)] {
            let made = resample(&wave(64, 48), width, height);
            let exact = wave(width, height);
            for (a, b) in made.values.iter().zip(&exact.values) {
                assert!((a - b).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn equal_sizes_keep_the_amplitudes_and_others_the_variance() {
        let image = wave(64, 48);
        let spectrum = Fft2::new(64, 48).spectrum(&image.values);
        let same = resample_spectrum(&image, 64, 48);
        assert!(same.iter().zip(&spectrum).skip(1).all(|(a, b)| (a - b.norm()).abs() < 1e-9));
        let variance = |a: &[f64]| a.iter().map(|v| v * v).sum::<f64>() / (a.len() as f64).powi(2);
        let other = resample_spectrum(&image, 128, 96);
        assert!((variance(&other) / variance(&same) - 1.0).abs() < 1e-9);
    }
}
