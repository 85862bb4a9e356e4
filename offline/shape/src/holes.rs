//! Holes of a surface: their rims, and the triangles that close them.

use crate::repair::{edge_uses, open_edges};
use crate::surface_mesh::SurfaceMesh;
use crate::triangle_tree::area_vector;
use crate::vector::{Vec3, add_scaled, cross, dot, sub, unit};
use rustc_hash::FxHashMap;

/// Triangles that close the holes of a surface.
#[derive(Debug, Default)]
pub(crate) struct Caps {
    /// Triangles over holes, each hole a fan around its middle.
    pub caps: Vec<[Vec3; 3]>,
    /// Single triangles that were lost.
    pub lost: Vec<[Vec3; 3]>,
    /// Number of holes.
    pub holes: usize,
}

impl SurfaceMesh {
    pub(crate) fn caps(&self) -> Caps {
        let mut made = Caps::default();
        for rim in self.rims() {
            made.holes += 1;
            let places: Vec<Vec3> = rim.iter().map(|&i| self.points[i as usize]).collect();
            if let [a, b, c] = places[..] {
                made.lost.push([a, b, c]);
                continue;
            }
            let n = places.len();
            let middle: Vec3 = std::array::from_fn(|c| places.iter().map(|p| p[c]).sum::<f64>() / n as f64);
            made.caps.extend((0..n).map(|i| [places[i], places[(i + 1) % n], middle]));
        }
        made
    }

    /// Rims of the holes, anticlockwise seen from outside. Rims that share a corner are told apart
    /// by turning left there as sharply as possible: the hole lies on the left.
    fn rims(&self) -> Vec<Vec<u32>> {
        let open = open_edges(&edge_uses(&self.triangles));
        // A hole's rim runs against the triangles beside it.
        let steps: Vec<[u32; 2]> =
            open.iter().map(|e| if e.upwards { [e.edge[1], e.edge[0]] } else { e.edge }).collect();
        let mut onwards: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        steps.iter().for_each(|&[a, b]| onwards.entry(a).or_default().push(b));
        let mut normal: FxHashMap<u32, Vec3> =
            onwards.iter().filter(|(_, to)| to.len() > 1).map(|(&i, _)| (i, [0.0; 3])).collect();
        for &t in &self.triangles {
            let area = area_vector(self.corners(t));
            for i in t {
                normal.entry(i).and_modify(|n| *n = add_scaled(*n, 1.0, area));
            }
        }
        let mut rims = Vec::new();
        for [start, _] in steps {
            let mut path = vec![start];
            let mut place: FxHashMap<u32, usize> = [(start, 0)].into_iter().collect();
            while let Some(&here) = path.last() {
                let before = path.len().checked_sub(2).map(|i| path[i]);
                let Some(next) = self.sharpest_left(before, here, &mut onwards, &normal) else { break };
                if let Some(&first) = place.get(&next) {
                    // The path has come round: what it went round is a hole, and the rest goes on.
                    if path.len() - first >= 3 {
                        rims.push(path[first..].to_vec());
                    }
                    path.drain(first + 1..).for_each(|i| {
                        place.remove(&i);
                    });
                    if first == 0 {
                        break;
                    }
                } else {
                    place.insert(next, path.len());
                    path.push(next);
                }
            }
        }
        rims
    }

    /// Takes the way onwards that turns left most.
    fn sharpest_left(
        &self,
        before: Option<u32>,
        here: u32,
        onwards: &mut FxHashMap<u32, Vec<u32>>,
        normal: &FxHashMap<u32, Vec3>,
    ) -> Option<u32> {
        let ways = onwards.get_mut(&here)?;
        let place = |i: u32| self.points[i as usize];
        let turn = |to: u32| {
            let (Some(before), Some(&up)) = (before, normal.get(&here)) else { return 0.0 };
            if to == before {
                return -std::f64::consts::PI;
            }
            let (came, goes) = (unit(sub(place(here), place(before))), unit(sub(place(to), place(here))));
            dot(unit(up), cross(came, goes)).atan2(dot(came, goes))
        };
        let best = (0..ways.len()).max_by(|&i, &j| turn(ways[i]).total_cmp(&turn(ways[j])))?;
        Some(ways.swap_remove(best))
    }
}
