//! Power law of the ground under a tip.
//!
//! ```text
//! S(q) = a² c q^−α, flat beyond the outer scale; each octave less what the tip does not follow
//! ```
//! Gauss–Newton over exponent and level for every outer scale, at once or over octaves; an outer
//! scale has to earn its place.

use crate::db;
use crate::octave_noise::{kernel_origin, octave_kernel, wavelength_m};
use crate::relief::{Band, wavenumber};
use asperity_dsp::fractal_noise::{OCTAVES, Relief, growth};

/// Power law of the ground under a tip: S(q) ∝ q^−α from the outer scale down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerLaw {
    /// Exponent α of the ground, before a tip rides on it.
    pub alpha: f64,
    /// Its standard error.
    pub alpha_se: f64,
    /// Rms of the octave about 1 mm of the ground, m.
    pub at_1mm_m: f64,
    /// Wavelength above which the spectrum is flat, m; none was seen where it is ∞.
    pub outer_scale_m: f64,
    /// True where it turns flat over octaves, as the engine's law does, and not at once.
    pub is_gradual: bool,
}

/// Wavelength at which a power law has its level, m.
const PINNED_M: f64 = 1e-3;

impl PowerLaw {
    /// Share of an octave's amplitude that a tip follows.
    #[must_use]
    pub fn followed(&self, wavelength_m: f64, tip_radius_m: f64) -> f64 {
        let roughness = ((2.5 - self.alpha) / 1.5).clamp(0.0, 1.0);
        let relief = Relief {
            rms_at_1mm_m: self.at_1mm_m / growth(roughness),
            outer_scale_m: f64::INFINITY,
            tip_radius_m,
            longest_wavelength_m: f64::INFINITY,
        };
        relief.share(wavelength_m, roughness) / growth(roughness)
    }

    /// Density of the felt height under a tip, m³: the engine's octaves, each as broad as its noise
    /// is.
    fn density_under(&self, q: f64, tip_radius_m: f64) -> f64 {
        let kernel = octave_kernel();
        let mut density = 0.0;
        for octave in 0..OCTAVES {
            let wavelength_m = wavelength_m(octave);
            let place = 10.0 * (q * wavelength_m).log10() + kernel_origin();
            let below = place.floor();
            if below < 0.0 || below as usize + 1 >= kernel.len() {
                continue;
            }
            let (a, b) = (kernel[below as usize].max(1e-12), kernel[below as usize + 1].max(1e-12));
            let shape = a * (b / a).powf(place - below);
            let beyond = wavelength_m / self.outer_scale_m;
            let flat = if self.is_gradual { (1.0 + beyond * beyond).sqrt() } else { beyond.max(1.0) };
            let rms_m = self.at_1mm_m
                * (wavelength_m / PINNED_M).powf(0.5 * (self.alpha - 1.0))
                * flat.powf(-0.5 * self.alpha)
                * self.followed(wavelength_m, tip_radius_m);
            density += rms_m * rms_m * wavelength_m * shape;
        }
        density
    }

    /// Density of the felt height in a third octave, dB re 1 m³.
    #[must_use]
    pub fn level_db(&self, band: usize, tip_radius_m: f64) -> f64 {
        let q = wavenumber(band);
        let knee = 1.0 / self.outer_scale_m;
        let flat = |q: f64| if self.is_gradual { q.hypot(knee) } else { q.max(knee) };
        // Rms of an octave about 1 mm: ∫ S dq from q/√2 to q√2.
        let octave = octave_integral(self.alpha) / PINNED_M;
        if tip_radius_m > 0.0 {
            return db(self.density_under(q, tip_radius_m));
        }
        db(self.at_1mm_m.powi(2) / octave) - 10.0 * self.alpha * (flat(q) * PINNED_M).log10()
    }

    /// Law through the bands, and what a tip of this radius leaves of it.
    #[must_use]
    pub fn through(bands: &[Band], tip_radius_m: f64) -> Self {
        let mut best: Option<(f64, Self)> = None;
        let longest = bands.first().map_or(0, |band| band.band);
        let knees = (longest..longest + 12).map(|band| 1.0 / wavenumber(band));
        let scales = std::iter::once((f64::INFINITY, false))
            .chain(knees.flat_map(|scale_m| [(scale_m, false), (scale_m, true)]));
        for (outer_scale_m, is_gradual) in scales {
            let (misfit, law) = Self::fitted(bands, tip_radius_m, outer_scale_m, is_gradual);
            // An outer scale is a constant more: it has to earn it.
            let misfit = misfit + if outer_scale_m.is_finite() { 9.0 } else { 0.0 };
            if best.as_ref().is_none_or(|(least, _)| misfit < *least) {
                best = Some((misfit, law));
            }
        }
        best.map_or(
            Self {
                alpha: 2.0,
                alpha_se: f64::INFINITY,
                at_1mm_m: 0.0,
                outer_scale_m: f64::INFINITY,
                is_gradual: false,
            },
            |(_, law)| law,
        )
    }

    /// Gauss–Newton over exponent and level.
    fn fitted(bands: &[Band], tip_radius_m: f64, outer_scale_m: f64, is_gradual: bool) -> (f64, Self) {
        let pinned = bands.iter().min_by_key(|band| band.band.abs_diff(30));
        let level_m = pinned.map_or(1e-6, |band| 10f64.powf(0.05 * band.level_db) * 20.0);
        let mut law =
            Self { alpha: 2.0, alpha_se: f64::INFINITY, at_1mm_m: level_m, outer_scale_m, is_gradual };
        let mut misfit = f64::INFINITY;
        for _ in 0..30 {
            let mut normal = [0.0f64; 5];
            misfit = 0.0;
            for band in bands {
                let weight = band.se_db.hypot(0.1).powi(-2);
                let at = |law: &Self| law.level_db(band.band, tip_radius_m);
                let own = at(&law);
                let by_alpha = (at(&Self { alpha: law.alpha + 0.01, ..law }) - own) / 0.01;
                let by_level = at(&Self { at_1mm_m: law.at_1mm_m * 10f64.powf(0.005), ..law }) - own;
                let by_level = by_level / 0.1;
                let beside = band.level_db - own;
                // Far under a tip the law of the tip is a guess.
                let seen = law.followed(1.0 / wavenumber(band.band), tip_radius_m);
                let weight = if seen > 0.3 { weight } else { 0.0 };
                normal[0] += weight * by_alpha * by_alpha;
                normal[1] += weight * by_alpha * by_level;
                normal[2] += weight * by_level * by_level;
                normal[3] += weight * by_alpha * beside;
                normal[4] += weight * by_level * beside;
                misfit += weight * beside * beside;
            }
            let [aa, al, ll, a, l] = normal;
            let determinant = (aa * ll - al * al).max(1e-12);
            let step = [(ll * a - al * l) / determinant, (aa * l - al * a) / determinant];
            law.alpha = (law.alpha + step[0].clamp(-0.5, 0.5)).clamp(-1.0, 5.0);
            law.at_1mm_m *= 10f64.powf(0.05 * step[1].clamp(-10.0, 10.0));
            law.alpha_se = (ll / determinant).sqrt();
            if step[0].abs() < 1e-5 && step[1].abs() < 1e-4 {
                break;
            }
        }
        (misfit, law)
    }
}

/// ∫ q^−α dq over an octave about 1.
fn octave_integral(alpha: f64) -> f64 {
    let half = std::f64::consts::SQRT_2;
    if (alpha - 1.0).abs() < 1e-9 {
        return 2f64.ln();
    }
    (half.powf(1.0 - alpha) - half.powf(alpha - 1.0)) / (1.0 - alpha)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octave_noise::octave_spectrum;
    use asperity_dsp::fractal_noise::{FractalNoise, OctaveWeights};

    // The engine's own noise, its octaves weighed for a tip.
    #[test]
    fn the_slope_of_the_ground_is_found_under_a_tip() {
        let field = FractalNoise::new(5);
        for roughness in [0.0, 0.3, 0.6, 1.0] {
            for tip_radius_m in [0.0, 0.4e-3, 1.6e-3, 3e-3] {
                let alpha = FractalNoise::alpha(roughness);
                let weights = OctaveWeights::new(&Relief {
                    rms_at_1mm_m: 10e-6 / growth(roughness),
                    outer_scale_m: 0.01,
                    tip_radius_m,
                    longest_wavelength_m: f64::INFINITY,
                });
                let spectra: Vec<Vec<f64>> =
                    (0..OCTAVES).map(|i| octave_spectrum(&field, &weights, roughness, i, 17..42)).collect();
                let bands: Vec<Band> = (17..42)
                    .map(|band| {
                        let sum = spectra.iter().map(|spectrum| spectrum[band - 17]).sum();
                        Band { band, level_db: db(sum), se_db: 0.2 }
                    })
                    .collect();
                let law = PowerLaw::through(&bands, tip_radius_m);
                // What a tip leaves of the octaves hides their slope, and the engine's weights are
                // polynomials of R within half a decibel.
                let bound = if tip_radius_m > 0.0 { 0.25 } else { 0.1 };
                let beside = law.alpha - alpha;
                assert!(
                    beside.abs() < bound,
                    "R {roughness}, tip {tip_radius_m} m: {} for {alpha}",
                    law.alpha
                );
            }
        }
    }
}
