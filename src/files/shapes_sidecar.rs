//! Shapes in a file of their own beside a modes file: plain binary, a quarter of the text's size
//! and read without parsing numbers.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `ASPSHAP1` |
//! | 4 × 4 | points, triangles, modes, struck point: `u32` |
//! | 24 × points | `points_m`: x, y, z as `f64` |
//! | 12 × triangles | three points each: `u32` |
//! | 8 × modes | `gains`: `f64` |
//! | 12 × points × modes | `phi_per_sqrt_kg`: x, y, z as `f32`, mode after mode, so that fewer modes are a prefix |
//!
//! Little-endian throughout. What begins with `glTF` is a [glTF document](super::shapes_glb) with
//! the same numbers.

use super::shapes_glb::{self, shapes_from_glb, shapes_to_glb};
use crate::model::mode_shapes::ModeShapes;

const MAGIC: &[u8; 8] = b"ASPSHAP1";

/// Writes shapes.
#[must_use]
pub fn shapes_to_bytes(shapes: &ModeShapes) -> Vec<u8> {
    let counts = [shapes.points_m.len(), shapes.triangles.len(), shapes.gains.len(), shapes.struck_point]
        .map(|n| n as u32);
    let mut bytes = MAGIC.to_vec();
    counts.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    shapes.points_m.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    shapes.triangles.iter().flatten().for_each(|i| bytes.extend(i.to_le_bytes()));
    shapes.gains.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    shapes.phi_per_sqrt_kg.iter().flatten().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

/// Writes shapes as the ending of the file's name says: a glTF document for `.glb`.
#[must_use]
pub fn shapes_to_file(shapes: &ModeShapes, name: &str) -> Vec<u8> {
    if name.to_ascii_lowercase().ends_with(".glb") { shapes_to_glb(shapes) } else { shapes_to_bytes(shapes) }
}

/// Reads shapes for so many modes.
///
/// # Errors
/// What is wrong with the file.
pub fn shapes_from_bytes(bytes: &[u8], modes: usize) -> Result<ModeShapes, String> {
    if bytes.starts_with(shapes_glb::MAGIC) {
        let shapes = shapes_from_glb(bytes, modes)?;
        shapes.check(modes)?;
        return Ok(shapes);
    }
    let mut rest = Rest(bytes);
    if rest.take::<8>() != Some(*MAGIC) {
        return Err("is no file of shapes; it must begin with ASPSHAP1 or be a .glb".to_owned());
    }
    let short = || "is cut off; write it again".to_owned();
    let mut count = || rest.u32().map(|n| n as usize).ok_or_else(short);
    let [points, triangles, held, struck_point] = [count()?, count()?, count()?, count()?];
    if held != modes {
        return Err(format!("has shapes of {held} modes; must have those of the file's {modes}"));
    }
    let (points_64, triangles_64, held_64) = (points as u64, triangles as u64, held as u64);
    let expected = 24 * points_64 + 12 * triangles_64 + 8 * held_64 + 12 * points_64 * held_64;
    if rest.0.len() as u64 != expected {
        return Err(format!("has {} bytes after its head; must have {expected}", rest.0.len()));
    }
    let shapes = ModeShapes {
        points_m: rest
            .many(points, |rest| Some([rest.f64()?, rest.f64()?, rest.f64()?]))
            .ok_or_else(short)?,
        triangles: rest
            .many(triangles, |rest| Some([rest.u32()?, rest.u32()?, rest.u32()?]))
            .ok_or_else(short)?,
        gains: rest.many(held, Rest::f64).ok_or_else(short)?,
        phi_per_sqrt_kg: rest
            .many(held, |rest| rest.many(points, |rest| Some([rest.f32()?, rest.f32()?, rest.f32()?])))
            .ok_or_else(short)?,
        struck_point,
    };
    shapes.check(modes)?;
    Ok(shapes)
}

/// Bytes that have not been read.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*head)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn f32(&mut self) -> Option<f32> {
        self.take().map(f32::from_le_bytes)
    }

    fn f64(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn many<T>(&mut self, count: usize, mut read: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..count).map(|_| read(self)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{Files, Memory};
    use crate::model::modal_model::ModalModel;
    use crate::model::mode_shapes::Unit;
    use asperity_dsp::mode::Mode;

    fn tetra() -> ModalModel {
        let mode = Mode { frequency_hz: 812.4, decay_per_s: 14.2, amplitude: 0.125, phase_rad: 1.5 };
        let shapes = ModeShapes {
            points_m: vec![[0.0, 0.0, 0.1], [1.0 / 3.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            gains: vec![0.5, 1e-7],
            phi_per_sqrt_kg: vec![vec![[0.0, 0.1, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 0.25]]; 2],
            struck_point: 2,
        };
        ModalModel::new(vec![mode, mode], 1.0).unwrap().with_shapes(shapes, Unit::Relative).unwrap()
    }

    #[test]
    fn shapes_beside_a_modes_file_come_back_to_the_last_bit() {
        let model = tetra();
        let (text, bytes) = model.to_json_beside("mug.shapes").unwrap();
        assert!(!text.contains("phi_per_sqrt_kg"));
        let mut files = Memory::new();
        files.add("bodies/mug.modes.json", text.clone());
        files.add("bodies/mug.shapes", bytes);
        assert_eq!(ModalModel::load_from(&files, "bodies/mug.modes.json").unwrap(), model);
        assert!(files.read(std::path::Path::new("bodies/mug.shapes")).is_ok());
        // As glTF places are single precision, and nothing else is.
        let (glb_text, glb) = model.to_json_beside("mug.glb").unwrap();
        files.add("bodies/glb.modes.json", glb_text);
        files.add("bodies/mug.glb", glb);
        let read = ModalModel::load_from(&files, "bodies/glb.modes.json").unwrap();
        let mut wanted = model.shapes.as_deref().unwrap().clone();
        wanted.points_m.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
        assert_eq!((read.shapes.as_deref(), &read.modes), (Some(&wanted), &model.modes));
        // Text alone does not say where its shapes are.
        let alone = ModalModel::parse(&text).unwrap_err().to_string();
        assert!(alone.contains("mug.shapes"), "{alone}");
        assert!(ModalModel::silent().to_json_beside("x").is_none());
    }

    #[test]
    fn a_place_that_a_glb_would_write_as_infinite_is_refused() {
        let mut shapes = (*tetra().shapes.unwrap()).clone();
        shapes.points_m[0][1] = 1e63;
        let refused = shapes_from_bytes(&shapes_to_bytes(&shapes), 2).unwrap_err();
        assert!(refused.contains("1000 km"), "{refused}");
    }

    #[test]
    fn a_damaged_or_missing_file_of_shapes_is_refused_by_name() {
        let (text, bytes) = tetra().to_json_beside("mug.shapes").unwrap();
        let refused = |bytes: Option<Vec<u8>>| {
            let mut files = Memory::new();
            files.add("mug.modes.json", text.clone());
            if let Some(bytes) = bytes {
                files.add("mug.shapes", bytes);
            }
            ModalModel::load_from(&files, "mug.modes.json").unwrap_err().to_string()
        };
        assert!(refused(None).contains("mug.shapes"));
        assert!(refused(Some(bytes[..bytes.len() - 1].to_vec())).contains("bytes after its head"));
        assert!(refused(Some(bytes[..20].to_vec())).contains("cut off"));
        assert!(refused(Some(b"ASPSHAP2".to_vec())).contains("ASPSHAP1"));
        for (at, value) in [(8, 0xff), (11, 0xff), (12, 9), (16, 7), (20, 9)] {
            let mut damaged = bytes.clone();
            damaged[at] = value;
            assert!(refused(Some(damaged)).contains("mug.shapes"), "byte {at}");
        }
    }
}
