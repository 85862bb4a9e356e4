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
        // TOML begins with a name, a table or a hash; JSON5 with a brace or a comment.
        let begins = text.trim_start_matches('\u{feff}').trim_start();
        if begins.starts_with('{') || begins.starts_with('/') {
            acf::device(text)
        } else {
            Self::from_toml(text)
        }
    }
}
