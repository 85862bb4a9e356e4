//! Nested dissection: an order of elimination that keeps the Cholesky factor of a solid body small.
//!
//! A body is cut in two across its longest extent; the nodes of the cut come last, and each half is
//! cut again. What is eliminated in one half then never fills the other (George 1973). For n
//! unknowns of a solid the factor grows as n^(4/3) and its work as n², where a minimum-degree
//! order, which looks at neighbours only, loses a factor of two or more; of shells and bars that
//! order is as good or better, so both are tried (`factor`).

use crate::vector::Vec3;

/// Parts of so few nodes are not cut any more.
const LEAF: usize = 24;
/// Cuts that are tried, as shares of the nodes below them: so many, from this one to as much above
/// a half. The one with the fewest nodes on it is taken; of several as small, the one nearest to
/// the middle.
const TRIED: usize = 21;
const LEAST_SHARE: f64 = 0.4;

/// Neighbours of every node.
struct Graph {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// From the pairs of a symmetric pattern, each stated once.
    fn of(nodes: usize, pairs: &mut dyn Iterator<Item = (u32, u32)>) -> Self {
        let pairs: Vec<(u32, u32)> = pairs.filter(|(a, b)| a != b).collect();
        let mut starts = vec![0_u32; nodes + 1];
        for &(a, b) in &pairs {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for i in 0..nodes {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; 2 * pairs.len()];
        for (a, b) in pairs {
            for (from, to) in [(a, b), (b, a)] {
                let at = &mut next[from as usize];
                neighbours[*at as usize] = to;
                *at += 1;
            }
        }
        Self { starts, neighbours }
    }

    fn around(&self, node: u32) -> &[u32] {
        &self.neighbours[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }
}

/// Which part a node of the piece at hand is in.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Elsewhere,
    Below,
    Above,
    Cut,
}

/// The nodes in the order in which they are eliminated; `pairs` are the places of the matrix, each
/// stated once.
pub fn order(nodes: &[Vec3], pairs: &mut dyn Iterator<Item = (u32, u32)>) -> Vec<u32> {
    let graph = Graph::of(nodes.len(), pairs);
    let mut side = vec![Side::Elsewhere; nodes.len()];
    let mut ordered = Vec::with_capacity(nodes.len());
    // Pieces to cut, and cuts that wait for both of their halves; the last one is next.
    let mut waiting: Vec<(Vec<u32>, bool)> = vec![((0..nodes.len() as u32).collect(), true)];
    while let Some((mut piece, whole)) = waiting.pop() {
        if !whole || piece.len() <= LEAF {
            ordered.append(&mut piece);
            continue;
        }
        let [below, above, cut] = halves(&mut piece, nodes, &graph, &mut side);
        if below.is_empty() && above.is_empty() {
            ordered.extend(cut);
            continue;
        }
        waiting.extend([(cut, false), (above, true), (below, true)]);
    }
    ordered
}

/// Cuts a piece across its longest extent: what is below, what is above, and the nodes between.
fn halves(piece: &mut [u32], nodes: &[Vec3], graph: &Graph, side: &mut [Side]) -> [Vec<u32>; 3] {
    let extent = |axis: usize| {
        let along = piece.iter().map(|&n| nodes[n as usize][axis]);
        let (low, high) = along.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let extents = [0, 1, 2].map(extent);
    let axis = (0..3).max_by(|&a, &b| extents[a].total_cmp(&extents[b])).unwrap_or(0);
    piece.sort_unstable_by(|&a, &b| {
        nodes[a as usize][axis].total_cmp(&nodes[b as usize][axis]).then(a.cmp(&b))
    });
    let best = (0..TRIED)
        .map(|i| LEAST_SHARE + (1.0 - 2.0 * LEAST_SHARE) * i as f64 / (TRIED - 1) as f64)
        .flat_map(|share| {
            let at = ((share * piece.len() as f64) as usize).clamp(1, piece.len() - 1);
            [(at, Side::Below), (at, Side::Above)]
        })
        .min_by_key(|&(at, from)| (cut_of(piece, at, from, graph, side).len(), at.abs_diff(piece.len() / 2)));
    let Some((at, from)) = best else { return [Vec::new(), Vec::new(), piece.to_vec()] };
    let cut = cut_of(piece, at, from, graph, side);
    mark(piece, at, side);
    cut.iter().for_each(|&n| side[n as usize] = Side::Cut);
    let part = |which: Side| piece.iter().copied().filter(|&n| side[n as usize] == which).collect();
    let (below, above) = (part(Side::Below), part(Side::Above));
    piece.iter().for_each(|&n| side[n as usize] = Side::Elsewhere);
    [below, above, cut]
}

fn mark(piece: &[u32], at: usize, side: &mut [Side]) {
    for (i, &n) in piece.iter().enumerate() {
        side[n as usize] = if i < at { Side::Below } else { Side::Above };
    }
}

/// The nodes of one side that touch the other, when a sorted piece is cut before its node `at`.
fn cut_of(piece: &[u32], at: usize, from: Side, graph: &Graph, side: &mut [Side]) -> Vec<u32> {
    mark(piece, at, side);
    let (these, other) = match from {
        Side::Below => (&piece[..at], Side::Above),
        _ => (&piece[at..], Side::Below),
    };
    let touches = |n: u32| graph.around(n).iter().any(|&m| side[m as usize] == other);
    let cut = these.iter().copied().filter(|&n| touches(n)).collect();
    piece.iter().for_each(|&n| side[n as usize] = Side::Elsewhere);
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of n³ nodes, each joined to its neighbours along the axes.
    fn grid(n: u32) -> (Vec<Vec3>, Vec<(u32, u32)>) {
        let index = |i: u32, j: u32, k: u32| i + n * (j + n * k);
        let (mut nodes, mut pairs) = (Vec::new(), Vec::new());
        for k in 0..n {
            for j in 0..n {
                for i in 0..n {
                    nodes.push([i, j, k].map(f64::from));
                    let here = index(i, j, k);
                    pairs.push((here, here));
                    for (inside, other) in
                        [(i + 1 < n, [i + 1, j, k]), (j + 1 < n, [i, j + 1, k]), (k + 1 < n, [i, j, k + 1])]
                    {
                        if inside {
                            pairs.push((here, index(other[0], other[1], other[2])));
                        }
                    }
                }
            }
        }
        (nodes, pairs)
    }

    #[test]
    fn every_node_comes_once_and_a_cube_is_cut_by_a_plane() {
        let (nodes, pairs) = grid(8);
        let order = order(&nodes, &mut pairs.into_iter());
        let mut seen = order.clone();
        seen.sort_unstable();
        assert_eq!(seen, (0..512).collect::<Vec<u32>>());
        let last = &order[512 - 64..];
        let plane = (0..3).any(|axis| {
            let at = nodes[last[0] as usize][axis];
            last.iter().all(|&n| nodes[n as usize][axis] == at)
        });
        assert!(plane, "{last:?}");
    }

    #[test]
    fn points_in_one_place_and_no_points_are_ordered_too() {
        assert!(order(&[], &mut std::iter::empty()).is_empty());
        let same = vec![[1.0; 3]; 100];
        let mut chain = (1..100).map(|i| (i - 1, i));
        let mut order = order(&same, &mut chain);
        order.sort_unstable();
        assert_eq!(order, (0..100).collect::<Vec<u32>>());
    }
}
