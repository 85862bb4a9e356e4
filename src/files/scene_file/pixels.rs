//! A picture that a scene names, and the channel of it that is meant.

use super::fields::Fields;
use crate::files::FileError;
pub use crate::files::storage::Pixels;
use asperity_surface::picture::Channel;

/// One of [`Channel::ALL`].
pub fn read_channel(fields: &mut Fields, key: &'static str) -> Result<Channel, FileError> {
    Ok(fields.word(key, &Channel::ALL)?.unwrap_or_default())
}
