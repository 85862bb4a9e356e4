//! The scene file: one TOML table a thing, in SI units, every key checked and named when refused.
//!
//! This file and its neighbours hold what a user wrote, as plain data with paths already relative
//! to the file. Nothing here opens an image or uses the engine;
//! [`Engine::from_scene`](crate::Engine::from_scene) turns a [`SceneFile`] into engine calls.

mod body;
mod fields;
mod named_files;
mod own;
mod pickup;
mod pixels;
mod probe;
mod sand;
mod source;
mod surface;

pub use body::BodyEntry;
pub use own::{MakeSource, OwnSource};
pub use pickup::PickupEntry;
pub use pixels::Pixels;
pub use sand::{Sand, ToolPicture};
pub use source::{Brownian, Lattice, Source};
pub use surface::{RoughnessEntry, SurfaceEntry};

use crate::files::FileError;
use crate::files::nearest::decimal_comma;
use crate::files::other_file::other_file;
use crate::files::storage::{Disk, Files};
use crate::model::actuator::{ActuatorSettings, Quantity};
use crate::model::bus::MAX_BUSES;
use crate::parameters;
use asperity_dsp::micro_contact::Probe;
use fields::Fields;
use std::path::{Path, PathBuf};
use toml::Value;

/// Scene files larger than this are refused; a scene is a page, not a database.
const MAX_BYTES: usize = 16 << 20;
/// Default ring-out after the last event, seconds.
const TAIL_S: f64 = 1.0;

/// A whole scene.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// The file it was read from, for messages.
    pub path: PathBuf,
    /// Rate of the WAV files; none = the engine's default.
    pub sample_rate_hz: Option<f64>,
    /// Seed of every random number; none = the engine's default.
    pub seed: Option<u64>,
    /// Contact log to render; none where the events come from elsewhere.
    pub contacts: Option<PathBuf>,
    /// Ring-out after the last event, seconds.
    pub tail_s: f64,
    /// Things that ring.
    pub bodies: Vec<BodyEntry>,
    /// Things that are touched.
    pub surfaces: Vec<SurfaceEntry>,
    /// Probe that touches unless a contact says otherwise.
    pub probe: Probe,
    /// Further probes, by name.
    pub probes: Vec<(String, Probe)>,
    /// Haptic channels, in order.
    pub actuators: Vec<ActuatorEntry>,
    /// Audio buses, in channel order.
    pub audio: Vec<AudioEntry>,
    /// Channels of pickups, in order; their places are their bodies'.
    pub pickups: Vec<PickupEntry>,
}

/// One haptic channel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ActuatorEntry {
    /// All that needs no other file and no level of the scene: its `full_scale`,
    /// `felt_force_exponent` and `limit_peaks` do not count.
    pub settings: ActuatorSettings,
    /// Metres or m/s² at sample value 1; none = by the level policy.
    pub full_scale: Option<f64>,
    /// n of a finger's displacement ∝ Fⁿ; none =
    /// [`FELT_FORCE_EXPONENT`](crate::model::actuator::FELT_FORCE_EXPONENT) where the level is by
    /// policy, otherwise 0.
    pub felt_force_exponent: Option<f64>,
    /// Keeps the channel within ±1, whatever the device; none = where the level is by policy.
    pub limit_peaks: Option<bool>,
    /// Name or file of the device whose response is inverted; none = no equaliser.
    pub equalise: Option<String>,
    /// Name or file of the device whose excursion and heat are kept within limits; none = no limit.
    pub limit: Option<String>,
}

/// An audio bus.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AudioEntry {
    /// Name that bodies use; none for a single bus.
    pub name: Option<String>,
    /// Linear gain; none = by the level policy.
    pub gain: Option<f64>,
    /// Pascals at 1 m at sample value 1, of bodies whose modes are in pascals; none = their numbers
    /// are as any other's.
    pub pascals_at_full_scale: Option<f64>,
    /// Keeps the channel within ±1; none = before a sound card, where a device is named, and where
    /// the gain is by policy.
    pub limit: Option<bool>,
}

impl SurfaceEntry {
    /// Reads one table of `[[surface]]` by itself.
    pub(crate) fn read(table: toml::Table, folder: &Path) -> Result<Self, FileError> {
        surface::read(Fields::new(table, "surface"), folder)
    }
}

impl BodyEntry {
    /// Indices of the buses that it plays on, and how loud on each; the loudest first.
    pub(crate) fn plays_on(&self, audio: &[AudioEntry]) -> Vec<(usize, f64)> {
        let index = |name: &String| audio.iter().position(|bus| bus.name.as_ref() == Some(name));
        let named = self.sends.iter().filter(|(_, gain)| *gain > 0.0);
        let mut on: Vec<_> = named.filter_map(|(bus, gain)| Some((index(bus)?, *gain))).collect();
        on.sort_by(|(_, a), (_, b)| b.total_cmp(a));
        if on.is_empty() {
            on.push((self.bus.as_ref().and_then(index).unwrap_or(0), 1.0));
        }
        on
    }

    /// Reads one table of `[[body]]` by itself.
    pub(crate) fn read(table: toml::Table, folder: &Path) -> Result<Self, FileError> {
        body::read(Fields::new(table, "body"), folder)
    }
}

/// Reads one table of `[[probe]]` by itself.
///
/// # Errors
/// When a key is unknown or out of its range.
pub fn probe_of(table: toml::Table) -> Result<Probe, FileError> {
    let mut fields = Fields::new(table, "probe");
    fields.text("name")?;
    probe::read(fields)
}

impl SceneFile {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// When the file is missing, is not TOML, or a key is unknown, missing or out of its range.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        Self::load_from(&Disk, path)
    }

    /// [`load`](Self::load), from wherever the files lie.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: &Path) -> Result<Self, FileError> {
        let bytes = files.read(path).map_err(|error| FileError::read(path, &error))?;
        if bytes.len() > MAX_BYTES {
            let right = format!("a scene file has at most {} MB", MAX_BYTES >> 20);
            return Err(FileError::file(path, format!("is {} MB long", bytes.len() >> 20), right));
        }
        if let Some((what, right)) = other_file(&bytes) {
            return Err(FileError::file(path, what, right));
        }
        match std::str::from_utf8(&bytes) {
            Ok(text) => Self::parse(text, path),
            Err(_) => Err(FileError::read(path, &std::io::ErrorKind::InvalidData.into())),
        }
    }

    /// Checks the text of a scene file that lies at `path`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            let line =
                error.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count());
            let written = text.lines().nth(line - 1).and_then(decimal_comma);
            let right = written.map_or("a scene file is TOML".to_owned(), |right| format!("write {right}"));
            FileError::file(path, format!("line {line}: {}", error.message()), right)
        })?;
        read(Fields::new(table, ""), path).map_err(|error| error.within(path.display()))
    }
}

fn read(mut top: Fields, path: &Path) -> Result<SceneFile, FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut bodies = Vec::new();
    for fields in top.tables("body")? {
        bodies.push(body::read(fields, folder)?);
    }
    let mut surfaces = Vec::new();
    for fields in top.tables("surface")? {
        surfaces.push(surface::read(fields, folder)?);
    }
    let mut actuators = Vec::new();
    for fields in top.tables("actuator")? {
        actuators.push(read_actuator(fields)?);
    }
    if actuators.is_empty() {
        actuators.push(ActuatorEntry::default());
    }
    top.whole("version", 1, 1)?;
    let (probe, probes) = probe::read_all(&mut top)?;
    let audio = read_buses(&mut top)?;
    let pickups = pickup::read_all(&mut top, &mut bodies)?;
    let scene = SceneFile {
        path: path.to_owned(),
        sample_rate_hz: top.number(&parameters::scene::SAMPLE_RATE_HZ)?,
        seed: top.seed(&parameters::scene::SEED)?,
        contacts: top.file("contacts", folder)?,
        tail_s: top.number_or(&parameters::scene::TAIL_S, TAIL_S)?,
        bodies,
        surfaces,
        probe,
        probes,
        actuators,
        audio,
        pickups,
    };
    top.finish()?;
    check_names(&scene)?;
    Ok(scene)
}

/// Names are unique, and every name that is used exists.
fn check_names(scene: &SceneFile) -> Result<(), FileError> {
    let bodies: Vec<&str> = scene.bodies.iter().map(|body| body.name.as_str()).collect();
    let surfaces: Vec<&str> = scene.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    for (what, names) in [("body", &bodies), ("surface", &surfaces)] {
        for (index, name) in names.iter().enumerate() {
            if names[..index].contains(name) {
                let at = format!("{what} {} \"{name}\": name", index + 1);
                return Err(FileError::new(at, "is used twice", "give each a name of its own"));
            }
        }
    }
    let buses: Vec<&str> = scene.audio.iter().filter_map(|bus| bus.name.as_deref()).collect();
    for body in &scene.bodies {
        let sends = body.sends.iter().map(|(bus, _)| ("sends", bus));
        let mut named = body.bus.iter().map(|bus| ("bus", bus)).chain(sends);
        if let Some((key, bus)) = named.find(|(_, bus)| !buses.contains(&bus.as_str())) {
            let known: Vec<String> = buses.iter().map(|name| format!("\"{name}\"")).collect();
            let right = match known.as_slice() {
                [] => "name a bus under [[audio]]".to_owned(),
                _ => format!("buses of this scene: {}", fields::any_of(&known)),
            };
            let at = format!("body \"{}\": {key}", body.name);
            return Err(FileError::new(at, format!("\"{bus}\" is unknown"), right));
        }
    }
    for (index, surface) in scene.surfaces.iter().enumerate() {
        if let Some(body) = surface.body.as_deref().filter(|body| !bodies.contains(body)) {
            let at = format!("surface {} \"{}\": body", index + 1, surface.name);
            let known: Vec<String> = bodies.iter().map(|name| format!("\"{name}\"")).collect();
            let right = format!("bodies of this scene: {}", fields::any_of(&known));
            return Err(FileError::new(at, format!("\"{body}\" is unknown"), right));
        }
    }
    Ok(())
}

fn read_actuator(mut fields: Fields) -> Result<ActuatorEntry, FileError> {
    let words = [
        ("displacement", Quantity::Displacement),
        ("acceleration", Quantity::Acceleration),
        ("tangential", Quantity::Tangential),
        ("force", Quantity::Force),
    ];
    let default = ActuatorSettings::default();
    let output = fields.word("output", &words)?.unwrap_or(default.output);
    let equalise = fields.text("equalise")?.filter(|name| name != "none");
    let (limit, limit_peaks) = match fields.take("limit") {
        // A device that is named is kept whole unless the scene says otherwise.
        None => (equalise.clone(), None),
        Some(Value::Boolean(false)) => (None, Some(false)),
        // The limits of the device that is equalised; without one, those of the file: full scale.
        Some(Value::Boolean(true)) => (equalise.clone(), Some(equalise.is_none())),
        Some(Value::String(device)) => (Some(device), Some(false)),
        Some(other) => {
            let what = format!("{} is refused", fields::shown(&other));
            return Err(fields.refuse("limit", what, "must be true, false or a device's name"));
        }
    };
    let full_scale = fields.number(&parameters::actuator::FULL_SCALE)?;
    let felt_force_exponent = fields.number(&parameters::actuator::FELT_FORCE_EXPONENT)?;
    let lowpass_hz = fields.number(&parameters::actuator::LOWPASS_HZ)?;
    let highpass_hz = fields.number_or(&parameters::actuator::HIGHPASS_HZ, default.highpass_hz)?;
    fields.finish()?;
    let settings = ActuatorSettings { output, lowpass_hz, highpass_hz, ..default };
    Ok(ActuatorEntry { settings, full_scale, felt_force_exponent, limit_peaks, equalise, limit })
}

/// `[audio]`, one bus for all, or `[[audio]]`, one table a bus.
fn read_buses(top: &mut Fields) -> Result<Vec<AudioEntry>, FileError> {
    if !top.is_list("audio") {
        let only = top.table("audio")?.map(read_audio).transpose()?;
        return Ok(vec![only.unwrap_or_default()]);
    }
    let buses = top.tables("audio")?.into_iter().map(read_audio).collect::<Result<Vec<_>, _>>()?;
    for (index, bus) in buses.iter().enumerate() {
        let at = format!("audio {}", index + 1);
        if bus.name.is_none() && buses.len() > 1 {
            return Err(FileError::new(format!("{at}: name"), "is missing", "give each bus a name"));
        }
        if bus.name.is_some() && buses[..index].iter().any(|before| before.name == bus.name) {
            return Err(FileError::new(
                format!("{at}: name"),
                "is used twice",
                "give each a name of its own",
            ));
        }
    }
    match buses.len() {
        0 => Err(FileError::new("audio", "is an empty list", "write [audio], or one [[audio]] a bus")),
        1..=MAX_BUSES => Ok(buses),
        many => Err(FileError::new("audio", format!("has {many} buses"), format!("at most {MAX_BUSES}"))),
    }
}

fn read_audio(mut fields: Fields) -> Result<AudioEntry, FileError> {
    let audio = AudioEntry {
        name: fields.text("name")?,
        gain: fields.number(&parameters::audio::GAIN)?,
        pascals_at_full_scale: fields.number(&parameters::audio::PASCALS_AT_FULL_SCALE)?,
        limit: fields.flag("limit")?,
    };
    fields.finish()?;
    Ok(audio)
}

#[cfg(test)]
mod tests;
