//! Image: a picture as a game engine has it in memory.

use crate::entry::array;
use crate::status::{ASP_BAD_ARGUMENT, Failure};
use asperity::surface::picture::{MAX_SIDE, MAX_TEXELS, Picture, Samples};
use std::ffi::c_void;

/// Samples are 0 to 255.
pub const ASP_U8: u32 = 0;
/// Samples are 0 to 65535.
pub const ASP_U16: u32 = 1;
/// Samples are floating point, taken as they are.
pub const ASP_F32: u32 = 2;

/// A decoded picture: rows from the top, samples of a pixel beside each other. All zero = none.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct asp_image {
    /// First sample of the first row; aligned as its samples are.
    pub samples: *const c_void,
    /// From one row to the next, bytes; 0 = rows without gaps.
    pub stride_bytes: u64,
    /// Pixels a row, up to 32768.
    pub width: u32,
    /// Rows, up to 32768; up to 2²⁶ pixels in all.
    pub height: u32,
    /// ASP_U8, ASP_U16 or ASP_F32.
    pub format: u32,
    /// 1 grey, 2 grey and alpha, 3 red, green and blue, 4 the same and alpha.
    pub channels: u32,
}

/// No picture.
pub(crate) const NONE: asp_image = asp_image {
    samples: std::ptr::null(),
    stride_bytes: 0,
    width: 0,
    height: 0,
    format: ASP_U8,
    channels: 1,
};

fn refuse(name: &str, what: impl std::fmt::Display, right: &str) -> Failure {
    Failure::new(ASP_BAD_ARGUMENT, format!("{name}: {what}; {right}"))
}

/// Copies a picture.
pub(crate) fn picture(image: &asp_image, name: &str) -> Result<Picture, Failure> {
    let asp_image { width, height, channels, .. } = *image;
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
        return Err(refuse(name, format!("{width} × {height} pixels are refused"), "a side has 1 to 32768"));
    }
    if u64::from(width) * u64::from(height) > MAX_TEXELS {
        return Err(refuse(name, format!("{width} × {height} pixels are refused"), "at most 2^26 in all"));
    }
    if !(1..=4).contains(&channels) {
        return Err(refuse(name, format!("channels: {channels} is refused"), "must be 1 to 4"));
    }
    let samples = match image.format {
        ASP_U8 => Samples::U8(rows(image, name)?),
        ASP_U16 => Samples::U16(rows(image, name)?),
        ASP_F32 => Samples::F32(rows(image, name)?),
        other => {
            let right = "must be ASP_U8, ASP_U16 or ASP_F32";
            return Err(refuse(name, format!("format: {other} is refused"), right));
        }
    };
    Picture::new(width, height, samples).map_err(|problem| refuse(name, problem, "give another picture"))
}

fn rows<T: Copy>(image: &asp_image, name: &str) -> Result<Vec<T>, Failure> {
    let (width, height) = ((image.width * image.channels) as usize, image.height as usize);
    let row_bytes = width * size_of::<T>();
    let stride = match image.stride_bytes {
        0 => row_bytes,
        stride => {
            usize::try_from(stride).ok().filter(|s| *s >= row_bytes && *s < 1 << 24).ok_or_else(|| {
                let right = format!("must be 0, or {row_bytes} and more, below 2^24");
                refuse(name, format!("stride_bytes: {stride} is refused"), &right)
            })?
        }
    };
    if stride % align_of::<T>() != 0 {
        let right = format!("must be a multiple of {}", align_of::<T>());
        return Err(refuse(name, format!("stride_bytes: {stride} is refused"), &right));
    }
    let mut samples = Vec::with_capacity(width * height);
    for row in 0..height {
        let first = image.samples.cast::<u8>().wrapping_add(row * stride).cast::<T>();
        samples.extend_from_slice(array(first, width, usize::MAX, name)?);
    }
    Ok(samples)
}
