//! The one way a kernel's design can fail: a parameter outside its range.

use core::fmt;

/// A parameter that a kernel cannot be designed with: which field, its value, what would be right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesignError {
    /// Name of the offending field, with its unit (`cutoff_hz`).
    pub field: &'static str,
    /// The value that was refused.
    pub value: f64,
    /// Accepted values, as the end of the sentence "must be …".
    pub expected: &'static str,
}

impl DesignError {
    /// `Ok(value)` when it is finite and `accept` holds, otherwise the error that names the field.
    pub fn check(
        field: &'static str,
        value: f64,
        expected: &'static str,
        accept: impl Fn(f64) -> bool,
    ) -> Result<f64, Self> {
        if value.is_finite() && accept(value) { Ok(value) } else { Err(Self { field, value, expected }) }
    }
}

impl fmt::Display for DesignError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} is refused; must be {}", self.field, self.value, self.expected)
    }
}

impl core::error::Error for DesignError {}
