//! `asperity texture solid-of MAP -o X.(stl|glb)`: a height map as a thing to hold.

use super::object::SizeMm;
use super::{grey, positive, refused};
use crate::error::CliError;
use crate::export::binary::Binary;
use crate::output::{self, Outputs};
use asperity_pictures::stl::Block;
use clap::Args;
use serde::Serialize;
use serde_json::json;
use std::f64::consts::FRAC_1_SQRT_2;
use std::path::PathBuf;

/// Make a closed block of a height map, a bed of sand or a metamer: STL in millimetres for a 3-D
/// printer, GLB in metres for everything else
#[derive(Debug, Args)]
pub struct Options {
    /// Height map: white is high
    #[arg(value_name = "MAP")]
    pub image: PathBuf,
    /// Block to write
    #[arg(short, long = "output", value_name = "OUT.(stl|glb)")]
    pub output: PathBuf,
    /// Height of white over black, mm [default: 2, that of the metamers' samples]
    #[arg(long, value_name = "MM", default_value = "2", hide_default_value = true, value_parser = positive)]
    pub relief_mm: f64,
    /// Width of the map, mm [default: 40, that of the samples]
    #[arg(long, value_name = "MM", default_value = "40", hide_default_value = true, value_parser = positive)]
    pub width_mm: f64,
    /// Thickness under the lowest point, mm [default: 10, that of the samples]
    #[arg(long, value_name = "MM", default_value = "10", hide_default_value = true, value_parser = positive)]
    pub base_mm: f64,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    #[serde(flatten)]
    size: SizeMm,
    base_mm: f64,
    triangles: u64,
    volume_mm3: f64,
    warnings: Vec<String>,
    files: Vec<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// When the map cannot be read, a size is refused or the block cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let ending = options.output.extension().map(|ending| ending.to_ascii_lowercase());
    let is_glb = match ending.as_ref().and_then(|ending| ending.to_str()) {
        Some("stl") => false,
        Some("glb") => true,
        _ => return Err(CliError::file(&options.output, "has another ending", "must end in .stl or .glb")),
    };
    output::check_destination(&options.output)?;
    let heights_m = grey(&options.image)?.map(|grey| 1e-3 * options.relief_mm * grey);
    let texel_m = 1e-3 * options.width_mm / heights_m.width as f64;
    let block = Block::new(&heights_m, texel_m, 1e-3 * options.base_mm)
        .map_err(|error| refused(&options.image, &error))?;
    let mut outputs = Outputs::new();
    if is_glb {
        outputs.write(&options.output, &glb(&block))?;
    } else {
        outputs.write_with(&options.output, |file| block.write_stl(file))?;
    }
    let size = SizeMm::of(&heights_m, texel_m);
    let mean_mm = 1e3 * (heights_m.mean() - heights_m.range().0);
    let report = Report {
        size,
        base_mm: options.base_mm,
        triangles: block.triangles(),
        volume_mm3: size.width_mm * size.height_mm * (options.base_mm + mean_mm),
        warnings: size.warning().into_iter().collect(),
        files: outputs.commit()?,
    };
    output::say_report(&report, options.json, || {
        format!(
            "{:.2} × {:.2} × {:.3} mm, {:.1} mm³, {} triangles: {}{}",
            size.width_mm,
            size.height_mm,
            options.base_mm + size.relief_mm,
            report.volume_mm3,
            report.triangles,
            options.output.display(),
            output::warned(&report.warnings)
        )
    })
}

/// The block as glTF: z points up in its mesh, as in STL, and the node turns it to the format's y.
fn glb(block: &Block<'_>) -> Vec<u8> {
    let mut binary = Binary::default();
    let (vertices, corners) = block.mesh();
    let (position, indices) = (binary.vectors(&vertices, true), binary.indices(&corners));
    let document = json!({
        "asset": {"version": "2.0", "generator": "asperity"},
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "rotation": [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": indices}]}],
    });
    binary.close(document, true)
}
