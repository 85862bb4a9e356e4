//! What is touched: where a place of a body is on its surface, and how what gives way answers a depth.

use super::Scene;
use crate::model::contact_sample::Place;
use crate::model::error::{AddError, Refusal};
use crate::model::event::{ContactId, ContactSample};
use crate::model::id::SurfaceId;
use asperity_texture::tip_law::TipLaw;

impl Scene {
    /// Texture coordinates of a point in the body of a surface that has a [frame](crate::Surface::frame), m; none for one that has none.
    ///
    /// # Errors
    /// When the surface is not in this scene.
    pub fn uv_at(
        &self,
        id: SurfaceId,
        point_m: impl Into<mint::Vector3<f64>>,
    ) -> Result<Option<[f64; 2]>, AddError> {
        let known = self.known_surface(id)?;
        let Place { frame, size_m, .. } = known.place;
        Ok(frame.map(|frame| frame.uv(point_m, size_m)))
    }

    /// How a surface that gives way answers the depth of a tip, for the thread that drives a device; none for a hard one. It is the law
    /// that the surface was added with.
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
        let known = self.touched.get(&contact).and_then(|surface| self.surfaces.get(surface.0));
        let nowhere = Place { frame: None, size_m: [1.0; 2], is_soft: false };
        sample.on(known.map_or(&nowhere, |known| &known.place))
    }
}
