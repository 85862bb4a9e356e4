//! Interval of accepted values, with the words by which an error names it.

use crate::DesignError;

/// From where to where a number may lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Smallest …
    pub low: f64,
    /// … and largest value.
    pub high: f64,
    /// True where `low` itself is refused.
    pub above: bool,
    /// Range as the end of the sentence "must be …".
    pub words: &'static str,
}

impl Range {
    /// From `low` to `high`, both included.
    #[must_use]
    pub const fn new(low: f64, high: f64, words: &'static str) -> Self {
        Self { low, high, above: false, words }
    }

    /// Above `low`, to `high`.
    #[must_use]
    pub const fn above(low: f64, high: f64, words: &'static str) -> Self {
        Self { low, high, above: true, words }
    }

    /// Tests whether a value is accepted; nothing that is not finite is.
    #[must_use]
    pub const fn holds(&self, value: f64) -> bool {
        value.is_finite()
            && value <= self.high
            && if self.above { value > self.low } else { value >= self.low }
    }

    /// The value of a field, if it is accepted.
    ///
    /// # Errors
    /// Names the field and what it must be.
    pub fn check(&self, field: &'static str, value: f64) -> Result<f64, DesignError> {
        DesignError::check(field, value, self.words, |value| self.holds(value))
    }
}
