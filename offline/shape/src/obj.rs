//! Wavefront OBJ: `v` and `f` lines, polygons cut into triangles, and `o` and `g` as names of
//! parts; everything else is left out.

use crate::error::ShapeError;
use crate::parts::Names;
use crate::polygon;
use crate::surface_mesh::{MOST_TRIANGLES, SurfaceMesh};
use crate::text::text_of;

/// Reads the text of an OBJ file.
///
/// # Errors
/// When a number does not read, a face names a point that is not there, or there is no face.
pub fn parse(bytes: &[u8]) -> Result<(SurfaceMesh, Names), ShapeError> {
    let text = text_of(bytes);
    let (mut mesh, mut names, mut named) = (SurfaceMesh::default(), Names::default(), [None; 2]);
    let mut lines = text.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let at = || format!("line {}", number + 1);
        // A line that ends with \ goes on in the next.
        let mut whole = String::new();
        let mut line = line.trim();
        while let Some(part) = line.strip_suffix('\\') {
            whole.push_str(part);
            whole.push(' ');
            line = lines.next().map_or("", |(_, next)| next.trim());
        }
        if !whole.is_empty() {
            whole.push_str(line);
            line = &whole;
        }
        let mut words = line.split_whitespace().take_while(|word| !word.starts_with('#'));
        match words.next() {
            Some("v") => mesh.points.push(point(words).map_err(|error| error.within(&at()))?),
            Some(kind @ ("o" | "g")) => {
                let name = line[1..].trim();
                named[usize::from(kind == "g")] = (!name.is_empty()).then(|| names.number(name));
            }
            Some("f") => {
                let corners = words
                    .map(|word| corner(word, mesh.points.len()))
                    .collect::<Option<Vec<u32>>>()
                    .filter(|corners| corners.len() >= 3);
                let cut = corners.and_then(|corners| polygon::triangles(&mesh.points, &corners));
                let cut = cut.ok_or_else(|| {
                    let right = format!("must name three points or more of 1 to {}", mesh.points.len());
                    ShapeError::new(at(), format!("`{line}` is not a face"), right)
                })?;
                mesh.triangles.extend(cut);
                names.fill(mesh.triangles.len(), named);
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
    Ok((mesh, names))
}

fn point<'a>(words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], ShapeError> {
    let numbers: Vec<f64> = words.take(3).filter_map(|w| w.parse().ok()).collect();
    let [x, y, z] = numbers[..] else {
        return Err(ShapeError::new("", "is not a point", "must be `v X Y Z` in metres"));
    };
    if x.is_finite() && y.is_finite() && z.is_finite() {
        return Ok([x, y, z]);
    }
    Err(ShapeError::new("", "has a coordinate that is not a number", "must be finite metres"))
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
        let (mesh, _) = parse(text).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn early_marks_and_lines_that_continue_lose_nothing() {
        let text = b"\xef\xbb\xbfv 0 0 0\rv 1 \\\r 0 0\rv 1 1 0\rf 1 \\\r2 \\\r3\r";
        let (mesh, _) = parse(text).unwrap();
        assert_eq!(mesh.points, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
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
