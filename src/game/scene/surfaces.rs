//! Surfaces of a scene: added, changed, replaced, removed.

use super::{KnownBody, KnownSurface, Scene};
use crate::files::contact_log::LogEdit;
use crate::game::contradiction::Sheet;
use crate::game::levels::BodyLevel;
use crate::link::message::Message;
use crate::model::body::Body;
use crate::model::contact_sample::Placement;
use crate::model::error::AddError;
use crate::model::id::SurfaceId;
use crate::model::surface::Surface;
use crate::resource::long_waves;
use crate::resource::overlay::Overlay;
use crate::resource::surface::{SurfaceLevels, SurfaceSlot};
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_surface::height_field::Setup;
use std::any::Any;

impl Scene {
    /// Adds a surface; where levels are [found](crate::LevelPolicy), a new one takes some ten
    /// milliseconds a probe, and one of a content that was there or was
    /// [prepared](Self::prepare) some ten microseconds.
    ///
    /// # Errors
    /// When every place is taken, its body is not in this scene, or a number is impossible.
    pub fn add_surface(&mut self, surface: Surface) -> Result<SurfaceId, AddError> {
        self.collect();
        let id = SurfaceId(self.surfaces.free()?);
        let is = self.described(&surface);
        self.set_surface(id, surface)?;
        self.note(|names| LogEdit::AddSurface { surface: names.surface(id), is });
        Ok(id)
    }

    /// Changes a surface under the contacts that slide on it, without a click.
    ///
    /// # Errors
    /// As [`add_surface`](Self::add_surface), or when the surface is not in this scene.
    pub fn replace_surface(&mut self, id: SurfaceId, surface: Surface) -> Result<(), AddError> {
        self.collect();
        self.known_surface(id)?;
        let is = self.described(&surface);
        self.set_surface(id, surface)?;
        self.note(|names| LogEdit::ReplaceSurface { surface: names.surface(id), is });
        Ok(())
    }

    pub(super) fn set_surface(&mut self, id: SurfaceId, surface: Surface) -> Result<(), AddError> {
        let (surface, levels) = self.levelled_surface(surface)?;
        let (message, known) = self.prepared_surface(id, surface, levels)?;
        self.send(message)?;
        self.surfaces.set(id.0, known);
        Ok(())
    }

    /// A surface as the audio half takes it.
    pub(crate) fn prepared_surface(
        &self,
        id: SurfaceId,
        surface: Surface,
        levels: SurfaceLevels,
    ) -> Result<(Message, KnownSurface), AddError> {
        let mut surface = surface.checked()?.tiled();
        let relief_m = surface.properties().reach_m;
        let tip_radii_m: Vec<f64> = self.rides.iter().map(|probe| probe.ride_radius_m(relief_m)).collect();
        surface.source.prepare(&Setup {
            sample_rate_hz: self.config.inner_rate_hz(),
            voices: self.config.voices(),
            tip_radii_m: &tip_radii_m,
        })?;
        let properties = surface.properties();
        let silent = KnownBody {
            material: Body::DEFAULT_MATERIAL,
            lowest_mode_hz: f64::INFINITY,
            field: None,
            weighs: false,
            level: BodyLevel::SILENT,
            variation: None,
        };
        let body = surface.body.map_or(Ok(silent), |body| self.known_body(body))?;
        let rubs = surface.rubs().is_some();
        let placed = body.field.is_none() || surface.frame.is_some();
        if rubs && !(body.can_be_rubbed() && placed) {
            return Err(AddError::CannotRub);
        }
        let stroking = self.stroking(&body)?;
        let config = &self.config;
        let period_m = surface.wrap_period_m();
        let trajectory = |period_m| {
            TrajectoryDesign::new(config.path, config.path_cutoff_hz, config.inner_rate_hz(), period_m)
        };
        let (trajectory, place_trajectory) = (trajectory(period_m)?, trajectory([f64::INFINITY; 2])?);
        let relief = (surface.micro_relief_m, surface.outer_scale_m, surface.micro_relief_octaves_db);
        let waves_m = long_waves::under(&mut surface, &properties);
        let overlay = Overlay::new(period_m, properties.band.shortest_m, relief, waves_m);
        let rings = body.lowest_mode_hz.is_finite();
        let is_soft = surface.compliance_m_n > 0.0 || properties.tip_law.is_some();
        let place = Placement { frame: surface.frame, size_m: [surface.width_m, surface.height_m], is_soft };
        let sheet = Sheet { size_m: place.size_m, period_m };
        let on = surface.body;
        let picture = properties.picture.clone();
        let tip_law = (surface.compliance_m_n > 0.0).then(|| surface.spring()).or(properties.tip_law);
        let surface = Box::new(SurfaceSlot {
            surface,
            properties,
            trajectory,
            place_trajectory,
            stroking,
            overlay,
            period_m,
            levels: levels.clone(),
        });
        Ok((
            Message::SetSurface { id, surface },
            KnownSurface { rings, picture, place, sheet, tip_law, body: on, rubs, levels },
        ))
    }

    /// Changes parameters of a surface's source while it is touched, without a click. What a source
    /// takes is said where it is documented: solid noise its parameters, a scaled source a
    /// [`ScaleTo`](asperity_surface::combine::ScaleTo), one of your own whatever type it looks for.
    /// A change that no source of the surface takes (another type, or impossible numbers) is
    /// counted as quarantined. It holds from the stamp of the last event on, after everything that
    /// is queued already: a game that reports ahead gets it then, not now. Recordings hold no such
    /// change.
    ///
    /// # Errors
    /// When the surface is not in this scene or the queue is full.
    pub fn change_surface(&mut self, id: SurfaceId, change: impl Any + Send + Sync) -> Result<(), AddError> {
        self.known_surface(id)?;
        self.send(Message::ChangeSurface { slot: id.index(), change: Box::new(change) })?;
        self.note(|names| LogEdit::ChangeSurface { surface: names.surface(id) });
        Ok(())
    }

    /// Takes a surface away; contacts on it fade.
    ///
    /// # Errors
    /// When it is not in this scene or the queue is full.
    pub fn remove_surface(&mut self, id: SurfaceId) -> Result<(), AddError> {
        self.known_surface(id)?;
        self.send(Message::RemoveSurface { slot: id.index() })?;
        self.surfaces.remove(id.0);
        self.strongest.strokes.remove(&id);
        self.motions.forget(id);
        self.note(|names| LogEdit::RemoveSurface { surface: names.surface(id) });
        Ok(())
    }
}
