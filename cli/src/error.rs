//! The one line a user gets when something is wrong.

use std::fmt;
use std::path::Path;

/// `error: WHERE: WHAT; RIGHT`: which file or field, what is wrong, what would be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CliError {
    at: String,
    what: String,
    right: String,
}

impl CliError {
    /// An error at a file, a field or an option.
    pub fn new(at: impl fmt::Display, what: impl fmt::Display, right: impl fmt::Display) -> Self {
        Self { at: at.to_string(), what: what.to_string(), right: right.to_string() }
    }

    /// An error at a file.
    pub fn file(path: &Path, what: impl fmt::Display, right: impl fmt::Display) -> Self {
        Self::new(path.display(), what, right)
    }

    /// An error that another crate has put into words: `WHERE: WHAT; RIGHT`, or as much of it as it says.
    pub fn told(text: impl fmt::Display) -> Self {
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

    /// A file that could not be read.
    pub fn read(path: &Path, error: &std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::NotFound => Self::file(path, "no such file", "name a file that exists"),
            std::io::ErrorKind::IsADirectory => Self::file(path, "is a folder", "name a file"),
            std::io::ErrorKind::InvalidData => {
                Self::file(path, "is not UTF-8 text", "save it as UTF-8, or name another file")
            }
            _ => Self::file(path, format!("cannot be read ({error})"), "name a readable file"),
        }
    }

    /// A file that could not be written.
    pub fn write(path: &Path, error: &std::io::Error) -> Self {
        let right = "choose a folder that can be written and has room";
        Self::file(path, format!("cannot be written ({error})"), right)
    }

    /// A panic, which is a defect of the program and says so.
    pub fn defect(payload: &(dyn std::any::Any + Send)) -> Self {
        let text = payload
            .downcast_ref::<&str>()
            .map(ToString::to_string)
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "no message".to_owned());
        Self::new("asperity", format!("a defect of the program ({text})"), "please report it with the input")
    }
}

impl fmt::Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = format!("error: {}: {}; {}", self.at, self.what, self.right);
        // Names come from outside and may hold line breaks or terminal codes; the report is one line.
        f.write_str(
            &line.split(char::is_control).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" "),
        )
    }
}

impl std::error::Error for CliError {}

/// One line for a refusal of the command line, where clap writes a paragraph.
pub fn usage_line(refusal: &clap::Error) -> String {
    let text = refusal.to_string();
    let lines: Vec<&str> = text
        .lines()
        .map(str::trim)
        .take_while(|line| !line.starts_with("Usage:"))
        .filter(|line| !line.is_empty() && !line.starts_with("For more information"))
        .collect();
    let what = match refusal.kind() {
        clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand
        | clap::error::ErrorKind::MissingSubcommand => "VERB: none is given".to_owned(),
        _ => lines.join(" ").trim_start_matches("error: ").to_owned(),
    };
    let what: String = what.split(char::is_control).collect::<Vec<_>>().join(" ");
    format!("error: {what}; `asperity --help` and `asperity VERB --help` say what is accepted")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_one_line_whatever_the_names_in_it() {
        let line = CliError::new("a\nb\x1b[31m", "is\r\nwrong", "do this").to_string();
        assert_eq!(line, "error: a b [31m: is wrong; do this");
    }

    #[test]
    fn errors_of_other_crates_keep_their_words() {
        let line = CliError::told("gain: 3 is refused; must be 0 to 1").within("audio").to_string();
        assert_eq!(line, "error: audio: gain: 3 is refused; must be 0 to 1");
        assert_eq!(CliError::told("broken").to_string(), "error: asperity: broken; see `asperity --help`");
    }

    #[test]
    fn an_outer_place_is_written_first() {
        let line = CliError::new("width_m", "-1 is refused", "must be above 0").within("scene.toml");
        assert_eq!(line.to_string(), "error: scene.toml: width_m: -1 is refused; must be above 0");
    }
}
