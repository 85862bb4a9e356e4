//! One pair of colliders over time: it lands, slides or rolls, rests, and leaves.

use crate::side::{Side, radius_m};
use asperity::{ContactEvent, ContactId, ContactSample, Impact, ProbeId, SurfaceId, Touching};
use glam::Vec3;

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
/// The least mobility that a blow is reckoned with, 1/kg: a blow between two things that nothing moves is one of 10 t.
const LEAST_MOBILITY_PER_KG: f64 = 1e-4;

/// What a pair does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// It touches, and its place of contact stands still.
    Rests,
    /// It slides.
    Scrapes,
    /// Its place of contact moves, and what is there does not slide.
    Rolls,
}

/// What a pair that touches does in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doing {
    /// What it does.
    pub kind: Kind,
    /// The contact that is reported; none while it rests, or where nothing can be scraped.
    pub contact: Option<ContactId>,
    /// Speed at which the place of contact moves over the surface, m/s.
    pub path_m_s: f32,
    /// Speed at which the two slide on each other there, m/s.
    pub slip_m_s: f32,
    /// Force between them, mean of the step, N.
    pub force_n: f32,
}

/// A contact as the solver left it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Where, in space, m: the mean of its points, weighted by their impulses.
    pub point_m: Vec3,
    /// Of length 1, from the first collider to the second.
    pub normal: Vec3,
    /// Along the normal, over the whole step, N·s.
    pub impulse_n_s: f32,
    /// Rebound over approach speed, 0 to 1.
    pub restitution: f32,
    /// Approach speed there as the solver met it, m/s; 0 where only gravity's share of the step brings the two together, as it does to all
    /// that rests.
    pub closing_m_s: f32,
}

/// What a pair needs to know of a step.
pub struct Step<'a> {
    /// The two, in the physics engine's order.
    pub sides: [&'a dyn Side; 2],
    /// Their contact; none: nothing presses.
    pub solved: Option<Solved>,
    /// What things touch with that do not say otherwise.
    pub rigid: ProbeId,
    /// Length of the step, s.
    pub step_s: f32,
}

/// A pair that the physics engine lists, from step to step.
#[derive(Debug, Default)]
pub struct Pair {
    doing: Option<Doing>,
    contact: Option<ContactId>,
    /// Place of contact in the space of the scraped collider.
    local_m: Option<Vec3>,
    resting_steps: u32,
}

impl Pair {
    /// What it did in the last step; none: it did not touch.
    #[must_use]
    pub fn doing(&self) -> Option<Doing> {
        self.doing
    }

    /// After a step in which the pair was listed. A new contact is called `next_contact`, which grows by it.
    pub fn advance(&mut self, step: &Step<'_>, next_contact: &mut u64, events: &mut Vec<ContactEvent>) {
        let Some(solved) = step.solved else { return self.leave(events) };
        let landed = self.doing.is_none();
        let closing_m_s = if landed { solved.closing_m_s } else { 0.0 };
        let felt_landing = step.sides.iter().any(|side| side.thing().is_finger());
        let strikes = closing_m_s > QUIET_LANDING_M_S && !felt_landing;
        if strikes && let Some(impact) = step.impact(&solved) {
            events.push(ContactEvent::Impact(impact));
        }
        let scraped = step.scraped();
        let (path, slip) = step.velocities(&solved, scraped.unwrap_or(0));
        let kind = match (path.length(), slip.length()) {
            (path, _) if path < REST_M_S => Kind::Rests,
            (path, slip) if slip < ROLLING * path => Kind::Rolls,
            _ => Kind::Scrapes,
        };
        // What has just struck leaves again, or slides from the next step on.
        if let Some(scraped) = scraped.filter(|_| !strikes) {
            self.slide(step, &solved, (scraped, path, slip, closing_m_s), next_contact, events);
        }
        self.doing = Some(Doing {
            kind,
            contact: self.contact,
            path_m_s: path.length(),
            slip_m_s: slip.length(),
            force_n: solved.impulse_n_s / step.step_s,
        });
    }

    /// Begins, moves or ends the contact of a pair that touches.
    fn slide(
        &mut self,
        step: &Step<'_>,
        solved: &Solved,
        (scraped, path, slip, closing_m_s): (usize, Vec3, Vec3, f32),
        next_contact: &mut u64,
        events: &mut Vec<ContactEvent>,
    ) {
        let toucher = step.sides[1 - scraped].thing();
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
        path: Vec3,
    ) -> Option<(ContactSample, SurfaceId)> {
        let side = step.sides[scraped];
        let surface = side.thing().surface?;
        let local_path = side.direction(path);
        let local_m = self.follow(side.place_m(solved.point_m), local_path * step.step_s);
        let triangle = side.triangle(local_m)?;
        let force_n = f64::from(solved.impulse_n_s / step.step_s);
        Some((triangle.sample(local_m.to_array(), local_path.to_array(), force_n), surface))
    }

    /// The path is integrated and pulled gently to where the solver says, because its point belongs to the start of the step and jumps as
    /// points come and go.
    fn follow(&mut self, told_m: Vec3, moved_m: Vec3) -> Vec3 {
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

    /// Nothing presses any more, or the physics engine does not list it any more.
    pub fn leave(&mut self, events: &mut Vec<ContactEvent>) {
        self.end(events);
        self.doing = None;
        self.resting_steps = 0;
    }
}

impl Solved {
    /// The closing speed of two that moved like this before the step, of which gravity has `gained_m_s` by itself in it.
    #[must_use]
    pub fn closing_m_s(
        before: [crate::Motion; 2],
        gained_m_s: [Vec3; 2],
        point_m: Vec3,
        normal: Vec3,
    ) -> f32 {
        let [first, second] = before.map(|motion| motion.at(point_m));
        let approach = (first - second).dot(normal);
        if approach <= QUIET_LANDING_M_S {
            return 0.0;
        }
        approach + (gained_m_s[0] - gained_m_s[1]).dot(normal)
    }
}

impl Step<'_> {
    /// The blow of a landing; none where nothing rings.
    fn impact(&self, solved: &Solved) -> Option<Impact> {
        let things = self.sides.map(Side::thing);
        let struck = things.iter().position(|thing| thing.body.is_some() && thing.actuator.is_none());
        let struck = struck.or_else(|| things.iter().position(|thing| thing.body.is_some()))?;
        let (thing, striker) = (things[struck], things[1 - struck]);
        let mobility: f32 =
            self.sides.iter().map(|side| side.mobility_per_kg(solved.point_m, solved.normal)).sum();
        let mut impact = Impact {
            speed_m_s: f64::from(solved.closing_m_s),
            mass_kg: 1.0 / f64::from(mobility).max(LEAST_MOBILITY_PER_KG),
            radius_m: radius_m(self.sides.map(Side::radius_m)),
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
        let radius_m = radius_m(self.sides.map(Side::radius_m));
        self.sides[1 - scraped].is_round().then_some(radius_m)
    }

    /// Which of the two is scraped: the one with a surface; of two the one that moves less easily.
    fn scraped(&self) -> Option<usize> {
        let things = self.sides.map(Side::thing);
        match things.map(|thing| thing.surface.is_some()) {
            [false, false] => None,
            [true, false] => Some(0),
            [false, true] => Some(1),
            [true, true] => {
                // What is in the hand scrapes; of two others the lighter one.
                let [first, second] = self.sides.map(Side::mass_kg);
                let held = things[0].actuator.is_some() && things[1].actuator.is_none();
                Some(usize::from(held || (second > first && things[1].actuator.is_none())))
            }
        }
    }

    /// Tangential velocities of the other one over the scraped one, after the step: of the place of contact, and of what is there.
    fn velocities(&self, solved: &Solved, scraped: usize) -> (Vec3, Vec3) {
        let [ground, other] = [self.sides[scraped].motion(), self.sides[1 - scraped].motion()];
        let along = |v: Vec3| v - solved.normal * v.dot(solved.normal);
        let slip = along(other.at(solved.point_m) - ground.at(solved.point_m));
        if !self.sides[1 - scraped].is_round() {
            return (slip, slip);
        }
        let spin = solved.normal * (other.angular_rad_s - ground.angular_rad_s).dot(solved.normal);
        let centre = other.linear_m_s - ground.at(other.centre_m);
        (along(centre + spin.cross(solved.point_m - other.centre_m)), slip)
    }
}
