//! `--stl OUT.stl`, of the verbs that make heights: the surface as an object for a 3-D printer.

use super::{positive, refused};
use crate::error::CliError;
use crate::output::{self, Outputs};
use asperity_pictures::stl::{Block, FINEST_TEXEL_M};
use asperity_surface::raster::Raster;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Thickness under the lowest point, mm, of the document's blocks.
const BASE_MM: f64 = 10.0;

/// Path and size of the object.
#[derive(Debug, Clone, Args)]
pub struct ObjectOptions {
    /// Also write the surface as a closed block for a 3-D printer: binary STL, in millimetres
    #[arg(long, value_name = "OUT.stl")]
    pub stl: Option<PathBuf>,
    /// Thickness of the block under its lowest point, mm
    #[arg(long, value_name = "MM", default_value_t = BASE_MM, value_parser = positive)]
    pub base_mm: f64,
    /// Width of the map on the surface, mm
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub width_mm: Option<f64>,
}

/// The surface in millimetres.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SizeMm {
    pub width_mm: f64,
    pub height_mm: f64,
    /// Side of a texel.
    pub texel_mm: f64,
    /// From the lowest point to the highest.
    pub relief_mm: f64,
}

impl SizeMm {
    /// The size of `heights_m` on texels of `texel_m`.
    pub fn of(heights_m: &Raster, texel_m: f64) -> Self {
        let texel_mm = 1e3 * texel_m;
        let (low, high) = heights_m.range();
        let [width_mm, height_mm] = [heights_m.width, heights_m.height].map(|n| n as f64 * texel_mm);
        Self { width_mm, height_mm, texel_mm, relief_mm: 1e3 * (high - low) }
    }

    /// Warning about what a printed block of this size lacks to the touch, if anything.
    pub fn warning(&self) -> Option<String> {
        (self.texel_mm > 1e3 * FINEST_TEXEL_M).then(|| {
            format!(
                "a texel of the object is {:.3} mm wide, more than the {:.2} mm below which a finger feels no facets; a map of \
                 more texels or a smaller --width-mm would be finer",
                self.texel_mm,
                1e3 * FINEST_TEXEL_M
            )
        })
    }
}

impl ObjectOptions {
    /// Refuses a path that cannot become a file, before any work is done for it.
    ///
    /// # Errors
    /// As [`output::check_destination`].
    pub fn check_destination(&self) -> Result<(), CliError> {
        self.stl.as_deref().map_or(Ok(()), output::check_destination)
    }

    /// Writes the block, if it is asked for.
    ///
    /// # Errors
    /// When a size is refused or the file cannot be written.
    pub fn write(&self, outputs: &mut Outputs, heights_m: &Raster, texel_m: f64) -> Result<(), CliError> {
        let Some(path) = &self.stl else { return Ok(()) };
        let block =
            Block::new(heights_m, texel_m, 1e-3 * self.base_mm).map_err(|error| refused(path, &error))?;
        outputs.write_with(path, |file| block.write_stl(file))
    }
}
