//! Mechanics of a pair's step: which side is scraped, how fast, and the blow of a landing.

use crate::face::{Points, Probes};
use crate::side::{Side, radius_m};
use asperity::Impact;
use glam::Vec3;

/// Slower landings are rest, not impacts, m/s.
pub(crate) const QUIET_LANDING_M_S: f32 = 0.02;
/// The least mobility that a blow is reckoned with, 1/kg: a blow between two things that nothing
/// moves is one of 10 t.
const LEAST_MOBILITY_PER_KG: f64 = 1e-4;
/// |cos| between an axis and a normal below which what is long and round touches along a line, not with an end.
const LINE: f32 = 0.05;
/// Force of a hand or a character whom the physics engine lets press with none, because neither is
/// moved by the other, N. Assumed: a finger that strokes.
pub const NOMINAL_FORCE_N: f32 = 1.0;

/// A contact as the solver left it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Place, in space, m: the mean of its points, weighted by their impulses.
    pub point_m: Vec3,
    /// Unit vector from the first collider to the second.
    pub normal: Vec3,
    /// Along the normal, over the whole step, N·s.
    pub impulse_n_s: f32,
    /// Rebound over approach speed, 0 to 1.
    pub restitution: f32,
    /// Approach speed there as the solver met it, m/s; 0 where only gravity's share of the step
    /// brings the two together, as it does to all that rests.
    pub closing_m_s: f32,
    /// Set where the force is a nominal one, of two that the engine lets pass through each other: a
    /// hand on fixed ground.
    pub is_nominal: bool,
    /// Its points, in space.
    pub points: Points,
}

/// Input of a pair's step.
pub struct Step<'a> {
    /// The two, in the physics engine's order.
    pub sides: [&'a dyn Side; 2],
    /// Their contact; none: nothing presses.
    pub solved: Option<Solved>,
    /// Probes of things that name none.
    pub probes: Probes,
    /// Length of the step, s.
    pub step_s: f32,
}

impl Solved {
    /// The closing speed of two that moved like this before the step, of which gravity has
    /// `gained_m_s` by itself in it.
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
    pub(crate) fn impact(&self, solved: &Solved) -> Option<Impact> {
        let things = self.sides.map(Side::thing);
        let struck = things.iter().position(|thing| thing.body.is_some() && thing.actuator.is_none());
        let struck = struck.or_else(|| things.iter().position(|thing| thing.body.is_some()))?;
        let (thing, striker) = (things[struck], things[1 - struck]);
        let mobility: f32 =
            self.sides.iter().map(|side| side.mobility_per_kg(solved.point_m, solved.normal)).sum();
        let mut impact = Impact {
            speed_m_s: f64::from(solved.closing_m_s),
            mass_kg: 1.0 / f64::from(mobility).max(LEAST_MOBILITY_PER_KG),
            radius_m: self.radius_m(solved),
            // Where the body lies in its collider's space: of a body whose modes have shapes.
            at_m: Some(self.sides[struck].place_m(solved.point_m).to_array().map(f64::from)),
            striker: striker.material,
            restitution: f64::from(solved.restitution).clamp(0.0, 1.0),
            ..Impact::on(thing.body?)
        };
        // A tool in the hand rings as its holder and is felt; any other striker rings beside what
        // it strikes.
        (impact.holder, impact.other) =
            if striker.actuator.is_some() { (striker.body, None) } else { (None, striker.body) };
        impact.actuator = striker.actuator.or(thing.actuator);
        Some(impact)
    }

    /// Radius of curvature with which the two meet, m.
    fn radius_m(&self, solved: &Solved) -> f64 {
        radius_m(
            self.sides.map(|side| side.radius_m().or_else(|| side.rolls_m(solved.point_m, solved.normal))),
        )
    }

    /// Radius of curvature where the side that touches the scraped one rolls, m; none where it does
    /// not.
    pub(crate) fn roll_radius_m(&self, solved: &Solved, scraped: usize) -> Option<f64> {
        self.sides[1 - scraped].rolls_m(solved.point_m, solved.normal)?;
        Some(self.radius_m(solved))
    }

    /// Length of the face with which the other one slides, m; 0 where it rolls.
    pub(crate) fn face_m(&self, solved: &Solved, scraped: usize, path: Vec3) -> f32 {
        let rolls = self.sides[1 - scraped].rolls_m(solved.point_m, solved.normal).is_some();
        if rolls { 0.0 } else { solved.points.length_m(path) }
    }

    /// The contact of what lies on its side in its middle: along the line the solver's point hops
    /// by centimetres from step to step.
    pub(crate) fn in_the_middle(&self, solved: Solved, scraped: usize) -> Solved {
        let other = self.sides[1 - scraped];
        match other.axis() {
            Some(axis) if axis.dot(solved.normal).abs() < LINE => {
                let along_m = (solved.point_m - other.motion().centre_m).dot(axis);
                Solved { point_m: solved.point_m - axis * along_m, ..solved }
            }
            _ => solved,
        }
    }

    /// Which of the two is scraped: the one with a surface; of two the one that moves less easily.
    pub(crate) fn scraped(&self) -> Option<usize> {
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

    /// Tangential velocities of the other one over the scraped one, after the step: of the place of
    /// contact, and of what is there.
    pub(crate) fn velocities(&self, solved: &Solved, scraped: usize) -> (Vec3, Vec3) {
        let [ground, other] = [self.sides[scraped].motion(), self.sides[1 - scraped].motion()];
        let along = |v: Vec3| v - solved.normal * v.dot(solved.normal);
        let [run, own_run] = [self.sides[scraped].belt_m_s(), self.sides[1 - scraped].belt_m_s()];
        let slip = along(other.at(solved.point_m) + own_run - ground.at(solved.point_m) - run);
        if self.sides[1 - scraped].rolls_m(solved.point_m, solved.normal).is_none() {
            return (slip, slip);
        }
        let spin = solved.normal * (other.angular_rad_s - ground.angular_rad_s).dot(solved.normal);
        let centre = other.linear_m_s - ground.at(other.centre_m) - run;
        (along(centre + spin.cross(solved.point_m - other.centre_m)), slip)
    }
}

impl std::fmt::Debug for Step<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Step").finish_non_exhaustive()
    }
}
