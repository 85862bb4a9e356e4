//! Errors of a TOML file that is read by types: line and key, what is wrong, what would be right.

use super::nearest::decimal_comma;
use super::{FileError, nearest};

impl FileError {
    /// An error of the TOML reader: the line and the key, and the key that was meant where one is
    /// misspelt. `right` is what would be right where nothing nearer is known.
    pub fn toml(text: &str, error: &toml::de::Error, right: &str) -> Self {
        let message = error.message().replace('\n', " ");
        let message = message.replace("u64", "a whole number from 0 on").replace("f64", "a number");
        let words: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
        if let (true, [unknown, known @ ..]) = (message.starts_with("unknown field"), words.as_slice()) {
            let meant = nearest(unknown, known).map_or_else(String::new, |meant| format!("write {meant}; "));
            let right = format!("{meant}accepted here: {}", known.join(", "));
            return Self::new(unknown, "unknown key", right).at_line_in(text);
        }
        if let (true, [missing]) = (message.starts_with("missing field"), words.as_slice()) {
            return Self::new(missing, "is missing", right);
        }
        let start = error.span().map_or(0, |span| span.start.min(text.len()));
        let line = 1 + text[..start].matches('\n').count();
        let written = text.lines().nth(line - 1).unwrap_or_default();
        let meant = decimal_comma(written).map(|number| format!("write {number}"));
        let right = meant.as_deref().unwrap_or(right);
        match written.split_once('=') {
            Some((key, _)) => Self::new(format!("line {line}: {}", key.trim()), message, right),
            None => Self::new(format!("line {line}"), message, right),
        }
    }

    /// The error with the line of `text` in which its key is set; as it is where none or several
    /// lines set that key.
    #[must_use]
    pub fn at_line_in(self, text: &str) -> Self {
        let key = self.at().rsplit(['.', ' ']).next().unwrap_or_default().to_owned();
        let sets = |line: &str| {
            let after = |rest: &str| rest.trim_start().starts_with('=');
            line.match_indices(&*key).any(|(place, _)| {
                let alone = line[..place].chars().next_back().is_none_or(|c| " {,.\t".contains(c));
                alone && after(&line[place + key.len()..])
            })
        };
        let mut lines = text.lines().enumerate().filter(|(_, line)| !key.is_empty() && sets(line));
        match (lines.next(), lines.next()) {
            (Some((index, _)), None) => self.within(format!("line {}", index + 1)),
            _ => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Profile {
        #[serde(rename = "band_hz")]
        _band_hz: [f64; 2],
        #[serde(rename = "label")]
        _label: String,
    }

    #[test]
    fn a_slip_in_a_profile_names_line_key_and_remedy() {
        for (text, line_of) in [
            (
                "label = \"x\"\nbnad_hz = [1, 2]",
                "line 2: bnad_hz: unknown key; write band_hz; accepted here: band_hz, label",
            ),
            ("label = \"x\"", "band_hz: is missing; must be a profile"),
            (
                "band_hz = [1, 2]\nlabel = 3",
                "line 2: label: invalid type: integer `3`, expected a string; must be a profile",
            ),
            ("label = \"x\"\nband_hz = [1", "line 2: band_hz: "),
            ("label = 0,5\n", "line 1: label: unexpected key or value, expected newline, `#`; write 0.5"),
        ] {
            let error = toml::from_str::<Profile>(text).unwrap_err();
            let line = FileError::toml(text, &error, "must be a profile").to_string();
            assert!(line.starts_with(line_of), "{line}\nis not\n{line_of}");
        }
    }
}
