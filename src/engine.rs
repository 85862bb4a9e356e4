//! Assembly of an engine from its settings: designs what is fixed, makes all memory, ties the two
//! halves together.

use crate::audio::renderer::Renderer;
use crate::files::contact_log::Names;
use crate::game::clock::Clock;
use crate::game::scene::Scene;
use crate::link::ring;
use crate::link::stats::Counters;
use crate::model::config::Config;
use crate::model::error::ConfigError;
use crate::model::levels::Levels;
use crate::resource::probe::{PreparedProbe, remark};
use crate::trial::TRIALS;
use asperity_surface::sand::SandWorker;
use std::sync::Arc;

/// An engine, built: a half for each thread, and what its parts are called.
///
/// ```
/// use asperity::{Config, Engine};
///
/// let Engine { scene, mut renderer, .. } = Config::default().build()?;
/// let (mut haptic, mut audio) = ([0.0; 64], [0.0; 64]);
/// renderer.render(&mut [&mut haptic], &mut [&mut audio]);
/// assert_eq!(scene.stats().position, 64);
/// # Ok::<(), asperity::ConfigError>(())
/// ```
#[non_exhaustive]
pub struct Engine {
    /// The game thread's half: takes resources and events.
    pub scene: Scene,
    /// The audio thread's half: renders.
    pub renderer: Renderer,
    /// Names of bodies, surfaces and strikers, where the engine was built from a file; empty
    /// otherwise.
    pub names: Names,
    /// Simulations that have to run on threads of their own, sand for instance; empty unless the
    /// engine was built to play live.
    pub workers: Vec<SandWorker>,
    /// Levels that were written or resolved, where the engine was built from a file; empty
    /// otherwise.
    pub levels: Levels,
    /// Doubts that are no errors, a line each: a coloured picture taken by its brightness, another
    /// integrator than the one asked for.
    pub remarks: Vec<String>,
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("names", &self.names).finish_non_exhaustive()
    }
}

impl Config {
    /// Builds the two halves: [`Scene`] for the game thread, [`Renderer`] for the audio thread.
    ///
    /// # Errors
    /// When a setting is outside its range; the message names the field.
    pub fn build(self) -> Result<Engine, ConfigError> {
        self.check()?;
        let kernel = self.kernel()?;
        let probe =
            PreparedProbe::new(&self.probe, &self.probe, self.integrator, self.inner_rate_hz(), kernel)?;
        let remarks = remark(probe.micro_contact.choice()).into_iter().collect();
        let counters = Arc::new(Counters::new(self.audio.len()));
        let (to_audio, from_game) = ring::channel(self.queue_capacity);
        let (to_game, from_audio) = ring::channel(self.most_to_free());
        let renderer = Renderer::new(&self, kernel, probe, from_game, to_game, counters.clone())?;
        let clock = Clock::new(self.clock, self.inner_rate_hz());
        let scene = Scene::new(self, (kernel, TRIALS), clock, to_audio, from_audio, counters);
        Ok(Engine {
            scene,
            renderer,
            names: Names::default(),
            workers: Vec::new(),
            levels: Levels::default(),
            remarks,
        })
    }
}
