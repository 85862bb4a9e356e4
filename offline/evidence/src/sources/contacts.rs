//! The source of contacts, touch and sound.

use super::{Found, columns};
use crate::spectrum::power_spectrum;
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};

/// Distance of two points of a profile, m.
const STEP_M: f64 = 1e-5;
const POINTS: usize = 1 << 17;
/// Wavelengths between which the slope is fitted, m.
const FITTED_M: [f64; 2] = [1e-4, 8e-3];

/// Profiles of α 1 and 2, with the slope that their spectra have.
pub fn profiles() -> Result<Found, String> {
    let alphas = [1.0, 2.0];
    let (mut measured, mut shown) = (Vec::new(), Vec::new());
    for alpha in alphas {
        let noise = FractalNoise::new(4);
        let position_m: Vec<[f64; 2]> = (0..POINTS).map(|n| [n as f64 * STEP_M, 0.3]).collect();
        let path = NoisePath { position_m: &position_m, footprint_m: &vec![STEP_M; POINTS] };
        let (roughness, mut height_m) = (vec![(2.5 - alpha) / 1.5; POINTS], vec![0.0; POINTS]);
        noise.add(&path, &roughness, &OctaveWeights::pinned(1e-6, 0.05), &mut height_m);
        measured.push(slope(&height_m));
        let largest = height_m.iter().fold(0.0_f64, |most, height| most.max(height.abs()));
        shown.push(height_m.iter().take(2000).step_by(4).map(|height| height / largest).collect());
    }
    let sentence = format!(
        "The spectra fall as 1/f^{:.2} and 1/f^{:.2}; the noise belongs to places, so that the profile is the same at every speed.",
        measured[0], measured[1]
    );
    let [first, second] = [shown.remove(0), shown.remove(0)];
    let ours = columns([("alpha", measured), ("profile_alpha_1", first), ("profile_alpha_2", second)]);
    Ok((columns([("alpha", alphas.to_vec())]), ours, sentence))
}

/// Exponent of a profile's power spectrum, by octaves.
fn slope(height_m: &[f64]) -> f64 {
    const LENGTH: usize = 1 << 14;
    let mean = height_m.iter().sum::<f64>() / height_m.len() as f64;
    let samples: Vec<f32> = height_m.iter().map(|height| (height - mean) as f32).collect();
    let power = power_spectrum(&samples, LENGTH);
    let bin = |wavelength_m: f64| LENGTH as f64 * STEP_M / wavelength_m;
    let (mut low, mut points) = (bin(FITTED_M[1]), Vec::new());
    while 2.0 * low < bin(FITTED_M[0]) {
        let band = &power[low as usize..2 * low as usize];
        points.push((points.len() as f64, (band.iter().sum::<f64>() / band.len() as f64).log2()));
        low *= 2.0;
    }
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let over: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    -over / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
