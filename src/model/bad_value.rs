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
    /// Accepted values.
    pub expected: &'static str,
}

/// The value of a field, if the list of limits accepts it.
pub(crate) fn within(field: &'static str, value: f64, range: Range) -> Result<f64, BadValue> {
    if range.holds(value) { Ok(value) } else { Err(BadValue { field, value, expected: range.words }) }
}

/// A magnitude of a report: beyond its range it is held at the limit, and `held` says so. What is
/// not finite is refused, and so is a negative one where none can be.
///
/// # Errors
/// Names the field and what it must be.
pub(crate) fn held(field: &'static str, value: f64, range: Range, held: &mut bool) -> Result<f64, BadValue> {
    let beyond = value.is_finite() && (value > range.high || (value < range.low && range.low < 0.0));
    *held |= beyond;
    if beyond { Ok(value.clamp(range.low, range.high)) } else { within(field, value, range) }
}
