//! A change of the sample rate: the device has another one, and the scene goes on.
//!
//! The old renderer hands its surfaces over, everything else is designed again for the new rate.
//! Ids stay what they are, time goes on at the same second, contacts that touch come back with
//! their next move; what rings is cut.

use crate::audio::renderer::Renderer;
use crate::game::scene::Scene;
use crate::link::ring;
use crate::model::config::Config;
use crate::model::error::{AddError, ConfigError};
use crate::model::id::{ProbeId, SurfaceId};
use crate::resource::probe::PreparedProbe;

/// A renderer at another rate.
#[non_exhaustive]
pub struct AtRate {
    /// Renders from now on.
    pub renderer: Renderer,
    /// Surfaces whose sources refuse the new rate, with the reason: they are no longer in the
    /// scene.
    pub lost: Vec<(SurfaceId, AddError)>,
}

/// Why a scene cannot go on at another rate. It goes on at the old one.
#[derive(thiserror::Error)]
#[error("{reason}")]
pub struct RateError {
    /// The renderer that was given.
    pub renderer: Box<Renderer>,
    /// Why.
    pub reason: AddError,
}

impl std::fmt::Debug for RateError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RateError").field("reason", &self.reason).finish_non_exhaustive()
    }
}

impl std::fmt::Debug for AtRate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AtRate").field("lost", &self.lost).finish_non_exhaustive()
    }
}

impl Scene {
    /// Goes on at another sample rate: takes the renderer that is no longer called, and gives the
    /// one to call from now on. Bodies, surfaces, probes, gains and names stay. Ports end and have
    /// to be opened again.
    ///
    /// ```
    /// use asperity::{Config, Engine};
    ///
    /// let Engine { mut scene, renderer, .. } = Config::live(44_100.0).build()?;
    /// // The headset was plugged in, and runs at 48 kHz.
    /// let mut renderer = scene.at_rate(renderer, 48_000.0)?.renderer;
    /// assert_eq!(renderer.sample_rate_hz(), 48_000.0);
    /// # let (mut haptic, mut audio) = ([0.0; 64], [0.0; 64]);
    /// # renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the rate is outside its range, or something of the scene cannot be rendered at it; the
    /// renderer is handed back.
    pub fn at_rate(&mut self, old: Renderer, sample_rate_hz: f64) -> Result<AtRate, RateError> {
        let before = self.config.clone();
        self.config.sample_rate_hz = sample_rate_hz;
        match self.designed_anew() {
            Ok(new) => Ok(self.move_to(new, old)),
            Err(reason) => {
                self.config = before;
                Err(RateError { renderer: Box::new(old), reason })
            }
        }
    }

    /// Everything but the surfaces, at the rate of the config.
    fn designed_anew(&self) -> Result<New, AddError> {
        let config: &Config = &self.config;
        config.check().map_err(design)?;
        let (kernel, inner_hz) = (self.kernel, config.inner_rate_hz());
        let probe = PreparedProbe::new(&config.probe, &config.probe, config.integrator, inner_hz, kernel)?;
        let (to_audio, from_game) = ring::channel(config.queue_capacity);
        let (to_game, from_audio) = ring::channel(config.most_to_free());
        let mut renderer = Renderer::new(config, kernel, probe, from_game, to_game, self.counters.clone())
            .map_err(design)?;
        for (place, probe) in self.probes.iter() {
            renderer.install(self.prepared_probe(ProbeId(place), probe)?);
        }
        for (id, body) in &self.given {
            let level = self.level_of(*id);
            renderer.install(self.prepared_body(*id, body, level, None)?.0);
        }
        Ok(New { renderer, to_audio, from_audio })
    }

    fn move_to(&mut self, new: New, old: Renderer) -> AtRate {
        let New { mut renderer, to_audio, from_audio } = new;
        let mut old = old.hand_over();
        let mut lost = Vec::new();
        for (id, slot) in std::mem::take(&mut old.surfaces) {
            match self.prepared_surface(id, slot.surface, slot.levels) {
                Ok((message, _)) => renderer.install(message),
                Err(reason) => {
                    self.surfaces.remove(id.0);
                    lost.push((id, reason));
                }
            }
        }
        (self.to_audio, self.from_audio) = (to_audio, from_audio);
        self.open_ports = 0;
        self.rested.clear();
        self.clock.at_rate(self.config.inner_rate_hz());
        for message in renderer.take_over(old) {
            // As many as the old queue held.
            let _ = self.to_audio.send(message);
        }
        AtRate { renderer, lost }
    }
}

/// Parts that are designed before anything is taken from the old renderer.
struct New {
    renderer: Renderer,
    to_audio: ring::Sender<crate::link::message::Message>,
    from_audio: ring::Receiver<crate::link::message::Retired>,
}

pub(crate) fn design(error: ConfigError) -> AddError {
    match error {
        ConfigError::Design(error) => AddError::Design(error),
        ConfigError::Kernel { .. } => AddError::Unknown("kernel"),
        ConfigError::Threads { .. } => AddError::Unknown("threads"),
    }
}
