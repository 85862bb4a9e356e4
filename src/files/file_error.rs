//! A refused file: one line that names the place, what is wrong there, and what would be right.

use std::fmt;
use std::path::Path;

/// `WHERE: WHAT; RIGHT`: which file or field, what is wrong, what would be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileError {
    at: String,
    what: String,
    right: String,
}

impl FileError {
    /// An error at a file, a field or an option.
    pub fn new(at: impl fmt::Display, what: impl fmt::Display, right: impl fmt::Display) -> Self {
        Self { at: at.to_string(), what: what.to_string(), right: right.to_string() }
    }

    /// The file, field or option that it names.
    #[must_use]
    pub fn at(&self) -> &str {
        &self.at
    }

    /// An error at a file.
    pub fn file(path: &Path, what: impl fmt::Display, right: impl fmt::Display) -> Self {
        Self::new(path.display(), what, right)
    }

    /// An error that another type has put into words: `WHERE: WHAT; RIGHT`, or as much of it as it
    /// says.
    pub fn from_error(text: impl fmt::Display) -> Self {
        let text = text.to_string();
        let (front, right) = text.rsplit_once("; ").unwrap_or((&text, "see `asperity --help`"));
        let (at, what) = front.split_once(": ").unwrap_or(("asperity", front));
        Self::new(at, what, right)
    }

    /// Puts an error of a field into its file or table: `WHERE: ` is written before what it names.
    #[must_use]
    pub fn within(mut self, outer: impl fmt::Display) -> Self {
        self.at = format!("{outer}: {}", self.at);
        self
    }

    /// Takes off an outer place that [`within`](Self::within) has written before what it names.
    #[must_use]
    pub fn out_of(mut self, outer: impl fmt::Display) -> Self {
        if let Some(inner) = self.at.strip_prefix(&format!("{outer}: ")) {
            self.at = inner.to_owned();
        }
        self
    }

    /// A file that could not be read.
    pub fn read(path: &Path, error: &std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::NotFound => Self::file(path, "no such file", "name a file that exists"),
            std::io::ErrorKind::IsADirectory => Self::file(path, "is a folder", "name a file"),
            std::io::ErrorKind::InvalidData => {
                Self::file(path, "is not UTF-8 text", "save it as UTF-8, or name another file")
            }
            std::io::ErrorKind::FileTooLarge => {
                Self::file(path, "is longer than a gigabyte", "name a shorter file")
            }
            _ => Self::file(path, format!("cannot be read ({error})"), "name a readable file"),
        }
    }

    /// A file that could not be written.
    pub fn write(path: &Path, error: &std::io::Error) -> Self {
        let right = "choose a folder that can be written and has room";
        Self::file(path, format!("cannot be written ({error})"), right)
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = format!("{}: {}; {}", self.at, self.what, self.right);
        // Names come from outside and may hold line breaks or terminal codes; the report is one
        // line.
        f.write_str(
            &line.split(char::is_control).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" "),
        )
    }
}

impl std::error::Error for FileError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_whatever_the_names_in_it() {
        let line = FileError::new("a\nb\x1b[31m", "is\r\nwrong", "do this").to_string();
        assert_eq!(line, "a b [31m: is wrong; do this");
    }

    #[test]
    fn errors_of_other_types_keep_their_words() {
        let line = FileError::from_error("gain: 3 is refused; must be 0 to 1").within("audio").to_string();
        assert_eq!(line, "audio: gain: 3 is refused; must be 0 to 1");
        assert_eq!(FileError::from_error("broken").to_string(), "asperity: broken; see `asperity --help`");
    }

    #[test]
    fn an_outer_place_is_written_first() {
        let line = FileError::new("width_m", "-1 is refused", "must be above 0").within("scene.toml");
        assert_eq!(line.to_string(), "scene.toml: width_m: -1 is refused; must be above 0");
    }
}
