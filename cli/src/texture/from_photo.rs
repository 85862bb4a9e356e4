//! `asperity texture from-photo PHOTO -o DIR`: a photograph becomes displacement, roughness and a scene.

use super::{bar, grey, positive, refused};
use crate::error::CliError;
use crate::output::{self, Outputs};
use asperity::ActuatorSettings;
use asperity_texture::from_photo::{PhotoOptions, PhotoSurface, TEXEL_M, surface_from_photo};
use asperity_texture::image_io;
use asperity_texture::light::Light;
use asperity_texture::raster::Raster;
use asperity_texture::shape_from_shading::{Method, STEPS};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Steps of the document's solver. Source: ours; more only add noise.
const TSAI_SHAH_STEPS: usize = 5;
/// Exaggerations of the relief that the document's study compared.
const VARIANTS: [f64; 3] = [1.0, 2.0, 4.0];
/// The generated stroke: speed, m/s, force, N, length, s, and events a second.
const STROKE: (f64, f64, f64, f64) = (0.1, 0.6, 2.0, 60.0);
/// A free bar struck in the middle, 420 Hz: ratios of a uniform bar, decays and levels assumed.
const MODES: [(f64, f64, f64); 4] =
    [(420.0, 9.0, 0.3), (1157.5, 16.0, 0.22), (2269.7, 27.0, 0.15), (3751.9, 41.0, 0.1)];
/// Largest side of a panel in the overview, texels.
const PANEL: usize = 512;

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
    /// How heights are found; by what the light allows unless given
    #[arg(long, value_enum)]
    pub method: Option<MethodName>,
    /// What the photograph's width is on the surface, m [default: 40 mm a 256 texels]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub width_m: Option<f64>,
    /// Height from the lowest to the highest point, m [default: what shading gives]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub relief_m: Option<f64>,
    /// Factor on the heights; users of the study preferred 2
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = positive)]
    pub exaggerate: f64,
    /// Also write scene_x1.toml, scene_x2.toml and scene_x4.toml
    #[arg(long)]
    pub variants: bool,
    /// Print one JSON object, the same as report.json
    #[arg(long)]
    pub json: bool,
}

/// Ways to find heights.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum MethodName {
    /// Slopes that fit the shading and belong to a surface.
    Integrable,
    /// Document 004's.
    TsaiShah,
    /// Bright is high: for light from everywhere.
    DarkIsDeep,
}

fn light(text: &str) -> Result<Light, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    let numbers = numbers.ok().and_then(|n| <[f64; 3]>::try_from(n).ok());
    let numbers = numbers.ok_or("must be three numbers, such as -0.5,-0.5,0.7")?;
    Light::new(numbers).map_err(|error| error.to_string())
}

#[derive(Debug, Serialize)]
struct LatticeReport {
    t1_px: [f64; 2],
    t2_px: [f64; 2],
    confidence: f64,
    /// Fraction of the picture's variance that repeats.
    share: f64,
    /// Whether the pattern wanders off the lattice: heights are then the whole picture's.
    wanders: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    photo: PathBuf,
    width: usize,
    height: usize,
    texel_m: f64,
    width_m: f64,
    height_m: f64,
    relief_m: f64,
    micro_relief_m: f64,
    method: &'static str,
    /// Unit vector to the light that was used.
    light: Option<[f64; 3]>,
    light_is_estimated: bool,
    unexplained: Option<f64>,
    lattice: Option<LatticeReport>,
    wallpaper_group: Option<&'static str>,
    fractal_dimension: Option<f64>,
    roughness_mean: f64,
    tileable: bool,
    seconds: f64,
    files: Vec<String>,
}

/// Runs the verb.
///
/// # Errors
/// When the photograph cannot be read or is too small, or the folder cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let picture = grey(&options.photo)?;
    output::ensure_folder(&options.output)?;
    let texel_m = options.width_m.map_or(TEXEL_M, |width_m| width_m / picture.width as f64);
    let settings = PhotoOptions {
        light: options.light,
        method: options.method.map(|name| match name {
            MethodName::Integrable => Method::Integrable(STEPS),
            MethodName::TsaiShah => Method::TsaiShah(TSAI_SHAH_STEPS),
            MethodName::DarkIsDeep => Method::DarkIsDeep,
        }),
        texel_m,
        relief_m: options.relief_m,
        exaggeration: options.exaggerate,
    };
    let start = Instant::now();
    let surface = surface_from_photo(&picture, &settings, bar("from photo"))
        .map_err(|error| refused(&options.photo, &error))?;
    let seconds = start.elapsed().as_secs_f64();
    let report = write(options, &picture, &surface, texel_m, seconds)?;
    if options.json {
        return output::say_json(&report);
    }
    let lattice = report.lattice.as_ref().map_or("nothing repeats".to_owned(), |lattice| {
        let group = report.wallpaper_group.unwrap_or("p1");
        let wanders = if lattice.wanders { ", but wanders: nothing is averaged" } else { "" };
        format!("repeats along {:.1?} and {:.1?} texels ({group}){wanders}", lattice.t1_px, lattice.t2_px)
    });
    output::say(&format!(
        "{lattice}; heights by {}, relief {:.2} mm, roughness {:.2}\nwrote {} files to {}\n\
         next: asperity render {} -o {}",
        report.method,
        report.relief_m * 1e3,
        report.roughness_mean,
        report.files.len(),
        options.output.display(),
        options.output.join("scene.toml").display(),
        options.output.join("stroke").display(),
    ));
    Ok(())
}

fn write(
    options: &Options,
    picture: &Raster,
    surface: &PhotoSurface,
    texel_m: f64,
    seconds: f64,
) -> Result<Report, CliError> {
    let mut outputs = Outputs::new();
    let folder = &options.output;
    let mut files = Vec::new();
    let mut picture_file = |outputs: &mut Outputs, name: &str, raster: &Raster| {
        files.push(name.to_owned());
        outputs
            .write_at(&folder.join(name), |path| image_io::save_gray16(path, raster).map_err(CliError::told))
    };
    picture_file(&mut outputs, "displacement.png", &surface.displacement)?;
    picture_file(&mut outputs, "roughness.png", &surface.roughness)?;
    picture_file(&mut outputs, "primitive.png", &surface.primitive)?;
    picture_file(&mut outputs, "symmetric.png", &surface.symmetric)?;
    picture_file(&mut outputs, "residual.png", &surface.residual.map(|v| v + 0.5))?;
    picture_file(&mut outputs, "overview.png", &overview(picture, surface))?;
    let size_m = [surface.displacement.width, surface.displacement.height].map(|n| n as f64 * texel_m);
    let mut text_file = |outputs: &mut Outputs, name: &str, text: &str| {
        files.push(name.to_owned());
        outputs.write(&folder.join(name), text.as_bytes())
    };
    let variants =
        if options.variants { VARIANTS.map(|factor| factor / options.exaggerate) } else { [1.0; 3] };
    // No stroke leaves the relief; the variants share the largest one's, or they would not differ.
    let deepest_m = surface.relief_m * variants.iter().copied().fold(1.0, f64::max);
    let full_scale_m = deepest_m.max(ActuatorSettings::default().full_scale);
    text_file(&mut outputs, "scene.toml", &scene(surface, size_m, 1.0, full_scale_m))?;
    if options.variants {
        for (factor, relative) in VARIANTS.into_iter().zip(variants) {
            let text = scene(surface, size_m, relative, full_scale_m);
            text_file(&mut outputs, &format!("scene_x{factor}.toml"), &text)?;
        }
    }
    text_file(&mut outputs, "stroke.jsonl", &stroke(size_m))?;
    text_file(&mut outputs, "surface.modes.json", &modes()?)?;
    files.push("report.json".to_owned());
    let report = report(options, surface, texel_m, seconds, files);
    let text = serde_json::to_string_pretty(&report)
        .map_err(|error| CliError::new("report.json", error, "please report it with the photograph"))?;
    outputs.write(&folder.join("report.json"), text.as_bytes())?;
    outputs.commit()?;
    Ok(report)
}

fn report(
    options: &Options,
    surface: &PhotoSurface,
    texel_m: f64,
    seconds: f64,
    files: Vec<String>,
) -> Report {
    let (width, height) = (surface.displacement.width, surface.displacement.height);
    let repetition = surface.repetition.as_ref();
    Report {
        photo: options.photo.clone(),
        width,
        height,
        texel_m,
        width_m: width as f64 * texel_m,
        height_m: height as f64 * texel_m,
        relief_m: surface.relief_m,
        micro_relief_m: surface.micro_relief_m,
        method: match surface.shape.method {
            Method::Integrable(_) => "integrable",
            Method::TsaiShah(_) => "tsai-shah",
            Method::DarkIsDeep => "dark-is-deep",
        },
        light: surface.shape.light.map(|light| light.direction()),
        light_is_estimated: options.light.is_none(),
        unexplained: surface.shape.unexplained,
        lattice: repetition.map(|found| LatticeReport {
            t1_px: found.lattice.t1_px,
            t2_px: found.lattice.t2_px,
            confidence: found.lattice.confidence,
            share: found.share,
            wanders: found.wanders,
        }),
        wallpaper_group: repetition.map(|found| found.group.name()),
        fractal_dimension: surface.dimension,
        roughness_mean: surface.roughness.mean(),
        tileable: surface.tileable,
        seconds,
        files,
    }
}

/// A scene that renders at once.
fn scene(surface: &PhotoSurface, [width_m, height_m]: [f64; 2], factor: f64, full_scale_m: f64) -> String {
    let wrap = if surface.tileable { "repeat" } else { "mirror" };
    format!(
        "# A stroke over the surface of a photograph.\n\
         contacts = \"stroke.jsonl\"\n\n\
         [[body]]\nname = \"plate\"\nmodes = \"surface.modes.json\"\n\n\
         [[surface]]\nname = \"photo\"\nbody = \"plate\"\n\
         displacement = \"displacement.png\"\nroughness = \"roughness.png\"\n\
         width_m = {width_m:?}\nheight_m = {height_m:?}\nrelief_m = {:?}\n\
         micro_relief_m = {:?}\nwrap = \"{wrap}\"\n\n\
         [[actuator]]\noutput = \"displacement\"\nfull_scale = {full_scale_m:?}\n",
        surface.relief_m * factor,
        surface.micro_relief_m * factor,
    )
}

/// A stroke across the middle, along u.
fn stroke([width_m, height_m]: [f64; 2]) -> String {
    let (speed, force, seconds, rate) = STROKE;
    let steps = (seconds * rate) as usize;
    let line = |step: usize| {
        let t = step as f64 / rate;
        let event = if step == 0 { "\"begin\"" } else { "\"move\"" };
        let place = if step == 0 { ",\"surface\":\"photo\",\"actuator\":0" } else { "" };
        let closing = if step == 0 { ",\"closing_m_s\":0.02" } else { "" };
        // A slight diagonal, so that a repeated pattern is not met on one line only.
        let uv = [0.05 + speed * t / width_m, 0.45 + 0.05 * speed * t / height_m];
        format!(
            "{{\"t\":{t:.6},\"event\":{event},\"contact\":1{place},\"uv\":[{:.9},{:.9}],\
             \"velocity_m_s\":[{speed},{}],\"normal_force_n\":{force}{closing}}}\n",
            uv[0],
            uv[1],
            0.05 * speed
        )
    };
    let mut text: String = (0..steps).map(line).collect();
    text.push_str(&format!("{{\"t\":{seconds:.6},\"event\":\"end\",\"contact\":1}}\n"));
    text
}

fn modes() -> Result<String, CliError> {
    let modes = MODES.map(|(frequency_hz, decay_per_s, amplitude)| {
        serde_json::json!({ "frequency_hz": frequency_hz, "decay_per_s": decay_per_s, "amplitude": amplitude, "phase_rad": 0.0 })
    });
    let model = serde_json::json!({
        "format": "asperity.modes", "version": 1, "source": "assumed: a free bar",
        "impulse_n_s": 0.01, "modes": modes,
    });
    serde_json::to_string_pretty(&model)
        .map_err(|error| CliError::new("surface.modes.json", error, "please report it with the photograph"))
}

/// Photo, symmetric part, residual; displacement, displacement lit from above left, roughness.
fn overview(picture: &Raster, surface: &PhotoSurface) -> Raster {
    let panels = [
        small(&stretched(picture)),
        small(&stretched(&surface.symmetric)),
        small(&surface.residual.map(|v| (v + 0.5).clamp(0.0, 1.0))),
        small(&surface.displacement),
        lit(&small(&surface.shape.height_px), surface.shape.height_px.width),
        small(&surface.roughness),
    ];
    let (w, h) = (panels[0].width, panels[0].height);
    let gap = 6;
    Raster::from_fn(3 * w + 2 * gap, 2 * h + gap, |x, y| {
        let (column, row) = (x / (w + gap), y / (h + gap));
        let (x, y) = (x % (w + gap), y % (h + gap));
        if x < w && y < h { panels[row * 3 + column].at(x, y) } else { 1.0 }
    })
}

fn stretched(raster: &Raster) -> Raster {
    let (low, high) = raster.range();
    raster.map(|v| if high > low { (v - low) / (high - low) } else { 0.5 })
}

/// Every n-th texel's mean, so that no side is above [`PANEL`].
fn small(raster: &Raster) -> Raster {
    let step = raster.width.max(raster.height).div_ceil(PANEL);
    Raster::from_fn(raster.width / step, raster.height / step, |x, y| {
        let cell = (0..step * step).map(|i| raster.at(x * step + i % step, y * step + i / step));
        cell.sum::<f64>() / (step * step) as f64
    })
}

/// Heights (texels of a picture `full` wide) under a light from above left.
fn lit(height: &Raster, full: usize) -> Raster {
    let texel = full as f64 / height.width as f64;
    let [sx, sy, sz] = Light::ABOVE_LEFT.direction();
    Raster::from_fn(height.width, height.height, |x, y| {
        let (left, up) = (x.saturating_sub(1), y.saturating_sub(1));
        let (right, down) = ((x + 1).min(height.width - 1), (y + 1).min(height.height - 1));
        let p = (height.at(right, y) - height.at(left, y)) / ((right - left) as f64 * texel);
        let q = (height.at(x, down) - height.at(x, up)) / ((down - up) as f64 * texel);
        ((sz - sx * p - sy * q) / (1.0 + p * p + q * q).sqrt()).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render;
    use std::path::Path;

    #[test]
    fn a_photograph_becomes_a_rendered_stroke() {
        let folder = tempfile::tempdir().unwrap();
        let photo = folder.path().join("photo.png");
        let tiles = Raster::from_fn(96, 80, |x, y| if x % 16 < 2 || y % 16 < 2 { 0.2 } else { 0.7 });
        image_io::save_gray16(&photo, &tiles).unwrap();
        let out = folder.path().join("out");
        let options = Options {
            photo,
            output: out.clone(),
            light: None,
            method: None,
            width_m: None,
            relief_m: None,
            exaggerate: 1.0,
            variants: true,
            json: false,
        };
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
    }

    /// Peak of what is felt, as a part of full scale.
    fn render_scene(scene: &Path, stem: &Path) -> f64 {
        let options = render::Options {
            scene: scene.to_owned(),
            output: stem.to_owned(),
            rate: None,
            block: 256,
            seed: None,
            integrator: None,
            path: None,
            trace: false,
            force: false,
            plot: false,
            json: false,
        };
        let report = render::render(&options).unwrap();
        assert!(report.haptic_peak[0] > 0.0 && report.audio_peak > 0.0);
        assert_eq!(report.quarantined + report.dropped, 0);
        f64::from(report.haptic_peak[0])
    }
}
