//! The four force renderings of Brownian relief: {surface, graph} × {orthogonal, lateral}.
//!
//! ```text
//! orthogonal   F = A · (dy/dt) · 1 ms   out of the surface
//! lateral      F = A · (∂y/∂u, ∂y/∂v)   along it
//! surface      y = y(u, v)              graph   y = y(s), s the distance travelled
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | y | height in grey levels of the document's 8-bit maps, 256 over the relief's range |
//! | A | [`BrownianForce::newton_per_grey`]: 0.005 N for the orthogonal surface, 0.01 N for the others |
//!
//! Source: the texture-analysis thesis §6.4, equations 6.6 and 6.7 and the four experiments. What
//! we changed: the printed Δy is the difference between two ticks of a 1 kHz loop, so that at audio
//! rates the force would shrink by the ratio of the rates; ours is the derivative times that
//! millisecond, the same at any rate. Equation 6.8 replaces the gradient by (Δy, 0, Δy), which
//! fixes the direction at 45°; ours is the gradient of 6.7, per millimetre (the unit is ours: the
//! thesis has none).

use crate::force_output::ForceAt;
pub use crate::force_rendering::Rendering;
use crate::height_field::{
    HeightField, MAX_BLOCK, NO_TOUCH_N, Part, PathBlock, Properties, Setup, SurfaceBlock, WavelengthBand,
};
use asperity_dsp::DesignError;

/// Grey levels over the range of the document's maps.
pub const GREY_LEVELS: f64 = 256.0;
/// Tick of the document's force loop, seconds.
pub const TICK_S: f64 = 1e-3;
/// Unit of length of the lateral rule, metres (ours).
pub const LATERAL_UNIT_M: f64 = 1e-3;

/// A force rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrownianForce {
    /// Which way the force points.
    pub rendering: Rendering,
    /// Proportionality constant A, N.
    pub newton_per_grey: f64,
    /// Grey levels in a metre of height.
    pub grey_per_m: f64,
}

impl BrownianForce {
    /// The document's rule for a surface whose heights span `range_m`.
    ///
    /// # Errors
    /// When the range is not above 0.
    pub fn surface(rendering: Rendering, range_m: f64) -> Result<Self, DesignError> {
        let newton_per_grey = if rendering == Rendering::Orthogonal { 0.005 } else { 0.01 };
        Self::new(rendering, newton_per_grey, range_m)
    }

    /// The document's rule for a graph whose heights span `range_m`.
    ///
    /// # Errors
    /// When the range is not above 0.
    pub fn graph(rendering: Rendering, range_m: f64) -> Result<Self, DesignError> {
        Self::new(rendering, 0.01, range_m)
    }

    fn new(rendering: Rendering, newton_per_grey: f64, range_m: f64) -> Result<Self, DesignError> {
        let range = DesignError::check("range_m", range_m, "above 0, to 1 m", |r| r > 0.0 && r <= 1.0)?;
        Ok(Self { rendering, newton_per_grey, grey_per_m: GREY_LEVELS / range })
    }

    /// Force along u, v and out of the surface, N, from the slope (m/m) and the velocity (m/s).
    #[must_use]
    pub fn force_n(&self, slope: [f64; 2], velocity_m_s: [f64; 2]) -> [f64; 3] {
        let grey = self.newton_per_grey * self.grey_per_m;
        match self.rendering {
            Rendering::Orthogonal => {
                let climb_m_s = slope[0] * velocity_m_s[0] + slope[1] * velocity_m_s[1];
                [0.0, 0.0, grey * climb_m_s * TICK_S]
            }
            Rendering::Lateral => {
                let unit = grey * LATERAL_UNIT_M;
                [unit * slope[0], unit * slope[1], 0.0]
            }
        }
    }
}

impl BrownianForce {
    /// The rule in the place of the relief's own push, in penetration only.
    fn answer(&self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        if !path.slopes {
            return;
        }
        for (i, velocity_m_s) in path.velocity_m_s.iter().enumerate().take(MAX_BLOCK) {
            let gradient = out.gradient[i];
            let presses = path.pressed_n(i) > NO_TOUCH_N;
            let force_n = if presses { self.force_n(gradient, *velocity_m_s) } else { [0.0; 3] };
            out.answer.set(i, ForceAt { force_n, push_per_n: gradient, cap_n: f64::INFINITY });
        }
    }
}

/// A relief (a height map of a Brownian surface) that also answers with one of the forces.
pub struct BrownianSurface {
    relief: [Part; 1],
    force: BrownianForce,
}

impl BrownianSurface {
    /// `relief` with a force rule.
    #[must_use]
    pub fn new(relief: Box<dyn HeightField>, force: BrownianForce) -> Self {
        Self { relief: [relief], force }
    }
}

impl HeightField for BrownianSurface {
    fn properties(&self, tile_m: [f64; 2]) -> Properties {
        Properties { is_rigid: false, ..self.relief[0].properties(tile_m) }
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        self.relief[0].sample(path, out);
        self.force.answer(path, out);
    }

    fn parts(&mut self) -> &mut [Part] {
        &mut self.relief
    }
}

/// Distance that a contact has travelled.
#[derive(Debug, Clone, Copy, Default)]
struct Travelled {
    /// Block asked for last, and the distance at its first sample.
    first_sample: u64,
    begin_m: f64,
    /// Distance at the end of that block.
    end_m: f64,
}

/// A Brownian graph: its height depends on the distance a contact has travelled, not on the place.
///
/// Every contact starts at the graph's origin and keeps its distance from sample to sample; reading
/// the same block twice gives the same heights.
#[derive(Debug, Clone)]
pub struct BrownianPath {
    coefficients: Vec<f64>,
    spacing_m: f64,
    force: Option<BrownianForce>,
    contacts: Vec<Travelled>,
}

impl BrownianPath {
    /// A periodic graph of heights (m) `spacing_m` apart; it answers with a force if one is given.
    ///
    /// # Errors
    /// When there are fewer than 4 heights, one is not finite or the spacing is not above 0.
    pub fn new(heights_m: &[f64], spacing_m: f64, rendering: Option<Rendering>) -> Result<Self, DesignError> {
        DesignError::check("heights_m", heights_m.len() as f64, "4 or more", |n| n >= 4.0)?;
        for &h in heights_m {
            DesignError::check("heights_m", h, "finite", |_| true)?;
        }
        let spacing = DesignError::check("spacing_m", spacing_m, "above 0, to 1 m", |s| s > 0.0 && s <= 1.0)?;
        let highest = heights_m.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lowest = heights_m.iter().copied().fold(f64::INFINITY, f64::min);
        let span = (highest - lowest).max(f64::MIN_POSITIVE);
        let mut coefficients = heights_m.to_vec();
        crate::lattice::prefilter(&mut coefficients);
        Ok(Self {
            coefficients,
            spacing_m: spacing,
            force: rendering.map(|rendering| BrownianForce::graph(rendering, span)).transpose()?,
            contacts: vec![Travelled::default(); Setup::default().voices],
        })
    }

    /// Height and slope after a distance, metres.
    #[must_use]
    pub fn at(&self, distance_m: f64) -> (f64, f64) {
        let n = self.coefficients.len();
        let turns = distance_m / (self.spacing_m * n as f64);
        let (indices, weights, slopes) = crate::lattice::taps(turns - turns.floor(), n);
        let (mut height, mut slope) = (0.0, 0.0);
        for k in 0..4 {
            height += weights[k] * self.coefficients[indices[k]];
            slope += slopes[k] * self.coefficients[indices[k]];
        }
        (height, slope / self.spacing_m)
    }

    /// The slope of the graph laid along the direction of motion.
    fn slope_along(slope: f64, velocity: [f64; 2]) -> [f64; 2] {
        let speed = libm::hypot(velocity[0], velocity[1]);
        if speed > 0.0 { velocity.map(|v| slope * v / speed) } else { [0.0; 2] }
    }

    fn slot(&self, contact: usize) -> usize {
        contact.min(self.contacts.len() - 1)
    }
}

impl HeightField for BrownianPath {
    fn properties(&self, _tile_m: [f64; 2]) -> Properties {
        let longest_m = self.spacing_m * self.coefficients.len() as f64;
        let reach_m = self.coefficients.iter().fold(0.0, |reach: f64, c| reach.max(c.abs()));
        let band = WavelengthBand { shortest_m: 2.0 * self.spacing_m, longest_m };
        Properties { reach_m, ..Properties::of(band) }
    }

    fn prepare(&mut self, setup: &Setup<'_>) -> Result<(), DesignError> {
        self.contacts = vec![Travelled::default(); setup.voices.max(1)];
        Ok(())
    }

    fn sample(&mut self, path: &PathBlock<'_>, out: &mut SurfaceBlock) {
        let n = path.len().min(MAX_BLOCK);
        out.clear(n);
        let slot = self.slot(path.contact);
        let travelled = self.contacts[slot];
        let again = travelled.first_sample == path.first_sample;
        let begin_m = if again { travelled.begin_m } else { travelled.end_m };
        let mut distance = begin_m;
        for i in 0..n {
            distance += path.footprint_m[i];
            let (height, slope) = self.at(distance);
            out.height_m[i] = height;
            out.gradient[i] = Self::slope_along(slope, path.velocity_m_s[i]);
        }
        self.contacts[slot] = Travelled { first_sample: path.first_sample, begin_m, end_m: distance };
        if let Some(force) = &self.force {
            force.answer(path, out);
        }
    }
}

crate::opaque::debug_by_name!(BrownianSurface);
