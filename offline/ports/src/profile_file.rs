//! Profile file: what a device plays, as a file says it.

use crate::acf;
use crate::device::Device;
use crate::error::PortError;

impl Device {
    /// A profile from TOML, or an actuator configuration (ACF) from JSON with comments.
    ///
    /// # Errors
    /// When it is neither, or a number is one that no device has; the message names line and key
    /// where the file's writer can be shown them.
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

/// An error of the TOML reader: line and key, what is wrong, what would be right.
pub(crate) fn refused(text: &str, error: &toml::de::Error) -> PortError {
    let right = "a profile is TOML with label, band_hz, pcm_rate_hz, points_per_s, [emphasis] and [source]";
    let message = error.message();
    let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let line = error.span().map_or(1, |span| 1 + text[..span.start.min(text.len())].matches('\n').count());
    let key =
        text.lines().nth(line - 1).and_then(|written| written.split_once('=')).map(|(key, _)| key.trim());
    let at = |key: &str| format!("line {line}: {key}");
    match words.as_slice() {
        [unknown, known @ ..] if message.starts_with("unknown field") => {
            let right = format!("accepted here: {}", known.join(", "));
            PortError::new(at(unknown), "unknown key", right)
        }
        [missing] if message.starts_with("missing field") => PortError::new(missing, "is missing", right),
        _ => PortError::new(key.map_or_else(|| format!("line {line}"), at), message, right),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_in_a_profile_names_its_line_and_its_key() {
        let text = include_str!("../devices/quest.toml");
        for (from, to, remarks) in [
            ("band_hz = [", "bnad_hz = [", "bnad_hz: unknown key; accepted here: label, band_hz"),
            ("pcm_rate_hz = 2000.0", "pcm_rate_hz = \"2000\"", "pcm_rate_hz: invalid type"),
            ("ducking =", "ducking", "line "),
            ("[source]", "[sources]", "sources: unknown key"),
        ] {
            let refused = Device::parse(&text.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(refused.starts_with("line ") && refused.contains(remarks), "{refused}");
        }
        let refused = Device::parse("label = \"x\"").unwrap_err().to_string();
        assert!(refused.starts_with("band_hz: is missing; "), "{refused}");
    }
}
