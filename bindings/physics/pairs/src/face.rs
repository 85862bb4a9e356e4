//! Face with which a thing lies on another: how long its points of contact are along the stroke,
//! and the probe for that length.
//!
//! A crate on one point falls into every joint of a brick floor; its face spans them
//! (`asperity::Probe::face_m`). Each length is a probe of the scene and one more copy of each map,
//! so there are two.

use asperity::{AddError, Probe, ProbeId, Scene, THING_PROBE, thing_with_face};
use glam::Vec3;

/// Lengths of the faces, m: what is shorter than the first touches with a tip, what is longer than
/// one counts as that. **Chosen**: a book or a drawer's runner, and a crate.
pub const FACES_M: [f64; 2] = [0.05, 0.25];
/// Steps after which another face counts: points of contact come and go.
const STEADY_STEPS: u32 = 6;
/// Points of contact that count.
const MOST_POINTS: usize = 16;

/// Points of a contact in space.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Points {
    at_m: [Vec3; MOST_POINTS],
    count: usize,
}

impl Points {
    /// Adds a point, m; of more than sixteen the first count.
    pub fn add(&mut self, at_m: Vec3) {
        if let Some(place) = self.at_m.get_mut(self.count) {
            *place = at_m;
            self.count += 1;
        }
    }

    /// Length along a direction, m; 0 along none.
    #[must_use]
    pub fn length_m(&self, along: Vec3) -> f32 {
        let along = along.normalize_or_zero();
        let places = || self.at_m[..self.count].iter().map(|at_m| at_m.dot(along));
        (places().fold(f32::NEG_INFINITY, f32::max) - places().fold(f32::INFINITY, f32::min)).max(0.0)
    }
}

/// Probes of things that name none: with a tip, and with each of the faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probes {
    /// Toucher with a tip.
    pub tip: ProbeId,
    faces: [ProbeId; FACES_M.len()],
}

impl Probes {
    /// Adds them to a scene, before the surfaces that they are to ride.
    ///
    /// # Errors
    /// When the scene has no place for them.
    pub fn add(scene: &mut Scene) -> Result<Self, AddError> {
        let tip = scene.add_probe(THING_PROBE)?;
        let mut faces = [tip; FACES_M.len()];
        for (face, face_m) in faces.iter_mut().zip(FACES_M) {
            *face = scene.add_probe(thing_with_face(face_m))?;
        }
        Ok(Self { tip, faces })
    }

    /// Tables of a scene file for them, each with a name that begins with `name`.
    pub fn tables(name: &str) -> [(String, Probe); 1 + FACES_M.len()] {
        let face = |m: f64| (format!("{name}, face of {m} m"), thing_with_face(m));
        [(name.to_owned(), THING_PROBE), face(FACES_M[0]), face(FACES_M[1])]
    }

    /// Probes of a scene that has them already, in the order of [`tables`](Self::tables).
    #[must_use]
    pub fn known([tip, short, long]: [ProbeId; 1 + FACES_M.len()]) -> Self {
        Self { tip, faces: [short, long] }
    }

    /// Each of them with a name that begins with `name`, for recordings.
    pub fn named(&self, name: &str) -> impl Iterator<Item = (String, ProbeId)> {
        let names = Self::tables(name).into_iter().map(|(name, _)| name);
        names.zip(std::iter::once(self.tip).chain(self.faces))
    }

    pub(crate) fn of(&self, face: Option<usize>) -> ProbeId {
        face.map_or(self.tip, |face| self.faces[face])
    }
}

/// The face of one pair, from step to step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Face {
    now: Option<usize>,
    other_steps: u32,
}

impl Face {
    /// After a step in which the points were so long along the stroke; true where it has become
    /// another face.
    pub(crate) fn turns(&mut self, length_m: f32, begins: bool) -> bool {
        let long = FACES_M.iter().rposition(|face_m| f64::from(length_m) >= *face_m);
        self.other_steps = if long == self.now { 0 } else { self.other_steps + 1 };
        let turns = long != self.now && (begins || self.other_steps > STEADY_STEPS);
        if turns {
            *self = Self { now: long, other_steps: 0 };
        }
        turns
    }

    /// Its place among [`FACES_M`]; none: a tip.
    pub(crate) fn now(&self) -> Option<usize> {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_on(half_m: [f32; 2]) -> Points {
        let mut points = Points::default();
        for (x, z) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            points.add(Vec3::new(x * half_m[0], 0.0, z * half_m[1]));
        }
        points
    }

    #[test]
    fn a_face_is_as_long_as_its_points_along_the_stroke() {
        let book = box_on([0.1, 0.01]);
        assert!((book.length_m(3.0 * Vec3::X) - 0.2).abs() < 1e-6);
        assert!((book.length_m(Vec3::Z) - 0.02).abs() < 1e-6);
        assert_eq!(Points::default().length_m(Vec3::X), 0.0);
        assert_eq!(book.length_m(Vec3::ZERO), 0.0);
    }

    #[test]
    fn a_crate_that_tips_for_a_step_keeps_its_face() {
        let mut face = Face::default();
        assert!(face.turns(0.4, true) && face.now() == Some(1));
        assert!((0..STEADY_STEPS).all(|_| !face.turns(0.0, false)));
        assert!(!face.turns(0.4, false));
        let turned = (0..=STEADY_STEPS).filter(|_| face.turns(0.1, false)).count();
        assert_eq!((turned, face.now()), (1, Some(0)));
    }
}
