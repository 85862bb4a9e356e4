//! Grating: a relief that repeats, by its period.
//!
//! ```text
//! sine    h = A sin(2π u/p)
//! ridges  h = A (2 s − 1)     s = ½ − ½ cos(π t),  t = (½ d − |u/p|)/w + ½ held to 0–1
//! dots    h = A (2 c − 1)     c = cos²(π r/d) within r = ½ d, else 0,  r² = (u/p)² + (v/p)²
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | p, A, d | [`GratingParameters::pitch_m`], `amplitude_m` (tops at A, ground at −A), `duty` |
//! | u/p, v/p | within half a period of the middle of a ridge or dot |
//! | w | flank over the period: a fifth of the narrower of ridge and groove, and no less than two readings |
//!
//! Lines run along v; dots sit on squares. Source: regular textures as sums of sines are those of
//! the solid-noise paper (put several into a [sum](crate::combine::Sum)); gratings and dots by
//! pitch and duty are the stimuli of studies of roughness. The flank is ours: a wall that stands
//! upright is a step between two samples. Towards two readings a period the relief fades to its
//! mean.

use crate::fade::Fade;
use crate::height_field::{
    Extension, HeightField, MAX_BLOCK, PathBlock, Properties, Setup, SurfaceBlock, WavelengthBand,
};
use asperity_dsp::DesignError;
use asperity_dsp::limits::Range;
use core::f64::consts::{PI, TAU};
use std::any::Any;

/// Range of the period.
pub const PITCH_M: Range = Range::new(1e-5, 1.0, "1e-5 to 1 m");
/// Range of the share of the period that a ridge or dot takes.
pub const DUTY: Range = Range::new(0.05, 0.95, "0.05 to 0.95");
/// Flank over the narrower of ridge and groove.
const FLANK: f64 = 0.2;
/// Readings a period from which on the relief fades, inverted, and at which it is gone.
const FADES: [f64; 2] = [0.35, 0.5];
/// Coulomb friction: that of the solids.
const FRICTION: f64 = crate::solid_materials::FRICTION;

/// Shape of a grating.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GratingKind {
    /// A sine along u.
    Sine,
    /// Flat ridges across u.
    Ridges,
    /// Round dots.
    Dots,
}

/// Everything about a grating; may change while it is touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GratingParameters {
    /// Shape.
    pub kind: GratingKind,
    /// Period, m.
    pub pitch_m: f64,
    /// Height of the tops over the middle, m.
    pub amplitude_m: f64,
    /// Share of the period that a ridge or a dot takes; a sine has none.
    pub duty: f64,
}

impl Default for GratingParameters {
    /// A sine of 2 mm and ±50 µm (ours).
    fn default() -> Self {
        Self { kind: GratingKind::Sine, pitch_m: 2e-3, amplitude_m: 5e-5, duty: 0.5 }
    }
}

impl GratingParameters {
    /// Refuses what cannot be rendered.
    ///
    /// # Errors
    /// Names the first field that is out of its range.
    pub fn check(&self) -> Result<(), DesignError> {
        PITCH_M.check("pitch_m", self.pitch_m)?;
        asperity_dsp::limits::solid::AMPLITUDE_M.check("amplitude_m", self.amplitude_m)?;
        DUTY.check("duty", self.duty)?;
        Ok(())
    }

    /// Flank over the period.
    #[must_use]
    pub fn flank(&self) -> f64 {
        FLANK * self.duty.min(1.0 - self.duty)
    }

    /// Mean height, m.
    fn mean_m(&self) -> f64 {
        let level = match self.kind {
            GratingKind::Sine => 0.5,
            GratingKind::Ridges => self.duty,
            // ∫ cos² over the disc.
            GratingKind::Dots => (0.5 * self.duty).powi(2) * (0.5 * PI - 2.0 / PI),
        };
        self.amplitude_m * (2.0 * level - 1.0)
    }

    /// Height and slope along u and v where readings are so far apart, m.
    #[must_use]
    pub fn at(&self, [u_m, v_m]: [f64; 2], footprint_m: f64) -> (f64, [f64; 2]) {
        let period = |x_m: f64| x_m / self.pitch_m - (x_m / self.pitch_m).round();
        let (x, y, apart) = (period(u_m), period(v_m), footprint_m / self.pitch_m);
        let (level, slope) = match self.kind {
            GratingKind::Sine => (0.5 + 0.5 * libm::sin(TAU * x), [PI * libm::cos(TAU * x), 0.0]),
            GratingKind::Ridges => {
                let width = self.flank().max(2.0 * apart).min(self.duty.min(1.0 - self.duty));
                let t = ((0.5 * self.duty - x.abs()) / width + 0.5).clamp(0.0, 1.0);
                let fall = -0.5 * PI / width * libm::sin(PI * t) * 1f64.copysign(x);
                (0.5 - 0.5 * libm::cos(PI * t), [fall, 0.0])
            }
            GratingKind::Dots => {
                let r = libm::hypot(x, y);
                let turn = PI * (r / self.duty).min(0.5);
                let fall = if r > 0.0 { -PI / self.duty * libm::sin(2.0 * turn) / r } else { 0.0 };
                (libm::cos(turn).powi(2), [fall * x, fall * y])
            }
        };
        let left = ((FADES[1] - apart) / (FADES[1] - FADES[0])).clamp(0.0, 1.0);
        let (scale, mean_m) = (left * left * (3.0 - 2.0 * left), self.mean_m());
        let height_m = mean_m + scale * (self.amplitude_m * (2.0 * level - 1.0) - mean_m);
        (height_m, slope.map(|slope| 2.0 * scale * self.amplitude_m * slope / self.pitch_m))
    }
}

/// A grating as a surface.
#[derive(Debug, Clone)]
pub struct Grating {
    parameters: Fade<GratingParameters>,
}

impl Grating {
    /// A grating.
    ///
    /// ```
    /// use asperity_surface::grating::{Grating, GratingKind, GratingParameters};
    ///
    /// let ridges = GratingParameters { kind: GratingKind::Ridges, pitch_m: 1e-3, amplitude_m: 2e-5, duty: 0.25 };
    /// assert!((ridges.at([3e-3, 0.0], 0.0).0 - 2e-5).abs() < 1e-12, "a ridge stands at every millimetre");
    /// let grating = Grating::new(ridges)?;
    /// # Ok::<(), asperity_dsp::DesignError>(())
    /// ```
    ///
    /// # Errors
    /// When a parameter is out of its range.
    pub fn new(parameters: GratingParameters) -> Result<Self, DesignError> {
        parameters.check()?;
        Ok(Self { parameters: Fade::new(parameters) })
    }
}

impl HeightField for Grating {
    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.parameters.prepare(setup.sample_rate_hz);
        Ok(())
    }

    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        let target = self.parameters.target();
        let sides = if target.kind == GratingKind::Dots { &tile_m[..] } else { &tile_m[..1] };
        let is_whole = |side: &f64| {
            let periods = side / target.pitch_m;
            (periods - periods.round()).abs() < 1e-9 * (1.0 + periods)
        };
        let repeats = sides.iter().all(is_whole);
        let shortest = match target.kind {
            GratingKind::Sine => 1.0,
            GratingKind::Ridges => 2.0 * target.flank(),
            GratingKind::Dots => target.duty,
        };
        let band = WavelengthBand { shortest_m: shortest * target.pitch_m, longest_m: target.pitch_m };
        Properties {
            reach_m: target.amplitude_m.abs(),
            extension: if repeats { Extension::Same } else { Extension::Fresh },
            ..Properties::of(band)
        }
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        out.clear(n);
        out.friction[..n].fill(FRICTION);
        for i in 0..n {
            let weights = self.parameters.weights(path.first_sample + i as u64);
            for (weight, parameters) in weights.iter().zip(self.parameters.values()) {
                if *weight != 0.0 {
                    let (height_m, slope) = parameters.at(path.position_m[i], path.footprint_m[i]);
                    out.height_m[i] += weight * height_m;
                    out.gradient[i][0] += weight * slope[0];
                    out.gradient[i][1] += weight * slope[1];
                }
            }
        }
    }

    /// Takes [`GratingParameters`].
    fn set(&mut self, change: &dyn Any, sample: u64) -> bool {
        let Some(parameters) = change.downcast_ref::<GratingParameters>() else { return false };
        let accepted = parameters.check().is_ok();
        if accepted {
            self.parameters.set(*parameters, sample);
        }
        accepted
    }
}
