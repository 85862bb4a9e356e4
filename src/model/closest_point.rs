//! Closest point of a triangulation to a place in space, for the game half: a tree of boxes, the
//! nearer half first.

use glam::DVec3;

/// Triangles of a leaf.
const LEAF: usize = 4;

/// A point of a triangulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnTriangle {
    pub(crate) triangle: usize,
    /// Barycentric coordinates; they sum to 1.
    pub(crate) weights: [f64; 3],
    square_m2: f64,
}

/// Triangles sorted into boxes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TriangleTree {
    corners: Vec<[DVec3; 3]>,
    /// Triangles in the order of the leaves.
    order: Vec<u32>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Node {
    low: DVec3,
    high: DVec3,
    /// Part of `order` that lies in it.
    range: (u32, u32),
    /// Its two halves; none for a leaf.
    halves: Option<(u32, u32)>,
}

impl TriangleTree {
    pub(crate) fn new(points_m: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let point = |i: u32| points_m.get(i as usize).copied().map_or(DVec3::ZERO, DVec3::from_array);
        let corners: Vec<_> = triangles.iter().map(|t| t.map(point)).collect();
        let mut tree = Self { order: (0..corners.len() as u32).collect(), corners, nodes: Vec::new() };
        if !tree.order.is_empty() {
            tree.split(0, tree.order.len());
        }
        tree
    }

    /// Makes the node of a range of triangles and those below it.
    fn split(&mut self, from: usize, to: usize) -> u32 {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in self.order[from..to].iter().flat_map(|&t| self.corners[t as usize]) {
            (low, high) = (low.min(corner), high.max(corner));
        }
        let index = self.nodes.len();
        self.nodes.push(Node { low, high, range: (from as u32, to as u32), halves: None });
        if to - from > LEAF {
            let axis = (high - low).max_position();
            let middle = usize::midpoint(from, to);
            let corners = &self.corners;
            let along = |t: &u32| corners[*t as usize].iter().map(|corner| corner[axis]).sum::<f64>();
            self.order[from..to].select_nth_unstable_by(middle - from, |a, b| along(a).total_cmp(&along(b)));
            self.nodes[index].halves = Some((self.split(from, middle), self.split(middle, to)));
        }
        index as u32
    }

    /// The nearest point; none without a triangle.
    pub(crate) fn nearest(&self, at_m: [f64; 3]) -> Option<OnTriangle> {
        let at = DVec3::from_array(at_m);
        let mut best: Option<OnTriangle> = None;
        if !self.nodes.is_empty() {
            self.search(0, at, &mut best);
        }
        best
    }

    fn search(&self, index: u32, at: DVec3, best: &mut Option<OnTriangle>) {
        let node = &self.nodes[index as usize];
        if best.is_some_and(|best| node.square_m2(at) >= best.square_m2) {
            return;
        }
        let Some((a, b)) = node.halves else {
            for &triangle in &self.order[node.range.0 as usize..node.range.1 as usize] {
                let found = on_triangle(at, &self.corners[triangle as usize], triangle as usize);
                if best.is_none_or(|best| found.square_m2 < best.square_m2) {
                    *best = Some(found);
                }
            }
            return;
        };
        let distance = |half: u32| self.nodes[half as usize].square_m2(at);
        let (near, far) = if distance(a) <= distance(b) { (a, b) } else { (b, a) };
        self.search(near, at, best);
        self.search(far, at, best);
    }

    /// Outward unit normal of a triangle; zero for one without area.
    pub(crate) fn normal(&self, triangle: usize) -> [f64; 3] {
        let [a, b, c] = self.corners[triangle];
        (b - a).cross(c - a).normalize_or_zero().to_array()
    }
}

impl Node {
    fn square_m2(&self, at: DVec3) -> f64 {
        at.distance_squared(at.clamp(self.low, self.high))
    }
}

/// The nearest point of one triangle: inside it, on an edge, or a corner (Ericson, *Real-Time
/// Collision Detection*, 5.1.5, by the signs of the projections).
fn on_triangle(at: DVec3, &[a, b, c]: &[DVec3; 3], triangle: usize) -> OnTriangle {
    let found = |weights: [f64; 3]| {
        let place = a * weights[0] + b * weights[1] + c * weights[2];
        OnTriangle { triangle, weights, square_m2: at.distance_squared(place) }
    };
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    if area > 0.0 {
        let inside = [(c - b).cross(at - b), (a - c).cross(at - c), (b - a).cross(at - a)]
            .map(|across| across.dot(normal) / area);
        if inside.iter().all(|weight| *weight >= 0.0) {
            let sum: f64 = inside.iter().sum();
            return found(inside.map(|weight| weight / sum));
        }
    }
    // Off it the nearest point is on one of the edges.
    let along = |from: DVec3, to: DVec3| {
        let square = from.distance_squared(to);
        if square > 0.0 { ((at - from).dot(to - from) / square).clamp(0.0, 1.0) } else { 0.0 }
    };
    let [ab, bc, ca] = [along(a, b), along(b, c), along(c, a)];
    let edges = [[1.0 - ab, ab, 0.0], [0.0, 1.0 - bc, bc], [ca, 0.0, 1.0 - ca]].map(found);
    let [first, second, third] = edges;
    let nearer = |x: OnTriangle, y: OnTriangle| if y.square_m2 < x.square_m2 { y } else { x };
    nearer(nearer(first, second), third)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    #[test]
    fn the_tree_finds_what_looking_at_every_triangle_finds() {
        let mut rng = Rng::new(17);
        let mut number = || 2.0 * rng.uniform() - 1.0;
        let points: Vec<[f64; 3]> = (0..300).map(|_| [number(), number(), 0.2 * number()]).collect();
        let triangles: Vec<[u32; 3]> =
            (0..500).map(|i| [i % 300, (i * 7 + 1) % 300, (i * 13 + 5) % 300]).collect();
        let tree = TriangleTree::new(&points, &triangles);
        for _ in 0..2000 {
            let at = [2.0 * number(), number(), number()];
            let found = tree.nearest(at).unwrap();
            let each = tree.corners.iter().enumerate();
            let least = each
                .map(|(t, corners)| on_triangle(DVec3::from_array(at), corners, t).square_m2)
                .fold(f64::INFINITY, f64::min);
            assert_eq!(found.square_m2, least);
            assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        }
        assert!(TriangleTree::new(&points, &[]).nearest([0.0; 3]).is_none());
    }

    #[test]
    fn triangles_without_area_still_have_nearest_points() {
        let tree = TriangleTree::new(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], &[[0, 1, 2], [0, 0, 0]]);
        let found = tree.nearest([0.25, 1.0, 0.0]).unwrap();
        assert!((found.square_m2 - 1.0).abs() < 1e-12);
        assert_eq!(tree.normal(1), [0.0; 3]);
    }
}
