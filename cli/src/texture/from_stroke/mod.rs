//! `asperity texture from-stroke STROKE… -o DIR`: recorded strokes become a surface and a scene.

mod input;
mod picture;
mod report;
mod scene;

use super::positive;
use crate::error::CliError;
use crate::output::{self, Outputs};
use crate::paths::has_end;
use asperity_stroke::report::Report;
use asperity_stroke::{Options as FitOptions, StrokeError, StrokeSurface, Tool, models, surface};
use clap::{Args, ValueEnum};
use input::Recorded;
use report::Written;
use std::path::PathBuf;

/// Make a touchable surface of recorded strokes
#[derive(Debug, Args)]
pub struct Options {
    /// Strokes over one surface: WAV, CSV with a header line, or XML of published models
    #[arg(value_name = "STROKE", required = true)]
    pub strokes: Vec<PathBuf>,
    /// Folder to write to
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// Probe that stroked: a preset, or a TOML file of a scene's probe fields
    #[arg(long, value_name = "NAME|FILE")]
    pub probe: String,
    /// Speed, m/s: a number, one a file with commas, or a column
    #[arg(long, value_name = "V|COLUMN")]
    pub speed: Option<String>,
    /// Pressing force, N: a number, one a file with commas, or a column
    #[arg(long, value_name = "N|COLUMN")]
    pub force: Option<String>,
    /// Rate of a CSV without a column time_s, Hz
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub rate: Option<f64>,
    /// Unit of the samples [default: m_s2]
    #[arg(long, value_enum)]
    pub unit: Option<Unit>,
    /// Columns of the recording; several axes are folded by power [default: all that are nothing
    /// else]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub columns: Vec<String>,
    /// Column of the force along the surface, N: gives friction
    #[arg(long, value_name = "COLUMN")]
    pub tangential: Option<String>,
    /// Recording of sound: ring of the body, a hit or a modes file
    #[arg(long, value_name = "FILE", conflicts_with = "unit")]
    pub ring: Option<PathBuf>,
    /// Response of the recording rig: CSV frequency_hz,gain_db
    #[arg(long, value_name = "FILE")]
    pub colour: Option<PathBuf>,
    /// Relative error of each of the probe's constants, for the stated errors
    #[arg(long, value_name = "SHARE", default_value_t = surface::PROBE_ERROR)]
    pub probe_error: f64,
    /// Print one JSON object, the same as surface.json
    #[arg(long)]
    pub json: bool,
}

/// Units of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Unit {
    /// Acceleration, m/s².
    #[value(name = "m_s2")]
    MetresPerSecondSquared,
    /// Acceleration, 9.80665 m/s².
    G,
    /// Displacement, µm.
    Um,
}

/// Files that every run may write.
const WRITTEN: [&str; 6] =
    ["scene.toml", "stroke.jsonl", "surface.json", "surface.svg", "displacement.png", "ring.modes.json"];

/// Runs the verb.
///
/// # Errors
/// When a recording cannot be read, is no stroke, or is not explained; when the folder cannot be
/// written.
pub fn run(options: &Options) -> Result<(), CliError> {
    WRITTEN.iter().try_for_each(|name| output::refuse_input(&options.output.join(name)))?;
    if !(0.0..1.0).contains(&options.probe_error) {
        let what = format!("{} is refused", options.probe_error);
        return Err(CliError::new("--probe-error", what, "must be 0 to below 1"));
    }
    let probe = input::probe(&options.probe)?;
    let quantity = input::quantity(options)?;
    let tool = Tool { probe: probe.constants, quantity };
    let fit_options = FitOptions {
        tool,
        probe_error: options.probe_error,
        colour: options.colour.as_deref().map(input::colour).transpose()?,
    };
    let mut progress = super::bar("from stroke");
    let found = found(options, &fit_options)?;
    progress(1.0);
    write(options, &probe, &fit_options, &found)
}

fn found(options: &Options, fit_options: &FitOptions) -> Result<StrokeSurface, CliError> {
    let first = &options.strokes[0];
    let at =
        |error: StrokeError| CliError::new(error.field, error.what, error.expected).within(first.display());
    if options.strokes.iter().any(|path| has_end(path, &["xml"])) {
        if options.strokes.len() > 1 {
            return Err(CliError::file(
                first,
                "stands beside other files",
                "name one file of models by itself",
            ));
        }
        let text = std::fs::read_to_string(first).map_err(|error| CliError::read(first, &error))?;
        let models = models::read(&text).map_err(at)?;
        return surface::fit_models(&models, fit_options).map_err(at);
    }
    let Recorded { strokes, tangential_n, remarks } = input::strokes(options)?;
    let mut found = surface::fit(&strokes, tangential_n.as_deref(), fit_options).map_err(at)?;
    found.warnings.splice(0..0, remarks);
    Ok(found)
}

fn write(
    options: &Options,
    probe: &input::NamedProbe,
    fit_options: &FitOptions,
    found: &StrokeSurface,
) -> Result<(), CliError> {
    output::ensure_folder(&options.output)?;
    let folder = &options.output;
    let mut outputs = Outputs::new();
    let mut files = Vec::new();
    let mut text = |outputs: &mut Outputs, name: &str, text: &str| {
        files.push(name.to_owned());
        outputs.write(&folder.join(name), text.as_bytes())
    };
    let ring = match &fit_options.tool.quantity {
        asperity_stroke::Quantity::Sound(ring) => Some(scene::ring_file(ring).to_json()),
        _ => None,
    };
    if let Some(ring) = &ring {
        text(&mut outputs, "ring.modes.json", ring)?;
    }
    let map = scene::Map::of(found);
    text(&mut outputs, "scene.toml", &scene::scene(found, probe, map.as_ref(), ring.is_some()))?;
    text(&mut outputs, "stroke.jsonl", &scene::stroke(found, map.as_ref()).to_jsonl())?;
    text(&mut outputs, "surface.svg", &picture::svg(&name(options), found))?;
    files.push("surface.json".to_owned());
    if let Some(map) = &map {
        files.push("displacement.png".to_owned());
        outputs.write(&folder.join("displacement.png"), &map.png)?;
    }
    let report = Written { report: Report::of(found), files };
    outputs.write_json(&folder.join("surface.json"), &report)?;
    outputs.commit()?;
    output::say_report(&report, options.json, || report.in_words(folder))
}

fn name(options: &Options) -> String {
    let names = options.strokes.iter().filter_map(|path| path.file_name());
    names.map(|name| name.to_string_lossy().into_owned()).collect::<Vec<_>>().join(", ")
}
