//! A number that is refused: its field, itself, and what would be right.

use asperity_dsp::limits::Range;

/// A number that nothing real can have.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{field}: {value} is refused; must be {expected}")]
pub struct BadValue {
    /// Its field, with its unit.
    pub field: &'static str,
    /// Its value.
    pub value: f64,
    /// What would be accepted.
    pub expected: &'static str,
}

/// The value of a field, if the list of limits accepts it.
pub(crate) fn within(field: &'static str, value: f64, range: Range) -> Result<f64, BadValue> {
    if range.holds(value) { Ok(value) } else { Err(BadValue { field, value, expected: range.words }) }
}
