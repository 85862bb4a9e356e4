//! Weights of the octaves: the surface's own law, and what a tip of some radius rides over.
//!
//! ```text
//! a(λ) = rms · g(R) · (λ / 1 mm)^((α−1)/2) · (1 + (λ/L)²)^(−α/4) · (1 + (λ_c/λ)^(2p))^(−1/2)
//! g(R) = 10^(0.75 (R − 1))        a(λ_c) (2π/λ_c)² r = 0.63,  p = 1.45 − (α − 1)/2
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | a(λ) | rms of the octave about the wavelength λ | α = 2.5 − 1.5 R |
//! | rms | [`Relief::rms_at_1mm_m`] | of the octave about 1 mm at R = 1 |
//! | g(R) | [`growth`] | 15 dB from polished to matte. **Design choice**: a polished plate is then felt at least 4 dB below a matte one at every speed of a hand, also in displacement, where its steep spectrum gathers in the long waves |
//! | L | [`Relief::outer_scale_m`] | beyond it a surface is flat: every finished surface has such a roll-off |
//! | r, λ_c | [`Relief::tip_radius_m`] | a sphere does not reach the ground of valleys sharper than itself; in front of λ_c in the right-hand equation stands a(λ) without the tip |
//!
//! The tip's term is the spectral equivalent of an exact dilation. It was fitted to spheres of 0.4,
//! 1.6 and 5 mm that rode on this noise, R 0.1–1, 11 µm (`tests/independent/tip_on_noise.py`): the
//! octaves from 4 mm to 0.06 mm within 2 dB.

use super::gains::{INVERSE_OCTAVE_RATIO, LEVEL, OCTAVE_RATIO};
use super::{FractalNoise, OCTAVES, band_weight};
use crate::gradient_noise_2d::{PEAK_WAVELENGTH_CELLS, VARIANCE};

/// Cells so many samples long are known between those.
const SEEN_CELLS: f64 = 24.0;

/// Coefficients of a polynomial in R.
const TERMS: usize = 5;

/// Curvature of the octave that a tip just follows, times its radius: fitted.
const FOLLOWED_CURVATURE: f64 = 0.63;

/// Power of λ with which a rough ground falls below λ_c: arcs of the tip, meeting in cusps. Fitted.
const ARCS: f64 = 1.45;

/// The wavelength at which the law is pinned, m.
const PINNED_M: f64 = 1e-3;

/// Roughness of a surface, and the tip on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relief {
    /// Rms of the octave about 1 mm where R is 1, m.
    pub rms_at_1mm_m: f64,
    /// Wavelength beyond which the surface is flat, m; ∞ for never.
    pub outer_scale_m: f64,
    /// Radius of the sphere that rides on it, m; 0 is a point.
    pub tip_radius_m: f64,
    /// Octaves of longer waves fade out, m; ∞ for none.
    pub longest_wavelength_m: f64,
}

/// Decades from polished to matte.
const GROWTH: f64 = 0.75;

/// Amplitude of a surface of roughness R over one of R = 1, at 1 mm.
#[must_use]
pub fn growth(roughness: f64) -> f64 {
    libm::pow(10.0, GROWTH * (roughness.clamp(0.0, 1.0) - 1.0))
}

/// Weights of the octaves as polynomials of the roughness, worked out beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OctaveWeights {
    pub(super) of: [[f32; TERMS]; OCTAVES],
    /// The first octave that is there at all; [`OCTAVES`] for none.
    pub(super) coarsest: usize,
    /// A bit for each octave that is there.
    pub(super) present: u32,
}

impl OctaveWeights {
    /// Bare law: one level at 1 mm for every roughness, no outer scale, felt by a point.
    #[must_use]
    pub fn pinned(rms_at_1mm_m: f64, longest_wavelength_m: f64) -> Self {
        let of =
            |cell_m| [band_weight(cell_m, longest_wavelength_m) * rms_at_1mm_m as f32, 0.0, 0.0, 0.0, 0.0];
        Self::of(CELLS_M.map(of))
    }

    /// Weights of a surface, for a tip.
    #[must_use]
    pub fn new(relief: &Relief) -> Self {
        let of = |cell_m| {
            let band = f64::from(band_weight(cell_m, relief.longest_wavelength_m));
            let at = |roughness| band * relief.share(PEAK_WAVELENGTH_CELLS * cell_m, roughness);
            polynomial([0.0, 0.25, 0.5, 0.75, 1.0].map(at)).map(|c| (c * relief.rms_at_1mm_m) as f32)
        };
        Self::of(CELLS_M.map(of))
    }

    /// Weights whose octaves are stronger by these gains, dB, coarsest first; −∞ leaves one out.
    #[must_use]
    pub fn with_gains_db(&self, gains_db: &[f64; OCTAVES]) -> Self {
        let mut of = self.of;
        for (weight, gain_db) in of.iter_mut().zip(gains_db) {
            let gain = libm::pow(10.0, 0.05 * gain_db) as f32;
            weight.iter_mut().for_each(|term| *term *= gain);
        }
        Self::of(of)
    }

    /// Weights that give each octave this rms, m, whatever the roughness; coarsest first.
    #[must_use]
    pub fn constant(rms_m: &[f64; OCTAVES]) -> Self {
        let mut of = [[0.0; TERMS]; OCTAVES];
        for ((of, rms_m), cell_m) in of.iter_mut().zip(rms_m).zip(CELLS_M) {
            let bare = |roughness| {
                let rising = 0.5 * (FractalNoise::alpha(roughness) - 1.0);
                libm::pow(PEAK_WAVELENGTH_CELLS * cell_m / PINNED_M, rising)
            };
            *of = polynomial([0.0, 0.25, 0.5, 0.75, 1.0].map(|r| rms_m / bare(r))).map(|c| c as f32);
        }
        Self::of(of)
    }

    /// Weights with those of other octaves beside them.
    #[must_use]
    pub fn with(&self, others: &Self) -> Self {
        let mut of = self.of;
        for (weight, other) in of.iter_mut().zip(&others.of) {
            weight.iter_mut().zip(other).for_each(|(term, other)| *term += other);
        }
        Self::of(of)
    }

    fn of(of: [[f32; TERMS]; OCTAVES]) -> Self {
        let coarsest = of.iter().position(|weight| *weight != [0.0; TERMS]).unwrap_or(OCTAVES);
        let present = of.iter().rev().fold(0, |bits, weight| bits << 1 | u32::from(*weight != [0.0; TERMS]));
        Self { of, coarsest, present }
    }
}

impl OctaveWeights {
    /// Rms of each octave at a roughness, m, coarsest first, where none fades with the footprint.
    #[must_use]
    pub fn rms_m(&self, roughness: f64) -> [f64; OCTAVES] {
        let r = roughness.clamp(0.0, 1.0);
        let sum = |c: &[f32]| c.iter().rev().fold(0.0, |sum, c| f64::from(*c) + r * sum);
        let (level, ratio) = (sum(&LEVEL) * libm::sqrt(VARIANCE), sum(&OCTAVE_RATIO));
        core::array::from_fn(|i| level * libm::pow(ratio, i as f64 - 4.0) * sum(&self.of[i]))
    }

    /// Weights of the octaves from one on, by their index.
    #[must_use]
    pub fn from_octave(&self, octave: usize) -> Self {
        Self { coarsest: self.coarsest.max(octave.min(OCTAVES)), ..*self }
    }

    /// Rms of the relief that lies beside the Catmull-Rom cubics through its samples, and which
    /// octaves have to be looked at between samples so that the others miss no more than `left_m`.
    ///
    /// ```text
    /// e² = Σ (gᵢ κ(aᵢ/s))² · 0.093        κ(c) = 1.5/c³
    /// ```
    /// s: `footprint_m`, the way between two samples; gᵢ: gain of the octave, faded as if that were
    /// `faded_m`. κ was measured on the noise (within 50 % from 2 to 24 samples a cell); longer
    /// cells count for nothing.
    #[must_use]
    pub fn missed(
        &self,
        roughness: f64,
        [footprint_m, faded_m]: [f64; 2],
        left_m: f64,
    ) -> InterpolationError {
        let r = roughness.clamp(0.0, 1.0);
        let sum = |c: &[f32]| c.iter().rev().fold(0.0, |sum, c| f64::from(*c) + r * sum);
        let coarser = sum(&INVERSE_OCTAVE_RATIO);
        let ratio = sum(&OCTAVE_RATIO);
        let cube = ratio * ratio * ratio;
        // The finest octave is seven below that of 1.024 mm cells.
        let mut gain = sum(&LEVEL) * cube * cube * ratio;
        let (mut squares, mut all) = ([0.0; OCTAVES], 0.0);
        let each = CELLS_M.iter().zip(&self.of).zip(&mut squares).skip(self.coarsest).rev();
        for ((cell_m, weight), square) in each {
            if *cell_m > SEEN_CELLS * footprint_m {
                break;
            }
            let alive = (0.5 * cell_m / faded_m - 1.0).clamp(0.0, 1.0);
            if alive > 0.0 {
                let c = footprint_m / cell_m;
                let beside = 1.5 * c * c * c * alive * alive * (3.0 - 2.0 * alive);
                let part = gain * sum(weight) * beside;
                *square = part * part * VARIANCE;
                all += *square;
            }
            gain *= coarser;
        }
        let (mut left, most) = (0.0, left_m * left_m);
        let octave = squares.iter().position(|square| {
            left += square;
            left > most
        });
        InterpolationError { all_m: libm::sqrt(all), octave: octave.unwrap_or(OCTAVES) }
    }
}

/// Error of cubics through samples of a relief.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterpolationError {
    /// Rms, m.
    pub all_m: f64,
    /// The coarsest octave that has to be looked at between samples, by its index; [`OCTAVES`] for
    /// none.
    pub octave: usize,
}

impl Relief {
    /// Amplitude of an octave over that of the bare law pinned at R = 1.
    #[must_use]
    pub fn share(&self, wavelength_m: f64, roughness: f64) -> f64 {
        let alpha = FractalNoise::alpha(roughness);
        let beyond = wavelength_m / self.outer_scale_m;
        growth(roughness)
            * libm::pow(1.0 + beyond * beyond, -0.25 * alpha)
            * self.followed(wavelength_m, roughness)
    }

    /// Share of an octave that the tip follows, 0–1.
    fn followed(&self, wavelength_m: f64, roughness: f64) -> f64 {
        let rising = 0.5 * (FractalNoise::alpha(roughness) - 1.0);
        let pinned_m = self.rms_at_1mm_m * growth(roughness);
        // a(λ_c) (2π)² r / λ_c² = 0.63
        let square = 4.0 * core::f64::consts::PI * core::f64::consts::PI;
        let curved = pinned_m * square * self.tip_radius_m / FOLLOWED_CURVATURE;
        if curved <= 0.0 {
            return 1.0;
        }
        let limit_m = libm::pow(curved * libm::pow(PINNED_M, -rising), 1.0 / (2.0 - rising));
        1.0 / libm::sqrt(1.0 + libm::pow(limit_m / wavelength_m, 2.0 * (ARCS - rising)))
    }
}

/// Cell lengths of the octaves, m.
const CELLS_M: [f64; OCTAVES] = {
    let mut cells_m = [super::LONGEST_CELL_M; OCTAVES];
    let mut i = 1;
    while i < OCTAVES {
        cells_m[i] = 0.5 * cells_m[i - 1];
        i += 1;
    }
    cells_m
};

/// The polynomial through values at 0, ¼, ½, ¾ and 1.
fn polynomial(values: [f64; TERMS]) -> [f64; TERMS] {
    let mut divided = values;
    for order in 1..TERMS {
        for i in (order..TERMS).rev() {
            divided[i] = (divided[i] - divided[i - 1]) / (0.25 * order as f64);
        }
    }
    // Newton's form, multiplied out from its innermost factor.
    let mut c = [0.0; TERMS];
    for i in (0..TERMS).rev() {
        let node = 0.25 * i as f64;
        for k in (0..TERMS).rev() {
            c[k] = if k > 0 { c[k - 1] } else { 0.0 } - node * c[k];
        }
        c[0] += divided[i];
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    const MATTE: Relief = Relief {
        rms_at_1mm_m: 11e-6,
        outer_scale_m: 4e-3,
        tip_radius_m: 1.6e-3,
        longest_wavelength_m: f64::INFINITY,
    };

    #[test]
    fn the_polynomial_passes_through_its_values() {
        let c = polynomial([1.0, -2.0, 0.5, 3.0, 7.0]);
        for (i, value) in [1.0, -2.0, 0.5, 3.0, 7.0].into_iter().enumerate() {
            let x = 0.25 * i as f64;
            let sum = c.iter().rev().fold(0.0, |sum, c| c + x * sum);
            assert!((sum - value).abs() < 1e-12, "{sum} for {value}");
        }
    }

    #[test]
    fn between_nodes_the_polynomial_keeps_the_law_within_half_a_decibel() {
        let weights = OctaveWeights::new(&MATTE);
        for (cell_m, c) in CELLS_M.into_iter().zip(weights.of) {
            let strongest = MATTE.share(PEAK_WAVELENGTH_CELLS * cell_m, 1.0).max(1e-3);
            for n in 0..=40 {
                let r = f64::from(n) / 40.0;
                let sum = c.iter().rev().fold(0.0, |sum, c| f64::from(*c) + r * sum) / MATTE.rms_at_1mm_m;
                let law = MATTE.share(PEAK_WAVELENGTH_CELLS * cell_m, r);
                assert!(
                    (sum - law).abs() < 0.06 * law + 0.01 * strongest,
                    "{cell_m} m, R {r}: {sum} for {law}"
                );
            }
        }
    }

    #[test]
    fn octaves_of_a_given_rms_have_it_at_every_roughness() {
        let mut rms_m = [0.0; OCTAVES];
        (rms_m[0], rms_m[3]) = (3e-5, 8e-6);
        let weights = OctaveWeights::constant(&rms_m);
        assert_eq!((weights.coarsest, weights.present), (0, 0b1001));
        for (i, (rms_m, c)) in rms_m.into_iter().zip(weights.of).enumerate() {
            for n in 0..=40 {
                let r = f64::from(n) / 40.0;
                let law = libm::pow(1.92 * CELLS_M[i] / 1e-3, 0.5 * (FractalNoise::alpha(r) - 1.0));
                let sum = law * c.iter().rev().fold(0.0, |sum, c| f64::from(*c) + r * sum);
                assert!((sum - rms_m).abs() <= 0.02 * rms_m, "octave {i}, R {r}: {sum} for {rms_m}");
            }
        }
        let both = OctaveWeights::new(&Relief { longest_wavelength_m: 1e-4, ..MATTE }).with(&weights);
        assert!(both.present & 0b1001 == 0b1001 && both.present & 0b110 == 0, "{:b}", both.present);
    }

    // dB that a sphere takes off the octaves about 8 mm … 62.5 µm: a dilation in numpy,
    // tests/independent/tip_on_noise.py.
    #[test]
    fn a_sphere_takes_off_what_its_dilation_takes_off() {
        let figures = [
            (1.6e-3, 0.1, [0.0, -0.1, -0.1, -0.3, -0.9, -2.3, -5.2, -9.3]),
            (1.6e-3, 0.5, [-0.2, -0.4, -0.4, -1.1, -3.1, -7.4, -13.8, -19.9]),
            (1.6e-3, 1.0, [-0.4, -0.7, -1.0, -3.2, -9.2, -17.8, -26.5, -34.5]),
            (0.4e-3, 0.5, [-0.1, -0.1, -0.1, -0.3, -0.9, -2.4, -6.1, -11.7]),
            (0.4e-3, 1.0, [-0.4, -0.5, -0.5, -1.2, -3.4, -9.0, -17.5, -25.5]),
            (5e-3, 0.5, [-0.3, -0.7, -1.1, -2.9, -7.7, -14.0, -20.6, -26.8]),
            (5e-3, 1.0, [-0.2, -1.0, -2.4, -7.5, -16.5, -25.2, -33.9, -41.9]),
        ];
        for (tip_radius_m, roughness, taken_db) in figures {
            // The figures are of 11 µm × 10^(R − 1).
            let rms_at_1mm_m = 11e-6 * libm::pow(10.0, roughness - 1.0) / growth(roughness);
            let ball = Relief { tip_radius_m, rms_at_1mm_m, ..MATTE };
            for (i, taken_db) in taken_db.into_iter().enumerate() {
                let wavelength_m = 8e-3 * libm::exp2(-(i as f64));
                let ours_db = 20.0 * libm::log10(ball.followed(wavelength_m, roughness));
                let error_db = ours_db - taken_db;
                assert!(
                    error_db.abs() < 2.0,
                    "{tip_radius_m} m, R {roughness}, {wavelength_m} m: {error_db} dB"
                );
            }
        }
    }
}
