//! Refusal: which file or field, what is wrong, what would be right.

use std::fmt::Display;

/// Why something was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{at}: {what}; {right}")]
pub struct PortError {
    /// The field or file.
    pub at: String,
    /// Fault of it.
    pub what: String,
    /// Remedy.
    pub right: String,
}

impl PortError {
    /// From its three parts.
    pub fn new(at: impl Display, what: impl Display, right: impl Display) -> Self {
        let one_line = |text: String| text.split(char::is_control).collect::<Vec<_>>().join(" ");
        Self {
            at: one_line(at.to_string()),
            what: one_line(what.to_string()),
            right: one_line(right.to_string()),
        }
    }

    /// Error inside a file or table.
    #[must_use]
    pub fn within(self, outer: impl Display) -> Self {
        Self { at: format!("{outer}: {}", self.at), ..self }
    }
}

/// A number that must lie in a range.
pub(crate) fn within(at: impl Display, value: f64, [low, high]: [f64; 2]) -> Result<f64, PortError> {
    if value.is_finite() && (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(PortError::new(at, format!("{value} is refused"), format!("must be {low} to {high}")))
    }
}
