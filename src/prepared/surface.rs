//! A surface, prepared for the audio half.

use crate::model::surface::Surface;
use crate::prepared::overlay::Overlay;
use crate::prepared::stroking::Stroking;
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_texture::height_field::Properties;

/// A surface as the audio half owns it: everything a contact needs, designed beforehand.
pub(crate) struct SurfaceSlot {
    pub(crate) surface: Surface,
    /// Properties of its source.
    pub(crate) properties: Properties,
    pub(crate) trajectory: TrajectoryDesign,
    /// Through its body, where nothing wraps.
    pub(crate) place_trajectory: TrajectoryDesign,
    /// Excitation of the body below by strokes.
    pub(crate) stroking: Stroking,
    /// Layout of the micro-noise on it.
    pub(crate) overlay: Overlay,
    /// After how many metres it is the same again, ∞ for never.
    pub(crate) period_m: [f64; 2],
}
