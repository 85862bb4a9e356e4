//! `asperity texture brownian --hurst H --size N --seed S -o OUT.png`: a Brownian surface as a
//! picture.

use super::{positive, say_preview, write_heights};
use crate::error::CliError;
use crate::output::check_destination;
use asperity_surface::brownian::{BrownianDesign, Method};
use clap::Args;
use std::path::PathBuf;

/// Make a 16-bit picture of a fractional Brownian surface
#[derive(Debug, Args)]
pub struct Options {
    /// Hurst exponent, above 0 and below 1: smaller is rougher; the dimension is 3 − H
    #[arg(long, value_name = "H", value_parser = exponent)]
    pub hurst: f64,
    /// Texels a side
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(4..=4096))]
    pub size: u32,
    /// Seed
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Rms height, m
    #[arg(long, value_name = "M", default_value_t = 1e-4, value_parser = positive)]
    pub rms_m: f64,
    /// Width of the picture on the surface, m
    #[arg(long, value_name = "M", default_value_t = 0.1, value_parser = positive)]
    pub width_m: f64,
    /// Let the surface end at its edges instead of repeating without a seam (at most 1024 texels a
    /// side)
    #[arg(long)]
    pub open: bool,
    /// Random midpoint displacement, the older construction, instead of the exact one; implies
    /// --open
    #[arg(long)]
    pub midpoint: bool,
    /// 16-bit PNG to write
    #[arg(short, long = "output", value_name = "OUT.png")]
    pub output: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

fn exponent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(hurst) if hurst > 0.0 && hurst < 1.0 => Ok(hurst),
        _ => Err("must be above 0 and below 1".to_owned()),
    }
}

/// Runs the verb.
///
/// # Errors
/// When the surface cannot be made at this size or the output cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    check_destination(&options.output)?;
    let design = BrownianDesign {
        hurst: options.hurst,
        size: options.size as usize,
        seed: options.seed,
        method: if options.midpoint { Method::Midpoint } else { Method::Exact },
        periodic: !(options.open || options.midpoint),
        rms_m: options.rms_m,
    };
    let heights_m = design.surface().map_err(CliError::from_error)?;
    let metres_per_px = options.width_m / heights_m.width as f64;
    let preview = write_heights(&options.output, &heights_m, metres_per_px)?;
    say_preview(&preview, options.json, options.width_m)
}
