//! Texture coordinates of a contact in space: a triangle of a mesh with texture
//! coordinates.
//!
//! Physics engines report a point and a velocity in space; [`ContactSample`] wants texture
//! coordinates and a velocity along the surface's u and v axes. Within a triangle both are linear:
//!
//! ```text
//! uv(P) = uv₀ + w₁ (uv₁ − uv₀) + w₂ (uv₂ − uv₀)      w: barycentric coordinates of P's projection
//! v_u = v · û,  v_v = v · v̂                          û ∥ ∂P/∂u,  v̂ ∥ ∂P/∂v
//! ```
//!
//! Vectors of any mathematics library come in through [`mint`]: glam's, nalgebra's, cgmath's, and
//! plain arrays, in `f32` or `f64`. Inside they are glam's, in `f64`.

use crate::model::event::ContactSample;
use glam::{DVec2, DVec3};
use mint::{Vector2, Vector3};

/// Squared sine of an angle between edges below which a triangle is a line: what rounding leaves of
/// one.
const FLAT: f64 = 1e-24;

/// A triangle in metres, in the space in which the physics engine reports its contacts, with a
/// texture coordinate at each corner.
///
/// ```
/// use asperity::UvTriangle;
///
/// let corners_m = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]];
/// let triangle = UvTriangle::new(corners_m, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).unwrap();
/// let sample = triangle.sample([0.05, 0.0, 0.1], [0.0, 0.0, 0.3], 0.6);
/// assert_eq!((sample.uv, sample.velocity_m_s), ([0.25, 0.5], Some([0.0, 0.3])));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTriangle {
    corner_m: DVec3,
    edges_m: [DVec3; 2],
    uv: DVec2,
    uv_edges: [DVec2; 2],
    axes: [DVec3; 2],
}

impl UvTriangle {
    /// The triangle of three corners and their texture coordinates; `None` where the triangle or
    /// its image in the texture has no area, or a number is not finite.
    #[must_use]
    pub fn new<T: Into<f64>, S: Into<f64>>(
        corners_m: [impl Into<Vector3<T>>; 3],
        uv: [impl Into<Vector2<S>>; 3],
    ) -> Option<Self> {
        let [a, b, c] = corners_m.map(in_space);
        let [uv_a, uv_b, uv_c] = uv.map(in_texture);
        let (edges_m, uv_edges) = ([b - a, c - a], [uv_b - uv_a, uv_c - uv_a]);
        let area_uv = uv_edges[0].perp_dot(uv_edges[1]);
        // ∂P/∂u and ∂P/∂v: the edges through the inverse of the texture's.
        let along_u = (edges_m[0] * uv_edges[1].y - edges_m[1] * uv_edges[0].y) / area_uv;
        let along_v = (edges_m[1] * uv_edges[0].x - edges_m[0] * uv_edges[1].x) / area_uv;
        let axes = [along_u.try_normalize()?, along_v.try_normalize()?];
        let [p, q] = edges_m;
        let has_area = p.cross(q).length_squared() > FLAT * p.length_squared() * q.length_squared();
        (has_area && uv_a.is_finite()).then_some(Self { corner_m: a, edges_m, uv: uv_a, uv_edges, axes })
    }

    /// Texture coordinates of a point, of its projection where it lies off the triangle's plane;
    /// they run on beyond the edges.
    #[must_use]
    pub fn uv_at<T: Into<f64>>(&self, point_m: impl Into<Vector3<T>>) -> [f64; 2] {
        let from_corner = in_space(point_m) - self.corner_m;
        let [p, q] = self.edges_m;
        let (pp, pq, qq) = (p.dot(p), p.dot(q), q.dot(q));
        let (along_p, along_q) = (from_corner.dot(p), from_corner.dot(q));
        let [w1, w2] =
            [qq * along_p - pq * along_q, pp * along_q - pq * along_p].map(|w| w / (pp * qq - pq * pq));
        (self.uv + w1 * self.uv_edges[0] + w2 * self.uv_edges[1]).to_array()
    }

    /// Direction across the triangle, of length 1; either of the two.
    pub(crate) fn normal(&self) -> DVec3 {
        let [p, q] = self.edges_m;
        p.cross(q).normalize_or_zero()
    }

    /// Lengths of ∂P/∂u and ∂P/∂v: what uv 1 spans, m.
    pub(crate) fn spans_m(&self) -> [f64; 2] {
        let ([p, q], [s, t]) = (self.edges_m, self.uv_edges);
        let area_uv = s.perp_dot(t);
        [(p * t.y - q * s.y) / area_uv, (q * s.x - p * t.x) / area_uv].map(DVec3::length)
    }

    /// A velocity, m/s, along the unit vectors of growing u and v.
    #[must_use]
    pub fn along<T: Into<f64>>(&self, velocity_m_s: impl Into<Vector3<T>>) -> [f64; 2] {
        let velocity_m_s = in_space(velocity_m_s);
        self.axes.map(|axis| axis.dot(velocity_m_s))
    }

    /// Report of a contact at a point that slides with a velocity, pressed with a force; its
    /// closing speed is 0.
    #[must_use]
    pub fn sample<T: Into<f64>, S: Into<f64>>(
        &self,
        point_m: impl Into<Vector3<T>>,
        velocity_m_s: impl Into<Vector3<S>>,
        normal_force_n: f64,
    ) -> ContactSample {
        ContactSample {
            uv: self.uv_at(point_m),
            velocity_m_s: Some(self.along(velocity_m_s)),
            normal_force_n,
            closing_m_s: 0.0,
            ..ContactSample::default()
        }
    }
}

fn in_space<T: Into<f64>>(vector: impl Into<Vector3<T>>) -> DVec3 {
    let Vector3 { x, y, z } = vector.into();
    DVec3::new(x.into(), y.into(), z.into())
}

fn in_texture<T: Into<f64>>(vector: impl Into<Vector2<T>>) -> DVec2 {
    let Vector2 { x, y } = vector.into();
    DVec2::new(x.into(), y.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    /// A slanted map P(uv) of which the triangle is a part: u and v are skewed and of different
    /// lengths.
    const AXES_M: [[f64; 3]; 2] = [[0.3, 0.1, 0.0], [0.1, -0.05, 0.4]];

    fn place(uv: [f64; 2]) -> [f64; 3] {
        [0, 1, 2].map(|a| 0.7 + uv[0] * AXES_M[0][a] + uv[1] * AXES_M[1][a])
    }

    #[test]
    fn a_mesh_point_finds_its_texture_coordinates_and_axes() {
        let corners = [[0.1, 0.2], [0.9, 0.3], [0.4, 0.8]];
        let triangle = UvTriangle::new(corners.map(place), corners).unwrap();
        for uv in [[0.1, 0.2], [0.5, 0.4], [2.0, -3.0]] {
            let found = triangle.uv_at(place(uv));
            assert!((found[0] - uv[0]).abs() < 1e-12 && (found[1] - uv[1]).abs() < 1e-12, "{found:?}");
        }
        // A finger that goes along ∂P/∂u at 0.2 m/s.
        let length = AXES_M[0].iter().map(|x| x * x).sum::<f64>().sqrt();
        let [u, v] = triangle.along(AXES_M[0].map(|x| 0.2 * x / length));
        let skew = AXES_M[0].iter().zip(AXES_M[1]).map(|(a, b)| a * b).sum::<f64>();
        let other = AXES_M[1].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((u - 0.2).abs() < 1e-12 && (v - 0.2 * skew / (length * other)).abs() < 1e-12, "{u} {v}");
    }

    #[test]
    fn vectors_of_a_games_own_library_are_taken_as_they_are() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let glams = corners.map(|uv| Vec3::from_array(place(uv).map(|x| x as f32)));
        let triangle =
            UvTriangle::new(glams, corners.map(|uv| Vec2::from_array(uv.map(|x| x as f32)))).unwrap();
        let sample =
            triangle.sample(Vec3::from_array(place([0.25, 0.5]).map(|x| x as f32)), [0.0, 0.0, 0.1], 0.6);
        assert!((sample.uv[0] - 0.25).abs() < 1e-6 && (sample.uv[1] - 0.5).abs() < 1e-6);
        assert_eq!(sample.checked().map(|sample| sample.normal_force_n), Ok(0.6));
    }

    #[test]
    fn a_triangle_without_area_is_none() {
        let line = [[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]];
        assert!(UvTriangle::new(line.map(place), line).is_none());
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        assert!(UvTriangle::new(line.map(place), corners).is_none());
        assert!(UvTriangle::new([[f64::NAN; 3]; 3], corners).is_none());
    }
}
