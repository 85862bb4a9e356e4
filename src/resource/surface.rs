//! A surface, prepared for the audio half.

use crate::model::surface::Surface;
use crate::resource::overlay::Overlay;
use crate::resource::stroking::Stroking;
use asperity_dsp::trajectory::TrajectoryDesign;
use asperity_surface::height_field::Properties;

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
    pub(crate) levels: SurfaceLevels,
}

/// Factors that bring strokes on a surface to their level, probe by probe, the engine's own first;
/// empty where nothing is found.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct SurfaceLevels(pub(crate) Vec<(Option<usize>, StrokeLevel)>);

/// Factors of the strokes of one probe.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StrokeLevel {
    pub(crate) heard: f64,
    /// Factor of each haptic channel.
    pub(crate) felt: Box<[f64]>,
    /// Rms of the body at 1 m/s, full scale 1, for a force of each decade from 0.1 N on.
    pub(crate) fast: [f64; 5],
}

impl SurfaceLevels {
    /// Factors of a probe, the place of one that came later counting as the last.
    pub(crate) fn of(&self, probe: Option<usize>) -> Option<&StrokeLevel> {
        let own = self.0.iter().find(|(of, _)| *of == probe);
        own.or(self.0.last()).map(|(_, level)| level)
    }
}

impl StrokeLevel {
    /// Factors of sound, and of what the actuator plays.
    pub(crate) fn factors(&self, actuator: Option<usize>) -> (f64, f64) {
        let felt = actuator.and_then(|channel| self.felt.get(channel).copied());
        (self.heard, felt.unwrap_or(1.0))
    }
}
