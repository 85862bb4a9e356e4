//! Shapes of the modes on the surface of a body: what a strike at any place excites.
//!
//! A strike of impulse J at p along n̂ gives mode m the velocity φ_m(p)·n̂ J (Φᵀ M Φ = 1). What is
//! heard of it is taken as the mean square velocity of the surface along its normal, g_m² = ∮
//! (φ_m·n̂)² dA / A, until radiation is known: relative levels.

use crate::eigenmodes::Eigenmodes;
use crate::system::System;
use crate::triangle_tree::area_vector;
use crate::vector::{Vec3, add_scaled, dot, length, unit};
use crate::volume_mesh::{EDGES, VolumeMesh};
use std::collections::HashMap;

/// Up to so many points the middles of edges are points of the field too.
const FINE_POINTS: usize = 4000;

/// A triangulated surface and the motion of its points in each mode.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceField {
    /// Points, m.
    pub points: Vec<Vec3>,
    /// Outward unit normals at the points.
    pub normals: Vec<Vec3>,
    /// Three points each, anticlockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Motion of every point, mode by mode, kg^−½.
    pub shapes: Vec<Vec<Vec3>>,
    /// g_m, root mean square of φ_m·n̂ over the surface, kg^−½.
    pub gains: Vec<f64>,
}

impl SurfaceField {
    /// φ_m·n̂ at a point.
    #[must_use]
    pub fn along_normal(&self, mode: usize, point: usize) -> f64 {
        dot(self.shapes[mode][point], self.normals[point])
    }

    /// The point where a strike excites all modes most evenly: Σ ln(φ_m·n̂)² is greatest.
    #[must_use]
    pub fn lively_point(&self) -> Option<usize> {
        let evenness = |p: usize| -> f64 {
            (0..self.shapes.len())
                .map(|m| {
                    (self.along_normal(m, p).powi(2) + 1e-4 * self.gains[m].powi(2))
                        .max(f64::MIN_POSITIVE)
                        .ln()
                })
                .sum()
        };
        let scores: Vec<f64> = (0..self.points.len()).map(evenness).collect();
        (0..scores.len()).max_by(|&a, &b| scores[a].total_cmp(&scores[b]))
    }
}

/// The surface of a solved mesh with its shapes.
#[must_use]
pub fn surface_field(volume: &VolumeMesh, system: &System, modes: &Eigenmodes) -> SurfaceField {
    let faces = volume.boundary();
    let middles = middles(system);
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    // A closed triangulation has half as many edges more as triangles.
    let fine = faces.len() * 2 + 2 <= FINE_POINTS;
    let triangles: Vec<[u32; 3]> = if fine {
        let quarters = |&[a, b, c]: &[u32; 3]| {
            let (ab, bc, ca) = (middles[&key(a, b)], middles[&key(b, c)], middles[&key(c, a)]);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces.iter().flat_map(quarters).collect()
    } else {
        faces
    };
    let mut number: HashMap<u32, u32> = HashMap::new();
    let mut nodes: Vec<u32> = Vec::new();
    let triangles: Vec<[u32; 3]> = triangles
        .into_iter()
        .map(|t| {
            t.map(|node| {
                *number.entry(node).or_insert_with(|| {
                    nodes.push(node);
                    nodes.len() as u32 - 1
                })
            })
        })
        .collect();
    let points: Vec<Vec3> = nodes.iter().map(|&n| system.nodes[n as usize]).collect();
    let shapes: Vec<Vec<Vec3>> = (0..modes.frequency_hz.len())
        .map(|m| {
            let motion = modes.motions.col_as_slice(m);
            nodes.iter().map(|&n| std::array::from_fn(|c| motion[3 * n as usize + c])).collect()
        })
        .collect();
    let mut sums = vec![[0.0; 3]; points.len()];
    let mut areas = vec![0.0; points.len()];
    for t in &triangles {
        let area = area_vector(t.map(|i| points[i as usize]));
        for &i in t {
            sums[i as usize] = add_scaled(sums[i as usize], 1.0, area);
            areas[i as usize] += length(area) / 3.0;
        }
    }
    let normals: Vec<Vec3> = sums.into_iter().map(unit).collect();
    let whole: f64 = areas.iter().sum();
    let gains = shapes
        .iter()
        .map(|shape| {
            let squares = shape.iter().zip(&normals).zip(&areas).map(|((s, n), a)| a * dot(*s, *n).powi(2));
            (squares.sum::<f64>() / whole).sqrt()
        })
        .collect();
    SurfaceField { points, normals, triangles, shapes, gains }
}

/// The node in the middle of each edge.
fn middles(system: &System) -> HashMap<[u32; 2], u32> {
    let mut middles = HashMap::new();
    for element in &system.elements {
        for (n, [a, b]) in EDGES.iter().enumerate() {
            let (a, b) = (element[*a], element[*b]);
            middles.insert([a.min(b), a.max(b)], element[4 + n]);
        }
    }
    middles
}
