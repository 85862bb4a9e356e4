//! Metres that a texture spans on the surface of a node: |∂P/∂u| and |∂P/∂v| in the scene, averaged
//! over its area.
//!
//! Tiling coordinates, `KHR_texture_transform`, matrices, scales of parents and quantised positions
//! are all in these two numbers.

use crate::error::CliError;
use asperity_shape::gltf::{Document, Placed, place};
use asperity_shape::vector::{cross, length, sub};
use serde_json::Value;

/// Side of a surface whose node has no mesh, m.
const PLAIN_SIDE_M: f64 = 0.1;
/// Widths that a scene takes, m.
const WIDTHS_M: [f64; 2] = [1e-4, 100.0];

/// Width and height of one repeat of a texture on a mesh; of the mesh's box where it has no
/// coordinates.
pub fn extent_m(
    document: &Document,
    node: &Value,
    map: &Placed,
    texture: &Value,
) -> Result<[f64; 2], CliError> {
    let index = node["mesh"].as_u64().unwrap_or(u64::MAX) as usize;
    let mesh = &document.json["meshes"][index];
    let (mut sums, mut whole) = ([0.0; 2], 0.0);
    let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
    for (p, primitive) in mesh["primitives"].as_array().into_iter().flatten().enumerate() {
        let at = format!("meshes[{index}].primitives[{p}]");
        if document.is_packed(primitive) {
            continue;
        }
        let Some((points, triangles)) = document.triangles(primitive, &at)? else { continue };
        let points: Vec<[f64; 3]> = points.into_iter().map(|p| place(map, p)).collect();
        for (p, c) in points.iter().flat_map(|p| (0..3).map(move |c| (p, c))) {
            (low[c], high[c]) = (low[c].min(p[c]), high[c].max(p[c]));
        }
        let Some(coordinates) = coordinates(document, primitive, texture, &at)? else { continue };
        for t in triangles {
            let Some(uv) = three(t.map(|i| coordinates.get(i as usize).copied())) else { continue };
            let [a, b, c] = t.map(|i| points[i as usize]);
            let (ab, ac) = (sub(b, a), sub(c, a));
            let (du, dv) =
                ([uv[1][0] - uv[0][0], uv[2][0] - uv[0][0]], [uv[1][1] - uv[0][1], uv[2][1] - uv[0][1]]);
            let determinant = du[0] * dv[1] - du[1] * dv[0];
            if determinant.abs() < 1e-12 {
                continue;
            }
            let along_u: [f64; 3] = std::array::from_fn(|k| (ab[k] * dv[1] - ac[k] * dv[0]) / determinant);
            let along_v: [f64; 3] = std::array::from_fn(|k| (ac[k] * du[0] - ab[k] * du[1]) / determinant);
            let area = 0.5 * length(cross(ab, ac));
            sums = [sums[0] + area * length(along_u), sums[1] + area * length(along_v)];
            whole += area;
        }
    }
    let held = |side: f64| side.clamp(WIDTHS_M[0], WIDTHS_M[1]);
    if whole > 0.0 {
        return Ok(sums.map(|sum| held(sum / whole)));
    }
    let mut sides: Vec<f64> = (0..3).map(|c| high[c] - low[c]).filter(|side| *side > 1e-6).collect();
    sides.sort_by(|a, b| b.total_cmp(a));
    Ok([0, 1].map(|i| sides.get(i).map_or(PLAIN_SIDE_M, |side| held(*side))))
}

/// Texture coordinates of a primitive as a texture reads them.
///
/// # Errors
/// When the accessor does not hold what it should.
pub fn coordinates(
    document: &Document,
    primitive: &Value,
    texture: &Value,
    at: &str,
) -> Result<Option<Vec<[f64; 2]>>, CliError> {
    let transform = &texture["extensions"]["KHR_texture_transform"];
    let set = transform["texCoord"].as_u64().or(texture["texCoord"].as_u64()).unwrap_or(0);
    let key = format!("TEXCOORD_{set}");
    let index = &primitive["attributes"][&key];
    if index.is_null() {
        return Ok(None);
    }
    let rows = document.accessor(index, "VEC2", &format!("{at}.attributes.{key}"))?;
    let pair = |key: &str, default: f64| -> [f64; 2] {
        [0, 1].map(|i| transform[key][i].as_f64().filter(|x| x.is_finite()).unwrap_or(default))
    };
    let scale = pair("scale", 1.0);
    let (sine, cosine) = transform["rotation"].as_f64().unwrap_or(0.0).sin_cos();
    let moved = |u: f64, v: f64| {
        let (u, v) = (u * scale[0], v * scale[1]);
        [cosine * u + sine * v, cosine * v - sine * u]
    };
    Ok(Some(rows.values.as_chunks::<2>().0.iter().map(|&[u, v]| moved(u, v)).collect()))
}

fn three<T: Copy>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}
