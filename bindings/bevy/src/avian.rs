//! Contacts of `avian3d`, by the rules that the adapters of all physics engines share
//! (`asperity-pairs`): every pair of colliders that have a [`TouchThing`](crate::TouchThing)
//! strikes, scrapes or rolls.
//!
//! ```text
//! closing   −normal_speed of the fastest point, which avian keeps from before the solver
//! force     Σ normal_impulse / (2 · step): avian adds up each substep's impulse twice
//! ```
//!
//! `PhysicsPlugins::default()` steps in `FixedPostUpdate`; this listens right after it.

use crate::component::TouchThing;
use crate::plugin::TouchSystems;
use crate::touch::Touch;
use asperity::{ChannelId, ContactEvent, UvPlace};
use asperity_pairs::{
    Motion, Notice, ODD_GRAVITY_M_S2, Pair, Points, Probes, Side, Solved, Step, Thing, Vec3, axis_radius_m,
    mobility_per_kg,
};
use avian3d::dynamics::rigid_body::{RigidBodyQueryReadOnly, RigidBodyQueryReadOnlyItem};
use avian3d::math::Vector;
use avian3d::prelude::{Collider, Collisions, ContactPair, Gravity, PhysicsSystems, Position, Rotation};
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time};
use std::collections::{BTreeMap, HashSet};

/// Name of the probe that things touch with, in recordings; with a face it goes on with its length.
pub const RIGID_PROBE: &str = "avian's rigid things";
/// Ids of these contacts begin here, so that the app's own stay free below.
const FIRST_CONTACT: u64 = 1 << 33;

/// Number of times that avian 0.7 counts an impulse: it adds what a substep has pushed so far to
/// `normal_impulse` after the substep's solving and again after its relaxing. What rests presses
/// with its weight only then.
const COUNTED: f32 = 2.0;

/// Listens to the physics; to be added after [`AsperityPlugin`](crate::AsperityPlugin).
#[derive(Debug, Clone, Copy, Default)]
pub struct AvianTouchPlugin;

impl Plugin for AvianTouchPlugin {
    fn build(&self, app: &mut App) {
        let Some(mut touch) = app.world_mut().get_resource_mut::<Touch>() else {
            return log::error!(
                "asperity gets nothing from avian: AsperityPlugin has to be added before, and to be built"
            );
        };
        match Probes::add(touch.scene()) {
            Ok(probes) => {
                probes.named(RIGID_PROBE).for_each(|(name, id)| touch.name_own_probe(&name, id));
                let pairs = BTreeMap::new();
                let warned = HashSet::new();
                app.insert_resource(Listener { probes, pairs, next_contact: FIRST_CONTACT, warned });
                app.add_systems(
                    FixedPostUpdate,
                    listen.after(PhysicsSystems::Last).in_set(TouchSystems::Report),
                );
            }
            Err(error) => log::error!("asperity gets nothing from avian: {error}"),
        }
    }
}

/// Pairs that avian lists, in order, so that the same world gives the same events.
#[derive(Resource)]
struct Listener {
    probes: Probes,
    pairs: BTreeMap<[Entity; 2], Listed>,
    next_contact: u64,
    /// Entities that were warned of because they are silent; none: the world.
    warned: HashSet<Option<Entity>>,
}

#[derive(Default)]
struct Listed {
    seen: bool,
    pair: Pair,
}

/// A vector of avian's.
fn own(v: Vec3) -> Vector {
    Vector::from_array(v.to_array())
}

/// A vector of the rules'.
fn vec3(v: Vector) -> Vec3 {
    Vec3::from_array(v.to_array())
}

/// The impulse-weighted mean of a pair's points; `None` when nothing presses. Two that nothing
/// moves press with `nominal_n_s` where they overlap.
fn solved(pair: &ContactPair, nominal_n_s: f32) -> Option<Solved> {
    let (mut point_m, mut normal) = (Vector::ZERO, Vector::ZERO);
    let (mut impulse_n_s, mut closing_m_s, mut restitution) = (0.0, 0.0f32, 0.0f32);
    let mut points = Points::default();
    for manifold in &pair.manifolds {
        for point in &manifold.points {
            let overlaps = f32::from(u8::from(nominal_n_s > 0.0 && point.penetration >= 0.0));
            let weight = if nominal_n_s > 0.0 { overlaps } else { point.normal_impulse };
            points.add(vec3(point.point));
            point_m += point.point * weight;
            normal += manifold.normal * weight;
            impulse_n_s += weight;
            closing_m_s = closing_m_s.max(-point.normal_speed);
        }
        restitution = restitution.max(manifold.restitution);
    }
    (impulse_n_s > 0.0).then(|| Solved {
        point_m: vec3(point_m / impulse_n_s),
        normal: vec3(normal.normalize_or_zero()),
        impulse_n_s: if nominal_n_s > 0.0 { nominal_n_s } else { impulse_n_s / COUNTED },
        restitution,
        closing_m_s,
        is_nominal: nominal_n_s > 0.0,
        points,
    })
}

/// A collider in a step.
struct ColliderSide<'a, 'w, 's> {
    thing: Thing,
    is: &'a TouchThing,
    collider: &'a Collider,
    position: Vector,
    rotation: Rotation,
    body: Option<&'a RigidBodyQueryReadOnlyItem<'w, 's>>,
}

impl Side for ColliderSide<'_, '_, '_> {
    fn thing(&self) -> Thing {
        self.thing
    }

    fn motion(&self) -> Motion {
        let Some(body) = self.body else { return Motion::default() };
        let centre_m = body.position.0 + body.rotation.0 * body.center_of_mass.0;
        Motion {
            linear_m_s: vec3(body.linear_velocity.0),
            angular_rad_s: vec3(body.angular_velocity.0),
            centre_m: vec3(centre_m),
        }
    }

    fn mass_kg(&self) -> f32 {
        self.body.filter(|body| body.rb.is_dynamic()).map_or(f32::INFINITY, |body| body.mass.value())
    }

    fn mobility_per_kg(&self, point_m: Vec3, along: Vec3) -> f32 {
        let Some(body) = self.body else { return 0.0 };
        let inverse_mass = body.effective_inverse_mass();
        let inverse_inertia = body.effective_global_angular_inertia().inverse();
        mobility_per_kg(
            point_m - self.motion().centre_m,
            along,
            |v| vec3(inverse_mass * own(v)),
            |turn| vec3(inverse_inertia * own(turn)),
        )
    }

    fn rolls_m(&self, point_m: Vec3, normal: Vec3) -> Option<f64> {
        let shape = self.collider.shape_scaled();
        let ball = shape.as_ball().map(|ball| ball.radius);
        let own = ball.or(shape.as_capsule().map(|capsule| capsule.radius)).map(f64::from);
        let rolls = own.or_else(|| axis_radius_m(self.axis()?, vec3(self.position), point_m, normal))?;
        Some(self.is.radius_m.unwrap_or(rolls))
    }

    fn radius_m(&self) -> Option<f64> {
        self.is.radius_m
    }

    fn axis(&self) -> Option<Vec3> {
        let shape = self.collider.shape_scaled();
        let own_axis = match shape.as_capsule() {
            Some(capsule) => capsule.segment.b - capsule.segment.a,
            None if shape.as_cylinder().is_some() || shape.as_cone().is_some() => Vector::Y,
            None => return None,
        };
        let axis = vec3(self.rotation * own_axis).normalize_or_zero();
        (axis != Vec3::ZERO).then_some(axis)
    }

    fn belt_m_s(&self) -> Vec3 {
        vec3(self.rotation * Vector::from_array(self.is.belt_m_s))
    }

    fn place_m(&self, point_m: Vec3) -> Vec3 {
        vec3(self.rotation.inverse() * (own(point_m) - self.position))
    }

    fn direction(&self, along: Vec3) -> Vec3 {
        vec3(self.rotation.inverse() * own(along))
    }

    fn coordinates(&self, place_m: Vec3, outward: Vec3) -> Option<UvPlace> {
        let [place, outward] = [place_m, outward].map(|v| v.to_array().map(f64::from));
        self.is.surface_mapping()?.at(place, outward)
    }
}

/// Impulse of a hand or a character on what nothing moves either; 0 where avian tells the force.
fn nominal_n_s(
    things: [&TouchThing; 2],
    bodies: [Option<&RigidBodyQueryReadOnlyItem<'_, '_>>; 2],
    step_s: f32,
) -> f32 {
    if bodies.iter().flatten().any(|body| body.rb.is_dynamic()) {
        return 0.0;
    }
    let hands = things.iter().zip(bodies).filter(|(_, body)| body.is_some_and(|body| body.rb.is_kinematic()));
    step_s * hands.fold(0.0f32, |most, (thing, _)| most.max(thing.nominal_force_n))
}

type ThingQuery<'a> = (&'a TouchThing, &'a Collider, &'a Position, &'a Rotation);

fn listen(
    collisions: Collisions,
    things: Query<ThingQuery<'_>>,
    bodies: Query<RigidBodyQueryReadOnly>,
    time: Res<Time<Fixed>>,
    gravity: Res<Gravity>,
    mut listener: ResMut<Listener>,
    mut touch: ResMut<Touch>,
) {
    let Listener { probes, pairs, next_contact, warned } = &mut *listener;
    let gravity_m_s2 = gravity.0.length();
    if gravity_m_s2 > ODD_GRAVITY_M_S2 && warned.insert(None) {
        log::warn!("asperity: {}", Notice::Gravity { m_s2: gravity_m_s2 });
    }
    pairs.values_mut().for_each(|listed| listed.seen = false);
    let mut events: Vec<ContactEvent> = Vec::new();
    let mut pressing: Vec<_> = collisions.iter().filter(|pair| pair.is_touching()).collect();
    // The graph's order is not the same from run to run of an app that spawns and despawns.
    pressing.sort_by_key(|pair| [pair.collider1, pair.collider2]);
    for contact in pressing {
        let entities = [contact.collider1, contact.collider2];
        let [Ok(first), Ok(second)] = entities.map(|entity| things.get(entity)) else { continue };
        let bodies = [contact.body1, contact.body2].map(|body| body.and_then(|body| bodies.get(body).ok()));
        let nominal_n_s =
            nominal_n_s([first.0, second.0], [0, 1].map(|k| bodies[k].as_ref()), time.delta_secs());
        let first = side(thing_of(entities[0], first.0, &touch), first, bodies[0].as_ref());
        let second = side(thing_of(entities[1], second.0, &touch), second, bodies[1].as_ref());
        let step = Step {
            sides: [&first, &second],
            solved: solved(contact, nominal_n_s),
            probes: *probes,
            step_s: time.delta_secs(),
        };
        let listed = pairs.entry(entities).or_default();
        listed.seen = true;
        listed.pair.advance(&step, next_contact, &mut events);
        let unplaced = listed.pair.doing().and_then(|doing| doing.unplaced);
        if let Some(entity) = unplaced.map(|side| entities[side])
            && warned.insert(Some(entity))
        {
            log::warn!("asperity, {entity}: {}", Notice::Unplaced);
        }
    }
    for listed in pairs.values_mut().filter(|listed| !listed.seen) {
        listed.pair.leave(&mut events);
    }
    pairs.retain(|_, listed| listed.seen);
    for event in events {
        touch.report(time.elapsed_secs_f64(), event);
    }
}

fn side<'a, 'w, 's>(
    thing: Thing,
    (is, collider, position, rotation): (&'a TouchThing, &'a Collider, &'a Position, &'a Rotation),
    body: Option<&'a RigidBodyQueryReadOnlyItem<'w, 's>>,
) -> ColliderSide<'a, 'w, 's> {
    ColliderSide { thing, is, collider, position: position.0, rotation: *rotation, body }
}

fn thing_of(entity: Entity, is: &TouchThing, touch: &Touch) -> Thing {
    Thing {
        material: is.material,
        body: touch.body(entity),
        // A plane without area has no texture coordinates: the thing is then struck only.
        surface: touch.surface(entity).filter(|_| is.surface_mapping().is_some()),
        actuator: is.actuator.map(ChannelId),
        probe: None,
    }
}
