//! The nodes of a lattice in the feature matrix: how well they fit, and whether some of them fit
//! worse than the rest.

use super::lattice::{combine, cross, length};
use super::minima::Fit;

/// Coarser lattices of index 2 and 3 within a lattice: (k, i, j) holds the nodes with i·m + j·n
/// divisible by k.
pub(super) const COARSER: [(f64, f64, f64); 7] = [
    (2.0, 1.0, 0.0),
    (2.0, 0.0, 1.0),
    (2.0, 1.0, 1.0),
    (3.0, 1.0, 0.0),
    (3.0, 0.0, 1.0),
    (3.0, 1.0, 1.0),
    (3.0, 1.0, 2.0),
];

/// Largest index of a coarser lattice that is separated from a finer one at which only some of the
/// pattern's lines fit: frames whose gap is a quarter or a fifth of their period fit themselves
/// there in part.
const DEEPEST_INDEX: usize = 9;

/// The basis of the coarser lattice of [`coarser_lattices`] within the lattice of a and b.
pub(super) fn coarser(a: [f64; 2], b: [f64; 2], (k, i, j): (f64, f64, f64)) -> [[f64; 2]; 2] {
    if i == 1.0 {
        [combine(a, b, k, 0.0), combine(a, b, (-j).rem_euclid(k), 1.0)]
    } else {
        [combine(a, b, 1.0, (-i).rem_euclid(k)), combine(a, b, 0.0, k)]
    }
}

/// All coarser lattices of index 2 to [`DEEPEST_INDEX`] whose nodes are those with i·m + j·n
/// divisible by k, each once.
pub(super) fn coarser_lattices() -> Vec<(f64, f64, f64)> {
    let mut all = Vec::new();
    for k in 2..=DEEPEST_INDEX {
        for (i, j) in (0..k).map(|j| (1, j)).chain((0..k).map(|i| (i, 1))) {
            // (i, j) and its multiples by what is prime to k are one lattice.
            let known =
                |&(l, p, q): &(usize, usize, usize)| l == k && (p * j + (k - q) * i).is_multiple_of(k);
            if !all.iter().any(known) {
                all.push((k, i, j));
            }
        }
    }
    all.into_iter().map(|(k, i, j)| (k as f64, i as f64, j as f64)).collect()
}

/// Nodes outside a coarser lattice that fit worse by less than this, relative, are as good as those
/// on it: reading the matrix between texels costs as much.
const UNEVEN_LIMIT: f64 = 0.02;

/// Nodes of two lattices nearer to each other than this are one node, texels.
const SHARED_PX: f64 = 1.5;

/// Standard errors from which the difference is no chance.
pub(super) const CLEARLY_UNEVEN: f64 = 6.0;

/// Calls `visit(m, n, depth, weight)` for the nodes (m, n) + offset within reach, one of each ±
/// pair.
pub(super) fn for_each_node(
    fit: &Fit,
    basis: [[f64; 2]; 2],
    offset: [f64; 2],
    mut visit: impl FnMut(f64, f64, f64, f64),
) {
    let [width, height] = fit.reach();
    let area = cross(basis[0], basis[1]).abs();
    let limit = |t: [f64; 2]| ((t[0].abs() * height + t[1].abs() * width) / area).ceil() as i64 + 1;
    let (most_m, most_n) = (limit(basis[1]), limit(basis[0]));
    // Half the reach: where the overlap is three quarters along each axis.
    let near = 0.5 * width.min(height);
    for i in -most_m..=most_m {
        for j in -most_n..=most_n {
            let (m, n) = (i as f64 + offset[0], j as f64 + offset[1]);
            if m < 0.0 || (m == 0.0 && n <= 0.0) {
                continue;
            }
            let shift = combine(basis[0], basis[1], m, n);
            if let Some(depth) = fit.at(shift) {
                let distance = length(shift) / near;
                visit(m, n, depth, 1.0 / (1.0 + distance * distance));
            }
        }
    }
}

/// A node in reach.
#[derive(Debug, Clone, Copy)]
struct Node {
    m: f64,
    n: f64,
    shift: [f64; 2],
    depth: f64,
    weight: f64,
}

/// All nodes of a lattice in reach, one of each ± pair.
pub(super) struct Nodes(Vec<Node>);

impl Nodes {
    pub fn new(fit: &Fit, basis: [[f64; 2]; 2]) -> Self {
        let mut all = Vec::new();
        for_each_node(fit, basis, [0.0; 2], |m, n, depth, weight| {
            all.push(Node { m, n, shift: combine(basis[0], basis[1], m, n), depth, weight });
        });
        Self(all)
    }

    /// By how many standard errors the nodes outside a coarser lattice fit worse than those on it,
    /// beside what the distance does; 0 when the difference is too small to matter.
    pub fn unevenness(&self, (k, i, j): (f64, f64, f64)) -> f64 {
        let is_outside = |node: &Node| (i * node.m + j * node.n).rem_euclid(k) != 0.0;
        missing(self.0.iter().map(|node| (*node, is_outside(node))))
    }

    /// By how many standard errors these nodes fit worse than those of another lattice, nodes of
    /// both left out; likewise.
    pub fn worse_than(&self, other: &Self) -> f64 {
        let is_shared = |node: &&Node| {
            let beside = |o: &Node| length(combine(o.shift, node.shift, 1.0, -1.0)) < SHARED_PX;
            other.0.iter().any(beside)
        };
        let own = self.0.iter().filter(|node| !is_shared(node)).map(|node| (*node, true));
        missing(other.0.iter().map(|node| (*node, false)).chain(own))
    }
}

/// By how many standard errors the nodes that are outside fit worse than the others, beside what
/// the distance does; 0 when the difference is too small to matter, or they are too few.
fn missing(nodes: impl Iterator<Item = (Node, bool)>) -> f64 {
    // Weighted least squares of depth = p + q·distance² + r·outside.
    let (mut squares, mut products, mut energy, mut weights) = ([[0.0; 3]; 3], [0.0; 3], 0.0, 0.0);
    let mut count = 0.0;
    for (node, outside) in nodes {
        // The weight is 1/(1 + distance²).
        let row = [1.0, 1.0 / node.weight - 1.0, f64::from(u8::from(outside))];
        for r in 0..3 {
            for c in 0..3 {
                squares[r][c] += node.weight * row[r] * row[c];
            }
            products[r] += node.weight * row[r] * node.depth;
        }
        energy += node.weight * node.depth * node.depth;
        weights += node.weight;
        count += 1.0;
    }
    let all = determinant(squares);
    if count < 8.0 || all <= 1e-9 * squares[0][0] * squares[1][1] * squares[2][2] {
        return 0.0;
    }
    let solution = [0, 1, 2].map(|column| {
        let mut replaced = squares;
        for r in 0..3 {
            replaced[r][column] = products[r];
        }
        determinant(replaced) / all
    });
    let explained: f64 = (0..3).map(|r| solution[r] * products[r]).sum();
    // Per node: the residual's variance times the third diagonal element of the inverse.
    let variance = (energy - explained).max(0.0) / weights * count / (count - 3.0);
    let minor = squares[0][0] * squares[1][1] - squares[0][1] * squares[1][0];
    let error = (variance * weights / count * minor / all).sqrt();
    let missing = -solution[2];
    if missing < UNEVEN_LIMIT * solution[0] { 0.0 } else { missing / error.max(f64::MIN_POSITIVE) }
}

fn determinant(m: [[f64; 3]; 3]) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

/// A weighted mean.
#[derive(Default)]
pub(super) struct Mean {
    sum: f64,
    weight: f64,
    squares: f64,
    pub count: usize,
}

impl Mean {
    pub fn add(&mut self, value: f64, weight: f64) {
        self.sum += weight * value;
        self.weight += weight;
        self.squares += weight * weight;
        self.count += 1;
    }

    /// Standard error for unit deviation: √Σw²/Σw.
    pub fn spread(&self) -> f64 {
        self.squares.sqrt() / self.weight
    }

    pub fn value(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.sum / self.weight }
    }
}
