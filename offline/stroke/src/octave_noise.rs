//! Octaves of the engine's micro-relief as they are: their wavelengths, and their spectra along a
//! line, read from the noise itself.

use crate::relief::wavenumber;
use asperity_dsp::fractal_noise::{FractalNoise, LONGEST_CELL_M, NoisePath, OCTAVES, OctaveWeights};
use asperity_dsp::gradient_noise_2d::PEAK_WAVELENGTH_CELLS;
use asperity_fft::{PowerSpectra, hann};
use std::ops::Range;
use std::sync::OnceLock;

/// Wavelength about which an octave of the engine lies, m.
#[must_use]
pub fn wavelength_m(octave: usize) -> f64 {
    PEAK_WAVELENGTH_CELLS * LONGEST_CELL_M / (1u64 << octave) as f64
}

/// Samples of a probe of the noise, and how many a cell.
const LENGTH: usize = 1 << 14;
const STEPS_A_CELL: f64 = 16.0;

/// Octave that the shape of all is read from, and third octaves about it.
const READ: usize = 5;
const READ_BANDS: Range<usize> = 5..46;

/// Density of an octave of the noise along a line over its rms squared and its wavelength λ, at
/// q λ.
pub(crate) fn octave_shape(waves: f64) -> f64 {
    static SHAPE: OnceLock<Vec<f64>> = OnceLock::new();
    let shape = SHAPE.get_or_init(|| {
        let weights = OctaveWeights::pinned(1e-6, f64::INFINITY);
        let own_m = weights.rms_m(1.0)[READ];
        let density = octave_spectrum(&FractalNoise::new(61), &weights, 1.0, READ, READ_BANDS);
        density.iter().map(|density| density / (own_m * own_m * wavelength_m(READ))).collect()
    });
    let place = 10.0 * (waves / wavelength_m(READ)).log10() - READ_BANDS.start as f64;
    let below = place.floor();
    if below < 0.0 || below as usize + 1 >= shape.len() {
        return 0.0;
    }
    let (a, b) = (shape[below as usize].max(1e-12), shape[below as usize + 1].max(1e-12));
    a * (b / a).powf(place - below)
}

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
    let spectra = PowerSpectra::new(hann(LENGTH, 0.0), LENGTH);
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
        let scale = 2.0 * step_m / (0.375 * LENGTH as f64) / WAYS.len() as f64;
        density.iter_mut().zip(spectra.of(height_m)).for_each(|(sum, bin)| *sum += scale * bin);
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
