//! Shapes beside a modes file as a glTF document of one file (`.glb`), which any viewer of meshes
//! opens: numbers where the draft `KHR_audio_rigid_bodies` has them.
//!
//! | accessor of `extensions.KHR_audio_rigid_bodies.modalModels[0]` | what |
//! |---|---|
//! | `positions` | `points_m`, `f32` |
//! | `indices` | `triangles`, `u32` (`u16` is read too) |
//! | `shapes` | `phi_per_sqrt_kg`, `f32`, mode after mode |
//! | `extras.gains`, `extras.struck_point` | what the draft has no name for, as JSON |
//!
//! The container is twelve bytes of head and two chunks (glTF 2.0 §4.4), the JSON is
//! `serde_json`'s: no crate for the rest of the format is needed.

use crate::model::mode_shapes::ModeShapes;
use serde_json::{Value, json};

pub(super) const MAGIC: &[u8; 4] = b"glTF";
const EXTENSION: &str = "KHR_audio_rigid_bodies";
const HEAD: usize = 12;
const CHUNK_HEAD: usize = 8;
const FLOAT: u64 = 5126;
const UNSIGNED_INT: u64 = 5125;
const UNSIGNED_SHORT: u64 = 5123;

/// Writes shapes. Places are rounded to single precision, which is all that the format has.
#[must_use]
pub fn shapes_to_glb(shapes: &ModeShapes) -> Vec<u8> {
    let points: Vec<[f32; 3]> = shapes.points_m.iter().map(|point| point.map(|x| x as f32)).collect();
    let motions = shapes.phi_per_sqrt_kg.iter().flatten().flatten();
    let parts: [Vec<u8>; 3] = [
        points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect(),
        shapes.triangles.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect(),
        motions.flat_map(|x| x.to_le_bytes()).collect(),
    ];
    let bound = |start: f32, of: fn(f32, f32) -> f32| {
        [0, 1, 2].map(|axis| points.iter().fold(start, |bound, point| of(bound, point[axis])))
    };
    let ([a, b, c], all) = (parts.each_ref().map(Vec::len), parts.concat());
    let view =
        |offset: usize, length: usize| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    let document = json!({
        "asset": {"version": "2.0", "generator": "asperity"},
        "buffers": [{"byteLength": all.len()}],
        "bufferViews": [view(0, a), view(a, b), view(a + b, c)],
        "accessors": [
            {"bufferView": 0, "componentType": FLOAT, "type": "VEC3", "count": points.len(),
             "min": bound(f32::INFINITY, f32::min), "max": bound(f32::NEG_INFINITY, f32::max)},
            {"bufferView": 1, "componentType": UNSIGNED_INT, "type": "SCALAR", "count": 3 * shapes.triangles.len()},
            {"bufferView": 2, "componentType": FLOAT, "type": "VEC3", "count": c / 12},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0,
        "extensionsUsed": [EXTENSION],
        "extensions": {EXTENSION: {"modalModels": [{"positions": 0, "indices": 1, "shapes": 2,
            "extras": {"gains": shapes.gains, "struck_point": shapes.struck_point}}]}},
    });
    // Chunks are multiples of 4 bytes, of spaces and of zeros.
    let chunk = |mut bytes: Vec<u8>, fill: u8, kind: &[u8; 4]| {
        bytes.resize(bytes.len().next_multiple_of(4), fill);
        [&(bytes.len() as u32).to_le_bytes()[..], kind, &bytes].concat()
    };
    let chunks = [chunk(document.to_string().into_bytes(), b' ', b"JSON"), chunk(all, 0, b"BIN\0")].concat();
    [&MAGIC[..], &2_u32.to_le_bytes(), &((HEAD + chunks.len()) as u32).to_le_bytes(), &chunks].concat()
}

/// Reads shapes for so many modes, unchecked against each other.
///
/// # Errors
/// What is wrong with the file, and where.
pub(super) fn shapes_from_glb(bytes: &[u8], modes: usize) -> Result<ModeShapes, String> {
    let document = Document::read(bytes)?;
    let model = &document.json["extensions"][EXTENSION]["modalModels"][0];
    if !model.is_object() {
        return Err(format!("has no modal model; must have extensions.{EXTENSION}.modalModels[0]"));
    }
    let points_m: Vec<[f64; 3]> =
        document.vectors(&model["positions"], "positions")?.iter().map(|p| p.map(f64::from)).collect();
    let corners = document.corners(&model["indices"])?;
    let motions = document.vectors(&model["shapes"], "shapes")?;
    let wanted = points_m.len() * modes;
    if motions.len() != wanted || wanted == 0 {
        let (found, points) = (motions.len(), points_m.len());
        return Err(format!(
            "has {found} motions; must have {wanted}, {points} points in each of the file's {modes} modes"
        ));
    }
    let extra = |key: &str| -> Result<&Value, String> {
        model["extras"].get(key).ok_or_else(|| format!("has no extras.{key}; write it again"))
    };
    let gains: Vec<f64> = serde_json::from_value(extra("gains")?.clone())
        .map_err(|error| format!("extras.gains: {error}; must be a number a mode"))?;
    let struck_point = serde_json::from_value(extra("struck_point")?.clone())
        .map_err(|error| format!("extras.struck_point: {error}; must be a point's index"))?;
    if corners.len() % 3 != 0 {
        return Err(format!("has {} corners; must have three a triangle", corners.len()));
    }
    Ok(ModeShapes {
        triangles: corners.as_chunks::<3>().0.to_vec(),
        phi_per_sqrt_kg: motions.chunks(points_m.len()).map(<[_]>::to_vec).collect(),
        points_m,
        gains,
        struck_point,
    })
}

/// A document and its only buffer.
struct Document<'a> {
    json: Value,
    numbers: &'a [u8],
}

/// Place of an accessor's elements.
struct Elements<'a> {
    bytes: &'a [u8],
    component: u64,
    stride: usize,
    count: usize,
}

impl<'a> Document<'a> {
    fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let short = || "is cut off; write it again".to_owned();
        let word = |bytes: &[u8], at: usize| {
            bytes.get(at..at + 4).and_then(|four| Some(u32::from_le_bytes(four.try_into().ok()?)))
        };
        if word(bytes, 4) != Some(2) {
            return Err("is no glTF of version 2".to_owned());
        }
        let chunk = |at: usize, kind: &[u8; 4]| {
            let length = word(bytes, at)? as usize;
            let held = bytes.get(at + 4..at + CHUNK_HEAD)? == kind;
            bytes.get(at + CHUNK_HEAD..)?.get(..length).filter(|_| held)
        };
        let text = chunk(HEAD, b"JSON").ok_or_else(short)?;
        let numbers = chunk(HEAD + CHUNK_HEAD + text.len(), b"BIN\0").ok_or_else(short)?;
        let json = serde_json::from_slice(text).map_err(|error| format!("is no glTF: {error}"))?;
        Ok(Self { json, numbers })
    }

    fn vectors(&self, accessor: &Value, name: &str) -> Result<Vec<[f32; 3]>, String> {
        let found = self.elements(accessor, "VEC3", 12).filter(|found| found.component == FLOAT);
        let found =
            found.ok_or_else(|| format!("{name} lead nowhere; must be an accessor of VEC3 as float"))?;
        let number = |bytes: &[u8]| bytes.first_chunk().map_or(0.0, |four| f32::from_le_bytes(*four));
        Ok(found.each().map(|bytes| [0, 4, 8].map(|at| number(&bytes[at..]))).collect())
    }

    fn corners(&self, accessor: &Value) -> Result<Vec<u32>, String> {
        let wrong =
            || "indices lead nowhere; must be an accessor of SCALAR as unsigned int or short".to_owned();
        let short = self.elements(accessor, "SCALAR", 2).filter(|found| found.component == UNSIGNED_SHORT);
        if let Some(found) = short {
            let number = |bytes: &[u8]| bytes.first_chunk().map_or(0, |two| u16::from_le_bytes(*two));
            return Ok(found.each().map(number).map(u32::from).collect());
        }
        let found = self.elements(accessor, "SCALAR", 4).filter(|found| found.component == UNSIGNED_INT);
        let number = |bytes: &[u8]| bytes.first_chunk().map_or(0, |four| u32::from_le_bytes(*four));
        Ok(found.ok_or_else(wrong)?.each().map(number).collect())
    }

    /// The elements of an accessor, of `size` bytes each; none where they are not all there.
    fn elements(&self, accessor: &Value, kind: &str, size: usize) -> Option<Elements<'a>> {
        let accessor = &self.json["accessors"][usize::try_from(accessor.as_u64()?).ok()?];
        let view = &self.json["bufferViews"][usize::try_from(accessor["bufferView"].as_u64()?).ok()?];
        let number = |value: &Value| usize::try_from(value.as_u64().unwrap_or(0)).ok();
        let (count, length) = (number(&accessor["count"])?, number(&view["byteLength"])?);
        let stride = number(&view["byteStride"])?.max(size);
        let (of_view, within) = (number(&view["byteOffset"])?, number(&accessor["byteOffset"])?);
        let bytes = self.numbers.get(of_view..)?.get(..length)?.get(within..)?;
        let needed =
            count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size))?;
        // Numbers of four bytes lie at multiples of four (glTF 2.0, section 3.6.2.4).
        let is_aligned = [of_view, within, stride].iter().all(|bytes| bytes.is_multiple_of(4));
        let fits =
            accessor["type"] == kind && is_aligned && needed <= bytes.len() && number(&view["buffer"])? == 0;
        fits.then(|| Elements {
            bytes,
            component: accessor["componentType"].as_u64().unwrap_or(0),
            stride,
            count,
        })
    }
}

impl<'a> Elements<'a> {
    fn each(self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.count).map(move |i| &self.bytes[i * self.stride..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetra() -> ModeShapes {
        ModeShapes {
            points_m: vec![[0.0, 0.0, 0.125], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.5]],
            triangles: vec![[0, 1, 2], [3, 2, 1]],
            gains: vec![0.3, 1e-7],
            phi_per_sqrt_kg: vec![
                vec![[0.0, 0.1, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 0.25], [1.0, 2.0, 3.0]],
                vec![[0.5, 0.1, 1.0], [0.0, 7.0, -1.0], [0.0, 0.0, 0.75], [1.0, 2.0, 4.0]],
            ],
            struck_point: 2,
        }
    }

    #[test]
    fn shapes_come_back_from_a_glb_to_the_last_bit() {
        let bytes = shapes_to_glb(&tetra());
        assert_eq!(bytes.len() % 4, 0);
        assert_eq!(bytes[8..12], (bytes.len() as u32).to_le_bytes());
        assert_eq!(shapes_from_glb(&bytes, 2).unwrap(), tetra());
    }

    #[test]
    fn a_damaged_glb_is_refused_with_a_remedy_and_never_panics() {
        let bytes = shapes_to_glb(&tetra());
        assert!(shapes_from_glb(&bytes, 3).unwrap_err().contains("must have 12"));
        for cut in 0..bytes.len() {
            assert!(shapes_from_glb(&bytes[..cut], 2).is_err(), "{cut}");
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        for (right, wrong) in [
            ("\"byteOffset\":0", "\"byteOffset\":9"),
            ("\"count\":8", "\"count\":9"),
            ("5125", "5126"),
            ("\"VEC3\"", "\"VEC2\""),
            ("\"gains\"", "\"pains\""),
            ("\"struck_point\":2", "\"struck_point\":x"),
            ("modalModels", "modalMuddle"),
            ("\"positions\":0", "\"positions\":7"),
        ] {
            assert!(text.contains(right), "{right}");
            let at = bytes.windows(right.len()).position(|window| window == right.as_bytes()).unwrap();
            let mut damaged = bytes.clone();
            damaged[at..at + right.len()].copy_from_slice(wrong.as_bytes());
            assert!(shapes_from_glb(&damaged, 2).is_err(), "{wrong}");
        }
    }
}
