//! `asperity texture analyze IMAGE`: how rough a picture is, and what pattern repeats in it.

use crate::arguments::{Words, one_of};
use crate::error::CliError;
use crate::output::{self, Outputs};
use crate::progress::Progress;
use asperity_pictures::fractal_dimension::{
    COLOUR_LIMIT, Condition, FractalDimension, colour_fraction, fractal_dimension,
};
use asperity_pictures::symmetry::{
    Distortion, DocumentSearch, Frieze, Lattice, averaged_cell, document_lattice, find_frieze, find_lattice,
    separate, wallpaper_group,
};
use asperity_surface::image_io::{Channel, load_channel};
use asperity_surface::raster::Raster;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Measure fractal dimension, roughness, lattice and wallpaper group of a picture
#[derive(Debug, Args)]
pub struct AnalyzeArgs {
    /// Picture or height map
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,
    /// Search for the lattice
    #[arg(long, value_enum, default_value_t = LatticeMethod::Sweep)]
    pub lattice_method: LatticeMethod,
    /// Distortion that the document's method averages
    #[arg(long, default_value = "squared", value_parser = one_of(DISTORTIONS))]
    pub distortion: Distortion,
    /// Share of the median distortion up to which the document's method takes a minimum, 0–1
    #[arg(long, default_value_t = 0.5, value_parser = share)]
    pub threshold: f64,
    /// Write what repeats, one cell or strip, as a 16-bit PNG (black to white: its lowest to its
    /// highest grey)
    #[arg(long, value_name = "FILE")]
    pub primitive: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Search for the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LatticeMethod {
    /// Without a threshold
    Sweep,
    /// By the steps and the threshold of the published analysis
    Document,
}

/// Two distortions that a lattice may have.
const DISTORTIONS: Words<Distortion, 2> = [
    ("squared", "Mean square of differences", Distortion::Squared),
    ("absolute", "Mean size of differences", Distortion::Absolute),
];

impl AnalyzeArgs {
    /// The lattice by the method asked for.
    fn lattice(&self, picture: &Raster) -> Option<Lattice> {
        let search = DocumentSearch { distortion: self.distortion, threshold: self.threshold };
        match self.lattice_method {
            LatticeMethod::Sweep => find_lattice(picture),
            LatticeMethod::Document => document_lattice(picture, &search),
        }
    }
}

/// A share above 0 and below 1, as words.
fn share(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(share) if share > 0.0 && share < 1.0 => Ok(share),
        _ => Err("give a share above 0 and below 1".into()),
    }
}

/// Output of `--json`.
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
    /// Pattern along one direction, where nothing repeats along two.
    frieze: Option<Frieze>,
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
    let analysis = analyze(arguments)?;
    output::say_report(&analysis, arguments.json, || text(&analysis))
}

/// Reading, dimensions, lattice, pattern: what the progress bar counts.
const STEPS: u64 = 4;

/// The analysis of a file.
fn analyze(arguments: &AnalyzeArgs) -> Result<Analysis, CliError> {
    let path = arguments.image.as_path();
    let mut progress = Progress::new("analyze", STEPS);
    let picture = load_channel(path, Channel::Luma).map_err(CliError::from_error)?.raster;
    progress.advance(1);
    let mut report = fractal_dimension(&picture)
        .map_err(|error| CliError::file(path, error, "give a picture of at least 64 × 64 with relief"))?;
    let colour = colour(path)?;
    if colour > COLOUR_LIMIT {
        report.conditions.push(Condition::Coloured(colour));
    }
    progress.advance(1);
    let lattice = arguments.lattice(&picture);
    let frieze = if lattice.is_none() { find_frieze(&picture) } else { None };
    progress.advance(1);
    let found = lattice.map(|lattice| describe(&picture, &lattice));
    if let Some(lattice) = lattice {
        report.conditions.push(Condition::Symmetric(lattice.confidence));
    }
    if let Some(file) = &arguments.primitive {
        write_primitive(file, &picture, lattice.as_ref(), frieze.as_ref())?;
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
        frieze,
        warnings: report.conditions.iter().map(ToString::to_string).collect(),
    })
}

/// Writes the averaged cell, or the averaged strip.
fn write_primitive(
    file: &Path,
    picture: &Raster,
    lattice: Option<&Lattice>,
    frieze: Option<&Frieze>,
) -> Result<(), CliError> {
    let primitive = match (lattice, frieze) {
        (Some(lattice), _) => separate(picture, lattice).primitive,
        (None, Some(frieze)) => frieze.primitive.clone(),
        (None, None) => {
            return Err(CliError::file(
                file,
                "not written: nothing repeats in the picture",
                "leave --primitive out, or give a picture with a pattern",
            ));
        }
    };
    let (low, high) = primitive.range();
    let scale = if high > low { 1.0 / (high - low) } else { 0.0 };
    let mut outputs = Outputs::new();
    outputs.write_gray16(file, &primitive.map(|v| (v - low) * scale))?;
    outputs.commit().map(drop)
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

/// Share of a picture that is colour rather than light.
fn colour(path: &Path) -> Result<f64, CliError> {
    let channel = |which| load_channel(path, which).map(|image| image.raster).map_err(CliError::from_error);
    Ok(colour_fraction(&channel(Channel::R)?, &channel(Channel::G)?, &channel(Channel::B)?))
}

/// Report for people.
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
        _ => lines += &without_lattice(analysis.frieze.as_ref()),
    }
    lines + &output::warned(&analysis.warnings)
}

/// Pattern along one direction, or a remark that one of few repeats would not be seen.
fn without_lattice(frieze: Option<&Frieze>) -> String {
    let Some(frieze) = frieze else {
        return "no pattern repeats along two directions, or fewer than five times a side (twice where the map tiles); none \
                along one, or fewer than six times"
            .into();
    };
    let ([x, y], kind) = (frieze.t_px, if frieze.stripes { "stripes" } else { "a frieze" });
    format!(
        "{kind}: repeats along ({x:.2}, {y:.2}) px alone, confidence {:.2}; group {}, {} repeats; no pattern repeats along \
         two directions",
        frieze.confidence,
        frieze.group.name(),
        frieze.repeats
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    /// The arguments as a shell gives them.
    #[derive(Debug, Parser)]
    struct Shell {
        #[command(flatten)]
        arguments: AnalyzeArgs,
    }

    fn analyze(path: &Path) -> Result<Analysis, CliError> {
        asked(path, &[])
    }

    fn asked(path: &Path, options: &[&str]) -> Result<Analysis, CliError> {
        let words = ["analyze", path.to_str().unwrap()];
        super::analyze(&Shell::parse_from(words.iter().chain(options)).arguments)
    }

    #[test]
    fn a_corrugated_sheet_has_its_translation_and_a_primitive_on_disk() {
        let sheet = Raster::from_fn(128, 112, |x, y| {
            0.5 + 0.4 * (std::f64::consts::TAU * (x as f64 + 0.2 * y as f64) / 14.0).cos()
        });
        let (folder, path) = saved(&sheet);
        let file = folder.path().join("strip.png");
        let analysis = asked(&path, &["--primitive", file.to_str().unwrap()]).unwrap();
        let json = serde_json::to_value(&analysis).unwrap();
        assert!(json["lattice"].is_null() && json["frieze"]["stripes"].as_bool().unwrap(), "{json}");
        assert_eq!(json["frieze"]["group"], "p2mm");
        assert!(text(&analysis).contains("stripes: repeats along (13."), "{}", text(&analysis));
        let strip = load_channel(&file, Channel::Luma).unwrap().raster;
        assert!(strip.width >= 14 && strip.range().1 > 0.99);
        // Where nothing repeats, no file is left and the reason is reported.
        let mut state = 7_u32;
        let noise = Raster::from_fn(96, 96, |_, _| {
            state = asperity_dsp::rng::hash_u32(state);
            f64::from(state >> 8) / f64::from(1 << 24)
        });
        let (_other, path) = saved(&noise);
        let missing = folder.path().join("none.png");
        let error = asked(&path, &["--primitive", missing.to_str().unwrap()]).unwrap_err().to_string();
        assert!(error.contains("nothing repeats") && !missing.exists(), "{error}");
        assert!(text(&analyze(&path).unwrap()).contains("fewer than five times a side"));
    }

    #[test]
    fn the_documents_own_method_finds_a_clean_lattice_with_either_distortion() {
        let tiles = Raster::from_fn(160, 128, |x, y| {
            let (u, v) = ((x % 16) as f64 - 5.0, (y % 20) as f64 - 8.0);
            0.1 + 0.8 * (-(u * u + v * v) / 14.0).exp()
        });
        let (_folder, path) = saved(&tiles);
        for distortion in ["squared", "absolute"] {
            let options = ["--lattice-method", "document", "--distortion", distortion, "--threshold", "0.3"];
            let lattice = asked(&path, &options).unwrap().lattice.unwrap();
            let off = (lattice.t1_px[0] - 16.0).hypot(lattice.t1_px[1]);
            assert!(off < 0.6 && (lattice.t2_px[1] - 20.0).abs() < 0.6, "{distortion}: {lattice:?}");
        }
        let bad = Shell::try_parse_from(["analyze", "x.png", "--threshold", "1.5"]).unwrap_err();
        assert!(bad.to_string().contains("above 0 and below 1"), "{bad}");
    }

    fn saved(picture: &Raster) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture.png");
        asperity_surface::image_io::save_gray16(&path, picture).unwrap();
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
