//! Strike position as a field: what a strike at any place of a body excites.
//!
//! ```text
//! amplitude of mode m for 1 N·s = g_m · (φ_m(p) · n̂)          φ_m(p) = Σ_i w_i φ_m(corner i)
//! ```
//! p is the point of the triangulation nearest to where the strike was reported, w its barycentric
//! coordinates, n̂ the direction of the strike, or the inward normal. Finding p is work for the
//! game half; what crosses to the audio half is a [`StrikePlace`] of six numbers.

use crate::model::closest_point::TriangleTree;
use crate::model::mode_shapes::ModeShapes;
use std::sync::Arc;

/// Place and direction of a strike on a body that has shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrikePlace {
    /// Three points of the shapes.
    pub corners: [u32; 3],
    /// Their shares; they sum to 1.
    pub weights: [f32; 3],
    /// A unit vector, in the body's frame.
    pub direction: [f32; 3],
}

impl StrikePlace {
    /// Nowhere: nothing moves.
    pub(crate) const NOWHERE: Self = Self { corners: [0; 3], weights: [0.0; 3], direction: [0.0; 3] };

    /// A mode's motion here, along the direction, in the unit of `phi`.
    #[must_use]
    pub fn motion(&self, phi: &[[f32; 3]]) -> f32 {
        let mut sum = 0.0;
        for (corner, weight) in self.corners.iter().zip(self.weights) {
            let at = phi.get(*corner as usize).copied().unwrap_or_default();
            sum +=
                weight * (at[0] * self.direction[0] + at[1] * self.direction[1] + at[2] * self.direction[2]);
        }
        sum
    }
}

/// Shapes of a body, ready to be asked for any place.
///
/// ```
/// use asperity::{ModeShapes, StrikeField};
///
/// // A triangle that swings about its first edge.
/// let shapes = ModeShapes {
///     points_m: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     triangles: vec![[0, 1, 2]],
///     gains: vec![2.0],
///     phi_per_sqrt_kg: vec![vec![[0.0; 3], [0.0; 3], [0.0, 0.0, 3.0]]],
///     struck_point: 2,
/// };
/// let field = StrikeField::new(shapes);
/// // From above, half way up; the inward normal points down.
/// let place = field.place([0.2, 0.5, 0.1], None).unwrap();
/// assert!((field.amplitudes(&place)[0] + 3.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StrikeField {
    shapes: Arc<ModeShapes>,
    tree: TriangleTree,
}

impl StrikeField {
    /// Sorts the triangles of some shapes.
    #[must_use]
    pub fn new(shapes: impl Into<Arc<ModeShapes>>) -> Self {
        let shapes = shapes.into();
        let tree = TriangleTree::new(&shapes.points_m, &shapes.triangles);
        Self { shapes, tree }
    }

    /// The shapes.
    #[must_use]
    pub fn shapes(&self) -> &Arc<ModeShapes> {
        &self.shapes
    }

    /// The place of the body nearest to `at_m` (its frame, m), struck along `direction`, whose
    /// length does not count; without one, or along one of no length, along the inward normal. None
    /// for a body without triangles, or where a number is not finite.
    #[must_use]
    pub fn place(&self, at_m: [f64; 3], direction: Option<[f64; 3]>) -> Option<StrikePlace> {
        if !at_m.iter().chain(direction.iter().flatten()).all(|x| x.is_finite()) {
            return None;
        }
        let found = self.tree.nearest(at_m)?;
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let inward = self.tree.normal(found.triangle).map(|x| -x);
        let direction = direction.map(|v| v.map(|x| x / length(v))).filter(|v| length(*v).is_finite());
        Some(StrikePlace {
            corners: self.shapes.triangles[found.triangle],
            weights: found.weights.map(|x| x as f32),
            direction: direction.unwrap_or(inward).map(|x| x as f32),
        })
    }

    /// The point of the surface where a place lies, m.
    #[must_use]
    pub fn point_m(&self, place: &StrikePlace) -> [f64; 3] {
        let corner = |i: usize| self.shapes.points_m[place.corners[i] as usize];
        std::array::from_fn(|axis| (0..3).map(|i| f64::from(place.weights[i]) * corner(i)[axis]).sum())
    }

    /// Place that the modes' own amplitudes belong to, m.
    pub(crate) fn struck_point_m(&self) -> [f64; 3] {
        self.shapes.points_m[self.shapes.struck_point]
    }

    /// Longest side of the box about the body, m.
    #[must_use]
    pub fn size_m(&self) -> f64 {
        self.shapes.size_m()
    }

    /// Amplitude of every mode for 1 N·s there, in the unit of the file.
    #[must_use]
    pub fn amplitudes(&self, place: &StrikePlace) -> Vec<f64> {
        let modes = self.shapes.gains.iter().zip(&self.shapes.phi_per_sqrt_kg);
        modes.map(|(gain, phi)| gain * f64::from(place.motion(phi))).collect()
    }
}
