//! Octaves of the micro-relief: those that the footprint cannot resolve are left out.

use super::{BLOCK, Row, SAMPLE_RATE_HZ};
use crate::error::CliError;
use crate::measure::{ns_per_item, relative_error};
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::simd::Level;

const SECONDS: f64 = 0.25;
const RMS_AT_1_MM_M: f64 = 2e-6;
const ROUGHNESS: f64 = 0.5;
const REFERENCE: &str = "all twelve octaves at the same places, which alias where the footprint is too long";

fn heights(noise: &FractalNoise, position_m: &[[f64; 2]], footprint_m: f64) -> Vec<f64> {
    let (footprints, roughness) = ([footprint_m; BLOCK], [ROUGHNESS; BLOCK]);
    let mut heights = vec![0.0; position_m.len()];
    for (places, out) in position_m.chunks(BLOCK).zip(heights.chunks_mut(BLOCK)) {
        let path = NoisePath { position_m: places, footprint_m: &footprints[..places.len()] };
        noise.add(
            &path,
            &roughness[..places.len()],
            &OctaveWeights::pinned(RMS_AT_1_MM_M, f64::INFINITY),
            out,
        );
    }
    heights
}

fn places(speed_m_s: f64) -> Vec<[f64; 2]> {
    (0..(SECONDS * SAMPLE_RATE_HZ) as usize)
        .map(|n| {
            let distance = speed_m_s * n as f64 / SAMPLE_RATE_HZ;
            [0.013 + 0.96 * distance, 0.017 + 0.28 * distance]
        })
        .collect()
}

/// Measures the axis.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let widest = FractalNoise::new(1);
    let portable = FractalNoise::new(1).on(Level::PORTABLE);
    let mut rows = Vec::new();
    let mut measure = |choice: String, noise: &FractalNoise, speed_m_s: f64, footprint_m: f64| {
        let places = places(speed_m_s);
        let reference = heights(&widest, &places, 0.0);
        let found = heights(noise, &places, footprint_m);
        let ns_per_sample = ns_per_item(places.len(), || {
            std::hint::black_box(heights(noise, &places, footprint_m));
        });
        let error = relative_error(found, &reference);
        rows.push(Row::of(("noise octaves", choice), ns_per_sample, error, REFERENCE));
    };
    measure("12 octaves, portable code".to_owned(), &portable, 0.1, 0.0);
    measure(format!("12 octaves, {:?}", widest.level().isa()), &widest, 0.1, 0.0);
    for speed_m_s in [0.1, 0.3, 1.0, 3.0] {
        let choice = format!("by footprint at {speed_m_s} m/s");
        measure(choice, &widest, speed_m_s, speed_m_s / SAMPLE_RATE_HZ);
    }
    Ok(rows)
}
