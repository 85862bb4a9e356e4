//! glTF 2.0: the triangles of every node of the scene, where the node places them.
//!
//! Read here by `serde_json`, which is there already: the crate `gltf` costs the first build an
//! eighth of all its time.

mod document;

pub use document::{Document, Rows};

use crate::error::ShapeError;
use crate::parts::Names;
use crate::surface_mesh::{MOST_TRIANGLES, SurfaceMesh};
use crate::vector::Vec3;
use serde_json::Value;
use std::path::Path;

/// A node's map to the scene: the images of x, y and z, and of the origin.
pub type Placed = [Vec3; 4];

const IDENTITY: Placed = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
/// Deepest nesting of nodes.
const DEEPEST: usize = 1000;

/// A place in a node's frame, in the scene.
#[must_use]
pub fn place(map: &Placed, p: Vec3) -> Vec3 {
    std::array::from_fn(|c| map[0][c] * p[0] + map[1][c] * p[1] + map[2][c] * p[2] + map[3][c])
}

/// Points, and the three of each triangle.
pub type Triangles = (Vec<Vec3>, Vec<[u32; 3]>);

impl Document {
    /// The map of every node to the scene; none where a node is not reached from a root.
    ///
    /// # Errors
    /// When nodes are nested in a circle.
    pub fn placed(&self) -> Result<Vec<Option<Placed>>, ShapeError> {
        let nodes = self.list("nodes");
        let children = |node: &Value| -> Vec<usize> {
            let list = node["children"].as_array().map_or(&[][..], Vec::as_slice);
            list.iter().filter_map(|i| i.as_u64().map(|i| i as usize)).filter(|&i| i < nodes.len()).collect()
        };
        let mut is_child = vec![false; nodes.len()];
        nodes.iter().flat_map(children).for_each(|i| is_child[i] = true);
        let mut maps = vec![None; nodes.len()];
        let roots = (0..nodes.len()).filter(|&i| !is_child[i]);
        let mut open: Vec<(usize, Placed, usize)> = roots.map(|i| (i, IDENTITY, 0)).collect();
        while let Some((i, parent, depth)) = open.pop() {
            if maps[i].is_some() || depth > DEEPEST {
                return Err(self.wrong(
                    format!("nodes[{i}]"),
                    "has two parents",
                    "nodes must be nested as a tree",
                ));
            }
            let own = own_map(&nodes[i]);
            let turned = |v: Vec3| place(&[parent[0], parent[1], parent[2], [0.0; 3]], v);
            let map = [turned(own[0]), turned(own[1]), turned(own[2]), place(&parent, own[3])];
            maps[i] = Some(map);
            open.extend(children(&nodes[i]).into_iter().map(|child| (child, map, depth + 1)));
        }
        Ok(maps)
    }

    /// Positions of a primitive in its node's frame, and its triangles; none where it is lines or
    /// points, or packed.
    ///
    /// # Errors
    /// When accessors do not hold what they should.
    pub fn triangles(&self, primitive: &Value, at: &str) -> Result<Option<Triangles>, ShapeError> {
        let mode = primitive["mode"].as_u64().unwrap_or(4);
        let positions = &primitive["attributes"]["POSITION"];
        if !(4..=6).contains(&mode) || positions.is_null() {
            return Ok(None);
        }
        let points = self.accessor(positions, "VEC3", &format!("{at}.attributes.POSITION"))?.triples();
        let corners: Vec<u32> = if primitive["indices"].is_null() {
            (0..points.len() as u32).collect()
        } else {
            let rows = self.accessor(&primitive["indices"], "SCALAR", &format!("{at}.indices"))?;
            rows.values.iter().map(|&i| i as u32).collect()
        };
        if corners.iter().any(|&i| i as usize >= points.len()) {
            return Err(self.wrong(
                format!("{at}.indices"),
                "names a point that is not there",
                "must be lower",
            ));
        }
        let triangles = match mode {
            4 => corners.as_chunks().0.to_vec(),
            5 => (corners.windows(3).enumerate())
                .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
                .collect(),
            _ => corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]).collect(),
        };
        Ok(Some((points, triangles)))
    }
}

/// A node's own map: its matrix, or scale, rotation and translation.
fn own_map(node: &Value) -> Placed {
    let numbers =
        |key: &str| -> Option<Vec<f64>> { node[key].as_array()?.iter().map(Value::as_f64).collect() };
    if let Some(&[a, b, c, _, d, e, f, _, g, h, i, _, x, y, z, _]) = numbers("matrix").as_deref() {
        return [[a, b, c], [d, e, f], [g, h, i], [x, y, z]];
    }
    let scale = numbers("scale").and_then(|s| s.try_into().ok()).unwrap_or([1.0; 3]);
    let at = numbers("translation").and_then(|t| t.try_into().ok()).unwrap_or([0.0; 3]);
    let [x, y, z, w] = numbers("rotation").and_then(|q| q.try_into().ok()).unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let turned: [Vec3; 3] = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
        [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
        [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
    ];
    [0, 1, 2]
        .map(|k| turned[k].map(|t| t * scale[k]))
        .into_iter()
        .chain([at])
        .collect::<Vec<_>>()
        .try_into()
        .unwrap_or(IDENTITY)
}

/// Reads the surface that all nodes of a document make together.
///
/// # Errors
/// When it is no glTF, its buffers are not there, or it has no triangle.
pub(crate) fn parse(path: &Path, bytes: &[u8]) -> Result<(SurfaceMesh, Names), ShapeError> {
    // The caller puts the path before every error.
    let document = Document::parse(path, bytes).map_err(stripped(path))?;
    surface(&document).map_err(stripped(path))
}

fn stripped(path: &Path) -> impl Fn(ShapeError) -> ShapeError {
    let name = path.display().to_string();
    move |mut error| {
        let at = error.at.strip_prefix(&name).map(|at| at.trim_start_matches(": ").to_owned());
        error.at = at.unwrap_or(error.at);
        error
    }
}

fn surface(document: &Document) -> Result<(SurfaceMesh, Names), ShapeError> {
    let (mut surface, mut names) = (SurfaceMesh::default(), Names::default());
    let mut packed = false;
    for (node, map) in document.list("nodes").iter().zip(document.placed()?) {
        let (Some(map), Some(index)) = (map, node["mesh"].as_u64()) else { continue };
        let mesh = &document.json["meshes"][index as usize];
        let named = [node, mesh].map(|of| of["name"].as_str().map(|name| names.number(name)));
        for (p, primitive) in mesh["primitives"].as_array().into_iter().flatten().enumerate() {
            packed |= document.is_packed(primitive);
            let at = format!("meshes[{index}].primitives[{p}]");
            if document.is_packed(primitive) {
                continue;
            }
            let Some((points, triangles)) = document.triangles(primitive, &at)? else { continue };
            let first = surface.points.len() as u32;
            surface.points.extend(points.into_iter().map(|p| place(&map, p)));
            surface.triangles.extend(triangles.into_iter().map(|t| t.map(|i| i + first)));
            names.fill(surface.triangles.len(), named);
            if surface.triangles.len() > MOST_TRIANGLES {
                let right = format!("at most {MOST_TRIANGLES}");
                return Err(ShapeError::new("meshes", "hold too many triangles", right));
            }
        }
    }
    if !surface.triangles.is_empty() && !packed {
        return Ok((surface, names));
    }
    let (what, right) = if packed {
        ("is packed by Draco or meshopt", "save it without compression")
    } else {
        ("has no triangle in a node", "give a document with a mesh that a node places")
    };
    Err(ShapeError::new("", what, right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use base64::Engine as _;

    #[test]
    fn a_quantised_mesh_stands_where_its_parents_put_it() {
        // One triangle of normalised bytes, halved by a matrix, turned a quarter around z, and
        // moved by its parent.
        let bytes: [i8; 12] = [0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0];
        let data = base64::engine::general_purpose::STANDARD.encode(bytes.map(|b| b as u8));
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_mesh_quantization"],
            "nodes":[{{"children":[1],"translation":[1,2,3],"rotation":[0,0,0.7071067811865476,0.7071067811865476]}},
            {{"name":"lid","mesh":0,"matrix":[0.5,0,0,0,0,0.5,0,0,0,0,0.5,0,0,0,0,1]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":12,"byteStride":4}}],
            "buffers":[{{"byteLength":12,"uri":"data:application/octet-stream;base64,{data}"}}]}}"#
        );
        let (mesh, _) = parse(Path::new("lid.gltf"), text.as_bytes()).unwrap();
        for (p, q) in mesh.points.iter().zip([[1.0, 2.0, 3.0], [1.0, 2.5, 3.0], [0.5, 2.0, 3.0]]) {
            assert!((0..3).all(|c| (p[c] - q[c]).abs() < 1e-12), "{p:?} {q:?}");
        }
    }
}
