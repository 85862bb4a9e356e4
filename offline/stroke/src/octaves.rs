//! Octaves of the engine's micro-relief that give a felt spectrum back.
//!
//! The engine adds twelve octaves of gradient noise, each broader than an octave: their own spectra,
//! read from the noise itself along a line, are weighed so that together they come to the target.
//! The tip's share is in them already, so a surface plays through the tip that it was felt by as it
//! was felt.

use crate::relief::{PowerLaw, Spectrum, wavenumber};
use asperity_dsp::fractal_noise::{
    FractalNoise, LONGEST_CELL_M, NoisePath, OCTAVES, OctaveWeights, Relief, growth,
};
use asperity_dsp::gradient_noise_2d::PEAK_WAVELENGTH_CELLS;
use asperity_fft::FftPlanner;
use asperity_fft::num_complex::Complex;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::OnceLock;

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

/// Wavelength about which an octave of the engine lies, m.
#[must_use]
pub fn wavelength_m(octave: usize) -> f64 {
    PEAK_WAVELENGTH_CELLS * LONGEST_CELL_M / (1u64 << octave) as f64
}

/// Wavelength beyond which the law is flat; the table says what is there.
pub const OUTER_SCALE_M: f64 = 0.01;
/// Greatest gain over the law, dB.
const MOST_DB: f64 = 60.0;
/// Third octaves of a probe of the noise.
const LENGTH: usize = 1 << 15;
const STEPS_A_CELL: f64 = 16.0;
/// Rounds of the fit, each of which multiplies gains.
const ROUNDS: usize = 300;
/// Third octaves of the target: 31 mm to 20 µm.
const FITTED: Range<usize> = 15..47;

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

/// Spectrum of one octave of the noise along a line, over its rms squared times its wavelength, by
/// third octaves of q λ; [`kernel_origin`] is the place of 1.
#[must_use]
pub fn octave_kernel() -> &'static [f64] {
    static KERNEL: OnceLock<Vec<f64>> = OnceLock::new();
    KERNEL.get_or_init(|| {
        const ROUGHNESS: f64 = 0.5;
        let law = Relief {
            rms_at_1mm_m: 1e-6,
            outer_scale_m: f64::INFINITY,
            tip_radius_m: 0.0,
            longest_wavelength_m: f64::INFINITY,
        };
        let field = FractalNoise::new(61);
        let density =
            octave_spectrum(&field, &OctaveWeights::new(&law), ROUGHNESS, KERNEL_OCTAVE, KERNEL_BANDS);
        let wave_m = wavelength_m(KERNEL_OCTAVE);
        let rms_m = law.rms_at_1mm_m
            * law.share(wave_m, ROUGHNESS)
            * (wave_m / 1e-3).powf(0.5 * (FractalNoise::alpha(ROUGHNESS) - 1.0));
        density.iter().map(|density| density / (rms_m * rms_m * wave_m)).collect()
    })
}

/// Place in the kernel where the wavelength is the octave's own.
#[must_use]
pub fn kernel_origin() -> f64 {
    -10.0 * wavelength_m(KERNEL_OCTAVE).log10() - KERNEL_BANDS.start as f64
}

/// Octave that the kernel is read from, and third octaves about it.
const KERNEL_OCTAVE: usize = 5;
const KERNEL_BANDS: Range<usize> = 5..46;

/// Density of one octave of the noise at third octaves of wavenumbers, m³.
pub(crate) fn octave_spectrum(
    field: &FractalNoise,
    weights: &OctaveWeights,
    roughness: f64,
    octave: usize,
    bands: Range<usize>,
) -> Vec<f64> {
    let mut alone = [f64::NEG_INFINITY; OCTAVES];
    alone[octave] = 0.0;
    let weights = weights.with_gains_db(&alone);
    let step_m = LONGEST_CELL_M / (1u64 << octave) as f64 / STEPS_A_CELL;
    let mut density = vec![0.0; LENGTH / 2];
    let transform = FftPlanner::new().plan_fft_forward(LENGTH);
    const WAYS: [f64; 3] = [0.0, 0.7, 1.9];
    for (turn, way) in WAYS.into_iter().enumerate() {
        let (sin, cos) = f64::sin_cos(way);
        let begin = 3.0 * turn as f64;
        let position_m: Vec<[f64; 2]> =
            (0..LENGTH).map(|i| [begin + cos * step_m * i as f64, sin * step_m * i as f64]).collect();
        let footprint_m = vec![step_m; LENGTH];
        let mut height_m = vec![0.0; LENGTH];
        let roughness = vec![roughness; LENGTH];
        field.add(
            &NoisePath { position_m: &position_m, footprint_m: &footprint_m },
            &roughness,
            &weights,
            &mut height_m,
        );
        let mut bins: Vec<Complex<f64>> = height_m
            .iter()
            .enumerate()
            .map(|(i, h)| Complex::new(h * (0.5 - 0.5 * (2.0 * PI * i as f64 / LENGTH as f64).cos()), 0.0))
            .collect();
        transform.process(&mut bins);
        let scale = 2.0 * step_m / (0.375 * LENGTH as f64) / WAYS.len() as f64;
        density.iter_mut().zip(&bins).for_each(|(sum, bin)| *sum += scale * bin.norm_sqr());
    }
    let bin_q = 1.0 / (LENGTH as f64 * step_m);
    bands
        .map(|band| {
            let (from, to) = (wavenumber(band) * 10f64.powf(-0.05), wavenumber(band) * 10f64.powf(0.05));
            let (from, to) = ((from / bin_q) as usize, (to / bin_q) as usize + 1);
            let (from, to) = (from.min(density.len()), to.min(density.len()));
            if to <= from { 0.0 } else { density[from..to].iter().sum::<f64>() / (to - from) as f64 }
        })
        .collect()
}
