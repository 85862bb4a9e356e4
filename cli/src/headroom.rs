//! `asperity headroom`: how many fingers and modes fit on this machine.
//!
//! One thread by default. A scene is rendered in blocks of 64 frames with events at 60
//! Hz, as a game drives it, and every block is timed; the kernels are timed alone in many short
//! repetitions. Every figure is the median of its blocks or repetitions, with the range of the
//! middle eight tenths beside it.

mod kernels;
mod paired;

use crate::bench_scene::{Bench, Load, modes};
use crate::error::CliError;
use crate::measure::{Timing, cpu_name, ns_spread, quantile};
use crate::output;
use crate::progress::Progress;
use asperity::{Config, Integrator, Probe};
use asperity_dsp::micro_contact::{ContactSample, MicroContact};
use asperity_dsp::modal_bank::{GroupOptions, GroupState, Inputs, ModalBank, design_groups, sort_by_decay};
use asperity_dsp::rng::Rng;
use asperity_dsp::simd::Level;
use clap::Args;
use kernels::Kernels;
use paired::Paired;
use serde::Serialize;

const SAMPLE_RATE_HZ: f64 = 44_100.0;
const BLOCK_FRAMES: usize = 64;
/// Signal rendered of each scene, s: enough blocks for a 99.9 % quantile.
const SCENE_S: f64 = 12.0;
/// Rows of the modal bank.
const BANKS: [usize; 5] = [16, 64, 256, 1024, 4096];

/// Measure how many fingers and modes this machine renders in real time
#[derive(Debug, Args)]
pub struct Options {
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
    /// Most threads that render a scene at once
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=64))]
    pub threads: u8,
}

#[derive(Debug, Serialize)]
struct Report {
    sample_rate_hz: f64,
    block_frames: usize,
    threads: u8,
    cpu: String,
    instruction_set: String,
    /// Method of measurement of every figure.
    estimate: &'static str,
    scenes: Vec<SceneRow>,
    modal_bank: Vec<BankRow>,
    contact: Vec<ContactRow>,
    growth: Vec<GrowthRow>,
    kernels: Kernels,
    paired: Paired,
}

#[derive(Debug, Serialize)]
struct SceneRow {
    name: String,
    contacts: usize,
    modes: usize,
    /// Length of a block over the median time it takes; the slow and the quick end of the middle
    /// eight tenths.
    real_time_factor: f64,
    real_time_factor_p10: f64,
    real_time_factor_p90: f64,
    block_p50_us: f64,
    block_p99_9_us: f64,
    ns_per_sample: f64,
    samples_per_s: f64,
}

#[derive(Debug, Serialize)]
struct BankRow {
    modes: usize,
    mode_samples_per_s: f64,
    mode_samples_per_s_p10: f64,
    mode_samples_per_s_p90: f64,
}

#[derive(Debug, Serialize)]
struct ContactRow {
    integrator: &'static str,
    ns_per_sample: f64,
    ns_per_sample_p10: f64,
    ns_per_sample_p90: f64,
}

/// Growth of the cost of a whole scene.
#[derive(Debug, Serialize)]
struct GrowthRow {
    /// Quantity that grows: `contacts`, each on a body of its own, or `modes` of one body under one
    /// finger.
    axis: &'static str,
    count: usize,
    /// Cost of each: for modes, what they add to a finger on a silent plate.
    ns_per_sample_each: f64,
}

const SCENES: [(&str, Load); 13] = [
    ("nothing touched", Load { contacts: 0, bodies: 1, modes_per_body: 100, lift: false }),
    ("one finger, silent plate", Load { contacts: 1, bodies: 1, modes_per_body: 0, lift: false }),
    ("1 finger, silent plates", Load { contacts: 1, bodies: 1, modes_per_body: 0, lift: false }),
    ("64 fingers, silent plates", Load { contacts: 64, bodies: 64, modes_per_body: 0, lift: false }),
    ("one finger, one body", Load { contacts: 1, bodies: 1, modes_per_body: 100, lift: false }),
    ("ten fingers on ten bodies", Load { contacts: 10, bodies: 10, modes_per_body: 100, lift: false }),
    ("ten bodies rung out", Load { contacts: 10, bodies: 10, modes_per_body: 100, lift: true }),
    ("4 fingers, one body", Load { contacts: 4, bodies: 1, modes_per_body: 100, lift: false }),
    ("16 fingers, one body", Load { contacts: 16, bodies: 1, modes_per_body: 100, lift: false }),
    ("64 fingers, one body", Load { contacts: 64, bodies: 1, modes_per_body: 100, lift: false }),
    ("one finger, 16 modes", Load { contacts: 1, bodies: 1, modes_per_body: 16, lift: false }),
    ("one finger, 256 modes", Load { contacts: 1, bodies: 1, modes_per_body: 256, lift: false }),
    ("one finger, 4096 modes", Load { contacts: 1, bodies: 1, modes_per_body: 4096, lift: false }),
];

const ESTIMATE: &str =
    "median of all blocks or repetitions; p10 and p90: the middle eight tenths lie between";

/// Runs the verb.
///
/// # Errors
/// When the engine refuses a scene made for measuring.
pub fn run(options: &Options) -> Result<(), CliError> {
    let mut progress = Progress::new("measuring", (SCENES.len() + BANKS.len() + 6) as u64);
    let mut scenes = Vec::new();
    for (name, load) in SCENES {
        scenes.push(scene(name, load, options.threads)?);
        progress.advance(1);
    }
    let mut modal_bank = Vec::new();
    for count in BANKS {
        modal_bank.push(bank(count)?);
        progress.advance(1);
    }
    let mut contact = Vec::new();
    for integrator in [Integrator::SemiImplicitEuler, Integrator::ExactEvent, Integrator::EnergyConserving] {
        contact.push(contact_alone(integrator)?);
        progress.advance(1);
    }
    let growth = growth()?;
    progress.advance(1);
    let kernels = kernels::measured()?;
    progress.advance(1);
    let paired = paired::rows()?;
    progress.advance(1);
    drop(progress);
    let report = Report {
        sample_rate_hz: SAMPLE_RATE_HZ,
        block_frames: BLOCK_FRAMES,
        threads: options.threads,
        cpu: cpu_name(),
        instruction_set: format!("{:?}", Level::detect().isa()),
        estimate: ESTIMATE,
        scenes,
        modal_bank,
        contact,
        growth,
        kernels,
        paired,
    };
    output::say_report(&report, options.json, || table(&report))
}

fn refused(error: impl std::fmt::Display) -> CliError {
    CliError::from_error(error).within("headroom")
}

/// Times of the blocks of a scene, s, after the first seconds: the fingers land, or everything
/// rings out.
fn block_times(load: Load, threads: u8, first_s: f64, length_s: f64) -> Result<Vec<f64>, CliError> {
    let config =
        Config { sample_rate_hz: SAMPLE_RATE_HZ, threads: usize::from(threads), ..Config::default() };
    let mut bench = Bench::new(load, config)?;
    let (mut haptic, mut audio) = ([0.0f32; BLOCK_FRAMES], [0.0f32; BLOCK_FRAMES]);
    let [first, length] = [first_s, length_s].map(|s| (s * SAMPLE_RATE_HZ) as usize / BLOCK_FRAMES);
    Ok((0..first + length).map(|_| bench.block(&mut haptic, &mut audio)).skip(first).collect())
}

fn scene(name: &str, load: Load, threads: u8) -> Result<SceneRow, CliError> {
    let mut times_s = block_times(load, threads, if load.lift { 6.0 } else { 0.5 }, SCENE_S)?;
    times_s.sort_by(f64::total_cmp);
    let p99_9_s = quantile(&times_s, 0.999);
    let block = Timing::of(times_s);
    let block_s = BLOCK_FRAMES as f64 / SAMPLE_RATE_HZ;
    let factor = |time_s: f64| block_s / time_s.max(1e-12);
    Ok(SceneRow {
        name: name.to_owned(),
        contacts: if load.lift { 0 } else { load.contacts },
        modes: load.bodies * load.modes_per_body,
        real_time_factor: factor(block.median),
        real_time_factor_p10: factor(block.p90),
        real_time_factor_p90: factor(block.p10),
        block_p50_us: block.median * 1e6,
        block_p99_9_us: p99_9_s * 1e6,
        ns_per_sample: block.median * 1e9 / BLOCK_FRAMES as f64,
        samples_per_s: BLOCK_FRAMES as f64 / block.median.max(1e-12),
    })
}

/// Signal rendered for each row of the growth, s.
const GROWTH_S: f64 = 2.0;
/// Modes under each finger while contacts are counted.
const GROWTH_MODES: usize = 16;

fn growth() -> Result<Vec<GrowthRow>, CliError> {
    let mut rows = Vec::new();
    for count in [1, 2, 4, 8, 16, 32, 64] {
        let load = Load { contacts: count, bodies: count, modes_per_body: GROWTH_MODES, lift: false };
        rows.push(GrowthRow { axis: "contacts", count, ns_per_sample_each: block_ns(load)? / count as f64 });
    }
    let load = |modes_per_body| Load { contacts: 1, bodies: 1, modes_per_body, lift: false };
    let without = block_ns(load(0))?;
    for count in [16, 64, 256, 1024, 4096] {
        let ns = block_ns(load(count))? - without;
        rows.push(GrowthRow { axis: "modes", count, ns_per_sample_each: ns / count as f64 });
    }
    Ok(rows)
}

/// Time of a sample of a scene in the median of its blocks.
fn block_ns(load: Load) -> Result<f64, CliError> {
    Ok(Timing::of(block_times(load, 1, 0.5, GROWTH_S)?).median * 1e9 / BLOCK_FRAMES as f64)
}

/// Renders blocks of a bank of so many modes, force in every sample.
fn ringing(count: usize) -> Result<impl FnMut(), CliError> {
    let mut modes = modes(count).modes;
    sort_by_decay(&mut modes);
    let groups = design_groups(&modes, SAMPLE_RATE_HZ, &GroupOptions::IMPULSE_RING)
        .collect::<Result<Vec<_>, _>>()
        .map_err(refused)?;
    let states = vec![GroupState::REST; groups.len()];
    let mut bank = ModalBank::new(Level::detect(), groups, states);
    let mut rng = Rng::new(1);
    let force: Vec<f32> = (0..BLOCK_FRAMES).map(|_| 1e-6 * (rng.uniform() as f32 - 0.5)).collect();
    let (mut at, mut out) = (0, [0.0f32; BLOCK_FRAMES]);
    Ok(move || {
        out.fill(0.0);
        bank.render(at, Inputs::One(&force), &mut out);
        at += BLOCK_FRAMES as u64;
        std::hint::black_box(&out);
    })
}

/// The bank alone, force in every sample.
fn bank(count: usize) -> Result<BankRow, CliError> {
    let ns = ns_spread(BLOCK_FRAMES * count, ringing(count)?);
    Ok(BankRow {
        modes: count,
        mode_samples_per_s: 1e9 / ns.median,
        mode_samples_per_s_p10: 1e9 / ns.p90,
        mode_samples_per_s_p90: 1e9 / ns.p10,
    })
}

/// The contact model alone on a smooth profile.
fn contact_alone(integrator: Integrator) -> Result<ContactRow, CliError> {
    let model = MicroContact::new(&Probe::default(), integrator, SAMPLE_RATE_HZ).map_err(refused)?;
    let length = 4410;
    let height_m: Vec<f64> = (0..length)
        .map(|n| 2e-5 * (2.0 * std::f64::consts::PI * 100.0 * f64::from(n) / SAMPLE_RATE_HZ).sin())
        .collect();
    let force_n = vec![0.5; height_m.len()];
    let mut rows = vec![ContactSample::default(); height_m.len()];
    let mut state = model.at_rest(0.0, 0.5);
    let ns = ns_spread(height_m.len(), || {
        for begin in (0..height_m.len()).step_by(BLOCK_FRAMES) {
            let part = begin..(begin + BLOCK_FRAMES).min(height_m.len());
            model.run(&mut state, &height_m[part.clone()], &force_n[part.clone()], &mut rows[part]);
        }
        std::hint::black_box(&rows);
    });
    Ok(ContactRow {
        integrator: integrator.name(),
        ns_per_sample: ns.median,
        ns_per_sample_p10: ns.p10,
        ns_per_sample_p90: ns.p90,
    })
}

fn table(report: &Report) -> String {
    use std::fmt::Write;
    let mut text = format!(
        "{} ({}), {}, {} Hz, blocks of {} frames ({:.0} µs)\n\
         every figure is the median of its blocks; the range is that of the middle eight tenths\n\n",
        report.cpu,
        report.instruction_set,
        if report.threads == 1 {
            "one thread".to_owned()
        } else {
            format!("scenes on {} threads", report.threads)
        },
        report.sample_rate_hz,
        report.block_frames,
        report.block_frames as f64 / report.sample_rate_hz * 1e6
    );
    let _ = writeln!(
        text,
        "{:<28}{:>9}{:>7}{:>12}{:>14}{:>12}{:>11}{:>12}",
        "scene", "contacts", "modes", "× real time", "range", "samples/s", "p50 µs", "p99.9 µs"
    );
    for row in &report.scenes {
        let _ = writeln!(
            text,
            "{:<28}{:>9}{:>7}{:>12.0}{:>14}{:>12}{:>11.1}{:>12.1}",
            row.name,
            row.contacts,
            row.modes,
            row.real_time_factor,
            format!("{:.0}–{:.0}", row.real_time_factor_p10, row.real_time_factor_p90),
            format!("{:.2} M", row.samples_per_s * 1e-6),
            row.block_p50_us,
            row.block_p99_9_us
        );
    }
    let _ = writeln!(text, "\n{:<28}{:>28}", "modal bank", "mode-samples a second");
    for row in &report.modal_bank {
        let range =
            format!("{:.2}–{:.2}", row.mode_samples_per_s_p10 / 1e9, row.mode_samples_per_s_p90 / 1e9);
        let modes = format!("{} modes", row.modes);
        let _ = writeln!(text, "{modes:<28}{:>24.2} G{range:>16}", row.mode_samples_per_s / 1e9);
    }
    let _ = writeln!(text, "\n{:<28}{:>28}", "contact model", "ns a sample");
    for row in &report.contact {
        let range = format!("{:.2}–{:.2}", row.ns_per_sample_p10, row.ns_per_sample_p90);
        let _ = writeln!(text, "{:<28}{:>26.2}{range:>16}", row.integrator, row.ns_per_sample);
    }
    for (axis, title) in
        [("contacts", "contacts, a body of 16 modes each"), ("modes", "modes under one finger")]
    {
        let rows = || report.growth.iter().filter(|row| row.axis == axis);
        let first = rows().next().map_or(1.0, |row| row.ns_per_sample_each);
        let _ = writeln!(text, "\n{title:<34}{:>22}{:>14}", "ns a sample and each", "against first");
        for row in rows() {
            let change = 100.0 * (row.ns_per_sample_each / first - 1.0);
            let _ = writeln!(text, "{:<34}{:>22.3}{change:>+12.1} %", row.count, row.ns_per_sample_each);
        }
    }
    report.kernels.table(&mut text);
    report.paired.table(&mut text);
    text.trim_end().to_owned()
}
