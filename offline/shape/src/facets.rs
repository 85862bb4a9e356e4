//! Flat faces on a round body: their corners lie on the surface, so the faces between them cut
//! volume off.
//!
//! A face whose middle lies s below the surface loses ¾ s on the mean (for a face around its centre
//! the sagitta falls with the square of the distance). Moving corners out by that much gives every
//! part of the body its volume back; the error of a ball's pitches falls tenfold.

use crate::triangle_tree::TriangleTree;
use crate::triangle_tree::area_vector;
use crate::vector::{Vec3, add_scaled, distance, dot, mean, sub, unit};
use crate::volume_mesh::{VolumeMesh, tet_volume_m3};

/// Mean loss of a face, of what it loses in its middle.
const MEAN_OF_MIDDLE: f64 = 0.75;
/// Faces whose normals differ by less than this cosine belong to one side of an edge.
const SAME_SIDE: f64 = 0.7;
/// A tetrahedron keeps at least this part of its volume.
const KEPT: f64 = 0.4;

/// Moves the corners of a mesh outwards (on hollow sides: the other way) until its faces lie as
/// much above the surface as below it.
pub fn round_out(mesh: &mut VolumeMesh, surface: &TriangleTree) {
    let mut sides: Vec<Vec<(Vec3, f64, f64)>> = vec![Vec::new(); mesh.points.len()];
    for face in mesh.boundary() {
        let corners = face.map(|i| mesh.points[i as usize]);
        let middle = mean(corners);
        let Some(near) = surface.nearest(middle) else { continue };
        let normal = unit(area_vector(corners));
        let sagitta = dot(sub(near.point, middle), normal);
        let edge = distance(corners[0], corners[1]);
        // Where the nearest surface is another wall, nothing can be said.
        if near.distance > 0.25 * edge || sagitta.abs() < 0.9 * near.distance {
            continue;
        }
        for i in face {
            let at = &mut sides[i as usize];
            match at.iter_mut().find(|(n, _, _)| dot(unit(*n), normal) > SAME_SIDE) {
                Some((n, sum, count)) => {
                    *n = add_scaled(*n, 1.0, normal);
                    *sum += sagitta;
                    *count += 1.0;
                }
                None => at.push((normal, sagitta, 1.0)),
            }
        }
    }
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); mesh.points.len()];
    for (t, tet) in mesh.tets.iter().enumerate() {
        tet.iter().for_each(|&i| around[i as usize].push(t));
    }
    for (i, at) in sides.iter().enumerate() {
        let shift = at.iter().fold([0.0; 3], |sum, (n, sagitta, count)| {
            add_scaled(sum, MEAN_OF_MIDDLE * sagitta / count, unit(*n))
        });
        let before = mesh.points[i];
        let volumes: Vec<f64> =
            around[i].iter().map(|&t| tet_volume_m3(mesh.corners(mesh.tets[t]))).collect();
        mesh.points[i] = add_scaled(before, 1.0, shift);
        let squeezed = |(&t, v): (&usize, &f64)| tet_volume_m3(mesh.corners(mesh.tets[t])) < KEPT * v;
        if around[i].iter().zip(&volumes).any(squeezed) {
            mesh.points[i] = before;
        }
    }
}
