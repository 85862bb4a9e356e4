//! `asperity texture …`: tools that make surfaces from pictures and from other surfaces.
//!
//! What the verbs share is here: pictures in, refusals in words, a bar for a fraction done.

pub mod analyze;
pub mod bake;
pub mod brownian;
pub mod compare;
pub mod from_normals;
pub mod from_photo;
pub mod from_stroke;
pub mod metamer;
pub mod object;
pub mod rank;
pub mod shader;
pub mod solid;
pub mod solid_of;

use crate::arguments::positive;
use crate::error::CliError;
use crate::output;
use crate::progress::Progress;
use asperity_dsp::DesignError;
use asperity_surface::image_io::{self, Channel};
use asperity_surface::raster::Raster;
use clap::Subcommand;
use std::path::Path;

/// Verbs on textures.
#[derive(Debug, Subcommand)]
pub enum Verb {
    Analyze(analyze::AnalyzeArgs),
    Brownian(brownian::Options),
    Solid(solid::Options),
    SolidOf(solid_of::Options),
    Compare(compare::Options),
    FromNormals(from_normals::Options),
    FromPhoto(from_photo::Options),
    FromStroke(Box<from_stroke::Options>),
    Metamer(metamer::Options),
    Rank(rank::Options),
}

/// Runs the verb.
///
/// # Errors
/// When an input is bad or an output cannot be written.
pub fn run(verb: Verb) -> Result<(), CliError> {
    match verb {
        Verb::Analyze(options) => analyze::run(&options),
        Verb::Brownian(options) => brownian::run(&options),
        Verb::Solid(options) => solid::run(&options),
        Verb::SolidOf(options) => solid_of::run(&options),
        Verb::Compare(options) => compare::run(&options),
        Verb::FromNormals(options) => from_normals::run(&options),
        Verb::FromPhoto(options) => from_photo::run(&options),
        Verb::FromStroke(options) => from_stroke::run(&options),
        Verb::Metamer(options) => metamer::run(&options),
        Verb::Rank(options) => rank::run(&options),
    }
}

/// The grey values of a map, 0–1; those of a normal map are no heights.
fn grey(path: &Path) -> Result<Raster, CliError> {
    image_io::load_map(path, Channel::Luma).map(|image| image.raster).map_err(CliError::from_error)
}

/// One channel of a picture, 0–1.
fn channel(path: &Path, channel: Channel) -> Result<Raster, CliError> {
    image_io::load_channel(path, channel).map(|image| image.raster).map_err(CliError::from_error)
}

/// A refused parameter or picture, at the file it came from.
fn refused(at: &Path, error: &DesignError) -> CliError {
    let what = format!("{} is refused", error.value);
    CliError::new(error.field, what, format!("must be {}", error.expected)).within(at.display())
}

/// A bar of the fraction done.
fn bar(what: &'static str) -> impl FnMut(f64) {
    const STEPS: f64 = 1000.0;
    let mut progress = Progress::new(what, STEPS as u64);
    let mut done = 0;
    move |fraction| {
        let now = (fraction.clamp(0.0, 1.0) * STEPS) as u64;
        progress.advance(now.saturating_sub(done));
        done = done.max(now);
    }
}

/// Report of the verbs that make heights from nothing.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Preview {
    /// Texels a side.
    pub size: usize,
    /// Size of a texel on the surface.
    pub metres_per_px: f64,
    /// Height of one of 65 535 grey steps.
    pub metres_per_grey: f64,
    /// Height of white over black: `relief_m` of a scene file.
    pub relief_m: f64,
    /// Rms height about the mean.
    pub rms_m: f64,
    /// Remarks on what it was made from.
    pub warnings: Vec<String>,
    /// The file written.
    pub files: Vec<std::path::PathBuf>,
}

/// Writes heights in metres as a 16-bit picture from its lowest to its highest point.
fn write_heights(path: &Path, heights_m: &Raster, metres_per_px: f64) -> Result<Preview, CliError> {
    let (low, high) = heights_m.range();
    let relief_m = high - low;
    let scale = if relief_m > 0.0 { 1.0 / relief_m } else { 0.0 };
    let grey: Vec<u16> =
        heights_m.values.iter().map(|height| ((height - low) * scale * 65_535.0).round() as u16).collect();
    let mean = heights_m.mean();
    let count = heights_m.values.len().max(1) as f64;
    let rms_m = (heights_m.values.iter().map(|height| (height - mean).powi(2)).sum::<f64>() / count).sqrt();
    let mut outputs = output::Outputs::new();
    outputs.write(path, &asperity_plot::pixels::png16(heights_m.width, heights_m.height, &grey))?;
    Ok(Preview {
        size: heights_m.width,
        metres_per_px,
        metres_per_grey: relief_m / 65_535.0,
        relief_m,
        rms_m,
        warnings: Vec::new(),
        files: outputs.commit()?,
    })
}

/// Prints a preview as JSON or in words.
fn say_preview(preview: &Preview, json: bool, width_m: f64) -> Result<(), CliError> {
    output::say_report(preview, json, || {
        format!(
            "{0} × {0} texels of {1}: relief {2}, rms {3}\nwrote {4}; in a scene file: width_m = {5}, height_m = {5}, relief_m = {6:.4e}{7}",
            preview.size,
            asperity_plot::quantity(preview.metres_per_px, "m"),
            asperity_plot::quantity(preview.relief_m, "m"),
            asperity_plot::quantity(preview.rms_m, "m"),
            output::listed(&preview.files),
            width_m,
            preview.relief_m,
            output::warned(&preview.warnings),
        )
    })
}
