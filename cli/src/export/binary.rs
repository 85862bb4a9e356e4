//! Numbers of a glTF document: one buffer, a view and an accessor for each column.

use base64::Engine as _;
use serde_json::{Value, json};

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
/// Purpose of a view: points or corners.
const VERTICES: u32 = 34962;
const CORNERS: u32 = 34963;

/// One buffer as it grows.
#[derive(Default)]
pub struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Binary {
    /// Numbers; the index of their accessor.
    pub fn scalars(&mut self, values: &[f32]) -> usize {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes());
        self.accessor(bytes, None, json!({"componentType": FLOAT, "type": "SCALAR", "count": values.len()}))
    }

    /// Vectors; of places the least and the greatest are written, as the format wants of a mesh.
    pub fn vectors<const N: usize>(&mut self, values: &[[f32; N]], places: bool) -> usize {
        let bytes = values.iter().flatten().flat_map(|x| x.to_le_bytes());
        let mut accessor = json!({"componentType": FLOAT, "type": format!("VEC{N}"), "count": values.len()});
        if places {
            let bound = |start: f32, of: fn(f32, f32) -> f32| {
                let all = |axis: usize| values.iter().fold(start, |bound, value| of(bound, value[axis]));
                (0..N).map(all).collect::<Vec<f32>>()
            };
            accessor["min"] = json!(bound(f32::INFINITY, f32::min));
            accessor["max"] = json!(bound(f32::NEG_INFINITY, f32::max));
        }
        self.accessor(bytes, places.then_some(VERTICES), accessor)
    }

    /// Corners of triangles.
    pub fn indices(&mut self, corners: &[u32]) -> usize {
        let bytes = corners.iter().flat_map(|corner| corner.to_le_bytes());
        let accessor = json!({"componentType": UNSIGNED_INT, "type": "SCALAR", "count": corners.len()});
        self.accessor(bytes, Some(CORNERS), accessor)
    }

    fn accessor(
        &mut self,
        bytes: impl Iterator<Item = u8>,
        target: Option<u32>,
        mut accessor: Value,
    ) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let mut view = json!({"buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The file: `.glb`, the buffer as its second chunk, or `.gltf`, the buffer as base64 within.
    pub fn close(self, mut document: Value, packed: bool) -> Vec<u8> {
        let Self { bytes, views, accessors } = self;
        let mut buffer = json!({"byteLength": bytes.len()});
        if !packed {
            let text = base64::engine::general_purpose::STANDARD.encode(&bytes);
            buffer["uri"] = json!(format!("data:application/octet-stream;base64,{text}"));
        }
        document["buffers"] = json!([buffer]);
        document["bufferViews"] = json!(views);
        document["accessors"] = json!(accessors);
        let json = document.to_string().into_bytes();
        if !packed {
            return json;
        }
        // Chunks are multiples of 4 bytes, of spaces and of zeros.
        let chunk = |mut bytes: Vec<u8>, fill: u8, kind: &[u8; 4]| {
            bytes.resize(bytes.len().next_multiple_of(4), fill);
            [&(bytes.len() as u32).to_le_bytes()[..], kind, &bytes].concat()
        };
        let chunks = [chunk(json, b' ', b"JSON"), chunk(bytes, 0, b"BIN\0")].concat();
        [b"glTF", &2_u32.to_le_bytes()[..], &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
    }
}
