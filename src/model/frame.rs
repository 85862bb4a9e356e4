//! Surface frame: where a surface lies in its body.
//!
//! ```text
//! P = origin + u · width · û + v · height · v̂            u = (P − origin) · û / width,  v = (P − origin) · v̂ / height
//! ```
//!
//! The one mapping between texture coordinates and the body's space, metres in the body's own
//! frame: solids are cut from one block by it, and places on a body are stated as texture
//! coordinates of its surfaces and back. Vectors are any library's, through [`mint`].

use crate::model::bad_value::{BadValue, within};
use asperity_dsp::limits;
use glam::DVec3;
use mint::Vector3;

/// Largest deviation of the axes from a right angle, as the cosine between them: what single
/// precision leaves of one.
const SQUARE: f64 = 1e-4;

/// A plane in a body: an origin and two axes at a right angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceFrame {
    origin_m: DVec3,
    axes: [DVec3; 2],
}

impl SurfaceFrame {
    /// A surface whose uv (0, 0) lies at `origin_m` of its body and whose u and v grow along the
    /// axes, which need not be of length 1.
    ///
    /// # Errors
    /// When a number is not finite, the origin lies beyond 1 km, an axis has no length, or the axes
    /// do not stand at a right angle.
    pub fn new<T: Into<f64>>(
        origin_m: impl Into<Vector3<T>>,
        u_axis: impl Into<Vector3<T>>,
        v_axis: impl Into<Vector3<T>>,
    ) -> Result<Self, BadValue> {
        let [origin_m, u, v] = [space(origin_m), space(u_axis), space(v_axis)];
        for x in origin_m.to_array() {
            within("origin_m", x, limits::PLACE_M)?;
        }
        let unit = |field: &'static str, axis: DVec3| {
            let length = within(field, axis.length(), limits::AXIS)?;
            Ok(axis / length)
        };
        let (u, v) = (unit("u_axis", u)?, unit("v_axis", v)?);
        let right_angle =
            limits::Range::new(-SQUARE, SQUARE, "at a right angle to u_axis: the cosine between them 0");
        within("v_axis", u.dot(v), right_angle)?;
        // Exactly square from here on: what is continuous over an edge is so to rounding.
        Ok(Self { origin_m, axes: [u, (v - u * u.dot(v)).normalize()] })
    }

    /// The point of the body at texture coordinates of a surface of `size_m`, m.
    #[must_use]
    pub fn point_m(&self, uv: [f64; 2], size_m: [f64; 2]) -> [f64; 3] {
        let [u, v] = self.axes;
        (self.origin_m + u * (uv[0] * size_m[0]) + v * (uv[1] * size_m[1])).to_array()
    }

    /// Texture coordinates of a point of the body, of its projection where it lies off the plane.
    #[must_use]
    pub fn uv<T: Into<f64>>(&self, point_m: impl Into<Vector3<T>>, size_m: [f64; 2]) -> [f64; 2] {
        let from_origin = space(point_m) - self.origin_m;
        [0, 1].map(|axis| from_origin.dot(self.axes[axis]) / size_m[axis])
    }

    /// Depth of a point of the body below the plane, m, against the direction u × v, which points
    /// out of the body.
    #[must_use]
    pub fn depth_m<T: Into<f64>>(&self, point_m: impl Into<Vector3<T>>) -> f64 {
        let [u, v] = self.axes;
        (self.origin_m - space(point_m)).dot(u.cross(v))
    }

    /// Components of a velocity of the body's space along u and v, m/s.
    #[must_use]
    pub fn along<T: Into<f64>>(&self, velocity_m_s: impl Into<Vector3<T>>) -> [f64; 2] {
        let velocity = space(velocity_m_s);
        self.axes.map(|axis| velocity.dot(axis))
    }

    /// The direction into the body: against u × v.
    pub(crate) fn inward(&self) -> [f64; 3] {
        let [u, v] = self.axes;
        (-u.cross(v)).to_array()
    }

    /// Place of uv (0, 0), m.
    #[must_use]
    pub fn origin_m(&self) -> [f64; 3] {
        self.origin_m.to_array()
    }

    /// Directions of u and v: unit vectors at a right angle.
    #[must_use]
    pub fn axes(&self) -> [[f64; 3]; 2] {
        self.axes.map(|axis| axis.to_array())
    }
}

fn space<T: Into<f64>>(vector: impl Into<Vector3<T>>) -> DVec3 {
    let Vector3 { x, y, z } = vector.into();
    DVec3::new(x.into(), y.into(), z.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn a_point_told_as_texture_coordinates_is_the_same_point_again() {
        let mut rng = Rng::new(3);
        for _ in 0..1000 {
            let mut number = || 2.0 * rng.uniform() - 1.0;
            let u = DVec3::new(number(), number(), number());
            let v = u.cross(DVec3::new(number(), number(), number()));
            let frame =
                SurfaceFrame::new([number(), number(), number()], u.to_array(), v.to_array()).unwrap();
            let (uv, size_m) = ([10.0 * number(), number()], [0.3, 0.07]);
            let point_m = frame.point_m(uv, size_m);
            let again = frame.uv(point_m, size_m);
            assert!((0..2).all(|axis| (again[axis] - uv[axis]).abs() < 1e-12), "{uv:?} {again:?}");
            let [along_u, along_v] = frame.axes();
            let velocity: [f64; 3] = std::array::from_fn(|i| 0.3 * along_u[i] - 2.0 * along_v[i]);
            let found = frame.along(velocity);
            assert!((found[0] - 0.3).abs() < 1e-12 && (found[1] + 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn what_is_no_plane_is_refused_by_name() {
        let frame = |o: [f64; 3], u: [f64; 3], v: [f64; 3]| SurfaceFrame::new(o, u, v);
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert!(frame([0.0; 3], x, y).is_ok());
        for (bad, field) in [
            (frame([f64::NAN, 0.0, 0.0], x, y), "origin_m"),
            (frame([2e3, 0.0, 0.0], x, y), "origin_m"),
            (frame([0.0; 3], [0.0; 3], y), "u_axis"),
            (frame([0.0; 3], x, [f64::INFINITY, 0.0, 0.0]), "v_axis"),
            (frame([0.0; 3], x, [0.1, 1.0, 0.0]), "v_axis"),
            (frame([0.0; 3], x, x), "v_axis"),
        ] {
            assert_eq!(bad.unwrap_err().field, field);
        }
    }
}
