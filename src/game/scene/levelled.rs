//! Levels of what is added and reported, as the scene's policy has them.

use super::Scene;
use crate::game::levels::BodyLevel;
use crate::model::body::Body;
use crate::model::config::Config;
use crate::model::error::AddError;
use crate::model::event::{ContactEvent, ContactId, Impact};
use crate::model::id::BodyId;
use crate::model::level_policy::LevelPolicy;
use crate::model::surface::Surface;
use crate::open::levels::REFERENCE_SPEED_M_S;
use crate::prepared::surface::SurfaceLevels;
use asperity_dsp::micro_contact::Probe;

impl Scene {
    /// Finds the level of a surface before it is added, while a game loads for instance, so that
    /// adding one of equal content takes microseconds; nothing where levels are as given
    /// ([`Config::levels`](field@Config::levels)). The surface says on which body it will be.
    ///
    /// # Errors
    /// As [`add_surface`](Self::add_surface).
    pub fn prepare(&mut self, surface: Surface) -> Result<Surface, AddError> {
        Ok(self.levelled_surface(surface)?.0)
    }

    /// [`prepare`](Self::prepare) for a body.
    ///
    /// # Errors
    /// As [`add_body`](Self::add_body).
    pub fn prepare_body(&mut self, body: &Body) -> Result<(), AddError> {
        self.levels.body(&self.config, body).map(|_| ())
    }

    /// The level that a body has got.
    pub(crate) fn level_of(&self, id: BodyId) -> BodyLevel {
        let as_given = || self.given.get(&id).map(BodyLevel::given);
        let level = self.bodies.get(id.0).map(|known| known.level).or_else(as_given);
        level.unwrap_or(BodyLevel { gain: 1.0, strike_gain: 1.0, peak_per_n_s: 0.0 })
    }

    pub(super) fn levelled_surface(
        &mut self,
        surface: Surface,
    ) -> Result<(Surface, SurfaceLevels), AddError> {
        let Config { probe, levels, .. } = &self.config;
        if *levels == LevelPolicy::AsGiven {
            return Ok((surface, SurfaceLevels::default()));
        }
        let (given, bodies) = (&self.given, &self.bodies);
        let known = |id: BodyId| Some((given.get(&id)?, bodies.get(id.0)?.level));
        let body = surface.body.map(|id| known(id).ok_or(AddError::Unknown("body"))).transpose()?;
        let own = std::iter::once((None, *probe));
        let others = self.probes.iter().map(|(place, probe)| (Some(place.index as usize), *probe));
        let probes: Vec<(Option<usize>, Probe)> = own.chain(others).collect();
        self.levels.surface(&self.config, surface, body, &probes)
    }

    /// An event as loud as the levels of what it meets let it be.
    pub(super) fn levelled(&self, event: ContactEvent) -> ContactEvent {
        if self.config.levels == LevelPolicy::AsGiven {
            return event;
        }
        match event {
            ContactEvent::Begin { contact, mut touching, sample } => {
                let speed = sample.velocity_m_s;
                touching.gain *= self.stroke_factor(contact, sample.normal_force_n, speed);
                ContactEvent::Begin { contact, touching, sample }
            }
            ContactEvent::Moved { contact, sample, mut emphasis } => {
                if let Some(touched) = self.touched.get(&contact).filter(|touched| touched.unfelt) {
                    let factor = self.stroke_factor(contact, sample.normal_force_n, sample.velocity_m_s);
                    emphasis.gain = Some(touched.gain * factor);
                }
                ContactEvent::Moved { contact, sample, emphasis }
            }
            ContactEvent::Impact(impact) => {
                let impulse_n_s =
                    impact.gain * impact.mass_kg * impact.speed_m_s * (1.0 + impact.restitution);
                let bodies = [Some(impact.body), impact.other, impact.holder].into_iter().flatten();
                let factor = bodies.map(|id| self.level_of(id).blow_factor(impulse_n_s));
                ContactEvent::Impact(Impact { gain: impact.gain * factor.fold(1.0, f64::min), ..impact })
            }
            ContactEvent::End { .. } => event,
        }
    }

    /// The factor of a contact that nobody feels; 1 where it is felt, or nothing is known of it.
    fn stroke_factor(&self, contact: ContactId, force_n: f64, velocity_m_s: Option<[f64; 2]>) -> f64 {
        let touched = self.touched.get(&contact).filter(|touched| touched.unfelt && force_n.is_finite());
        let level = touched.and_then(|touched| {
            self.surfaces.get(touched.surface.0)?.levels.of(touched.probe)
        });
        let speed_m_s = velocity_m_s.map_or(REFERENCE_SPEED_M_S, |[u, v]| libm::hypot(u, v));
        level.map_or(1.0, |level| level.stroke_factor(force_n, speed_m_s))
    }
}
