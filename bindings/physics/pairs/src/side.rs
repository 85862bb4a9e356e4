//! One of the two of a pair: what it is to asperity, and how it moves.

use asperity::{BodyId, ChannelId, Material, ProbeId, SurfaceId, UvPlace};
use glam::Vec3;

/// Radius of an edge or a corner that nobody gave one, m: what is broken with sandpaper. Assumed.
pub const EDGE_RADIUS_M: f64 = 0.002;

/// Role of a collider in asperity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thing {
    /// Material.
    pub material: Material,
    /// Body that rings when it is struck or stroked.
    pub body: Option<BodyId>,
    /// Surface that is stroked on it.
    pub surface: Option<SurfaceId>,
    /// The haptic channel that feels it: a finger, or a tool in the hand.
    pub actuator: Option<ChannelId>,
    /// Probe that it touches with; none = a finger is the engine's own probe, anything else a rigid
    /// one.
    pub probe: Option<ProbeId>,
}

impl Thing {
    /// A finger is felt and does not ring: its landings are contacts, not impacts.
    #[must_use]
    pub fn is_finger(&self) -> bool {
        self.actuator.is_some() && self.body.is_none()
    }
}

/// Motion of a rigid body at an instant; zero for what has none.
#[derive(Clone, Copy, Default, Debug, PartialEq)]
pub struct Motion {
    /// Velocity of its centre of mass, m/s.
    pub linear_m_s: Vec3,
    /// rad/s.
    pub angular_rad_s: Vec3,
    /// Centre of mass, m.
    pub centre_m: Vec3,
}

impl Motion {
    /// Velocity of a point of it, m/s.
    #[must_use]
    pub fn at(&self, point_m: Vec3) -> Vec3 {
        self.linear_m_s + self.angular_rad_s.cross(point_m - self.centre_m)
    }
}

/// Data that a physics engine has of one of the two.
pub trait Side {
    /// Role in asperity.
    fn thing(&self) -> Thing;
    /// Motion after the step.
    fn motion(&self) -> Motion;
    /// Mass, kg; infinite for what nothing moves.
    fn mass_kg(&self) -> f32;
    /// Mobility: gain in speed of its point along a direction after an impulse of 1 N·s along it
    /// there, 1/kg: 0 for what nothing moves.
    fn mobility_per_kg(&self, point_m: Vec3, along: Vec3) -> f32;
    /// Radius of curvature with which it rolls on something that it meets at a point with a normal,
    /// m: then its place of contact moves with its centre. None where it does not roll: of a box,
    /// of a cylinder that stands on its end.
    fn rolls_m(&self, point_m: Vec3, normal: Vec3) -> Option<f64>;
    /// Radius of curvature where it strikes, m; none = as it rolls, or an edge.
    fn radius_m(&self) -> Option<f64>;
    /// Axis of what is longer than round, in space, of length 1: of a cylinder, a capsule, a cone.
    fn axis(&self) -> Option<Vec3> {
        None
    }
    /// Velocity of its surface beside its own motion, in space, m/s: a conveyor belt, a track.
    fn belt_m_s(&self) -> Vec3 {
        Vec3::ZERO
    }
    /// A place in the collider's own space, m.
    fn place_m(&self, point_m: Vec3) -> Vec3;
    /// A direction in the collider's own space.
    fn direction(&self, along: Vec3) -> Vec3;
    /// Texture coordinates about a place of its own space, where its surface faces along `outward`.
    fn coordinates(&self, place_m: Vec3, outward: Vec3) -> Option<UvPlace>;
}

/// [`Side::mobility_per_kg`] of a body that moves: 1/m and inverse inertia in space are given as
/// what they do to a vector.
#[must_use]
pub fn mobility_per_kg(
    arm_m: Vec3,
    along: Vec3,
    inverse_mass: impl Fn(Vec3) -> Vec3,
    inverse_inertia: impl Fn(Vec3) -> Vec3,
) -> f32 {
    let turn = arm_m.cross(along);
    along.dot(inverse_mass(along)) + turn.dot(inverse_inertia(turn))
}

/// Radius of curvature with which two things meet, m: of the round ones, where there are any, else
/// of an edge.
#[must_use]
pub fn radius_m(own: [Option<f64>; 2]) -> f64 {
    let curvature: f64 = own.into_iter().flatten().map(|radius_m| 1.0 / radius_m).sum();
    if curvature > 0.0 { 1.0 / curvature } else { EDGE_RADIUS_M }
}

/// |cos| between an axis and a normal up to which what is round about the axis lies on its side.
const ACROSS: f32 = 0.5;

/// Returns whether a body that is round about an axis lies on its side.
#[must_use]
pub fn lies_across(axis: Vec3, normal: Vec3) -> bool {
    axis.dot(normal).abs() < ACROSS
}

/// Radius of a cylinder or a cone where it lies on its side, m: from its axis, through `origin_m`,
/// to the point.
#[must_use]
pub fn axis_radius_m(axis: Vec3, origin_m: Vec3, point_m: Vec3, normal: Vec3) -> Option<f64> {
    let arm_m = point_m - origin_m;
    let radius_m = f64::from((arm_m - axis * arm_m.dot(axis)).length());
    (lies_across(axis, normal) && radius_m > 0.0).then_some(radius_m.max(EDGE_RADIUS_M))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_balls_meet_with_half_their_radius() {
        assert_eq!(radius_m([Some(0.03), Some(0.03)]), 0.015);
        assert_eq!(radius_m([None, Some(0.03)]), 0.03);
        assert_eq!(radius_m([None, None]), EDGE_RADIUS_M);
    }

    #[test]
    fn a_barrel_on_its_side_has_its_radius_and_on_end_none() {
        let radius_m = |normal| axis_radius_m(Vec3::X, Vec3::ZERO, Vec3::new(0.4, -0.3, 0.0), normal);
        assert!((radius_m(Vec3::Y).unwrap() - 0.3).abs() < 1e-7);
        assert_eq!(radius_m(Vec3::X), None);
    }

    #[test]
    fn a_rod_struck_at_its_end_moves_as_a_quarter_mass() {
        // 1 kg, 1 m: I = 1/12 about its centre, across.
        let mobility = mobility_per_kg(Vec3::new(0.5, 0.0, 0.0), Vec3::Y, |v| v, |turn| turn * 12.0);
        assert!((mobility - 4.0).abs() < 1e-6, "{mobility}");
    }
}
