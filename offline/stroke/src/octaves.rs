//! Octaves of the engine's micro-relief that give a felt spectrum back.
//!
//! The engine adds twelve octaves of gradient noise, each broader than an octave: their own
//! spectra, read from the noise itself along a line, are weighed so that together they come to the
//! target. The tip's share is in them already, so a surface plays through the tip that it was felt
//! by as it was felt.

use crate::octave_noise::octave_spectrum;
use crate::power_law::PowerLaw;
use crate::relief::Spectrum;
use asperity_dsp::fractal_noise::{FractalNoise, OCTAVES, OctaveWeights, Relief, growth};
use std::ops::Range;

/// Wavelength beyond which the law is flat; the table says what is there.
pub const OUTER_SCALE_M: f64 = 0.01;
/// Greatest gain over the law, dB.
const MOST_DB: f64 = 60.0;
/// Rounds of the fit, each of which multiplies gains.
const ROUNDS: usize = 300;
/// Third octaves of the target: 31 mm to 20 µm.
const FITTED: Range<usize> = 15..47;

/// Micro-relief of a surface as a scene file says it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MicroRelief {
    /// Roughness, 0–1: sets the law's slope.
    pub roughness: f64,
    /// Rms of the law's octave about 1 mm at a roughness of 1, m.
    pub micro_relief_m: f64,
    /// Gains of the octaves over the law, coarsest first, dB.
    pub octaves_db: [f64; OCTAVES],
}

/// Octaves that come to the spectrum under a tip.
#[must_use]
pub fn playing(spectrum: &Spectrum<'_>, law: &PowerLaw, tip_radius_m: f64) -> MicroRelief {
    let roughness = ((2.5 - law.alpha) / 1.5).clamp(0.0, 1.0);
    let micro_relief_m = (law.at_1mm_m / growth(roughness)).clamp(1e-9, 1e-3);
    let weights = OctaveWeights::new(&Relief {
        rms_at_1mm_m: micro_relief_m,
        outer_scale_m: OUTER_SCALE_M,
        tip_radius_m,
        longest_wavelength_m: f64::INFINITY,
    });
    let field = FractalNoise::new(61);
    let own: Vec<Vec<f64>> =
        (0..OCTAVES).map(|octave| octave_spectrum(&field, &weights, roughness, octave, FITTED)).collect();
    let target: Vec<f64> = FITTED.map(|band| 10f64.powf(0.1 * spectrum.at(band as f64))).collect();
    let mut gains = [1.0f64; OCTAVES];
    for _ in 0..ROUNDS {
        let model: Vec<f64> = (0..target.len())
            .map(|k| own.iter().zip(&gains).map(|(own, gain)| own[k] * gain).sum::<f64>().max(1e-60))
            .collect();
        for (own, gain) in own.iter().zip(&mut gains) {
            let (mut sum, mut whole) = (0.0, 1e-12);
            for (k, own) in own.iter().enumerate() {
                let share = own * *gain / model[k];
                sum += share * (target[k] / model[k]).ln();
                whole += share;
            }
            *gain =
                (*gain * (sum / whole).exp()).clamp(10f64.powf(-0.1 * MOST_DB), 10f64.powf(0.1 * MOST_DB));
        }
    }
    MicroRelief {
        roughness,
        micro_relief_m,
        octaves_db: gains.map(|gain| crate::db(gain).clamp(-MOST_DB, MOST_DB)),
    }
}
