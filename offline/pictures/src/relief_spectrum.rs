//! Relief spectrum, from profiles across a surface: exponent, roughness and micro-relief.
//!
//! ```text
//! P(f) = A f^(−α) e^(−(2πσf)²)        least squares over ln P in thirds of an octave
//! R = (2.5 − α)/1.5        D = (7 − α)/2        rms² of an octave at λ = ∫ A f^(−α) df over λ/√2 … λ√2
//! ```
//! | symbol | here |
//! |---|---|
//! | P(f) | power of profiles along rows and along columns, mean of both |
//! | σ | blur of lens and demosaicing, texels, 0 … [`MOST_BLUR_PX`]: so that R is the surface's and not the lens' |
//! | α | Hasti's exponent of the overlay, α = 2.5 − 1.5 R |
//!
//! The engine's overlay begins where a map ends, at two texels, so its level is taken at the map's
//! fine end ([`FINE_OCTAVE_PX`]) and carried to the octave at 1 mm, where it is stated, by the
//! overlay's own law: both join.

use crate::borders::{Borders, SplitBorders};
use crate::fft2::signed_bin;
use crate::waves::Waves;
use asperity_dsp::fractal_noise::FractalNoise;
use asperity_surface::raster::Raster;
use std::f64::consts::{SQRT_2, TAU};

/// Wavelength at which the engine's micro-noise is calibrated, m.
pub const MICRO_WAVELENGTH_M: f64 = 1e-3;
/// Centre of the octave that the micro-relief continues, texels.
pub const FINE_OCTAVE_PX: f64 = 4.0;
/// Widest blur that is taken for a lens', standard deviation in texels. Assumed.
pub const MOST_BLUR_PX: f64 = 1.2;
/// Wavelengths the law is fitted to, texels; at most a third of the shorter side.
const FITTED_PX: [f64; 2] = [2.5, 32.0];
/// Bands an octave.
const PER_OCTAVE: f64 = 3.0;
/// Fewest bands that give a law.
const LEAST_BANDS: usize = 4;
/// Standard deviation of the window of the roughness map, texels.
const WINDOW_PX: usize = 24;
/// Share of the mean power below which a place says nothing about its own exponent.
const FAINT: f64 = 0.05;

/// The law of a relief's profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliefSpectrum {
    /// α of 1/f^α, as fitted; a real surface's is between 1 and 4.
    pub exponent: f64,
    /// ln A: power at one cycle per texel.
    level: f64,
}

impl ReliefSpectrum {
    /// The law of heights (texels), or `None` when they are flat or too few.
    #[must_use]
    pub fn of(heights_px: &Raster) -> Option<Self> {
        let points = bands(heights_px);
        if points.len() < LEAST_BANDS {
            return None;
        }
        let most = MOST_BLUR_PX * MOST_BLUR_PX;
        let free = fit(&points, None);
        let blur = free[2].clamp(0.0, most);
        let [level, exponent, _] = if blur == free[2] { free } else { fit(&points, Some(blur)) };
        Some(Self { exponent, level })
    }

    /// Roughness R, 0–1.
    #[must_use]
    pub fn roughness(&self) -> f64 {
        FractalNoise::roughness(self.exponent)
    }

    /// Dimension D of the surface, 2–3.
    #[must_use]
    pub fn dimension(&self) -> f64 {
        ((7.0 - self.exponent) / 2.0).clamp(2.0, 3.0)
    }

    /// Rms of a profile in the octave at 1 mm that makes the engine's overlay continue this relief
    /// below two texels, in texels of height, for texels of `texel_m`.
    #[must_use]
    pub fn micro_relief_px(&self, texel_m: f64) -> f64 {
        let (low, high) = (1.0 / (FINE_OCTAVE_PX * SQRT_2), SQRT_2 / FINE_OCTAVE_PX);
        let steep = 1.0 - self.exponent;
        let integral =
            if steep.abs() < 1e-6 { (high / low).ln() } else { (high.powf(steep) - low.powf(steep)) / steep };
        let rms = (self.level.exp() * integral).sqrt();
        let overlay = FractalNoise::alpha(self.roughness());
        rms * (MICRO_WAVELENGTH_M / (FINE_OCTAVE_PX * texel_m)).powf(0.5 * (overlay - 1.0))
    }

    /// R place by place: the whole relief's, moved by how the octaves at 6 and 12 texels compare
    /// there.
    #[must_use]
    pub fn roughness_map(&self, heights_px: &Raster) -> Raster {
        let (w, h) = (heights_px.width, heights_px.height);
        let periodic = SplitBorders::of(heights_px, Borders::Detect).periodic;
        let mut waves = Waves::of(&periodic);
        drop(periodic);
        let window = WINDOW_PX.min(w.min(h) / 4).max(2);
        let mut energy = |centre_px: f64| {
            let mut local = waves.weighed_by_frequency(|r| octave(r, centre_px));
            local.values.iter_mut().for_each(|z| *z *= *z);
            let local = blurred(local, window);
            let mean = local.mean();
            (local, mean)
        };
        let (fine, fine_mean) = energy(6.0);
        let (mut map, coarse_mean) = energy(12.0);
        if fine_mean <= 0.0 || coarse_mean <= 0.0 {
            return Raster::constant(w, h, self.roughness());
        }
        for (coarse, fine) in map.values.iter_mut().zip(&fine.values) {
            let ratio = (*coarse / coarse_mean + FAINT) / (fine / fine_mean + FAINT);
            *coarse = FractalNoise::roughness(self.exponent + ratio.log2());
        }
        map
    }
}

/// (ln f, ω², ln P) of bands of a third of an octave that have power.
fn bands(heights_px: &Raster) -> Vec<[f64; 3]> {
    let (w, h) = (heights_px.width, heights_px.height);
    let periodic = SplitBorders::of(heights_px, Borders::Detect).periodic;
    let waves = Waves::of(&periodic);
    drop(periodic);
    let longest = FITTED_PX[1].min(w.min(h) as f64 / 3.0);
    let count = ((longest / FITTED_PX[0]).log2() * PER_OCTAVE).floor().max(0.0) as usize;
    // Sums of power and of waves along rows and along columns.
    let mut sums = vec![[[0.0_f64; 2]; 2]; count];
    let band = |k: usize, n: usize| {
        let bin = signed_bin(k, n).unsigned_abs() as f64;
        let band = ((n as f64 / bin) / FITTED_PX[0]).log2() * PER_OCTAVE;
        (bin > 0.0 && band >= 0.0 && (band as usize) < count).then_some(band as usize)
    };
    let bands_of = |n: usize| (0..n).map(|k| band(k, n)).collect::<Vec<_>>();
    let (along_rows, along_columns) = (bands_of(w), bands_of(h));
    waves.each(|wave| {
        let power = wave.power * wave.count;
        let bin = |frequency: f64, n: usize| (frequency.abs() / TAU * n as f64 + 0.5) as usize;
        if let Some(band) = along_rows[bin(wave.wx, w)] {
            sums[band][0][0] += power;
        }
        if let Some(band) = along_columns[bin(wave.wy, h)] {
            sums[band][1][0] += power;
        }
    });
    along_rows.iter().flatten().for_each(|&band| sums[band][0][1] += 1.0);
    along_columns.iter().flatten().for_each(|&band| sums[band][1][1] += 1.0);
    // Two-sided power of a bin, times 2 n for one side per cycle per texel.
    let scale = 2.0 / (w as f64 * h as f64).powi(2);
    let power =
        |[power, bins]: [f64; 2], n: usize| if bins > 0.0 { power / bins * scale * n as f64 } else { 0.0 };
    let points = sums.iter().enumerate().map(|(band, &[rows, columns])| {
        let f = 1.0 / (FITTED_PX[0] * ((band as f64 + 0.5) / PER_OCTAVE).exp2());
        let mean = 0.5 * (power(rows, w) + power(columns, h));
        [f.ln(), (TAU * f).powi(2), mean]
    });
    points.filter(|p| p[2] > f64::MIN_POSITIVE).map(|[f, w2, p]| [f, w2, p.ln()]).collect()
}

/// (ln A, α, σ²) of least squares; σ² is kept when it is given.
fn fit(points: &[[f64; 3]], blur: Option<f64>) -> [f64; 3] {
    let n = points.len() as f64;
    let given = blur.unwrap_or(0.0);
    let mean = |value: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(value).sum::<f64>() / n;
    let x = |p: &[f64; 3]| -p[0];
    let z = |p: &[f64; 3]| -p[1];
    let y = |p: &[f64; 3]| p[2] + given * p[1];
    let (mx, mz, my) = (mean(&x), mean(&z), mean(&y));
    let dot = |a: &dyn Fn(&[f64; 3]) -> f64, ma: f64, b: &dyn Fn(&[f64; 3]) -> f64, mb: f64| {
        points.iter().map(|p| (a(p) - ma) * (b(p) - mb)).sum::<f64>()
    };
    let (xx, xz, zz) = (dot(&x, mx, &x, mx), dot(&x, mx, &z, mz), dot(&z, mz, &z, mz));
    let (xy, zy) = (dot(&x, mx, &y, my), dot(&z, mz, &y, my));
    let (exponent, square) = match blur {
        Some(given) => (xy / xx, given),
        None => {
            let determinant = xx * zz - xz * xz;
            ((xy * zz - zy * xz) / determinant, (zy * xx - xy * xz) / determinant)
        }
    };
    let rest = if blur.is_some() { 0.0 } else { square * mz };
    [my - exponent * mx - rest, exponent, square]
}

/// Share of a wave of so many radians a texel in the octave about a wavelength, fading smoothly.
fn octave(frequency: f64, centre_px: f64) -> f64 {
    let octaves = (frequency * centre_px / TAU).max(1e-9).log2();
    (-0.5 * (octaves / 0.4).powi(2)).exp()
}

/// A blur of this standard deviation: three moving means, mirrored at the borders.
fn blurred(mut raster: Raster, deviation: usize) -> Raster {
    let (w, h) = (raster.width, raster.height);
    // Three boxes of 2r + 1 have the variance (2r + 1)² / 4, nearly.
    let radius = deviation.min(w / 2).min(h / 2).max(1);
    raster.values.chunks_exact_mut(w).for_each(|row| three_moving_means(row, radius));
    let mut turned = raster.transposed();
    turned.values.chunks_exact_mut(h).for_each(|column| three_moving_means(column, radius));
    turned.transposed()
}

fn three_moving_means(line: &mut [f64], radius: usize) {
    // The line with what is mirrored at both ends.
    let mut wide = vec![0.0; line.len() + 2 * radius];
    for _ in 0..3 {
        let n = line.len();
        wide[radius..radius + n].copy_from_slice(line);
        for i in 0..radius {
            (wide[radius - 1 - i], wide[radius + n + i]) = (line[i], line[n - 1 - i]);
        }
        let mut sum: f64 = wide[..2 * radius].iter().sum();
        let share = 1.0 / (2 * radius + 1) as f64;
        for (mean, ends) in line.iter_mut().zip(wide.windows(2 * radius + 1)) {
            sum += ends[2 * radius];
            *mean = sum * share;
            sum -= ends[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fft2::{Fft2, angular_frequency};
    use asperity_dsp::rng::Rng;
    use asperity_fft::num_complex::Complex64;

    /// Heights whose profiles go as 1/f^α, blurred by a lens.
    fn relief(n: usize, exponent: f64, blur_px: f64, seed: u64) -> Raster {
        let mut rng = Rng::new(seed);
        let noise = Raster::from_fn(n, n, |_, _| rng.normal());
        let mut fft = Fft2::new(n, n);
        let mut spectrum = fft.spectrum(&noise.values);
        spectrum[0] = Complex64::default();
        for (place, value) in spectrum.iter_mut().enumerate().skip(1) {
            let r = angular_frequency(place / n, n).hypot(angular_frequency(place % n, n));
            *value *= r.powf(-0.5 * (exponent + 1.0)) * (-0.5 * (r * blur_px).powi(2)).exp();
        }
        fft.image(&mut spectrum)
    }

    #[test]
    fn a_lens_does_not_make_a_rough_surface_smooth() {
        for exponent in [1.3, 1.75, 2.2] {
            for blur_px in [0.0, 0.6, 1.0] {
                let found = ReliefSpectrum::of(&relief(256, exponent, blur_px, 3)).unwrap().exponent;
                assert!((found - exponent).abs() < 0.45, "α {exponent}, blur {blur_px}: {found}");
            }
        }
    }

    #[test]
    fn micro_relief_is_the_rms_of_the_octave_at_one_millimetre() {
        // Texels of 0.25 mm: the fine octave is the one at 1 mm.
        let heights = relief(256, 2.0, 0.0, 4);
        let given = ReliefSpectrum::of(&heights).unwrap().micro_relief_px(0.25e-3);
        let n = 256;
        let mut fft = Fft2::new(n, n);
        let mut spectrum = fft.spectrum(&heights.values);
        for (place, value) in spectrum.iter_mut().enumerate() {
            let cycles = angular_frequency(place / n, n).abs() / TAU;
            if !(0.25 / SQRT_2..0.25 * SQRT_2).contains(&cycles) {
                *value = Complex64::default();
            }
        }
        let rows = fft.image(&mut spectrum);
        let rms = (rows.values.iter().map(|z| z * z).sum::<f64>() / (n * n) as f64).sqrt();
        assert!((given / rms - 1.0).abs() < 0.15, "{given} and {rms}");
    }

    #[test]
    fn a_relief_map_in_two_halves_shows_both_without_border_strips() {
        let (smooth, rough) = (relief(256, 2.4, 0.0, 7), relief(256, 1.2, 0.0, 8));
        let both = Raster::from_fn(256, 256, |x, y| if x < 128 { smooth.at(x, y) } else { rough.at(x, y) });
        let map = ReliefSpectrum::of(&both).unwrap().roughness_map(&both);
        let mean = |from: usize, to: usize| {
            let cells = (0..256).flat_map(|y| (from..to).map(move |x| (x, y)));
            cells.map(|(x, y)| map.at(x, y)).sum::<f64>() / (256 * (to - from)) as f64
        };
        assert!(mean(32, 96) + 0.2 < mean(160, 224), "{} and {}", mean(32, 96), mean(160, 224));
        assert!((mean(252, 256) - mean(200, 240)).abs() < 0.25);
        let steps = map.values.windows(2).enumerate().filter(|(i, _)| (i + 1) % 256 != 0);
        let steepest = steps.map(|(_, pair)| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(steepest < 0.1, "a step of {steepest}: a window's edge");
    }

    #[test]
    fn a_flat_relief_has_no_law() {
        assert_eq!(ReliefSpectrum::of(&Raster::constant(64, 64, 1.0)), None);
    }
}
