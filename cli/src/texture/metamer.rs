//! `asperity texture metamer ORIGINAL REFERENCE -o OUT.png`: the original's pattern with the
//! reference's feel.

use super::{bar, grey, positive, refused};
use crate::error::CliError;
use crate::output::{self, Outputs};
use asperity_dsp::DesignError;
use asperity_texture::borders::Borders;
use asperity_texture::image_io;
use asperity_texture::metamer::{self as core, MetamerOptions, Method};
use asperity_texture::pyramid::Kind;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Make one height map feel like another
#[derive(Debug, Args)]
pub struct Options {
    /// Height map whose arrangement is kept
    #[arg(value_name = "ORIGINAL")]
    pub original: PathBuf,
    /// Height map that it shall feel like
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,
    /// 16-bit PNG to write
    #[arg(short, long = "output", value_name = "OUT.png")]
    pub output: PathBuf,
    /// Bands of wavelength, an octave each
    #[arg(long, default_value_t = core::BANDS)]
    pub bands: usize,
    /// Orientations of each band
    #[arg(long, default_value_t = core::ORIENTATIONS)]
    pub orientations: usize,
    /// Passes over bands, residuals and heights
    #[arg(long, default_value_t = core::PASSES, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1000))]
    pub iterations: usize,
    /// How the original is changed
    #[arg(long, value_enum, default_value_t = MethodName::Iterated)]
    pub method: MethodName,
    /// Whether the maps tile
    #[arg(long, value_enum, default_value_t = BordersName::Detect)]
    pub borders: BordersName,
    /// Size of the original's texels, mm
    #[arg(long, value_name = "MM", value_parser = positive, requires = "reference_mm_per_px")]
    pub mm_per_px: Option<f64>,
    /// Size of the reference's texels, mm
    #[arg(long, value_name = "MM", value_parser = positive, requires = "mm_per_px")]
    pub reference_mm_per_px: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Ways to change the original.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MethodName {
    /// Bands, residuals and heights, again and again.
    Iterated,
    /// Bands once, as document 002 has it.
    SinglePass,
    /// The reference's amplitude spectrum.
    Spectrum,
}

/// What is known about the borders.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq)]
pub enum BordersName {
    /// Look at the seams.
    Detect,
    /// The maps tile.
    Periodic,
    /// They do not.
    Smooth,
}

#[derive(Debug, Serialize)]
struct Band {
    kind: &'static str,
    band: Option<usize>,
    orientation: Option<usize>,
    wavelength_px: Option<f64>,
    before: f64,
    after: f64,
}

#[derive(Debug, Serialize)]
struct Report {
    width: usize,
    height: usize,
    method: MethodName,
    iterations: Option<usize>,
    /// Histogram distance of each sub-band: mean distance of equal quantiles over the reference's σ.
    bands: Vec<Band>,
    mean_before: f64,
    mean_after: f64,
    heights_before: f64,
    heights_after: f64,
    tileable: bool,
    /// Fraction of texels outside 0–1, which the file cannot hold.
    clipped: f64,
    seconds: f64,
    files: Vec<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// When a map cannot be read, is too small for the bands, or the output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    output::check_destination(&options.output)?;
    let (original, reference) = (grey(&options.original)?, grey(&options.reference)?);
    let settings = MetamerOptions {
        bands: options.bands,
        orientations: options.orientations,
        method: match options.method {
            MethodName::Iterated => Method::Iterated(options.iterations),
            MethodName::SinglePass => Method::SinglePass,
            MethodName::Spectrum => Method::Spectrum,
        },
        borders: match options.borders {
            BordersName::Detect => Borders::Detect,
            BordersName::Periodic => Borders::Periodic,
            BordersName::Smooth => Borders::Smooth,
        },
        scale: match (options.mm_per_px, options.reference_mm_per_px) {
            (Some(ours), Some(theirs)) => ours / theirs,
            _ => 1.0,
        },
    };
    let start = Instant::now();
    let made = core::metamer(&original, &reference, &settings, bar("metamer"))
        .map_err(|error| refused(at(&error, &options.original, &options.reference), &error))?;
    let seconds = start.elapsed().as_secs_f64();
    let outside = made.image.values.iter().filter(|v| !(0.0..=1.0).contains(*v)).count();
    let mut outputs = Outputs::new();
    outputs
        .write_at(&options.output, |path| image_io::save_gray16(path, &made.image).map_err(CliError::told))?;
    let report = Report {
        width: made.image.width,
        height: made.image.height,
        method: options.method,
        iterations: (options.method == MethodName::Iterated).then_some(options.iterations),
        bands: made.bands.iter().map(band).collect(),
        mean_before: made.mean_before(),
        mean_after: made.mean_after(),
        heights_before: made.heights_before,
        heights_after: made.heights_after,
        tileable: made.tileable,
        clipped: outside as f64 / made.image.values.len() as f64,
        seconds,
        files: outputs.commit()?,
    };
    if options.json {
        return output::say_json(&report);
    }
    output::say(&format!(
        "histogram distance of the sub-bands: {:.3} → {:.4} σ in {:.2} s\nwrote {}",
        report.mean_before,
        report.mean_after,
        report.seconds,
        options.output.display()
    ));
    Ok(())
}

/// The map that an error is about.
pub(super) fn at<'a>(error: &DesignError, original: &'a Path, reference: &'a Path) -> &'a Path {
    if error.field.starts_with("reference") { reference } else { original }
}

fn band(distance: &core::BandDistance) -> Band {
    let (kind, band, orientation) = match distance.kind {
        Kind::HighResidual => ("high-residual", None, None),
        Kind::Oriented { band, orientation } => ("oriented", Some(band), Some(orientation)),
        Kind::LowResidual => ("low-residual", None, None),
    };
    Band {
        kind,
        band,
        orientation,
        wavelength_px: distance.wavelength_px.is_finite().then_some(distance.wavelength_px),
        before: distance.before,
        after: distance.after,
    }
}
