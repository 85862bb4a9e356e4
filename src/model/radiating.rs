//! Radiating body: how loud each mode is in the air, as one gain a mode when it is loaded
//! (`dsp::radiation`).
//!
//! ```text
//! gain_m ← p̂_m at 1 m for a velocity of 1 m/s·kg^½        d_m ← d_m + d_rad        ω_m² + d_m² stays
//! ```
//! Nothing of it costs anything while it sounds.

use crate::model::click::Click;
use crate::model::material::Material;
use crate::model::modal_model::{ModalModel, ModalModelError};
use crate::model::mode_shapes::Unit;
use asperity_dsp::radiation::{EquivalentSphere, Surface};
use std::f64::consts::TAU;
use std::sync::Arc;

impl ModalModel {
    /// Body in pascals at 1 m: each mode as loud as its [shape](crate::ModeShapes) radiates, its
    /// decay with what radiation takes, and with the click of a body of this material that a blow
    /// pushes as a whole. One in pascals already stays what it is.
    ///
    /// A mode that radiation damps so much that it no longer swings becomes silent.
    ///
    /// # Errors
    /// When the model is relative and has no shapes, or their surface has no area.
    pub fn radiating(mut self, material: &Material) -> Result<Self, ModalModelError> {
        if self.unit == Unit::PascalsAtOneMetre {
            return Ok(self);
        }
        let unknown =
            |message: &str| ModalModelError::Malformed { path: "radiation".into(), message: message.into() };
        let Some(mut shapes) = self.shapes.take() else {
            return Err(unknown("the modes have no shapes, so their radiation is unknown"));
        };
        let to = Arc::make_mut(&mut shapes);
        let surface = Surface { points_m: &to.points_m, triangles: &to.triangles };
        let sphere =
            EquivalentSphere::of(&surface).ok_or_else(|| unknown("the surface of the shapes has no area"))?;
        for (m, mode) in self.modes.iter_mut().enumerate() {
            let phi = &to.phi_per_sqrt_kg[m];
            let multipoles = sphere.multipoles(&surface, |point| phi[point].map(f64::from));
            let square = (TAU * mode.frequency_hz).powi(2) + mode.decay_per_s.powi(2);
            // What radiates is near enough at the damped frequency: decays are small against it.
            let decay_per_s = mode.decay_per_s + sphere.loss_per_s(&multipoles, mode.frequency_hz);
            let gain = sphere.pressure_pa_s_m(&multipoles, mode.frequency_hz);
            let swings = decay_per_s * decay_per_s < square;
            let louder = if swings && to.gains[m] != 0.0 { gain / to.gains[m] } else { 0.0 };
            to.gains[m] *= louder;
            mode.amplitude *= louder;
            self.positions.iter_mut().for_each(|amplitudes| amplitudes[m] *= louder);
            if swings {
                mode.frequency_hz = (square - decay_per_s * decay_per_s).sqrt() / TAU;
                mode.decay_per_s = decay_per_s;
            }
        }
        let volume_m3 = sphere.volume_m3();
        let click = Click { volume_m3, mass_kg: volume_m3 * material.density_kg_m3, gain: 1.0 };
        self.click = Some(click).filter(|_| volume_m3 > 0.0);
        (self.shapes, self.unit, self.residual) = (Some(shapes), Unit::PascalsAtOneMetre, None);
        self.check()?;
        Ok(self)
    }
}
