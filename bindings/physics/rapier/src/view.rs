//! A view of a physics world: the sets that the adapter reads, whoever owns them.

use crate::vector::vec3;
use asperity_pairs::Motion;
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

/// Motion of a rigid body.
pub(crate) fn motion(body: &RigidBody) -> Motion {
    Motion {
        linear_m_s: vec3(body.linvel()),
        angular_rad_s: vec3(body.angvel()),
        centre_m: vec3(body.center_of_mass()),
    }
}

impl View<'_> {
    pub(crate) fn body_of(&self, collider: ColliderHandle) -> Option<&RigidBody> {
        self.bodies.get(self.colliders.get(collider)?.parent()?)
    }

    /// Still for a collider without a body.
    pub(crate) fn motion(&self, collider: ColliderHandle) -> Motion {
        self.body_of(collider).map(motion).unwrap_or_default()
    }
}

impl std::fmt::Debug for View<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("View").finish_non_exhaustive()
    }
}
