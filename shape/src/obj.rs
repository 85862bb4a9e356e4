//! Wavefront OBJ: `v` and `f` lines; polygons are cut into fans, everything else is left out.

use crate::error::ShapeError;
use crate::surface_mesh::{MOST_TRIANGLES, SurfaceMesh};

/// Reads the text of an OBJ file.
///
/// # Errors
/// When a number does not read, a face names a point that is not there, or there is no face.
pub fn parse(bytes: &[u8]) -> Result<SurfaceMesh, ShapeError> {
    let text = std::str::from_utf8(bytes)
        .map_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect::<String>(), str::to_owned);
    let mut mesh = SurfaceMesh::default();
    for (number, line) in text.lines().enumerate() {
        let at = || format!("line {}", number + 1);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.take(3).filter_map(|w| w.parse().ok()).collect();
                let [x, y, z] = numbers[..] else {
                    return Err(ShapeError::new(at(), "is not a point", "must be `v X Y Z` in metres"));
                };
                if !(x.is_finite() && y.is_finite() && z.is_finite()) {
                    return Err(ShapeError::new(
                        at(),
                        "has a coordinate that is not a number",
                        "must be finite metres",
                    ));
                }
                mesh.points.push([x, y, z]);
            }
            Some("f") => {
                let corners = words
                    .map(|word| corner(word, mesh.points.len()))
                    .collect::<Option<Vec<u32>>>()
                    .filter(|corners| corners.len() >= 3)
                    .ok_or_else(|| {
                        let right = format!("must name three points or more of 1 to {}", mesh.points.len());
                        ShapeError::new(at(), format!("`{}` is not a face", line.trim()), right)
                    })?;
                mesh.triangles
                    .extend((1..corners.len() - 1).map(|i| [corners[0], corners[i], corners[i + 1]]));
                if mesh.triangles.len() > MOST_TRIANGLES {
                    return Err(ShapeError::new(
                        at(),
                        "too many triangles",
                        format!("at most {MOST_TRIANGLES}"),
                    ));
                }
            }
            _ => {}
        }
    }
    if mesh.triangles.is_empty() {
        return Err(ShapeError::new("", "has no face", "give the surface of a body (`v` and `f` lines)"));
    }
    Ok(mesh)
}

/// `7`, `7/1`, `7//3` or, counted from the end, `-1`.
fn corner(word: &str, points: usize) -> Option<u32> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = if number < 0 { points as i64 + number } else { number - 1 };
    (0..points as i64).contains(&index).then_some(index as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_texture_indices_and_counting_from_the_end_are_read() {
        let text = b"# box\nv 0 0 0\nv 1 0 0 1 0 0\nvn 0 0 1\nv 1 1 0\nv 0 1 0\nf 1/1 2/2/1 3//1 -1\n";
        let mesh = parse(text).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, line) in [("v 0 0\n", "line 1"), ("v 0 0 0\nf 1 1 9\n", "line 2"), ("v 0 nan 0", "line 1")]
        {
            assert!(parse(text.as_bytes()).unwrap_err().to_string().contains(line), "{text}");
        }
        assert!(parse(b"hello").is_err());
    }
}
