//! A changed scene file, applied to the scene that sounds.
//!
//! Everything new is made before anything is changed, so that a broken map leaves the old scene as
//! it was.

use super::Overrides;
use crate::files::FileError;
use crate::files::contact_log::Names;
use crate::files::scene_file::{AudioEntry, BodyEntry, SceneFile, SurfaceEntry};
use crate::game::scene::Scene;
use crate::make::maker::Loader;
use crate::make::maps::Maps;
use crate::model::body::Body;
use crate::model::bus::BusId;
use crate::model::id::BodyId;
use crate::model::surface::Surface;
use asperity_surface::sand::SandWorker;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// Result of a changed scene file.
#[derive(Debug, Default)]
#[non_exhaustive]
pub struct Changes {
    /// Changes, in words: `surface "tiles": changed`.
    pub done: Vec<String>,
    /// Changes that wait, with when they will come.
    pub waiting: Vec<String>,
    /// Simulations of new sand, to be run on threads of their own as those of
    /// [`Engine::workers`](crate::Engine::workers).
    pub workers: Vec<SandWorker>,
}

impl Scene {
    /// Makes of the scene that was opened as `before` the one that `after` says, while it sounds:
    /// bodies and surfaces that differ, are new or gone, new probes, gains of buses. What is fixed
    /// when an engine is built is listed in [`Changes::waiting`]. `overrides` are those that the
    /// scene was opened with.
    ///
    /// # Errors
    /// When a file cannot be used or a number is refused, nothing has changed. When the queue is
    /// full, apply it again after a block.
    pub fn apply(
        &mut self,
        names: &mut Names,
        before: &SceneFile,
        after: &SceneFile,
        overrides: &Overrides<'_>,
    ) -> Result<Changes, FileError> {
        let workers = RefCell::default();
        let maker = Loader {
            files: overrides.files,
            maps: &Maps::default(),
            own: overrides.own,
            seed: self.config().seed,
            workers: overrides.live.then_some(&workers),
        };
        let at = |error: FileError| error.within(after.path.display());
        let gains: Vec<f64> = self.config().audio.iter().map(|bus| bus.gain).collect();
        let strike_gain = |name: &String| self.silent_strike_gain(names.bodies.get(name));
        let new = New::make(&maker, (&gains, strike_gain), before, after, overrides.touched).map_err(at)?;
        let mut changes = Changes { waiting: waiting(before, after), ..Changes::default() };
        new.put(self, names, &mut changes).map_err(at)?;
        self.apply_buses(before, after, &mut changes).map_err(at)?;
        self.remove_what_is_gone(names, before, after, &mut changes).map_err(at)?;
        changes.workers = workers.into_inner();
        Ok(changes)
    }

    /// Gain of impacts on a body that has none of its own: as they are on it, and on a new one as
    /// on the others, which share what the level policy has found.
    fn silent_strike_gain(&self, body: Option<&BodyId>) -> f64 {
        body.and_then(|body| self.strike_gain_of(*body).ok()).unwrap_or(self.strike_gain)
    }

    fn apply_buses(
        &mut self,
        before: &SceneFile,
        after: &SceneFile,
        changes: &mut Changes,
    ) -> Result<(), FileError> {
        for (index, (old, new)) in before.audio.iter().zip(&after.audio).enumerate() {
            if let Some(gain) = new.gain.filter(|gain| old.gain != Some(*gain)) {
                self.set_audio_gain(BusId(index), gain).map_err(FileError::from_error)?;
                changes.done.push(format!("audio {}: gain {gain}", index + 1));
            }
        }
        Ok(())
    }

    fn remove_what_is_gone(
        &mut self,
        names: &mut Names,
        before: &SceneFile,
        after: &SceneFile,
        changes: &mut Changes,
    ) -> Result<(), FileError> {
        for SurfaceEntry { name, .. } in &before.surfaces {
            if after.surfaces.iter().all(|entry| entry.name != *name)
                && let Some(id) = names.surfaces.get(name)
            {
                self.remove_surface(*id).map_err(FileError::from_error)?;
                names.surfaces.remove(name);
                changes.done.push(format!("surface \"{name}\": removed"));
            }
        }
        for BodyEntry { name, .. } in &before.bodies {
            if after.bodies.iter().all(|entry| entry.name != *name)
                && let Some(id) = names.bodies.get(name)
            {
                self.remove_body(*id).map_err(FileError::from_error)?;
                names.bodies.remove(name);
                changes.done.push(format!("body \"{name}\": removed"));
            }
        }
        Ok(())
    }
}

/// Differences, made and not yet in the scene.
struct New<'a> {
    probes: Vec<&'a (String, asperity_dsp::micro_contact::Probe)>,
    bodies: Vec<(&'a BodyEntry, Body)>,
    surfaces: Vec<(&'a SurfaceEntry, Surface)>,
}

impl<'a> New<'a> {
    fn make(
        maker: &Loader<'_>,
        (gains, strike_gain): (&[f64], impl Fn(&String) -> f64),
        before: &SceneFile,
        after: &'a SceneFile,
        touched: &[PathBuf],
    ) -> Result<Self, FileError> {
        let holds_touched = |files: Vec<&Path>| files.iter().any(|file| touched.iter().any(|t| t == file));
        let differs =
            |entry: &BodyEntry| !before.bodies.contains(entry) || holds_touched(entry.named_files());
        let mut bodies = Vec::new();
        for entry in after.bodies.iter().filter(|entry| differs(entry)) {
            // Buses are those that the engine was built with.
            let body = maker.body(entry, &before.audio, gains, strike_gain(&entry.name));
            bodies.push((entry, body.map_err(|error| error.within(format!("body \"{}\"", entry.name)))?));
        }
        let body_of = |file: &'a SceneFile, entry: &SurfaceEntry| {
            file.bodies.iter().find(|body| Some(&body.name) == entry.body.as_ref())
        };
        let mut surfaces = Vec::new();
        for entry in &after.surfaces {
            let material = body_of(after, entry).and_then(|body| body.material);
            let old = before.surfaces.iter().find(|old| *old == entry);
            let old_body = before.bodies.iter().find(|body| Some(&body.name) == entry.body.as_ref());
            if old.is_some()
                && !holds_touched(entry.named_files())
                && old_body.map(|body| body.material) == body_of(after, entry).map(|body| body.material)
            {
                continue;
            }
            let surface = maker.surface(entry, material, &Names::default());
            let place = |error: FileError| error.within(format!("surface \"{}\"", entry.name));
            surfaces.push((entry, surface.map_err(place)?));
        }
        let known = |name: &String| before.probes.iter().any(|(old, _)| old == name);
        let probes = after.probes.iter().filter(|(name, _)| !known(name)).collect();
        Ok(Self { probes, bodies, surfaces })
    }

    fn put(self, scene: &mut Scene, names: &mut Names, changes: &mut Changes) -> Result<(), FileError> {
        for (name, probe) in self.probes {
            let id = scene.add_probe(*probe).map_err(FileError::from_error)?;
            names.probes.insert(name.clone(), id);
            changes.done.push(format!("probe \"{name}\": added"));
        }
        for (BodyEntry { name, .. }, body) in self.bodies {
            let word = match names.bodies.get(name) {
                Some(id) => scene.replace_body_and_sends(*id, body).map(|()| "changed"),
                None => scene.add_body(body).map(|id| {
                    names.bodies.insert(name.clone(), id);
                    "added"
                }),
            };
            let word =
                word.map_err(|error| FileError::from_error(error).within(format!("body \"{name}\"")))?;
            changes.done.push(format!("body \"{name}\": {word}"));
        }
        for (SurfaceEntry { name, body, .. }, mut surface) in self.surfaces {
            if let Some(body) = body.as_ref().and_then(|body| names.bodies.get(body)) {
                surface = surface.body(*body);
            }
            let word = match names.surfaces.get(name) {
                Some(id) => scene.replace_surface(*id, surface).map(|()| "changed"),
                None => scene.add_surface(surface).map(|id| {
                    names.surfaces.insert(name.clone(), id);
                    "added"
                }),
            };
            let word =
                word.map_err(|error| FileError::from_error(error).within(format!("surface \"{name}\"")))?;
            changes.done.push(format!("surface \"{name}\": {word}"));
        }
        Ok(())
    }
}

/// Settings that are fixed when an engine is built, and differ.
fn waiting(before: &SceneFile, after: &SceneFile) -> Vec<String> {
    let buses = |file: &SceneFile| -> Vec<_> {
        // A gain that is no longer written is found by the level policy, anew.
        let bus = |entry: &AudioEntry| {
            (entry.name.clone(), entry.limit, entry.gain.is_none(), entry.pascals_at_full_scale)
        };
        file.audio.iter().map(bus).collect()
    };
    let sensors =
        |file: &SceneFile| -> Vec<_> { file.pickups.iter().map(|pickup| pickup.sensor.clone()).collect() };
    let known =
        |(name, probe): &(String, _)| after.probes.iter().any(|new| new.0 == *name && new.1 == *probe);
    let differs = [
        ("sample_rate_hz", before.sample_rate_hz != after.sample_rate_hz),
        ("seed", before.seed != after.seed),
        ("contacts", before.contacts != after.contacts),
        ("probe", before.probe != after.probe || !before.probes.iter().all(known)),
        ("actuator", before.actuators != after.actuators),
        ("pickup: number and sensors", sensors(before) != sensors(after)),
        (
            "audio: number, names, limits and pascals of buses, gains that are not written",
            buses(before) != buses(after),
        ),
    ];
    let differing = differs.into_iter().filter(|(_, differs)| *differs);
    differing.map(|(what, _)| format!("{what}: takes effect when the scene is opened again")).collect()
}
