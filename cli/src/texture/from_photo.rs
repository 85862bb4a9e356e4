//! `asperity texture from-photo PHOTO -o DIR`: a photograph becomes displacement, roughness and a
//! scene.

mod overview;
mod report;
mod scene;

use super::object::ObjectOptions;
use super::{bar, positive, refused};
use crate::arguments::{Words, one_of, three};
use crate::error::CliError;
use crate::output::{self, Outputs};
use asperity::ActuatorSettings;
use asperity_pictures::fractal_dimension::{COLOUR_LIMIT, Condition};
use asperity_pictures::from_photo::{
    Doubt, MOST_TEXELS, PhotoOptions, PhotoSurface, TEXEL_M, calibration, surface_from_photo,
};
use asperity_pictures::light::Light;
use asperity_pictures::photograph::{Photograph, load_reduced_photograph};
use asperity_pictures::shape_from_shading::{Method, STEPS};
use asperity_surface::raster::Raster;
use clap::Args;
pub use report::Report;
use report::Size;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Steps of the document's solver. Source: ours; more only add noise.
const TSAI_SHAH_STEPS: usize = 5;
/// Exaggerations of the relief that the document's study compared.
const VARIANTS: [f64; 3] = [1.0, 2.0, 4.0];

/// Make a touchable surface of a photograph
#[derive(Debug, Args)]
pub struct Options {
    /// Photograph, seen from straight above
    #[arg(value_name = "PHOTO")]
    pub photo: PathBuf,
    /// Folder to write to
    #[arg(short, long = "output", value_name = "DIR")]
    pub output: PathBuf,
    /// Direction to the light: right, down, out of the surface; found out unless given
    #[arg(long, value_name = "X,Y,Z", value_parser = light, allow_hyphen_values = true)]
    pub light: Option<Light>,
    /// Method that finds heights; by the light unless given
    #[arg(long, value_parser = one_of(METHODS))]
    pub method: Option<Method>,
    /// Turn the heights over: what is bright lies deep
    #[arg(long)]
    pub bright_is_deep: bool,
    /// Width of the photograph on the surface, m [default: 40 mm a 256 texels]
    #[arg(long, value_name = "M", value_parser = positive, conflicts_with = "width_mm")]
    pub width_m: Option<f64>,
    /// Height from the lowest to the highest point, m [default: what contrast gives]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub relief_m: Option<f64>,
    /// Factor on the heights that contrast gives, as a report of the same camera and light has it
    #[arg(long, value_name = "FACTOR", value_parser = positive, conflicts_with = "known")]
    pub calibration: Option<f64>,
    /// Photograph of a sample of known relief by the same camera, light and distance: takes the
    /// calibration from it
    #[arg(long, value_name = "PHOTO", requires = "known_relief_m")]
    pub known: Option<PathBuf>,
    /// Relief of that sample from its lowest to its highest point, m
    #[arg(long, value_name = "M", value_parser = positive, requires = "known")]
    pub known_relief_m: Option<f64>,
    /// Factor on the heights; users of the study preferred 2
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = positive)]
    pub exaggerate: f64,
    /// Also write scene_x1.toml, scene_x2.toml and scene_x4.toml
    #[arg(long)]
    pub variants: bool,
    /// The object's file and size
    #[command(flatten)]
    pub object: ObjectOptions,
    /// Print one JSON object, the same as report.json
    #[arg(long)]
    pub json: bool,
}

/// Ways to find heights.
const METHODS: Words<Method, 4> = [
    ("integrable", "Slopes that fit the shading and belong to a surface", Method::Integrable(STEPS)),
    (
        "tsai-shah",
        "Tsai and Shah (1994), for comparison: its heights are no relief",
        Method::TsaiShah(TSAI_SHAH_STEPS),
    ),
    ("dark-is-deep", "Bright is high: for light from everywhere", Method::DarkIsDeep),
    ("flat-ground", "Relief on a flat ground, lit from the viewer's direction", Method::FlatGround),
];

fn light(text: &str) -> Result<Light, String> {
    Light::new(three(text, ", such as -0.5,-0.5,0.7")?).map_err(|error| error.to_string())
}

/// Files that every run writes, or may write: none of them can be the photograph.
const WRITTEN: [&str; 15] = [
    "displacement.png",
    "roughness.png",
    "primitive.png",
    "symmetric.png",
    "residual.png",
    "overview.png",
    "cell.png",
    "scene.toml",
    "scene_lattice.toml",
    "scene_x1.toml",
    "scene_x2.toml",
    "scene_x4.toml",
    "stroke.jsonl",
    "surface.modes.json",
    "report.json",
];

impl Options {
    /// Tests whether no option gives the photograph's width.
    fn assumes_width(&self) -> bool {
        self.object.width_mm.is_none() && self.width_m.is_none()
    }
}

/// Runs the verb.
///
/// # Errors
/// When a photograph cannot be read or is too small, or the folder cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let report = make(options)?;
    output::say_report(&report, options.json, || report.in_words(options))
}

/// Makes the maps and the scene; `stroke` uses it too.
///
/// # Errors
/// As [`run`].
pub fn make(options: &Options) -> Result<Report, CliError> {
    WRITTEN.iter().try_for_each(|name| output::refuse_input(&options.output.join(name)))?;
    let photograph = load(&options.photo)?;
    options.object.check_destination()?;
    let width_m = options.object.width_mm.map(|mm| 1e-3 * mm).or(options.width_m);
    let texel_m = width_m.map_or(TEXEL_M, |width_m| width_m / photograph.width_px as f64);
    let mut settings = PhotoOptions {
        light: options.light,
        method: options.method,
        bright_is_deep: options.bright_is_deep,
        texel_m,
        relief_m: options.relief_m,
        calibration: options.calibration.unwrap_or(1.0),
        exaggeration: options.exaggerate,
        jpeg_divisor: photograph.jpeg_divisor,
    };
    if let (Some(known), Some(relief_m)) = (&options.known, options.known_relief_m) {
        let sample = load(known)?;
        let at_its_size = PhotoOptions {
            texel_m: texel_m * sample.reduced_by as f64,
            jpeg_divisor: sample.jpeg_divisor,
            ..settings
        };
        settings.calibration = calibration(&sample.brightness, relief_m, &at_its_size)
            .map_err(|error| refused(known, &error))?;
    }
    let Photograph { brightness: picture, reduced_by, colour, .. } = photograph;
    settings.texel_m *= reduced_by as f64;
    let size = Size { texel_m: settings.texel_m, reduced_by, calibration: settings.calibration };
    output::ensure_folder(&options.output)?;
    let start = Instant::now();
    let mut surface = surface_from_photo(&picture, &settings, bar("from photo"))
        .map_err(|error| refused(&options.photo, &error))?;
    if colour > COLOUR_LIMIT {
        surface.doubts.push(Doubt::Condition(Condition::Coloured(colour)));
    }
    write(options, &picture, &surface, size, start)
}

fn load(path: &Path) -> Result<Photograph, CliError> {
    load_reduced_photograph(path, MOST_TEXELS).map_err(CliError::from_error)
}

fn write(
    options: &Options,
    picture: &Raster,
    surface: &PhotoSurface,
    size: Size,
    start: Instant,
) -> Result<Report, CliError> {
    let mut outputs = Outputs::new();
    let folder = &options.output;
    let mut files = Vec::new();
    let mut picture_file = |outputs: &mut Outputs, name: &str, raster: &Raster| {
        files.push(name.to_owned());
        outputs.write_gray16(&folder.join(name), raster)
    };
    picture_file(&mut outputs, "displacement.png", &surface.displacement)?;
    picture_file(&mut outputs, "roughness.png", &surface.roughness)?;
    picture_file(&mut outputs, "primitive.png", &surface.primitive)?;
    picture_file(&mut outputs, "symmetric.png", &surface.symmetric)?;
    picture_file(&mut outputs, "residual.png", &surface.residual.map(|v| v + 0.5))?;
    picture_file(&mut outputs, "overview.png", &overview::overview(picture, surface))?;
    if let Some(cell) = &surface.cell {
        picture_file(&mut outputs, "cell.png", &cell.heights)?;
    }
    let size_m = [surface.displacement.width, surface.displacement.height].map(|n| n as f64 * size.texel_m);
    let mut text_file = |outputs: &mut Outputs, name: &str, text: &str| {
        files.push(name.to_owned());
        outputs.write(&folder.join(name), text.as_bytes())
    };
    let variants =
        if options.variants { VARIANTS.map(|factor| factor / options.exaggerate) } else { [1.0; 3] };
    // No stroke leaves the relief; the variants share the largest one's, or they would not differ.
    let deepest_m = surface.relief_m * variants.iter().copied().fold(1.0, f64::max);
    let full_scale_m = deepest_m.max(ActuatorSettings::default().full_scale);
    text_file(&mut outputs, "scene.toml", &scene::of_picture(surface, size_m, 1.0, full_scale_m))?;
    if options.variants {
        for (factor, relative) in VARIANTS.into_iter().zip(variants) {
            let text = scene::of_picture(surface, size_m, relative, full_scale_m);
            text_file(&mut outputs, &format!("scene_x{factor}.toml"), &text)?;
        }
    }
    if let Some(cell) = &surface.cell {
        let text = scene::of_cell(surface, cell, size_m, full_scale_m);
        text_file(&mut outputs, "scene_lattice.toml", &text)?;
    }
    text_file(&mut outputs, "stroke.jsonl", &scene::stroke(size_m).to_jsonl())?;
    text_file(&mut outputs, "surface.modes.json", &scene::modes().to_json())?;
    let heights_m = surface.displacement.map(|grey| grey * surface.relief_m);
    options.object.write(&mut outputs, &heights_m, size.texel_m)?;
    files.extend(options.object.stl.as_ref().map(|path| path.display().to_string()));
    files.push("report.json".to_owned());
    let report = Report::new(options, surface, size, start.elapsed().as_secs_f64(), files);
    outputs.write_json(&folder.join("report.json"), &report)?;
    outputs.commit()?;
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::plain;
    use crate::render;
    use asperity_surface::image_io;
    use std::path::Path;

    #[test]
    fn a_photograph_becomes_a_rendered_stroke() {
        let folder = tempfile::tempdir().unwrap();
        let photo = folder.path().join("photo.png");
        let tiles = Raster::from_fn(96, 80, |x, y| if x % 16 < 2 || y % 16 < 2 { 0.2 } else { 0.7 });
        image_io::save_gray16(&photo, &tiles).unwrap();
        let out = folder.path().join("out");
        let options = Options { variants: true, ..plain(&photo, &out).unwrap() };
        run(&options).unwrap();
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
        for file in report["files"].as_array().unwrap() {
            assert!(out.join(file.as_str().unwrap()).is_file(), "{file}");
        }
        assert!((report["lattice"]["t1_px"][0].as_f64().unwrap() - 16.0).abs() < 0.05);
        let [once, twice, four] =
            ["1", "2", "4"].map(|x| render_scene(&out.join(format!("scene_x{x}.toml")), &out.join("stroke")));
        assert!(once < twice && twice < four && four <= 1.0, "{once} {twice} {four}");
        for field in ["method", "relief_m", "micro_relief_m", "roughness", "sign_confidence", "warnings"] {
            assert!(!report[field].is_null(), "{field}");
        }
        assert_eq!(report["light_is_estimated"], false, "no light was found");
        assert_eq!(report["width_is_assumed"], true);
        // The cell alone, repeated without end, is as high as the map.
        let mapped = render_scene(&out.join("scene_x1.toml"), &out.join("stroke"));
        let repeated = render_scene(&out.join("scene_lattice.toml"), &out.join("stroke"));
        assert!((repeated / mapped - 1.0).abs() < 0.3, "{repeated} against {mapped}");
    }

    #[test]
    fn a_photograph_states_its_assumed_width_and_the_way_to_change_it() {
        let folder = tempfile::tempdir().unwrap();
        let photo = folder.path().join("wall.png");
        image_io::save_gray16(&photo, &Raster::from_fn(96, 80, |x, y| ((x * 7 + y * 13) % 31) as f64 / 31.0))
            .unwrap();
        let out = folder.path().join("wall");
        let assumed: Options = plain(&photo, &out).unwrap();
        let words = make(&assumed).unwrap().in_words(&assumed);
        assert!(words.starts_with("taken to be 15 mm wide (--width-m says another width);"), "{words}");
        let remarks = Options { width_m: Some(0.5), ..plain(&photo, &out).unwrap() };
        let words = make(&remarks).unwrap().in_words(&remarks);
        assert!(words.starts_with("500 mm wide;"), "{words}");
    }

    #[test]
    fn colours_and_patterns_are_doubted_in_the_report_as_analyze_doubts_them() {
        let folder = tempfile::tempdir().unwrap();
        let photo = folder.path().join("photo.png");
        let tile = |x: u32, y: u32| if x % 16 < 2 || y % 16 < 2 { 40 } else { 180 };
        // Red above, blue below, and brightness nearly the same.
        let half = |x: u32, y: u32, more: bool| tile(x, y) / 2 + if more { 80 } else { 0 };
        let picture: Vec<u8> = (0..80)
            .flat_map(|y| (0..96).flat_map(move |x| [half(x, y, y < 40), tile(x, y), half(x, y, y >= 40)]))
            .map(|level: u32| level as u8)
            .collect();
        std::fs::write(&photo, asperity_plot::pixels::png_rgb(96, 80, &picture)).unwrap();
        let out = folder.path().join("out");
        let arguments = ["from-photo", photo.to_str().unwrap(), "-o", out.to_str().unwrap()];
        #[derive(clap::Parser)]
        struct Line {
            #[command(flatten)]
            options: Options,
        }
        run(&<Line as clap::Parser>::parse_from(arguments).options).unwrap();
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
        let warnings = report["warnings"].to_string();
        assert!(warnings.contains("coloured") && warnings.contains("a pattern repeats"), "{warnings}");
    }

    /// Peak of what is felt, as a part of full scale.
    fn render_scene(scene: &Path, stem: &Path) -> f64 {
        let options: render::Options = plain(scene, stem).unwrap();
        let report = render::render(&options).unwrap();
        assert!(report.haptic_peak[0] > 0.0 && report.audio_peak > 0.0);
        assert_eq!(report.quarantined + report.dropped, 0);
        f64::from(report.haptic_peak[0])
    }
}
