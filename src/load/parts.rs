//! Parts of a scene, each from a table of the scene file by itself: for games, and other languages,
//! that add bodies, surfaces and probes one by one while the scene runs.

use super::Overrides;
use crate::files::FileError;
use crate::files::contact_log::Names;
use crate::files::scene_file::{BodyEntry, SurfaceEntry, probe_of};
use crate::game::scene::Scene;
use crate::make::maker::Loader;
use crate::make::maps::Maps;
use crate::model::body::Body;
use crate::model::id::BodyId;
use crate::model::surface::Surface;
use asperity_dsp::micro_contact::Probe;
use asperity_surface::sand::SandWorker;
use std::cell::RefCell;
use std::path::Path;
use toml::{Table, Value};

/// A surface that was read, and what has to run beside it.
#[non_exhaustive]
pub struct ReadSurface {
    /// The surface, ready to be added.
    pub surface: Surface,
    /// Simulations that have to run on threads of their own, as those of
    /// [`Engine::workers`](crate::Engine::workers); empty unless [`Overrides::live`] is set.
    pub workers: Vec<SandWorker>,
}

impl std::fmt::Debug for ReadSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReadSurface").field("surface", &self.surface).finish_non_exhaustive()
    }
}

impl Scene {
    /// A body from the keys of a scene file's `[[body]]`; `name` may be missing, and `bus` has no
    /// place here: say [`Body::bus`]. Paths lie relative to `folder`. A body that has no
    /// `strike_gain` is struck as loudly as those of the scene file, whose the level policy has
    /// found; 1 where nothing was found.
    ///
    /// ```
    /// use asperity::load::Overrides;
    /// use asperity::{Config, Engine};
    ///
    /// let Engine { mut scene, .. } = Config::default().build()?;
    /// let table = "stock = \"bowl\"\nsize_m = 0.1\nmaterial = \"brass\"";
    /// let bell = scene.read_body(table, "".as_ref(), &Overrides::default())?;
    /// scene.add_body(bell.bus(asperity::BusId(0)))?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When a key is unknown, missing or out of its range, or a file cannot be used; the message
    /// names it.
    pub fn read_body(
        &self,
        table: &str,
        folder: &Path,
        overrides: &Overrides<'_>,
    ) -> Result<Body, FileError> {
        let table = named(table, "body")?;
        if let Some(key) = ["bus", "sends"].into_iter().find(|key| table.contains_key(*key)) {
            let right = "leave it out, and give the number of the bus beside the table";
            let what = "goes by names, and a body by itself has none";
            return Err(FileError::new(format!("body: {key}"), what, right));
        }
        let entry = BodyEntry::read(table, folder)?;
        self.maker(overrides, &Maps::default(), None).body(&entry, &[], &[], self.strike_gain)
    }

    /// A surface from the keys of a scene file's `[[surface]]`; `name` may be missing. It rings
    /// `on`, or the body that the table names in `names`, and has the finish of that body's
    /// material where it says nothing else and the material is not [the default
    /// one](Body::DEFAULT_MATERIAL). Paths lie relative to `folder`.
    ///
    /// # Errors
    /// When a key is unknown, missing or out of its range, a file cannot be used, or there is no
    /// such body; the message names it.
    pub fn read_surface(
        &self,
        table: &str,
        folder: &Path,
        on: Option<BodyId>,
        names: &Names,
        overrides: &Overrides<'_>,
    ) -> Result<ReadSurface, FileError> {
        let entry = SurfaceEntry::read(named(table, "surface")?, folder)?;
        let body = match (on, &entry.body) {
            (Some(body), _) => Some(body),
            (None, Some(name)) => Some(*names.bodies.get(name).ok_or_else(|| {
                let right = "name a body of this scene, or leave it out";
                FileError::new("surface: body", format!("\"{name}\" is unknown"), right)
            })?),
            (None, None) => None,
        };
        let material = body.and_then(|body| self.given.get(&body)).map(|body| body.material);
        let material = material.filter(|material| *material != Body::DEFAULT_MATERIAL);
        let workers = RefCell::default();
        let surface =
            self.maker(overrides, &Maps::default(), Some(&workers)).surface(&entry, material, names)?;
        let surface = match body {
            Some(body) => surface.body(body),
            None => surface,
        };
        Ok(ReadSurface { surface, workers: workers.into_inner() })
    }

    /// A probe from the keys of a scene file's `[[probe]]`: a `preset`, and what differs from it.
    ///
    /// # Errors
    /// When a key is unknown or out of its range; the message names it.
    pub fn read_probe(table: &str) -> Result<Probe, FileError> {
        probe_of(named(table, "probe")?)
    }

    fn maker<'a>(
        &self,
        overrides: &Overrides<'a>,
        maps: &'a Maps,
        workers: Option<&'a RefCell<Vec<SandWorker>>>,
    ) -> Loader<'a> {
        let workers = workers.filter(|_| overrides.live);
        Loader { files: overrides.files, maps, own: overrides.own, seed: self.config().seed, workers }
    }
}

/// The table of a text; `kind` is its name if it has none.
fn named(text: &str, kind: &str) -> Result<Table, FileError> {
    let mut table: Table = text.parse().map_err(|error: toml::de::Error| {
        let right = format!("write the keys of a [[{kind}]] of a scene file, as TOML");
        FileError::new(kind, error.message().replace('\n', " "), right)
    })?;
    table.entry("name").or_insert_with(|| Value::String(kind.into()));
    Ok(table)
}
