//! Triangles: where a point lies on a mesh, as texture coordinates.

use godot::classes::Mesh;
use godot::classes::mesh::ArrayType;
use godot::prelude::*;

/// The triangles of a mesh that have texture coordinates, in the mesh's own frame.
#[derive(Default)]
pub(crate) struct Triangles {
    all: Vec<([Vector3; 3], [Vector2; 3])>,
}

impl Triangles {
    /// Triangles of all surfaces of a mesh; those without texture coordinates are left out.
    pub(crate) fn of(mesh: &Gd<Mesh>) -> Self {
        let mut all = Vec::new();
        for surface in 0..mesh.get_surface_count() {
            let arrays = mesh.surface_get_arrays(surface);
            let at = |kind: ArrayType| arrays.get(kind.ord() as usize).unwrap_or_default();
            let points = at(ArrayType::VERTEX).try_to::<PackedVector3Array>().unwrap_or_default();
            let uvs = at(ArrayType::TEX_UV).try_to::<PackedVector2Array>().unwrap_or_default();
            let (points, uvs) = (points.as_slice(), uvs.as_slice());
            let corners: Vec<usize> = match at(ArrayType::INDEX).try_to::<PackedInt32Array>() {
                Ok(indices) if !indices.is_empty() => {
                    indices.as_slice().iter().map(|i| *i as usize).collect()
                }
                _ => (0..points.len()).collect(),
            };
            for corner in corners.as_chunks::<3>().0 {
                let point = corner.map(|i| points.get(i).copied());
                let uv = corner.map(|i| uvs.get(i).copied());
                if let ([Some(a), Some(b), Some(c)], [Some(d), Some(e), Some(f)]) = (point, uv) {
                    all.push(([a, b, c], [d, e, f]));
                }
            }
        }
        Self { all }
    }

    /// The texture coordinates of the place nearest to `point`, and how the mesh runs along u and v
    /// there; none where there are none.
    pub(crate) fn uv_at(&self, point: Vector3) -> Option<(Vector2, [Vector3; 2])> {
        let mut best: Option<(f32, Vector2, [Vector3; 2])> = None;
        for (corners, uv) in &self.all {
            let weights = nearest(corners, point);
            let place = corners[0] * weights[0] + corners[1] * weights[1] + corners[2] * weights[2];
            let far = place.distance_squared_to(point);
            if best.is_none_or(|(nearest, ..)| far < nearest) {
                let here = uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2];
                best = Some((far, here, axes(corners, uv)));
            }
        }
        best.map(|(_, uv, axes)| (uv, axes))
    }
}

/// ∂P/∂u and ∂P/∂v up to a factor of one sign; zero where the texture has no area.
fn axes(corners: &[Vector3; 3], uv: &[Vector2; 3]) -> [Vector3; 2] {
    let (p, q) = (corners[1] - corners[0], corners[2] - corners[0]);
    let (s, t) = (uv[1] - uv[0], uv[2] - uv[0]);
    let sign = s.cross(t).signum();
    [(p * t.y - q * s.y) * sign, (q * s.x - p * t.x) * sign]
}

/// Factor by which another side has to be nearer than the one that a finger is on.
const HOLD: f32 = 1.2;

/// The axis that a normal is nearest to: 0, 1, 2 for x, y, z; the one before, until another is
/// clearly nearer.
pub(crate) fn side(normal: Vector3, before: Option<usize>) -> usize {
    let along = |axis: usize| {
        let own = [normal.x, normal.y, normal.z][axis].abs();
        if before == Some(axis) { HOLD * own } else { own }
    };
    [1, 0, 2].into_iter().max_by(|a, b| along(*a).total_cmp(&along(*b))).unwrap_or(1)
}

/// A vector along u and v of a side.
pub(crate) fn on_side(v: Vector3, side: usize) -> Vector2 {
    match side {
        0 => Vector2::new(v.z, v.y),
        1 => Vector2::new(v.x, v.z),
        _ => Vector2::new(v.x, v.y),
    }
}

/// Barycentric coordinates of a triangle's nearest place: by the regions of its plane (Ericson,
/// Real-Time Collision Detection, 5.1.5).
fn nearest([a, b, c]: &[Vector3; 3], p: Vector3) -> [f32; 3] {
    let (ab, ac) = (*b - *a, *c - *a);
    let from = |corner: Vector3| (ab.dot(p - corner), ac.dot(p - corner));
    let ((d1, d2), (d3, d4), (d5, d6)) = (from(*a), from(*b), from(*c));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let along = d1 / (d1 - d3);
        return [1.0 - along, along, 0.0];
    }
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let along = d2 / (d2 - d6);
        return [1.0 - along, 0.0, along];
    }
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - along, along];
    }
    let sum = va + vb + vc;
    [va / sum, vb / sum, vc / sum]
}
