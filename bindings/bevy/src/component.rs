//! Components: roles of entities in touch. Adding a component puts it into the scene, removing it
//! or the entity takes it out.

use asperity::{Body, Material, Probe, Surface, UvMapping};
use bevy_ecs::prelude::*;
use std::sync::{Mutex, PoisonError};

/// The entity rings: its modes and what it is made of. Inserted again, it replaces the body while
/// it rings.
#[derive(Component, Debug, Clone)]
pub struct TouchBody(pub Body);

/// The entity can be stroked. The surface moves into the scene when the component is added, so the
/// component holds nothing afterwards; inserted again, it replaces the surface under the contacts
/// that slide on it.
#[derive(Component)]
pub struct TouchSurface {
    surface: Mutex<Option<Surface>>,
    /// The entity whose [`TouchBody`] rings under it; none = this entity's own, if it has one.
    body: Option<Entity>,
}

impl TouchSurface {
    /// A surface that rings the entity's own [`TouchBody`], where it has one.
    #[must_use]
    pub fn new(surface: Surface) -> Self {
        Self { surface: Mutex::new(Some(surface)), body: None }
    }

    /// A surface that rings the body of another entity.
    #[must_use]
    pub fn on(mut self, body: Entity) -> Self {
        self.body = Some(body);
        self
    }

    /// The entity that rings, if it is another one.
    #[must_use]
    pub fn body(&self) -> Option<Entity> {
        self.body
    }

    pub(crate) fn take(&self) -> Option<Surface> {
        self.surface.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// The entity touches: a finger, a pen. Without it an entity that touches is the engine's own
/// probe, felt by the first actuator.
#[derive(Component, Debug, Clone, Copy, Default)]
pub struct TouchProbe {
    /// Probe; none = the engine's own.
    pub probe: Option<Probe>,
    /// The haptic channel that feels it; none = it is heard only.
    pub actuator: Option<u16>,
}

impl TouchProbe {
    /// The engine's own probe, felt by an actuator.
    #[must_use]
    pub fn felt_by(actuator: u16) -> Self {
        Self { probe: None, actuator: Some(actuator) }
    }
}

/// Role of a physics engine's collider in touch; put it on the entity that has the collider. It
/// rings as the entity's [`TouchBody`], and what slides on it strokes the entity's
/// [`TouchSurface`]. Colliders without it are not heard.
#[derive(Component, Debug, Clone, PartialEq)]
pub struct TouchThing {
    /// Material.
    pub material: Material,
    /// The plane of its surface in the collider's own space, m: the place of uv (0, 0), the edge
    /// along u, the edge along v. A collider with a surface needs it, or a `mapping`.
    pub plane_m: Option<[[f64; 3]; 3]>,
    /// Mapping of places on it to texture coordinates, where that is no plane: by the normal,
    /// around a sphere or a cylinder.
    pub mapping: Option<UvMapping>,
    /// The haptic channel that feels what it touches: a finger, or a tool in the hand.
    pub actuator: Option<u16>,
    /// Radius of what strikes or rolls, m; none = the shape's own, where it is round.
    pub radius_m: Option<f64>,
    /// Velocity of its surface in its own space, m/s: a conveyor belt.
    pub belt_m_s: [f32; 3],
    /// With how much it presses on what nothing moves either, N: a kinematic hand on fixed ground,
    /// of which the physics tells no force.
    pub nominal_force_n: f32,
}

impl TouchThing {
    /// A thing that strikes, and rings where it has a body.
    #[must_use]
    pub fn of(material: Material) -> Self {
        Self {
            material,
            plane_m: None,
            mapping: None,
            actuator: None,
            radius_m: None,
            belt_m_s: [0.0; 3],
            nominal_force_n: 1.0,
        }
    }

    /// Its surface lies on this plane of the collider: place of uv (0, 0), edge along u, edge along
    /// v, m.
    #[must_use]
    pub fn plane(mut self, origin_m: [f64; 3], u_m: [f64; 3], v_m: [f64; 3]) -> Self {
        self.plane_m = Some([origin_m, u_m, v_m]);
        self
    }

    /// Its surface lies on it so: [`UvMapping::ByNormal`] for a box or a hull.
    #[must_use]
    pub fn mapped(mut self, mapping: UvMapping) -> Self {
        self.mapping = Some(mapping);
        self
    }

    /// Its surface runs with this velocity in its own space, m/s.
    #[must_use]
    pub fn running(mut self, belt_m_s: [f32; 3]) -> Self {
        self.belt_m_s = belt_m_s;
        self
    }

    /// Presses with this force on what nothing moves either, N.
    #[must_use]
    pub fn pressing(mut self, force_n: f32) -> Self {
        self.nominal_force_n = force_n;
        self
    }

    /// Is a finger or held in a hand.
    #[must_use]
    pub fn felt_by(mut self, actuator: u16) -> Self {
        self.actuator = Some(actuator);
        self
    }

    /// Strikes with this radius of curvature, m.
    #[must_use]
    pub fn radius_m(mut self, radius_m: f64) -> Self {
        self.radius_m = Some(radius_m);
        self
    }

    /// Its mapping as the engine takes it; `None` without one, or where its plane has no area.
    #[cfg(any(feature = "avian", feature = "rapier"))]
    pub(crate) fn surface_mapping(&self) -> Option<UvMapping> {
        if self.mapping.is_some() {
            return self.mapping;
        }
        let [origin, u, v] = self.plane_m?;
        let end = |edge: [f64; 3]| [0, 1, 2].map(|axis| origin[axis] + edge[axis]);
        let uv = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        asperity::UvTriangle::new([origin, end(u), end(v)], uv).map(UvMapping::Plane)
    }
}
