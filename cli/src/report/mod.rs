//! `asperity report`: what every choice the engine offers costs, and what it costs in accuracy.
//!
//! One file an axis; each measures its choices on the same input against a reference that it names.
//! The error is the rms of the difference over the alternating rms of the reference.

mod blocks;
mod cases;
mod choices;
pub mod end_to_end;
mod excitation;
mod from_reports;
pub mod integrator;
mod map_filter;
pub mod modes;
mod noise;
mod path;
mod resampled;
mod shed;
mod stability;
mod stability_picture;
mod strokes;
mod through;
mod write;

use crate::error::CliError;
use crate::measure::cpu_name;
use crate::output::{self, Outputs, ensure_folder};
use crate::progress::Progress;
use cases::{CASES, SEEDS};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Rate at which everything is measured, Hz.
const SAMPLE_RATE_HZ: f64 = 44_100.0;
/// Samples handed to a kernel at once, as the engine does.
const BLOCK: usize = 64;

/// Measure speed against error for every choice the engine offers
#[derive(Debug, Args)]
pub struct Options {
    /// Folder for speed_vs_error.json, .svg and .md, and stability.svg
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// Print the JSON object too
    #[arg(long)]
    pub json: bool,
}

/// One choice, measured.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Choice.
    pub axis: &'static str,
    /// Which choice.
    pub choice: String,
    /// Cost.
    pub ns_per_sample: f64,
    /// Rms of the difference over the alternating rms of the reference: the worst of all cases.
    pub error: f64,
    /// Reference that it is compared with.
    pub reference: &'static str,
    /// The error on each named case, where a choice has them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<CaseError>,
    /// Second error, measured as `error`.
    pub worst: f64,
    /// Over all cases and quantities.
    pub geometric_mean: f64,
    /// Delay of a path behind the reports, ms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency_ms: Option<f64>,
    /// Missed excitation where modes of a struck body are left out: within this 99 of 100 cells of
    /// an ERB and 20 ms excite the ear as all modes do, dB.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation_db: Option<f64>,
}

/// A choice on a named case ([`cases`]).
#[derive(Debug, Clone, Serialize)]
pub struct CaseError {
    /// Name of the case.
    pub name: &'static str,
    /// Error of the pad's displacement, where the choice reaches it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<f64>,
    /// Error of the contact force, where the choice reaches it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contact_force: Option<f64>,
    /// Error of the outputs: the worse of felt and heard.
    pub output: f64,
}

impl Row {
    /// A choice with one error.
    fn of(
        (axis, choice): (&'static str, impl Into<String>),
        ns_per_sample: f64,
        error: f64,
        reference: &'static str,
    ) -> Self {
        Self {
            axis,
            choice: choice.into(),
            ns_per_sample,
            error,
            reference,
            cases: Vec::new(),
            worst: error,
            geometric_mean: error,
            latency_ms: None,
            excitation_db: None,
        }
    }

    /// A choice with its errors on the named cases.
    fn on_cases(
        (axis, choice): (&'static str, impl Into<String>),
        ns_per_sample: f64,
        cases: Vec<CaseError>,
        reference: &'static str,
    ) -> Self {
        let errors = || {
            let of = |case: &CaseError| [case.displacement, case.contact_force, Some(case.output)];
            cases.iter().flat_map(of).flatten()
        };
        let worst = errors().fold(0.0, f64::max);
        let mean = errors().map(|error| error.max(1e-16).ln()).sum::<f64>() / errors().count().max(1) as f64;
        let row = Self::of((axis, choice), ns_per_sample, worst, reference);
        Self { cases, geometric_mean: mean.exp(), ..row }
    }
}

#[derive(Debug, Serialize)]
struct Report {
    cpu: String,
    sample_rate_hz: f64,
    rows: Vec<Row>,
    end_to_end: Vec<end_to_end::Preset>,
    from_reports: Vec<from_reports::Stroke>,
    load: Vec<shed::LoadLevel>,
    stability: Vec<stability::Cell>,
}

type Axis = fn() -> Result<Vec<Row>, CliError>;

/// Every axis, in the order of the report.
const AXES: [Axis; 14] = [
    integrator::rows,
    choices::oversampling_rows,
    choices::exciter_rows,
    path::rows,
    from_reports::rows,
    map_filter::rows,
    map_filter::rows_on_cases,
    noise::rows,
    noise::rows_on_cases,
    modes::culling_rows,
    modes::stroked_sleep_rows,
    modes::shedding_rows,
    modes::format_rows,
    blocks::rows,
];

/// Runs the verb.
///
/// # Errors
/// When the folder cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    ensure_folder(&options.output)?;
    let mut progress = Progress::new("measuring", AXES.len() as u64 + 3);
    let mut rows = Vec::new();
    for axis in AXES {
        rows.extend(axis()?);
        progress.advance(1);
    }
    let end_to_end = end_to_end::presets()?;
    let from_reports = from_reports::strokes()?;
    progress.advance(1);
    let load = shed::levels()?;
    progress.advance(1);
    let stability = stability::cells()?;
    drop(progress);
    let (cpu, sample_rate_hz) = (cpu_name(), SAMPLE_RATE_HZ);
    let report = Report { cpu, sample_rate_hz, rows, end_to_end, from_reports, load, stability };
    let mut outputs = Outputs::new();
    let path = |name: &str| options.output.join(name);
    outputs.write_json(&path("speed_vs_error.json"), &report)?;
    outputs.write(
        &path("speed_vs_error.svg"),
        write::svg(&report.cpu, &report.rows, &report.end_to_end).as_bytes(),
    )?;
    let text = write::markdown(&report.cpu, &report.rows, &report.end_to_end)
        + &write::strokes_table(&report.from_reports)
        + &write::load_table(&report.load)
        + &stability_picture::markdown(&report.stability);
    outputs.write(&path("speed_vs_error.md"), text.as_bytes())?;
    outputs.write(&path("stability.svg"), stability_picture::svg(&report.stability).as_bytes())?;
    let folder = path("cases");
    ensure_folder(&folder)?;
    for case in &CASES {
        for (name, bytes) in cases::files(case, *SEEDS.start(), None)? {
            // The body is the same in all of them.
            if case.name == CASES[0].name || !name.ends_with("modes.json") {
                outputs.write(&folder.join(name), &bytes)?;
            }
        }
    }
    let files = outputs.commit()?;
    output::say_report(&report, options.json, || format!("{text}\nwrote {}", output::listed(&files)))
}

/// A kernel that refuses its own defaults is a defect.
fn refused(error: impl std::fmt::Display) -> CliError {
    CliError::from_error(error).within("report")
}
