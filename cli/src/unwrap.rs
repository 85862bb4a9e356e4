//! `--unwrap` of `modes` and `import`: texture coordinates for meshes that have none, as glTF.

use crate::export::binary::Binary;
use asperity_shape::ShapeError;
use asperity_shape::repair::Cracks;
use asperity_shape::surface_mesh::SurfaceMesh;
use asperity_shape::unwrap::{self, PHI, Unwrapped};
use clap::{Args, ValueEnum};
use serde_json::json;

/// Options that unwrap.
#[derive(Debug, Clone, Args)]
pub struct UnwrapOptions {
    /// Also write the mesh with texture coordinates in metres, as glTF: `energy` changes lengths
    /// and areas least, `smooth` varies most evenly; a mesh with one rim
    #[arg(long, value_enum, value_name = "METHOD")]
    pub unwrap: Option<Method>,
    /// Weight of lengths beside areas in `--unwrap energy`, 0 to 1
    #[arg(long, value_name = "PHI", default_value_t = PHI, value_parser = share)]
    pub phi: f64,
}

/// Way to unwrap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Method {
    /// Least change of lengths and areas
    Energy,
    /// Smooth, the rim on a circle
    Smooth,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("must be 0 to 1".to_owned()),
    }
}

impl UnwrapOptions {
    /// The mesh as glTF, and how it was unwrapped, if that is asked for.
    ///
    /// # Errors
    /// When the surface is no single piece with one rim.
    pub fn glb(&self, surface: SurfaceMesh) -> Result<Option<(Vec<u8>, Unwrapped)>, ShapeError> {
        let method = match self.unwrap {
            None => return Ok(None),
            Some(Method::Energy) => unwrap::Method::Energy(self.phi),
            Some(Method::Smooth) => unwrap::Method::Smooth,
        };
        let surface = surface.joined(Cracks::Hair, &mut Vec::new())?.in_order();
        let unwrapped = unwrap::unwrap(&surface, method)?;
        let mut binary = Binary::default();
        let points: Vec<[f32; 3]> = surface.points.iter().map(|point| point.map(|x| x as f32)).collect();
        let uv: Vec<[f32; 2]> = unwrapped.uv.iter().map(|uv| uv.map(|x| x as f32)).collect();
        let position = binary.vectors(&points, true);
        let coordinates = binary.vectors(&uv, false);
        let indices = binary.indices(surface.triangles.as_flattened());
        let attributes = json!({"POSITION": position, "TEXCOORD_0": coordinates});
        let document = json!({
            "asset": {"version": "2.0", "generator": "asperity"},
            "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": attributes, "indices": indices}]}],
        });
        Ok(Some((binary.close(document, true), unwrapped)))
    }
}
