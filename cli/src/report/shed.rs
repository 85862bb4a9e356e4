//! Levels of load, as the engine renders them: the excitation missed by ear and finger, and the
//! cost saved.

use super::excitation::{Missed, missed, missed_in_the_mean};
use super::{SAMPLE_RATE_HZ, refused};
use crate::bench_scene::{self, Bench, Load};
use crate::error::CliError;
use crate::measure::Timing;
use asperity::{Config, ContactEvent, Impact, Material, ModalModel, Mode};
use asperity_dsp::rng::Rng;
use serde::Serialize;

/// Ten fingers on ten bodies of 500 modes: modes and contacts both are much of the work.
const LOAD: Load = Load { contacts: 10, bodies: 10, modes_per_body: 500, lift: false };
const BLOCK: usize = 64;
/// Span that is compared, after a quarter of a second in which the fingers begin.
const BLOCKS: usize = 689;
const SKIPPED: usize = 172;
/// The highest level: one of modes, then two contacts a level.
const HIGHEST: usize = 5;

/// A level of load.
#[derive(Debug, Clone, Serialize)]
pub struct LoadLevel {
    /// 0: nothing is left out.
    pub level: usize,
    /// Parts left out at this level, beside all of the levels below.
    pub leaves_out: &'static str,
    /// Ten fingers, median of the blocks.
    pub ns_per_sample: f64,
    /// Share of the cost of level 0: the median of blocks rendered in turn.
    pub share: f64,
    /// Excitation missed of ten fingers that stroke.
    pub stroke: Missed,
    /// Excitation missed of a strike.
    pub strike: Missed,
    /// The most that a third octave of what is felt differs, 63 Hz–2 kHz, dB.
    pub felt_worst_db: f64,
    /// Their mean difference, dB.
    pub felt_mean_db: f64,
}

fn leaves_out(level: usize) -> &'static str {
    match level {
        0 => "nothing",
        1 => "inaudible modes, two fifths at least",
        _ => "the two least important contacts",
    }
}

/// Strikes whose modes begin at other phases.
const STRIKES: u64 = 8;

/// A body as a fit gives it: modes that differ by 60 dB, of which louder ones hide many.
fn body(phases: u64) -> ModalModel {
    let (mut rng, mut phase) = (Rng::new(3), Rng::new(phases));
    let modes = (0..LOAD.modes_per_body).map(|_| Mode {
        frequency_hz: 60.0 * 250f64.powf(rng.uniform()),
        decay_per_s: 1.0 + 80.0 * rng.uniform(),
        amplitude: 0.1 * 10f64.powf(-3.0 * rng.uniform()),
        phase_rad: std::f64::consts::TAU * phase.uniform(),
    });
    ModalModel { impulse_n_s: 0.01, modes: modes.collect(), ..ModalModel::silent() }
}

/// Ten fingers at one level.
struct Stroke {
    bench: Bench,
    heard: Vec<f64>,
    felt: Vec<f64>,
    times_s: Vec<f64>,
}

/// Ten fingers at every level, block by block in turn, so that all see the same machine.
fn strokes() -> Result<Vec<Stroke>, CliError> {
    let config = || Config { sample_rate_hz: SAMPLE_RATE_HZ, ..Config::default() };
    let stroke = |_| {
        let bench = Bench::of(LOAD, config(), &body(1))?;
        Ok(Stroke { bench, heard: Vec::new(), felt: Vec::new(), times_s: Vec::new() })
    };
    let mut strokes = (0..=HIGHEST).map(stroke).collect::<Result<Vec<_>, CliError>>()?;
    for block in 0..SKIPPED + BLOCKS {
        for (level, Stroke { bench, heard, felt, times_s }) in strokes.iter_mut().enumerate() {
            let (mut haptic, mut audio) = ([0.0; BLOCK], [0.0; BLOCK]);
            let took_s = bench.block(&mut haptic, &mut audio);
            if block == SKIPPED / 2 {
                bench.be_late(level);
            }
            if block >= SKIPPED {
                times_s.push(took_s);
                heard.extend(audio.map(f64::from));
                felt.extend(haptic.map(f64::from));
            }
        }
    }
    Ok(strokes)
}

/// Sounds of strikes at a level.
fn strikes(level: usize) -> Result<Vec<Vec<f64>>, CliError> {
    (1..=STRIKES).map(|phases| strike(level, phases)).collect()
}

fn strike(level: usize, phases: u64) -> Result<Vec<f64>, CliError> {
    let config = Config { sample_rate_hz: SAMPLE_RATE_HZ, ..Config::default() };
    let asperity::Engine { mut scene, mut renderer, .. } = config.build().map_err(refused)?;
    let body = asperity::Body::new(body(phases)).material(Material::CERAMIC);
    let body = scene.add_body(body).map_err(refused)?;
    bench_scene::be_late(&mut renderer, level);
    let impact = Impact::from_impulse(body, 1e-3, 2.0, 1.0).striker(Material::STEEL, 2.5e-4, 1e-3);
    scene.report(0.0, ContactEvent::Impact(impact)).map_err(refused)?;
    let mut audio = vec![0.0; BLOCK * BLOCKS];
    let mut haptic = audio.clone();
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    Ok(audio.into_iter().map(f64::from).collect())
}

/// Worst and mean difference of third octaves, dB; of those within 40 dB of the strongest.
fn third_octaves_apart(less: &[f64], whole: &[f64]) -> (f64, f64) {
    let [less, whole] = [less, whole].map(super::from_reports::third_octaves_db);
    let loudest = whole.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let apart: Vec<f64> = less
        .iter()
        .zip(&whole)
        .filter(|(_, whole)| **whole > loudest - 40.0)
        .map(|(less, whole)| (less - whole).abs())
        .collect();
    (apart.iter().copied().fold(0.0, f64::max), apart.iter().sum::<f64>() / apart.len().max(1) as f64)
}

/// Measures every level.
///
/// # Errors
/// Never but by a defect.
pub fn levels() -> Result<Vec<LoadLevel>, CliError> {
    let strokes = strokes()?;
    let (whole, struck) = (&strokes[0], strikes(0)?);
    let median = |times: Vec<f64>| Timing::of(times).median;
    let level = |(level, stroke): (usize, &Stroke)| {
        let (felt_worst_db, felt_mean_db) = third_octaves_apart(&stroke.felt, &whole.felt);
        let shares = stroke.times_s.iter().zip(&whole.times_s).map(|(less, whole)| less / whole);
        Ok(LoadLevel {
            level,
            leaves_out: leaves_out(level),
            ns_per_sample: median(stroke.times_s.clone()) * 1e9 / BLOCK as f64,
            share: median(shares.collect()),
            stroke: missed(&stroke.heard, &whole.heard, SAMPLE_RATE_HZ),
            strike: missed_in_the_mean(
                strikes(level)?.iter().zip(&struck).map(|(less, whole)| (&less[..], &whole[..])),
                SAMPLE_RATE_HZ,
            ),
            felt_worst_db,
            felt_mean_db,
        })
    };
    strokes.iter().enumerate().map(level).collect()
}
