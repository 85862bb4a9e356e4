//! The waves of an image that tiles, weighed and made an image again.
//!
//! ```text
//! image'(x) = Σ_k g(|ω_x|, |ω_y|) X(k) e^(i ω·x) / (width · height)        ω = 2π k / size, radians per texel
//! ```
//! A gain that is the same for a wave and its mirror images is asked for a quarter of the waves,
//! and half of them are kept: X(−k) = conj X(k).

use crate::fft2::{RealFft2, Workspace};
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex64;
use asperity_surface::raster::Raster;
use std::f64::consts::TAU;

/// One wave of an image, standing for its conjugate as well.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wave {
    /// Radians per texel along u, 0 … π.
    pub wx: f64,
    /// Radians per texel along v, −π … π.
    pub wy: f64,
    /// |X|².
    pub power: f64,
    /// Number of waves of the whole spectrum that it stands for, 1 or 2.
    pub count: f64,
}

impl Wave {
    /// Radians per texel.
    pub fn frequency(&self) -> f64 {
        length(self.wx, self.wy)
    }
}

/// Half the spectrum of an image.
#[derive(Debug)]
pub(crate) struct Waves {
    fft: RealFft2,
    work: Workspace,
    half: Vec<Complex64>,
}

impl Waves {
    /// The waves of an image of at least one texel.
    pub fn of(image: &Raster) -> Self {
        let fft = RealFft2::new(&mut FftPlanner::new(), image.width, image.height);
        let mut work = Workspace::default();
        let mut half = Vec::with_capacity(fft.half_columns() * fft.height());
        fft.forward(&image.values, fft.half_columns(), &mut work, |_, column| half.extend_from_slice(column));
        Self { fft, work, half }
    }

    /// Calls `take` with every wave but the mean.
    pub fn each(&self, mut take: impl FnMut(Wave)) {
        let (w, h) = (self.fft.width(), self.fft.height());
        for (kx, column) in self.half.chunks_exact(h).enumerate() {
            let (wx, count) = (step(w) * kx as f64, if (2 * kx).is_multiple_of(w) { 1.0 } else { 2.0 });
            for (ky, value) in column.iter().enumerate().skip(usize::from(kx == 0)) {
                let wy = step(h) * if ky > h / 2 { ky as f64 - h as f64 } else { ky as f64 };
                take(Wave { wx, wy, power: value.norm_sqr(), count });
            }
        }
    }

    /// The image whose waves are `gain(|ω_x|, |ω_y|)` times as strong.
    pub fn weighed(&mut self, mut gain: impl FnMut(f64, f64) -> f64) -> Raster {
        let (width, height) = (self.fft.width(), self.fft.height());
        let scale = 1.0 / self.fft.len() as f64;
        let mut gains = vec![0.0; height / 2 + 1];
        let mut values = Vec::new();
        let Self { fft, work, half } = self;
        fft.inverse_unscaled(fft.half_columns(), work, &mut values, |kx, column| {
            let wx = step(width) * kx as f64;
            for (ky, weight) in gains.iter_mut().enumerate() {
                *weight = scale * gain(wx, step(height) * ky as f64);
            }
            let own = &half[kx * height..][..height];
            let mirrored = gains[1..height.div_ceil(2)].iter().rev();
            for ((to, value), weight) in column.iter_mut().zip(own).zip(gains.iter().chain(mirrored)) {
                *to = value * *weight;
            }
        });
        Raster { width, height, values }
    }

    /// The image whose waves of |ω| radians a texel are `gain(|ω|)` times as strong.
    pub fn weighed_by_frequency(&mut self, mut gain: impl FnMut(f64) -> f64) -> Raster {
        self.weighed(|wx, wy| gain(length(wx, wy)))
    }
}

/// Not `hypot`: frequencies neither overflow nor vanish, and it takes ten times as long.
fn length(wx: f64, wy: f64) -> f64 {
    (wx * wx + wy * wy).sqrt()
}

/// Radians a texel between neighbouring waves over `n` texels.
fn step(n: usize) -> f64 {
    TAU / n as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fft2::{Fft2, angular_frequency};
    use asperity_dsp::rng::Rng;

    const SIZES: [(usize, usize); 7] = [(1, 1), (2, 1), (1, 5), (8, 12), (15, 9), (33, 20), (64, 31)];

    fn noise(width: usize, height: usize) -> Raster {
        let mut rng = Rng::new(8);
        Raster::from_fn(width, height, |_, _| rng.normal())
    }

    #[test]
    fn weighing_half_the_waves_is_weighing_all_of_them() {
        for (w, h) in SIZES {
            let image = noise(w, h);
            let gain = |wx: f64, wy: f64| 0.3 + wx.cos() * (1.0 + wy.abs());
            let mut fft = Fft2::new(w, h);
            let mut spectrum = fft.spectrum(&image.values);
            for (place, value) in spectrum.iter_mut().enumerate() {
                *value *= gain(angular_frequency(place / h, w), angular_frequency(place % h, h));
            }
            let expected = fft.image(&mut spectrum);
            let found = Waves::of(&image).weighed(gain);
            let worst = found.values.iter().zip(&expected.values).map(|(a, b)| (a - b).abs());
            assert!(worst.fold(0.0, f64::max) < 1e-12, "{w} × {h}");
        }
    }

    #[test]
    fn the_waves_have_the_power_of_the_image_about_its_mean() {
        for (w, h) in SIZES {
            let image = noise(w, h);
            let (mean, texels) = (image.mean(), (w * h) as f64);
            let (mut power, mut count) = (0.0, 0.0);
            Waves::of(&image).each(|wave| {
                power += wave.power * wave.count / texels;
                count += wave.count;
            });
            let expected = image.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
            assert!((power - expected).abs() < 1e-9 && count == texels - 1.0, "{w} × {h}");
        }
    }
}
