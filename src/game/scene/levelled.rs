//! Levels of what is added and reported, as the scene's policy has them.

use super::Scene;
use crate::game::clipping::{ClipReason, TOLD_DB};
use crate::game::levels::BodyLevel;
use crate::model::body::Body;
use crate::model::config::Config;
use crate::model::error::AddError;
use crate::model::event::{ContactEvent, ContactId, Impact};
use crate::model::id::BodyId;
use crate::model::level_policy::LevelPolicy;
use crate::model::levels::REFERENCE_SPEED_M_S;
use crate::model::surface::Surface;
use crate::resource::surface::SurfaceLevels;
use asperity_dsp::micro_contact::Probe;
use std::sync::atomic::Ordering::Relaxed;

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

    /// Reasons why more leaves than full scale holds, the loudest first, each with what to turn and
    /// by how much; empty where nothing does. What has clipped is known where a limiter stood
    /// behind it, and otherwise from the meters of the last half second. A reference strike is
    /// rendered on every body that was struck, which takes some milliseconds the first time.
    ///
    /// ```
    /// use asperity::{Body, Config, ContactEvent, Engine, Impact, Material, Stock};
    ///
    /// let Engine { mut scene, mut renderer, .. } = Config::default().build()?;
    /// let bell = scene.add_body(Body::stock(Stock::Bowl, Material::STEEL, 0.1)?)?;
    /// scene.report(0.0, ContactEvent::Impact(Impact { mass_kg: 5.0, ..Impact::on(bell) }))?;
    /// renderer.render(&mut [&mut [0.0; 512]], &mut [&mut [0.0; 512]]);
    /// assert!(scene.why_clipped()[0].to_string().starts_with("impacts on body 0 peak"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn why_clipped(&mut self) -> Vec<ClipReason> {
        let stats = self.stats();
        let most = stats.bus_levels.iter().fold(0.0, |most, peak| f64::max(most, f64::from(*peak)));
        let [heard_db, felt_db] = [0, 1].map(|of| self.counters.limiters_db[of].load(Relaxed) as f64);
        let felt = (felt_db >= TOLD_DB).then_some(ClipReason::Felt { by_db: felt_db });
        let by_db = heard_db.max(20.0 * libm::log10(most.max(1e-9)));
        if by_db < TOLD_DB {
            return felt.into_iter().collect();
        }
        let blows: Vec<(BodyId, f64)> =
            self.strongest.blows_n_s.iter().map(|(id, n_s)| (*id, *n_s)).collect();
        let mut because: Vec<_> = blows.into_iter().filter_map(|(id, n_s)| self.blows(id, n_s)).collect();
        because.sort_by(|a, b| b.by_db().total_cmp(&a.by_db()).then(a.to_string().cmp(&b.to_string())));
        because.iter_mut().for_each(|reason| reason.hold(by_db));
        if because.is_empty() {
            let stroked = self.strongest.stroked();
            let strokes = stroked.map(|(surface, [force_n, speed_m_s])| ClipReason::Strokes {
                surface,
                by_db,
                force_n,
                speed_m_s,
            });
            because.push(strokes.unwrap_or(ClipReason::Sum { by_db }));
        }
        because.extend(felt);
        because
    }

    /// The hardest blow on a body, where it alone peaks above full scale.
    fn blows(&mut self, id: BodyId, impulse_n_s: f64) -> Option<ClipReason> {
        let (body, level) = (self.given.get(&id)?, self.bodies.get(id.0)?.level);
        let bus = self.config.audio.get(body.bus)?.gain;
        let unit = self.levels.peak_per_n_s(&self.config, body).ok()?;
        let peak = unit * impulse_n_s * level.gain * level.strike_gain * body.gain * bus;
        let by_db = 20.0 * libm::log10(peak.max(1e-9));
        let strike_gain = level.strike_gain / peak;
        (by_db >= TOLD_DB).then_some(ClipReason::Blows { body: id, by_db, strike_gain })
    }

    /// The level that a body has got.
    pub(crate) fn level_of(&self, id: BodyId) -> BodyLevel {
        let as_given = || self.given.get(&id).map(BodyLevel::given);
        let level = self.bodies.get(id.0).map(|known| known.level).or_else(as_given);
        level.unwrap_or(BodyLevel::SILENT)
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
                let Some(pulse) = self.pulse(&impact) else { return event };
                let bodies = [Some(impact.body), impact.other, impact.holder].into_iter().flatten();
                let factor = bodies.map(|id| self.level_of(id).blow_factor(pulse));
                ContactEvent::Impact(Impact { gain: impact.gain * factor.fold(1.0, f64::min), ..impact })
            }
            ContactEvent::End { .. } | ContactEvent::Motion { .. } => event,
        }
    }

    /// The factor of a contact that nobody feels; 1 where it is felt, or nothing is known of it.
    fn stroke_factor(&self, contact: ContactId, force_n: f64, velocity_m_s: Option<[f64; 2]>) -> f64 {
        let touched = self.touched.get(&contact).filter(|touched| touched.unfelt && force_n.is_finite());
        let level =
            touched.and_then(|touched| self.surfaces.get(touched.surface.0)?.levels.of(touched.probe));
        let speed_m_s = velocity_m_s.map_or(REFERENCE_SPEED_M_S, |[u, v]| libm::hypot(u, v));
        level.map_or(1.0, |level| level.stroke_factor(force_n, speed_m_s))
    }
}
