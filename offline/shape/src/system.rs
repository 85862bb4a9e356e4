//! Stiffness and mass of a body: K and M of M ü + K u = 0, sparse, from its quadratic tetrahedra.
//!
//! M couples a node's three directions alike, so it is kept as one number a pair of nodes; of K,
//! which is symmetric, only the lower triangle is kept.

use crate::elastic::Elastic;
use crate::quadratic_tet::{NODES, mass_share_420, stiffness};
use crate::vector::{Vec3, mean};
use crate::volume_mesh::{EDGES, VolumeMesh, tet_volume_m3};
use std::collections::HashMap;

/// A symmetric sparse pattern over nodes: the lower triangle, column by column, rows rising.
#[derive(Debug, Default)]
struct Pattern {
    starts: Vec<usize>,
    rows: Vec<u32>,
}

impl Pattern {
    fn of(elements: &[[u32; NODES]], nodes: usize) -> Self {
        let mut pairs: Vec<u64> = Vec::with_capacity(elements.len() * NODES * (NODES + 1) / 2);
        for element in elements {
            for &a in element {
                pairs.extend(
                    element.iter().filter(|&&b| b >= a).map(|&b| (u64::from(a) << 32) | u64::from(b)),
                );
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let mut starts = vec![0; nodes + 1];
        for pair in &pairs {
            starts[(pair >> 32) as usize + 1] += 1;
        }
        for i in 0..nodes {
            starts[i + 1] += starts[i];
        }
        Self { starts, rows: pairs.iter().map(|pair| *pair as u32).collect() }
    }

    fn column(&self, node: usize) -> std::ops::Range<usize> {
        self.starts[node]..self.starts[node + 1]
    }

    fn position(&self, column: u32, row: u32) -> usize {
        let range = self.column(column as usize);
        range.start + self.rows[range].partition_point(|&r| r < row)
    }
}

/// K and M of a body.
#[derive(Debug)]
pub struct System {
    /// Places of the nodes, m: corners first, then the middles of edges.
    pub nodes: Vec<Vec3>,
    /// The ten nodes of each element.
    pub elements: Vec<[u32; NODES]>,
    pattern: Pattern,
    /// A 3 × 3 block (row-major) for each place of the pattern, N/m.
    stiffness: Vec<[f64; 9]>,
    /// One number for each place of the pattern, kg.
    mass: Vec<f64>,
}

impl System {
    /// Numbers the nodes and sums the elements.
    #[must_use]
    pub fn assemble(mesh: &VolumeMesh, material: &Elastic) -> Self {
        let (nodes, elements) = number_nodes(mesh);
        let pattern = Pattern::of(&elements, nodes.len());
        let mut stiffness_blocks = vec![[0.0; 9]; pattern.rows.len()];
        let mut mass = vec![0.0; pattern.rows.len()];
        for (tet, element) in mesh.tets.iter().zip(&elements) {
            let corners = mesh.corners(*tet);
            let k = stiffness(corners, material);
            let mass_kg = material.density_kg_m3 * tet_volume_m3(corners);
            for a in 0..NODES {
                for b in (0..NODES).filter(|&b| element[b] >= element[a]) {
                    let at = pattern.position(element[a], element[b]);
                    for (i, x) in stiffness_blocks[at].iter_mut().enumerate() {
                        *x += k[b][a][i / 3][i % 3];
                    }
                    mass[at] += mass_kg * mass_share_420(a, b) / 420.0;
                }
            }
        }
        Self { nodes, elements, pattern, stiffness: stiffness_blocks, mass }
    }

    /// Unknown displacements.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        3 * self.nodes.len()
    }

    /// Mass of the body, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        let columns = (0..self.nodes.len()).flat_map(|c| self.pattern.column(c).map(move |at| (c, at)));
        columns
            .map(|(c, at)| self.mass[at] * if self.pattern.rows[at] as usize == c { 1.0 } else { 2.0 })
            .sum()
    }

    /// The pairs of nodes that an element joins, each once, and each node with itself.
    pub fn pairs(&self) -> impl Iterator<Item = (u32, u32)> {
        let columns = (0..self.nodes.len()).map(|c| (c as u32, self.pattern.column(c)));
        columns.flat_map(|(column, range)| self.pattern.rows[range].iter().map(move |&row| (column, row)))
    }

    /// The lower triangle of K − σM: column starts, rows and values.
    #[must_use]
    pub fn shifted(&self, sigma: f64) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
        let entries = 9 * self.pattern.rows.len() - 3 * self.nodes.len();
        let (mut starts, mut rows, mut values) = (
            Vec::with_capacity(self.unknowns() + 1),
            Vec::with_capacity(entries),
            Vec::with_capacity(entries),
        );
        starts.push(0);
        for node in 0..self.nodes.len() {
            for direction in 0..3 {
                for at in self.pattern.column(node) {
                    let row = self.pattern.rows[at] as usize;
                    let first = if row == node { direction } else { 0 };
                    for i in first..3 {
                        let mass = if i == direction { self.mass[at] } else { 0.0 };
                        rows.push((3 * row + i) as u32);
                        values.push(self.stiffness[at][3 * i + direction] - sigma * mass);
                    }
                }
                starts.push(rows.len() as u32);
            }
        }
        (starts, rows, values)
    }

    /// `out` = M v, kg·m.
    pub fn times_mass(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for column in 0..self.nodes.len() {
            for at in self.pattern.column(column) {
                let (row, m) = (self.pattern.rows[at] as usize, self.mass[at]);
                for i in 0..3 {
                    out[3 * row + i] += m * v[3 * column + i];
                }
                if row != column {
                    for i in 0..3 {
                        out[3 * column + i] += m * v[3 * row + i];
                    }
                }
            }
        }
    }

    /// `out` = K v, N.
    pub fn times_stiffness(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for column in 0..self.nodes.len() {
            for at in self.pattern.column(column) {
                let (row, k) = (self.pattern.rows[at] as usize, &self.stiffness[at]);
                for i in 0..3 {
                    for j in 0..3 {
                        out[3 * row + i] += k[3 * i + j] * v[3 * column + j];
                        if row != column {
                            out[3 * column + j] += k[3 * i + j] * v[3 * row + i];
                        }
                    }
                }
            }
        }
    }
}

/// Corners keep their numbers; each edge's middle gets one after them.
fn number_nodes(mesh: &VolumeMesh) -> (Vec<Vec3>, Vec<[u32; NODES]>) {
    let mut nodes = mesh.points.clone();
    let mut middles: HashMap<[u32; 2], u32> = HashMap::with_capacity(mesh.tets.len() * 2);
    let elements = mesh
        .tets
        .iter()
        .map(|tet| {
            std::array::from_fn(|n| {
                if n < 4 {
                    return tet[n];
                }
                let [a, b] = EDGES[n - 4].map(|i| tet[i]);
                *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    nodes.push(mean([mesh.points[a as usize], mesh.points[b as usize]]));
                    nodes.len() as u32 - 1
                })
            })
        })
        .collect();
    (nodes, elements)
}
