//! `asperity report`: what every choice the engine offers costs, and what it costs in accuracy.
//!
//! One file an axis; each measures its choices on the same input against a reference that it names. The
//! error is the rms of the difference over the alternating rms of the reference.

mod blocks;
mod integrator;
mod map_filter;
mod modes;
mod noise;
mod path;
mod stability;
mod stability_picture;
mod write;

use crate::error::CliError;
use crate::measure::cpu_name;
use crate::output::{self, Outputs, ensure_folder};
use crate::progress::Progress;
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
    /// What is chosen.
    pub axis: &'static str,
    /// Which choice.
    pub choice: String,
    /// Cost.
    pub ns_per_sample: f64,
    /// Rms of the difference over the alternating rms of the reference.
    pub error: f64,
    /// What it is compared with.
    pub reference: &'static str,
}

#[derive(Debug, Serialize)]
struct Report {
    cpu: String,
    sample_rate_hz: f64,
    rows: Vec<Row>,
    stability: Vec<stability::Cell>,
}

type Axis = fn() -> Result<Vec<Row>, CliError>;

/// Every axis, in the order of the report.
const AXES: [Axis; 10] = [
    integrator::rows,
    path::rows,
    map_filter::rows,
    noise::rows,
    modes::culling_rows,
    modes::sleep_rows,
    modes::shedding_rows,
    modes::struck_shedding_rows,
    modes::format_rows,
    blocks::rows,
];

/// Runs the verb.
///
/// # Errors
/// When the folder cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    ensure_folder(&options.output)?;
    let mut progress = Progress::new("measuring", AXES.len() as u64 + 1);
    let mut rows = Vec::new();
    for axis in AXES {
        rows.extend(axis()?);
        progress.advance(1);
    }
    let stability = stability::cells()?;
    drop(progress);
    let report = Report { cpu: cpu_name(), sample_rate_hz: SAMPLE_RATE_HZ, rows, stability };
    let json = serde_json::to_string_pretty(&report).map_err(CliError::told)?;
    let mut outputs = Outputs::new();
    let path = |name: &str| options.output.join(name);
    outputs.write(&path("speed_vs_error.json"), json.as_bytes())?;
    outputs.write(&path("speed_vs_error.svg"), write::svg(&report.cpu, &report.rows).as_bytes())?;
    let text = write::markdown(&report.cpu, &report.rows) + &stability_picture::markdown(&report.stability);
    outputs.write(&path("speed_vs_error.md"), text.as_bytes())?;
    outputs.write(&path("stability.svg"), stability_picture::svg(&report.stability).as_bytes())?;
    let files = outputs.commit()?;
    if options.json {
        return output::say_json(&report);
    }
    let names: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
    output::say(&format!("{text}\nwrote {}", names.join(", ")));
    Ok(())
}

/// A kernel that refuses its own defaults is a defect.
fn refused(error: impl std::fmt::Display) -> CliError {
    CliError::told(error).within("report")
}
