//! A picture that a scene names, and the channel of it that is meant.

use super::fields::Fields;
use crate::files::FileError;
use std::path::PathBuf;

/// A channel of an image file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pixels {
    /// Image file.
    pub path: PathBuf,
    /// `r`, `g`, `b`, `a` or `luma`; none = what the image suggests.
    pub channel: Option<char>,
}

/// `r`, `g`, `b`, `a` or `luma`.
pub fn read_channel(fields: &mut Fields, key: &'static str) -> Result<Option<char>, FileError> {
    fields.word(key, &[("r", 'r'), ("g", 'g'), ("b", 'b'), ("a", 'a'), ("luma", 'l')])
}
