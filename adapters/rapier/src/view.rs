//! A view of a physics world: the sets that the adapter reads, whoever owns them.

use rapier3d::prelude::*;

/// The parts of a rapier world, borrowed between two steps.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Rigid bodies.
    pub bodies: &'a RigidBodySet,
    /// Colliders.
    pub colliders: &'a ColliderSet,
    /// Contact pairs.
    pub narrow_phase: &'a NarrowPhase,
    /// Gravity, m/s².
    pub gravity: Vector,
    /// Length of a step, s.
    pub step_s: f32,
}

impl<'a> From<&'a PhysicsWorld> for View<'a> {
    fn from(world: &'a PhysicsWorld) -> Self {
        Self {
            bodies: &world.bodies,
            colliders: &world.colliders,
            narrow_phase: &world.narrow_phase,
            gravity: world.gravity,
            step_s: world.integration_parameters.dt,
        }
    }
}

/// Motion of a rigid body at an instant; still for a collider without one.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Motion {
    pub linear_m_s: Vector,
    pub angular_rad_s: Vector,
    pub centre_m: Vector,
}

impl Motion {
    pub fn of(body: &RigidBody) -> Self {
        Self { linear_m_s: body.linvel(), angular_rad_s: body.angvel(), centre_m: body.center_of_mass() }
    }

    pub fn at(&self, point_m: Vector) -> Vector {
        self.linear_m_s + self.angular_rad_s.cross(point_m - self.centre_m)
    }
}

impl View<'_> {
    pub(crate) fn body_of(&self, collider: ColliderHandle) -> Option<&RigidBody> {
        self.bodies.get(self.colliders.get(collider)?.parent()?)
    }

    pub(crate) fn motion(&self, collider: ColliderHandle) -> Motion {
        self.body_of(collider).map(Motion::of).unwrap_or_default()
    }

    /// How much faster a body's point goes along a direction after an impulse of 1 N·s along it there, 1/kg: 0 for what nothing moves.
    pub(crate) fn mobility_per_kg(&self, collider: ColliderHandle, point_m: Vector, along: Vector) -> f32 {
        let Some(body) = self.body_of(collider).filter(|body| body.is_dynamic()) else { return 0.0 };
        let properties = body.mass_properties();
        let arm = (point_m - body.center_of_mass()).cross(along);
        along.dot(properties.effective_inv_mass * along)
            + arm.dot(properties.effective_world_inv_inertia * arm)
    }
}
