//! Errors that say where, what is wrong and what would be right.

/// `WHERE: WHAT; RIGHT` in one line.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{at}: {what}; {right}")]
pub struct ShapeError {
    /// Which file, line or field.
    pub at: String,
    /// Fault of it.
    pub what: String,
    /// Accepted values.
    pub right: String,
}

impl ShapeError {
    /// An error at a place.
    pub fn new(at: impl Into<String>, what: impl Into<String>, right: impl Into<String>) -> Self {
        Self { at: at.into(), what: what.into(), right: right.into() }
    }

    /// Error of a body that was mended before: the mending may be its cause.
    #[must_use]
    pub(crate) fn after(mut self, mended: &str) -> Self {
        if !mended.is_empty() {
            self.what = format!("{} (after: {mended})", self.what);
        }
        self
    }

    /// Error inside a file: its path comes first.
    #[must_use]
    pub fn within(mut self, outer: &str) -> Self {
        self.at = if self.at.is_empty() { outer.to_owned() } else { format!("{outer}: {}", self.at) };
        self
    }
}
