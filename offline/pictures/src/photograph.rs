//! Photographs: their brightness, and how much of them is colour rather than light.

mod jpeg;
#[cfg(test)]
mod tests;

use crate::fractal_dimension::ColourSums;
use asperity_surface::image_io::{ImageError, Picture, decode_photograph, open};
use asperity_surface::raster::Raster;
use std::path::Path;

/// A photograph as the tools work on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Photograph {
    /// Brightness 0–1: means of [`Photograph::reduced_by`]² pixels.
    pub brightness: Raster,
    /// Number of pixels a side that are one texel.
    pub reduced_by: usize,
    /// Pixels in a row of the file.
    pub width_px: usize,
    /// Share that is colour rather than light ([`ColourSums::fraction`]).
    pub colour: f64,
    /// [`PhotoOptions::jpeg_divisor`](crate::from_photo::PhotoOptions::jpeg_divisor).
    pub jpeg_divisor: f64,
}

/// Reads a photograph reduced to at most `most_texels`, without ever holding all of a larger one as
/// numbers.
///
/// # Errors
/// As [`load_channel`](asperity_surface::image_io::load_channel).
pub fn load_reduced_photograph(path: impl AsRef<Path>, most_texels: usize) -> Result<Photograph, ImageError> {
    let path = path.as_ref();
    let read = || {
        let mut file = open(path)?;
        let divisor = jpeg::divisor(&mut file).unwrap_or(0.0);
        let photograph = decode_photograph(file)?;
        let [width, height] = photograph.size();
        let reduced_by = Raster::reduction(width, height, most_texels);
        let brightness = photograph.brightness(reduced_by)?;
        Ok(Photograph {
            brightness,
            reduced_by,
            width_px: width,
            colour: colour_of(&photograph),
            jpeg_divisor: divisor / reduced_by as f64,
        })
    };
    read().map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

/// Share of a picture that is colour; 0 of a grey one.
fn colour_of(picture: &Picture) -> f64 {
    let mut sums = ColourSums::default();
    picture.each_colour(|colour| sums.add(colour));
    sums.fraction()
}
