//! Meshes as files: `.msh` (Gmsh 2.2 and 4.1), `.obj`, `.stl`, `.ply`, `.glb`, `.gltf`; what a file
//! holds, by its ending.

use crate::error::ShapeError;
use crate::mesh::Mesh;
use crate::parts::{Names, part};
use crate::{gltf, msh, obj, ply, stl};
use std::path::Path;

/// Largest file that is read, bytes.
const LARGEST: u64 = 1 << 30;

/// Reads a mesh.
///
/// # Errors
/// When the file cannot be read, is not what its ending says, or ends too early; the error names
/// file and line.
pub fn load(path: &Path) -> Result<Mesh, ShapeError> {
    load_part(path, None)
}

/// Reads a mesh, or the part of it that a name in the file says (of an OBJ's objects and groups, an
/// STL's solids, a glTF's nodes and meshes); `largest` is the part of the greatest volume.
///
/// # Errors
/// Those of [`load`], and when there is no such part.
pub fn load_part(path: &Path, wanted: Option<&str>) -> Result<Mesh, ShapeError> {
    let name = path.display().to_string();
    let bytes = read(path).map_err(|error| error.within(&name))?;
    let (mesh, names) = parse_named(path, &bytes)?;
    wanted.map_or(Ok(mesh.clone()), |wanted| part(mesh, &names, wanted).map_err(|error| error.within(&name)))
}

/// Reads a mesh that was loaded already; `path` is what it is called, and its ending says what it
/// is.
///
/// # Errors
/// When the bytes are not what the ending says, or end too early; the error names file and line.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Mesh, ShapeError> {
    parse_named(path, bytes).map(|(mesh, _)| mesh)
}

fn parse_named(path: &Path, bytes: &[u8]) -> Result<(Mesh, Names), ShapeError> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let surface = |(surface, names)| (Mesh::Surface(surface), names);
    let mesh = match ending.as_str() {
        _ if bytes.is_empty() => Err(ShapeError::new("", "is empty", "give a mesh")),
        _ if placeholder(bytes).is_some() => {
            Err(ShapeError::new("", placeholder(bytes).unwrap_or_default(), "download the mesh itself"))
        }
        "msh" => msh::parse(bytes).map(|mesh| (mesh, Names::default())),
        "obj" => obj::parse(bytes).map(surface),
        "stl" => stl::parse(bytes).map(surface),
        "ply" => ply::parse(bytes).map(surface),
        "glb" | "gltf" => gltf::parse(path, bytes).map(surface),
        _ => {
            let right = "must end in .obj, .stl, .ply, .glb, .gltf or .msh";
            Err(ShapeError::new("", "is no kind of mesh that is read", right))
        }
    };
    mesh.map(|(mesh, names)| (mesh.used(), names)).map_err(|error| error.within(&path.display().to_string()))
}

/// Download's leftover in the mesh's place.
fn placeholder(bytes: &[u8]) -> Option<&'static str> {
    let begins = String::from_utf8_lossy(&bytes[..bytes.len().min(64)]).trim_start().to_lowercase();
    if begins.starts_with("version https://git-lfs") {
        return Some("is a pointer of Git LFS");
    }
    (begins.starts_with("<!doctype html") || begins.starts_with("<html")).then_some("is a web page")
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
