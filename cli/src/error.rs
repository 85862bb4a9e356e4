//! The one line a user gets when something is wrong.

use asperity::files::FileError;
use std::fmt;
use std::path::Path;

/// `error: WHERE: WHAT; RIGHT`: which file or field, what is wrong, what would be right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CliError(FileError);

impl From<FileError> for CliError {
    fn from(error: FileError) -> Self {
        Self(error)
    }
}

impl CliError {
    /// Message, without the word that begins the program's last line.
    #[cfg(any(feature = "device", test))]
    pub fn without_prefix(&self) -> &FileError {
        &self.0
    }

    /// An error at a file, a field or an option.
    pub fn new(at: impl fmt::Display, what: impl fmt::Display, right: impl fmt::Display) -> Self {
        Self(FileError::new(at, what, right))
    }

    /// An error at a file.
    pub fn file(path: &Path, what: impl fmt::Display, right: impl fmt::Display) -> Self {
        Self(FileError::file(path, what, right))
    }

    /// An error that another crate has put into words: `WHERE: WHAT; RIGHT`, or as much of it as it
    /// says.
    pub fn from_error(text: impl fmt::Display) -> Self {
        Self(FileError::from_error(text))
    }

    /// Puts an error of a field into its file or table: `WHERE: ` is written before what it names.
    #[must_use]
    pub fn within(self, outer: impl fmt::Display) -> Self {
        Self(self.0.within(outer))
    }

    /// A file that could not be read.
    pub fn read(path: &Path, error: &std::io::Error) -> Self {
        Self(FileError::read(path, error))
    }

    /// A file that could not be written.
    pub fn write(path: &Path, error: &std::io::Error) -> Self {
        Self(FileError::write(path, error))
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
        write!(f, "error: {}", self.0)
    }
}

impl std::error::Error for CliError {}

/// Refusals of the number parsers of the standard library, and what would be right.
const NUMBERS: [(&str, &str); 5] = [
    ("invalid digit found in string", "must be a whole number from 0 on"),
    ("cannot parse integer from empty string", "must be a whole number from 0 on"),
    ("number too large to fit in target type", "must be a smaller number"),
    ("invalid float literal", "must be a number"),
    ("cannot parse float from empty string", "must be a number"),
];

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
        _ => lines.join(" ").trim_start_matches("error: ").replace(" tip:", "; tip:"),
    };
    let what: String = what.split(char::is_control).collect::<Vec<_>>().join(" ");
    let what = NUMBERS.iter().fold(what, |what, (refused, right)| what.replace(refused, right));
    format!("error: {what}; `asperity --help` and `asperity VERB --help` say what is accepted")
}
