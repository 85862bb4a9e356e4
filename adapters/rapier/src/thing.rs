//! A collider to asperity: what it is made of, what rings, what can be stroked on it, and who feels it.

use asperity::{Actuator, BodyId, Material, ProbeId, SurfaceId, UvTriangle};
use rapier3d::parry::query::PointQueryWithLocation;
use rapier3d::parry::shape::ShapeType;
use rapier3d::prelude::*;

/// What a collider is to asperity.
#[derive(Debug, Clone)]
pub struct Thing {
    pub(crate) material: Material,
    pub(crate) body: Option<BodyId>,
    pub(crate) surface: Option<(SurfaceId, Mapping)>,
    pub(crate) actuator: Option<Actuator>,
    pub(crate) probe: Option<ProbeId>,
    pub(crate) radius_m: Option<f64>,
}

impl Thing {
    /// A thing that strikes but does not ring and cannot be stroked.
    #[must_use]
    pub fn of(material: Material) -> Self {
        Self { material, body: None, surface: None, actuator: None, probe: None, radius_m: None }
    }

    /// Rings as this body.
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
    pub fn felt_by(mut self, actuator: Actuator) -> Self {
        self.actuator = Some(actuator);
        self
    }

    /// Touches as this probe; the adapter's rigid one unless told otherwise.
    #[must_use]
    pub fn touching_with(mut self, probe: ProbeId) -> Self {
        self.probe = Some(probe);
        self
    }

    /// Radius of what strikes, m: a ball's own and [`EDGE_RADIUS_M`](crate::EDGE_RADIUS_M) for an edge unless told otherwise.
    #[must_use]
    pub fn radius_m(mut self, radius_m: f64) -> Self {
        self.radius_m = Some(radius_m);
        self
    }

    /// What the rules of pairs need to know of it.
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
    /// A plane.
    Plane(UvTriangle),
    /// A triangle mesh with one coordinate a vertex, in the order of the collider's vertices. rapier's flags that merge vertices renumber
    /// them, and those that delete triangles move the rest.
    Mesh(Vec<[f64; 2]>),
}

impl Mapping {
    /// The plane through `origin_m` (uv 0, 0) whose u and v run along two edges, uv 1 at their ends, m.
    ///
    /// # Panics
    /// When the edges span no area.
    #[must_use]
    pub fn plane(origin_m: [f64; 3], u_m: [f64; 3], v_m: [f64; 3]) -> Self {
        let end = |edge: [f64; 3]| [0, 1, 2].map(|axis| origin_m[axis] + edge[axis]);
        let triangle = UvTriangle::new([origin_m, end(u_m), end(v_m)], [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        Self::Plane(triangle.expect("the edges of a plane span an area"))
    }

    /// The triangle that a place lies on. On a mesh it comes from the projection: clustered contacts of several triangles carry no single
    /// sub-shape index.
    pub(crate) fn triangle_at(&self, shape: &dyn Shape, local_m: Vector) -> Option<UvTriangle> {
        match self {
            Self::Plane(triangle) => Some(*triangle),
            Self::Mesh(uv) => {
                let mesh = shape.as_trimesh()?;
                let (_, (triangle, _)) = mesh.project_local_point_and_get_location(local_m, false);
                let corners = *mesh.indices().get(triangle as usize)?;
                let uv = corners.map(|corner| uv.get(corner as usize).copied());
                let [Some(a), Some(b), Some(c)] = uv else { return None };
                UvTriangle::new(corners.map(|corner| mesh.vertices()[corner as usize].to_array()), [a, b, c])
            }
        }
    }
}

/// Whether a collider rolls: then its place of contact moves with its centre.
pub(crate) fn is_round(collider: &Collider) -> bool {
    use ShapeType::{Ball, Capsule, Cone, Cylinder, RoundCone, RoundCylinder};
    matches!(collider.shape().shape_type(), Ball | Capsule | Cylinder | Cone | RoundCylinder | RoundCone)
}

/// Radius of curvature of a thing where it strikes, m; none = an edge.
pub(crate) fn own_radius_m(thing: &Thing, collider: &Collider) -> Option<f64> {
    let ball = collider.shape().as_ball().map(|ball| f64::from(ball.radius));
    let capsule = collider.shape().as_capsule().map(|capsule| f64::from(capsule.radius));
    thing.radius_m.or(ball).or(capsule)
}
