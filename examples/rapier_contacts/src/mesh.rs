//! A rippled slab: a triangle mesh with texture coordinates, as a renderer and a physics engine
//! share it.

use rapier3d::prelude::*;

/// Vertices, triangles, and a texture coordinate for each vertex.
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
}
