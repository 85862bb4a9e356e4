//! Frames a block: the whole engine, one finger on a body of 100 modes.

use super::{Row, SAMPLE_RATE_HZ};
use crate::bench_scene::{Bench, Load};
use crate::error::CliError;
use crate::measure::{Timing, relative_error};
use asperity::Config;

const SECONDS: f64 = 2.0;
const REFERENCE: &str = "the same scene in blocks of 64 frames, audio";
const LOAD: Load = Load { contacts: 1, bodies: 1, modes_per_body: 100, lift: false };
/// Each block size is timed so often; all blocks of all rounds count.
const ROUNDS: usize = 5;

/// The sound, and what each block took, s.
fn render(block: usize) -> Result<(Vec<f32>, Vec<f64>), CliError> {
    let config = Config { sample_rate_hz: SAMPLE_RATE_HZ, ..Config::default() };
    let mut bench = Bench::new(LOAD, config)?;
    let mut audio = vec![0.0; (SECONDS * SAMPLE_RATE_HZ) as usize / 4096 * 4096];
    let mut haptic = vec![0.0; block];
    let times_s = audio.chunks_mut(block).map(|part| bench.block(&mut haptic[..part.len()], part)).collect();
    Ok((audio, times_s))
}

/// Measures the axis.
pub fn rows() -> Result<Vec<Row>, CliError> {
    let reference: Vec<f64> = render(64)?.0.into_iter().map(f64::from).collect();
    [1, 16, 64, 256, 1024, 4096]
        .into_iter()
        .map(|block| {
            let (audio, mut times_s) = render(block)?;
            for _ in 1..ROUNDS {
                times_s.extend(render(block)?.1);
            }
            Ok(Row::of(
                ("block size", format!("{block} frames")),
                Timing::of(times_s).median * 1e9 / block as f64,
                relative_error(audio.into_iter().map(f64::from), &reference),
                REFERENCE,
            ))
        })
        .collect()
}
