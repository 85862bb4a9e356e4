//! The scene file: one TOML table a thing, in SI units, every key checked and named when refused.
//!
//! This file and its neighbours hold what a user wrote, as plain data with paths already relative to the
//! file. Nothing here opens an image or knows the engine; [`Engine::from_scene`](crate::Engine::from_scene) turns a
//! [`SceneFile`] into engine calls.

mod fields;
mod own;
mod pixels;
mod sand;
mod source;
mod surface;

pub use own::{MakeSource, OwnSource};
pub use pixels::Pixels;
pub use sand::{Sand, Tool};
pub use source::{Brownian, BrownianForce, Direction, Lattice, SolidNoise, Source};
pub use surface::{Excitation, Roughness, SurfaceEntry, Wrap};

use crate::files::FileError;
use crate::model::bus::MAX_BUSES;
use crate::model::material::Material;
use crate::model::stock::Stock;
use asperity_dsp::limits::{self, Range};
use fields::Fields;
use std::path::{Path, PathBuf};
use toml::Value;

/// Scene files larger than this are refused; a scene is a page, not a database.
const MAX_BYTES: u64 = 16 << 20;
/// Default ring-out after the last event, seconds.
const TAIL_S: f64 = 1.0;
/// Longest ring-out, s.
const LONGEST_TAIL_S: Range = Range::new(0.0, 600.0, "0 to 600 s");

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
    /// What touches unless a contact says otherwise.
    pub probe: ProbeEntry,
    /// Further probes, by name.
    pub probes: Vec<(String, ProbeEntry)>,
    /// Haptic channels, in order.
    pub actuators: Vec<ActuatorEntry>,
    /// Audio buses, in channel order.
    pub audio: Vec<AudioEntry>,
}

/// A body: what an impact on it sounds like.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEntry {
    /// Name that surfaces and impacts use.
    pub name: String,
    /// Modes file; none = those of `stock`, or silent.
    pub modes: Option<PathBuf>,
    /// A stock shape and its size, m.
    pub stock: Option<(Stock, f64)>,
    /// What it is made of; none = the engine's default.
    pub material: Option<Material>,
    /// Gain of the residual that its modes file may carry; none = 1, 0 = not played.
    pub residual: Option<f64>,
    /// Name of the bus it plays on; none = the first.
    pub bus: Option<String>,
}

/// A finger or tool: a preset, and constants that differ from it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ProbeEntry {
    /// Name of a preset; none = the engine's default.
    pub preset: Option<String>,
    /// Mass of the moving pad, kg.
    pub pad_mass_kg: Option<f64>,
    /// Stiffness between pad and finger, N/m.
    pub pad_stiffness_n_m: Option<f64>,
    /// Damping between pad and finger, N·s/m.
    pub pad_damping_n_s_m: Option<f64>,
    /// Mass of the finger, kg.
    pub finger_mass_kg: Option<f64>,
    /// Stiffness of pad against surface, N/m.
    pub contact_stiffness_n_m: Option<f64>,
    /// How far the finger may leave the surface, m.
    pub leash_m: Option<f64>,
}

/// One haptic channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorEntry {
    /// What the channel carries.
    pub output: ActuatorOutput,
    /// Metres or m/s² at sample value 1.
    pub full_scale: f64,
    /// Cutoff of the high-pass about the mean surface, Hz; 0 = off.
    pub highpass_hz: f64,
    /// Name of a device profile whose response is inverted; none = no equaliser.
    pub equalise: Option<String>,
    /// Name of the device profile whose excursion and heat are kept within limits; none = no limit.
    pub limit: Option<String>,
    /// Keeps the channel within ±1, whatever the device.
    pub limit_peaks: bool,
}

impl Default for ActuatorEntry {
    fn default() -> Self {
        Self {
            output: ActuatorOutput::Displacement,
            full_scale: 1e-4,
            highpass_hz: 10.0,
            equalise: None,
            limit: None,
            limit_peaks: false,
        }
    }
}

/// What a haptic channel carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActuatorOutput {
    /// Displacement of the pad, m.
    Displacement,
    /// Acceleration of the pad, m/s².
    Acceleration,
}

/// An audio bus.
#[derive(Debug, Clone, PartialEq)]
pub struct AudioEntry {
    /// Name that bodies use; none for a single bus.
    pub name: Option<String>,
    /// Linear gain.
    pub gain: f64,
    /// Keeps the channel within ±1.
    pub limit: bool,
}

impl SceneFile {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// When the file is missing, is not TOML, or a key is unknown, missing or out of its range.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let size = std::fs::metadata(path).map_err(|error| FileError::read(path, &error))?.len();
        if size > MAX_BYTES {
            let right = format!("a scene file has at most {} MB", MAX_BYTES >> 20);
            return Err(FileError::file(path, format!("is {} MB long", size >> 20), right));
        }
        let text = std::fs::read_to_string(path).map_err(|error| FileError::read(path, &error))?;
        Self::parse(&text, path)
    }

    /// Checks the text of a scene file that lies at `path`.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
            let line =
                error.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count());
            FileError::file(path, format!("line {line}: {}", error.message()), "a scene file is TOML")
        })?;
        read(Fields::new(table, ""), path).map_err(|error| error.within(path.display()))
    }
}

fn read(mut top: Fields, path: &Path) -> Result<SceneFile, FileError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut bodies = Vec::new();
    for fields in top.tables("body")? {
        bodies.push(read_body(fields, folder)?);
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
    let (probe, probes) = read_probes(&mut top)?;
    let audio = read_buses(&mut top)?;
    let scene = SceneFile {
        path: path.to_owned(),
        sample_rate_hz: top.number("sample_rate_hz", limits::output::SAMPLE_RATE_HZ)?,
        seed: top.whole("seed", 0, u64::MAX)?,
        contacts: top.file("contacts", folder)?,
        tail_s: top.number_or("tail_s", TAIL_S, LONGEST_TAIL_S)?,
        bodies,
        surfaces,
        probe,
        probes,
        actuators,
        audio,
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
        if let Some(bus) = body.bus.as_deref().filter(|bus| !buses.contains(bus)) {
            let known: Vec<String> = buses.iter().map(|name| format!("\"{name}\"")).collect();
            let right = match known.as_slice() {
                [] => "name a bus under [[audio]]".to_owned(),
                _ => format!("buses of this scene: {}", fields::any_of(&known)),
            };
            let at = format!("body \"{}\": bus", body.name);
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

fn read_body(mut fields: Fields, folder: &Path) -> Result<BodyEntry, FileError> {
    let name = fields.needed_text("name")?;
    let place = format!("{} \"{name}\"", fields.inner("").trim_end_matches(": "));
    fields.rename(place);
    let body = BodyEntry {
        name,
        modes: fields.file("modes", folder)?,
        stock: read_stock(&mut fields)?,
        material: read_material(&mut fields)?,
        residual: fields.number("residual", limits::material::RESIDUAL)?,
        bus: fields.text("bus")?,
    };
    if body.modes.is_some() && body.stock.is_some() {
        return Err(fields.refuse("stock", "stands beside modes", "write one of them"));
    }
    fields.finish()?;
    Ok(body)
}

/// `stock` and the `size_m` that it needs.
fn read_stock(fields: &mut Fields) -> Result<Option<(Stock, f64)>, FileError> {
    let shape = fields.word("stock", &Stock::ALL)?;
    let size_m = fields.number("size_m", limits::material::SIZE_M)?;
    match (shape, size_m) {
        (Some(shape), Some(size_m)) => Ok(Some((shape, size_m))),
        (Some(_), None) => {
            Err(fields.missing("size_m", "its longest side or its diameter, for instance 0.3"))
        }
        (None, Some(_)) => {
            Err(fields.refuse("size_m", "stands without stock", "write stock = \"bar\", or leave it out"))
        }
        (None, None) => Ok(None),
    }
}

/// A preset's name, or a table of constants: elastic ones, and what else differs from the default material.
fn read_material(fields: &mut Fields) -> Result<Option<Material>, FileError> {
    let table = match fields.take("material") {
        None => return Ok(None),
        Some(Value::String(name)) => {
            let unknown = || {
                let right = format!("must be one of: {}, or a table of constants", Material::names());
                fields.refuse("material", format!("\"{name}\" is unknown"), right)
            };
            return Material::by_name(&name).map(Some).ok_or_else(unknown);
        }
        Some(Value::Table(table)) => table,
        Some(other) => {
            let what = format!("{} is not a material", fields::shown(&other));
            let right = "write a preset's name, or { young_pa = …, poisson = …, density_kg_m3 = … }";
            return Err(fields.refuse("material", what, right));
        }
    };
    use limits::material as range;
    let mut fields = Fields::new(table, fields.inner("material"));
    let young_pa = fields.needed_number("young_pa", range::YOUNG_PA)?;
    let poisson = fields.needed_number("poisson", range::POISSON)?;
    let other =
        Material::new(young_pa, poisson, fields.needed_number("density_kg_m3", range::DENSITY_KG_M3)?);
    let material = Material {
        alpha_per_s: fields.number_or("alpha_per_s", other.alpha_per_s, range::ALPHA_PER_S)?,
        eta: fields.number_or("eta", other.eta, range::ETA)?,
        beta_s: fields.number_or("beta_s", other.beta_s, range::BETA_S)?,
        mu_static: fields.number_or("mu_static", other.mu_static, limits::FRICTION)?,
        mu_kinetic: fields.number_or("mu_kinetic", other.mu_kinetic, limits::FRICTION)?,
        roughness: fields.number_or("roughness", other.roughness, limits::ROUGHNESS)?,
        micro_relief_m: fields.number_or("micro_relief_m", other.micro_relief_m, limits::MICRO_RELIEF_M)?,
        ..other
    };
    fields.finish()?;
    Ok(Some(material))
}

/// `[probe]`, the only one, or `[[probe]]`, of which the one without a name is the default.
fn read_probes(top: &mut Fields) -> Result<(ProbeEntry, Vec<(String, ProbeEntry)>), FileError> {
    if !top.is_list("probe") {
        let only = top.table("probe")?.map(read_probe).transpose()?;
        return Ok((only.unwrap_or_default(), Vec::new()));
    }
    let (mut default, mut named) = (None, Vec::<(String, ProbeEntry)>::new());
    for mut fields in top.tables("probe")? {
        match fields.text("name")? {
            None if default.is_some() => {
                let right = "only one probe is the default";
                return Err(fields.refuse("name", "is missing for the second time", right));
            }
            Some(name) if named.iter().any(|(known, _)| *known == name) => {
                return Err(fields.refuse("name", "is used twice", "give each a name of its own"));
            }
            None => default = Some(read_probe(fields)?),
            Some(name) => named.push((name, read_probe(fields)?)),
        }
    }
    Ok((default.unwrap_or_default(), named))
}

fn read_probe(mut fields: Fields) -> Result<ProbeEntry, FileError> {
    let probe = ProbeEntry {
        preset: fields.text("preset")?,
        pad_mass_kg: fields.number("pad_mass_kg", limits::probe::PAD_MASS_KG)?,
        pad_stiffness_n_m: fields.number("pad_stiffness_n_m", limits::probe::PAD_STIFFNESS_N_M)?,
        pad_damping_n_s_m: fields.number("pad_damping_n_s_m", limits::probe::PAD_DAMPING_N_S_M)?,
        finger_mass_kg: fields.number("finger_mass_kg", limits::probe::FINGER_MASS_KG)?,
        contact_stiffness_n_m: fields
            .number("contact_stiffness_n_m", limits::probe::CONTACT_STIFFNESS_N_M)?,
        leash_m: fields.number("leash_m", limits::probe::LEASH_M)?,
    };
    fields.finish()?;
    Ok(probe)
}

fn read_actuator(mut fields: Fields) -> Result<ActuatorEntry, FileError> {
    let words =
        [("displacement", ActuatorOutput::Displacement), ("acceleration", ActuatorOutput::Acceleration)];
    let default = ActuatorEntry::default();
    let output = fields.word("output", &words)?.unwrap_or(default.output);
    let equalise = fields.text("equalise")?.filter(|name| name != "none");
    let (limit, limit_peaks) = match fields.take("limit") {
        None | Some(Value::Boolean(false)) => (None, false),
        // The limits of the device that is equalised; without one, those of the file: full scale.
        Some(Value::Boolean(true)) => (equalise.clone(), equalise.is_none()),
        Some(Value::String(device)) => (Some(device), false),
        Some(other) => {
            let what = format!("{} is refused", fields::shown(&other));
            return Err(fields.refuse("limit", what, "must be true, false or a device's name"));
        }
    };
    let actuator = ActuatorEntry {
        output,
        full_scale: match fields.number("full_scale", limits::output::FULL_SCALE)? {
            Some(full_scale) => full_scale,
            None if output == ActuatorOutput::Displacement => default.full_scale,
            None => {
                return Err(fields.missing("full_scale", "the m/s² at sample value 1.0, for instance 100.0"));
            }
        },
        highpass_hz: fields.number_or("highpass_hz", default.highpass_hz, limits::output::HIGHPASS_HZ)?,
        equalise,
        limit,
        limit_peaks,
    };
    fields.finish()?;
    Ok(actuator)
}

/// `[audio]`, one bus for all, or `[[audio]]`, one table a bus.
fn read_buses(top: &mut Fields) -> Result<Vec<AudioEntry>, FileError> {
    if !top.is_list("audio") {
        let only = top.table("audio")?.map(read_audio).transpose()?;
        return Ok(vec![only.unwrap_or(AudioEntry { name: None, gain: 1.0, limit: false })]);
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
        gain: fields.number_or("gain", 1.0, limits::output::AUDIO_GAIN)?,
        limit: fields.flag("limit")?.unwrap_or(false),
    };
    fields.finish()?;
    Ok(audio)
}

#[cfg(test)]
mod tests;
