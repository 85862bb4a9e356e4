//! `AsperityWorld`: the engine of a scene tree.

mod members;
mod opening;
mod reports;

use crate::events;
use crate::haptic_stream::AsperityHapticStream;
use crate::stream::{AsperityStream, MOST_CHANNELS};
use crate::surface::AsperitySurface;
use asperity::files::contact_log::Names;
use asperity::live::ports::{Feed, Pcm, PcmPort, PointSettings, Points, PointsPort, Tone};
use asperity::surface::sand::{SandThread, SandWorker};
use asperity::{Engine, Scene, SurfaceId, TipSurface};
use godot::classes::{AudioStreamPlayer, INode, ProjectSettings, SceneTree};
use godot::prelude::*;

/// The group by which bodies and fingers find their world.
const GROUP: &str = "asperity_world";
/// The group by which a world that is built finds the bodies that are in the tree already.
pub(crate) const BODIES: &str = "asperity_bodies";

/// Gravity beyond which a project's unit is taken for the centimetre, m/s².
const ODD_GRAVITY_M_S2: f64 = 100.0;
/// The project's gravity.
const GRAVITY: &str = "physics/3d/default_gravity";

/// Time of a haptic channel that waits for its stream, s.
const HOLDS_S: f64 = 0.25;

/// A scene that runs.
pub(crate) struct Running {
    pub scene: Scene,
    pub names: Names,
    /// Simulations on threads of their own; they end with it.
    sand: Vec<SandThread>,
}

/// The engine: one in a tree, before what touches. It opens when it enters the tree, sounds on
/// `audio_bus`, and lets `haptic_bus` vibrate. What it refuses, it says as Godot's errors and in
/// `last_error()`.
#[derive(GodotClass)]
#[class(init, base = Node)]
pub struct AsperityWorld {
    /// A scene file of the engine's, TOML; empty: a world without bodies, with `haptic_channels`.
    #[export(file = "*.toml")]
    scene_file: GString,
    /// Haptic channels, where no scene file says them.
    #[export]
    #[init(val = 2)]
    haptic_channels: i64,
    /// Displacement at full scale of a haptic channel, m, where no scene file says it; strokes move
    /// a fingertip by hundredths of a millimetre to tenths, blows by millimetres, and a limiter
    /// keeps them within full scale.
    #[export]
    #[init(val = 5e-4)]
    haptic_full_scale_m: f64,
    /// Levels of bodies and surfaces where no scene file says them: "shared" (found by trials as
    /// they come, with their differences kept), "each" (each thing as loud as the next) or
    /// "as_given" (as their numbers say).
    #[export(enum = (shared, each, as_given))]
    #[init(val = "shared".into())]
    levels: GString,
    /// Loudness before the limiter, linear, where no scene file says it; with levels "as_given"
    /// blows reach many times full scale.
    #[export]
    #[init(val = 1.0)]
    gain: f64,
    /// Godot's audio bus on which it sounds; empty: a player of the project's own plays
    /// `audio_stream()`.
    #[export]
    #[init(val = "Master".into())]
    audio_bus: StringName,
    /// Godot's audio bus that leads to the actuators; empty: none.
    #[export]
    haptic_bus: StringName,
    running: Option<Running>,
    stream: Option<Gd<AsperityStream>>,
    /// The players that it made for its buses.
    players: Vec<Gd<AudioStreamPlayer>>,
    /// Number of builds: ids of before belong to no engine any more.
    builds: u64,
    latency_frames: usize,
    time_s: f64,
    error: String,
    base: Base<Node>,
}

#[godot_api]
impl INode for AsperityWorld {
    fn enter_tree(&mut self) {
        self.base_mut().add_to_group(GROUP);
        // Game time has moved on before the tick's reports are stamped.
        self.base_mut().set_physics_process_priority(-1000);
        if self.running.is_none() {
            self.build();
        }
        let settings = ProjectSettings::singleton();
        let gravity: f64 = settings.get_setting(GRAVITY).try_to().unwrap_or(0.0);
        if gravity > ODD_GRAVITY_M_S2 {
            godot_warn!("AsperityWorld: gravity is {gravity}; asperity takes metres: scale the physics");
        }
    }

    fn ready(&mut self) {
        self.play_all();
    }

    fn physics_process(&mut self, delta: f64) {
        self.time_s += delta;
        if let Some(running) = &mut self.running {
            running.scene.collect();
        }
    }
}

#[godot_api]
impl AsperityWorld {
    /// Opens the engine anew, at the audio server's rate. Bodies in the tree join it and the
    /// world's own buses play it; ids and streams of before are no longer known, and silent. False,
    /// and an error, where it cannot.
    #[func]
    fn build(&mut self) -> bool {
        self.running = None;
        self.stream = None;
        self.builds += 1;
        for mut player in self.players.drain(..) {
            player.stop();
            player.queue_free();
        }
        let made = self.open(true);
        let Some(engine) = self.said("build", made) else { return false };
        let Engine { scene, renderer, names, workers, .. } = engine;
        if renderer.audio_buses().max(renderer.haptic_channels()) > MOST_CHANNELS {
            let what = format!("more than {MOST_CHANNELS} buses or haptic channels; take fewer");
            return self.said::<()>("build", Err(what)).is_some();
        }
        self.latency_frames = renderer.latency_samples();
        let stream = AsperityStream::new_gd();
        if let Ok(mut slot) = stream.bind().slot.lock() {
            *slot = Some(renderer);
        }
        self.stream = Some(stream);
        self.running =
            Some(Running { scene, names, sand: workers.into_iter().map(SandWorker::spawn).collect() });
        self.take_in_bodies();
        if self.base().is_node_ready() {
            self.play_all();
        }
        true
    }

    /// The stream of its audio buses, for a player of one's own. It can be played in one place.
    /// Null: the world is not built.
    #[func]
    fn audio_stream(&self) -> Option<Gd<AsperityStream>> {
        self.stream.clone()
    }

    /// By how many frames what is played comes after the engine's own time line: what `render_log`
    /// renders begins so many frames earlier.
    #[func]
    fn latency_frames(&self) -> i64 {
        self.latency_frames as i64
    }

    /// A stream of two haptic channels, for a player of one's own; -1: none on that side.
    #[func]
    fn haptic_stream(&mut self, left: i64, right: i64) -> Option<Gd<AsperityHapticStream>> {
        let ports = self.tried("haptic_stream", |running| {
            let mut open = |number: i64| -> Result<Option<PcmPort>, String> {
                let Some(channel) = events::channel(number)? else { return Ok(None) };
                let port = running.scene.open_port(Pcm { from: Feed::Haptic(channel), holds_s: HOLDS_S });
                port.map(Some).map_err(|error| error.to_string())
            };
            Ok([open(left)?, open(right)?])
        })?;
        let stream = AsperityHapticStream::new_gd();
        if let Ok(mut home) = stream.bind().ports.lock() {
            *home = Some(ports);
        }
        Some(stream)
    }

    /// Adds a surface to a body (0: none) and gives its id; 0, and an error, where it is refused.
    #[func]
    fn add_surface(&mut self, surface: Option<Gd<AsperitySurface>>, body: i64, name: GString) -> i64 {
        let surface = surface.ok_or_else(|| "surface: is null; give an AsperitySurface".to_owned());
        let Some(surface) = self.said("add_surface", surface) else { return 0 };
        self.join_surface(&surface, body, &name.to_string())
    }

    /// Adds what touches, a table as a scene file's `[probe]` (`preset = "rigid"`, `face_m = 0.4`
    /// for a crate), and gives its id for `report_begin`; best before the surfaces, which get ready
    /// for it. 0, and an error, where it is refused.
    #[func]
    fn add_probe(&mut self, table: GString, name: GString) -> i64 {
        let added = self.tried("add_probe", |running| {
            let probe = Scene::read_probe(&table.to_string()).map_err(|error| error.to_string())?;
            let id = running.scene.add_probe(probe).map_err(|error| error.to_string())?;
            if !name.is_empty() {
                running.names.probes.insert(name.to_string(), id);
            }
            Ok(id.to_bits() as i64)
        });
        added.unwrap_or(0)
    }

    /// Takes a surface away; contacts on it fade. Its id is refused from then on.
    #[func]
    fn remove_surface(&mut self, id: i64) -> bool {
        self.tried("remove_surface", |running| {
            let id = SurfaceId::from_bits(id as u64);
            running.scene.remove_surface(id).map_err(|error| error.to_string())?;
            running.names.surfaces.retain(|_, known| *known != id);
            Ok(())
        })
        .is_some()
    }

    /// The id of a surface by its name in the scene file, or that of its `AsperityBody`; 0: there
    /// is none.
    #[func]
    fn find_surface(&self, name: GString) -> i64 {
        let running = self.running.as_ref();
        running.and_then(|r| r.names.surfaces.get(&name.to_string())).map_or(0, |id| id.to_bits() as i64)
    }

    /// The id of a body by its name; 0: there is none.
    #[func]
    fn find_body(&self, name: GString) -> i64 {
        let running = self.running.as_ref();
        running.and_then(|r| r.names.bodies.get(&name.to_string())).map_or(0, |id| id.to_bits() as i64)
    }

    /// Statistics so far; `clock_jumps` and `refused` should be 0. `limiter_db` is by how
    /// much limiters have turned down at most; `why_silent` says what speaks against anything being
    /// heard, `why_clipped` what is too loud and what to turn.
    #[func]
    fn stats(&mut self) -> VarDictionary {
        let mut told = VarDictionary::new();
        let Some(running) = &mut self.running else { return told };
        let stats = running.scene.stats();
        for (name, count) in [
            ("impacts", stats.impacts),
            ("jumps", stats.jumps),
            ("late", stats.late),
            ("clock_jumps", stats.clock_jumps),
            ("refused", stats.refused),
            ("contacts", stats.contacts),
            ("limiter_db", stats.limiter_db),
        ] {
            told.set(name, count as i64);
        }
        let why: Vec<String> = running.scene.why_silent().iter().map(ToString::to_string).collect();
        told.set("why_silent", why.join("; ").as_str());
        let why: Vec<String> = running.scene.why_clipped().iter().map(ToString::to_string).collect();
        told.set("why_clipped", why.join("; ").as_str());
        told
    }

    /// The sentence of the last thing that was refused; empty: nothing was.
    #[func]
    fn last_error(&self) -> GString {
        (&self.error).into()
    }
}

impl AsperityWorld {
    /// The world of a tree.
    pub(crate) fn of(tree: &Gd<SceneTree>) -> Option<Gd<Self>> {
        let worlds = tree.clone().get_nodes_in_group(GROUP);
        // One that goes at the end of this frame takes nobody in.
        worlds.iter_shared().find(|world| !world.is_queued_for_deletion())?.try_cast::<Self>().ok()
    }

    /// Points of a haptic channel, 100 a second in the range of a headset's controller.
    pub(crate) fn points(&mut self, channel: i64) -> Option<PointsPort> {
        self.tried("AsperityHaptics", |running| {
            let channel = events::channel(channel)?.ok_or("channel: must be a haptic channel from 0")?;
            let settings = PointSettings { rate_hz: 100.0, band_hz: [55.0, 200.0], tone: Tone::Drawn };
            let kind = Points { from: Feed::Haptic(channel), settings, holds_s: HOLDS_S };
            running.scene.open_port(kind).map_err(|error| error.to_string())
        })
    }

    /// Rectangles of surfaces that have a frame.
    pub(crate) fn rectangles(&self, ids: &[SurfaceId]) -> Result<Vec<TipSurface>, String> {
        let running =
            self.running.as_ref().ok_or("the world is not built; call build(), or see its error")?;
        running.scene.tip_surfaces(ids).map_err(|error| error.to_string())
    }

    /// Number of builds.
    pub(crate) fn builds(&self) -> u64 {
        self.builds
    }

    /// Lets its buses sound and vibrate.
    fn play_all(&mut self) {
        if self.running.is_none() {
            return;
        }
        if let Some(stream) = self.stream.clone().filter(|_| !self.audio_bus.is_empty()) {
            self.play(&stream.upcast(), &self.audio_bus.clone());
        }
        if !self.haptic_bus.is_empty()
            && let Some(stream) = self.haptic_stream(0, 1)
        {
            self.play(&stream.upcast(), &self.haptic_bus.clone());
        }
    }

    fn play(&mut self, stream: &Gd<godot::classes::AudioStream>, bus: &StringName) {
        let mut player = AudioStreamPlayer::new_alloc();
        player.set_stream(stream);
        player.set_bus(bus);
        self.base_mut().add_child(&player);
        player.play();
        self.players.push(player);
    }

    /// Does something with the engine; says so where there is none.
    pub(crate) fn tried<T>(
        &mut self,
        what: &str,
        work: impl FnOnce(&mut Running) -> Result<T, String>,
    ) -> Option<T> {
        let done = match &mut self.running {
            Some(running) => work(running),
            None => Err("the world is not built; call build(), or see its error".into()),
        };
        self.said(what, done)
    }

    /// Says what was refused.
    pub(crate) fn said<T>(&mut self, what: &str, done: Result<T, String>) -> Option<T> {
        done.inspect_err(|sentence| {
            godot_error!("{what}: {sentence}");
            self.error.clone_from(sentence);
        })
        .ok()
    }
}
