//! A collider to asperity: what it is made of, what rings, what can be stroked on it, and who feels
//! it.

use crate::vector::{own, vec3};
use asperity::{BodyId, ChannelId, Material, ProbeId, SurfaceId, UvMapping, UvPlace, UvTriangle};
use asperity_pairs::{NOMINAL_FORCE_N, Vec3, axis_radius_m};
use rapier3d::parry::query::PointQueryWithLocation;
use rapier3d::parry::shape::ShapeType;
use rapier3d::prelude::*;

/// Role of a collider in asperity.
#[derive(Debug, Clone)]
pub struct Thing {
    pub(crate) material: Material,
    pub(crate) body: Option<BodyId>,
    pub(crate) surface: Option<(SurfaceId, Mapping)>,
    pub(crate) actuator: Option<ChannelId>,
    pub(crate) probe: Option<ProbeId>,
    pub(crate) radius_m: Option<f64>,
    pub(crate) belt_m_s: Vector,
    pub(crate) nominal_n: f32,
}

impl Thing {
    /// A thing that strikes but does not ring and cannot be stroked.
    #[must_use]
    pub fn of(material: Material) -> Self {
        Self {
            material,
            body: None,
            surface: None,
            actuator: None,
            probe: None,
            radius_m: None,
            belt_m_s: Vector::ZERO,
            nominal_n: NOMINAL_FORCE_N,
        }
    }

    /// Rings as this body. The body's frame is the collider's own space: that is where blows are
    /// told to land.
    #[must_use]
    pub fn ringing(mut self, body: BodyId) -> Self {
        self.body = Some(body);
        self
    }

    /// Can be scraped: its surface, and how places become texture coordinates.
    #[must_use]
    pub fn with_surface(mut self, surface: SurfaceId, mapping: Mapping) -> Self {
        self.surface = Some((surface, mapping));
        self
    }

    /// Is a finger, or held in a hand: what it touches is felt.
    #[must_use]
    pub fn felt_by(mut self, actuator: ChannelId) -> Self {
        self.actuator = Some(actuator);
        self
    }

    /// Touches as this probe; the adapter's rigid one unless told otherwise.
    #[must_use]
    pub fn touching_with(mut self, probe: ProbeId) -> Self {
        self.probe = Some(probe);
        self
    }

    /// Radius of what strikes or rolls, m: a ball's, a capsule's or a lying cylinder's own, and
    /// [`EDGE_RADIUS_M`](crate::EDGE_RADIUS_M) for an edge unless told otherwise.
    #[must_use]
    pub fn radius_m(mut self, radius_m: f64) -> Self {
        self.radius_m = Some(radius_m);
        self
    }

    /// Its surface runs with this velocity in the collider's own space, m/s: a conveyor belt, whose
    /// physics is a hook's `tangent_velocity`. What rests on it is silent.
    #[must_use]
    pub fn running(mut self, belt_m_s: [f32; 3]) -> Self {
        self.belt_m_s = Vector::from_array(belt_m_s);
        self
    }

    /// Presses with this force on what nothing moves either, N: a kinematic hand or character on
    /// fixed ground, of which rapier tells no force. [`NOMINAL_FORCE_N`](crate::NOMINAL_FORCE_N)
    /// unless told otherwise; with 0 it is not heard there. Its collider needs
    /// `ActiveCollisionTypes::all()`.
    #[must_use]
    pub fn pressing(mut self, force_n: f32) -> Self {
        self.nominal_n = force_n;
        self
    }

    /// Data of it for the rules of pairs.
    pub(crate) fn facts(&self) -> asperity_pairs::Thing {
        asperity_pairs::Thing {
            material: self.material,
            body: self.body,
            surface: self.surface.as_ref().map(|(surface, _)| *surface),
            actuator: self.actuator,
            probe: self.probe,
        }
    }
}

/// From a place on a collider, in its own space, to texture coordinates.
#[derive(Debug, Clone)]
pub enum Mapping {
    /// By the place and the direction in which the collider faces there: planes, boxes, hulls,
    /// spheres, cylinders. A plane serves a height field as well.
    Shape(UvMapping),
    /// A triangle mesh with one coordinate a vertex, in the order of the collider's vertices.
    /// rapier's flags that merge vertices renumber them, and those that delete triangles move the
    /// rest.
    Mesh(Vec<[f64; 2]>),
}

impl Mapping {
    /// The plane through `origin_m` (uv 0, 0) whose u and v run along two edges, uv 1 at their
    /// ends, m.
    ///
    /// # Panics
    /// When the edges span no area.
    #[must_use]
    pub fn plane(origin_m: [f64; 3], u_m: [f64; 3], v_m: [f64; 3]) -> Self {
        let end = |edge: [f64; 3]| [0, 1, 2].map(|axis| origin_m[axis] + edge[axis]);
        let triangle = UvTriangle::new([origin_m, end(u_m), end(v_m)], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        Self::Shape(UvMapping::Plane(triangle.expect("the edges of a plane span an area")))
    }

    /// Every flat side by its normal: a box, a hull, a compound; uv 1 spans `span_m`, the surface's
    /// width and height.
    #[must_use]
    pub fn by_normal(span_m: [f64; 2]) -> Self {
        Self::Shape(UvMapping::ByNormal { span_m })
    }

    /// Around a ball.
    #[must_use]
    pub fn sphere(radius_m: f64, span_m: [f64; 2]) -> Self {
        Self::Shape(UvMapping::Sphere { radius_m, span_m })
    }

    /// Around a cylinder or a capsule along y.
    #[must_use]
    pub fn cylinder(radius_m: f64, span_m: [f64; 2]) -> Self {
        Self::Shape(UvMapping::Cylinder { radius_m, span_m })
    }

    /// Texture coordinates about a place. On a mesh they come from the projection: clustered
    /// contacts of several triangles carry no single sub-shape index.
    pub(crate) fn coordinates(&self, shape: &dyn Shape, local_m: Vec3, outward: Vec3) -> Option<UvPlace> {
        match self {
            Self::Shape(mapping) => {
                let [place, outward] = [local_m, outward].map(|v| v.to_array().map(f64::from));
                mapping.at(place, outward)
            }
            Self::Mesh(uv) => {
                let mesh = shape.as_trimesh()?;
                let (_, (triangle, _)) = mesh.project_local_point_and_get_location(own(local_m), false);
                let corners = *mesh.indices().get(triangle as usize)?;
                let uv = corners.map(|corner| uv.get(corner as usize).copied());
                let [Some(a), Some(b), Some(c)] = uv else { return None };
                let corners = corners.map(|corner| mesh.vertices()[corner as usize].to_array());
                UvTriangle::new(corners, [a, b, c]).map(UvPlace::Triangle)
            }
        }
    }
}

/// Axis of what is longer than round, in space.
pub(crate) fn axis(collider: &Collider) -> Option<Vec3> {
    use ShapeType::{Capsule, Cone, Cylinder, RoundCone, RoundCylinder};
    let own_axis = match collider.shape().shape_type() {
        Capsule => {
            let segment = &collider.shape().as_capsule()?.segment;
            segment.b - segment.a
        }
        Cylinder | Cone | RoundCylinder | RoundCone => Vector::Y,
        _ => return None,
    };
    let axis = vec3(collider.position().rotation * own_axis).normalize_or_zero();
    (axis != Vec3::ZERO).then_some(axis)
}

/// Radius with which a collider rolls on what it meets at a point with a normal, m; none: it does
/// not.
pub(crate) fn rolls_m(thing: &Thing, collider: &Collider, point_m: Vec3, normal: Vec3) -> Option<f64> {
    let shape = collider.shape();
    let ball = shape.as_ball().map(|ball| ball.radius);
    let own = ball.or(shape.as_capsule().map(|capsule| capsule.radius)).map(f64::from);
    let middle_m = vec3(collider.position().translation);
    let rolls = own.or_else(|| axis_radius_m(axis(collider)?, middle_m, point_m, normal))?;
    Some(thing.radius_m.unwrap_or(rolls))
}
