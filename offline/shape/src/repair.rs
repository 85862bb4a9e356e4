//! Repair of a surface as files have it: one order, joined points, needles taken out, cracks
//! closed.
//!
//! | step | what it does |
//! |---|---|
//! | [`SurfaceMesh::in_order`] | drops points that no triangle uses, sorts the rest: the order in a file changes nothing |
//! | weld | points nearer than a millionth of the longest side are one |
//! | needles | a triangle lower than that is left out; what it joined is joined again by the next step |
//! | cracks | where edges have one triangle, corners are joined and edges cut at the corners that lie on them, at growing reach |
//!
//! A crack is closed only where that leaves fewer open edges, and corners are joined only well
//! within the shortest edge that ends there, so that small holes and thin slots of a fine mesh stay
//! what they are.

use crate::surface_mesh::SurfaceMesh;
use crate::triangle_tree::area_vector;
use crate::vector::{Vec3, add_scaled, distance, dot, length, longest_side, sub};
use crate::volume_mesh::sorted;
use rustc_hash::{FxHashMap, FxHashSet};

/// Points nearer than this part of the longest side are one, and triangles lower than it are
/// needles.
const JOINED: f64 = 1e-6;
/// Widths of cracks that are closed one after the other, as parts of the longest side.
const CRACKS: [f64; 4] = [JOINED, 1e-5, 1e-4, 1e-3];
/// Corners beside a crack are joined when nearer than this part of the shortest edge that ends
/// there.
const WITHIN_EDGE: f64 = 0.3;
/// Most open edges that are searched for cracks: beyond it is no crack, but a surface in pieces.
const MOST_OPEN_EDGES: usize = 300_000;
/// Number of cuts of the edges of a triangle: each has three.
const CUTS: usize = 3;

/// Width of cracks that are closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cracks {
    /// Up to a thousandth of the longest side: the surface shall enclose something.
    Wide,
    /// Up to a millionth: it is a sheet, whose rims are its own.
    Hair,
}

/// One use of an edge by a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct EdgeUse {
    /// Its ends, the smaller number first.
    pub edge: [u32; 2],
    /// The triangle.
    pub triangle: usize,
    /// The triangle runs along it from the smaller number to the larger.
    pub upwards: bool,
}

/// Uses of all edges, those of one edge together.
pub(crate) fn edge_uses(triangles: &[[u32; 3]]) -> Vec<EdgeUse> {
    let mut uses = Vec::with_capacity(3 * triangles.len());
    for (triangle, &[a, b, c]) in triangles.iter().enumerate() {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            uses.push(EdgeUse { edge: [a.min(b), a.max(b)], triangle, upwards: a < b });
        }
    }
    uses.sort_unstable();
    uses
}

/// Edges with one triangle.
pub(crate) fn open_edges(uses: &[EdgeUse]) -> Vec<EdgeUse> {
    uses.chunk_by(|a, b| a.edge == b.edge).filter(|group| group.len() == 1).map(|group| group[0]).collect()
}

/// Points by the cell they lie in.
struct Grid {
    width: f64,
    cells: FxHashMap<[i64; 3], Vec<u32>>,
}

impl Grid {
    fn new(width: f64) -> Self {
        Self { width, cells: FxHashMap::default() }
    }

    fn key(&self, p: Vec3) -> [i64; 3] {
        p.map(|x| (x / self.width).floor() as i64)
    }

    fn add(&mut self, p: Vec3, number: u32) {
        let key = self.key(p);
        self.cells.entry(key).or_default().push(number);
    }

    /// Numbers of points in the cells within `reach` of a place.
    fn near(&self, p: Vec3, reach: f64) -> impl Iterator<Item = u32> {
        let low = self.key(p.map(|x| x - reach));
        let high = self.key(p.map(|x| x + reach));
        (low[0]..=high[0])
            .flat_map(move |i| {
                (low[1]..=high[1]).flat_map(move |j| (low[2]..=high[2]).map(move |k| [i, j, k]))
            })
            .filter_map(|key| self.cells.get(&key))
            .flatten()
            .copied()
    }
}

impl SurfaceMesh {
    /// Points that triangles use, each place once and sorted by place, and the triangles sorted by
    /// them.
    #[must_use]
    pub fn in_order(mut self) -> Self {
        let mut used = vec![false; self.points.len()];
        self.triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
        // Adding 0 makes −0 the same place as 0.
        self.points.iter_mut().flatten().for_each(|x| *x += 0.0);
        let mut order: Vec<u32> = (0..self.points.len() as u32).filter(|&i| used[i as usize]).collect();
        let place = |i: u32| self.points[i as usize];
        let by_place = |a: &u32, b: &u32| {
            let (a, b) = (place(*a), place(*b));
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        };
        order.sort_unstable_by(by_place);
        let mut number = vec![0; self.points.len()];
        let mut points: Vec<Vec3> = Vec::with_capacity(order.len());
        for i in order {
            if points.last() != Some(&place(i)) {
                points.push(place(i));
            }
            number[i as usize] = points.len() as u32 - 1;
        }
        self.points = points;
        for triangle in &mut self.triangles {
            let [a, b, c] = triangle.map(|i| number[i as usize]);
            *triangle = if a < b && a < c {
                [a, b, c]
            } else if b < a && b < c {
                [b, c, a]
            } else {
                [c, a, b]
            };
        }
        self.triangles.sort_unstable();
        self
    }

    /// Joins points, takes needles and doubled triangles out and closes cracks.
    pub(crate) fn repaired(mut self, cracks: Cracks, remarks: &mut Vec<String>) -> Self {
        let side = longest_side(&self.points);
        self = self.in_order();
        self.weld(JOINED * side);
        self.take_needles_out(JOINED * side);
        let before = self.triangles.len();
        self.take_doubles_out();
        if self.triangles.len() < before {
            remarks.push(format!("{} doubled triangles were left out", before - self.triangles.len()));
        }
        let reaches = if cracks == Cracks::Wide { &CRACKS[..] } else { &CRACKS[..1] };
        for reach in reaches {
            let open = open_edges(&edge_uses(&self.triangles)).len();
            if open == 0 || open > MOST_OPEN_EDGES {
                break;
            }
            let mut closed = self.clone();
            closed.join_open_corners(reach * side);
            for _ in 0..CUTS {
                closed.cut_open_edges(reach * side);
            }
            closed.take_needles_out(JOINED * side);
            closed.take_doubles_out();
            let left = open_edges(&edge_uses(&closed.triangles)).len();
            if left < open && !closed.triangles.is_empty() {
                // Hair cracks are rounding, not worth a word.
                if *reach > JOINED {
                    remarks.push(format!(
                        "cracks up to {:.0e} of its size were closed: {open} open edges became {left}",
                        reach
                    ));
                }
                self = closed;
            }
        }
        self.in_order()
    }

    fn renumber(&mut self, number: &[u32]) {
        self.triangles.iter_mut().flatten().for_each(|i| *i = number[*i as usize]);
    }

    /// Joins each point with an earlier one nearer than `reach`.
    fn weld(&mut self, reach: f64) {
        let mut grid = Grid::new(8.0 * reach);
        let mut number: Vec<u32> = (0..self.points.len() as u32).collect();
        for (i, &p) in self.points.iter().enumerate() {
            let near = grid.near(p, reach).filter(|&j| distance(self.points[j as usize], p) < reach).min();
            match near {
                Some(j) => number[i] = j,
                None => grid.add(p, i as u32),
            }
        }
        self.renumber(&number);
    }

    /// Leaves out triangles lower than `height`.
    fn take_needles_out(&mut self, height: f64) {
        let points = &self.points;
        self.triangles.retain(|t| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            let longest = distance(a, b).max(distance(b, c)).max(distance(c, a));
            t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && {
                2.0 * length(area_vector([a, b, c])) > height * longest
            }
        });
    }

    fn take_doubles_out(&mut self) {
        let mut seen = FxHashSet::default();
        self.triangles.retain(|&t| seen.insert(sorted(t)));
    }

    /// Joins corners on either side of a crack.
    fn join_open_corners(&mut self, reach: f64) {
        let uses = edge_uses(&self.triangles);
        let corners = corners_of(&open_edges(&uses));
        let mut shortest: FxHashMap<u32, f64> = corners.iter().map(|&i| (i, f64::MAX)).collect();
        let mut joined: FxHashSet<[u32; 2]> = FxHashSet::default();
        for group in uses.chunk_by(|a, b| a.edge == b.edge) {
            let [a, b] = group[0].edge;
            let long = distance(self.points[a as usize], self.points[b as usize]);
            for i in [a, b] {
                shortest.entry(i).and_modify(|s| *s = s.min(long));
            }
            if shortest.contains_key(&a) && shortest.contains_key(&b) {
                joined.insert([a, b]);
            }
        }
        let mut grid = Grid::new(4.0 * reach);
        let mut pairs: Vec<(f64, u32, u32)> = Vec::new();
        for &i in &corners {
            let p = self.points[i as usize];
            for j in grid.near(p, reach) {
                let away = distance(p, self.points[j as usize]);
                let most = reach.min(WITHIN_EDGE * shortest[&i].min(shortest[&j]));
                if away < most && !joined.contains(&[i.min(j), i.max(j)]) {
                    pairs.push((away, j, i));
                }
            }
            grid.add(p, i);
        }
        pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut root: Vec<usize> = (0..self.points.len()).collect();
        for (_, i, j) in pairs {
            let a = crate::volume_mesh::find(&mut root, i as usize);
            let b = crate::volume_mesh::find(&mut root, j as usize);
            root[a.max(b)] = a.min(b);
        }
        let number: Vec<u32> =
            (0..root.len()).map(|i| crate::volume_mesh::find(&mut root, i) as u32).collect();
        self.renumber(&number);
    }

    /// Cuts each triangle at the open corners that lie on one of its open edges.
    fn cut_open_edges(&mut self, reach: f64) {
        let open = open_edges(&edge_uses(&self.triangles));
        let side = longest_side(&self.points);
        let width = reach.max(side / 256.0);
        let mut grid = Grid::new(width);
        corners_of(&open).into_iter().for_each(|i| grid.add(self.points[i as usize], i));
        let mut cut: FxHashSet<usize> = FxHashSet::default();
        for EdgeUse { edge, triangle, upwards } in open {
            if cut.contains(&triangle) {
                continue;
            }
            let [from, to] = if upwards { edge } else { [edge[1], edge[0]] };
            let on = self.on_edge(&grid, [from, to], reach);
            let Some(apex) = self.triangles[triangle].into_iter().find(|i| ![from, to].contains(i)) else {
                continue;
            };
            if on.is_empty() || on.contains(&apex) {
                continue;
            }
            cut.insert(triangle);
            let stops: Vec<u32> = [from].into_iter().chain(on).chain([to]).collect();
            self.triangles[triangle] = [stops[0], stops[1], apex];
            self.triangles.extend(stops.windows(2).skip(1).map(|w| [w[0], w[1], apex]));
        }
    }

    /// Open corners within `reach` of an edge between its ends, in order along it.
    fn on_edge(&self, grid: &Grid, [from, to]: [u32; 2], reach: f64) -> Vec<u32> {
        let (a, b) = (self.points[from as usize], self.points[to as usize]);
        let along = sub(b, a);
        let long = length(along);
        let pieces = (long / grid.width).ceil().max(1.0) as usize;
        let mut on: Vec<(f64, u32)> = Vec::new();
        for piece in 0..pieces {
            let middle = add_scaled(a, (piece as f64 + 0.5) / pieces as f64, along);
            for i in grid.near(middle, 0.5 * grid.width + reach) {
                let p = self.points[i as usize];
                let at = dot(sub(p, a), along) / (long * long);
                let away = distance(p, add_scaled(a, at, along));
                let from_ends = (at.min(1.0 - at)) * long;
                if i != from && i != to && away < reach && from_ends > reach.max(away) {
                    on.push((at, i));
                }
            }
        }
        on.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        on.dedup_by_key(|(_, i)| *i);
        on.into_iter().map(|(_, i)| i).collect()
    }
}

/// Ends of some edges, each once, in rising order.
fn corners_of(edges: &[EdgeUse]) -> Vec<u32> {
    let mut corners: Vec<u32> = edges.iter().flat_map(|e| e.edge).collect();
    corners.sort_unstable();
    corners.dedup();
    corners
}
