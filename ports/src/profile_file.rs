//! Profile file: what a device plays, as a file says it.

use crate::acf;
use crate::device::Device;
use crate::error::PortError;

impl Device {
    /// A profile from TOML, or an actuator configuration (ACF) from JSON with comments.
    ///
    /// # Errors
    /// When it is neither, or a number is one that no device has.
    pub fn parse(text: &str) -> Result<Self, PortError> {
        let plain = acf::without_comments(text);
        if plain.trim_start().starts_with('{') { acf::device(&plain) } else { Self::from_toml(text) }
    }
}
