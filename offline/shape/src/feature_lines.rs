//! Sharp edges and corners of a surface: where a mesh of a body must have edges and corners of its
//! own.
//!
//! A box cut by elements that round its edges off errs by several per cent in its pitches.

use crate::surface_mesh::SurfaceMesh;
use crate::vector::{Vec3, add_scaled, distance, dot, sub, unit};
use std::collections::{HashMap, HashSet};

/// Normals of two triangles that differ by more than this make an edge sharp: 35°.
const SHARP: f64 = 0.819;
/// Two edges that meet at less than this cosine (60°) are one line round a corner.
const STRAIGHT: f64 = 0.5;

/// A sharp line from corner to corner, or a ring.
#[derive(Debug, Clone)]
pub struct FeatureLine {
    /// Its points in order; a ring repeats its first at the end.
    pub points: Vec<Vec3>,
    /// Normals of the two faces at each of its segments.
    pub normals: Vec<[Vec3; 2]>,
}

impl FeatureLine {
    /// Length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.points.windows(2).map(|w| distance(w[0], w[1])).sum()
    }

    /// The point that far along it, and the normals there.
    #[must_use]
    pub fn at(&self, along_m: f64) -> (Vec3, [Vec3; 2]) {
        let mut left = along_m;
        for (w, normals) in self.points.windows(2).zip(&self.normals) {
            let piece = distance(w[0], w[1]);
            if left <= piece {
                return (add_scaled(w[0], left / piece.max(f64::MIN_POSITIVE), sub(w[1], w[0])), *normals);
            }
            left -= piece;
        }
        (self.points.last().copied().unwrap_or_default(), self.normals.last().copied().unwrap_or_default())
    }
}

/// The sharp lines of a surface.
#[must_use]
pub fn feature_lines(mesh: &SurfaceMesh) -> Vec<FeatureLine> {
    let normals = mesh.normals();
    let mut beside: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            beside.entry([a.min(b), a.max(b)]).or_default().push(t);
        }
    }
    let mut sharp: HashMap<[u32; 2], [Vec3; 2]> = HashMap::new();
    let mut at: HashMap<u32, Vec<u32>> = HashMap::new();
    for (edge, triangles) in beside {
        if let [s, t] = triangles[..]
            && dot(normals[s], normals[t]) < SHARP
        {
            sharp.insert(edge, [normals[s], normals[t]]);
            at.entry(edge[0]).or_default().push(edge[1]);
            at.entry(edge[1]).or_default().push(edge[0]);
        }
    }
    at.values_mut().for_each(|ends| ends.sort_unstable());
    let place = |i: u32| mesh.points[i as usize];
    let is_corner = |i: u32| match at[&i][..] {
        [a, b] => dot(unit(sub(place(i), place(a))), unit(sub(place(b), place(i)))) < STRAIGHT,
        _ => true,
    };
    let mut starts: Vec<u32> = at.keys().copied().collect();
    // Corners first; what is left are rings.
    starts.sort_unstable_by_key(|&i| (!is_corner(i), i));
    let mut done: HashSet<[u32; 2]> = HashSet::new();
    let mut lines = Vec::new();
    for start in starts {
        for &second in &at[&start] {
            let key = |a: u32, b: u32| [a.min(b), a.max(b)];
            if !done.insert(key(start, second)) {
                continue;
            }
            let mut line = FeatureLine {
                points: vec![place(start), place(second)],
                normals: vec![sharp[&key(start, second)]],
            };
            let (mut before, mut here) = (start, second);
            while here != start && !is_corner(here) {
                let Some(&onwards) = at[&here].iter().find(|&&n| n != before) else { break };
                if !done.insert(key(here, onwards)) {
                    break;
                }
                line.points.push(place(onwards));
                line.normals.push(sharp[&key(here, onwards)]);
                (before, here) = (here, onwards);
            }
            lines.push(line);
        }
    }
    lines
}
