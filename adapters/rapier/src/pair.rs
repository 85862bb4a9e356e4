//! One pair of colliders over time: it lands, slides or rolls, rests, and leaves.
//!
//! ```text
//! closing    (v₁ − v₂) · n before the step, gravity's share of the step included
//! mass       1 / (n·K₁n + n·K₂n),  n·Kn = 1/m + (r × n)·I⁻¹(r × n)
//! path       of a round body: (v_c + (ω·n) n × r) ∥ surface, of others: the slip, v_c + ω × r; a round one tells its slip beside it
//! ```

use crate::solved::Solved;
use crate::thing::{Thing, is_round, radius_m};
use crate::view::{Motion, View};
use crate::{Kind, Touch};
use asperity::{ContactEvent, ContactId, ContactSample, Impact, ProbeId, Touching};
use rapier3d::prelude::*;

/// Slower landings are rest, not impacts, m/s.
const QUIET_LANDING_M_S: f32 = 0.02;
/// A place of contact that moves slower rests, m/s.
const REST_M_S: f32 = 0.002;
/// Steps of rest after which a contact ends.
const REST_STEPS: u32 = 6;
/// Share by which the integrated place is pulled to the reported one in each step.
const PULL: f32 = 0.3;
/// Beyond this the reported place is right, m.
const TELEPORT_M: f32 = 0.01;
/// A pair whose slip is below this share of its path rolls.
const ROLLING: f32 = 0.3;

/// What a pair needs to know of a step.
pub(crate) struct Step<'a> {
    pub view: &'a View<'a>,
    pub colliders: [ColliderHandle; 2],
    pub things: [&'a Thing; 2],
    /// How both moved before the step.
    pub before: [Motion; 2],
    pub solved: Option<Solved>,
    pub rigid: ProbeId,
}

#[derive(Debug, Default)]
pub(crate) struct Pair {
    /// Whether the physics engine still lists it.
    pub seen: bool,
    pub touch: Option<Touch>,
    contact: Option<ContactId>,
    /// Place of contact in the space of the scraped collider.
    local_m: Option<Vector>,
    resting_steps: u32,
}

impl Pair {
    /// After a step in which the pair was listed.
    pub fn advance(&mut self, step: &Step<'_>, next_contact: &mut u64, events: &mut Vec<ContactEvent>) {
        let Some(solved) = step.solved else { return self.leave(events) };
        let landed = self.touch.is_none();
        let closing_m_s = if landed { step.closing_m_s(&solved) } else { 0.0 };
        let felt_landing = step.things.iter().any(|thing| thing.is_finger());
        let strikes = closing_m_s > QUIET_LANDING_M_S && !felt_landing;
        if strikes && let Some(impact) = step.impact(&solved, closing_m_s) {
            events.push(ContactEvent::Impact(impact));
        }
        let scraped = step.scraped();
        let (path, slip) = step.velocities(&solved, scraped.unwrap_or(0));
        let kind = match (path.length(), slip.length()) {
            (path, _) if path < REST_M_S => Kind::Rests,
            (path, slip) if slip < ROLLING * path => Kind::Rolls,
            _ => Kind::Scrapes,
        };
        self.touch = Some(Touch {
            colliders: step.colliders,
            kind,
            contact: self.contact,
            path_m_s: path.length(),
            slip_m_s: slip.length(),
            force_n: solved.impulse_n_s / step.view.step_s,
        });
        // What has just struck leaves again, or slides from the next step on.
        if let Some(scraped) = scraped.filter(|_| !strikes) {
            self.slide(step, &solved, (scraped, path, slip, closing_m_s), next_contact, events);
        }
        if let Some(touch) = &mut self.touch {
            touch.contact = self.contact;
        }
    }

    /// Begins, moves or ends the contact of a pair that touches.
    fn slide(
        &mut self,
        step: &Step<'_>,
        solved: &Solved,
        (scraped, path, slip, closing_m_s): (usize, Vector, Vector, f32),
        next_contact: &mut u64,
        events: &mut Vec<ContactEvent>,
    ) {
        let toucher = step.things[1 - scraped];
        let rests = path.length() < REST_M_S && toucher.actuator.is_none();
        self.resting_steps = if rests { self.resting_steps + 1 } else { 0 };
        if self.resting_steps > REST_STEPS || (rests && self.contact.is_none()) {
            return self.end(events);
        }
        let Some((mut sample, surface)) = self.sample(step, solved, scraped, path) else {
            return self.end(events);
        };
        // What is not round slides as fast as it moves.
        if let Some(radius_m) = step.roll_radius_m(scraped) {
            sample = sample.rolling(radius_m).slipping(f64::from(slip.length()));
        }
        if let Some(contact) = self.contact {
            events.push(ContactEvent::moved(contact, sample));
            return;
        }
        let contact = ContactId(*next_contact);
        *next_contact += 1;
        self.contact = Some(contact);
        let mut touching = Touching::on(surface);
        // A finger is the engine's own probe unless it says otherwise.
        touching.probe = toucher.probe.or((!toucher.is_finger()).then_some(step.rigid));
        (touching.holder, touching.actuator) = (toucher.body, toucher.actuator);
        let sample = ContactSample { closing_m_s: f64::from(closing_m_s.max(0.0)), ..sample };
        events.push(ContactEvent::begin_with(contact, touching, sample));
    }

    /// Where and how the pair touches, on the surface of the scraped one.
    fn sample(
        &mut self,
        step: &Step<'_>,
        solved: &Solved,
        scraped: usize,
        path: Vector,
    ) -> Option<(ContactSample, asperity::SurfaceId)> {
        let collider = step.view.colliders.get(step.colliders[scraped])?;
        let (surface, mapping) = step.things[scraped].surface.as_ref()?;
        let place = collider.position();
        let local_path = place.rotation.inverse() * path;
        let told_m = place.inverse() * solved.point_m;
        let local_m = self.follow(told_m, local_path * step.view.step_s);
        let triangle = mapping.triangle_at(collider.shape(), local_m)?;
        let force_n = f64::from(solved.impulse_n_s / step.view.step_s);
        Some((triangle.sample(local_m.to_array(), local_path.to_array(), force_n), *surface))
    }

    /// The path is integrated and pulled gently to where the solver says, because its point belongs to the start of the step and jumps as
    /// points come and go.
    fn follow(&mut self, told_m: Vector, moved_m: Vector) -> Vector {
        let local_m = match self.local_m {
            Some(last_m) if (told_m - last_m).length() < TELEPORT_M + 2.0 * moved_m.length() => {
                let here_m = last_m + moved_m;
                here_m + (told_m + moved_m - here_m) * PULL
            }
            _ => told_m,
        };
        self.local_m = Some(local_m);
        local_m
    }

    fn end(&mut self, events: &mut Vec<ContactEvent>) {
        self.local_m = None;
        if let Some(contact) = self.contact.take() {
            events.push(ContactEvent::end(contact));
        }
    }

    /// Nothing presses any more.
    pub fn leave(&mut self, events: &mut Vec<ContactEvent>) {
        self.end(events);
        self.touch = None;
        self.resting_steps = 0;
    }
}

impl Step<'_> {
    /// Approach speed at the place of contact as the solver met it; 0 where only gravity's share of this step brings them together, as it
    /// does to all that rests.
    fn closing_m_s(&self, solved: &Solved) -> f32 {
        let [first, second] = self.before.map(|motion| motion.at(solved.point_m));
        let approach = (first - second).dot(solved.normal);
        if approach <= QUIET_LANDING_M_S {
            return 0.0;
        }
        let [first, second] = self.colliders.map(|collider| {
            let body = self.view.body_of(collider).filter(|body| body.is_dynamic());
            body.map_or(0.0, |body| body.gravity_scale()) * self.view.step_s
        });
        approach + (self.view.gravity * (first - second)).dot(solved.normal)
    }

    /// The blow of a landing; none where nothing rings.
    fn impact(&self, solved: &Solved, closing_m_s: f32) -> Option<Impact> {
        let struck = self.things.iter().position(|thing| thing.body.is_some() && thing.actuator.is_none());
        let struck = struck.or_else(|| self.things.iter().position(|thing| thing.body.is_some()))?;
        let (thing, striker) = (self.things[struck], self.things[1 - struck]);
        let mobility: f32 =
            self.colliders.iter().map(|c| self.view.mobility_per_kg(*c, solved.point_m, solved.normal)).sum();
        let [a, b] = self.colliders.map(|collider| self.view.colliders.get(collider));
        let mut impact = Impact {
            speed_m_s: f64::from(closing_m_s),
            mass_kg: 1.0 / f64::from(mobility).max(1e-4),
            radius_m: radius_m([(self.things[0], a?), (self.things[1], b?)]),
            striker: striker.material,
            restitution: f64::from(solved.restitution).clamp(0.0, 1.0),
            ..Impact::on(thing.body?)
        };
        // A tool in the hand rings as its holder and is felt; any other striker rings beside what it strikes.
        (impact.holder, impact.other) =
            if striker.actuator.is_some() { (striker.body, None) } else { (None, striker.body) };
        impact.actuator = striker.actuator.or(thing.actuator);
        Some(impact)
    }

    /// Radius of the round one that touches the scraped one, m.
    fn roll_radius_m(&self, scraped: usize) -> Option<f64> {
        let [a, b] = self.colliders.map(|collider| self.view.colliders.get(collider));
        let round = [a, b][1 - scraped].is_some_and(is_round);
        Some(radius_m([(self.things[0], a?), (self.things[1], b?)])).filter(|_| round)
    }

    /// Which of the two is scraped: the one with a surface; of two the one that moves less easily.
    fn scraped(&self) -> Option<usize> {
        match self.things.map(|thing| thing.surface.is_some()) {
            [false, false] => None,
            [true, false] => Some(0),
            [false, true] => Some(1),
            [true, true] => {
                // What is in the hand scrapes; of two others the lighter one.
                let [first, second] = self.colliders.map(|collider| {
                    let body = self.view.body_of(collider).filter(|body| body.is_dynamic());
                    body.map_or(f32::INFINITY, |body| body.mass())
                });
                let held = self.things[0].actuator.is_some() && self.things[1].actuator.is_none();
                Some(usize::from(held || (second > first && self.things[1].actuator.is_none())))
            }
        }
    }

    /// Tangential velocities of the other one over the scraped one, after the step: of the place of contact, and of what is there.
    fn velocities(&self, solved: &Solved, scraped: usize) -> (Vector, Vector) {
        let ground = self.view.motion(self.colliders[scraped]);
        let other = self.view.motion(self.colliders[1 - scraped]);
        let along = |v: Vector| v - solved.normal * v.dot(solved.normal);
        let slip = along(other.at(solved.point_m) - ground.at(solved.point_m));
        let round = self.view.colliders.get(self.colliders[1 - scraped]).is_some_and(is_round);
        if !round {
            return (slip, slip);
        }
        let spin = solved.normal * (other.angular_rad_s - ground.angular_rad_s).dot(solved.normal);
        let centre = other.linear_m_s - ground.at(other.centre_m);
        (along(centre + spin.cross(solved.point_m - other.centre_m)), slip)
    }
}
