//! `asperity texture solid PRESET --size N -o OUT.png`: a solid-noise material or a grating as a
//! picture, as functions of a shader, or as a map over a mesh.

use super::bake::bake;
use super::shader::{Language, of_grating, of_solid};
use super::{positive, say_preview, write_heights};
use crate::arguments::{Words, one_of};
use crate::error::CliError;
use crate::output::{self, Outputs, check_destination};
use crate::paths::ends_in;
use asperity_plot::quantity;
use asperity_surface::grating::{GratingKind, GratingParameters};
use asperity_surface::raster::Raster;
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{SolidCut, SolidNoise};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Make a 16-bit picture, or a shader's functions, of a solid-noise material (sandpaper, granite,
/// rough glass, wood, sand, gravel, pebbles, ridged, billow, turbulence, voronoi) or of a grating
#[derive(Debug, Args)]
pub struct Options {
    /// Name of the material, or `grating`
    #[arg(value_name = "PRESET")]
    pub preset: String,
    /// Texels a side
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(2..=4096))]
    pub size: u32,
    /// Seed of the noise
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Width of the picture on the surface, m
    #[arg(long, value_name = "M", default_value_t = 0.05, value_parser = positive)]
    pub width_m: f64,
    /// Shape of a grating
    #[arg(long, value_parser = one_of(KINDS))]
    pub kind: Option<GratingKind>,
    /// Period of a grating, m [default: 2 mm]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub pitch_m: Option<f64>,
    /// Height of a grating's tops over its middle, m [default: 50 µm]
    #[arg(long, value_name = "M", value_parser = positive)]
    pub amplitude_m: Option<f64>,
    /// Share of the period that a grating's ridge or dot takes [default: 0.5]
    #[arg(long, value_name = "SHARE", value_parser = positive)]
    pub duty: Option<f64>,
    /// Write functions of this language instead of a picture: NAME_height of a place in the block
    /// and NAME_picture of a place in the picture, both metres
    #[arg(long, value_enum, value_name = "LANGUAGE")]
    pub shader: Option<Language>,
    /// Sample it over the surface of a glTF mesh instead, into the mesh's texture coordinates: for
    /// engines without shaders
    #[arg(long, value_name = "MESH.glb", conflicts_with_all = ["shader", "width_m"])]
    pub bake: Option<PathBuf>,
    /// File to write: 16-bit PNG, or the shader's text, which goes to stdout unless given
    #[arg(short, long = "output", value_name = "OUT.png", required_unless_present = "shader")]
    pub output: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Shape of a grating.
const KINDS: Words<GratingKind, 3> = [
    ("sine", "Waves", GratingKind::Sine),
    ("ridges", "Flat ridges", GratingKind::Ridges),
    ("dots", "Round dots", GratingKind::Dots),
];

#[derive(Debug, Serialize)]
struct ShaderReport {
    name: String,
    shader: String,
    files: Vec<PathBuf>,
}

/// Heights that are drawn.
enum Heights {
    Solid(Box<SolidNoise>),
    Grating(GratingParameters),
}

/// Runs the verb.
///
/// # Errors
/// When the material is unknown or the output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let heights = heights(options)?;
    if let Some(language) = options.shader {
        return write_shader(options, &heights, language);
    }
    let Some(path) = &options.output else { return Ok(()) };
    ends_in(path, "png")?;
    check_destination(path)?;
    let size = options.size as usize;
    if let Some(mesh) = &options.bake {
        return write_baked(options, &heights, mesh, path);
    }
    let metres_per_px = options.width_m / size as f64;
    if let Heights::Grating(grating) = &heights
        && grating.pitch_m < 2.0 * metres_per_px
    {
        let what = format!(
            "{} is finer than two texels of {}",
            quantity(grating.pitch_m, "m"),
            quantity(metres_per_px, "m")
        );
        return Err(CliError::new("--pitch-m", what, "give a smaller --width-m or a larger --size"));
    }
    let heights_m = Raster::from_fn(size, size, |x, y| {
        let place = [(x as f64 + 0.5) * metres_per_px, (y as f64 + 0.5) * metres_per_px];
        match &heights {
            Heights::Grating(grating) => grating.at(place, 0.0).0,
            Heights::Solid(noise) => {
                let parameters = noise.parameters();
                parameters.amplitude_m * noise.definition(&parameters, SolidCut::SLANTED.at(place))
            }
        }
    });
    let preview = write_heights(path, &heights_m, metres_per_px)?;
    say_preview(&preview, options.json, options.width_m)
}

fn write_baked(options: &Options, heights: &Heights, mesh: &Path, path: &Path) -> Result<(), CliError> {
    let Heights::Solid(noise) = heights else {
        let right = "bake a solid: a grating lies in one plane";
        return Err(CliError::new("--bake", "takes no grating", right));
    };
    let parameters = noise.parameters();
    let height = |at_m| parameters.amplitude_m * noise.definition(&parameters, at_m);
    let baked = bake(mesh, options.size as usize, height)?;
    let mut preview = write_heights(path, &baked.heights_m, baked.metres_per_px)?;
    preview.warnings = baked.warnings;
    let width_m = baked.metres_per_px * f64::from(options.size);
    say_preview(&preview, options.json, 1e-6 * (1e6 * width_m).round())
}

fn heights(options: &Options) -> Result<Heights, CliError> {
    let &Options { kind, pitch_m, amplitude_m, duty, .. } = options;
    if options.preset.trim().eq_ignore_ascii_case("grating") {
        let usual = GratingParameters::default();
        let grating = GratingParameters {
            kind: kind.unwrap_or(usual.kind),
            pitch_m: pitch_m.unwrap_or(usual.pitch_m),
            amplitude_m: amplitude_m.unwrap_or(usual.amplitude_m),
            duty: duty.unwrap_or(usual.duty),
        };
        grating.check().map_err(CliError::from_error)?;
        return Ok(Heights::Grating(grating));
    }
    let material = SolidMaterial::from_name(&options.preset).ok_or_else(|| {
        let known = SolidMaterial::all().map(SolidMaterial::name).collect::<Vec<_>>().join(", ");
        let right = format!("must be one of: {known}, grating");
        CliError::new("PRESET", format!("\"{}\" is unknown", options.preset), right)
    })?;
    if kind.is_some() || [pitch_m, amplitude_m, duty].iter().any(Option::is_some) {
        let right = "leave --kind, --pitch-m, --amplitude-m and --duty to `texture solid grating`";
        return Err(CliError::new("PRESET", format!("{} is no grating", material.name()), right));
    }
    let noise = SolidNoise::new(material.parameters(), options.seed).map_err(CliError::from_error)?;
    Ok(Heights::Solid(Box::new(noise)))
}

fn write_shader(options: &Options, heights: &Heights, language: Language) -> Result<(), CliError> {
    let name = options.preset.trim().to_ascii_lowercase().replace(['-', ' '], "_");
    let shader = match heights {
        Heights::Grating(grating) => of_grating(&name, grating, language),
        Heights::Solid(noise) => of_solid(&name, noise, &noise.parameters(), language),
    };
    let mut outputs = Outputs::new();
    if let Some(path) = &options.output {
        ends_in(path, if language == Language::Wgsl { "wgsl" } else { "glsl" })?;
        outputs.write(path, shader.as_bytes())?;
    }
    let files = outputs.commit()?;
    if options.json {
        return output::say_json(&ShaderReport { name, shader, files });
    }
    output::say(files.first().map_or(&shader, |_| &name));
    Ok(())
}
