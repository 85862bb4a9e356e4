//! Maps as artists have them: one channel of a PNG, JPEG, PGM, GIF or EXR file, and 16-bit PNG back.
//!
//! The only file that names the `image` crate. What the file *is* decides, never what it is called:
//! palettes are expanded (the index of a pixel is not its grey), interlacing is undone, the file may
//! have any shape, 16 bits stay 16 bits, a picture that EXIF calls turned is turned back, of a moving GIF the first frame counts. A header is believed only within [`MAX_SIDE`] and
//! [`MAX_TEXELS`], before any pixel is decoded.

#[cfg(test)]
mod tests;

use crate::deband::deband;
#[cfg(feature = "offline")]
use crate::fractal_dimension::ColourSums;
use crate::raster::Raster;
use crate::wrap::Wrap;
use image::metadata::Orientation;
use image::{ColorType, DynamicImage, ImageDecoder, ImageReader, Limits};
use std::fs::{self, File};
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Most texels a side may have.
pub const MAX_SIDE: u32 = 32_768;
/// Most texels an image may have: 8192 × 8192. Half a gigabyte as a [`Raster`].
pub const MAX_TEXELS: u64 = 1 << 26;
/// Most bytes a file may have.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Which numbers of a pixel are the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Grey, or 0.2126 R + 0.7152 G + 0.0722 B of the stored numbers (Rec. 709).
    #[default]
    Luma,
    /// Red; grey in a grey image.
    R,
    /// Green; grey in a grey image.
    G,
    /// Blue; grey in a grey image.
    B,
    /// Alpha: where packed textures keep the height.
    A,
}

/// One channel of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelImage {
    /// Values 0–1 (black to white); EXR values as they are.
    pub raster: Raster,
    /// Distance between two neighbouring levels of the file, in the raster's units; 0 for floating
    /// point. Measured, so that 8-bit data in a 16-bit file is known for what it is.
    pub step: f64,
}

impl ChannelImage {
    /// The raster without the terraces of coarse quantisation ([`crate::deband`]).
    #[must_use]
    pub fn debanded(&self, wrap: Wrap) -> Raster {
        deband(&self.raster, self.step, wrap)
    }
}

/// Why a map could not be read or written: which file, what is wrong, what would be right.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", .file.display())]
pub struct ImageError {
    /// The file.
    pub file: PathBuf,
    /// What is wrong with it.
    pub problem: Problem,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The system could not open, read or write it.
    #[error("{0}; a readable file (or a writable folder for output) is needed")]
    Io(std::io::Error),
    /// Its first bytes are of no picture format we read.
    #[error("not a picture this program reads; PNG, JPEG, PGM, GIF{} are read", if cfg!(feature = "exr") { " and EXR" } else { " (and EXR with the feature `exr`)" })]
    UnknownFormat,
    /// The picture is cut off or contradicts itself.
    #[error("damaged or cut off ({0}); a complete file is needed")]
    Damaged(String),
    /// The format allows it, we do not read it.
    #[error("not supported ({0}); 8 or 16 bits a channel, grey or colour, are read")]
    Unsupported(String),
    /// Larger than we are willing to decode.
    #[error(
        "{width} × {height} texels are too many; at most {MAX_SIDE} a side and {MAX_TEXELS} in all are read"
    )]
    TooLarge {
        /// Texels in a row, as the header claims.
        width: u32,
        /// Rows, as the header claims.
        height: u32,
    },
    /// Decoding would take more memory than we grant.
    #[error(
        "asks for more memory than is granted; at most {MAX_SIDE} texels a side and {MAX_TEXELS} in all are read"
    )]
    TooMuchMemory,
    /// The file itself is too long.
    #[error("{0} bytes are too many; at most {MAX_FILE_BYTES} are read")]
    TooLong(u64),
    /// The channel asked for is not in the picture.
    #[error("has no alpha channel; choose `luma`, `r`, `g` or `b`, or a picture with alpha")]
    NoAlpha,
    /// A value is not a number.
    #[error("the value at column {x}, row {y} is not finite; only finite values make a map")]
    NotFinite {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
    /// There is nothing in it.
    #[error("has no texels; at least 1 × 1 is needed")]
    Empty,
}

/// Reads one channel of a picture.
///
/// # Errors
/// [`ImageError`] when the file cannot be read, is no picture, is damaged, too large, lacks the channel
/// or holds values that are not finite.
pub fn load_channel(path: impl AsRef<Path>, channel: Channel) -> Result<ChannelImage, ImageError> {
    let path = path.as_ref();
    load(path, channel).map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

/// Reads the brightness of a photograph, and how much of it is colour rather than light ([`ColourSums::fraction`]), decoding it once.
///
/// # Errors
/// As [`load_channel`].
#[cfg(feature = "offline")]
pub fn load_photograph(path: impl AsRef<Path>) -> Result<(ChannelImage, f64), ImageError> {
    let path = path.as_ref();
    decode(path, Channel::Luma)
        .and_then(|image| Ok((extract(&image, Channel::Luma)?, colour_of(&image))))
        .map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

/// Writes values 0–1 (clamped) as a 16-bit grey PNG. The file appears under its name complete or not
/// at all.
///
/// # Errors
/// [`ImageError`] when the raster is empty or not finite, or the file cannot be written.
pub fn save_gray16(path: impl AsRef<Path>, raster: &Raster) -> Result<(), ImageError> {
    let path = path.as_ref();
    save(path, raster).map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

fn load(path: &Path, channel: Channel) -> Result<ChannelImage, Problem> {
    extract(&decode(path, channel)?, channel)
}

/// The picture of a file that has this channel, turned as EXIF says.
fn decode(path: &Path, channel: Channel) -> Result<DynamicImage, Problem> {
    let file = File::open(path).map_err(Problem::Io)?;
    let metadata = file.metadata().map_err(Problem::Io)?;
    if metadata.is_dir() {
        return Err(Problem::Io(std::io::Error::from(std::io::ErrorKind::IsADirectory)));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(Problem::TooLong(metadata.len()));
    }
    let mut reader = ImageReader::new(BufReader::new(file)).with_guessed_format().map_err(Problem::Io)?;
    match reader.format() {
        Some(format) if format.reading_enabled() => {}
        _ => return Err(Problem::UnknownFormat),
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_TEXELS * 16 + MAX_FILE_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(translate)?;
    let (width, height) = decoder.dimensions();
    if width > MAX_SIDE || height > MAX_SIDE || u64::from(width) * u64::from(height) > MAX_TEXELS {
        return Err(Problem::TooLarge { width, height });
    }
    if width == 0 || height == 0 {
        return Err(Problem::Empty);
    }
    if channel == Channel::A && !decoder.color_type().has_alpha() {
        return Err(Problem::NoAlpha);
    }
    // Telephones store a picture as the sensor lies and say in EXIF which way up it is. Damaged EXIF says nothing.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut image = DynamicImage::from_decoder(decoder).map_err(translate)?;
    image.apply_orientation(orientation);
    Ok(image)
}

/// How much of a picture is colour; 0 of a grey one.
#[cfg(feature = "offline")]
fn colour_of(image: &DynamicImage) -> f64 {
    let mut sums = ColourSums::default();
    let channels = usize::from(image.color().channel_count());
    match image.color() {
        ColorType::L8 | ColorType::La8 | ColorType::L16 | ColorType::La16 => {}
        ColorType::Rgb8 | ColorType::Rgba8 => {
            for pixel in image.as_bytes().chunks_exact(channels) {
                sums.add([pixel[0], pixel[1], pixel[2]].map(f64::from));
            }
        }
        ColorType::Rgb16 | ColorType::Rgba16 => {
            for pixel in image.as_bytes().chunks_exact(2 * channels) {
                sums.add([0, 2, 4].map(|at| f64::from(u16::from_ne_bytes([pixel[at], pixel[at + 1]]))));
            }
        }
        _ => image.to_rgb32f().pixels().for_each(|pixel| sums.add(pixel.0.map(f64::from))),
    }
    sums.fraction()
}

fn translate(error: image::ImageError) -> Problem {
    match error {
        image::ImageError::IoError(e) if e.kind() == std::io::ErrorKind::UnexpectedEof => {
            Problem::Damaged(one_line(&e))
        }
        image::ImageError::IoError(e) => Problem::Io(e),
        image::ImageError::Unsupported(e) => Problem::Unsupported(one_line(&e)),
        image::ImageError::Limits(_) => Problem::TooMuchMemory,
        other => Problem::Damaged(one_line(&other)),
    }
}

/// A message of the decoder without its line breaks and its full stop.
fn one_line(error: &impl std::fmt::Display) -> String {
    let text = error.to_string();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").trim_end_matches('.').to_string()
}

/// One channel of a decoded picture, as 0–1.
fn extract(image: &DynamicImage, channel: Channel) -> Result<ChannelImage, Problem> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let shape = [width * height, usize::from(image.color().channel_count())];
    let pick = |pixel: &[f64]| channel_of(pixel, channel);
    let (values, step) = match image.color() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            integers(image.as_bytes().iter().map(|&b| u16::from(b)), shape, 255, channel)
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let pairs = image.as_bytes().chunks_exact(2).map(|b| u16::from_ne_bytes([b[0], b[1]]));
            integers(pairs, shape, 65_535, channel)
        }
        _ => {
            let rgba = image.to_rgba32f();
            let values = rgba.pixels().map(|p| pick(&p.0.map(f64::from))).collect();
            (values, 0.0)
        }
    };
    let raster = Raster { width, height, values };
    if let Some(at) = raster.values.iter().position(|v| !v.is_finite()) {
        return Err(Problem::NotFinite { x: at % width, y: at / width });
    }
    Ok(ChannelImage { raster, step })
}

/// The channel of integer pixels as 0–1, and the distance of its levels: the greatest number of which
/// every level is a multiple.
fn integers(
    samples: impl Iterator<Item = u16>,
    [texels, channels]: [usize; 2],
    white: u16,
    channel: Channel,
) -> (Vec<f64>, f64) {
    let mut pixel = [0.0; 4];
    let mut filled = 0;
    let mut common = 0;
    let mut values = Vec::with_capacity(texels);
    for sample in samples {
        pixel[filled] = f64::from(sample);
        filled += 1;
        if filled == channels {
            filled = 0;
            let value = channel_of(&pixel[..channels], channel);
            if common != 1 {
                common = greatest_common_divisor(common, value.round() as u16);
            }
            values.push(value / f64::from(white));
        }
    }
    (values, f64::from(common) / f64::from(white))
}

fn greatest_common_divisor(mut a: u16, mut b: u16) -> u16 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

fn channel_of(pixel: &[f64], channel: Channel) -> f64 {
    let is_grey = pixel.len() < 3;
    match channel {
        Channel::A => pixel[pixel.len() - 1],
        Channel::Luma if !is_grey => luma(pixel[0], pixel[1], pixel[2]),
        Channel::G if !is_grey => pixel[1],
        Channel::B if !is_grey => pixel[2],
        _ => pixel[0],
    }
}

/// Weighted so that a grey pixel keeps its number exactly.
fn luma(r: f64, g: f64, b: f64) -> f64 {
    g + 0.2126 * (r - g) + 0.0722 * (b - g)
}

fn save(path: &Path, raster: &Raster) -> Result<(), Problem> {
    let (width, height) = (raster.width, raster.height);
    if raster.values.is_empty() || raster.values.len() != width * height {
        return Err(Problem::Empty);
    }
    if let Some(at) = raster.values.iter().position(|v| !v.is_finite()) {
        return Err(Problem::NotFinite { x: at % width, y: at / width });
    }
    let (Ok(w), Ok(h)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(Problem::TooLarge { width: u32::MAX, height: u32::MAX });
    };
    let grey: Vec<u16> =
        raster.values.iter().map(|v| (v.clamp(0.0, 1.0) * 65_535.0).round() as u16).collect();
    let image = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(w, h, grey).ok_or(Problem::Empty)?;
    let beside = beside(path);
    let result = (|| {
        let mut file = BufWriter::new(File::create(&beside).map_err(Problem::Io)?);
        image.write_with_encoder(image::codecs::png::PngEncoder::new(&mut file)).map_err(translate)?;
        file.flush().map_err(Problem::Io)?;
        drop(file);
        fs::rename(&beside, path).map_err(Problem::Io)
    })();
    if result.is_err() {
        let _ = fs::remove_file(&beside);
    }
    result
}

/// A name in the same folder that no other process uses.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}
