//! `asperity texture analyze IMAGE`: how rough a picture is, and what pattern repeats in it.

use crate::error::CliError;
use crate::output;
use crate::progress::Progress;
use asperity_texture::fractal_dimension::{
    COLOUR_LIMIT, Condition, FractalDimension, colour_fraction, fractal_dimension,
};
use asperity_texture::image_io::{Channel, load_channel};
use asperity_texture::raster::Raster;
use asperity_texture::symmetry::{Lattice, averaged_cell, find_lattice, separate, wallpaper_group};
use clap::Args;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Measure fractal dimension, roughness, lattice and wallpaper group of a picture
#[derive(Debug, Args)]
pub struct AnalyzeArgs {
    /// Picture or height map
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// What `--json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    width_px: usize,
    height_px: usize,
    fractal_dimension: FractalDimension,
    hurst: f64,
    spectral_exponent: f64,
    roughness: f64,
    lattice: Option<Lattice>,
    wallpaper_group: Option<&'static str>,
    pattern: Option<Pattern>,
    warnings: Vec<String>,
}

/// More about a pattern that repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
struct Pattern {
    cell_area_px2: f64,
    cells: usize,
    reliability: f64,
    group_agreement: f64,
    /// Roughness of the picture without its pattern; null if nothing else is in it.
    residual_roughness: Option<f64>,
}

/// Analyses a picture and says what is in it.
///
/// # Errors
/// When the picture cannot be read, is smaller than 64 × 64 or has no relief.
pub fn run(arguments: &AnalyzeArgs) -> Result<(), CliError> {
    let analysis = analyze(&arguments.image)?;
    if arguments.json {
        output::say_json(&analysis)
    } else {
        output::say(&text(&analysis));
        Ok(())
    }
}

/// Reading, dimensions, lattice, pattern: what the progress bar counts.
const STEPS: u64 = 4;

/// The analysis of a file.
fn analyze(path: &Path) -> Result<Analysis, CliError> {
    let mut progress = Progress::new("analyze", STEPS);
    let picture = load_channel(path, Channel::Luma).map_err(CliError::told)?.raster;
    progress.advance(1);
    let mut report = fractal_dimension(&picture)
        .map_err(|error| CliError::file(path, error, "give a picture of at least 64 × 64 with relief"))?;
    let colour = colour(path)?;
    if colour > COLOUR_LIMIT {
        report.conditions.push(Condition::Coloured(colour));
    }
    progress.advance(1);
    let lattice = find_lattice(&picture);
    progress.advance(1);
    let found = lattice.map(|lattice| describe(&picture, &lattice));
    if let Some(lattice) = lattice {
        report.conditions.push(Condition::Symmetric(lattice.confidence));
    }
    Ok(Analysis {
        width_px: picture.width,
        height_px: picture.height,
        fractal_dimension: report.dimension,
        hurst: report.hurst,
        spectral_exponent: report.spectral_exponent,
        roughness: report.roughness,
        lattice,
        wallpaper_group: found.map(|(group, _)| group),
        pattern: found.map(|(_, pattern)| pattern),
        warnings: report.conditions.iter().map(ToString::to_string).collect(),
    })
}

/// Group and figures of a pattern.
fn describe(picture: &Raster, lattice: &Lattice) -> (&'static str, Pattern) {
    let cell = averaged_cell(picture, lattice);
    let symmetry = wallpaper_group(&cell, lattice);
    let residual = fractal_dimension(&separate(picture, lattice).residual);
    let pattern = Pattern {
        cell_area_px2: lattice.cell_area_px2(),
        cells: cell.repeats,
        reliability: cell.reliability,
        group_agreement: symmetry.agreement,
        residual_roughness: residual.ok().map(|report| report.roughness),
    };
    (symmetry.group.name(), pattern)
}

/// How much of a picture is colour rather than light.
fn colour(path: &Path) -> Result<f64, CliError> {
    let channel = |which| load_channel(path, which).map(|image| image.raster).map_err(CliError::told);
    Ok(colour_fraction(&channel(Channel::R)?, &channel(Channel::G)?, &channel(Channel::B)?))
}

/// The same for people.
fn text(analysis: &Analysis) -> String {
    let d = &analysis.fractal_dimension;
    let mut lines = format!(
        "fractal dimension {:.3} (box {:.3}, information {:.3}, correlation {:.3}, probability {:.3})\n\
         Hurst index {:.3}, roughness R {:.3}\n",
        d.recommended,
        d.box_counting,
        d.information,
        d.correlation,
        d.probability,
        analysis.hurst,
        analysis.roughness
    );
    match (&analysis.lattice, &analysis.pattern, analysis.wallpaper_group) {
        (Some(lattice), Some(pattern), Some(group)) => {
            let ([ax, ay], [bx, by]) = (lattice.t1_px, lattice.t2_px);
            let _ = write!(
                lines,
                "lattice ({ax:.2}, {ay:.2}) and ({bx:.2}, {by:.2}) px, confidence {:.2}; group {group}, {} cells",
                lattice.confidence, pattern.cells
            );
        }
        _ => lines += "no pattern repeats along two directions",
    }
    for warning in &analysis.warnings {
        let _ = write!(lines, "\nwarning: {warning}");
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_texture::image_io::save_gray16;

    fn saved(picture: &Raster) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        save_gray16(&path, picture).unwrap();
        (folder, path)
    }

    #[test]
    fn the_json_of_a_pattern_has_every_field_of_the_interface() {
        let tiles = Raster::from_fn(160, 128, |x, y| {
            let (u, v) = ((x % 16) as f64 - 5.0, (y % 20) as f64 - 8.0);
            0.1 + 0.8 * (-(u * u + v * v) / 14.0).exp() + 0.1 * f64::from(u8::from(u > 3.0 && v > 5.0))
        });
        let (_folder, path) = saved(&tiles);
        let json = serde_json::to_value(analyze(&path).unwrap()).unwrap();
        for kind in ["box", "information", "correlation", "probability", "recommended"] {
            assert!(json["fractal_dimension"][kind].as_f64().is_some(), "{kind}");
        }
        for field in ["hurst", "roughness"] {
            assert!((0.0..=1.0).contains(&json[field].as_f64().unwrap()), "{field}");
        }
        let lattice = &json["lattice"];
        let close = |field: &str, expected: [f64; 2]| {
            (0..2).all(|k| (lattice[field][k].as_f64().unwrap() - expected[k]).abs() < 0.1)
        };
        assert!(close("t1_px", [16.0, 0.0]) && close("t2_px", [0.0, 20.0]), "{lattice}");
        assert!(lattice["confidence"].as_f64().unwrap() > 0.5);
        assert!(json["wallpaper_group"].is_string() && !json["warnings"].as_array().unwrap().is_empty());
    }

    #[test]
    fn a_picture_without_a_pattern_has_null_for_it() {
        let mut state = 1_u32;
        let noise = Raster::from_fn(96, 96, |_, _| {
            state = asperity_dsp::rng::hash_u32(state);
            f64::from(state >> 8) / f64::from(1 << 24)
        });
        let (_folder, path) = saved(&noise);
        let json = serde_json::to_value(analyze(&path).unwrap()).unwrap();
        assert!(json["lattice"].is_null() && json["wallpaper_group"].is_null());
        assert!(json["roughness"].as_f64().unwrap() > 0.9);
    }

    #[test]
    fn bad_pictures_are_refused_with_their_name() {
        let (_folder, path) = saved(&Raster::constant(80, 80, 0.5));
        let error = analyze(&path).unwrap_err().to_string();
        assert!(
            error.starts_with("error: ") && error.contains("picture.png") && error.contains("flat"),
            "{error}"
        );
        assert!(analyze(Path::new("nowhere.png")).unwrap_err().to_string().contains("nowhere.png"));
    }
}
