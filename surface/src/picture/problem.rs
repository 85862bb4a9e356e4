//! Faults of map files: which file, what is wrong, what would be right.

use super::{MAX_FILE_BYTES, MAX_SIDE, MAX_TEXELS};
use std::path::PathBuf;

/// Why a map could not be read or written: which file, what is wrong, what would be right.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", .file.display())]
pub struct ImageError {
    /// The file.
    pub file: PathBuf,
    /// Fault of it.
    pub problem: Problem,
}

/// Fault of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The system could not open, read or write it.
    #[error("{0}; a readable file (or a writable folder for output) is needed")]
    Io(std::io::Error),
    /// Its first bytes are of no picture format we read.
    #[error("not a picture this program reads; PNG, JPEG, PGM, GIF{}{} are read",
        if cfg!(feature = "more-pictures") { ", WebP, TIFF, TGA, BMP" } else { "" },
        if cfg!(feature = "exr") { " and EXR" } else { " (and EXR with the feature `exr`)" })]
    UnknownFormat,
    /// Its first bytes are of another format that we know by name.
    #[error("is {kind}, which is not read; {instead}")]
    OtherFormat {
        /// The format.
        kind: &'static str,
        /// Way to a picture that is read.
        instead: &'static str,
    },
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
    /// The picture is still a file.
    #[error(
        "is not decoded, and this build decodes no file; build it with the feature `image`, or hand the picture over decoded"
    )]
    NotDecoded,
    /// Decoding would take more memory than we grant.
    #[error(
        "asks for more memory than is granted; at most {MAX_SIDE} texels a side and {MAX_TEXELS} in all are read"
    )]
    TooMuchMemory,
    /// The file itself is too long.
    #[error("{0} bytes are too many; at most {MAX_FILE_BYTES} are read")]
    TooLong(u64),
    /// Several layers, none of which is the picture.
    #[error("has several layers ({0}); save the one that is the map as a picture of its own")]
    Layers(String),
    /// The channel asked for is not in the picture.
    #[error("has no alpha channel; choose `luma`, `r`, `g` or `b`, or a picture with alpha")]
    NoAlpha,
    /// Its channels are not of 8 bits, or too few.
    #[error(
        "has no red, green and blue of 8 bits, which `rg` and `rgb` put together; choose `luma`, `r`, `g`, `b` or `a`"
    )]
    NotPacked,
    /// Samples that do not fill the pixels.
    #[error("{count} samples do not fill {width} × {height} pixels; one to four a pixel are needed")]
    Samples {
        /// Number that there is.
        count: usize,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// A value is not a number.
    #[error("the value at column {x}, row {y} is not finite; only finite values make a map")]
    NotFinite {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
    /// Its pixels are directions.
    #[error(
        "is a normal map, not a map of heights; make heights of it (`asperity texture from-normals`), or name the channel that is meant"
    )]
    IsNormalMap,
    /// There is nothing in it.
    #[error("has no texels; at least 1 × 1 is needed")]
    Empty,
}
