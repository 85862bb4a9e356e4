//! The two live halves: a scene that takes reports, a renderer that fills the blocks of a callback.

use crate::error::refused;
use crate::pictures;
use crate::sources::{self, Sources};
use asperity::files::contact_log::{ContactLog, Names};
use asperity::files::scene_file::SceneFile;
use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::load::Overrides;
use asperity::surface::sand::SandThread;
use asperity::surface::sand::SandWorker;
use asperity::{ChannelId, Clip, ClockMode, ContactEvent, Engine, Scene};
use numpy::{PyArray2, PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard};

/// Longest block that is rendered while the GIL is held, frames: letting it go and taking it again
/// may cost 5 ms, a block of this length costs less.
const SHORT_FRAMES: usize = 1024;

/// The game's half.
#[pyclass(frozen, module = "asperity._native")]
pub struct LiveScene {
    inner: Mutex<Game>,
}

struct Game {
    scene: Scene,
    names: Names,
    /// Simulations of sand; they stop when they are dropped.
    _sand: Vec<SandThread>,
}

/// The audio callback's half.
#[pyclass(frozen, module = "asperity._native")]
pub struct LiveRenderer {
    /// None while the channel map changes hands.
    inner: Mutex<Option<Interleaver>>,
    #[pyo3(get)]
    sr: f64,
    #[pyo3(get)]
    haptic_channels: usize,
    #[pyo3(get)]
    audio_buses: usize,
    #[pyo3(get)]
    pickup_channels: usize,
    #[pyo3(get)]
    latency_samples: usize,
    #[pyo3(get)]
    kernel: &'static str,
}

/// Opens a scene to be reported to: its two halves, and the levels in use.
#[pyfunction]
#[pyo3(signature = (scene, files, *, sr=None, seed=None, kernel=None, integrator=None, live=true))]
#[allow(clippy::too_many_arguments, reason = "they are the options of a verb")]
pub fn open(
    py: Python<'_>,
    scene: PathBuf,
    files: &Bound<'_, PyDict>,
    sr: Option<f64>,
    seed: Option<u64>,
    kernel: Option<&str>,
    integrator: Option<&str>,
    live: bool,
) -> PyResult<(LiveScene, LiveRenderer, Vec<f64>, Vec<f64>, Vec<f64>)> {
    let (kernel, integrator) = (sources::kernel(kernel)?, sources::integrator(integrator)?);
    let sources = Sources::of(files)?;
    let engine = py.detach(|| {
        let overrides = Overrides {
            files: &sources,
            sample_rate_hz: sr,
            seed,
            integrator,
            kernel,
            live,
            clock: live.then_some(ClockMode::LIVE),
            ..Overrides::default()
        };
        SceneFile::load_from(&sources, &scene).and_then(|file| Engine::from_scene(&file, &overrides))
    });
    let Engine { scene, renderer, names, workers, levels, .. } =
        engine.map_err(|error| sources.told(error))?;
    let map = ChannelMap::stereo_then_haptics(renderer.haptic_channels());
    let half = LiveRenderer {
        sr: renderer.sample_rate_hz(),
        haptic_channels: renderer.haptic_channels(),
        audio_buses: renderer.audio_buses(),
        pickup_channels: renderer.pickup_channels(),
        latency_samples: renderer.latency_samples(),
        kernel: renderer.kernel().name(),
        inner: Mutex::new(Some(Interleaver::new(renderer, map))),
    };
    let sand = workers.into_iter().map(SandWorker::spawn).collect();
    let game = Game { scene, names, _sand: sand };
    let game = LiveScene { inner: Mutex::new(game) };
    Ok((game, half, levels.full_scale, levels.gain, levels.strike_gain))
}

/// A half that another thread holds is told so at once: waiting here could wait for the GIL.
fn held<T>(mutex: &Mutex<T>) -> PyResult<MutexGuard<'_, T>> {
    mutex
        .try_lock()
        .map_err(|_| PyRuntimeError::new_err("is in use by another thread; give each half one thread"))
}

impl LiveScene {
    /// Does something with the scene.
    pub fn with<T>(&self, work: impl FnOnce(&mut Scene) -> PyResult<T>) -> PyResult<T> {
        work(&mut held(&self.inner)?.scene)
    }
}

#[pymethods]
impl LiveScene {
    /// Reports the events of a text of JSON Lines, each at its own t.
    fn report(&self, text: &str) -> PyResult<()> {
        let mut game = held(&self.inner)?;
        let log = ContactLog::parse(text, "events").map_err(refused)?;
        log.check_actuators(game.scene.config().actuators.len()).map_err(refused)?;
        for line in &log.lines {
            let event = line.event.resolve(&game.names).map_err(refused)?;
            game.scene
                .report(line.t, event)
                .map_err(|error| refused(format!("t = {} s: {error}", line.t)))?;
        }
        Ok(())
    }

    /// Reports the strike of a line under a name.
    fn report_named(&self, name: u64, text: &str) -> PyResult<()> {
        let mut game = held(&self.inner)?;
        let log = ContactLog::parse(text, "event").map_err(refused)?;
        log.check_actuators(game.scene.config().actuators.len()).map_err(refused)?;
        for line in &log.lines {
            let ContactEvent::Impact(impact) = line.event.resolve(&game.names).map_err(refused)? else {
                return Err(refused("event: is no strike; only an \"impact\" takes a name"));
            };
            game.scene.report_named(line.t, name, impact).map_err(refused)?;
        }
        Ok(())
    }

    /// Plays a clip on a haptic channel.
    #[allow(clippy::too_many_arguments, reason = "they are those of the method")]
    fn play_clip(
        &self,
        t: f64,
        channel: u16,
        samples: Vec<f32>,
        rate_hz: f64,
        gain: f64,
        ducking: f64,
    ) -> PyResult<()> {
        let clip = Clip { samples, rate_hz, gain, ducking };
        held(&self.inner)?.scene.play_clip(t, ChannelId(channel), &clip).map_err(refused)
    }

    /// Takes a strike with a name back.
    fn withdraw(&self, name: u64) -> PyResult<bool> {
        Ok(held(&self.inner)?.scene.withdraw(name))
    }

    /// Game seconds a second of audio.
    fn set_time_scale(&self, scale: f64, bend_pitch: bool) -> PyResult<()> {
        held(&self.inner)?.scene.set_time_scale(scale, bend_pitch).map_err(refused)
    }

    /// Statistics of the engine so far, as JSON.
    fn stats(&self) -> PyResult<String> {
        serde_json::to_string(&held(&self.inner)?.scene.stats()).map_err(refused)
    }

    /// Reasons against anything being heard or felt.
    fn why_silent(&self) -> PyResult<Vec<String>> {
        Ok(held(&self.inner)?.scene.why_silent().iter().map(ToString::to_string).collect())
    }

    /// Bodies and surfaces that leave more than full scale holds.
    fn why_clipped(&self) -> PyResult<Vec<String>> {
        Ok(held(&self.inner)?.scene.why_clipped().iter().map(ToString::to_string).collect())
    }

    /// Game time begins anew.
    fn reset(&self) -> PyResult<()> {
        held(&self.inner)?.scene.reset().map_err(refused)
    }

    /// Everything fades, or comes back.
    fn set_muted(&self, muted: bool) -> PyResult<()> {
        held(&self.inner)?.scene.set_muted(muted).map_err(refused)
    }

    /// Names of surfaces and of bodies.
    fn names(&self) -> PyResult<(Vec<String>, Vec<String>)> {
        let game = held(&self.inner)?;
        let sorted = |names: Vec<&String>| {
            let mut names: Vec<String> = names.into_iter().cloned().collect();
            names.sort();
            names
        };
        Ok((sorted(game.names.surfaces.keys().collect()), sorted(game.names.bodies.keys().collect())))
    }
}

#[pymethods]
impl LiveRenderer {
    /// The next frames: audio (buses, frames) and haptic (channels, frames).
    #[allow(clippy::type_complexity, reason = "two arrays, as Python takes them")]
    fn render<'py>(
        &self,
        py: Python<'py>,
        frames: usize,
    ) -> PyResult<(Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>)> {
        let mut audio = vec![vec![0.0; frames]; self.audio_buses];
        let mut haptic = vec![vec![0.0; frames]; self.haptic_channels];
        let mut held = held(&self.inner)?;
        let renderer = held.as_mut().ok_or_else(gone)?.renderer();
        py.detach(|| {
            let mut audio: Vec<&mut [f32]> = audio.iter_mut().map(Vec::as_mut_slice).collect();
            let mut haptic: Vec<&mut [f32]> = haptic.iter_mut().map(Vec::as_mut_slice).collect();
            renderer.render(&mut haptic, &mut audio);
        });
        Ok((pictures::planar(py, audio)?, pictures::planar(py, haptic)?))
    }

    /// The next frames of the pickups: (channels, frames).
    fn render_pickups<'py>(&self, py: Python<'py>, frames: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mut read = vec![vec![0.0; frames]; self.pickup_channels];
        let mut held = held(&self.inner)?;
        let renderer = held.as_mut().ok_or_else(gone)?.renderer();
        py.detach(|| {
            let mut read: Vec<&mut [f32]> = read.iter_mut().map(Vec::as_mut_slice).collect();
            renderer.render_with_pickups(&mut [], &mut [], &mut read);
        });
        pictures::planar(py, read)
    }

    /// Fills (frames, device channels) with the next frames.
    fn render_into(&self, py: Python<'_>, mut out: PyReadwriteArray2<'_, f32>) -> PyResult<()> {
        let [frames, channels] = [out.shape()[0], out.shape()[1]];
        if !out.is_c_contiguous() {
            return Err(refused(
                "out: does not lie frame after frame; must be C-contiguous (frames, channels)",
            ));
        }
        let mut held = held(&self.inner)?;
        let half = held.as_mut().ok_or_else(gone)?;
        let out = out.as_slice_mut()?;
        if frames <= SHORT_FRAMES {
            half.fill(out, channels);
        } else {
            py.detach(|| half.fill(out, channels));
        }
        Ok(())
    }

    /// Channels of the device: "audio=0,1 haptic=2,3".
    fn set_channels(&self, text: &str) -> PyResult<usize> {
        let map = ChannelMap::parse(text).map_err(refused)?;
        let width = map.width();
        let mut held = held(&self.inner)?;
        let renderer = held.take().ok_or_else(gone)?.into_renderer();
        *held = Some(Interleaver::new(renderer, map));
        Ok(width)
    }

    /// Tells which share of its time budget the last block took.
    fn report_load(&self, load: f32) -> PyResult<()> {
        held(&self.inner)?.as_mut().ok_or_else(gone)?.renderer().report_load(load);
        Ok(())
    }

    /// Index of the next sample.
    fn position(&self) -> PyResult<u64> {
        Ok(held(&self.inner)?.as_mut().ok_or_else(gone)?.renderer().position())
    }
}

fn gone() -> PyErr {
    PyRuntimeError::new_err("the renderer was lost while its channels changed; open the scene again")
}
