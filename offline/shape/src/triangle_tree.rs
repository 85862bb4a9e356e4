//! Closed surface as a tree of boxes: the nearest point of it, and how often it winds around a
//! place.
//!
//! The generalised winding number is the solid angle of all triangles over 4π: 1 inside, 0 outside,
//! and in between where the surface has holes, so that ½ is the best surface through them
//! (Jacobson, Kavan & Sorkine-Hornung 2013). Far triangles count together as one dipole (Barill et
//! al. 2018).

use crate::vector::{Vec3, add_scaled, cross, distance, dot, length, longest_side, mean, sub, unit};

/// Triangles in a leaf.
const LEAF: usize = 6;
/// A box counts as a dipole from this many of its radii on: the error of a number is then below
/// 0.01.
const FAR: f64 = 2.5;
/// Longest edge of a triangle, over the longest side by the root of the number of triangles: those
/// of an even mesh have at most 3. A longer one is cut, because no box that holds it is ever far
/// (of a sponge's 12,000 strips each answer took all).
const LONGEST_EDGE: f64 = 6.0;
/// Number of pieces that cutting adds at most: 100 MB.
const MOST_MORE: usize = 1_000_000;

#[derive(Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// Centre of area, the sum of area vectors, and the radius around the centre.
    centre: Vec3,
    area: Vec3,
    radius: f64,
    /// First and last triangle of a leaf, or the two children.
    range: (usize, usize),
    leaf: bool,
}

/// Triangles for questions of place.
#[derive(Debug)]
pub struct TriangleTree {
    triangles: Vec<[Vec3; 3]>,
    nodes: Vec<Node>,
}

/// A point of the surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfacePoint {
    /// Place, m.
    pub point: Vec3,
    /// Distance from the place asked for, m.
    pub distance: f64,
}

/// Outward area vector of a triangle, m².
#[must_use]
pub fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    cross(sub(b, a), sub(c, a)).map(|x| 0.5 * x)
}

impl TriangleTree {
    /// Sorts triangles into boxes.
    #[must_use]
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let triangles = cut(triangles);
        let count = triangles.len();
        let mut this = Self { triangles, nodes: Vec::with_capacity(count / 2 + 2) };
        if count > 0 {
            this.build(0, count);
        }
        this
    }

    fn build(&mut self, first: usize, last: usize) -> usize {
        let part = &self.triangles[first..last];
        let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
        let (mut centre, mut area, mut weight) = ([0.0; 3], [0.0; 3], 0.0);
        for triangle in part {
            for point in triangle {
                for c in 0..3 {
                    low[c] = low[c].min(point[c]);
                    high[c] = high[c].max(point[c]);
                }
            }
            let vector = area_vector(*triangle);
            let size = length(vector);
            centre = add_scaled(centre, size, mean(*triangle));
            area = add_scaled(area, 1.0, vector);
            weight += size;
        }
        let centre = if weight > 0.0 { centre.map(|x| x / weight) } else { mean([low, high]) };
        let radius = part.iter().flatten().map(|&p| distance(p, centre)).fold(0.0, f64::max);
        let index = self.nodes.len();
        let leaf = last - first <= LEAF;
        self.nodes.push(Node { low, high, centre, area, radius, range: (first, last), leaf });
        if !leaf {
            let axis = (0..3).max_by(|&a, &b| (high[a] - low[a]).total_cmp(&(high[b] - low[b]))).unwrap_or(0);
            let mut order: Vec<usize> = (first..last).collect();
            let key = |i: &usize| mean(self.triangles[*i])[axis];
            order.sort_by(|a, b| key(a).total_cmp(&key(b)));
            let sorted: Vec<_> = order.iter().map(|&i| self.triangles[i]).collect();
            self.triangles[first..last].copy_from_slice(&sorted);
            let middle = usize::midpoint(first, last);
            let left = self.build(first, middle);
            let right = self.build(middle, last);
            self.nodes[index].range = (left, right);
        }
        index
    }

    /// Winding number of the surface around a place.
    #[must_use]
    pub fn winding(&self, place: Vec3) -> f64 {
        let mut angle = 0.0;
        let mut stack = vec![0];
        while let Some(node) = stack.pop().and_then(|i: usize| self.nodes.get(i)) {
            let away = sub(node.centre, place);
            let far = length(away);
            if far > FAR * node.radius {
                angle += dot(node.area, away) / (far * far * far);
            } else if node.leaf {
                let part = &self.triangles[node.range.0..node.range.1];
                angle += part.iter().map(|t| solid_angle(t.map(|p| sub(p, place)))).sum::<f64>();
            } else {
                stack.extend([node.range.0, node.range.1]);
            }
        }
        angle / (4.0 * std::f64::consts::PI)
    }

    /// Tests whether a place is inside.
    #[must_use]
    pub fn contains(&self, place: Vec3) -> bool {
        self.winding(place) >= 0.5
    }

    /// The nearest point of the surface; none where there is no triangle.
    #[must_use]
    pub fn nearest(&self, place: Vec3) -> Option<SurfacePoint> {
        let mut best: Option<SurfacePoint> = None;
        let mut stack = vec![0];
        while let Some(node) = stack.pop().and_then(|i: usize| self.nodes.get(i)) {
            if best.is_some_and(|b| box_distance(node, place) >= b.distance) {
                continue;
            }
            if node.leaf {
                for i in node.range.0..node.range.1 {
                    let point = nearest_in_triangle(self.triangles[i], place);
                    let away = distance(point, place);
                    if best.is_none_or(|b| away < b.distance) {
                        best = Some(SurfacePoint { point, distance: away });
                    }
                }
            } else {
                let (left, right) = node.range;
                let left_first =
                    box_distance(&self.nodes[left], place) < box_distance(&self.nodes[right], place);
                stack.extend(if left_first { [right, left] } else { [left, right] });
            }
        }
        best
    }

    /// Distance of a ray from a place to the surface, m; none: it does not meet it again.
    #[must_use]
    pub fn free_path(&self, from: Vec3, direction: Vec3, nearest: f64) -> Option<f64> {
        let mut best: Option<f64> = None;
        let mut stack = vec![0];
        while let Some(node) = stack.pop().and_then(|i: usize| self.nodes.get(i)) {
            if !ray_meets(node, from, direction, best.unwrap_or(f64::MAX)) {
                continue;
            }
            if node.leaf {
                for triangle in &self.triangles[node.range.0..node.range.1] {
                    let hit = ray_triangle(*triangle, from, direction);
                    if let Some(t) = hit.filter(|&t| t > nearest && best.is_none_or(|b| t < b)) {
                        best = Some(t);
                    }
                }
            } else {
                stack.extend([node.range.0, node.range.1]);
            }
        }
        best
    }
}

/// Triangles without long ones, which are halved.
fn cut(triangles: &[[Vec3; 3]]) -> Vec<[Vec3; 3]> {
    let corners: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    let longest = LONGEST_EDGE * longest_side(&corners) / (triangles.len() as f64).sqrt();
    let most = triangles.len() + MOST_MORE;
    let (mut left, mut pieces) = (triangles.to_vec(), Vec::with_capacity(triangles.len()));
    while let Some([a, b, c]) = left.pop() {
        let turned = [[a, b, c], [b, c, a], [c, a, b]];
        let edge = |[a, b, _]: &[Vec3; 3]| distance(*a, *b);
        let [a, b, c] = turned.into_iter().max_by(|s, t| edge(s).total_cmp(&edge(t))).unwrap_or([a, b, c]);
        if distance(a, b) > longest && pieces.len() + left.len() < most {
            let middle = mean([a, b]);
            left.extend([[a, middle, c], [middle, b, c]]);
        } else {
            pieces.push([a, b, c]);
        }
    }
    pieces
}

fn box_distance(node: &Node, place: Vec3) -> f64 {
    let outside: Vec3 =
        std::array::from_fn(|c| (node.low[c] - place[c]).max(place[c] - node.high[c]).max(0.0));
    length(outside)
}

fn ray_meets(node: &Node, from: Vec3, direction: Vec3, most: f64) -> bool {
    let (mut enter, mut leave) = (0.0_f64, most);
    for c in 0..3 {
        if direction[c].abs() < 1e-300 {
            if from[c] < node.low[c] || from[c] > node.high[c] {
                return false;
            }
            continue;
        }
        let (a, b) = ((node.low[c] - from[c]) / direction[c], (node.high[c] - from[c]) / direction[c]);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    enter <= leave * (1.0 + 1e-12)
}

/// Möller & Trumbore 1997.
fn ray_triangle([a, b, c]: [Vec3; 3], from: Vec3, direction: Vec3) -> Option<f64> {
    let (ab, ac) = (sub(b, a), sub(c, a));
    let p = cross(direction, ac);
    let determinant = dot(ab, p);
    if determinant == 0.0 {
        return None;
    }
    let s = sub(from, a);
    let u = dot(s, p) / determinant;
    let q = cross(s, ab);
    let v = dot(direction, q) / determinant;
    let slack = 1e-9;
    (u >= -slack && v >= -slack && u + v <= 1.0 + slack).then(|| dot(ac, q) / determinant)
}

/// Solid angle of a triangle seen from the origin (Van Oosterom & Strackee 1983).
fn solid_angle([a, b, c]: [Vec3; 3]) -> f64 {
    let (la, lb, lc) = (length(a), length(b), length(c));
    let volume = dot(a, cross(b, c));
    2.0 * volume.atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
}

/// Nearest point of a triangle, by the region of its plane the place falls into (Ericson, Real-Time
/// Collision Detection, §5.1.5).
fn nearest_in_triangle([a, b, c]: [Vec3; 3], p: Vec3) -> Vec3 {
    let on_edge = |a: Vec3, b: Vec3| {
        let ab = sub(b, a);
        let t = (dot(sub(p, a), ab) / dot(ab, ab).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        add_scaled(a, t, ab)
    };
    let normal = cross(sub(b, a), sub(c, a));
    let inside = |a: Vec3, b: Vec3| dot(cross(sub(b, a), sub(p, a)), normal) >= 0.0;
    if dot(normal, normal) > 0.0 && inside(a, b) && inside(b, c) && inside(c, a) {
        let n = unit(normal);
        return add_scaled(p, -dot(sub(p, a), n), n);
    }
    let candidates = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    candidates.into_iter().min_by(|x, y| distance(*x, p).total_cmp(&distance(*y, p))).unwrap_or(a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octahedron() -> Vec<[Vec3; 3]> {
        let mut triangles = Vec::new();
        for (x, y, z) in (0..8).map(|i| (1 - 2 * (i & 1), 1 - (i & 2), 1 - (i & 4) / 2)) {
            let corners = [[f64::from(x), 0.0, 0.0], [0.0, f64::from(y), 0.0], [0.0, 0.0, f64::from(z)]];
            let [a, b, c] = corners;
            triangles.push(if x * y * z > 0 { [a, b, c] } else { [b, a, c] });
        }
        triangles
    }

    #[test]
    fn a_closed_surface_winds_once_around_its_inside_despite_a_leak() {
        let mut triangles = octahedron();
        let tree = TriangleTree::new(&triangles);
        assert!((tree.winding([0.1, 0.2, -0.1]) - 1.0).abs() < 0.02);
        assert!(tree.winding([0.7, 0.7, 0.7]).abs() < 0.02);
        triangles.pop();
        let leaky = TriangleTree::new(&triangles);
        assert!(leaky.contains([0.1, 0.1, 0.1]) && !leaky.contains([0.7, -0.7, 0.7]));
    }

    #[test]
    fn the_nearest_point_lies_on_the_surface_and_rays_cross_it() {
        let tree = TriangleTree::new(&octahedron());
        let near = tree.nearest([1.0, 1.0, 1.0]).unwrap();
        assert!(near.point.iter().all(|x| (x - 1.0 / 3.0).abs() < 1e-12), "{near:?}");
        let path = tree.free_path([-2.0, 0.1, 0.1], [1.0, 0.0, 0.0], 0.0).unwrap();
        assert!((path - 1.2).abs() < 1e-12);
    }

    /// Each answer about a sponge of 12,000 strips took all of them, and its filling a minute.
    #[test]
    fn long_strips_are_cut_and_triangles_of_an_even_mesh_are_not() {
        assert_eq!(cut(&octahedron()).len(), 8);
        let strip = |i: u32| {
            let y = f64::from(i) / 1000.0;
            [[0.0, y, 0.0], [1.0, y, 0.0], [1.0, y + 1e-3, 0.0]]
        };
        let strips: Vec<_> = (0..1000).map(strip).collect();
        let pieces = cut(&strips);
        let area = |all: &[[Vec3; 3]]| all.iter().map(|t| length(area_vector(*t))).sum::<f64>();
        let longest =
            |t: &[Vec3; 3]| distance(t[0], t[1]).max(distance(t[1], t[2])).max(distance(t[2], t[0]));
        assert!(pieces.len() < 30_000 && (area(&pieces) - area(&strips)).abs() < 1e-12, "{}", pieces.len());
        assert!(pieces.iter().all(|t| longest(t) <= 6.0 / 1000.0_f64.sqrt()));
    }
}
