//! `asperity texture …`: tools that make surfaces from pictures and from other surfaces.
//!
//! What the verbs share is here: pictures in, refusals in words, a bar for a fraction done.

pub mod from_normals;
pub mod from_photo;
pub mod metamer;

use crate::error::CliError;
use crate::progress::Progress;
use asperity_dsp::DesignError;
use asperity_texture::image_io::{self, Channel};
use asperity_texture::raster::Raster;
use clap::Subcommand;
use std::path::Path;

/// What to do with a texture.
#[derive(Debug, Subcommand)]
pub enum Verb {
    FromNormals(from_normals::Options),
    FromPhoto(from_photo::Options),
    Metamer(metamer::Options),
}

/// Runs the verb.
///
/// # Errors
/// When an input is bad or an output cannot be written.
pub fn run(verb: Verb) -> Result<(), CliError> {
    match verb {
        Verb::FromNormals(options) => from_normals::run(&options),
        Verb::FromPhoto(options) => from_photo::run(&options),
        Verb::Metamer(options) => metamer::run(&options),
    }
}

/// The grey values of a picture, 0–1.
fn grey(path: &Path) -> Result<Raster, CliError> {
    channel(path, Channel::Luma)
}

/// One channel of a picture, 0–1.
fn channel(path: &Path, channel: Channel) -> Result<Raster, CliError> {
    image_io::load_channel(path, channel).map(|image| image.raster).map_err(CliError::told)
}

/// A refused parameter or picture, at the file it came from.
fn refused(at: &Path, error: &DesignError) -> CliError {
    let what = format!("{} is refused", error.value);
    CliError::new(error.field, what, format!("must be {}", error.expected)).within(at.display())
}

/// A bar that is told the fraction done.
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

/// A number above 0.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a number above 0".to_owned()),
    }
}
