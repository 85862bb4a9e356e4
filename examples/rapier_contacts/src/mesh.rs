//! A triangle mesh with texture coordinates: from a point near it to the triangle it lies on.

use asperity::UvTriangle;
use rapier3d::parry::query::PointQueryWithLocation;
use rapier3d::parry::shape::TriMesh;
use rapier3d::prelude::*;

/// What the renderer's mesh and the collider share: vertex i of one is vertex i of the other. Keep it so:
/// rapier's flags that merge vertices renumber them, and those that delete triangles move the rest.
pub struct UvMesh {
    pub vertices: Vec<Vector>,
    pub indices: Vec<[u32; 3]>,
    pub uv: Vec<[f64; 2]>,
}

impl UvMesh {
    /// A square of `side_m` in the xz plane, rippled by `relief_m`, of `cells` × `cells` quads.
    pub fn rippled(side_m: f32, relief_m: f32, cells: u32) -> Self {
        let mut mesh = Self { vertices: Vec::new(), indices: Vec::new(), uv: Vec::new() };
        for row in 0..=cells {
            for column in 0..=cells {
                let (u, v) = (column as f32 / cells as f32, row as f32 / cells as f32);
                let y = relief_m * (6.0 * u).sin() * (6.0 * v).sin();
                mesh.vertices.push(Vector::new((u - 0.5) * side_m, y, (v - 0.5) * side_m));
                mesh.uv.push([f64::from(u), f64::from(v)]);
            }
        }
        for row in 0..cells {
            for column in 0..cells {
                let corner = row * (cells + 1) + column;
                let [a, b, c, d] = [corner, corner + 1, corner + cells + 1, corner + cells + 2];
                mesh.indices.extend([[a, c, b], [b, c, d]]);
            }
        }
        mesh
    }

    /// The triangle that a point near the mesh lies on. It comes from the projection: clustered contacts of
    /// several triangles carry no single sub-shape index.
    pub fn triangle_at(&self, shape: &TriMesh, local: Vector) -> Option<UvTriangle> {
        let (_, (triangle, _)) = shape.project_local_point_and_get_location(local, false);
        let corners = *self.indices.get(triangle as usize)?;
        UvTriangle::new(
            corners.map(|corner| self.vertices[corner as usize]),
            corners.map(|corner| self.uv[corner as usize]),
        )
    }
}
