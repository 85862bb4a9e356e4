//! A triangle mesh with texture coordinates: from a point on it to uv, and to the axes along u and v.

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

/// A point of the mesh.
pub struct OnMesh {
    pub uv: [f64; 2],
    /// Unit vectors along which u and v grow, in the mesh's own space.
    pub axes: [Vector; 2],
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

    /// Where a point near the mesh lies on it. The triangle comes from the projection: clustered contacts
    /// of several triangles carry no single sub-shape index.
    pub fn locate(&self, shape: &TriMesh, local: Vector) -> Option<OnMesh> {
        let (_, (triangle, place)) = shape.project_local_point_and_get_location(local, false);
        let weights = place.barycentric_coordinates()?;
        let corners = *self.indices.get(triangle as usize)?;
        let mut uv = [0.0; 2];
        for (corner, weight) in corners.iter().zip(weights) {
            for (sum, x) in uv.iter_mut().zip(self.uv[*corner as usize]) {
                *sum += f64::from(weight) * x;
            }
        }
        Some(OnMesh { uv, axes: self.axes(corners)? })
    }

    /// ∂P/∂u and ∂P/∂v of a triangle, normalised.
    fn axes(&self, corners: [u32; 3]) -> Option<[Vector; 2]> {
        let [p, q, r] = corners.map(|corner| self.vertices[corner as usize]);
        let [a, b, c] = corners.map(|corner| self.uv[corner as usize]);
        let (edges, du) = ([q - p, r - p], [b[0] - a[0], c[0] - a[0]]);
        let dv = [b[1] - a[1], c[1] - a[1]];
        let area = du[0] * dv[1] - du[1] * dv[0];
        if area == 0.0 {
            return None;
        }
        let along = |first: f64, second: f64| {
            (edges[0] * (first / area) as f32 + edges[1] * (second / area) as f32).normalize_or_zero()
        };
        Some([along(dv[1], -dv[0]), along(-du[1], du[0])])
    }
}
