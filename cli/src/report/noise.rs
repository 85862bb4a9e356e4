//! Octaves of the micro-relief: those that the footprint cannot resolve are left out.

use super::cases::Case;
use super::through::Truth;
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
    relief(noise, position_m, footprint_m, ROUGHNESS, RMS_AT_1_MM_M)
}

fn relief(
    noise: &FractalNoise,
    position_m: &[[f64; 2]],
    footprint_m: f64,
    roughness: f64,
    rms_at_1_mm_m: f64,
) -> Vec<f64> {
    let (footprints, roughness) = ([footprint_m; BLOCK], [roughness; BLOCK]);
    let mut heights = vec![0.0; position_m.len()];
    for (places, out) in position_m.chunks(BLOCK).zip(heights.chunks_mut(BLOCK)) {
        let path = NoisePath { position_m: places, footprint_m: &footprints[..places.len()] };
        noise.add(
            &path,
            &roughness[..places.len()],
            &OctaveWeights::pinned(rms_at_1_mm_m, f64::INFINITY),
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

/// Micro-relief of the cases, m.
const CASE_RMS_AT_1_MM_M: f64 = 2.2e-5;
const CASES_REFERENCE: &str = "the relief that a footprint at the engine's own rate leaves, sampled at 8 times that rate, through the same contact; cases \
                               without micro-relief have their own axis";

/// Noise on the named cases that have micro-relief: the contact's response to it.
pub fn rows_on_cases() -> Result<Vec<Row>, CliError> {
    let read = |level: Option<Level>, footprints: f64| {
        move |case: &Case, seed: u64, places_m: &[f64], _: f64| {
            let noise = FractalNoise::new(seed);
            let noise = level.map_or(noise.clone(), |level| noise.on(level));
            let places: Vec<[f64; 2]> = places_m.iter().map(|x| [*x, 0.017]).collect();
            let footprint_m = footprints * case.speed_m_s / SAMPLE_RATE_HZ;
            let roughness = case.roughness().unwrap_or(0.0);
            Ok(relief(&noise, &places, footprint_m, roughness, CASE_RMS_AT_1_MM_M))
        }
    };
    let truth = Truth::new(|case| case.roughness().is_some(), &read(None, 1.0))?;
    let costs = rows()?;
    let ns = |which: usize| costs.get(which).map_or(0.0, |row| row.ns_per_sample);
    let row = |ns: f64, name: &str, heights: &super::through::Heights<'_>| {
        truth.row(("noise octaves, on the cases", name.to_owned()), ns, CASES_REFERENCE, heights)
    };
    Ok(vec![
        row(ns(0), "12 octaves, portable code (not offered)", &read(Some(Level::PORTABLE), 0.0))?,
        row(ns(1), "12 octaves, whatever passes (not offered)", &read(None, 0.0))?,
        row(ns(2), "by footprint (the engine)", &read(None, 1.0))?,
        row(ns(3), "by twice the footprint (not offered)", &read(None, 2.0))?,
    ])
}
