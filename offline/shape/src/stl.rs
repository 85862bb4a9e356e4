//! STL: triangles by their corners, binary or ASCII.

use crate::error::ShapeError;
use crate::parts::Names;
use crate::surface_mesh::{MOST_TRIANGLES, SurfaceMesh};
use crate::text::text_of;
use crate::vector::Vec3;

/// Header and number of triangles.
const HEADER: usize = 84;
/// A normal, three corners and two bytes.
const RECORD: usize = 50;
/// Bytes from the beginning that say which of the two a file is.
const TELLING: usize = 1000;

/// Reads an STL file.
///
/// # Errors
/// When it ends too early, a number does not read or there is no triangle.
pub fn parse(bytes: &[u8]) -> Result<(SurfaceMesh, Names), ShapeError> {
    let count = bytes.get(80..HEADER).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    // Binary files may begin with `solid`, ASCII ones with a comment or a mark: length and zeros
    // tell.
    if let Some(count) = count.filter(|&count| bytes.len() == HEADER + RECORD * count) {
        return binary(bytes, count).map(|mesh| (mesh, Names::default()));
    }
    let begins = text_of(&bytes[..bytes.len().min(TELLING)]).to_lowercase();
    let ascii =
        !begins.contains('\0') && ["solid", "facet", "vertex"].iter().any(|word| begins.contains(word));
    match count {
        _ if ascii => text(&text_of(bytes)),
        // A text's letters would be counts of thousands of millions.
        _ if is_text(&bytes[..bytes.len().min(TELLING)]) => {
            Err(ShapeError::new("", "is a text without `facet`", "must be a binary or ASCII STL"))
        }
        // Some programs leave the number of triangles at 0.
        Some(0) => binary(bytes, (bytes.len() - HEADER) / RECORD).map(|mesh| (mesh, Names::default())),
        Some(count) => binary(bytes, count).map(|mesh| (mesh, Names::default())),
        None => Err(ShapeError::new("", "is cut short or no STL", "must be a binary or ASCII STL")),
    }
}

fn is_text(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace())
}

fn binary(bytes: &[u8], count: usize) -> Result<SurfaceMesh, ShapeError> {
    if count > MOST_TRIANGLES {
        return Err(ShapeError::new(
            "",
            format!("announces {count} triangles"),
            format!("at most {MOST_TRIANGLES}"),
        ));
    }
    let there = (bytes.len() - HEADER) / RECORD;
    if there < count {
        let what = format!("is cut short: {there} of {count} triangles are there");
        return Err(ShapeError::new("", what, "give the whole file"));
    }
    let number =
        |at: usize| f64::from(f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]));
    let corners = (0..count).flat_map(|t| {
        let start = HEADER + RECORD * t + 12;
        (0..3).map(move |k| std::array::from_fn(|c| number(start + 12 * k + 4 * c)))
    });
    from_corners(corners.collect())
}

fn text(text: &str) -> Result<(SurfaceMesh, Names), ShapeError> {
    let mut corners: Vec<Vec3> = Vec::new();
    let (mut names, mut named, mut ended) = (Names::default(), [None; 2], false);
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or_default().to_ascii_lowercase();
        match first.as_str() {
            "vertex" => {
                let numbers: Vec<f64> = words.filter_map(|w| w.parse().ok()).collect();
                let [x, y, z] = numbers[..] else {
                    let right = "must be `vertex X Y Z` in metres";
                    return Err(ShapeError::new(format!("line {}", number + 1), "is not a corner", right));
                };
                corners.push([x, y, z]);
                names.fill(corners.len().div_ceil(3), named);
            }
            "solid" => {
                let name = line.trim()[first.len()..].trim();
                named[0] = (!name.is_empty()).then(|| names.number(name));
            }
            "endsolid" => ended = true,
            "end" => ended |= words.next().is_some_and(|word| word.eq_ignore_ascii_case("solid")),
            _ => {}
        }
    }
    if !ended {
        return Err(ShapeError::new("", "is cut short: no `endsolid`", "give the whole file"));
    }
    Ok((from_corners(corners)?, names))
}

fn from_corners(points: Vec<Vec3>) -> Result<SurfaceMesh, ShapeError> {
    if points.is_empty() {
        return Err(ShapeError::new("", "has no triangle", "give the surface of a body"));
    }
    if !points.len().is_multiple_of(3) {
        return Err(ShapeError::new("", "its last triangle has no three corners", "give the whole file"));
    }
    if points.iter().flatten().any(|x| !x.is_finite()) {
        return Err(ShapeError::new("", "a coordinate is not a number", "must be finite metres"));
    }
    let triangles = (0..points.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok(SurfaceMesh { points, triangles })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_triangle() -> Vec<u8> {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend(1_u32.to_le_bytes());
        for x in [0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 3.0, 0.0] {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn binary_files_beginning_with_solid_are_read_and_cut_ones_refused() {
        let (mesh, _) = parse(&one_triangle()).unwrap();
        assert_eq!(mesh.points, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
        let mut cut = one_triangle();
        cut[0] = b'x';
        cut.truncate(100);
        assert!(parse(&cut).unwrap_err().what.contains("cut short"));
    }

    #[test]
    fn ascii_files_are_read_and_refused_when_cut() {
        let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e0 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
        assert_eq!(parse(text.as_bytes()).unwrap().0.triangles.len(), 1);
        assert!(parse(&text.as_bytes()[..60]).is_err());
    }

    #[test]
    fn old_spellings_marks_comments_and_trailing_bytes_are_no_reason_to_refuse() {
        let body = "Facet Normal 0 0 1\nOuter Loop\nVERTEX 0 0 0\nVertex 1e0 0 0\nvertex 0 1 0\nend loop\nend facet\n";
        for (head, end) in [
            ("SOLID A", "ENDSOLID A"),
            ("Solid a", "end solid"),
            ("\u{feff}solid a", "endsolid"),
            ("; by hand\nsolid", "endsolid"),
        ] {
            let text = format!("{head}\n{body}{end}\n");
            assert_eq!(parse(text.as_bytes()).unwrap().0.triangles.len(), 1, "{head}");
        }
        let mut trailing = one_triangle();
        trailing.extend([0, 0]);
        assert_eq!(parse(&trailing).unwrap().0.triangles.len(), 1);
        let mut uncounted = trailing.clone();
        uncounted[80..84].fill(0);
        assert_eq!(parse(&uncounted).unwrap().0.triangles.len(), 1);
    }
}
