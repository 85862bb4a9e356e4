//! Opening a scene: a scene file becomes a running engine.

mod source;

use crate::engine::Engine;
use crate::files::FileError;
use crate::files::scene_file::{
    ActuatorEntry, ActuatorOutput, Excitation as ExcitationEntry, MakeSource, Pixels, ProbeEntry,
    Roughness as RoughnessEntry, SceneFile, Source, SurfaceEntry, Wrap as WrapEntry,
};
use crate::model::probe::{PROBE_PRESETS, probe_by_name};
use crate::{
    ActuatorPreset, ActuatorSettings, AudioBus, Body, BodyId, Config, DeviceProfile, Excitation, Extent,
    Integrator, Material, ModalModel, PathMode, Probe, Quantity, Roughness, Surface, Wrap,
};
use asperity_texture::height_map::HeightMap;
use asperity_texture::image_io::{self, Channel};
use asperity_texture::raster::Raster;
use asperity_texture::sand::SandWorker;
use source::Ground;
use std::cell::RefCell;
use std::path::Path;

/// What the command line may set, whatever the scene file says.
#[derive(Debug, Clone, Copy, Default)]
pub struct Overrides {
    /// Rate of the outputs, Hz.
    pub sample_rate_hz: Option<f64>,
    /// Seed of every random number.
    pub seed: Option<u64>,
    /// Integrator of the contact model.
    pub integrator: Option<Integrator>,
    /// How sparse positions become a path.
    pub path: Option<PathMode>,
    /// For a sound card: sand is simulated on a thread of its own, and peaks of the audio are limited.
    pub live: bool,
    /// Sources of one's own, by the `kind` under which a scene's `own = { kind = "NAME", … }` names them.
    pub own: &'static [(&'static str, MakeSource)],
}

impl Engine {
    /// Reads a scene file and every file that it names, and builds the engine, for a render or a replay.
    ///
    /// # Errors
    /// When a file cannot be used or a number is refused; the message names file and field.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FileError> {
        Self::from_scene(&SceneFile::load(path.as_ref())?, &Overrides::default())
    }

    /// Loads every file that a scene names and builds the engine.
    ///
    /// # Errors
    /// When a file cannot be used or the engine refuses a number; the message names file and field.
    pub fn from_scene(file: &SceneFile, overrides: &Overrides) -> Result<Self, FileError> {
        build(file, overrides)
    }
}

fn build(file: &SceneFile, overrides: &Overrides) -> Result<Engine, FileError> {
    let at = |error: FileError| error.within(file.path.display());
    let config = config(file, overrides).map_err(at)?;
    let (seed, rate_hz) = (config.seed, config.inner_rate_hz());
    let Engine { mut scene, renderer, mut names, .. } =
        config.build().map_err(|error| at(FileError::told(error)))?;
    let workers = RefCell::default();
    for (name, entry) in &file.probes {
        let place = |error: FileError| at(error.within(format!("probe \"{name}\"")));
        let id = probe(entry).and_then(|probe| scene.add_probe(probe).map_err(FileError::told));
        names.probes.insert(name.clone(), id.map_err(place)?);
    }
    for body in &file.bodies {
        let place = |error: FileError| at(error.within(format!("body \"{}\"", body.name)));
        let material = body.material.unwrap_or(Body::DEFAULT_MATERIAL);
        let mut model = match (&body.modes, body.stock) {
            (Some(path), _) => ModalModel::load(path).map_err(FileError::told)?,
            (None, Some((shape, size_m))) => {
                shape.modes(&material, size_m).map_err(|error| place(FileError::told(error)))?
            }
            (None, None) => ModalModel::silent(),
        };
        if let Some(gain) = body.residual {
            let residual = model.residual.take();
            model = model.with_residual(residual, gain).map_err(|error| place(FileError::told(error)))?;
        }
        let thing = Body::new(model).of(material);
        let named = |name: &String| file.audio.iter().position(|bus| bus.name.as_ref() == Some(name));
        let id = scene.add_body(thing.on_bus(body.bus.as_ref().and_then(named).unwrap_or(0)));
        names.bodies.insert(body.name.clone(), id.map_err(|error| place(FileError::told(error)))?);
    }
    for entry in &file.surfaces {
        let place = |error: FileError| at(error.within(format!("surface \"{}\"", entry.name)));
        let body = entry.body.as_ref().and_then(|name| names.bodies.get(name)).copied();
        let stuff =
            file.bodies.iter().find(|body| Some(&body.name) == entry.body.as_ref()).and_then(|b| b.material);
        let live = overrides.live.then_some(&workers);
        let ground = Ground { own: overrides.own, ..ground(entry, (seed, rate_hz), live) };
        let surface = surface(entry, body, stuff, ground).map_err(place)?;
        let id = scene.add_surface(surface).map_err(|error| place(FileError::told(error)))?;
        names.surfaces.insert(entry.name.clone(), id);
    }
    Ok(Engine { scene, renderer, names, workers: workers.into_inner() })
}

fn config(file: &SceneFile, overrides: &Overrides) -> Result<Config, FileError> {
    let default = Config::default();
    let folder = file.path.parent().unwrap_or(Path::new(""));
    Ok(Config {
        sample_rate_hz: overrides.sample_rate_hz.or(file.sample_rate_hz).unwrap_or(default.sample_rate_hz),
        seed: overrides.seed.or(file.seed).unwrap_or(default.seed),
        path: overrides.path.unwrap_or(default.path),
        integrator: overrides.integrator.unwrap_or(default.integrator),
        probe: probe(&file.probe).map_err(|error| error.within("probe"))?,
        actuators: file.actuators.iter().map(|entry| actuator(entry, folder)).collect::<Result<_, _>>()?,
        // A sound card clips what exceeds full scale.
        audio: file
            .audio
            .iter()
            .map(|bus| AudioBus { gain: bus.gain, limit: bus.limit || overrides.live })
            .collect(),
        max_surfaces: default.max_surfaces.max(file.surfaces.len()),
        max_bodies: default.max_bodies.max(file.bodies.len()),
        // A scene is loaded whole before the first block is rendered.
        queue_capacity: default.queue_capacity.max(2 * (file.surfaces.len() + file.bodies.len())),
        ..default
    })
}

fn probe(entry: &ProbeEntry) -> Result<Probe, FileError> {
    let preset = match entry.preset.as_deref() {
        None => Probe::default(),
        Some(name) => probe_by_name(name).ok_or_else(|| {
            let known = PROBE_PRESETS.map(|(name, _)| format!("\"{name}\"")).join(", ");
            let right = format!("must be one of {known}, or write the fields");
            FileError::new("preset", format!("\"{name}\" is unknown"), right)
        })?,
    };
    Ok(Probe {
        pad_mass_kg: entry.pad_mass_kg.unwrap_or(preset.pad_mass_kg),
        pad_stiffness_n_m: entry.pad_stiffness_n_m.unwrap_or(preset.pad_stiffness_n_m),
        pad_damping_n_s_m: entry.pad_damping_n_s_m.unwrap_or(preset.pad_damping_n_s_m),
        finger_mass_kg: entry.finger_mass_kg.unwrap_or(preset.finger_mass_kg),
        contact_stiffness_n_m: entry.contact_stiffness_n_m.unwrap_or(preset.contact_stiffness_n_m),
        leash_m: entry.leash_m.unwrap_or(preset.leash_m),
    })
}

fn actuator(entry: &ActuatorEntry, folder: &Path) -> Result<ActuatorSettings, FileError> {
    Ok(ActuatorSettings {
        output: match entry.output {
            ActuatorOutput::Displacement => Quantity::Displacement,
            ActuatorOutput::Acceleration => Quantity::Acceleration,
        },
        full_scale: entry.full_scale,
        highpass_hz: entry.highpass_hz,
        equalise: device("equalise", entry.equalise.as_deref(), folder)?,
        limit: device("limit", entry.limit.as_deref(), folder)?,
        limit_peaks: entry.limit_peaks,
        ..ActuatorSettings::default()
    })
}

/// A shipped profile by name, or a profile's file, relative to the scene's.
fn device(field: &str, name: Option<&str>, folder: &Path) -> Result<Option<DeviceProfile>, FileError> {
    let Some(name) = name else { return Ok(None) };
    if let Some(preset) = ActuatorPreset::by_name(name) {
        return Ok(Some(preset.profile));
    }
    let at = format!("actuator: {field}");
    if Path::new(name).extension().is_some_and(|ending| ending == "toml") {
        let preset = ActuatorPreset::load(folder.join(name));
        return preset.map(|preset| Some(preset.profile)).map_err(|error| FileError::told(error).within(at));
    }
    let right = format!("must be none, a profile's file (NAME.toml) or one of: {}", ActuatorPreset::names());
    Err(FileError::new(at, format!("\"{name}\" is unknown"), right))
}

/// Heights of a surface on a grid over its extent, the longer edge `longest` points; none where the heights
/// do not belong to places, or the source cannot be made.
pub fn relief(entry: &SurfaceEntry, seed: Option<u64>, longest: usize) -> Option<Raster> {
    let default = Config::default();
    let ground = ground(entry, (seed.unwrap_or(default.seed), default.sample_rate_hz), None);
    ground.relief(&entry.source, longest)
}

fn ground<'a>(
    entry: &SurfaceEntry,
    (seed, sample_rate_hz): (u64, f64),
    workers: Option<&'a RefCell<Vec<SandWorker>>>,
) -> Ground<'a> {
    let wrap = match entry.wrap {
        WrapEntry::Repeat => Wrap::Repeat,
        WrapEntry::Clamp => Wrap::Clamp,
        WrapEntry::Mirror => Wrap::Mirror,
    };
    let extent = Extent { width_m: entry.width_m, height_m: entry.height_m, relief_m: 1.0 };
    Ground { extent, wrap, seed, sample_rate_hz, workers, own: &[] }
}

/// A surface on a body of a material that the scene names has that material's finish where it says nothing else.
fn surface(
    entry: &SurfaceEntry,
    body: Option<BodyId>,
    material: Option<Material>,
    ground: Ground<'_>,
) -> Result<Surface, FileError> {
    let (extent, wrap) = (ground.extent, ground.wrap);
    let source = ground.source(&entry.source)?;
    let surface = Surface::from_source(source, extent.width_m, extent.height_m).map_err(FileError::told)?;
    let surface = surface.wraps(ground.wrap != Wrap::Clamp);
    let surface = match (material, &entry.source) {
        (Some(material), Source::Flat) => surface.of(material),
        // How rough a pictured surface is, its material does not tell: it may be glazed or sanded.
        (Some(material), Source::Map { .. } | Source::Lattice(_)) => {
            surface.of(material).roughness(Roughness::FromSource)
        }
        // Other sources bring a finish of their own.
        _ => surface,
    };
    let mut surface = match &entry.roughness {
        RoughnessEntry::Number(None) => surface,
        RoughnessEntry::Number(Some(r)) => surface.roughness(Roughness::Constant(*r)),
        RoughnessEntry::Map { image, gloss } => {
            let raster = pixels(image)?.raster;
            let raster = if *gloss { raster.map(|gloss| 1.0 - gloss) } else { raster };
            let map = HeightMap::new(&raster, extent, wrap)
                .map_err(|error| FileError::told(error).within(image.path.display()))?;
            surface.roughness(Roughness::Map(Box::new(map)))
        }
    };
    if let Some(rms_m) = entry.micro_relief_m {
        surface = surface.micro_relief_m(rms_m);
    }
    if let Some(friction) = entry.friction {
        surface = surface.friction(friction);
    }
    surface = surface.at_strike_position(entry.strike_position);
    if let Some(excitation) = entry.excitation {
        surface = surface.excitation(match excitation {
            ExcitationEntry::Collisions => Excitation::Collisions,
            ExcitationEntry::Force => Excitation::Force,
            ExcitationEntry::Both => Excitation::Both,
        });
    }
    Ok(match body {
        Some(body) => surface.on(body),
        None => surface,
    })
}

/// One channel of an image file.
pub fn pixels(image: &Pixels) -> Result<image_io::ChannelImage, FileError> {
    let channel = match image.channel {
        Some('r') => Channel::R,
        Some('g') => Channel::G,
        Some('b') => Channel::B,
        Some('a') => Channel::A,
        _ => Channel::Luma,
    };
    image_io::load_channel(&image.path, channel).map_err(FileError::told)
}
