//! Delaunay tetrahedralisation of points: no other point lies in the sphere around a tetrahedron.
//!
//! Points are put in one after the other; the tetrahedra whose spheres hold the new one are taken
//! out and the hole is filled from it (Bowyer 1981, Watson 1981). The signs that decide are exact
//! (Shewchuk 1997, through the crate `robust`).

use crate::vector::{Vec3, bounds, distance, longest_side};
use robust::{Coord3D, insphere, orient3d};
use std::collections::HashMap;

const NONE: u32 = u32::MAX;
/// Corners of the tetrahedron that holds all points; they come before the points.
const OUTER: usize = 4;

/// Tetrahedra over points, which more can be put into.
pub struct Delaunay {
    points: Vec<Vec3>,
    tets: Vec<[u32; 4]>,
    /// The neighbour opposite each corner.
    across: Vec<[u32; 4]>,
    alive: Vec<bool>,
    free: Vec<u32>,
    last: u32,
    smallest: f64,
}

/// Cavity of a new point: tetrahedra, and the faces around them with what lies beyond each.
struct Hole {
    inside: Vec<u32>,
    faces: Vec<([u32; 3], u32)>,
}

fn coord(p: Vec3) -> Coord3D<f64> {
    Coord3D { x: p[0], y: p[1], z: p[2] }
}

/// The faces of a tetrahedron of positive orientation, each so that the corner it faces lies on its
/// positive side.
const FACES: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

impl Delaunay {
    /// One huge tetrahedron around the box of some points.
    #[must_use]
    pub fn around(points: &[Vec3]) -> Self {
        let side = longest_side(points).max(f64::MIN_POSITIVE);
        let (low, high) = bounds(points).unwrap_or(([0.0; 3], [1.0; 3]));
        let centre: Vec3 = std::array::from_fn(|c| 0.5 * (low[c] + high[c]));
        let far = 200.0 * side;
        let at = |x: f64, y: f64, z: f64| [centre[0] + far * x, centre[1] + far * y, centre[2] + far * z];
        let outer = vec![at(1.0, 1.0, 1.1), at(-1.0, 1.0, -1.0), at(1.0, -1.05, -1.0), at(-1.0, -1.0, 1.0)];
        let mut first = [0, 1, 2, 3];
        if orient3d(coord(outer[0]), coord(outer[1]), coord(outer[2]), coord(outer[3])) < 0.0 {
            first.swap(0, 1);
        }
        Self {
            points: outer,
            tets: vec![first],
            across: vec![[NONE; 4]],
            alive: vec![true],
            free: Vec::new(),
            last: 0,
            smallest: 1e-9 * side,
        }
    }

    fn orient(&self, face: [u32; 3], p: Vec3) -> f64 {
        let [a, b, c] = face.map(|i| coord(self.points[i as usize]));
        orient3d(a, b, c, coord(p))
    }

    fn in_sphere(&self, tet: u32, p: Vec3) -> bool {
        let [a, b, c, d] = self.tets[tet as usize].map(|i| coord(self.points[i as usize]));
        insphere(a, b, c, d, coord(p)) > 0.0
    }

    /// The tetrahedron that holds a place.
    fn locate(&self, p: Vec3) -> u32 {
        let mut tet = self.last;
        for turn in 0..4 * self.tets.len() + 16 {
            let next = (0..4).map(|i| (i + turn) % 4).find_map(|i| {
                let face = FACES[i].map(|k| self.tets[tet as usize][k]);
                let beyond = self.orient(face, p) < 0.0;
                (beyond && self.across[tet as usize][i] != NONE).then(|| self.across[tet as usize][i])
            });
            match next {
                Some(next) => tet = next,
                None => return tet,
            }
        }
        tet
    }

    /// Puts a point in and gives its number; none when another is already there.
    pub fn insert(&mut self, p: Vec3) -> Option<u32> {
        let start = self.locate(p);
        let near = |i: u32| distance(self.points[i as usize], p) < self.smallest;
        if self.tets[start as usize].iter().any(|&i| near(i)) {
            return None;
        }
        let hole = self.hole(start, p)?;
        let number = self.points.len() as u32;
        self.points.push(p);
        self.fill(&hole, number);
        Some(number - OUTER as u32)
    }

    /// The tetrahedra to take out, and the faces around them as (corners, what lies beyond).
    fn hole(&self, start: u32, p: Vec3) -> Option<Hole> {
        let mut inside = vec![start];
        let mut is_inside: std::collections::HashSet<u32> = [start].into();
        let mut next = 0;
        loop {
            while next < inside.len() {
                for beyond in self.across[inside[next] as usize] {
                    if beyond != NONE && !is_inside.contains(&beyond) && self.in_sphere(beyond, p) {
                        is_inside.insert(beyond);
                        inside.push(beyond);
                    }
                }
                next += 1;
            }
            // Every face must be seen from the point; where one is edge-on, what lies behind it
            // goes as well.
            let mut faces = Vec::new();
            let mut grown = false;
            for &tet in &inside.clone() {
                for (corners, &beyond) in FACES.iter().zip(&self.across[tet as usize]) {
                    if beyond != NONE && is_inside.contains(&beyond) {
                        continue;
                    }
                    let face = corners.map(|k| self.tets[tet as usize][k]);
                    if self.orient(face, p) > 0.0 {
                        faces.push((face, beyond));
                    } else if beyond == NONE {
                        return None;
                    } else if is_inside.insert(beyond) {
                        inside.push(beyond);
                        grown = true;
                    }
                }
            }
            if !grown {
                return Some(Hole { inside, faces });
            }
        }
    }

    fn fill(&mut self, Hole { inside, faces }: &Hole, number: u32) {
        for &tet in inside {
            self.alive[tet as usize] = false;
            self.free.push(tet);
        }
        let mut open: HashMap<[u32; 2], (u32, usize)> = HashMap::with_capacity(faces.len() * 2);
        for &(face, beyond) in faces {
            let tet = self.free.pop().unwrap_or_else(|| {
                self.tets.push([0; 4]);
                self.across.push([NONE; 4]);
                self.alive.push(false);
                self.tets.len() as u32 - 1
            });
            let t = tet as usize;
            self.alive[t] = true;
            self.tets[t] = [face[0], face[1], face[2], number];
            self.across[t] = [NONE, NONE, NONE, beyond];
            if beyond != NONE {
                let b = beyond as usize;
                let mine = (0..4).find(|&i| !face.contains(&self.tets[b][i]));
                if let Some(i) = mine {
                    self.across[b][i] = tet;
                }
            }
            for i in 0..3 {
                let (a, b) = (face[(i + 1) % 3], face[(i + 2) % 3]);
                if let Some((other, j)) = open.remove(&[a.min(b), a.max(b)]) {
                    self.across[t][i] = other;
                    self.across[other as usize][j] = tet;
                } else {
                    open.insert([a.min(b), a.max(b)], (tet, i));
                }
            }
            self.last = tet;
        }
    }

    /// The tetrahedra between points alone, right-handed.
    #[must_use]
    pub fn tets(&self) -> Vec<[u32; 4]> {
        let outer = OUTER as u32;
        (0..self.tets.len())
            .filter(|&t| self.alive[t] && self.tets[t].iter().all(|&i| i >= outer))
            .map(|t| {
                let [a, b, c, d] = self.tets[t].map(|i| i - outer);
                // Positive for the predicate is left-handed here.
                [b, a, c, d]
            })
            .collect()
    }

    /// The points in the order they were put in.
    #[must_use]
    pub fn points(&self) -> &[Vec3] {
        &self.points[OUTER..]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume_mesh::tet_volume_m3;

    #[test]
    fn a_grid_of_points_is_filled_exactly_despite_shared_spheres() {
        let mut points = Vec::new();
        for i in 0..5 {
            for j in 0..4 {
                for k in 0..3 {
                    points.push([f64::from(i) * 0.1, f64::from(j) * 0.1, f64::from(k) * 0.1]);
                }
            }
        }
        let mut mesh = Delaunay::around(&points);
        for &p in &points {
            assert!(mesh.insert(p).is_some());
        }
        assert!(mesh.insert(points[7]).is_none());
        let volumes: Vec<f64> =
            mesh.tets().iter().map(|t| tet_volume_m3(t.map(|i| mesh.points()[i as usize]))).collect();
        assert!(volumes.iter().all(|&v| v > 0.0));
        assert!((volumes.iter().sum::<f64>() - 0.4 * 0.3 * 0.2).abs() < 1e-15);
    }

    #[test]
    fn no_point_lies_in_the_sphere_of_a_tetrahedron() {
        let mut seed = 7_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        let points: Vec<Vec3> = (0..200).map(|_| std::array::from_fn(|_| random())).collect();
        let mut mesh = Delaunay::around(&points);
        points.iter().for_each(|&p| assert!(mesh.insert(p).is_some()));
        for tet in mesh.tets() {
            let [a, b, c, d] = tet.map(|i| coord(points[i as usize]));
            assert!(orient3d(a, b, c, d) < 0.0);
            assert!(points.iter().all(|&p| insphere(b, a, c, d, coord(p)) <= 0.0));
        }
    }
}
