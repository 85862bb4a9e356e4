//! Handles: what a program holds of a scene, a renderer, a port, a player, a tip and a world of
//! pairs.

use crate::entry::enter;
use crate::handle::Table;
use crate::playing::Player;
use asperity::files::contact_log::Names;
use asperity::live::ports::{ForcePort, LevelsPort, PcmPort, PointsPort};
use asperity::surface::sand::SandThread;
use asperity::{Renderer, Scene, SurfaceId, Tip};
use asperity_pairs::{Collider, Probes, World};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The game's half of an engine: takes bodies, surfaces and events. One thread at a time.
pub struct asp_scene {
    _private: [u8; 0],
}

/// The audio half of an engine: renders. One thread at a time.
pub struct asp_renderer {
    _private: [u8; 0],
}

/// The reading end of a port: what leaves the engine, for any one thread.
pub struct asp_port {
    _private: [u8; 0],
}

/// An engine that plays on a sound card.
pub struct asp_player {
    _private: [u8; 0],
}

/// A tracked tip.
pub struct asp_tip {
    _private: [u8; 0],
}

/// Colliders of a simulated world, and what pairs of them do.
pub struct asp_pairs {
    _private: [u8; 0],
}

/// Scene behind a handle.
pub(crate) struct SceneHalf {
    pub(crate) scene: Scene,
    pub(crate) names: Names,
    /// Sand that is simulated on threads of its own; they end with the scene.
    pub(crate) sand: Vec<SandThread>,
    /// True where sand that is added later is simulated on its own thread.
    pub(crate) live: bool,
}

impl Drop for SceneHalf {
    fn drop(&mut self) {
        for sand in self.sand.drain(..) {
            sand.stop();
        }
    }
}

/// Renderer behind a handle, and memory for one stretch of every signal.
pub(crate) struct AudioHalf {
    /// Away only while it changes its rate.
    pub(crate) renderer: Option<Renderer>,
    pub(crate) haptic: Vec<Vec<f32>>,
    pub(crate) audio: Vec<Vec<f32>>,
    pub(crate) pickups: Vec<Vec<f32>>,
    /// The tick of a mixer that was rendered last, so that two effects do not render one engine
    /// twice.
    pub(crate) tick: Option<u64>,
}

/// Port behind a handle.
#[expect(clippy::large_enum_variant, reason = "the table boxes it whole")]
pub(crate) enum AnyPort {
    Pcm(PcmPort),
    Points(PointsPort),
    Levels(LevelsPort),
    Forces(ForcePort),
}

/// Contents of a tip's handle: the tip, and the surfaces that it may touch.
pub(crate) struct TrackedTip {
    pub(crate) tip: Tip,
    pub(crate) surfaces: Vec<SurfaceId>,
}

/// World of pairs behind a handle.
pub(crate) struct Simulated {
    pub(crate) world: World,
    pub(crate) probes: Probes,
    pub(crate) colliders: Vec<Option<Collider>>,
    /// Time of its last step.
    pub(crate) last_s: Option<f64>,
}

pub(crate) static SCENES: Table<SceneHalf> = Table::new(1, "scene");
pub(crate) static RENDERERS: Table<AudioHalf> = Table::new(2, "renderer");
pub(crate) static PORTS: Table<AnyPort> = Table::new(3, "port");
pub(crate) static PLAYERS: Table<Player> = Table::new(4, "player");
pub(crate) static TIPS: Table<TrackedTip> = Table::new(5, "tip");
pub(crate) static PAIRS: Table<Simulated> = Table::new(6, "pairs");

/// Frees what a handle names; what it leaves in a fault is not freed.
fn free<T: Send>(table: &Table<T>, handle: usize) -> i32 {
    enter(|| {
        if handle == 0 {
            return Ok(());
        }
        let value = table.remove(handle)?;
        let _ = catch_unwind(AssertUnwindSafe(|| drop(value)));
        Ok(())
    })
}

/// Frees a scene; null is nothing. Its renderer and ports may live on: they ring out. Not on the
/// audio thread.
#[unsafe(no_mangle)]
pub extern "C" fn asp_scene_free(scene: *mut asp_scene) -> i32 {
    free(&SCENES, scene as usize)
}

/// Frees a renderer; null is nothing. Waits until no other thread renders with it. Not on the audio
/// thread.
#[unsafe(no_mangle)]
pub extern "C" fn asp_renderer_free(renderer: *mut asp_renderer) -> i32 {
    free(&RENDERERS, renderer as usize)
}

/// Frees a tip; null is nothing. It ends no contact: report the end of what it touches.
#[unsafe(no_mangle)]
pub extern "C" fn asp_tip_free(tip: *mut asp_tip) -> i32 {
    free(&TIPS, tip as usize)
}

/// Frees a world of pairs; null is nothing. It ends no contact.
#[unsafe(no_mangle)]
pub extern "C" fn asp_pairs_free(pairs: *mut asp_pairs) -> i32 {
    free(&PAIRS, pairs as usize)
}

/// Closes a port; null is nothing.
#[unsafe(no_mangle)]
pub extern "C" fn asp_port_free(port: *mut asp_port) -> i32 {
    free(&PORTS, port as usize)
}
