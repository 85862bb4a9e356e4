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
/// Third octaves whose level is known: the lowest frequencies of fast strokes are below.
const KNOWN: Range<usize> = 10..48;

/// Micro-relief of a surface as a scene file says it.
#[derive(Debug, Clone, PartialEq)]
pub struct MicroRelief {
    /// Roughness, 0–1: sets the law's slope.
    pub roughness: f64,
    /// Rms of the law's octave about 1 mm at a roughness of 1, m.
    pub micro_relief_m: f64,
    /// Gains of the octaves over the law, coarsest first, dB.
    pub octaves_db: [f64; OCTAVES],
    /// Levels of the third octaves [`KNOWN`] as it plays under the tip, dB re 1 m³.
    played_db: Vec<f64>,
}

impl MicroRelief {
    /// Level of a third octave as it plays under the tip, dB re 1 m³.
    #[must_use]
    pub fn level_db(&self, band: usize) -> f64 {
        self.played_db[band.clamp(KNOWN.start, KNOWN.end - 1) - KNOWN.start]
    }
}

/// Octaves that come to the spectrum under a tip.
#[must_use]
pub fn playing(spectrum: &Spectrum<'_>, law: &PowerLaw, tip_radius_m: f64) -> MicroRelief {
    let roughness = law.roughness();
    let micro_relief_m = (law.at_1mm_m / growth(roughness)).clamp(1e-9, 1e-3);
    let weights = OctaveWeights::new(&Relief {
        rms_at_1mm_m: micro_relief_m,
        outer_scale_m: OUTER_SCALE_M,
        tip_radius_m,
        longest_wavelength_m: f64::INFINITY,
    });
    let field = FractalNoise::new(61);
    let own: Vec<Vec<f64>> =
        (0..OCTAVES).map(|octave| octave_spectrum(&field, &weights, roughness, octave, KNOWN)).collect();
    let first = FITTED.start - KNOWN.start;
    let target: Vec<f64> = FITTED.map(|band| 10f64.powf(0.1 * spectrum.at(band as f64))).collect();
    let sum = |own: &[Vec<f64>], gains: &[f64; OCTAVES]| -> Vec<f64> {
        let at = |k: usize| own.iter().zip(gains).map(|(own, gain)| own[k] * gain).sum::<f64>().max(1e-60);
        (0..KNOWN.len()).map(at).collect()
    };
    let mut gains = [1.0f64; OCTAVES];
    for _ in 0..ROUNDS {
        let model = sum(&own, &gains);
        let model = &model[first..];
        for (own, gain) in own.iter().zip(&mut gains) {
            let (mut sum, mut whole) = (0.0, 1e-12);
            for (k, own) in own[first..].iter().take(target.len()).enumerate() {
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
        played_db: sum(&own, &gains).into_iter().map(crate::db).collect(),
    }
}
