//! One of the two of a pair, as rapier knows it.

use crate::thing::{Thing, axis, rolls_m};
use crate::vector::{own, vec3};
use crate::view::View;
use asperity::UvPlace;
use asperity_pairs::{Motion, Side, Vec3, mobility_per_kg};
use rapier3d::prelude::*;

/// A collider in a step.
pub(crate) struct ColliderSide<'a> {
    pub view: &'a View<'a>,
    pub handle: ColliderHandle,
    pub collider: &'a Collider,
    pub thing: &'a Thing,
}

impl ColliderSide<'_> {
    fn dynamic(&self) -> Option<&RigidBody> {
        self.view.body_of(self.handle).filter(|body| body.is_dynamic())
    }
}

impl Side for ColliderSide<'_> {
    fn thing(&self) -> asperity_pairs::Thing {
        self.thing.facts()
    }

    fn motion(&self) -> Motion {
        self.view.motion(self.handle)
    }

    fn mass_kg(&self) -> f32 {
        self.dynamic().map_or(f32::INFINITY, RigidBody::mass)
    }

    fn mobility_per_kg(&self, point_m: Vec3, along: Vec3) -> f32 {
        let Some(body) = self.dynamic() else { return 0.0 };
        let properties = body.mass_properties();
        let arm_m = point_m - vec3(body.center_of_mass());
        mobility_per_kg(
            arm_m,
            along,
            |v| vec3(properties.effective_inv_mass * own(v)),
            |turn| vec3(properties.effective_world_inv_inertia * own(turn)),
        )
    }

    fn rolls_m(&self, point_m: Vec3, normal: Vec3) -> Option<f64> {
        rolls_m(self.thing, self.collider, point_m, normal)
    }

    fn radius_m(&self) -> Option<f64> {
        self.thing.radius_m
    }

    fn axis(&self) -> Option<Vec3> {
        axis(self.collider)
    }

    fn belt_m_s(&self) -> Vec3 {
        vec3(self.collider.position().rotation * self.thing.belt_m_s)
    }

    fn place_m(&self, point_m: Vec3) -> Vec3 {
        vec3(self.collider.position().inverse() * own(point_m))
    }

    fn direction(&self, along: Vec3) -> Vec3 {
        vec3(self.collider.position().rotation.inverse() * own(along))
    }

    fn coordinates(&self, place_m: Vec3, outward: Vec3) -> Option<UvPlace> {
        let (_, mapping) = self.thing.surface.as_ref()?;
        mapping.coordinates(self.collider.shape(), place_m, outward)
    }
}
