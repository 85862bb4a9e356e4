//! Maps as artists have them: one channel of a PNG, JPEG, PGM, GIF, WebP, TIFF, TGA, BMP or EXR
//! file, and 16-bit PNG back.
//!
//! The only room that names the `image` crate and its decoders. What the file *is* decides, never
//! what it is called: palettes are expanded (the index of a pixel is not its grey), interlacing is
//! undone, the file may have any shape, 16 bits stay 16 bits, a picture that EXIF calls turned is
//! turned back, of a moving GIF the first frame counts. A header is believed only within
//! [`MAX_SIDE`] and [`MAX_TEXELS`], before any pixel is decoded.

#[cfg(feature = "exr")]
mod exr;
mod other_kinds;
#[cfg(test)]
mod tests;
#[cfg(feature = "more-pictures")]
mod tiff;

use crate::picture::Samples;
pub use crate::picture::{
    Channel, ChannelImage, ImageError, MAX_FILE_BYTES, MAX_SIDE, MAX_TEXELS, Picture, Problem,
};
use crate::raster::Raster;
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::fs::{self, File};
use std::io::{BufRead, BufReader, BufWriter, Cursor, Read, Seek, Write};
use std::path::{Path, PathBuf};

/// Bytes by which a kind of file is known.
const FIRST_BYTES: u64 = 64;

/// Reads one channel of a picture.
///
/// # Errors
/// [`ImageError`] when the file cannot be read, is no picture, is damaged, too large, lacks the
/// channel or holds values that are not finite.
pub fn load_channel(path: impl AsRef<Path>, channel: Channel) -> Result<ChannelImage, ImageError> {
    let path = path.as_ref();
    load(path, channel).map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

/// Reads one channel of a picture from the bytes of its file.
///
/// # Errors
/// As [`load_channel`].
pub fn read_channel(bytes: &[u8], channel: Channel) -> Result<ChannelImage, Problem> {
    decode(Cursor::new(bytes), channel)?.channel(channel)
}

/// Reads one channel of a picture as a map of a surface ([`Picture::map`]), from the bytes of its
/// file.
///
/// # Errors
/// As [`load_channel`], and when it is a normal map.
pub fn read_map(bytes: &[u8], channel: Channel) -> Result<ChannelImage, Problem> {
    decode(Cursor::new(bytes), channel)?.map(channel)
}

/// [`read_map`] of a file.
///
/// # Errors
/// As [`read_map`].
pub fn load_map(path: impl AsRef<Path>, channel: Channel) -> Result<ChannelImage, ImageError> {
    let path = path.as_ref();
    let read = open(path).and_then(|file| decode(file, channel)?.map(channel));
    read.map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

/// Writes values 0–1 (clamped) as a 16-bit grey PNG. The file appears under its name complete or
/// not at all.
///
/// # Errors
/// [`ImageError`] when the raster is empty or not finite, or the file cannot be written.
pub fn save_gray16(path: impl AsRef<Path>, raster: &Raster) -> Result<(), ImageError> {
    let path = path.as_ref();
    save(path, raster).map_err(|problem| ImageError { file: path.to_path_buf(), problem })
}

fn load(path: &Path, channel: Channel) -> Result<ChannelImage, Problem> {
    decode(open(path)?, channel)?.channel(channel)
}

/// Opens a file that is short enough to be a picture.
///
/// # Errors
/// When it cannot be opened, is a folder or longer than [`MAX_FILE_BYTES`].
pub fn open(path: &Path) -> Result<BufReader<File>, Problem> {
    let file = File::open(path).map_err(Problem::Io)?;
    let metadata = file.metadata().map_err(Problem::Io)?;
    if metadata.is_dir() {
        return Err(Problem::Io(std::io::Error::from(std::io::ErrorKind::IsADirectory)));
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(Problem::TooLong(metadata.len()));
    }
    Ok(BufReader::new(file))
}

/// Reader of a picture, as a trait object: decoders are compiled once, not for each reader.
trait Source: BufRead + Seek {}

impl<T: BufRead + Seek> Source for T {}

/// The picture of a file that has this channel, turned as EXIF says.
fn decode(mut file: impl BufRead + Seek, channel: Channel) -> Result<Picture, Problem> {
    Ok(decode_as(&mut file, channel)?.0)
}

/// The picture of a photograph's file, with the brightness that the file itself has.
///
/// # Errors
/// As [`load_channel`].
pub fn decode_photograph(mut file: impl BufRead + Seek) -> Result<Picture, Problem> {
    let (photograph, format) = decode_as(&mut file, Channel::Luma)?;
    Ok(if format == ImageFormat::Jpeg { photograph.of_jpeg() } else { photograph })
}

/// Picture, and the kind of file it is.
fn decode_as(mut file: &mut dyn Source, channel: Channel) -> Result<(Picture, ImageFormat), Problem> {
    let format = format_of(&mut file)?;
    #[cfg(feature = "exr")]
    if format == ImageFormat::OpenExr {
        return Ok((exr::read(file)?, format));
    }
    #[cfg(feature = "more-pictures")]
    if format == ImageFormat::Tiff
        && let Some(picture) = tiff::read(&mut file)?
    {
        return Ok((picture, format));
    }
    if !format.reading_enabled() {
        return Err(Problem::UnknownFormat);
    }
    let mut reader = ImageReader::with_format(file, format);
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
    // Telephones store a picture as the sensor lies and say in EXIF which way up it is. Damaged
    // EXIF says nothing.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let mut image = DynamicImage::from_decoder(decoder).map_err(translate)?;
    image.apply_orientation(orientation);
    Ok((picture(image)?, format))
}

/// Kind of a file, by its first bytes.
fn format_of(file: &mut dyn Source) -> Result<ImageFormat, Problem> {
    let mut first = Vec::new();
    (&mut *file).take(FIRST_BYTES).read_to_end(&mut first).map_err(Problem::Io)?;
    file.rewind().map_err(Problem::Io)?;
    if let Some((kind, instead)) = other_kinds::of(&first) {
        return Err(Problem::OtherFormat { kind, instead });
    }
    match image::guess_format(&first) {
        Ok(format) => Ok(format),
        Err(_) if is_tga(&first) => Ok(ImageFormat::Tga),
        Err(_) => Err(Problem::UnknownFormat),
    }
}

/// Tests whether these are the first bytes of a TGA file, which has no signature: palette or none,
/// a kind of picture, bits a pixel. Source: Truevision, TGA file format specification 2.0, field
/// 1–5.
fn is_tga(first: &[u8]) -> bool {
    let [_, palette, kind, .., bits, descriptor] = first.first_chunk::<18>().unwrap_or(&[0; 18]);
    let is_indexed = matches!(kind, 1 | 9);
    let bits_of = if matches!(kind, 3 | 11) { &[8, 16][..] } else { &[8, 15, 16, 24, 32][..] };
    *palette <= 1
        && matches!(kind, 1..=3 | 9..=11)
        && (*palette == 1) >= is_indexed
        && bits_of.contains(bits)
        && descriptor & 0xC0 == 0
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

/// The decoded pixels, as they are stored.
fn picture(image: DynamicImage) -> Result<Picture, Problem> {
    let (width, height) = (image.width(), image.height());
    let samples = match image {
        DynamicImage::ImageLuma8(pixels) => Samples::U8(pixels.into_raw()),
        DynamicImage::ImageLumaA8(pixels) => Samples::U8(pixels.into_raw()),
        DynamicImage::ImageRgb8(pixels) => Samples::U8(pixels.into_raw()),
        DynamicImage::ImageRgba8(pixels) => Samples::U8(pixels.into_raw()),
        DynamicImage::ImageLuma16(pixels) => Samples::U16(pixels.into_raw()),
        DynamicImage::ImageLumaA16(pixels) => Samples::U16(pixels.into_raw()),
        DynamicImage::ImageRgb16(pixels) => Samples::U16(pixels.into_raw()),
        DynamicImage::ImageRgba16(pixels) => Samples::U16(pixels.into_raw()),
        DynamicImage::ImageRgb32F(pixels) => Samples::F32(pixels.into_raw()),
        other => Samples::F32(other.into_rgba32f().into_raw()),
    };
    Picture::new(width, height, samples)
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
