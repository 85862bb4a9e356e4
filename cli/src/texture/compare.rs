//! `asperity texture compare A B …`: can a finger tell them apart? Document 002's ABX tables without
//! observers.

use super::abx::{self, Features, Size};
use super::{grey, positive, refused};
use crate::error::CliError;
use crate::output;
use crate::progress::Progress;
use asperity_texture::borders::Borders;
use asperity_texture::metamer::{MetamerOptions, Method, PASSES, metamer};
use asperity_texture::raster::Raster;
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
    /// Strokes on each surface
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(20..=10_000))]
    pub strokes: usize,
    /// Passes of the default metamer
    #[arg(long, default_value_t = PASSES, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1000))]
    pub iterations: usize,
    /// What a map's width is on the surface, m [default: 40 mm, as in document 002]
    #[arg(long, value_name = "M", default_value = "0.04", value_parser = positive)]
    pub width_m: f64,
    /// Height of white over black, m [default: 2 mm, as in document 002]
    #[arg(long, value_name = "M", default_value = "0.002", value_parser = positive)]
    pub relief_m: f64,
    /// Seed of the strokes
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Share of right answers for every pair; the diagonal is a surface against itself, stroked again.
#[derive(Debug, Clone, Serialize)]
pub struct Table {
    rows: Vec<Vec<f64>>,
    /// Mean over the pairs of different surfaces.
    mean: f64,
    /// Mean over the pairs of the first surface, which metamers are made like, and another one: what counts for them, and what
    /// the mean over all pairs hides.
    reference: f64,
    /// Mean of the diagonal: chance, if the judge is honest.
    same: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    maps: Vec<PathBuf>,
    strokes: usize,
    width_m: f64,
    relief_m: f64,
    seed: u64,
    originals: Table,
    single_pass: Option<Table>,
    metamers: Option<Table>,
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
        originals,
        single_pass: matched(Method::SinglePass, 1)?,
        metamers: matched(Method::Iterated(options.iterations), 2)?,
    };
    drop(progress);
    if options.json {
        return output::say_json(&report);
    }
    output::say(&in_words(&report));
    Ok(())
}

/// The first map and the others made to feel like it.
fn all_like_the_first(options: &Options, maps: &[Raster], method: Method) -> Result<Vec<Raster>, CliError> {
    let mut all = vec![maps[0].clone()];
    for (map, path) in maps.iter().zip(&options.maps).skip(1) {
        // Every map is spread over the same width, so that texels may differ in size.
        let scale = maps[0].width as f64 / map.width as f64;
        let settings = MetamerOptions { method, scale, ..MetamerOptions::default() };
        let made = metamer(map, &maps[0], &settings, |_| {})
            .map_err(|error| refused(super::metamer::at(&error, path, &options.maps[0]), &error))?;
        all.push(made.image);
    }
    Ok(all)
}

fn table(options: &Options, maps: &[Raster], set: u64, progress: &mut Progress) -> Result<Table, CliError> {
    let mut felt: Vec<Vec<Features>> = Vec::new();
    for (index, (map, path)) in maps.iter().zip(&options.maps).enumerate() {
        let size = Size { texel_m: options.width_m / map.width as f64, relief_m: options.relief_m };
        let tiles = Borders::Detect.decide(map) == Borders::Periodic;
        let seed = options.seed.wrapping_mul(1000).wrapping_add(set * 100 + index as u64);
        // Twice as many: the second half is the same surface stroked again.
        let strokes = abx::strokes(map, tiles, size, 2 * options.strokes, seed)
            .map_err(|error| error.within(path.display()))?;
        felt.push(strokes);
        progress.advance(1);
    }
    let n = options.strokes;
    let cell = |i: usize, j: usize| {
        let other = if i == j { &felt[j][n..] } else { &felt[j][..n] };
        abx::right_answers(&felt[i][..n], other)
    };
    let size = maps.len();
    let rows: Vec<Vec<f64>> = (0..size).map(|i| (0..size).map(|j| cell(i, j)).collect()).collect();
    let all: f64 = rows.iter().flatten().sum();
    let same: f64 = (0..size).map(|i| rows[i][i]).sum();
    let mean = (all - same) / (size * (size - 1)) as f64;
    let reference = rows[0][1..].iter().sum::<f64>() / (size - 1) as f64;
    Ok(Table { rows, mean, reference, same: same / size as f64 })
}

fn in_words(report: &Report) -> String {
    let mut text = String::new();
    for (number, path) in report.maps.iter().enumerate() {
        text.push_str(&format!("{}  {}\n", number + 1, path.display()));
    }
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
        for row in &table.rows {
            let cells: Vec<String> = row.iter().map(|cell| format!("{cell:.2}")).collect();
            text.push_str(&format!("  {}\n", cells.join("  ")));
        }
    }
    text.push_str("\n0.5 is chance; 1.0: always told apart");
    text
}
