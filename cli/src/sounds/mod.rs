//! Sets of sounds, as `strike` and `stroke` write them: one gain for the set, trimmed, with
//! loudness and peak, and the scene and the log of each beside it.
//!
//! | file | content |
//! |---|---|
//! | `NAME.wav` | what is heard, from the first contact on until it has died away |
//! | `NAME.haptic.wav` | what a finger feels, 32-bit float as `render` writes it |
//! | `NAME.toml`, `NAME.jsonl` | the scene and the contact log, which `asperity render` turns into the same samples |
//!
//! Where the scene has no gain of its own the loudest sample of the set lies 1 dB below full scale,
//! so that what is hit harder stays louder.

mod loudness;
mod paths;
mod seam;

use crate::error::CliError;
use crate::output::{self, Outputs, ensure_folder};
use crate::paths::without_ends;
use crate::progress::Progress;
use crate::render;
use crate::wav::{self, Bits};
use asperity::files::contact_log::ContactLog;
use asperity::files::scene_file::SceneFile;
use asperity::offline::Render;
use clap::Args;
pub use loudness::integrated_lufs;
pub use paths::with_absolute_paths;
use paths::with_relative_paths;
pub use seam::Loop;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The loudest sample of a set, dBFS.
const LOUDEST_DB: f64 = -1.0;
/// A sound ends where it stays so far below its peak, dB.
const ENDED_DB: f64 = -80.0;
/// Longest ring-out, s.
pub const MOST_TAIL_S: f64 = 20.0;

/// Options of both verbs.
#[derive(Debug, Clone, Args)]
pub struct Options {
    /// Folder to fill. The loudest sample of the set lies 1 dB below full scale, unless the scene
    /// gives its audio a gain
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// Sample format: 16 or 24 bits, or 32-bit float
    #[arg(long, value_name = "16|24|32", default_value = "24", value_parser = Bits::parse)]
    pub bits: Bits,
    /// Sample rate, Hz; missing: the scene's, or 44100
    #[arg(long, value_name = "HZ", value_parser = render::sample_rate)]
    pub rate: Option<f64>,
    /// Takes of each sound, all different
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=999))]
    pub takes: u16,
    /// Seed of what differs between takes
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// A sound that is to be made.
pub struct Sound {
    /// File name without its end.
    pub name: String,
    /// The scene, its paths absolute, without contacts and tail.
    pub scene: Table,
    /// Kind of sound.
    pub log: ContactLog,
    /// Most of what it may ring out, s; nothing of a loop does.
    pub tail_s: f64,
    /// True where a finger or a tool feels something.
    pub is_felt: bool,
    /// Span that is cut to be played again and again.
    pub cut: Option<Loop>,
}

/// Remarks on how the body or the surface of a set was made.
#[derive(Debug, Default)]
pub struct Told {
    /// Assumptions, where no option was given.
    pub assumed: Vec<String>,
    /// Warnings of the fit, or of the photograph.
    pub warnings: Vec<String>,
}

/// Output of `--json`.
#[derive(Debug, Serialize)]
struct Report {
    files: Vec<FileReport>,
    /// Linear gain that all of them were written with; null where the scene says its own.
    gain: Option<f64>,
    /// Assumptions, where no option was given.
    assumed: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct FileReport {
    name: String,
    seconds: f64,
    /// Integrated loudness, LUFS; null for silence.
    lufs: Option<f64>,
    peak_dbfs: Option<f64>,
}

/// A folder that is removed again when it was made for nothing.
pub struct Folder {
    path: PathBuf,
    is_new: bool,
}

impl Folder {
    /// Makes sure that it is there.
    ///
    /// # Errors
    /// When it cannot be made, or a file has its name.
    pub fn open(path: &Path) -> Result<Self, CliError> {
        let is_new = !path.exists();
        ensure_folder(path)?;
        let path = fs::canonicalize(path).map_err(|error| CliError::write(path, &error))?;
        Ok(Self { path, is_new })
    }

    /// Its absolute path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if self.is_new {
            // Refused, and nothing lost, where files lie in it.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

/// Renders and writes a set, and says what it is.
///
/// # Errors
/// When a scene is refused or a file cannot be written; then none of the set is there.
pub fn make(
    sounds: &[Sound],
    options: &Options,
    folder: &Folder,
    inputs: &[PathBuf],
    remarks: Told,
) -> Result<(), CliError> {
    check_outputs(sounds, folder, inputs)?;
    let Told { assumed, warnings } = remarks;
    let mut report = Report { files: Vec::new(), gain: None, assumed, warnings };
    let mut progress = Progress::new("rendering", 2 * sounds.len() as u64);
    let mut trials = Vec::new();
    for sound in sounds {
        trials.push(Trial::of(sound, options, folder)?);
        progress.advance(1);
    }
    let loudest = trials.iter().filter(|trial| trial.is_levelled).map(|trial| trial.peak).fold(0.0, f64::max);
    if loudest > 0.0 {
        report.gain = Some(db(LOUDEST_DB) / loudest);
    }
    let mut outputs = Outputs::new();
    for (sound, trial) in sounds.iter().zip(trials) {
        let mut scene = trial.scene;
        if let (true, Some(gain)) = (trial.is_levelled, report.gain) {
            set_level(&mut scene, gain);
        }
        scene.insert("tail_s".into(), Value::Float(trial.tail_s));
        report.files.push(write(&mut outputs, sound, &scene, options, folder, &mut report.warnings)?);
        progress.advance(1);
    }
    drop(progress);
    outputs.commit()?;
    output::say_report(&report, options.json, || in_words(&report, &options.output))
}

/// Result of a sound's first rendering.
struct Trial {
    scene: Table,
    /// True where the level is the set's.
    is_levelled: bool,
    peak: f64,
    tail_s: f64,
}

impl Trial {
    fn of(sound: &Sound, options: &Options, folder: &Folder) -> Result<Self, CliError> {
        let mut scene = sound.scene.clone();
        if let Some(rate_hz) = options.rate {
            scene.insert("sample_rate_hz".into(), Value::Float(rate_hz));
        }
        scene.insert("contacts".into(), Value::String(format!("{}.jsonl", sound.name)));
        scene.insert("tail_s".into(), Value::Float(sound.tail_s));
        let is_levelled = !has_level(&scene);
        if is_levelled {
            set_level(&mut scene, 1.0);
        }
        let (render, _) = rendered(&scene, sound, folder)?;
        let peak = render.audio.iter().flatten().fold(0.0, |peak: f64, x| peak.max(f64::from(x.abs())));
        let from = (sound.log.end_s() * render.sample_rate_hz).ceil() as usize;
        let frames = ended(&render, peak * db(ENDED_DB)).max(from);
        // Half a sample short, so that rounding up gives just so many.
        let tail_s = ((frames as f64 - 0.5) / render.sample_rate_hz - sound.log.end_s()).max(0.0);
        Ok(Self { scene, is_levelled, peak, tail_s: if sound.cut.is_some() { 0.0 } else { tail_s } })
    }
}

fn db(level: f64) -> f64 {
    10f64.powf(level / 20.0)
}

/// The frame behind which every bus stays below a level.
fn ended(render: &Render, level: f64) -> usize {
    let last = |bus: &Vec<f32>| bus.iter().rposition(|x| f64::from(x.abs()) > level).map_or(0, |i| i + 1);
    render.audio.iter().map(last).max().unwrap_or(0)
}

/// Tests whether the scene gives a bus its gain.
fn has_level(scene: &Table) -> bool {
    let says = |bus: &Value| bus.get("gain").is_some() || bus.get("pascals_at_full_scale").is_some();
    match scene.get("audio") {
        Some(Value::Array(buses)) => buses.iter().any(says),
        Some(bus) => says(bus),
        None => false,
    }
}

/// Gives every bus a gain, and no limiter behind it: the gain is the set's.
fn set_level(scene: &mut Table, gain: f64) {
    let audio = scene.entry("audio").or_insert_with(|| Value::Table(Table::new()));
    let set = |bus: &mut Value| {
        if let Some(bus) = bus.as_table_mut() {
            bus.insert("gain".into(), Value::Float(gain));
            bus.insert("limit".into(), Value::Boolean(false));
        }
    };
    match audio {
        Value::Array(buses) => buses.iter_mut().for_each(set),
        bus => set(bus),
    }
}

fn rendered(scene: &Table, sound: &Sound, folder: &Folder) -> Result<(Render, Vec<String>), CliError> {
    let path = folder.path().join(format!("{}.toml", sound.name));
    let file = SceneFile::parse(&text_of(scene)?, &path)?;
    render::in_memory(file, &sound.log)
}

fn text_of(scene: &Table) -> Result<String, CliError> {
    toml::to_string(scene).map_err(|error| CliError::from_error(error).within("scene"))
}

fn write(
    outputs: &mut Outputs,
    sound: &Sound,
    scene: &Table,
    options: &Options,
    folder: &Folder,
    warnings: &mut Vec<String>,
) -> Result<FileReport, CliError> {
    let (mut render, remarks) = rendered(scene, sound, folder)?;
    let remarks = remarks.into_iter().map(|line| format!("{}: {line}", sound.name));
    warnings
        .extend(remarks.filter(|line| sound.is_felt || !line.contains("every haptic channel is silence")));
    let rate_hz = render.sample_rate_hz;
    let mut head = format!("# {}.wav\n", sound.name);
    if let Some(cut) = &sound.cut {
        let [from, to, blended] = cut.apply(&mut render);
        head = format!(
            "# {}.wav is samples {from} to {to} of what this renders to, its last {blended} blended into the {blended} before.\n",
            sound.name
        );
    }
    let path = |end: &str| folder.path().join(format!("{}.{end}", sound.name));
    let audio: Vec<&[f32]> = render.audio.iter().map(Vec::as_slice).collect();
    let clipped = wav::write_bits(outputs, &path("wav"), &audio, rate_hz, options.bits)?;
    if clipped > 0 {
        let right = "lower gain under [audio], or write --bits 32";
        warnings
            .push(format!("{}: {clipped} samples were beyond full scale and cut off; {right}", sound.name));
    }
    if sound.is_felt {
        let haptic: Vec<&[f32]> = render.haptic.iter().map(Vec::as_slice).collect();
        wav::write(outputs, &path("haptic.wav"), &haptic, rate_hz)?;
    }
    let scene = text_of(&with_relative_paths(scene, folder.path()))?;
    outputs.write(&path("toml"), (head + &scene).as_bytes())?;
    outputs.write_with(&path("jsonl"), |file| sound.log.write(file))?;
    let peak = audio.iter().copied().flatten().fold(0.0f32, |peak, x| peak.max(x.abs()));
    Ok(FileReport {
        name: sound.name.clone(),
        seconds: audio.first().map_or(0, |bus| bus.len()) as f64 / rate_hz,
        lufs: integrated_lufs(&audio, rate_hz),
        peak_dbfs: (peak > 0.0).then(|| 20.0 * f64::from(peak).log10()),
    })
}

fn in_words(report: &Report, folder: &Path) -> String {
    let mut lines: Vec<String> = report.assumed.clone();
    let widest = 4 + report.files.iter().map(|file| file.name.chars().count()).max().unwrap_or(0);
    let number = |value: Option<f64>| value.map_or("silent".to_owned(), |value| format!("{value:.1}"));
    lines.extend(report.files.iter().map(|file| {
        format!(
            "  {:widest$}  {:6.2} s  {:>7} LUFS  {:>7} dBFS",
            format!("{}.wav", file.name),
            file.seconds,
            number(file.lufs),
            number(file.peak_dbfs)
        )
    }));
    lines.extend(report.warnings.iter().map(|warning| format!("warning: {warning}")));
    let last = report.files.first().map_or("NAME", |file| file.name.as_str());
    let sounds = if report.files.len() == 1 { "sound" } else { "sounds" };
    lines.push(format!("wrote {} {sounds} to {}", report.files.len(), folder.display()));
    lines.push(format!(
        "the same again: asperity render {} -o take",
        output::quoted(&folder.join(format!("{last}.toml")))
    ));
    lines.join("\n")
}

/// Refuses to write over what is read, by whatever path.
fn check_outputs(sounds: &[Sound], folder: &Folder, inputs: &[PathBuf]) -> Result<(), CliError> {
    output::reads(inputs);
    let ends = ["wav", "haptic.wav", "toml", "jsonl"];
    let names = sounds.iter().flat_map(|sound| ends.map(|end| format!("{}.{end}", sound.name)));
    names.map(|name| folder.path().join(name)).try_for_each(|path| output::refuse_input(&path))
}

/// A number in a file's name: `0.3`, `1`.
pub fn short(value: f64) -> String {
    format!("{}", (value * 1e4).round() / 1e4)
}

/// A file's name without folder and ends, fit to be part of another.
pub fn stem(path: &Path) -> String {
    let stem = without_ends(path);
    stem.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
}

/// The end of a name that numbers a take: nothing where there is one.
pub fn take_suffix(take: u16, takes: u16) -> String {
    if takes == 1 { String::new() } else { format!("-{take:0width$}", width = takes.to_string().len()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_takes_sort_as_numbers_do() {
        assert_eq!([take_suffix(1, 1), take_suffix(3, 9), take_suffix(7, 10)], ["", "-3", "-07"]);
        assert_eq!(stem(Path::new("hits/big pan.modes.json")), "big_pan");
        assert_eq!(stem(Path::new("hits/pan.take2.wav")), "pan.take2");
        assert_eq!([short(0.3), short(1.0), short(0.123_456)], ["0.3", "1", "0.1235"]);
    }
}
