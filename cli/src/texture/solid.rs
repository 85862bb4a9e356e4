//! `asperity texture solid PRESET --size N -o OUT.png`: one of the seven solid-noise materials as a
//! picture.

use super::{positive, say_preview, write_heights};
use crate::error::CliError;
use crate::output::check_destination;
use asperity_surface::raster::Raster;
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::{SolidCut, SolidNoise};
use clap::Args;
use std::path::PathBuf;

/// Make a 16-bit picture of a solid-noise material: sandpaper, granite, rough glass, wood, sand,
/// gravel, pebbles
#[derive(Debug, Args)]
pub struct Options {
    /// Name of the material
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
    /// 16-bit PNG to write
    #[arg(short, long = "output", value_name = "OUT.png")]
    pub output: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// When the material is unknown or the output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    check_destination(&options.output)?;
    let material = SolidMaterial::from_name(&options.preset).ok_or_else(|| {
        let known = SolidMaterial::SEVEN.map(SolidMaterial::name).join(", ");
        CliError::new(
            "PRESET",
            format!("\"{}\" is unknown", options.preset),
            format!("must be one of: {known}"),
        )
    })?;
    let parameters = material.parameters();
    let noise = SolidNoise::new(parameters, options.seed).map_err(CliError::from_error)?;
    let size = options.size as usize;
    let metres_per_px = options.width_m / size as f64;
    let heights_m = Raster::from_fn(size, size, |x, y| {
        let place = [(x as f64 + 0.5) * metres_per_px, (y as f64 + 0.5) * metres_per_px];
        parameters.amplitude_m * noise.definition(&parameters, SolidCut::SLANTED.at(place))
    });
    let preview = write_heights(&options.output, &heights_m, metres_per_px)?;
    say_preview(&preview, options.json, options.width_m)
}
