//! One world of colliders as the arrays of a simulator have it: numbers, and no physics engine.
//!
//! ```text
//! closing   (v₁ − v₂) · n, the greater of this step's and the last one's: some simulators have
//!           the velocities of a contact's instant, others those that the solver has left
//! force     Σ of the points of a pair, place and normal weighted by it
//! ```

use crate::face::{Points, Probes};
use crate::pair::Pair;
use crate::side::{Motion, Side, Thing, axis_radius_m};
use crate::step::{Solved, Step};
use asperity::{ContactEvent, UvMapping, UvPlace};
use glam::{Mat3, Vec3};
use std::collections::BTreeMap;

/// Form of a collider as far as it rolls; axes are its own z.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Form {
    /// It does not roll.
    #[default]
    Flat,
    /// Sphere of a radius, m.
    Sphere(f64),
    /// Capsule of a radius, m.
    Capsule(f64),
    /// Cylinder.
    Cylinder,
}

/// A collider, for its whole life.
#[derive(Debug, Clone, Copy)]
pub struct Collider {
    /// Role in asperity.
    pub thing: Thing,
    /// Gain in speed after 1 N·s, 1/kg; 0 for what nothing moves. Levers are left out.
    pub mobility_per_kg: f32,
    /// Form.
    pub form: Form,
    /// Radius where it strikes, m; none = as it rolls, or an edge.
    pub radius_m: Option<f64>,
    /// Mapping from places on it to texture coordinates; none = it is struck only.
    pub mapping: Option<UvMapping>,
}

/// Place and motion of a collider in a step.
#[derive(Debug, Clone, Copy, Default)]
pub struct Placed {
    /// Origin of its own space, m.
    pub place_m: Vec3,
    /// Turn from its own space to the world's.
    pub turn: Mat3,
    /// Motion about its origin.
    pub motion: Motion,
}

/// A point at which two colliders press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// The two, by index.
    pub colliders: [u32; 2],
    /// Place, m.
    pub point_m: Vec3,
    /// Direction from the first to the second.
    pub normal: Vec3,
    /// Along the normal, N.
    pub force_n: f32,
    /// Rebound over approach speed, 0 to 1.
    pub restitution: f32,
}

/// Pairs of a world from step to step.
#[derive(Debug, Default)]
pub struct World {
    pairs: BTreeMap<[u32; 2], (bool, Pair)>,
    before: Vec<Motion>,
    next_contact: u64,
}

struct Seen<'a> {
    collider: &'a Collider,
    placed: &'a Placed,
}

impl World {
    /// Takes a step of `step_s` in which these pressed; `placed` has an entry for each collider.
    /// Places without a collider, and pairs in which nothing rings, are not heard.
    pub fn step(
        &mut self,
        (colliders, placed): (&[Option<Collider>], &[Placed]),
        contacts: &mut [Contact],
        (probes, step_s): (Probes, f32),
        events: &mut Vec<ContactEvent>,
    ) {
        for contact in contacts.iter_mut().filter(|contact| contact.colliders[0] > contact.colliders[1]) {
            contact.colliders.reverse();
            contact.normal = -contact.normal;
        }
        contacts.sort_by_key(|contact| contact.colliders);
        self.pairs.values_mut().for_each(|(seen, _)| *seen = false);
        for points in contacts.chunk_by(|a, b| a.colliders == b.colliders) {
            let indices = points[0].colliders.map(|index| index as usize);
            let [Some(first), Some(second)] = indices.map(|index| colliders[index].as_ref()) else {
                continue;
            };
            if first.thing.body.or(second.thing.body).is_none() || indices[0] == indices[1] {
                continue;
            }
            let now = indices.map(|index| placed[index].motion);
            let before = indices.map(|index| self.before.get(index).copied().unwrap_or(placed[index].motion));
            let sides = [(first, indices[0]), (second, indices[1])]
                .map(|(collider, index)| Seen { collider, placed: &placed[index] });
            let solved = solved(points, [before, now], step_s);
            let step = Step { sides: [&sides[0], &sides[1]], solved, probes, step_s };
            let (seen, pair) = self.pairs.entry(points[0].colliders).or_default();
            *seen = true;
            pair.advance(&step, &mut self.next_contact, events);
        }
        self.pairs.values_mut().filter(|(seen, _)| !seen).for_each(|(_, pair)| pair.leave(events));
        self.pairs.retain(|_, (seen, _)| *seen);
        self.before.clear();
        self.before.extend(placed.iter().map(|placed| placed.motion));
    }
}

/// The force-weighted mean of a pair's points; none: nothing presses.
fn solved(contacts: &[Contact], motions: [[Motion; 2]; 2], step_s: f32) -> Option<Solved> {
    let (mut point_m, mut normal, mut force_n, mut restitution) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0f32);
    let mut points = Points::default();
    for contact in contacts.iter().filter(|contact| contact.force_n > 0.0) {
        points.add(contact.point_m);
        point_m += contact.point_m * contact.force_n;
        normal += contact.normal * contact.force_n;
        force_n += contact.force_n;
        restitution = restitution.max(contact.restitution);
    }
    let (point_m, normal) = (point_m / force_n, normal.normalize_or_zero());
    let closing = motions.map(|both| Solved::closing_m_s(both, [Vec3::ZERO; 2], point_m, normal));
    (force_n > 0.0 && normal != Vec3::ZERO).then(|| Solved {
        point_m,
        normal,
        impulse_n_s: force_n * step_s,
        restitution,
        closing_m_s: closing[0].max(closing[1]),
        is_nominal: false,
        points,
    })
}

impl Side for Seen<'_> {
    fn thing(&self) -> Thing {
        self.collider.thing
    }

    fn motion(&self) -> Motion {
        self.placed.motion
    }

    fn mass_kg(&self) -> f32 {
        1.0 / self.collider.mobility_per_kg
    }

    fn mobility_per_kg(&self, _: Vec3, _: Vec3) -> f32 {
        self.collider.mobility_per_kg
    }

    fn rolls_m(&self, point_m: Vec3, normal: Vec3) -> Option<f64> {
        let own = match self.collider.form {
            Form::Flat => return None,
            Form::Sphere(radius_m) | Form::Capsule(radius_m) => radius_m,
            Form::Cylinder => axis_radius_m(self.placed.turn.z_axis, self.placed.place_m, point_m, normal)?,
        };
        Some(self.collider.radius_m.unwrap_or(own))
    }

    fn radius_m(&self) -> Option<f64> {
        self.collider.radius_m
    }

    fn axis(&self) -> Option<Vec3> {
        matches!(self.collider.form, Form::Capsule(_) | Form::Cylinder).then_some(self.placed.turn.z_axis)
    }

    fn place_m(&self, point_m: Vec3) -> Vec3 {
        self.direction(point_m - self.placed.place_m)
    }

    fn direction(&self, along: Vec3) -> Vec3 {
        self.placed.turn.transpose() * along
    }

    fn coordinates(&self, place_m: Vec3, outward: Vec3) -> Option<UvPlace> {
        let [place, outward] = [place_m, outward].map(|v| v.to_array().map(f64::from));
        self.collider.mapping?.at(place, outward)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::{BodyId, Config, Material, SurfaceId};

    fn collider(mobility_per_kg: f32, rings: bool) -> Option<Collider> {
        let thing = Thing {
            material: Material::STEEL,
            body: rings.then(|| BodyId::from_bits(1)),
            surface: rings.then(|| SurfaceId::from_bits(1)),
            actuator: None,
            probe: None,
        };
        let mapping = Some(UvMapping::ByNormal { span_m: [0.2; 2] });
        let form = if rings { Form::Flat } else { Form::Sphere(0.01) };
        Some(Collider { thing, mobility_per_kg, form, radius_m: None, mapping })
    }

    /// Events of steps in which the second of two moves so fast, pressed with a force.
    fn stepped(steps: &[([f32; 3], f32)], order: [u32; 2]) -> Vec<Vec<ContactEvent>> {
        let mut scene = Config::default().build().unwrap().scene;
        let probes = Probes::add(&mut scene).unwrap();
        let colliders = [collider(0.0, true), collider(50.0, false)];
        let (mut world, mut place_m) = (World::default(), Vec3::new(0.0, 0.0, 0.01));
        let step = |(velocity, force_n): &([f32; 3], f32)| {
            let velocity = Vec3::from_array(*velocity);
            place_m += velocity * 0.002;
            let motion = Motion { linear_m_s: velocity, centre_m: place_m, ..Motion::default() };
            let rest = Placed { turn: Mat3::IDENTITY, ..Placed::default() };
            let placed = [rest, Placed { place_m, motion, ..rest }];
            let normal = if order == [0, 1] { Vec3::Z } else { Vec3::NEG_Z };
            let contact = Contact {
                colliders: order,
                point_m: place_m - 0.01 * Vec3::Z,
                normal,
                force_n: *force_n,
                restitution: 0.0,
            };
            let mut events = Vec::new();
            world.step((&colliders, &placed), &mut [contact], (probes, 0.002), &mut events);
            events
        };
        steps.iter().map(step).collect()
    }

    #[test]
    fn a_ball_that_lands_strikes_once_with_its_speed_and_mass() {
        let steps = [([0.0, 0.0, -1.0], 0.0), ([0.0, 0.0, -1.0], 3.0), ([0.0; 3], 1.0), ([0.0; 3], 0.2)];
        let events = stepped(&steps, [0, 1]).concat();
        let [ContactEvent::Impact(impact)] = events[..] else { panic!("{events:?}") };
        assert_eq!((impact.speed_m_s, impact.radius_m), (1.0, 0.01));
        assert!((impact.mass_kg - 0.02).abs() < 1e-7);
    }

    #[test]
    fn what_slides_begins_moves_and_ends_whichever_comes_first_in_its_pair() {
        let mut steps = vec![([0.1, 0.0, 0.0], 0.5); 3];
        steps.push(([0.1, 0.0, 0.0], 0.0));
        let both = [[0, 1], [1, 0]].map(|order| stepped(&steps, order));
        assert_eq!(both[0], both[1]);
        let [begin, _, moved, end] = &both[0][..] else { panic!() };
        assert!(matches!(begin[..], [ContactEvent::Begin { .. }]));
        assert!(matches!(moved[..], [ContactEvent::Moved { sample, .. }]
            if (sample.normal_force_n - 0.5).abs() < 1e-6 && sample.velocity_m_s.unwrap()[0].abs() > 0.09
                // It does not turn: nothing of it rolls.
                && sample.slip_m_s.is_none()));
        assert!(matches!(end[..], [ContactEvent::End { .. }]));
    }

    #[test]
    fn what_rests_is_silent() {
        assert!(stepped(&[([0.0; 3], 0.5); 20], [0, 1]).concat().is_empty());
    }
}
