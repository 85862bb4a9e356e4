//! Curved faces of tetrahedra of higher order, cut into flat triangles.
//!
//! A face with nodes in the middles of its edges is x(λ) = Σ λ_i (2 λ_i − 1) x_i + Σ 4 λ_i λ_j
//! x_ij. Of cubic elements, whose edges have two nodes each, the middle of an edge is (9 (a + b) −
//! (i + j)) / 16. The elements are solved with straight edges; `facets` moves their corners until
//! the body has the volume that the curved faces enclose.

use crate::surface_mesh::SurfaceMesh;
use crate::vector::{Vec3, add_scaled, distance};
use crate::volume_mesh::VolumeMesh;
use std::collections::HashMap;

/// Pieces of an edge: the triangles stray from the face by a sixteenth of what it strays from its
/// corners' plane.
const PIECES: usize = 4;
/// An edge is curved when its middle strays by more than this part of its length.
const CURVED: f64 = 1e-6;

/// Nodes between the two corners of an edge.
pub(crate) type Between = HashMap<[i64; 2], Vec<i64>>;

/// Puts the nodes of six edges into a map: one an edge, or two; more are in the element's inside.
pub(crate) fn between(map: &mut Between, edges: [[i64; 2]; 6], nodes: &[i64]) {
    let each = (nodes.len() / 6).min(2);
    if each > 0 {
        for ([a, b], nodes) in edges.into_iter().zip(nodes.chunks_exact(each)) {
            map.insert([a.min(b), a.max(b)], nodes.to_vec());
        }
    }
}

/// The curved boundary of a mesh; none where all its edges are straight.
pub(crate) fn surface(
    volume: &VolumeMesh,
    between: &Between,
    numbers: &HashMap<i64, u32>,
) -> Option<SurfaceMesh> {
    let place = |tag: &i64| numbers.get(tag).map(|&i| volume.points[i as usize]);
    let mut middles: HashMap<[u32; 2], Vec3> = HashMap::new();
    let mut is_curved = false;
    for (ends, nodes) in between {
        let (a, b) = (*numbers.get(&ends[0])?, *numbers.get(&ends[1])?);
        let (from, to) = (volume.points[a as usize], volume.points[b as usize]);
        let sum = add_scaled(from, 1.0, to);
        let middle = match nodes[..] {
            [m] => place(&m)?,
            [i, j] => {
                add_scaled(sum.map(|x| 9.0 * x / 16.0), -1.0 / 16.0, add_scaled(place(&i)?, 1.0, place(&j)?))
            }
            _ => return None,
        };
        is_curved |= distance(middle, sum.map(|x| 0.5 * x)) > CURVED * distance(from, to);
        middles.insert([a.min(b), a.max(b)], middle);
    }
    if !is_curved {
        return None;
    }
    let mut surface = SurfaceMesh::default();
    for face in volume.boundary() {
        let corners = face.map(|i| volume.points[i as usize]);
        let middle = |i: usize, j: usize| middles.get(&[face[i].min(face[j]), face[i].max(face[j])]).copied();
        let mid = [middle(0, 1)?, middle(1, 2)?, middle(2, 0)?];
        let first = surface.points.len() as u32;
        let mut number = HashMap::new();
        for i in 0..=PIECES {
            for j in 0..=PIECES - i {
                let l = [PIECES - i - j, i, j].map(|n| n as f64 / PIECES as f64);
                let on_corners =
                    (0..3).fold([0.0; 3], |p, k| add_scaled(p, l[k] * (2.0 * l[k] - 1.0), corners[k]));
                let p = (0..3).fold(on_corners, |p, k| add_scaled(p, 4.0 * l[k] * l[(k + 1) % 3], mid[k]));
                number.insert((i, j), first + number.len() as u32);
                surface.points.push(p);
            }
        }
        for (&(i, j), &a) in &number {
            let at = |i: usize, j: usize| number.get(&(i, j)).copied();
            if let (Some(b), Some(c)) = (at(i + 1, j), at(i, j + 1)) {
                surface.triangles.push([a, b, c]);
                surface.triangles.extend(at(i + 1, j + 1).map(|d| [b, d, c]));
            }
        }
    }
    Some(surface.in_order())
}
