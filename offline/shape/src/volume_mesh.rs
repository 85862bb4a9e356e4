//! A body cut into tetrahedra, and the checks that make it one body.

use crate::error::ShapeError;
use crate::vector::{Vec3, cross, dot, longest_side, sub};
use rustc_hash::FxHashMap;
use std::collections::HashMap;

/// Most unknowns that are solved for; chunky bodies end sooner, by their factor's numbers.
pub const MOST_DEGREES_OF_FREEDOM: usize = 150_000;
/// Longest side accepted, m.
pub const LONGEST_SIDE_M: f64 = 1e4;
/// Shortest side accepted, m.
pub const SHORTEST_SIDE_M: f64 = 1e-5;

/// Corner points and the four corners of each tetrahedron, right-handed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VolumeMesh {
    /// Corners, m.
    pub points: Vec<Vec3>,
    /// Indices of four corners each; the volume is positive.
    pub tets: Vec<[u32; 4]>,
}

/// The triangles of a tetrahedron, each seen from outside anticlockwise.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
/// The edges of a tetrahedron in the order of its mid-edge nodes.
pub const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Volume of a tetrahedron, m³; negative when it is left-handed.
#[must_use]
pub fn tet_volume_m3([a, b, c, d]: [Vec3; 4]) -> f64 {
    dot(cross(sub(b, a), sub(c, a)), sub(d, a)) / 6.0
}

impl VolumeMesh {
    /// The corners of a tetrahedron.
    #[must_use]
    pub fn corners(&self, tet: [u32; 4]) -> [Vec3; 4] {
        tet.map(|i| self.points[i as usize])
    }

    /// Volume, m³.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        self.tets.iter().map(|&t| tet_volume_m3(self.corners(t))).sum()
    }

    /// Triangles with one tetrahedron behind them, seen from outside anticlockwise.
    #[must_use]
    pub fn boundary(&self) -> Vec<[u32; 3]> {
        let mut seen: HashMap<[u32; 3], (u32, [u32; 3])> = HashMap::with_capacity(self.tets.len() * 3);
        for tet in &self.tets {
            for face in FACES {
                let face = face.map(|i| tet[i]);
                seen.entry(sorted(face)).or_insert((0, face)).0 += 1;
            }
        }
        let mut faces: Vec<_> = seen.into_values().filter(|(n, _)| *n == 1).map(|(_, f)| f).collect();
        faces.sort_unstable();
        faces
    }

    /// Turns what a mesher wrote into a body: points at the same place become one, left-handed
    /// tetrahedra are turned, flat ones left out; each is reported. What has two parts, overlaps
    /// itself or is too large is refused.
    ///
    /// # Errors
    /// When no body is left, it has several parts, three tetrahedra share a face, a number is not
    /// finite, or it has more than [`MOST_DEGREES_OF_FREEDOM`] unknowns.
    pub fn checked(mut self, remarks: &mut Vec<String>) -> Result<Self, ShapeError> {
        let refuse = |what: String, right: &str| Err(ShapeError::new("", what, right));
        if self.points.iter().flatten().any(|x| !x.is_finite()) {
            return refuse("a coordinate is not a number".into(), "must be finite metres");
        }
        if self.tets.is_empty() {
            return refuse("has no tetrahedron".into(), "give a volume mesh, or the surface of a body");
        }
        self.merge_points(remarks);
        let side = longest_side(&self.points);
        check_side(side)?;
        self.orient(side, remarks)?;
        self.refuse_overlaps()?;
        let parts = self.parts();
        if parts > 1 {
            return refuse(
                format!("has {parts} separate parts"),
                "a body has one: name one with --part, or give each a file of its own",
            );
        }
        let unknowns = degrees_of_freedom(&self.tets);
        if unknowns > MOST_DEGREES_OF_FREEDOM {
            return refuse(
                format!("has {unknowns} unknowns"),
                &format!("at most {MOST_DEGREES_OF_FREEDOM}: mesh it coarser"),
            );
        }
        Ok(self)
    }

    /// Joins points at the same place and drops those no tetrahedron uses.
    fn merge_points(&mut self, remarks: &mut Vec<String>) {
        let mut at: HashMap<[u64; 3], u32> = HashMap::new();
        let mut points = Vec::new();
        let mut used = vec![false; self.points.len()];
        self.tets.iter().flatten().for_each(|&i| used[i as usize] = true);
        let mut joined = 0;
        let mut moved = vec![0_u32; self.points.len()];
        for (i, point) in self.points.iter().enumerate().filter(|(i, _)| used[*i]) {
            // Adding 0 makes −0 the same place as 0.
            let next = points.len() as u32;
            let index = *at.entry(point.map(|x| (x + 0.0).to_bits())).or_insert(next);
            if index == next {
                points.push(*point);
            } else {
                joined += 1;
            }
            moved[i] = index;
        }
        self.tets.iter_mut().flatten().for_each(|i| *i = moved[*i as usize]);
        self.points = points;
        if joined > 0 {
            remarks.push(format!("{joined} points lay on others and were joined with them"));
        }
    }

    fn orient(&mut self, side: f64, remarks: &mut Vec<String>) -> Result<(), ShapeError> {
        let before = self.tets.len();
        let points = &self.points;
        let volume = |t: &[u32; 4]| tet_volume_m3(t.map(|i| points[i as usize]));
        let flat_m3 = 1e-15 * side.powi(3);
        self.tets.retain(|t| volume(t).abs() > flat_m3);
        let flat = before - self.tets.len();
        if self.tets.is_empty() {
            return Err(ShapeError::new("", "every tetrahedron is flat", "must enclose a volume"));
        }
        if flat * 100 > before {
            let what = format!("{flat} of {before} tetrahedra are flat");
            return Err(ShapeError::new("", what, "at most one in a hundred may be: mesh it anew"));
        }
        let turned: Vec<usize> = (0..self.tets.len()).filter(|&i| volume(&self.tets[i]) < 0.0).collect();
        let all = self.tets.len();
        for &i in &turned {
            self.tets[i].swap(2, 3);
        }
        if flat > 0 {
            remarks.push(format!("{flat} flat tetrahedra were left out"));
        }
        if !turned.is_empty() && turned.len() < all {
            remarks.push(format!("{} of {all} tetrahedra were inside out and were turned", turned.len()));
        }
        Ok(())
    }

    /// A face with three tetrahedra, or two on the same side of it: the mesh runs through itself.
    fn refuse_overlaps(&self) -> Result<(), ShapeError> {
        let mut seen: HashMap<[u32; 3], i32> = HashMap::with_capacity(self.tets.len() * 3);
        for tet in &self.tets {
            for face in FACES {
                let face = face.map(|i| tet[i]);
                // Bit 1 for one way round, bit 2 for the other.
                let way = if even(face) { 1 } else { 2 };
                let sides = seen.entry(sorted(face)).or_insert(0);
                if *sides & way != 0 {
                    let what = "tetrahedra overlap: two lie on the same side of a face";
                    return Err(ShapeError::new("", what, "mesh it anew"));
                }
                *sides |= way;
            }
        }
        Ok(())
    }

    /// Number of parts that hang together by faces.
    #[must_use]
    pub fn parts(&self) -> usize {
        let part_of = self.part_of();
        (0..part_of.len()).filter(|&t| part_of[t] == t).count()
    }

    /// The part of each tetrahedron, by the first one in it.
    fn part_of(&self) -> Vec<usize> {
        let mut root: Vec<usize> = (0..self.tets.len()).collect();
        let mut faces: FxHashMap<[u32; 3], usize> = FxHashMap::default();
        for (t, tet) in self.tets.iter().enumerate() {
            for face in FACES {
                if let Some(other) = faces.insert(sorted(face.map(|i| tet[i])), t) {
                    let (a, b) = (find(&mut root, t), find(&mut root, other));
                    root[a.max(b)] = a.min(b);
                }
            }
        }
        (0..root.len()).map(|t| find(&mut root, t)).collect()
    }

    /// Keeps the part of the greatest volume; gives the share of the volume that is left out, and
    /// how many parts.
    pub(crate) fn keep_largest(&mut self) -> (f64, usize) {
        let part_of = self.part_of();
        let mut volumes = vec![0.0; self.tets.len()];
        let mut whole = 0.0;
        for (t, &part) in part_of.iter().enumerate() {
            let volume = tet_volume_m3(self.corners(self.tets[t])).abs();
            volumes[part] += volume;
            whole += volume;
        }
        let largest = (0..volumes.len()).max_by(|&a, &b| volumes[a].total_cmp(&volumes[b]));
        let Some(largest) = largest else { return (0.0, 0) };
        let others = (0..part_of.len()).filter(|&t| part_of[t] == t).count() - 1;
        let mut t = 0;
        self.tets.retain(|_| {
            t += 1;
            part_of[t - 1] == largest
        });
        (1.0 - volumes[largest] / whole, others)
    }
}

/// Unknown displacements of quadratic elements: three a corner and three an edge.
#[must_use]
pub fn degrees_of_freedom(tets: &[[u32; 4]]) -> usize {
    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(tets.len() * 6);
    for tet in tets {
        edges.extend(EDGES.map(|[a, b]| [tet[a].min(tet[b]), tet[a].max(tet[b])]));
    }
    edges.sort_unstable();
    edges.dedup();
    let mut corners: Vec<u32> = tets.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    3 * (corners.len() + edges.len())
}

/// # Errors
/// When a body is larger or smaller than any object.
pub fn check_side(side: f64) -> Result<(), ShapeError> {
    if (SHORTEST_SIDE_M..=LONGEST_SIDE_M).contains(&side) {
        return Ok(());
    }
    let right = format!("must be {SHORTEST_SIDE_M} to {LONGEST_SIDE_M} m; meshes are in metres");
    Err(ShapeError::new("", format!("its longest side is {side:.3e} m"), right))
}

/// The root of an element in a forest, with the path to it shortened.
pub fn find(root: &mut [usize], mut i: usize) -> usize {
    while root[i] != i {
        root[i] = root[root[i]];
        i = root[i];
    }
    i
}

/// A triangle's corners in rising order.
#[must_use]
pub fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// Tests whether sorting a triangle's corners keeps its sense.
fn even([a, b, c]: [u32; 3]) -> bool {
    (u32::from(a > b) + u32::from(a > c) + u32::from(b > c)) % 2 == 0
}
