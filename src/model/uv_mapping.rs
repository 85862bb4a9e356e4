//! Texture coordinates of what has none of its own: by the place on the body and the direction in
//! which its surface faces there.
//!
//! ```text
//! plane       one plane; where the surface stands across it (more than 60°), as by the normal
//! by normal   the two axes across the one that the normal is nearest to: the faces of a box, a hull, a wall (`surface::triplanar`)
//! sphere      u = R φ / span_u,  v = R θ / span_v        φ: angle about y,  θ: from the pole
//! cylinder    u = R φ / span_u,  v = −y / span_v; its ends as by the normal
//! ```
//! All in the body's own space, y along the axis. `span_m` is what uv 1 spans: the surface's width
//! and height.

use crate::model::uv_triangle::UvTriangle;
use glam::DVec3;

/// |cos| of the angle between a surface and a plane below which the plane says nothing about it.
const ACROSS: f64 = 0.5;

/// From a place on a body, in its own space, to texture coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum UvMapping {
    /// A plane; what stands across it is mapped by the normal.
    Plane(UvTriangle),
    /// By the direction in which the surface faces: boxes, hulls, whatever has flat sides.
    ByNormal {
        /// Metres that uv 1 spans.
        span_m: [f64; 2],
    },
    /// A sphere about the origin.
    Sphere {
        /// Its radius, m.
        radius_m: f64,
        /// Metres that uv 1 spans; without a seam where they go a whole number of times into the
        /// circumference.
        span_m: [f64; 2],
    },
    /// A cylinder, or a capsule, about the y axis.
    Cylinder {
        /// Its radius, m.
        radius_m: f64,
        /// As of a sphere.
        span_m: [f64; 2],
    },
}

/// Texture coordinates about a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UvPlace {
    /// A triangle, exact or tangent to what is round.
    Triangle(UvTriangle),
    /// By the normal: a [`TriplanarPath`](crate::surface::triplanar::TriplanarPath) of this span
    /// keeps its plane from report to report.
    ByNormal {
        /// Metres that uv 1 spans.
        span_m: [f64; 2],
    },
}

impl UvMapping {
    /// Texture coordinates about a place whose surface faces along `outward`, both in the body's
    /// own space; none where a span or a radius is no length.
    #[must_use]
    pub fn at(&self, place_m: [f64; 3], outward: [f64; 3]) -> Option<UvPlace> {
        let (place, outward) = (DVec3::from_array(place_m), DVec3::from_array(outward).normalize_or_zero());
        match *self {
            Self::Plane(triangle) => {
                let across = outward != DVec3::ZERO && outward.dot(triangle.normal()).abs() < ACROSS;
                let spans = UvPlace::ByNormal { span_m: triangle.spans_m() };
                Some(if across { spans } else { UvPlace::Triangle(triangle) })
            }
            Self::ByNormal { span_m } => by_normal(span_m),
            Self::Sphere { radius_m, span_m } => {
                let theta = libm::acos((place.y / place.length()).clamp(-1.0, 1.0));
                let wide = libm::sin(theta).max(1e-3);
                let meridian = |east: DVec3| east.cross(place).normalize_or_zero();
                tangent(place, (radius_m, span_m), [1.0 / wide, radius_m * theta / span_m[1]], meridian)
            }
            Self::Cylinder { span_m, .. } if outward.y.abs() > 0.5 => by_normal(span_m),
            Self::Cylinder { radius_m, span_m } => {
                tangent(place, (radius_m, span_m), [1.0, -place.y / span_m[1]], |_| DVec3::NEG_Y)
            }
        }
    }
}

fn by_normal(span_m: [f64; 2]) -> Option<UvPlace> {
    span_m.iter().all(|span| *span > 0.0 && span.is_finite()).then_some(UvPlace::ByNormal { span_m })
}

/// The triangle that touches a round body at a place: u about its axis, stretched by `widened`, v
/// along what `down` makes of that.
fn tangent(
    place: DVec3,
    (radius_m, span_m): (f64, [f64; 2]),
    [widened, v]: [f64; 2],
    down: impl Fn(DVec3) -> DVec3,
) -> Option<UvPlace> {
    let about = libm::atan2(place.x, place.z);
    let east = DVec3::new(libm::cos(about), 0.0, -libm::sin(about));
    let u = radius_m * about / span_m[0];
    let corners = [place, place + east, place + down(east)].map(|corner| corner.to_array());
    UvTriangle::new(corners, [[u, v], [u + widened / span_m[0], v], [u, v + 1.0 / span_m[1]]])
        .map(UvPlace::Triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Movement of uv for a step of `step_m` from a place, and what is reported of a velocity along
    /// it.
    fn step(mapping: UvMapping, place: DVec3, outward: DVec3, step_m: DVec3) -> ([f64; 2], [f64; 2]) {
        let at = |place: DVec3| match mapping.at(place.to_array(), outward.to_array()) {
            Some(UvPlace::Triangle(triangle)) => triangle.sample(place.to_array(), step_m.to_array(), 1.0),
            other => panic!("{other:?}"),
        };
        let (before, after) = (at(place), at(place + step_m));
        ([0, 1].map(|k| after.uv[k] - before.uv[k]), before.velocity_m_s.unwrap())
    }

    #[test]
    fn barrel_distances_are_those_of_the_map() {
        let barrel = UvMapping::Cylinder { radius_m: 0.3, span_m: [0.2, 0.5] };
        for about in [0.1f64, 1.0, 2.5, -2.0] {
            let outward = DVec3::new(about.sin(), 0.0, about.cos());
            let (place, east) = (0.3 * outward + 0.4 * DVec3::Y, DVec3::new(about.cos(), 0.0, -about.sin()));
            let (uv, along) = step(barrel, place, outward, 1e-4 * east);
            assert!((uv[0] - 1e-4 / 0.2).abs() < 1e-8 && uv[1].abs() < 1e-9, "{about}: {uv:?}");
            assert!((along[0] - 1e-4).abs() < 1e-9 && along[1].abs() < 1e-12, "{along:?}");
            let (uv, along) = step(barrel, place, outward, 1e-4 * DVec3::NEG_Y);
            assert!((uv[1] - 1e-4 / 0.5).abs() < 1e-9 && (along[1] - 1e-4).abs() < 1e-12, "{uv:?} {along:?}");
        }
        assert_eq!(barrel.at([0.1, 0.4, 0.0], [0.0, 1.0, 0.0]), by_normal([0.2, 0.5]));
    }

    #[test]
    fn globe_distances_are_those_of_the_map() {
        let globe = UvMapping::Sphere { radius_m: 0.5, span_m: [0.25, 0.25] };
        for (about, theta) in [(0.3f64, 1.57f64), (-2.0, 0.9), (3.0, 2.0)] {
            let outward = DVec3::new(about.sin() * theta.sin(), theta.cos(), about.cos() * theta.sin());
            let east = DVec3::new(about.cos(), 0.0, -about.sin());
            let (uv, along) = step(globe, 0.5 * outward, outward, 1e-4 * east.cross(outward));
            assert!((uv[1] - 1e-4 / 0.25).abs() < 1e-7 && uv[0].abs() < 1e-8, "{uv:?}");
            assert!((along[1] - 1e-4).abs() < 1e-9, "{along:?}");
            let (uv, along) = step(globe, 0.5 * outward, outward, 1e-4 * east);
            assert!((uv[0] * theta.sin() - 1e-4 / 0.25).abs() < 1e-6, "{uv:?}");
            assert!((along[0] - 1e-4).abs() < 1e-9, "{along:?}");
        }
    }

    #[test]
    fn a_crates_side_under_a_mapped_top_goes_by_the_normal() {
        let corners = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let top = UvTriangle::new(corners, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).unwrap();
        let crate_ = UvMapping::Plane(top);
        assert_eq!(crate_.at([0.1; 3], [0.0, 1.0, 0.0]), Some(UvPlace::Triangle(top)));
        assert_eq!(crate_.at([0.1; 3], [0.3, 0.9, 0.0]), Some(UvPlace::Triangle(top)));
        assert_eq!(crate_.at([0.1; 3], [1.0, 0.0, 0.0]), by_normal([2.0, 1.0]));
        assert_eq!(UvMapping::ByNormal { span_m: [0.0, 1.0] }.at([0.1; 3], [1.0, 0.0, 0.0]), None);
    }
}
