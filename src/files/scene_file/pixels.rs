//! A picture that a scene names, and the channel of it that is meant.

use super::fields::Fields;
use crate::files::FileError;
pub use crate::files::storage::Pixels;
use asperity_texture::picture::Channel;

/// `r`, `g`, `b`, `a` or `luma`.
pub fn read_channel(fields: &mut Fields, key: &'static str) -> Result<Channel, FileError> {
    use Channel::{A, B, G, Luma, R};
    Ok(fields.word(key, &[("r", R), ("g", G), ("b", B), ("a", A), ("luma", Luma)])?.unwrap_or_default())
}
