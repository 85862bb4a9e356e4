//! The whole chain of one contact beside the sum of its kernels, each alone on the same stroke:
//! what is left over is glue.

use super::{BLOCK_FRAMES, SAMPLE_RATE_HZ, refused, ringing};
use crate::bench_scene::{Bench, Load, plate};
use crate::error::CliError;
use crate::measure::Timing;
use asperity::{Config, Integrator, Probe};
use asperity_dsp::butterworth::{self, Butterworth, Two};
use asperity_dsp::fractal_noise::{FractalNoise, NoisePath, OctaveWeights};
use asperity_dsp::micro_contact::{ContactSample, MicroContact};
use asperity_dsp::trajectory::{PathEvent, PathPoint, Trajectory, TrajectoryDesign};
use asperity_surface::height_field::{HeightField, PathBlock, SurfaceBlock};
use serde::Serialize;
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

const LOAD: Load = Load { contacts: 1, bodies: 1, modes_per_body: 100, lift: false };
/// Times everything is timed, in turn, so that all of it sees the same machine.
const TURNS: usize = 600;
/// Blocks of each in a turn: long against the clock.
const BLOCKS: usize = 8;
/// Blocks between two reports.
const REPORT_BLOCKS: usize = 11;
/// Blocks of the stroke that the kernels repeat.
const STROKE_BLOCKS: usize = 64;

/// One kernel.
#[derive(Debug, Serialize)]
pub(super) struct KernelRow {
    kernel: &'static str,
    ns_per_sample: f64,
}

/// Costs of a contact's kernels and of its whole chain.
#[derive(Debug, Serialize)]
pub(super) struct Kernels {
    rows: Vec<KernelRow>,
    sum_ns_per_sample: f64,
    /// One finger on a body of 100 modes.
    chain_ns_per_sample: f64,
    /// The median of its turns.
    chain_over_kernels: f64,
}

type Work = Box<dyn FnMut()>;
type Kernel = (&'static str, Work);

/// The stroke of the scene, as each stage leaves it.
struct Stroke {
    path_m: Vec<[f64; 2]>,
    height_m: Vec<f64>,
    rows: Vec<ContactSample>,
}

pub(super) fn measured() -> Result<Kernels, CliError> {
    let mut kernels = kernels()?;
    let config = Config { sample_rate_hz: SAMPLE_RATE_HZ, ..Config::default() };
    let mut bench = Bench::new(LOAD, config)?;
    let (mut haptic, mut audio) = ([0.0f32; BLOCK_FRAMES], [0.0f32; BLOCK_FRAMES]);
    let ns = 1e9 / (BLOCKS * BLOCK_FRAMES) as f64;
    let mut times = vec![Vec::new(); kernels.len()];
    let (mut chains, mut ratios) = (Vec::new(), Vec::new());
    for turn in 0..TURNS + TURNS / 8 {
        let chain = bench.blocks(BLOCKS, &mut haptic, &mut audio) * ns;
        let each = kernels.iter_mut().map(|(_, work)| {
            let began = Instant::now();
            (0..BLOCKS).for_each(|_| work());
            began.elapsed().as_secs_f64() * ns
        });
        let each: Vec<f64> = each.collect();
        // The first turns land the finger and warm everything up.
        if turn >= TURNS / 8 {
            ratios.push(chain / each.iter().sum::<f64>());
            times.iter_mut().zip(each).for_each(|(times, ns)| times.push(ns));
            chains.push(chain);
        }
    }
    let median = |times: Vec<f64>| Timing::of(times).median;
    let named = kernels.iter().zip(times);
    let rows: Vec<KernelRow> =
        named.map(|((kernel, _), times)| KernelRow { kernel, ns_per_sample: median(times) }).collect();
    Ok(Kernels {
        sum_ns_per_sample: rows.iter().map(|row| row.ns_per_sample).sum(),
        rows,
        chain_ns_per_sample: median(chains),
        chain_over_kernels: median(ratios),
    })
}

fn kernels() -> Result<Vec<Kernel>, CliError> {
    let mut map = plate().ok_or_else(|| refused("plate: cannot be made; please report it"))?;
    let stroke = stroke(&mut map)?;
    let footprint_m = [0.1 / SAMPLE_RATE_HZ; BLOCK_FRAMES];
    let (path_m, mut block) = (stroke.path_m.clone(), (0..STROKE_BLOCKS).cycle());
    let mut out = SurfaceBlock::default();
    let mut map_block = block.clone();
    let reading: Work = Box::new({
        let path_m = path_m.clone();
        move || {
            sample(&mut map, place(&path_m, map_block.next()), &footprint_m, &mut out);
            black_box(&out);
        }
    });
    let noise = FractalNoise::new(1);
    let weights = OctaveWeights::pinned(2.2e-5, 0.14 / 256.0);
    let mut relief_block = block.clone();
    let relief: Work = Box::new(move || {
        let position_m = place(&path_m, relief_block.next());
        let mut height_m = [0.0; BLOCK_FRAMES];
        let path = NoisePath { position_m, footprint_m: &footprint_m };
        noise.add(&path, &[0.5; BLOCK_FRAMES], &weights, &mut height_m);
        black_box(&height_m);
    });
    let model = MicroContact::new(&Probe::default(), Integrator::default(), SAMPLE_RATE_HZ);
    let model = model.map_err(refused)?;
    let mut state = model.at_rest(stroke.height_m[0], 0.5);
    let (height_m, mut pad_block) = (stroke.height_m, block.clone());
    let mut rows = [ContactSample::default(); BLOCK_FRAMES];
    let pad: Work = Box::new(move || {
        model.run(&mut state, place(&height_m, pad_block.next()), &[0.5; BLOCK_FRAMES], &mut rows);
        black_box(&rows);
    });
    let filter = Butterworth::new(10.0, SAMPLE_RATE_HZ).map_err(refused)?;
    let mut states = [butterworth::State::default(); 2];
    let rows = stroke.rows;
    let filters: Work = Box::new(move || {
        let mut two = Two::new([&filter; 2], states);
        for row in place(&rows, block.next()) {
            black_box(two.tick([row.pad_m, row.contact_force_n].into()).high);
        }
        states = two.states();
    });
    Ok(vec![
        ("path", path()?),
        ("map and roughness map", reading),
        ("micro-relief below the map", relief),
        ("pad, exact between events", pad),
        ("high-passes, felt and heard", filters),
        ("bank of 100 modes", Box::new(ringing(LOAD.modes_per_body)?)),
    ])
}

/// A block of a stroke.
fn place<T>(of: &[T], block: Option<usize>) -> &[T] {
    let from = block.unwrap_or(0) * BLOCK_FRAMES;
    &of[from..from + BLOCK_FRAMES]
}

fn sample(
    map: &mut impl HeightField,
    position_m: &[[f64; 2]],
    footprint_m: &[f64; BLOCK_FRAMES],
    out: &mut SurfaceBlock,
) {
    let velocity_m_s = [[0.1, 0.0]; BLOCK_FRAMES];
    let path = PathBlock {
        position_m,
        velocity_m_s: &velocity_m_s,
        footprint_m,
        normal_force_n: &[],
        ..PathBlock::default()
    };
    map.sample(&path, out);
}

/// Ground under the finger of the scene.
fn stroke(map: &mut impl HeightField) -> Result<Stroke, CliError> {
    let count = STROKE_BLOCKS * BLOCK_FRAMES;
    let path_m: Vec<[f64; 2]> = (0..count).map(|n| [0.1 * n as f64 / SAMPLE_RATE_HZ, 0.042]).collect();
    let footprint_m = [0.1 / SAMPLE_RATE_HZ; BLOCK_FRAMES];
    let mut height_m = Vec::with_capacity(count);
    let mut out = SurfaceBlock::default();
    for position_m in path_m.chunks(BLOCK_FRAMES) {
        sample(map, position_m, &footprint_m, &mut out);
        height_m.extend_from_slice(&out.height_m[..BLOCK_FRAMES]);
    }
    let path = NoisePath { position_m: &path_m, footprint_m: &vec![footprint_m[0]; count] };
    let weights = OctaveWeights::pinned(2.2e-5, 0.14 / 256.0);
    FractalNoise::new(1).add(&path, &vec![0.5; count], &weights, &mut height_m);
    let model = MicroContact::new(&Probe::default(), Integrator::default(), SAMPLE_RATE_HZ);
    let model = model.map_err(refused)?;
    let mut rows = vec![ContactSample::default(); count];
    model.run(&mut model.at_rest(height_m[0], 0.5), &height_m, &vec![0.5; count], &mut rows);
    Ok(Stroke { path_m, height_m, rows })
}

fn path() -> Result<Work, CliError> {
    let Config { path, path_cutoff_hz, .. } = Config::default();
    let design = TrajectoryDesign::new(path, path_cutoff_hz, SAMPLE_RATE_HZ, [0.14; 2]).map_err(refused)?;
    let event = PathEvent {
        sample: 0,
        fraction: 0.0,
        position_m: [0.01, 0.02],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.5,
    };
    let mut points = [PathPoint::default(); BLOCK_FRAMES];
    let (mut trajectory, mut blocks) = (Trajectory::begin(&design, &event), 0);
    Ok(Box::new(move || {
        if blocks % REPORT_BLOCKS == 0 {
            trajectory = Trajectory::begin(&design, &event);
        }
        blocks += 1;
        trajectory.advance(&design, &mut points);
        black_box(&points);
    }))
}

impl Kernels {
    pub(super) fn table(&self, text: &mut String) {
        let Self { rows, sum_ns_per_sample, chain_ns_per_sample, chain_over_kernels } = self;
        let _ = writeln!(text, "\n{:<34}{:>22}", "one contact, stage by stage", "ns a sample");
        for KernelRow { kernel, ns_per_sample } in rows {
            let _ = writeln!(text, "{kernel:<34}{ns_per_sample:>22.2}");
        }
        let _ = writeln!(text, "{:<34}{sum_ns_per_sample:>22.2}", "all kernels");
        let _ = writeln!(
            text,
            "{:<34}{chain_ns_per_sample:>22.2}{:>16}",
            "the whole chain",
            format!("{chain_over_kernels:.2} × them")
        );
    }
}
