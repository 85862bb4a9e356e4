//! `asperity texture compare A B …`: can a finger tell them apart? The ABX tables of a published
//! study without its participants.

use super::{grey, positive, refused};
use crate::error::CliError;
use crate::output;
use crate::progress::Progress;
use asperity_evidence::compare::{self, Asked, Comparison, Table};
use asperity_pictures::metamer::{Method, PASSES};
use asperity_surface::raster::Raster;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Ask a machine which of two surfaces a stroke was on: 0.5 is chance, 1 is certain
#[derive(Debug, Args)]
pub struct Options {
    /// Height maps, 2 to 8; the first is the reference of the metamers
    #[arg(value_name = "MAP", num_args = 2..=8, required = true)]
    pub maps: Vec<PathBuf>,
    /// Also compare metamers of all maps to the first: single pass and default
    #[arg(long)]
    pub metamers: bool,
    /// Ask the observer with people's thresholds and difference limens, who misses what a finger
    /// misses, instead of a machine that misses next to nothing
    #[arg(long)]
    pub observer: bool,
    /// Strokes on each surface
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(20..=10_000))]
    pub strokes: usize,
    /// Passes of the default metamer
    #[arg(long, default_value_t = PASSES, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1000))]
    pub iterations: usize,
    /// Width of a map on the surface, m [default: 40 mm, that of the published study's samples]
    #[arg(long, value_name = "M", default_value = "0.04", value_parser = positive)]
    pub width_m: f64,
    /// Height of white over black, m [default: 2 mm, that of the samples]
    #[arg(long, value_name = "M", default_value = "0.002", value_parser = positive)]
    pub relief_m: f64,
    /// Seed of the strokes
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    maps: Vec<PathBuf>,
    strokes: usize,
    width_m: f64,
    relief_m: f64,
    seed: u64,
    judge: Asked,
    originals: Table,
    single_pass: Option<Table>,
    metamers: Option<Table>,
}

impl Options {
    fn asked(&self) -> Asked {
        if self.observer { Asked::Observer } else { Asked::Machine }
    }
}

/// Runs the verb.
///
/// # Errors
/// When a map cannot be read, or is too small for a metamer.
pub fn run(options: &Options) -> Result<(), CliError> {
    let maps = options.maps.iter().map(|path| grey(path)).collect::<Result<Vec<_>, _>>()?;
    let sets = if options.metamers { 3 } else { 1 };
    let mut progress = Progress::new("strokes", (sets * maps.len()) as u64);
    let originals = table(options, &maps, 0, &mut progress)?;
    let mut matched = |method, set| -> Result<Option<Table>, CliError> {
        if !options.metamers {
            return Ok(None);
        }
        table(options, &all_like_the_first(options, &maps, method)?, set, &mut progress).map(Some)
    };
    let report = Report {
        maps: options.maps.clone(),
        strokes: options.strokes,
        width_m: options.width_m,
        relief_m: options.relief_m,
        seed: options.seed,
        judge: options.asked(),
        originals,
        single_pass: matched(Method::SinglePass, 1)?,
        metamers: matched(Method::Iterated(options.iterations), 2)?,
    };
    drop(progress);
    output::say_report(&report, options.json, || in_words(&report))
}

/// The first map and the others made to feel like it.
fn all_like_the_first(options: &Options, maps: &[Raster], method: Method) -> Result<Vec<Raster>, CliError> {
    compare::all_like_the_first(maps, method, |_| ()).map_err(|(place, error)| {
        refused(super::metamer::at(&error, &options.maps[place], &options.maps[0]), &error)
    })
}

fn table(options: &Options, maps: &[Raster], set: u64, progress: &mut Progress) -> Result<Table, CliError> {
    let &Options { strokes, width_m, relief_m, seed, .. } = options;
    let comparison = Comparison { asked: options.asked(), strokes, width_m, relief_m, seed };
    comparison
        .table(maps, set, || progress.advance(1))
        .map_err(|(place, error)| CliError::from_error(error).within(options.maps[place].display()))
}

fn in_words(report: &Report) -> String {
    let mut text = String::new();
    for (number, path) in report.maps.iter().enumerate() {
        text.push_str(&format!("{}  {}\n", number + 1, path.display()));
    }
    text.push_str(&format!(
        "\ntaken to be {} mm wide and {} mm from black to white (--width-m, --relief-m); rows and columns are the maps \
         above by number, a cell how often strokes of the two are told apart: 0.5 is chance, 1.0 always\n",
        1e3 * report.width_m,
        1e3 * report.relief_m
    ));
    let tables = [
        ("originals", Some(&report.originals)),
        ("single pass", report.single_pass.as_ref()),
        ("metamers", report.metamers.as_ref()),
    ];
    for (name, table) in tables {
        let Some(table) = table else { continue };
        let Table { mean, reference, same, .. } = table;
        text.push_str(&format!(
            "\n{name}: the first against the others {reference:.2}, all pairs {mean:.2}, same against same {same:.2}\n"
        ));
        let numbers: Vec<String> = (1..=table.rows.len()).map(|number| format!("{number:4}")).collect();
        text.push_str(&format!("     {}\n", numbers.join("  ")));
        for (row, number) in table.rows.iter().zip(1..) {
            let cells: Vec<String> = row.iter().map(|cell| format!("{cell:.2}")).collect();
            text.push_str(&format!("{number:3}  {}\n", cells.join("  ")));
        }
    }
    text.trim_end().to_owned()
}
