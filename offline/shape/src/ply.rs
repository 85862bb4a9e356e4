//! PLY, ASCII or binary: points, and faces cut into triangles; everything else is left out.

use crate::error::ShapeError;
use crate::parts::Names;
use crate::polygon;
use crate::surface_mesh::{MOST_TRIANGLES, SurfaceMesh};
use serde::Deserialize;
use serde::de::Error as _;
use serde_ply::{DeserializeError, PlyReader};
use std::borrow::Cow;
use std::io::Read;

/// Most corners of one face.
const MOST_CORNERS: usize = 10_000;

/// Bytes from the beginning in which a file says whether it is text.
const HEAD: usize = 1000;

#[derive(Deserialize)]
struct Skipped {}

#[derive(Deserialize)]
struct Vertex {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Deserialize)]
struct Face {
    #[serde(alias = "vertex_index")]
    vertex_indices: Vec<i64>,
}

/// Reads a PLY file.
///
/// # Errors
/// When it is no PLY, is cut short, names a point that is not there, or has no face.
pub(crate) fn parse(bytes: &[u8]) -> Result<(SurfaceMesh, Names), ShapeError> {
    let (vertices, faces) = elements(&with_line_feeds(bytes)).map_err(|error| {
        let what = error.to_string().replace('\n', " ");
        ShapeError::new("", format!("is no whole PLY ({what})"), "must hold vertices with x, y, z and faces")
    })?;
    let points: Vec<[f64; 3]> = vertices.iter().map(|v| [v.x, v.y, v.z]).collect();
    if let Some(i) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
        let what = format!("vertex {i} has a coordinate that is not a number");
        return Err(ShapeError::new("", what, "must be finite metres"));
    }
    let mut triangles = Vec::new();
    // Points and edges among the faces enclose nothing.
    for (i, face) in faces.iter().enumerate().filter(|(_, face)| face.vertex_indices.len() >= 3) {
        let corners = face.vertex_indices.iter().map(|&c| u32::try_from(c).ok()).collect::<Option<Vec<_>>>();
        let cut = corners
            .filter(|corners| corners.len() <= MOST_CORNERS)
            .and_then(|corners| polygon::triangles(&points, &corners));
        triangles.extend(cut.ok_or_else(|| {
            let right =
                format!("must name three vertices or more of 0 to {}", points.len().saturating_sub(1));
            ShapeError::new(format!("face {i}"), "is no face", right)
        })?);
        if triangles.len() > MOST_TRIANGLES {
            return Err(ShapeError::new("", "too many triangles", format!("at most {MOST_TRIANGLES}")));
        }
    }
    if triangles.is_empty() {
        return Err(ShapeError::new("", "has no face", "give the surface of a body, not points alone"));
    }
    Ok((SurfaceMesh { points, triangles }, Names::default()))
}

/// Vertices and faces; rows of other elements are passed over, whatever they are called.
fn elements(bytes: &[u8]) -> Result<(Vec<Vertex>, Vec<Face>), DeserializeError> {
    // The last number of a text may end with the file.
    let end: &[u8] = if is_text(bytes) { b"\n" } else { b"" };
    let mut reader = PlyReader::from_reader(bytes.chain(end))?;
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    while let Some(element) = reader.current_element() {
        // Rows without a property take no bytes, and as many as a header likes would be counted.
        if element.count > bytes.len() {
            let what = format!("{} rows of {} in {} bytes", element.count, element.name, bytes.len());
            return Err(DeserializeError::custom(what));
        }
        match element.name.as_str() {
            "vertex" => vertices = reader.next_element()?,
            "face" => faces.extend(reader.next_element::<Vec<Face>>()?),
            "tristrips" => faces.extend(reader.next_element::<Vec<Face>>()?.iter().flat_map(of_strips)),
            _ => _ = reader.next_element::<Vec<Skipped>>()?,
        }
    }
    Ok((vertices, faces))
}

/// Triangles of strips with a −1 between two, every other one turned.
fn of_strips(strips: &Face) -> Vec<Face> {
    let strips = strips.vertex_indices.split(|&corner| corner < 0);
    let all = strips.flat_map(|strip| strip.windows(3).enumerate());
    let own = all.filter(|(_, t)| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    own.map(|(i, t)| Face { vertex_indices: vec![t[i % 2], t[1 - i % 2], t[2]] }).collect()
}

fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    head.windows(12).any(|part| part == b"format ascii")
}

/// The file with a header, and a text with all its lines, that ends lines by a line feed: some
/// programs end them by a carriage return, or by both the other way round.
fn with_line_feeds(bytes: &[u8]) -> Cow<'_, [u8]> {
    const LAST: &[u8] = b"end_header";
    let mark: &[u8] = match bytes.get(3..5) {
        Some(b"\n\r") => b"\n\r",
        Some([b'\r', next]) if *next != b'\n' => b"\r",
        _ => return Cow::Borrowed(bytes),
    };
    let Some(last) = bytes.windows(LAST.len()).position(|part| part == LAST) else {
        return Cow::Borrowed(bytes);
    };
    let head = if is_text(bytes) { bytes.len() } else { (last + LAST.len() + mark.len()).min(bytes.len()) };
    let mut whole: Vec<u8> = bytes[..head].to_vec();
    whole.retain(|&byte| mark == b"\r" || byte != b'\r');
    whole.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
    whole.extend(&bytes[head..]);
    Cow::Owned(whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty uchar red\n\
         element face 1\nproperty list uchar int vertex_index\nelement edge 1\nproperty int vertex1\nend_header\n";

    #[test]
    fn text_and_binary_files_of_coloured_points_are_the_same_mesh() {
        let text = format!(
            "ply\nformat ascii 1.0\ncomment made\n{HEAD}0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0.5 9\n4 0 1 2 3\n0\n"
        );
        let mut binary = format!("ply\nformat binary_big_endian 1.0\n{HEAD}").into_bytes();
        for [x, y, z] in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.5]] {
            binary.extend((x as f32).to_be_bytes());
            binary.extend((y as f32).to_be_bytes());
            binary.extend(f64::to_be_bytes(z));
            binary.push(9);
        }
        binary.push(4);
        (0..4_i32).for_each(|i| binary.extend(i.to_be_bytes()));
        binary.extend(0_i32.to_be_bytes());
        let mesh = parse(text.as_bytes()).unwrap().0;
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.points[3], [0.0, 1.0, 0.5]);
        assert_eq!(parse(&binary).unwrap().0, mesh);
        for part in [20, 50, 90, 99] {
            assert!(parse(&binary[..binary.len() * part / 100]).is_err(), "{part}");
        }
        assert!(parse(text.replace("4 0 1 2 3", "4 0 1 2 9").as_bytes()).is_err());
    }

    #[test]
    fn rows_that_a_file_cannot_hold_are_refused_at_once() {
        let nothing =
            "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\nend_header\n";
        let error = parse(nothing.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("18446744073709551615 rows of nothing"), "{error}");
    }
}
