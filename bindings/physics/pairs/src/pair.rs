//! One pair of colliders over time: it lands, slides or rolls, rests, and leaves.

use crate::face::Face;
use crate::step::{QUIET_LANDING_M_S, Solved, Step};
use asperity::surface::triplanar::TriplanarPath;
use asperity::{ContactEvent, ContactId, ContactSample, SurfaceId, Touching, UvPlace};
use glam::Vec3;

/// A place of contact that moves slower rests, m/s.
const REST_M_S: f32 = 0.002;
/// Steps of rest after which a contact ends.
const REST_STEPS: u32 = 6;
/// Share by which the integrated place is pulled to the reported one in each step.
const PULL: f32 = 0.3;
/// Beyond this the reported place is right, m.
const TELEPORT_M: f32 = 0.01;
/// Share of its path by which the slip of what turns differs from it.
const TURNS: f32 = 1e-3;
/// A pair whose slip is below this share of its path rolls.
const ROLLING: f32 = 0.3;

/// Activity of a pair.
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

/// Activity of a touching pair in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doing {
    /// Activity.
    pub kind: Kind,
    /// The contact that is reported; none while it rests, or where nothing can be scraped.
    pub contact: Option<ContactId>,
    /// Speed at which the place of contact moves over the surface, m/s.
    pub path_m_s: f32,
    /// Speed at which the two slide on each other there, m/s.
    pub slip_m_s: f32,
    /// Force between them, mean of the step, N.
    pub force_n: f32,
    /// The one of the two that has a surface but no texture coordinates where it is touched:
    /// nothing can be heard of it.
    pub unplaced: Option<usize>,
}

/// A pair that the physics engine lists, from step to step.
#[derive(Debug, Default)]
pub struct Pair {
    doing: Option<Doing>,
    contact: Option<ContactId>,
    /// Place of contact in the space of the scraped collider.
    local_m: Option<Vec3>,
    /// Distance that the scraped one's own surface has run since the contact began, in its space.
    run_m: Vec3,
    /// The plane that it is mapped on by its normal, kept until another is clearly nearer.
    path: Option<TriplanarPath>,
    unplaced: Option<usize>,
    resting_steps: u32,
    face: Face,
}

impl Pair {
    /// Activity in the last step; none: it did not touch.
    #[must_use]
    pub fn doing(&self) -> Option<Doing> {
        self.doing
    }

    /// After a step in which the pair was listed. A new contact is called `next_contact`, which
    /// grows by it.
    pub fn advance(&mut self, step: &Step<'_>, next_contact: &mut u64, events: &mut Vec<ContactEvent>) {
        let Some(solved) = step.solved else { return self.leave(events) };
        let landed = self.doing.is_none();
        let closing_m_s = if landed { solved.closing_m_s } else { 0.0 };
        let felt_landing = step.sides.iter().any(|side| side.thing().is_finger());
        // What only a hand's own force presses is not thrown.
        let strikes = closing_m_s > QUIET_LANDING_M_S && !felt_landing && !solved.is_nominal;
        if strikes && let Some(impact) = step.impact(&solved) {
            events.push(ContactEvent::Impact(impact));
        }
        let scraped = step.scraped();
        let solved = step.in_the_middle(solved, scraped.unwrap_or(0));
        let (path, slip) = step.velocities(&solved, scraped.unwrap_or(0));
        let kind = match (path.length(), slip.length()) {
            (path, slip) if path.max(slip) < REST_M_S => Kind::Rests,
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
            unplaced: self.unplaced,
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
        let rests = path.length().max(slip.length()) < REST_M_S && toucher.actuator.is_none();
        self.resting_steps = if rests { self.resting_steps + 1 } else { 0 };
        if self.resting_steps > REST_STEPS || (rests && self.contact.is_none()) {
            self.unplaced = None;
            return self.end(events);
        }
        let placed = self.sample(step, solved, scraped, path);
        self.unplaced = placed.is_none().then_some(scraped);
        let Some((mut sample, surface)) = placed else { return self.end(events) };
        // What is not round, or does not turn, slides as fast as it moves.
        let slides = path.distance(slip) <= TURNS * path.length();
        if let Some(radius_m) = step.roll_radius_m(solved, scraped).filter(|_| !slides) {
            sample = sample.rolling(radius_m).slipping(f64::from(slip.length()));
        }
        // One that rests keeps the face that it slid with.
        let length_m = step.face_m(solved, scraped, path);
        let turns = path.length() >= REST_M_S && self.face.turns(length_m, self.contact.is_none());
        if turns && toucher.probe.is_none() && !toucher.is_finger() {
            // A probe is a contact's for its whole life; the one goes as the other comes.
            events.extend(self.contact.take().map(ContactEvent::end));
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
        touching.probe = toucher.probe.or((!toucher.is_finger()).then_some(step.probes.of(self.face.now())));
        (touching.holder, touching.actuator) = (toucher.body, toucher.actuator);
        let sample = ContactSample { closing_m_s: f64::from(closing_m_s.max(0.0)), ..sample };
        events.push(ContactEvent::begin_with(contact, touching, sample));
    }

    /// Place and manner of the pair's touch, on the surface of the scraped one.
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
        // What lies on a belt stands still on its surface.
        let told_m = side.place_m(solved.point_m) - self.run_m;
        self.run_m += side.direction(side.belt_m_s()) * step.step_s;
        let local_m = self.follow(told_m, local_path * step.step_s);
        let force_n = f64::from(solved.impulse_n_s / step.step_s);
        let outward = side.direction(solved.normal * if scraped == 0 { 1.0 } else { -1.0 });
        let sample = self.on(side.coordinates(local_m, outward)?, local_m, local_path, outward, force_n)?;
        Some((sample, surface))
    }

    /// A place in the scraped one's space on its surface.
    fn on(
        &mut self,
        place: UvPlace,
        local_m: Vec3,
        along: Vec3,
        outward: Vec3,
        force_n: f64,
    ) -> Option<ContactSample> {
        match place {
            UvPlace::Triangle(triangle) => {
                self.path = None;
                Some(triangle.sample(local_m.to_array(), along.to_array(), force_n))
            }
            UvPlace::ByNormal { span_m } => {
                if self.path.is_none() {
                    self.path = TriplanarPath::new(span_m).ok();
                }
                let [place, along, outward] = [local_m, along, outward].map(|v| v.to_array().map(f64::from));
                let point = self.path.as_mut()?.at(place, along, outward);
                Some(ContactSample::new(point.uv, force_n).sliding(point.velocity_m_s))
            }
        }
    }

    /// The path is integrated and pulled gently to where the solver says, because its point belongs
    /// to the start of the step and jumps as points come and go.
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
        (self.local_m, self.path, self.run_m) = (None, None, Vec3::ZERO);
        if let Some(contact) = self.contact.take() {
            events.push(ContactEvent::end(contact));
        }
    }

    /// Nothing presses any more, or the physics engine does not list it any more.
    pub fn leave(&mut self, events: &mut Vec<ContactEvent>) {
        self.end(events);
        (self.doing, self.unplaced) = (None, None);
        self.resting_steps = 0;
    }
}
