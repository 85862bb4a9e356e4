//! Contacts of `avian3d`: every pair of colliders that have a [`TouchThing`](crate::TouchThing) strikes, scrapes or rolls.
//!
//! ```text
//! closing   −normal_speed of the fastest point, which avian keeps from before the solver
//! force     Σ normal_impulse / step
//! path      of a ball or capsule: the motion of the centre, as it rolls; of others: the slip at the point
//! ```
//!
//! `PhysicsPlugins::default()` steps in `FixedPostUpdate`; this listens right after it.

use crate::component::TouchThing;
use crate::plugin::TouchSystems;
use crate::touch::Touch;
use asperity::{Actuator, ContactEvent, ContactId, ContactSample, Impact, SurfaceId, Touching};
use avian3d::math::Vector;
use avian3d::prelude::{
    AngularVelocity, Collider, Collisions, ComputedCenterOfMass, ContactPair, LinearVelocity, PhysicsSystems,
    Position, Rotation,
};
use bevy_app::prelude::*;
use bevy_ecs::prelude::*;
use bevy_time::{Fixed, Time};
use std::collections::BTreeMap;

/// Ids of these contacts begin here, so that the app's own stay free below.
const FIRST_CONTACT: u64 = 1 << 33;
/// Slower landings are rest, not impacts, m/s.
const QUIET_LANDING_M_S: f32 = 0.02;
/// A place of contact that moves slower rests, m/s.
const REST_M_S: f32 = 0.002;
/// Steps of rest after which a contact ends.
const REST_STEPS: u32 = 6;
/// Radius of an edge that nobody gave one, m: what is broken with sandpaper. Assumed.
const EDGE_RADIUS_M: f64 = 0.002;

/// Listens to the physics; to be added after [`AsperityPlugin`](crate::AsperityPlugin).
#[derive(Debug, Clone, Copy, Default)]
pub struct AvianTouchPlugin;

impl Plugin for AvianTouchPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(Pairs { next_contact: FIRST_CONTACT, ..Pairs::default() });
        app.add_systems(
            FixedPostUpdate,
            listen.after(PhysicsSystems::Last).in_set(TouchSystems::Report).run_if(resource_exists::<Touch>),
        );
    }
}

/// Pairs that press, in order, so that the same world gives the same events.
#[derive(Resource, Default)]
struct Pairs {
    pairs: BTreeMap<[Entity; 2], Pair>,
    next_contact: u64,
}

#[derive(Default)]
struct Pair {
    seen: bool,
    contact: Option<ContactId>,
    resting_steps: u32,
}

/// A pair's contact as the solver left it.
struct Solved {
    point_m: Vector,
    /// Of length 1, from the first collider to the second.
    normal: Vector,
    impulse_n_s: f32,
    closing_m_s: f32,
    restitution: f32,
}

impl Solved {
    /// `None` when nothing presses.
    fn of(pair: &ContactPair) -> Option<Self> {
        let mut solved = Self {
            point_m: Vector::ZERO,
            normal: Vector::ZERO,
            impulse_n_s: 0.0,
            closing_m_s: 0.0,
            restitution: 0.0,
        };
        for manifold in &pair.manifolds {
            for point in &manifold.points {
                solved.point_m += point.point * point.normal_impulse;
                solved.normal += manifold.normal * point.normal_impulse;
                solved.impulse_n_s += point.normal_impulse;
                solved.closing_m_s = solved.closing_m_s.max(-point.normal_speed);
            }
            solved.restitution = solved.restitution.max(manifold.restitution);
        }
        (solved.impulse_n_s > 0.0).then(|| Self {
            point_m: solved.point_m / solved.impulse_n_s,
            normal: solved.normal.normalize_or_zero(),
            ..solved
        })
    }
}

type Moving<'a> =
    (&'a Position, &'a Rotation, &'a LinearVelocity, &'a AngularVelocity, Option<&'a ComputedCenterOfMass>);

/// How a collider moves; still without a body.
#[derive(Clone, Copy, Default)]
struct Motion {
    linear_m_s: Vector,
    angular_rad_s: Vector,
    centre_m: Vector,
}

impl Motion {
    fn of(
        (position, rotation, linear, angular, centre): (
            &Position,
            &Rotation,
            &LinearVelocity,
            &AngularVelocity,
            Option<&ComputedCenterOfMass>,
        ),
    ) -> Self {
        let centre_m = position.0 + centre.map_or(Vector::ZERO, |centre| rotation.0 * centre.0);
        Self { linear_m_s: linear.0, angular_rad_s: angular.0, centre_m }
    }

    fn at(&self, point_m: Vector) -> Vector {
        self.linear_m_s + self.angular_rad_s.cross(point_m - self.centre_m)
    }
}

type ThingQuery<'a> = (&'a TouchThing, &'a Collider, &'a Position, &'a Rotation);

fn listen(
    collisions: Collisions,
    things: Query<ThingQuery<'_>>,
    bodies: Query<Moving<'_>>,
    time: Res<Time<Fixed>>,
    mut pairs: ResMut<Pairs>,
    mut touch: ResMut<Touch>,
) {
    let Pairs { pairs, next_contact } = &mut *pairs;
    pairs.values_mut().for_each(|pair| pair.seen = false);
    let mut events = Vec::new();
    let mut pressing: Vec<_> = collisions.iter().filter(|pair| pair.is_touching()).collect();
    // The graph's order is not the same from run to run of an app that spawns and despawns.
    pressing.sort_by_key(|pair| [pair.collider1, pair.collider2]);
    for told in pressing {
        let entities = [told.collider1, told.collider2];
        let [Ok(first), Ok(second)] = entities.map(|entity| things.get(entity)) else { continue };
        let Some(solved) = Solved::of(told) else { continue };
        let motions = [told.body1, told.body2]
            .map(|body| body.and_then(|body| bodies.get(body).ok()).map(Motion::of).unwrap_or_default());
        let landed = !pairs.contains_key(&entities);
        let pair = pairs.entry(entities).or_default();
        pair.seen = true;
        let sides = [first, second];
        let strikes = landed
            && solved.closing_m_s > QUIET_LANDING_M_S
            && !entities
                .iter()
                .zip(sides)
                .any(|(entity, (thing, ..))| thing.actuator.is_some() && touch.body(*entity).is_none());
        if strikes {
            events.extend(impact(entities, sides, &solved, &touch));
            continue;
        }
        let closing_m_s = if landed { solved.closing_m_s.max(0.0) } else { 0.0 };
        let sliding = slide(entities, sides, motions, &solved, &touch, time.delta_secs());
        pair.advance(sliding, closing_m_s, next_contact, &mut events);
    }
    for pair in pairs.values_mut().filter(|pair| !pair.seen) {
        pair.end(&mut events);
    }
    pairs.retain(|_, pair| pair.seen);
    for event in events {
        touch.report(time.elapsed_secs_f64(), event);
    }
}

/// The blow of a landing; none where nothing rings.
fn impact(
    entities: [Entity; 2],
    sides: [(&TouchThing, &Collider, &Position, &Rotation); 2],
    solved: &Solved,
    touch: &Touch,
) -> Option<ContactEvent> {
    let bodies = entities.map(|entity| touch.body(entity));
    let struck = (0..2).find(|i| bodies[*i].is_some() && sides[*i].0.actuator.is_none());
    let struck = struck.or_else(|| bodies.iter().position(Option::is_some))?;
    let striker = sides[1 - struck].0;
    let (impulse, speed) = (f64::from(solved.impulse_n_s), f64::from(solved.closing_m_s));
    let restitution = f64::from(solved.restitution).clamp(0.0, 1.0);
    let mut impact = Impact::from_impulse(bodies[struck]?, impulse, speed, restitution);
    impact.radius_m = radius_m(sides);
    impact.striker = striker.material;
    // A tool in the hand rings as its holder and is felt; any other striker rings beside what it strikes.
    if striker.actuator.is_some() {
        impact.holder = bodies[1 - struck];
    } else {
        impact.other = bodies[1 - struck];
    }
    impact.actuator = striker.actuator.or(sides[struck].0.actuator).map(Actuator);
    Some(ContactEvent::Impact(impact))
}

/// Radius of curvature with which two things meet, m: of the round ones, where there are any, else of an edge.
fn radius_m(sides: [(&TouchThing, &Collider, &Position, &Rotation); 2]) -> f64 {
    let own = |(thing, collider, ..): (&TouchThing, &Collider, &Position, &Rotation)| {
        let shape = collider.shape_scaled();
        let ball = shape.as_ball().map(|ball| f64::from(ball.radius));
        thing.radius_m.or(ball).or(shape.as_capsule().map(|capsule| f64::from(capsule.radius)))
    };
    let curvature: f64 = sides.into_iter().filter_map(own).map(|radius_m| 1.0 / radius_m).sum();
    if curvature > 0.0 { 1.0 / curvature } else { EDGE_RADIUS_M }
}

/// What slides on what, and how.
struct Sliding {
    surface: SurfaceId,
    holder: Option<asperity::BodyId>,
    actuator: Option<Actuator>,
    sample: ContactSample,
    path_m_s: f32,
}

fn slide(
    entities: [Entity; 2],
    sides: [(&TouchThing, &Collider, &Position, &Rotation); 2],
    motions: [Motion; 2],
    solved: &Solved,
    touch: &Touch,
    step_s: f32,
) -> Option<Sliding> {
    // Of two surfaces the one that is not in the hand is stroked.
    let scraped = (0..2)
        .filter(|i| touch.surface(entities[*i]).is_some() && sides[*i].0.plane_m.is_some())
        .min_by_key(|i| sides[*i].0.actuator.is_some())?;
    let other = 1 - scraped;
    let (thing, _, position, rotation) = sides[scraped];
    let [ground, moving] = [motions[scraped], motions[other]];
    let shape = sides[other].1.shape_scaled();
    let round = shape.as_ball().is_some() || shape.as_capsule().is_some();
    let velocity = if round {
        moving.linear_m_s - ground.at(moving.centre_m)
    } else {
        moving.at(solved.point_m) - ground.at(solved.point_m)
    };
    let path = velocity - solved.normal * velocity.dot(solved.normal);
    let inverse = rotation.0.inverse();
    let [place, along] = [inverse * (solved.point_m - position.0), inverse * path].map(|v| v.to_array());
    let force_n = f64::from(solved.impulse_n_s / step_s);
    Some(Sliding {
        surface: touch.surface(entities[scraped])?,
        holder: touch.body(entities[other]),
        actuator: sides[other].0.actuator.map(Actuator),
        sample: thing.triangle()?.sample(place, along, force_n),
        path_m_s: path.length(),
    })
}

impl Pair {
    /// Begins, moves or ends the contact of a pair that presses.
    fn advance(
        &mut self,
        sliding: Option<Sliding>,
        closing_m_s: f32,
        next_contact: &mut u64,
        events: &mut Vec<ContactEvent>,
    ) {
        let Some(sliding) = sliding else { return self.end(events) };
        let rests = sliding.path_m_s < REST_M_S && sliding.actuator.is_none();
        self.resting_steps = if rests { self.resting_steps + 1 } else { 0 };
        if self.resting_steps > REST_STEPS || (rests && self.contact.is_none()) {
            return self.end(events);
        }
        if let Some(contact) = self.contact {
            return events.push(ContactEvent::moved(contact, sliding.sample));
        }
        let contact = ContactId(*next_contact);
        *next_contact += 1;
        self.contact = Some(contact);
        let mut touching = Touching::on(sliding.surface);
        (touching.holder, touching.actuator) = (sliding.holder, sliding.actuator);
        let sample = ContactSample { closing_m_s: f64::from(closing_m_s), ..sliding.sample };
        events.push(ContactEvent::begin_with(contact, touching, sample));
    }

    fn end(&mut self, events: &mut Vec<ContactEvent>) {
        if let Some(contact) = self.contact.take() {
            events.push(ContactEvent::end(contact));
        }
    }
}
