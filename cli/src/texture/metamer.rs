//! `asperity texture metamer ORIGINAL REFERENCE -o OUT.png`: the original's pattern with the
//! reference's feel.

use super::object::{ObjectOptions, SizeMm};
use super::{bar, grey, positive, refused};
use crate::arguments::{Words, one_of};
use crate::error::CliError;
use crate::output::{self, Outputs};
use asperity_dsp::DesignError;
use asperity_pictures::borders::Borders;
use asperity_pictures::from_photo::TEXEL_M;
use asperity_pictures::metamer::{self as core, Metamer, MetamerOptions, Method, Statistics};
use asperity_pictures::pyramid::{Kind, Subband};
use asperity_surface::raster::Raster;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Correlation with the original below which a metamer is warned of: what it shares with its
/// original is hardly seen.
const LEAST_CORRELATION: f64 = 0.3;

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
    /// Passes over bands, residuals and heights on a grid of 256 × 256 texels; coarser grids get
    /// more, finer ones fewer
    #[arg(long, default_value_t = core::PASSES, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=1000))]
    pub iterations: usize,
    /// End as soon as the mean distance of the sub-bands is this small, in deviations of the
    /// reference
    #[arg(long, value_name = "SIGMA", value_parser = positive)]
    pub until: Option<f64>,
    /// Largest share of the reference's own arrangement to take where the original's does not come
    /// near enough
    #[arg(long, value_name = "0-1", default_value_t = 1.0, value_parser = share)]
    pub borrow: f64,
    /// Way of changing the original
    #[arg(long, value_enum, default_value_t = MethodName::Iterated)]
    pub method: MethodName,
    /// Tiling of the maps
    #[arg(long, default_value = "detect", value_parser = one_of(BORDERS))]
    pub borders: Borders,
    /// Size of the original's texels, mm
    #[arg(long, value_name = "MM", value_parser = positive, requires = "reference_mm_per_px")]
    pub mm_per_px: Option<f64>,
    /// Size of the reference's texels, mm
    #[arg(long, value_name = "MM", value_parser = positive, requires = "mm_per_px")]
    pub reference_mm_per_px: Option<f64>,
    /// Height of the reference's white over its black, mm
    #[arg(long, value_name = "MM", default_value = "2", value_parser = positive)]
    pub relief_mm: f64,
    /// The object's file and size
    #[command(flatten)]
    pub object: ObjectOptions,
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
    /// Bands once, as published: a machine tells 93 to 99 of 100 strokes on it from the reference's
    SinglePass,
    /// The reference's amplitude spectrum.
    Spectrum,
}

/// Knowledge about the borders.
const BORDERS: Words<Borders, 3> = [
    ("detect", "Look at the seams", Borders::Detect),
    ("periodic", "The maps tile", Borders::Periodic),
    ("smooth", "They do not", Borders::Smooth),
];

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
    /// Passes done on the map's own grid.
    passes: usize,
    /// Histogram distance of each sub-band: mean distance of equal quantiles over the reference's
    /// σ. Those after are of the file, read back.
    bands: Vec<Band>,
    mean_before: f64,
    mean_after: f64,
    heights_before: f64,
    heights_after: f64,
    /// Share of the reference's own arrangement in the surface that the passes began with.
    borrowed: f64,
    /// Mean correlation of the oriented sub-bands with the original's in place and with the
    /// reference's at the best of all shifts: how much of either arrangement the surface has, 1 all
    /// and 0 none.
    correlation_with_original: f64,
    correlation_with_reference: f64,
    /// That shift of the reference along u and v, texels.
    shift_from_reference_px: [usize; 2],
    tileable: bool,
    /// Height = `offset` + `scale` · grey, grey 0–1, in units of the reference's white over black.
    offset: f64,
    scale: f64,
    /// Fraction of texels that the file cannot hold: none since `offset` and `scale` are written.
    clipped: f64,
    #[serde(flatten)]
    size: SizeMm,
    /// Value for a scene file that uses the map: height of its white over its black, m.
    relief_m: f64,
    warnings: Vec<String>,
    seconds: f64,
    files: Vec<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// When a map cannot be read, is too small for the bands, or the output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    output::check_destination(&options.output)?;
    options.object.check_destination()?;
    let (original, reference) = (grey(&options.original)?, grey(&options.reference)?);
    let start = Instant::now();
    let refuse = |error| refused(at(&error, &options.original, &options.reference), &error);
    let mut feel =
        Statistics::new(&reference, original.width, original.height, &settings(options)).map_err(refuse)?;
    let mut file = Levels::default();
    let stored = |image| {
        file = Levels::holding(&image);
        file.read_back(&image)
    };
    let made = feel.metamer(&original, stored, bar("metamer")).map_err(refuse)?;
    let seconds = start.elapsed().as_secs_f64();
    let mut outputs = Outputs::new();
    let grey = file.grey(&made.image);
    outputs.write_gray16(&options.output, &grey)?;
    let texel_m = texel_m(options, original.width);
    let heights_m = made.image.map(|height| 1e-3 * options.relief_mm * height);
    options.object.write(&mut outputs, &heights_m, texel_m)?;
    let mut report = report(options, &made, file, SizeMm::of(&heights_m, texel_m));
    report.seconds = seconds;
    report.files = outputs.commit()?;
    output::say_report(&report, options.json, || in_words(options, &report))
}

fn settings(options: &Options) -> MetamerOptions {
    MetamerOptions {
        bands: options.bands,
        orientations: options.orientations,
        method: match options.method {
            MethodName::Iterated => Method::Iterated(options.iterations),
            MethodName::SinglePass => Method::SinglePass,
            MethodName::Spectrum => Method::Spectrum,
        },
        borders: options.borders,
        scale: match (options.mm_per_px, options.reference_mm_per_px) {
            (Some(ours), Some(theirs)) => ours / theirs,
            _ => 1.0,
        },
        until: options.until,
        borrow: options.borrow,
    }
}

/// Size of a texel of the original: given, by its width or as in the document, 40 mm over 256
/// texels.
fn texel_m(options: &Options, width: usize) -> f64 {
    let by_width = options.object.width_mm.map(|width_mm| 1e-3 * width_mm / width as f64);
    by_width.or(options.mm_per_px.map(|mm| 1e-3 * mm)).unwrap_or(TEXEL_M)
}

/// The grey levels of a file and the heights they stand for.
#[derive(Debug, Clone, Copy)]
struct Levels {
    offset: f64,
    scale: f64,
}

impl Default for Levels {
    /// Black is 0 and white 1, as in the reference's file.
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0 }
    }
}

impl Levels {
    /// The default, unless a height lies outside by more than is rounded away.
    fn holding(image: &Raster) -> Self {
        const HALF_A_STEP: f64 = 0.5 / 65_535.0;
        let (low, high) = image.range();
        if low >= -HALF_A_STEP && high <= 1.0 + HALF_A_STEP {
            return Self::default();
        }
        Self { offset: low, scale: if high > low { high - low } else { 1.0 } }
    }

    fn grey(self, image: &Raster) -> Raster {
        image.map(|height| (height - self.offset) / self.scale)
    }

    /// The heights that a reader of the file gets.
    fn read_back(self, image: &Raster) -> Raster {
        let stored = |grey: f64| (grey.clamp(0.0, 1.0) * 65_535.0).round() / 65_535.0;
        self.grey(image).map(|grey| self.offset + self.scale * stored(grey))
    }
}

fn report(options: &Options, made: &Metamer, file: Levels, size: SizeMm) -> Report {
    let Metamer { before, after, .. } = made;
    let bands = made.subbands.iter().zip(before.subbands.iter().zip(&after.subbands));
    let mut report = Report {
        width: made.image.width,
        height: made.image.height,
        method: options.method,
        iterations: (options.method == MethodName::Iterated).then_some(options.iterations),
        passes: made.passes,
        bands: bands.map(|(subband, (before, after))| band(subband, *before, *after)).collect(),
        mean_before: before.mean,
        mean_after: after.mean,
        heights_before: before.heights,
        heights_after: after.heights,
        borrowed: made.borrowed,
        correlation_with_original: made.correlation_with_original,
        correlation_with_reference: made.correlation_with_reference,
        shift_from_reference_px: made.shift_from_reference_px,
        tileable: made.tileable,
        offset: file.offset,
        scale: file.scale,
        clipped: 0.0,
        size,
        relief_m: 1e-3 * options.relief_mm * file.scale,
        warnings: Vec::new(),
        seconds: 0.0,
        files: Vec::new(),
    };
    report.warnings = warnings(options, &report);
    report
}

fn warnings(options: &Options, report: &Report) -> Vec<String> {
    let mut warnings = Vec::new();
    let is_iterated = options.method == MethodName::Iterated;
    if is_iterated && report.size.relief_mm == 0.0 {
        return vec!["the reference is flat, and so is what feels like it".to_string()];
    }
    let goal = options.until.unwrap_or(core::REACH);
    let farthest = report.mean_after.max(if options.until.is_some() { 0.0 } else { report.heights_after });
    if is_iterated && farthest > goal {
        warnings.push(format!(
            "the file is {farthest:.3} σ from the reference where {goal} was the aim; more --iterations or another original may \
             come nearer"
        ));
    }
    if report.borrowed > 0.0 {
        warnings.push(format!(
            "it was begun with {:.0} % of the reference's own arrangement, because the original's alone does not come near enough; \
             --borrow 0 begins with the original's",
            100.0 * report.borrowed
        ));
    }
    if is_iterated && report.correlation_with_original < LEAST_CORRELATION {
        warnings.push(format!(
            "little of the original's arrangement is left (correlation {:.2}, with the reference's {:.2}): surfaces with this \
             reference's sub-bands hardly admit another",
            report.correlation_with_original, report.correlation_with_reference
        ));
    }
    if (report.offset, report.scale) != (0.0, 1.0) {
        warnings.push(format!(
            "heights run from {:.3} to {:.3} of the reference's white: black in the file is the first, white the second, and its \
             relief_m is {:.6e}",
            report.offset,
            report.offset + report.scale,
            report.relief_m
        ));
    }
    if options.object.stl.is_some() {
        warnings.extend(report.size.warning());
    }
    warnings
}

fn in_words(options: &Options, report: &Report) -> String {
    let mut text = format!(
        "histogram distance of the sub-bands: {:.3} → {:.4} σ, of the heights: {:.3} → {:.4} σ, in {:.2} s\n",
        report.mean_before, report.mean_after, report.heights_before, report.heights_after, report.seconds
    );
    text.push_str(&format!(
        "arrangement: correlation {:.2} with the original's, {:.2} with the reference's\n",
        report.correlation_with_original, report.correlation_with_reference
    ));
    for warning in &report.warnings {
        text.push_str(&format!("warning: {warning}\n"));
    }
    let SizeMm { width_mm, height_mm, relief_mm, .. } = report.size;
    text.push_str(&format!(
        "{width_mm:.2} × {height_mm:.2} mm, relief {relief_mm:.3} mm; in a scene file: displacement = {:?}, width_m = {}, \
         height_m = {}, relief_m = {:?}\n",
        options.output.display().to_string(),
        1e-3 * width_mm,
        1e-3 * height_mm,
        report.relief_m
    ));
    let files: Vec<String> = report.files.iter().map(|path| path.display().to_string()).collect();
    text + "wrote " + &files.join(" and ")
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("must be a number from 0 to 1".to_owned()),
    }
}

/// The map that an error is about.
pub(super) fn at<'a>(error: &DesignError, original: &'a Path, reference: &'a Path) -> &'a Path {
    if error.field.starts_with("reference") { reference } else { original }
}

fn band(subband: &Subband, before: f64, after: f64) -> Band {
    let (kind, band, orientation) = match subband.kind {
        Kind::HighResidual => ("high-residual", None, None),
        Kind::Oriented { band, orientation } => ("oriented", Some(band), Some(orientation)),
        Kind::LowResidual => ("low-residual", None, None),
    };
    let wavelength_px = subband.wavelength_px.is_finite().then_some(subband.wavelength_px);
    Band { kind, band, orientation, wavelength_px, before, after }
}
