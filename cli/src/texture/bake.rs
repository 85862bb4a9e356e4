//! Heights of a solid as a map over a mesh: each texel is the place of the mesh that lies on it.

use crate::error::CliError;
use crate::import::extent::coordinates;
use asperity_shape::gltf::{Document, place};
use asperity_surface::raster::Raster;
use serde_json::Value;
use std::path::Path;

/// Texels around each triangle that continue its plane, so that filters meet no border.
const MARGIN_PX: f64 = 4.0;
/// Coordinates this far beyond 0 to 1 are still at the border.
const BORDER: f64 = 1e-4;

/// Map over a mesh.
pub struct Baked {
    /// Heights, m; their mean where no triangle lies.
    pub heights_m: Raster,
    /// Size of a texel on the mesh, the root of the mean of its area, m.
    pub metres_per_px: f64,
    /// Remarks on the mesh's coordinates.
    pub warnings: Vec<String>,
}

/// Triangle of a mesh on the map.
struct Laid {
    at_px: [[f64; 2]; 3],
    at_m: [[f64; 3]; 3],
}

/// Samples `height` over the surface of a glTF mesh, `size` texels a side.
///
/// # Errors
/// When the file cannot be read, has no texture coordinates, or coordinates that run beyond 0 to 1.
pub fn bake(mesh: &Path, size: usize, height: impl Fn([f64; 3]) -> f64) -> Result<Baked, CliError> {
    let triangles = laid(mesh, size)?;
    let [on_map_px2, on_mesh_m2] =
        triangles.iter().map(Laid::areas).fold([0.0; 2], |sum, [px2, m2]| [sum[0] + px2.abs(), sum[1] + m2]);
    let mut times = vec![0_u32; size * size];
    let mut heights_m = Raster::constant(size, size, 0.0);
    for margin_px in [0.0, MARGIN_PX] {
        let inside = times.clone();
        for triangle in &triangles {
            triangle.texels(size, margin_px, |texel, at_m| {
                // What lies under a triangle is not overwritten by the margin of another one.
                if margin_px == 0.0 || inside[texel] == 0 {
                    times[texel] += u32::from(margin_px == 0.0 || times[texel] == 0);
                    heights_m.values[texel] = height(at_m);
                }
            });
        }
    }
    let covered = times.iter().filter(|times| **times > 0).count().max(1) as f64;
    let laid = heights_m.values.iter().zip(&times).filter(|(_, times)| **times > 0);
    let mean_m = laid.map(|(height_m, _)| height_m).sum::<f64>() / covered;
    heights_m.values.iter_mut().zip(&times).filter(|(_, n)| **n == 0).for_each(|(h, _)| *h = mean_m);
    let twice = times.iter().filter(|times| **times > 1).count() as f64 / covered;
    let warnings = (twice > 0.02).then(|| {
        let percent = (100.0 * twice).round();
        format!("{percent} % of the texels lie under several triangles and hold one of their heights; unwrap the mesh so that none overlap")
    });
    let metres_per_px = (on_mesh_m2 / on_map_px2.max(f64::MIN_POSITIVE)).sqrt();
    Ok(Baked { heights_m, metres_per_px, warnings: warnings.into_iter().collect() })
}

/// Triangles of every node of the scene, with their coordinates.
fn laid(mesh: &Path, size: usize) -> Result<Vec<Laid>, CliError> {
    let document = Document::read(mesh)?;
    let maps = document.placed()?;
    let mut triangles = Vec::new();
    for (node, map) in document.list("nodes").iter().zip(&maps) {
        let (Some(map), Some(index)) = (map, node["mesh"].as_u64()) else { continue };
        let primitives = document.json["meshes"][index as usize]["primitives"].as_array();
        for (p, primitive) in primitives.into_iter().flatten().enumerate() {
            let at = format!("meshes[{index}].primitives[{p}]");
            if document.is_packed(primitive) {
                let right = "export the mesh without compression";
                return Err(CliError::file(mesh, format!("{at} is compressed"), right));
            }
            let Some((points, corners)) = document.triangles(primitive, &at)? else { continue };
            let uv = coordinates(&document, primitive, &Value::Null, &at)?.unwrap_or_default();
            if uv.len() < points.len() {
                let right = "unwrap it, or let `asperity import --unwrap energy` do so";
                return Err(CliError::file(mesh, format!("{at} has no texture coordinates"), right));
            }
            let beyond = uv.iter().flatten().find(|x| !(-BORDER..=1.0 + BORDER).contains(*x));
            if let Some(x) = beyond {
                let what = format!("{at} has texture coordinates that run to {x}");
                return Err(CliError::file(mesh, what, "must be 0 to 1: what repeats has no map of its own"));
            }
            triangles.extend(corners.into_iter().map(|corners| {
                let corners = corners.map(|i| i as usize);
                Laid {
                    at_px: corners.map(|i| uv[i].map(|x| x * size as f64)),
                    at_m: corners.map(|i| place(map, points[i])),
                }
            }));
        }
    }
    if triangles.is_empty() {
        return Err(CliError::file(mesh, "holds no triangle", "must hold a mesh that a node places"));
    }
    Ok(triangles)
}

impl Laid {
    /// Areas on the map, px², negative where it is turned over, and on the mesh, m².
    fn areas(&self) -> [f64; 2] {
        let [a, b, c] = self.at_px;
        let px2 = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        let [a, b, c] = self.at_m;
        let [ab, ac]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|k| p[k] - a[k]));
        let across = |i: usize, j: usize| ab[i] * ac[j] - ab[j] * ac[i];
        [px2, 0.5 * across(1, 2).hypot(across(2, 0)).hypot(across(0, 1))]
    }

    /// Texels whose middle lies in the triangle or this far from it, and their places.
    fn texels(&self, size: usize, margin_px: f64, mut each: impl FnMut(usize, [f64; 3])) {
        let [area_px2, _] = self.areas();
        if area_px2.abs() < 1e-12 {
            return;
        }
        let range = |axis: usize| {
            let along = self.at_px.map(|p| p[axis]);
            let low = along.iter().copied().fold(f64::MAX, f64::min) - margin_px - 0.5;
            let high = along.iter().copied().fold(f64::MIN, f64::max) + margin_px - 0.5;
            low.ceil().max(0.0) as usize..(high.floor() + 1.0).clamp(0.0, size as f64) as usize
        };
        for y in range(1) {
            for x in range(0) {
                let at = [x as f64 + 0.5, y as f64 + 0.5];
                let mut share = [0.0; 3];
                let mut apart_px = f64::MAX;
                for (i, share) in share.iter_mut().enumerate() {
                    let (b, c) = (self.at_px[(i + 1) % 3], self.at_px[(i + 2) % 3]);
                    let across = (c[0] - b[0]) * (at[1] - b[1]) - (c[1] - b[1]) * (at[0] - b[0]);
                    *share = 0.5 * across / area_px2;
                    let side_px = (c[0] - b[0]).hypot(c[1] - b[1]);
                    apart_px = apart_px.min(across * area_px2.signum() / side_px.max(1e-12));
                }
                if apart_px >= -margin_px {
                    let along = |k: usize| (0..3).map(|i| share[i] * self.at_m[i][k]).sum();
                    each(y * size + x, std::array::from_fn(along));
                }
            }
        }
    }
}
