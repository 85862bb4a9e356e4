//! Manifest: `manifest.json`, what a data set holds and what made it.
//!
//! Each shard has a file `NAME.sha256` beside it, written after it. A run lists those and rewrites
//! the manifest whole under a lock, so that runs on many machines that share a folder end with a
//! manifest of all that is there.

use crate::build::Build;
use crate::force;
use crate::spec::Spec;
use crate::stroke::DataLevels;
use crate::whole_file;
use asperity::files::FileError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::path::Path;
use std::time::Duration;

/// Name of the file.
pub const NAME: &str = "manifest.json";
/// The `format` that is written.
pub const FORMAT: u32 = 1;
/// Held while the manifest is rewritten.
const LOCK: &str = ".manifest.lock";
/// A file that nobody has written to for so long is nobody's.
const ABANDONED: Duration = Duration::from_secs(3600);

/// Contents of a data set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of this layout.
    pub format: u32,
    /// Name of the data set.
    pub name: String,
    /// Build that made it.
    #[serde(flatten)]
    pub build: Build,
    /// Seed of every draw.
    pub seed: u64,
    /// Strokes of the whole data set.
    pub strokes: u64,
    /// Strokes a shard; the last may have fewer.
    pub per_shard: u64,
    /// Meaning of sample value 1, and the gain of the sound.
    pub levels: Levels,
    /// Unit and rate of samples.
    pub units: Units,
    /// Further quantities that are felt, in the order of their columns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_haptic: Vec<FurtherHaptic>,
    /// The force and the path, where they are kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<ForceUnits>,
    /// The part that each surface belongs to; empty where parts are made by stroke and each record
    /// says its own.
    #[serde(default)]
    pub splits: BTreeMap<String, String>,
    /// The shards that are there, in order.
    pub shards: Vec<Shard>,
}

/// Levels that hold for every stroke.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// Metres or m/s² at sample value 1 of `haptic`.
    pub haptic_full_scale: f64,
    /// n of a finger's displacement ∝ Fⁿ.
    #[serde(default)]
    pub haptic_felt_force_exponent: f64,
    /// Gain of `audio`.
    pub audio_gain: f64,
}

/// A further quantity that is felt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FurtherHaptic {
    /// Its column.
    pub column: String,
    /// Haptic quantity.
    pub output: String,
    /// Unit of `full_scale`.
    pub unit: String,
    /// Meaning of sample value 1.
    pub full_scale: f64,
    /// n of a finger's displacement ∝ Fⁿ.
    #[serde(default)]
    pub felt_force_exponent: f64,
    /// Samples a second, Hz.
    pub rate_hz: f64,
}

/// The force and the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForceUnits {
    /// Rows a second, Hz.
    pub rate_hz: f64,
    /// Its columns, whose names say their units.
    pub columns: Vec<String>,
}

/// Unit of a quantity.
fn unit_of(output: &str) -> String {
    match output {
        "acceleration" => "m/s^2",
        "force" => "N",
        _ => "m",
    }
    .to_owned()
}

/// Units and rates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Units {
    /// Unit of `haptic_full_scale`.
    pub haptic: String,
    /// Haptic column.
    pub haptic_output: String,
    /// Samples a second of `haptic`, Hz.
    pub haptic_rate_hz: f64,
    /// Meaning of sample value 1 of `audio`.
    pub audio: String,
    /// Samples a second of `audio`, Hz.
    pub audio_rate_hz: f64,
    /// Codec of `audio`.
    pub audio_codec: String,
}

/// One shard.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Its file, in the data set's folder.
    pub file: String,
    /// SHA-256 of its bytes.
    pub sha256: String,
    /// Strokes in it.
    pub strokes: u64,
}

impl Manifest {
    /// Manifest of a specification, without shards.
    #[must_use]
    pub fn new(spec: &Spec, build: &Build, levels: &DataLevels, splits: BTreeMap<String, String>) -> Self {
        let output = &spec.says.output;
        let (haptic, audio) = (&output.haptic[0], &output.audio);
        let further = output.haptic.iter().zip(&levels.full_scale).skip(1);
        Self {
            format: FORMAT,
            name: spec.says.name.clone(),
            build: build.clone(),
            seed: spec.says.seed,
            strokes: spec.says.strokes,
            per_shard: spec.says.per_shard,
            levels: Levels {
                haptic_full_scale: levels.full_scale[0],
                haptic_felt_force_exponent: haptic.exponent(),
                audio_gain: levels.gain,
            },
            units: Units {
                haptic: unit_of(&haptic.output),
                haptic_output: haptic.output.clone(),
                haptic_rate_hz: haptic.rate_hz,
                audio: "full scale".to_owned(),
                audio_rate_hz: audio.rate_hz,
                audio_codec: audio.codec.name().to_owned(),
            },
            further_haptic: further
                .map(|(haptic, full_scale)| FurtherHaptic {
                    column: haptic.further_column(),
                    output: haptic.output.clone(),
                    unit: unit_of(&haptic.output),
                    full_scale: *full_scale,
                    felt_force_exponent: haptic.exponent(),
                    rate_hz: haptic.rate_hz,
                })
                .collect(),
            force: output.force.map(|force| ForceUnits {
                rate_hz: force.rate_hz,
                columns: force::COLUMNS.map(str::to_owned).to_vec(),
            }),
            splits,
            shards: Vec::new(),
        }
    }

    /// The levels that its strokes were made with.
    #[must_use]
    pub fn data_levels(&self) -> DataLevels {
        let further = self.further_haptic.iter().map(|haptic| haptic.full_scale);
        let full_scale = std::iter::once(self.levels.haptic_full_scale).chain(further).collect();
        DataLevels { full_scale, gain: self.levels.audio_gain }
    }

    /// Reads the manifest of a data set; none where there is none yet.
    ///
    /// # Errors
    /// When it cannot be read or is none of ours.
    pub fn load(folder: &Path) -> Result<Option<Self>, FileError> {
        let path = folder.join(NAME);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(FileError::read(&path, &error)),
        };
        let manifest: Self = serde_json::from_slice(&bytes).map_err(|error| {
            FileError::file(
                &path,
                format!("is no manifest ({error})"),
                "remove it; the next run writes it anew",
            )
        })?;
        if manifest.format != FORMAT {
            let what = format!("has format {}", manifest.format);
            return Err(FileError::file(&path, what, format!("this program reads format {FORMAT}")));
        }
        Ok(Some(manifest))
    }

    /// Writes it with every shard that is there.
    ///
    /// # Errors
    /// When the folder cannot be read or written.
    pub fn write(&mut self, folder: &Path) -> Result<(), FileError> {
        let _held = lock(folder)?;
        self.shards = listed(folder, self.strokes, self.per_shard)?;
        remove_left_behind(folder);
        let path = folder.join(NAME);
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|error| FileError::from_error(error).within(path.display()))?;
        text.push('\n');
        whole_file::write(&path, text.as_bytes())
    }
}

/// Place of a shard's hash.
#[must_use]
pub fn sum_name(file: &str) -> String {
    format!("{file}.sha256")
}

/// Holds the folder for as long as it is kept: nobody else begins a file, counts shards or clears
/// up.
///
/// # Errors
/// When the lock cannot be made.
pub(crate) fn lock(folder: &Path) -> Result<File, FileError> {
    let path = folder.join(LOCK);
    let held = File::create(&path).map_err(|error| FileError::write(&path, &error))?;
    // A file system without locks has no worse fate than a manifest that the next run completes.
    let _ = held.lock();
    Ok(held)
}

/// Removes what killed runs have left half-written: files that no process holds. Where the file
/// system has no locks, those that nobody has written to within the hour. A file that cannot be
/// removed harms nobody.
fn remove_left_behind(folder: &Path) {
    let is_old = |path: &Path| {
        let age = fs::metadata(path).and_then(|about| about.modified()).ok().and_then(|at| at.elapsed().ok());
        age.is_some_and(|age| age > ABANDONED)
    };
    let is_left = |path: &Path| match File::open(path).map(|file| file.try_lock()) {
        Ok(Ok(())) => true,
        Ok(Err(TryLockError::WouldBlock)) => false,
        _ => is_old(path),
    };
    for entry in fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok) {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with('.') && name.ends_with(".part") && is_left(&entry.path()) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Every shard whose hash stands beside it, in order.
fn listed(folder: &Path, strokes: u64, per_shard: u64) -> Result<Vec<Shard>, FileError> {
    let entries = fs::read_dir(folder).map_err(|error| FileError::read(folder, &error))?;
    let mut shards = Vec::new();
    for entry in entries.filter_map(Result::ok) {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(index) = index_of(&name) else { continue };
        let Ok(text) = fs::read_to_string(folder.join(sum_name(&name))) else { continue };
        let sha256 = text.split_whitespace().next().unwrap_or_default().to_owned();
        let held = per_shard.min(strokes.saturating_sub(index * per_shard));
        shards.push((index, Shard { file: name, sha256, strokes: held }));
    }
    shards.sort_by_key(|(index, _)| *index);
    Ok(shards.into_iter().map(|(_, shard)| shard).collect())
}

/// The number of a shard, by its name.
fn index_of(name: &str) -> Option<u64> {
    let (number, extension) = name.strip_prefix("shard-")?.split_once('.')?;
    ["parquet", "tar"].contains(&extension).then(|| number.parse().ok())?
}
