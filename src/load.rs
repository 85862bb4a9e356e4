//! From a scene file to a running engine.

mod change;
mod doubts;
pub mod levels;
mod parts;

use crate::engine::Engine;
use crate::files::scene_file::{AudioEntry, MakeSource, PickupEntry, SceneFile, SurfaceEntry};
use crate::files::sensor_profile::SensorPreset;
use crate::files::{Disk, FileError, Files};
pub use crate::make::edit::{Edits, MakeSurface};
use crate::make::maker::{self, Loader};
pub use crate::make::maps::Maps;
use crate::model::bus::AudioBus;
use crate::model::clock_mode::ClockMode;
use crate::model::config::Config;
use crate::model::preset::Preset;
use crate::resource::probe::remark;
use asperity_dsp::micro_contact::{Integrator, MicroContact};
use asperity_dsp::sensor::SensorProfile;
use asperity_dsp::simd::Isa;
use asperity_dsp::trajectory::PathMode;
use asperity_surface::raster::Raster;
pub use change::Changes;
use levels::Levels;
pub use parts::ReadSurface;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// Way of opening a scene, and settings that count more than the scene file's.
#[derive(Clone, Copy)]
pub struct Overrides<'a> {
    /// Place of the files that the scene names; the disk by default.
    pub files: &'a dyn Files,
    /// Rate of the outputs, Hz.
    pub sample_rate_hz: Option<f64>,
    /// Seed of every random number.
    pub seed: Option<u64>,
    /// Accuracy of the engine; the fields below count more.
    pub preset: Preset,
    /// Inner samples where there would be one ([`Config::oversampling`]).
    pub oversampling: Option<usize>,
    /// Integrator of the contact model.
    pub integrator: Option<Integrator>,
    /// Way from sparse positions to a path.
    pub path: Option<PathMode>,
    /// Instruction set of the kernels whose last bits depend on it.
    pub kernel: Option<Isa>,
    /// Most contacts that sound at once
    /// ([`Config::max_contacts`](field@crate::Config::max_contacts)). A render of one finger that
    /// makes room for few opens faster; the bits are the same.
    pub max_contacts: Option<usize>,
    /// Threads that render at once; 1 by default
    /// ([`Config::threads`](field@crate::Config::threads)).
    pub threads: Option<usize>,
    /// Conversion of game time to samples; exactly by default, for a render or a replay.
    /// A game that opens a scene and runs now takes [`ClockMode::LIVE`].
    pub clock: Option<ClockMode>,
    /// For a sound card: sand is simulated on a thread of its own, and peaks of the audio are
    /// limited.
    pub live: bool,
    /// Sources of one's own, by the `kind` under which a scene's `own = { kind = "NAME", … }` names
    /// them: `Engine::from_scene(&SceneFile::load(path)?, &Overrides { own: &[("NAME", make)],
    /// ..Overrides::default() })`. What makes them may be called more than once ([`MakeSource`]).
    pub own: &'a [(&'a str, MakeSource)],
    /// For [`Scene::apply`](crate::Scene::apply): files that hold something else than before,
    /// though the scene names them alike. What is made from them is made anew.
    pub touched: &'a [PathBuf],
    /// Maps that were made already: scenes that are opened with the same ones, one after the other,
    /// read, decode and filter a picture once. A picture that changes meanwhile is not read again.
    pub maps: Option<&'a Maps>,
}

impl Default for Overrides<'_> {
    fn default() -> Self {
        Self {
            files: &Disk,
            sample_rate_hz: None,
            seed: None,
            preset: Preset::Default,
            oversampling: None,
            integrator: None,
            path: None,
            kernel: None,
            max_contacts: None,
            threads: None,
            clock: None,
            live: false,
            own: &[],
            touched: &[],
            maps: None,
        }
    }
}

impl Engine {
    /// Reads a scene file and every file that it names, and builds the engine, for a render or a
    /// replay.
    ///
    /// # Errors
    /// When a file cannot be used or a number is refused; the message names file and field.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FileError> {
        Self::open_from(&Disk, path)
    }

    /// [`open`](Self::open), from wherever the files lie: memory, or an engine's archive.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_from(files: &dyn Files, path: impl AsRef<Path>) -> Result<Self, FileError> {
        let file = SceneFile::load_from(files, path.as_ref())?;
        Self::from_scene(&file, &Overrides { files, ..Overrides::default() })
    }

    /// Loads every file that a scene names and builds the engine.
    ///
    /// # Errors
    /// When a file cannot be used or the engine refuses a number; the message names file and field.
    pub fn from_scene(file: &SceneFile, overrides: &Overrides<'_>) -> Result<Self, FileError> {
        build(file, overrides)
    }
}

fn build(file: &SceneFile, overrides: &Overrides<'_>) -> Result<Engine, FileError> {
    let own = Maps::default();
    let maps = overrides.maps.unwrap_or(&own);
    let trial = |levels: &Levels| {
        let plain = |mut config: Config| {
            for actuator in &mut config.actuators {
                (actuator.equalise, actuator.limit, actuator.limit_peaks) = (None, None, false);
            }
            config.audio.iter_mut().for_each(|bus| bus.limit = false);
            config
        };
        // Levels are a scene's, however exactly it is rendered.
        let trial =
            Overrides { live: false, clock: None, preset: Preset::Default, oversampling: None, ..*overrides };
        assemble(file, &trial, maps, levels, plain)
    };
    let levels = levels::resolve(file, &calibrated(file, overrides)?, trial)?;
    let mut engine = assemble(file, overrides, maps, &levels, |config| config)?;
    engine.levels = levels;
    engine.remarks.extend(maps.remarks());
    // A level by policy is meant.
    let written = file.actuators.iter().map(|actuator| actuator.full_scale.unwrap_or_default());
    engine.remarks.extend(doubts::doubts(&engine.scene.config().actuators, written));
    Ok(engine)
}

/// Which bodies sound in pascals, whatever the gain by policy, because their modes and their bus
/// say how loud they are.
fn calibrated(file: &SceneFile, overrides: &Overrides<'_>) -> Result<Vec<bool>, FileError> {
    let maker =
        Loader { files: overrides.files, maps: &Maps::default(), own: overrides.own, seed: 0, workers: None };
    let is = |entry| {
        let body = maker.body(entry, &file.audio, &[], 1.0)?;
        let pascals = file.audio.get(body.bus).and_then(|bus| bus.pascals_at_full_scale);
        Ok(pascals.is_some() && body.model.unit == crate::model::mode_shapes::Unit::PascalsAtOneMetre)
    };
    if file.audio.iter().all(|bus| bus.pascals_at_full_scale.is_none()) {
        return Ok(vec![false; file.bodies.len()]);
    }
    file.bodies.iter().map(is).collect()
}

fn assemble(
    file: &SceneFile,
    overrides: &Overrides<'_>,
    maps: &Maps,
    levels: &Levels,
    change: impl FnOnce(Config) -> Config,
) -> Result<Engine, FileError> {
    let at = |error: FileError| error.within(file.path.display());
    let config = change(config(file, overrides, levels).map_err(at)?);
    let workers = RefCell::default();
    let maker = Loader {
        files: overrides.files,
        maps,
        own: overrides.own,
        seed: config.seed,
        workers: overrides.live.then_some(&workers),
    };
    let Engine { mut scene, renderer, mut names, mut remarks, .. } =
        config.build().map_err(|error| at(FileError::from_error(error)))?;
    for (name, probe) in &file.probes {
        let place = |error: FileError| at(error.within(format!("probe \"{name}\"")));
        let id = scene.add_probe(*probe).map_err(|error| place(FileError::from_error(error)))?;
        let Config { integrator, .. } = *scene.config();
        let contact = MicroContact::new(probe, integrator, scene.config().inner_rate_hz());
        let contact = contact.map_err(|error| place(FileError::from_error(error)))?;
        remarks.extend(remark(contact.choice()).map(|remark| format!("probe \"{name}\": {remark}")));
        names.probes.insert(name.clone(), id);
    }
    scene.strike_gain = shared(file, levels);
    for (entry, strike_gain) in file.bodies.iter().zip(&levels.strike_gain) {
        let place = |error: FileError| at(error.within(format!("body \"{}\"", entry.name)));
        let body = maker.body(entry, &file.audio, &levels.gain, *strike_gain).map_err(place)?;
        let id = scene.add_body(body).map_err(|error| place(FileError::from_error(error)))?;
        names.bodies.insert(entry.name.clone(), id);
    }
    for entry in &file.surfaces {
        let place = |error: FileError| at(error.within(format!("surface \"{}\"", entry.name)));
        let body = file.bodies.iter().find(|body| Some(&body.name) == entry.body.as_ref());
        let material = body.and_then(|body| body.material);
        let surface = maker.surface(entry, material, &names).map_err(place)?;
        let id = scene.add_surface(surface).map_err(|error| place(FileError::from_error(error)))?;
        names.surfaces.insert(entry.name.clone(), id);
    }
    let workers = workers.into_inner();
    Ok(Engine { scene, renderer, names, workers, levels: Levels::default(), remarks })
}

/// Gain of impacts on a body that is added later: as on those that share what the level policy has
/// found.
fn shared(file: &SceneFile, levels: &Levels) -> f64 {
    let silent = file.bodies.iter().zip(&levels.strike_gain).filter(|(entry, _)| entry.strike_gain.is_none());
    silent.map(|(_, strike_gain)| *strike_gain).fold(1.0, f64::min)
}

fn config(file: &SceneFile, overrides: &Overrides<'_>, levels: &Levels) -> Result<Config, FileError> {
    let default = Config::default().preset(overrides.preset);
    let actuators = file.actuators.iter().zip(&levels.full_scale);
    let actuators =
        actuators.map(|(entry, full_scale)| maker::actuator(overrides.files, entry, *full_scale, &file.path));
    let folder = file.path.parent().unwrap_or(Path::new(""));
    let pickups = file.pickups.iter().map(|entry| sensor(overrides.files, entry, folder));
    Ok(Config {
        sample_rate_hz: overrides.sample_rate_hz.or(file.sample_rate_hz).unwrap_or(default.sample_rate_hz),
        seed: overrides.seed.or(file.seed).unwrap_or(default.seed),
        oversampling: overrides.oversampling.unwrap_or(default.oversampling),
        path: overrides.path.unwrap_or(default.path),
        integrator: overrides.integrator.unwrap_or(default.integrator),
        probe: file.probe,
        kernel: overrides.kernel,
        max_contacts: overrides.max_contacts.unwrap_or(default.max_contacts),
        threads: overrides.threads.unwrap_or(1),
        clock: overrides.clock.unwrap_or(default.clock),
        actuators: actuators.collect::<Result<_, _>>()?,
        audio: file
            .audio
            .iter()
            .zip(&levels.gain)
            .map(|(bus, gain)| bus_of(bus, *gain, file, overrides))
            .collect(),
        pickups: pickups.collect::<Result<_, _>>()?,
        max_surfaces: default.max_surfaces.max(file.surfaces.len()),
        max_bodies: default.max_bodies.max(file.bodies.len()),
        // A scene is loaded whole before the first block is rendered.
        queue_capacity: default.queue_capacity.max(2 * (file.surfaces.len() + file.bodies.len())),
        ..default
    })
}

/// The sensor of a pickup, where it names one.
fn sensor(files: &dyn Files, entry: &PickupEntry, folder: &Path) -> Result<Option<SensorProfile>, FileError> {
    let Some(name) = &entry.sensor else { return Ok(None) };
    let preset = SensorPreset::find(files, name, folder);
    preset
        .map(|preset| Some(preset.profile))
        .map_err(|error| error.within(format!("pickup \"{}\"", entry.name)))
}

/// A bus without a word about a limiter has one where something is known to clip or it is unknown:
/// before a sound card, where a device is named, behind a level that nobody wrote.
fn bus_of(entry: &AudioEntry, gain: f64, file: &SceneFile, overrides: &Overrides<'_>) -> AudioBus {
    let names_device =
        file.actuators.iter().any(|actuator| actuator.equalise.is_some() || actuator.limit.is_some());
    let limit = entry.limit.unwrap_or(overrides.live || names_device || entry.gain.is_none());
    AudioBus { gain, limit: limit || overrides.live, pascals_at_full_scale: entry.pascals_at_full_scale }
}

/// Heights of a surface on a grid over its extent, the longer edge `longest` points; none where the
/// heights do not belong to places, or the source cannot be made.
pub fn relief(entry: &SurfaceEntry, seed: Option<u64>, longest: usize) -> Option<Raster> {
    relief_from(&Disk, entry, seed, longest)
}

/// [`relief`], from wherever the files lie.
pub fn relief_from(
    files: &dyn Files,
    entry: &SurfaceEntry,
    seed: Option<u64>,
    longest: usize,
) -> Option<Raster> {
    let seed = seed.unwrap_or(Config::default().seed);
    let maker = Loader { files, maps: &Maps::default(), own: &[], seed, workers: None };
    maker.ground(entry).relief(&entry.source, longest)
}

crate::opaque::debug_by_name!(Overrides<'_>);
