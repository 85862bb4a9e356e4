//! `asperity texture rank ORIGINAL FOLDER`: the maps of a folder, ordered by likeness of feel.

use super::{grey, positive};
use crate::error::CliError;
use crate::output;
use crate::paths::has_end;
use crate::progress::Progress;
use asperity_evidence::likeness::Impression;
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Pictures that are looked for in a folder.
const ENDINGS: [&str; 12] =
    ["png", "jpg", "jpeg", "pgm", "ppm", "gif", "exr", "webp", "tif", "tiff", "tga", "bmp"];

/// Order the height maps of a folder by how much they feel like an original, nearest first
#[derive(Debug, Args)]
pub struct Options {
    /// Height map to look for
    #[arg(value_name = "ORIGINAL")]
    pub original: PathBuf,
    /// Folder of height maps; its own folders are not looked into
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,
    /// Strokes on each map
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(10..=10_000))]
    pub strokes: usize,
    /// Width of a map on the surface, m [default: 40 mm]
    #[arg(long, value_name = "M", default_value = "0.04", hide_default_value = true, value_parser = positive)]
    pub width_m: f64,
    /// Height of white over black, m [default: 2 mm]
    #[arg(long, value_name = "M", default_value = "0.002", hide_default_value = true, value_parser = positive)]
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
    original: PathBuf,
    folder: PathBuf,
    strokes: usize,
    width_m: f64,
    relief_m: f64,
    ranking: Vec<Ranked>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Ranked {
    /// Name in the folder.
    file: String,
    /// d′: about 1 is just noticeable.
    distance: f64,
}

/// Runs the verb.
///
/// # Errors
/// When the original cannot be read, or the folder holds no map that can.
pub fn run(options: &Options) -> Result<(), CliError> {
    let names = pictures(&options.folder)?;
    let original = impression(options, &options.original)?;
    let results = distances(options, &original, &names);
    let (mut ranking, mut warnings) = (Vec::new(), Vec::new());
    for (file, result) in names.into_iter().zip(results) {
        match result {
            Ok(distance) => ranking.push(Ranked { file, distance }),
            Err(error) => {
                warnings.push(format!("left out: {}", error.to_string().replacen("error: ", "", 1)))
            }
        }
    }
    if ranking.is_empty() {
        let what = warnings.first().cloned().unwrap_or_else(|| "has no picture".to_owned());
        return Err(CliError::file(&options.folder, what, "give a folder of height maps"));
    }
    ranking.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let &Options { strokes, width_m, relief_m, .. } = options;
    let (original, folder) = (options.original.clone(), options.folder.clone());
    let report = Report { original, folder, strokes, width_m, relief_m, ranking, warnings };
    output::say_report(&report, options.json, || {
        let rows = report.ranking.iter().map(|Ranked { file, distance }| format!("\n{distance:8.2}  {file}"));
        format!(
            "taken to be {} mm wide and {} mm from black to white (--width-m, --relief-m); distances are d′ of one stroke: 1 is \
             about just noticeable{}{}",
            1e3 * width_m,
            1e3 * relief_m,
            rows.collect::<String>(),
            output::warned(&report.warnings)
        )
    })
}

/// Names of the pictures in a folder, in order.
fn pictures(folder: &Path) -> Result<Vec<String>, CliError> {
    let unread = |error| CliError::file(folder, error, "give a folder of height maps");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unread)? {
        let path = entry.map_err(unread)?.path();
        if has_end(&path, &ENDINGS) && path.is_file() {
            names.extend(path.file_name().and_then(|name| name.to_str()).map(str::to_owned));
        }
    }
    names.sort();
    Ok(names)
}

fn impression(options: &Options, path: &Path) -> Result<Impression, CliError> {
    let strokes = (options.strokes, options.seed);
    Impression::of(&grey(path)?, options.width_m, options.relief_m, strokes)
        .map_err(|error| CliError::from_error(error).within(path.display()))
}

/// Distance of each map, on as many threads as the machine has cores.
fn distances(options: &Options, original: &Impression, names: &[String]) -> Vec<Result<f64, CliError>> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let progress = Mutex::new(Progress::new("maps", names.len() as u64));
    let of = &|name: &String| {
        let distance = impression(options, &options.folder.join(name)).map(|map| original.distance(&map));
        if let Ok(mut progress) = progress.lock() {
            progress.advance(1);
        }
        distance
    };
    let share = names.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        let parts: Vec<_> = names
            .chunks(share)
            .map(|part| scope.spawn(move || part.iter().map(of).collect::<Vec<_>>()))
            .collect();
        parts.into_iter().flat_map(|part| part.join().unwrap_or_default()).collect()
    })
}
