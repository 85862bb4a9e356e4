//! Session: the engine of this instance, from a scene file.

use crate::exchange::{answer, done, inbox_text};
use crate::open_ports::Ports;
use asperity::files::FileError;
use asperity::files::contact_log::Names;
use asperity::files::scene_file::SceneFile;
use asperity::load::{self, Overrides};
use asperity::{
    BodyId, BusId, ChannelId, ClockMode, Engine, Isa, Material, ProbeId, Renderer, Scene, SurfaceId,
};
use serde_json::json;
use std::cell::RefCell;
use std::path::Path;

/// Name of the scene in messages about it.
const SCENE: &str = "scene.toml";

thread_local! {
    static SESSION: RefCell<Option<Session>> = const { RefCell::new(None) };
}

/// A scene that runs.
pub(crate) struct Session {
    pub scene: Scene,
    pub renderer: Renderer,
    pub names: Names,
    pub file: SceneFile,
    /// Things by the numbers that events name them with: their order in the file.
    pub surfaces: Vec<SurfaceId>,
    pub bodies: Vec<BodyId>,
    pub probes: Vec<ProbeId>,
    pub ports: Ports,
}

impl Session {
    fn open(text: &str, rate_hz: f64, live: bool) -> Result<Self, FileError> {
        let file = SceneFile::parse(text, Path::new(SCENE))?;
        let engine = crate::files::with(|files| {
            let overrides = Overrides {
                files,
                sample_rate_hz: (rate_hz != 0.0).then_some(rate_hz),
                kernel: Some(Isa::Portable),
                clock: live.then_some(ClockMode::LIVE),
                ..Overrides::default()
            };
            Engine::from_scene(&file, &overrides)
        })?;
        answer(reply(&file, &engine).to_string());
        let Engine { scene, renderer, names, .. } = engine;
        let mut session = Self {
            scene,
            renderer,
            names,
            file,
            surfaces: Vec::new(),
            bodies: Vec::new(),
            probes: Vec::new(),
            ports: Ports::default(),
        };
        session.number();
        Ok(session)
    }

    /// Numbers everything anew, in the file's order.
    fn number(&mut self) {
        let Self { file, names, .. } = self;
        let surfaces = file.surfaces.iter().filter_map(|entry| names.surfaces.get(&entry.name));
        self.surfaces = surfaces.copied().collect();
        self.bodies = file.bodies.iter().filter_map(|entry| names.bodies.get(&entry.name)).copied().collect();
        self.probes = file.probes.iter().filter_map(|(name, _)| names.probes.get(name)).copied().collect();
    }

    fn apply(&mut self, text: &str) -> Result<String, FileError> {
        let after = SceneFile::parse(text, Path::new(SCENE))?;
        let changes = crate::files::with(|files| {
            let overrides = Overrides { files, kernel: Some(Isa::Portable), ..Overrides::default() };
            self.scene.apply(&mut self.names, &self.file, &after, &overrides)
        })?;
        self.file = after;
        self.number();
        Ok(json!({ "done": changes.done, "waiting": changes.waiting, "names": names(&self.file) })
            .to_string())
    }
}

/// Does something with the engine; refuses where there is none.
pub(crate) fn with<R>(work: impl FnOnce(&mut Session) -> Result<R, String>) -> Result<R, String> {
    SESSION.with_borrow_mut(|session| {
        let session = session.as_mut().ok_or("no scene is open; open one before")?;
        work(session)
    })
}

/// Does something with the engine, if there is one: for the audio thread, which makes no sentences.
pub(crate) fn if_open(work: impl FnOnce(&mut Session)) {
    SESSION.with_borrow_mut(|session| session.as_mut().map(work));
}

fn names(file: &SceneFile) -> serde_json::Value {
    json!({
        "surfaces": file.surfaces.iter().map(|entry| {
            json!({ "name": entry.name, "body": entry.body, "width_m": entry.width_m, "height_m": entry.height_m })
        }).collect::<Vec<_>>(),
        "bodies": file.bodies.iter().map(|entry| &entry.name).collect::<Vec<_>>(),
        "probes": file.probes.iter().map(|(name, _)| name).collect::<Vec<_>>(),
    })
}

/// Description of an engine for JavaScript.
fn reply(file: &SceneFile, engine: &Engine) -> serde_json::Value {
    let mut reply = names(file);
    reply["sample_rate_hz"] = engine.renderer.sample_rate_hz().into();
    reply["latency_samples"] = engine.renderer.latency_samples().into();
    reply["buses"] = engine.renderer.audio_buses().into();
    reply["haptic_channels"] = engine.renderer.haptic_channels().into();
    reply["full_scale"] = engine.levels.full_scale.clone().into();
    reply["gain"] = engine.levels.gain.clone().into();
    reply["strike_gain"] = engine.levels.strike_gain.clone().into();
    reply["tail_s"] = file.tail_s.into();
    reply["materials"] = Material::PRESETS.iter().map(|preset| preset.name).collect();
    reply
}

/// Opens a scene in the place of the one before. Inbox: the text of a scene file. `rate_hz` 0: the
/// file's own. `live` 1: times of reports follow the audio (a page that runs now); 0: they are
/// exact (a replay). Outbox: what there is, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn asp_open(rate_hz: f64, live: u32) -> u32 {
    SESSION.take();
    let opened = inbox_text()
        .and_then(|text| Session::open(&text, rate_hz, live != 0).map_err(|error| error.to_string()));
    done(opened.map(|session| SESSION.set(Some(session))))
}

/// Closes the scene.
#[unsafe(no_mangle)]
pub extern "C" fn asp_close() {
    SESSION.take();
}

/// Makes of the scene that runs the one that the inbox says, without a step where that can be.
/// Outbox: what has changed, what waits, what there is, as JSON. It makes what is new, so on an
/// audio thread it costs a gap unless that is small.
#[unsafe(no_mangle)]
pub extern "C" fn asp_apply() -> u32 {
    let applied =
        inbox_text().and_then(|text| with(|session| session.apply(&text).map_err(|error| error.to_string())));
    done(applied.map(answer))
}

/// Sets what concerns the whole engine: see the constants beside.
#[unsafe(no_mangle)]
pub extern "C" fn asp_do(what: u32, index: u32, value: f64) -> u32 {
    done(with(|Session { scene, .. }| {
        let done = match what {
            MUTE => scene.set_muted(value != 0.0),
            PAUSE => scene.pause(),
            RESUME => scene.resume(),
            FADE_ALL => scene.fade_all(),
            RESET => scene.reset(),
            AUDIO_GAIN => scene.set_audio_gain(BusId(index as usize), value),
            HAPTIC_GAIN => {
                let channel = u16::try_from(index).map_err(|_| format!("channel: {index} is none"))?;
                scene.set_haptic_gain(ChannelId(channel), value)
            }
            TIME_SCALE => scene.set_time_scale(value, false),
            other => return Err(format!("what: {other} is refused; must be 0 to {TIME_SCALE}")),
        };
        done.map_err(|error| error.to_string())
    }))
}

/// All that leaves fades (value 1) or comes back (0).
pub const MUTE: u32 = 0;
/// The page stands still.
pub const PAUSE: u32 = 1;
/// It goes on.
pub const RESUME: u32 = 2;
/// Every contact ends, everything rings out.
pub const FADE_ALL: u32 = 3;
/// Times begin anew.
pub const RESET: u32 = 4;
/// Linear gain of bus `index`.
pub const AUDIO_GAIN: u32 = 5;
/// Linear gain of haptic channel `index`.
pub const HAPTIC_GAIN: u32 = 6;
/// Game seconds a second, for exact times.
pub const TIME_SCALE: u32 = 7;

/// Counts since the scene was opened, as JSON in the outbox.
#[unsafe(no_mangle)]
pub extern "C" fn asp_stats() -> u32 {
    done(with(|session| {
        let silent: Vec<_> = session.scene.why_silent().iter().map(ToString::to_string).collect();
        answer(json!({ "stats": session.scene.stats(), "why_silent": silent }).to_string());
        Ok(())
    }))
}

/// Heights of surface `index` on a grid whose longer side has `longest` points. Outbox: columns and
/// rows as 32-bit whole numbers, then heights in metres as 32-bit floating point, little-endian;
/// refused where heights do not belong to places.
#[unsafe(no_mangle)]
pub extern "C" fn asp_relief(index: u32, longest: u32) -> u32 {
    done(with(|session| {
        let entry = session.file.surfaces.get(index as usize).ok_or("there is no such surface")?;
        let longest = longest.clamp(1, 4096) as usize;
        let raster = crate::files::with(|files| load::relief_from(files, entry, session.file.seed, longest));
        let raster = raster.ok_or("its heights do not belong to places")?;
        let mut bytes = Vec::with_capacity(8 + 4 * raster.values.len());
        for side in [raster.width, raster.height] {
            bytes.extend((side as u32).to_le_bytes());
        }
        bytes.extend(raster.values.iter().flat_map(|height| (*height as f32).to_le_bytes()));
        answer(bytes);
        Ok(())
    }))
}
