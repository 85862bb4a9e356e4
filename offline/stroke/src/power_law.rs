//! Power law of the ground under a tip.
//!
//! ```text
//! S(q) = a² c q^−α, flat beyond the outer scale; under a tip the engine's own octaves
//! ```
//! Gauss–Newton over exponent, level and outer scale. Under a tip a law without an outer scale
//! would put the flat long waves down to the exponent; bare ground may have none, so there the
//! scale, sharp or gradual, has to earn its place.

use crate::db;
use crate::octave_noise::{octave_shape, wavelength_m};
use crate::relief::{Band, wavenumber};
use asperity_dsp::fractal_noise::{FractalNoise, OCTAVES, OctaveWeights, Relief, growth};
use nalgebra::{Matrix3, Vector3};

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
/// Share of the amplitude that a tip must follow for a band to count.
const LEAST_FOLLOWED: f64 = 0.3;

impl PowerLaw {
    /// Share of an octave's amplitude that a tip follows.
    fn followed(&self, wavelength_m: f64, tip_radius_m: f64) -> f64 {
        let roughness = self.roughness();
        let relief = self.relief(f64::INFINITY, tip_radius_m);
        relief.share(wavelength_m, roughness) / growth(roughness)
    }

    /// Roughness whose exponent is the nearest.
    #[must_use]
    pub fn roughness(&self) -> f64 {
        FractalNoise::roughness(self.alpha)
    }

    fn relief(&self, outer_scale_m: f64, tip_radius_m: f64) -> Relief {
        Relief {
            rms_at_1mm_m: self.at_1mm_m / growth(self.roughness()),
            outer_scale_m,
            tip_radius_m,
            longest_wavelength_m: f64::INFINITY,
        }
    }

    /// Rms squared of the engine's octaves under a tip, times their wavelengths, m³.
    fn octaves(&self, tip_radius_m: f64) -> [f64; OCTAVES] {
        let roughness = self.roughness();
        let rms_m = OctaveWeights::new(&self.relief(self.outer_scale_m, tip_radius_m)).rms_m(roughness);
        // Exponents beyond those of a roughness.
        let rising = self.alpha - FractalNoise::alpha(roughness);
        std::array::from_fn(|i| {
            let wave_m = wavelength_m(i);
            rms_m[i] * rms_m[i] * (wave_m / PINNED_M).powf(rising) * wave_m
        })
    }

    /// Density of the ground itself in a third octave, dB re 1 m³.
    fn bare_db(&self, band: usize) -> f64 {
        let q = wavenumber(band);
        let knee = 1.0 / self.outer_scale_m;
        let flat = if self.is_gradual { q.hypot(knee) } else { q.max(knee) };
        // Rms of an octave about 1 mm: ∫ S dq from q/√2 to q√2.
        let octave = octave_integral(self.alpha) / PINNED_M;
        db(self.at_1mm_m.powi(2) / octave) - 10.0 * self.alpha * (flat * PINNED_M).log10()
    }

    /// Law through the bands, and what a tip of this radius leaves of it.
    #[must_use]
    pub fn through(bands: &[Band], tip_radius_m: f64) -> Self {
        let seen = Seen::new(bands, tip_radius_m);
        let longest = bands.first().map_or(0, |band| band.band);
        let scale_m = |further: usize| 1.0 / wavenumber(longest + further);
        let least = |best: (f64, Self), now: (f64, Self)| if now.0 < best.0 { now } else { best };
        // The engine's octaves turn flat over octaves, not at once.
        let [first, others @ ..] = [2, 6, 10].map(|further| seen.fitted(scale_m(further), true));
        let gradual = others.into_iter().fold(first, least);
        if tip_radius_m > 0.0 {
            return gradual.1;
        }
        // An outer scale is a constant more: it has to earn it.
        const EARNED: f64 = 9.0;
        let bare = seen.fitted(f64::INFINITY, false);
        let knees = (0..12).map(|further| seen.fitted(scale_m(further), false));
        let best = knees.fold(gradual, least);
        // One that explains more, but has not earned its place, leaves a doubt.
        let law = if best.0 + EARNED < bare.0 { best.1 } else { bare.1 };
        let doubt = if best.0 < bare.0 { (best.1.alpha - law.alpha).abs() } else { 0.0 };
        Self { alpha_se: law.alpha_se.hypot(doubt), ..law }
    }
}

/// Bands that a law is laid through.
struct Seen<'a> {
    bands: &'a [Band],
    tip_radius_m: f64,
    /// Density of each of the engine's octaves over its rms squared and wavelength, in each band.
    shapes: Vec<[f64; OCTAVES]>,
}

impl<'a> Seen<'a> {
    fn new(bands: &'a [Band], tip_radius_m: f64) -> Self {
        let shapes =
            |band: &Band| std::array::from_fn(|i| octave_shape(wavenumber(band.band) * wavelength_m(i)));
        let shapes = if tip_radius_m > 0.0 { bands.iter().map(shapes).collect() } else { Vec::new() };
        Self { bands, tip_radius_m, shapes }
    }

    /// Levels of the bands, dB re 1 m³: each octave as broad as the engine's noise is.
    fn levels_db(&self, law: &PowerLaw) -> Vec<f64> {
        if self.shapes.is_empty() {
            return self.bands.iter().map(|band| law.bare_db(band.band)).collect();
        }
        let octaves = law.octaves(self.tip_radius_m);
        let level = |shapes: &[f64; OCTAVES]| db(shapes.iter().zip(&octaves).map(|(a, b)| a * b).sum());
        self.shapes.iter().map(level).collect()
    }

    /// Gauss–Newton over exponent, level and, where it turns flat gradually, outer scale.
    fn fitted(&self, outer_scale_m: f64, is_gradual: bool) -> (f64, PowerLaw) {
        let pinned = self.bands.iter().min_by_key(|band| band.band.abs_diff(30));
        let level_m = pinned.map_or(1e-6, |band| 10f64.powf(0.05 * band.level_db) * 20.0);
        let mut law =
            PowerLaw { alpha: 2.0, alpha_se: f64::INFINITY, at_1mm_m: level_m, outer_scale_m, is_gradual };
        let moved = |law: &PowerLaw, step: Vector3<f64>| PowerLaw {
            alpha: (law.alpha + step[0].clamp(-0.5, 0.5)).clamp(-1.0, 5.0),
            at_1mm_m: law.at_1mm_m * 10f64.powf(0.05 * step[1].clamp(-10.0, 10.0)),
            outer_scale_m: if is_gradual {
                (law.outer_scale_m * step[2].clamp(-0.5, 0.5).exp()).clamp(1e-4, 10.0)
            } else {
                law.outer_scale_m
            },
            ..*law
        };
        let mut misfit = f64::INFINITY;
        for _ in 0..30 {
            let own = self.levels_db(&law);
            const BY: f64 = 0.01;
            let other = |i: usize| self.levels_db(&moved(&law, Vector3::ith(i, BY)));
            let free = if is_gradual { 3 } else { 2 };
            let others: Vec<Vec<f64>> = (0..free).map(other).collect();
            let (mut normal, mut right) = (Matrix3::identity() * 1e-9, Vector3::zeros());
            misfit = 0.0;
            for (k, band) in self.bands.iter().enumerate() {
                // Far under a tip the law of the tip is a guess.
                if law.followed(1.0 / wavenumber(band.band), self.tip_radius_m) < LEAST_FOLLOWED {
                    continue;
                }
                let mut by = Vector3::zeros();
                others.iter().enumerate().for_each(|(i, other)| by[i] = (other[k] - own[k]) / BY);
                let (weight, beside) = (band.se_db.hypot(0.1).powi(-2), band.level_db - own[k]);
                normal += weight * by * by.transpose();
                right += weight * beside * by;
                misfit += weight * beside * beside;
            }
            let Some(inverse) = normal.try_inverse() else { break };
            let step = inverse * right;
            law = PowerLaw { alpha_se: inverse[(0, 0)].sqrt(), ..moved(&law, step) };
            if step.abs().max() < 1e-4 {
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

    // The engine's own noise, its octaves weighed for a tip.
    #[test]
    fn the_grounds_slope_is_found_under_a_tip_within_two_errors() {
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
                // polynomials of R within half a decibel: the exponent is off by up to 0.3 under
                // the widest tip, and its standard error has to hold that.
                let bound = if tip_radius_m > 0.0 { (2.0 * law.alpha_se).min(0.3) } else { 0.1 };
                assert!(
                    (law.alpha - alpha).abs() < bound,
                    "R {roughness}, tip {tip_radius_m} m: {} ± {} for {alpha}",
                    law.alpha,
                    law.alpha_se
                );
            }
        }
    }

    // Long waves beyond 10 mm are flat, and a stroke of few seconds gives each third octave to a
    // decibel only.
    #[test]
    fn flat_long_waves_are_not_taken_for_a_slope_under_tips() {
        let field = FractalNoise::new(5);
        for tip_radius_m in [1.6e-3, 3e-3] {
            let weights = OctaveWeights::new(&Relief {
                rms_at_1mm_m: 1e-6,
                outer_scale_m: 0.01,
                tip_radius_m,
                longest_wavelength_m: f64::INFINITY,
            });
            let spectra: Vec<Vec<f64>> =
                (0..OCTAVES).map(|i| octave_spectrum(&field, &weights, 1.0, i, 17..42)).collect();
            let sum = |k: usize| spectra.iter().map(|spectrum| spectrum[k]).sum();
            let band = |k: usize| Band { band: 17 + k, level_db: db(sum(k)), se_db: 1.0 };
            let law = PowerLaw::through(&(0..25).map(band).collect::<Vec<_>>(), tip_radius_m);
            assert!((law.alpha - 1.0).abs() < 0.05, "tip {tip_radius_m} m: {}", law.alpha);
        }
    }
}
