//! Meshes as files: `.msh` (Gmsh 2.2 and 4.1), `.obj`, `.stl`; what a file holds, by its ending.

use crate::error::ShapeError;
use crate::mesh::Mesh;
use crate::{msh, obj, stl};
use std::path::Path;

/// Largest file that is read, bytes.
const LARGEST: u64 = 1 << 30;

/// Reads a mesh.
///
/// # Errors
/// When the file cannot be read, is not what its ending says, or ends too early; the error names file and line.
pub fn load(path: &Path) -> Result<Mesh, ShapeError> {
    let name = path.display().to_string();
    let bytes = read(path).map_err(|error| error.within(&name))?;
    parse(path, &bytes)
}

/// Reads a mesh that was loaded already; `path` is what it is called, and its ending says what it is.
///
/// # Errors
/// When the bytes are not what the ending says, or end too early; the error names file and line.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Mesh, ShapeError> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let mesh = match ending.as_str() {
        _ if bytes.is_empty() => Err(ShapeError::new("", "is empty", "give a mesh")),
        "msh" => msh::parse(bytes),
        "obj" => obj::parse(bytes).map(Mesh::Surface),
        "stl" => stl::parse(bytes).map(Mesh::Surface),
        _ => Err(ShapeError::new("", "is no kind of mesh that is read", "must end in .obj, .stl or .msh")),
    };
    mesh.map_err(|error| error.within(&path.display().to_string()))
}

fn read(path: &Path) -> Result<Vec<u8>, ShapeError> {
    let readable = |error: std::io::Error| {
        ShapeError::new("", format!("cannot be read ({error})"), "give a readable mesh file")
    };
    let size = std::fs::metadata(path).map_err(readable)?.len();
    if size > LARGEST {
        return Err(ShapeError::new("", format!("has {size} bytes"), "at most 1 GiB is read"));
    }
    std::fs::read(path).map_err(readable)
}
