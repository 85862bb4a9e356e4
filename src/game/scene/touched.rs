//! Places: where a place of a body is on its surface, and how what gives way answers a depth.

use super::spin::Spin;
use super::{Scene, Touched};
use crate::game::tip::TipSurface;
use crate::model::contact_sample::Placement;
use crate::model::error::{AddError, Refusal};
use crate::model::event::{ContactEvent, ContactId, ContactSample};
use crate::model::frame::SurfaceFrame;
use crate::model::id::{ProbeId, SurfaceId};
use crate::model::strike_field::StrikePlace;
use asperity_surface::tip_law::TipLaw;

impl Scene {
    /// Texture coordinates of a point in the body of a surface that has a
    /// [frame](crate::Surface::frame), m; none for one that has none.
    ///
    /// # Errors
    /// When the surface is not in this scene.
    pub fn uv_at(
        &self,
        id: SurfaceId,
        point_m: impl Into<mint::Vector3<f64>>,
    ) -> Result<Option<[f64; 2]>, AddError> {
        let known = self.known_surface(id)?;
        let Placement { frame, size_m, .. } = known.place;
        Ok(frame.map(|frame| frame.uv(point_m, size_m)))
    }

    /// Rectangles of surfaces that have a [frame](crate::Surface::frame), for a tracked
    /// [`Tip`](crate::Tip) in the axes of their body.
    ///
    /// # Errors
    /// When a surface is not in this scene, or has no frame.
    pub fn tip_surfaces(&self, ids: &[SurfaceId]) -> Result<Vec<TipSurface>, AddError> {
        let rectangle = |id: &SurfaceId| {
            let Placement { frame, size_m, .. } = self.known_surface(*id)?.place;
            Ok(TipSurface { frame: frame.ok_or(AddError::NoFrame)?, size_m })
        };
        ids.iter().map(rectangle).collect()
    }

    /// Law of a surface that gives way for the depth of a tip, for the thread that drives a device;
    /// none for a hard one. It is the law that the surface was added with.
    ///
    /// # Errors
    /// When the surface is not in this scene.
    pub fn tip_law(&self, id: SurfaceId) -> Result<Option<TipLaw>, AddError> {
        Ok(self.known_surface(id)?.tip_law)
    }

    /// A move on the surface that its contact began on.
    pub(super) fn on_touched(
        &self,
        contact: ContactId,
        sample: ContactSample,
    ) -> Result<ContactSample, Refusal> {
        if sample.at_m.is_none() && sample.depth_m.is_none() {
            return Ok(sample);
        }
        let known = self.touched.get(&contact).and_then(|touched| self.surfaces.get(touched.surface.0));
        let nowhere = Placement { frame: None, size_m: [1.0; 2], is_soft: false };
        sample.on(known.map_or(&nowhere, |known| &known.place))
    }

    /// Remembers what a contact touches, and where it says it is in the body.
    pub(super) fn note_touch(&mut self, event: &ContactEvent) {
        match event {
            ContactEvent::Begin { contact, touching, sample } => {
                let touched = Touched {
                    surface: touching.surface,
                    at_m: sample.at_m,
                    probe: touching.probe.map(ProbeId::index),
                    gain: touching.gain,
                    unfelt: touching.actuator.is_none(),
                    spin: Spin::default(),
                };
                self.touched.insert(*contact, touched);
            }
            ContactEvent::Moved { contact, sample, emphasis } => {
                if let Some(touched) = self.touched.get_mut(contact) {
                    touched.at_m = sample.at_m;
                    touched.gain = emphasis.gain.unwrap_or(touched.gain);
                }
            }
            ContactEvent::End { .. } | ContactEvent::Impact(_) | ContactEvent::Motion { .. } => {}
        }
    }

    /// An event at `now_s` of the audio, over ground that runs on where it slips faster than it
    /// moves.
    pub(super) fn spun(&mut self, now_s: f64, mut event: ContactEvent) -> ContactEvent {
        if let ContactEvent::Begin { contact, sample, .. } | ContactEvent::Moved { contact, sample, .. } =
            &mut event
            && let Some(touched) = self.touched.get_mut(contact)
            && let Some(known) = self.surfaces.get(touched.surface.0)
        {
            *sample = touched.spin.under(now_s, known.place.size_m, *sample);
        }
        event
    }

    /// Place of a contact on a body that has shapes: its own place counts before its surface's
    /// frame; none where both are missing.
    pub(super) fn touched(&self, event: &ContactEvent) -> Option<StrikePlace> {
        let (ContactEvent::Begin { contact, sample, .. } | ContactEvent::Moved { contact, sample, .. }) =
            event
        else {
            return None;
        };
        let touched = self.touched.get(contact)?;
        let known = self.surfaces.get(touched.surface.0)?;
        let field = self.bodies.get(known.body?.0)?.field.as_ref()?;
        let Placement { frame, size_m, .. } = &known.place;
        let uv = touched.spin.uv().unwrap_or(sample.uv);
        let in_frame = || Some(frame.as_ref()?.point_m(uv, *size_m));
        // A bow stands on what its frame says, which at the edge of a sheet is no part of the
        // sheet.
        let inward = frame.as_ref().filter(|_| known.rubs).map(SurfaceFrame::inward);
        field.place(touched.at_m.or_else(in_frame)?, inward)
    }
}
