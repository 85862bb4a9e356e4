//! Microphones on bodies of simulated worlds: arrays of contacts in, what the pickups read out.
//!
//! Each world has an engine of its own and the rules of pairs (`asperity_pairs`); worlds that are
//! due render at once, on threads that share nothing, so the bits are those of one world alone.

use crate::error::refused;
use crate::pictures;
use crate::sources::Sources;
use crate::stepped::{Points, Step, Told};
use asperity::files::FileError;
use asperity::files::scene_file::{ActuatorEntry, SceneFile, SurfaceEntry};
use asperity::load::{Maps, Overrides};
use asperity::{ContactEvent, Engine, Material, ProbeId, RigidMotion, UvMapping, UvTriangle};
use asperity_pairs::{Collider, Contact, Form, Placed, Probes, Thing, Vec3, World};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Mutex;

/// Samples that may wait before they are rendered, and reports: an engine takes 4096.
const DUE: (u64, usize) = (2048, 1024);
/// Samples a block.
const BLOCK: usize = 512;
/// Name of the probes that things touch with.
const PROBES: &str = "a thing of the simulator";

/// Rows of MuJoCo's forces at which contacts begin, and true where all rows of one sum up to its
/// normal force.
type Efc<'py> = Option<(PyReadonlyArray1<'py, i32>, bool)>;

/// Worlds with microphones.
#[pyclass(frozen, module = "asperity._native")]
pub struct Microphones {
    inner: Mutex<Worlds>,
    #[pyo3(get)]
    channels: usize,
    #[pyo3(get)]
    latency_samples: usize,
}

struct Worlds {
    file: SceneFile,
    sources: Sources,
    maps: Maps,
    settings: Settings,
    things: Vec<Option<Told>>,
    all: Vec<Heard>,
}

#[derive(Clone, Copy)]
struct Settings {
    seed: u64,
    sample_rate_hz: f64,
    step_s: f64,
    keep: usize,
    gravity_m_s2: Option<Vec3>,
    threads: usize,
    log: bool,
}

/// A world, and what its microphones have read.
struct Heard {
    engine: Engine,
    rules: World,
    probes: Probes,
    colliders: Vec<Option<Collider>>,
    placed: Vec<Placed>,
    contacts: Vec<Contact>,
    events: Vec<ContactEvent>,
    /// First stamp and last one, s.
    time_s: Option<[f64; 2]>,
    reported: usize,
    rendered: u64,
    read: Vec<VecDeque<f32>>,
}

#[pymethods]
impl Microphones {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "they are those of a class of Python")]
    fn new(
        py: Python<'_>,
        scene: PathBuf,
        files: &Bound<'_, PyDict>,
        things: Vec<Option<Told>>,
        worlds: usize,
        seed: u64,
        sr: f64,
        step_s: f64,
        keep: usize,
        gravity: Option<[f32; 3]>,
        threads: usize,
        log: bool,
    ) -> PyResult<Self> {
        let sources = Sources::of(files)?;
        let mut file = SceneFile::load_from(&sources, &scene).map_err(|error| sources.told(error))?;
        // Nothing is felt and nobody hears: bodies ring for their pickups alone.
        file.actuators = vec![ActuatorEntry { full_scale: Some(1.0), ..ActuatorEntry::default() }];
        file.audio.clear();
        file.bodies.iter_mut().for_each(|body| body.strike_gain = body.strike_gain.or(Some(1.0)));
        file.probes.extend(Probes::tables(PROBES));
        let settings = Settings {
            seed,
            sample_rate_hz: sr,
            step_s,
            keep,
            gravity_m_s2: gravity.map(Vec3::from_array),
            threads: threads.max(1),
            log,
        };
        let mut inner = Worlds { file, sources, maps: Maps::default(), settings, things, all: Vec::new() };
        let seeds: Vec<u64> = (0..worlds as u64).collect();
        inner.all = py.detach(|| inner.built(&seeds)).map_err(|error| inner.sources.told(error))?;
        let Some(first) = inner.all.first() else {
            return Err(refused("worlds: 0 is refused; must be 1 or more"));
        };
        let (channels, latency_samples) = (first.read.len(), first.engine.renderer.audio_latency_samples());
        Ok(Self { inner: Mutex::new(inner), channels, latency_samples })
    }

    /// Takes a step of the worlds from `first` on. Nothing has changed where it is refused.
    #[allow(clippy::too_many_arguments, reason = "an array each")]
    #[pyo3(signature = (first, t, world, pairs, point, normal, force, restitution, place, turn, velocity, about, efc=None))]
    fn step(
        &self,
        py: Python<'_>,
        first: usize,
        t: PyReadonlyArray1<'_, f64>,
        world: Option<PyReadonlyArray1<'_, i64>>,
        pairs: PyReadonlyArray2<'_, i32>,
        point: PyReadonlyArray2<'_, f64>,
        normal: PyReadonlyArray2<'_, f64>,
        force: PyReadonlyArray1<'_, f64>,
        restitution: f32,
        place: PyReadonlyArray3<'_, f64>,
        turn: PyReadonlyArray3<'_, f64>,
        velocity: PyReadonlyArray3<'_, f64>,
        about: PyReadonlyArray3<'_, f64>,
        efc: Efc<'_>,
    ) -> PyResult<()> {
        let mut inner = self.held()?;
        let Worlds { settings, things, all, .. } = &mut *inner;
        let step = Step {
            time_s: t.as_array(),
            place: place.as_array(),
            turn: turn.as_array(),
            velocity: velocity.as_array(),
            about: about.as_array(),
        };
        let count = step.time_s.len();
        let Some(worlds) = all.get_mut(first..first + count) else {
            return Err(refused(format!("t: has {count} times; must have one for each world")));
        };
        let last_s: Vec<_> = worlds.iter().map(|heard| heard.time_s.map(|[_, last]| last)).collect();
        step.check(&last_s, things).map_err(refused)?;
        let points = Points {
            world: world.as_ref().map(|world| world.as_array()),
            pairs: pairs.as_array(),
            point: point.as_array(),
            normal: normal.as_array(),
            force: force.as_array(),
            efc: efc.as_ref().map(|(address, sums)| (address.as_array(), *sums)),
            restitution,
        };
        points.check(count, things.len()).map_err(refused)?;
        points.contacts().for_each(|(world, contact)| worlds[world].contacts.push(contact));
        for (index, heard) in worlds.iter_mut().enumerate() {
            heard.step(index, &step, things, settings);
        }
        let rate_hz = settings.sample_rate_hz;
        if worlds.iter().any(|heard| heard.is_due(rate_hz)) {
            py.detach(|| rendered(worlds, settings, |heard| heard.is_due(rate_hz)));
        }
        Ok(())
    }

    /// Newest samples of every world, silence before the first: (worlds × channels, samples).
    fn read<'py>(&self, py: Python<'py>, samples: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mut inner = self.held()?;
        let Worlds { settings, all, .. } = &mut *inner;
        py.detach(|| rendered(all, settings, |_| true));
        let newest = |read: &VecDeque<f32>| {
            let silent = samples.saturating_sub(read.len());
            let from = read.len() - (samples - silent);
            std::iter::repeat_n(0.0, silent).chain(read.range(from..).copied()).collect()
        };
        pictures::planar(py, all.iter().flat_map(|heard| heard.read.iter().map(newest)).collect())
    }

    /// Replaces these worlds by new ones.
    fn reset(&self, py: Python<'_>, worlds: Vec<usize>) -> PyResult<()> {
        let inner = &mut *self.held()?;
        let seeds: Vec<u64> = worlds.iter().map(|world| *world as u64).collect();
        let built = py.detach(|| inner.built(&seeds)).map_err(|error| inner.sources.told(error))?;
        for (world, new) in worlds.into_iter().zip(built) {
            inner.all[world] = new;
        }
        Ok(())
    }

    /// Contact log of a world since its last call, as JSON Lines.
    fn log(&self, world: usize) -> PyResult<String> {
        let mut inner = self.held()?;
        if !inner.settings.log {
            return Err(refused("log: was not kept; open the microphones with log=True"));
        }
        let Some(heard) = inner.all.get_mut(world) else {
            return Err(refused(format!("world: {world} is unknown")));
        };
        let text = heard.engine.scene.stop_recording().to_jsonl();
        heard.engine.scene.start_recording(&heard.engine.names);
        Ok(text)
    }

    /// Statistics of the engine of a world, as JSON.
    fn stats(&self, world: usize) -> PyResult<String> {
        let inner = self.held()?;
        let heard = inner.all.get(world).ok_or_else(|| refused(format!("world: {world} is unknown")))?;
        serde_json::to_string(&heard.engine.scene.stats()).map_err(refused)
    }
}

impl Microphones {
    fn held(&self) -> PyResult<std::sync::MutexGuard<'_, Worlds>> {
        let busy = |_| PyRuntimeError::new_err("microphones: are in use by another thread; give them one");
        self.inner.try_lock().map_err(busy)
    }
}

impl Worlds {
    /// Worlds of these seeds over the first one's.
    fn built(&mut self, seeds: &[u64]) -> Result<Vec<Heard>, FileError> {
        seeds.iter().map(|seed| self.open(*seed)).collect()
    }

    fn open(&self, world: u64) -> Result<Heard, FileError> {
        let Settings { seed, sample_rate_hz, .. } = self.settings;
        let overrides = Overrides {
            files: &self.sources,
            maps: Some(&self.maps),
            seed: Some(seed.wrapping_add(world)),
            sample_rate_hz: Some(sample_rate_hz),
            ..Overrides::default()
        };
        let mut engine = Engine::from_scene(&self.file, &overrides)?;
        let probe = |(name, _): (String, _)| engine.names.probes[&name];
        let probes = Probes::known(Probes::tables(PROBES).map(probe) as [ProbeId; 3]);
        let colliders = self.things.iter().map(|told| told.as_ref().map(|told| self.collider(told, &engine)));
        let colliders = colliders.map(Option::transpose).collect::<Result<Vec<_>, _>>()?;
        if self.settings.log {
            engine.scene.start_recording(&engine.names);
        }
        Ok(Heard {
            rules: World::default(),
            probes,
            placed: vec![Placed::default(); colliders.len()],
            colliders,
            contacts: Vec::new(),
            events: Vec::new(),
            time_s: None,
            reported: 0,
            rendered: 0,
            read: vec![VecDeque::new(); engine.renderer.pickup_channels()],
            engine,
        })
    }

    fn collider(&self, told: &Told, engine: &Engine) -> Result<Collider, FileError> {
        let (body, surface, material, mobility_per_kg, form, radius_m, ..) = told;
        let unknown = |kind, name: &str| {
            FileError::new(kind, format!("\"{name}\" is unknown"), "name one of the scene's")
        };
        let names = &engine.names;
        let body =
            body.as_ref().map(|name| names.bodies.get(name).copied().ok_or_else(|| unknown("body", name)));
        let entry = surface.as_ref().map(|name| {
            self.file
                .surfaces
                .iter()
                .find(|entry| entry.name == *name)
                .ok_or_else(|| unknown("surface", name))
        });
        let entry = entry.transpose()?;
        let form = match form.as_str() {
            "sphere" => Form::Sphere(*radius_m),
            "capsule" => Form::Capsule(*radius_m),
            "cylinder" => Form::Cylinder,
            "flat" => Form::Flat,
            other => {
                return Err(FileError::new(
                    "form",
                    format!("\"{other}\" is unknown"),
                    "must be flat, sphere, capsule or cylinder",
                ));
            }
        };
        let thing = Thing {
            material: Material::by_name(material).ok_or_else(|| unknown("material", material))?,
            body: body.transpose()?,
            surface: entry.map(|entry| names.surfaces[&entry.name]),
            actuator: None,
            probe: None,
        };
        let mapping = entry.map(mapping);
        Ok(Collider { thing, mobility_per_kg: *mobility_per_kg, form, radius_m: None, mapping })
    }
}

/// Mapping by the surface's frame where it has one, else by the normal.
fn mapping(entry: &SurfaceEntry) -> UvMapping {
    let size_m = [entry.width_m, entry.height_m];
    let plane = entry.frame.and_then(|frame| {
        let corners_uv = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        UvTriangle::new(corners_uv.map(|uv| frame.point_m(uv, size_m)), corners_uv)
    });
    plane.map_or(UvMapping::ByNormal { span_m: size_m }, UvMapping::Plane)
}

impl Heard {
    fn step(&mut self, world: usize, step: &Step<'_>, things: &[Option<Told>], settings: &Settings) {
        let t = step.time_s[world];
        let is_first = self.time_s.is_none();
        let [first, last] = self.time_s.unwrap_or([t, t - settings.step_s]);
        self.time_s = Some([first, t]);
        let step_s = (t - last) as f32;
        for (thing, told) in things.iter().enumerate() {
            let (Some(told), Some(collider)) = (told, &self.colliders[thing]) else { continue };
            let before = self.placed[thing].motion;
            let placed = step.placed(world, thing, (told.6, told.7));
            self.placed[thing] = placed;
            if let (Some(gravity_m_s2), Some(body)) = (settings.gravity_m_s2, collider.thing.body) {
                let gained = if is_first { Vec3::ZERO } else { placed.motion.linear_m_s - before.linear_m_s };
                let own = |v: Vec3| (placed.turn.transpose() * v).to_array().map(f64::from);
                let motion = RigidMotion {
                    acceleration_m_s2: own(gained / step_s),
                    gravity_m_s2: own(gravity_m_s2),
                    angular_velocity_rad_s: own(placed.motion.angular_rad_s),
                    ..RigidMotion::default()
                };
                self.events.push(ContactEvent::Motion { body, motion });
            }
        }
        let arrays = (&self.colliders[..], &self.placed[..]);
        self.rules.step(arrays, &mut self.contacts, (self.probes, step_s), &mut self.events);
        self.contacts.clear();
        self.reported += self.events.len();
        for event in self.events.drain(..) {
            // What is refused is counted in the statistics.
            let _ = self.engine.scene.report(t - first, event);
        }
    }

    /// Samples that have to be rendered up to the last step.
    fn due(&self, rate_hz: f64) -> u64 {
        let until = self.time_s.map_or(0.0, |[first, last]| (last - first) * rate_hz);
        (until as u64).saturating_sub(self.rendered)
    }

    fn is_due(&self, rate_hz: f64) -> bool {
        self.due(rate_hz) >= DUE.0 || self.reported >= DUE.1
    }

    fn render(&mut self, settings: &Settings) {
        let mut block = vec![[0.0f32; BLOCK]; self.read.len()];
        let mut left = self.due(settings.sample_rate_hz) as usize;
        self.rendered += left as u64;
        self.reported = 0;
        while left > 0 {
            let n = left.min(BLOCK);
            let mut out: Vec<&mut [f32]> = block.iter_mut().map(|block| &mut block[..n]).collect();
            self.engine.renderer.render_with_pickups(&mut [], &mut [], &mut out);
            for (read, block) in self.read.iter_mut().zip(&block) {
                read.extend(&block[..n]);
                read.drain(..read.len().saturating_sub(settings.keep));
            }
            left -= n;
        }
    }
}

/// Renders the worlds that are due, on as many threads as there may be.
fn rendered(worlds: &mut [Heard], settings: &Settings, is_due: impl Fn(&Heard) -> bool) {
    let mut due: Vec<&mut Heard> = worlds.iter_mut().filter(|heard| is_due(heard)).collect();
    let share = due.len().div_ceil(settings.threads).max(1);
    std::thread::scope(|scope| {
        let mut shares = due.chunks_mut(share);
        let own = shares.next();
        for others in shares {
            scope.spawn(|| others.iter_mut().for_each(|heard| heard.render(settings)));
        }
        own.into_iter().flatten().for_each(|heard| heard.render(settings));
    });
}
