//! Mode shapes: how a body's surface moves in each mode, so that a strike at any place finds what
//! it excites.
//!
//! A strike of impulse J at a point p of the surface, along n̂, sounds as y(t) = J Σ `gains[m]` ·
//! (φ_m(p)·n̂) · e^(−d_m t) · sin(2π f_m t + phase_m), with φ between points of the triangulation
//! by barycentric coordinates. φ is mass-normalised (Φᵀ M Φ = 1, kg^−½).

use serde::{Deserialize, Serialize};

/// Furthest place of a body from its origin, m: single precision, as a `.glb` has it, still says
/// it.
const FARTHEST_M: f64 = 1e6;
/// Most points of a triangulation.
const MOST_POINTS: usize = 1_000_000;

/// Unit of a modes file's amplitudes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Unit {
    /// Right against each other within the file; the scale is free.
    #[default]
    #[serde(rename = "relative")]
    Relative,
    /// Pascals at 1 m.
    #[serde(rename = "pa_1m")]
    PascalsAtOneMetre,
}

/// Shapes on a triangulated surface: the field `shapes` of a modes file of version 2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeShapes {
    /// Points of the surface in the body's frame, m.
    pub points_m: Vec<[f64; 3]>,
    /// Three points each, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// For each mode what its velocity at the struck place becomes in the sound, in the file's
    /// unit.
    pub gains: Vec<f64>,
    /// For each mode the motion of every point, kg^−½.
    pub phi_per_sqrt_kg: Vec<Vec<[f32; 3]>>,
    /// The point that the modes' own amplitudes belong to.
    pub struck_point: usize,
}

impl ModeShapes {
    /// Longest side of the box about the body, m.
    pub(crate) fn size_m(&self) -> f64 {
        let side = |axis: usize| {
            let along = || self.points_m.iter().map(|point| point[axis]);
            along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
        };
        (0..3).map(side).fold(0.0, f64::max)
    }

    /// Body `size` times as large: mass-normalised motion falls as its mass grows, and what it
    /// sounds like stays.
    pub(crate) fn scale(&mut self, size: f64) {
        let heavier = libm::pow(size, 1.5);
        self.points_m.iter_mut().flatten().for_each(|x| *x *= size);
        self.gains.iter_mut().for_each(|gain| *gain *= heavier);
        let motion = self.phi_per_sqrt_kg.iter_mut().flatten().flatten();
        motion.for_each(|x| *x = (f64::from(*x) / heavier) as f32);
    }

    /// The shapes of some of the modes.
    pub(crate) fn kept(&self, keep: &[bool]) -> Self {
        let kept = |m: &usize| keep.get(*m).copied().unwrap_or(false);
        let modes = || (0..self.gains.len()).filter(kept);
        Self {
            points_m: self.points_m.clone(),
            triangles: self.triangles.clone(),
            gains: modes().map(|m| self.gains[m]).collect(),
            phi_per_sqrt_kg: modes().map(|m| self.phi_per_sqrt_kg[m].clone()).collect(),
            struck_point: self.struck_point,
        }
    }

    /// # Errors
    /// What does not fit.
    pub(crate) fn check(&self, modes: usize) -> Result<(), String> {
        let points = self.points_m.len();
        if !(1..=MOST_POINTS).contains(&points) || self.struck_point >= points {
            return Err(format!("shapes: {points} points, struck at {}", self.struck_point));
        }
        if self.triangles.iter().flatten().any(|&i| i as usize >= points) {
            return Err(format!("shapes.triangles: a corner beyond the {points} points"));
        }
        if self.gains.len() != modes || self.phi_per_sqrt_kg.len() != modes {
            let (gains, shapes) = (self.gains.len(), self.phi_per_sqrt_kg.len());
            return Err(format!("shapes: {gains} gains and {shapes} motions for {modes} modes"));
        }
        if let Some(m) = self.phi_per_sqrt_kg.iter().position(|phi| phi.len() != points) {
            return Err(format!(
                "shapes.phi_per_sqrt_kg[{m}]: must have one entry for each of the {points} points"
            ));
        }
        if self.points_m.iter().flatten().any(|x| x.is_finite() && x.abs() > FARTHEST_M) {
            return Err("shapes.points_m: a place is more than 1000 km away; must be in metres".to_owned());
        }
        let finite = self.points_m.iter().flatten().chain(&self.gains).all(|x| x.is_finite())
            && self.phi_per_sqrt_kg.iter().flatten().flatten().all(|x| x.is_finite());
        if finite { Ok(()) } else { Err("shapes: a number is not finite".to_owned()) }
    }
}
