//! A number that is refused: its field, itself, and what would be right.

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

/// `value`, if it lies from `low` to `high`.
pub(crate) fn within(
    field: &'static str,
    value: f64,
    expected: &'static str,
    low: f64,
    high: f64,
) -> Result<f64, BadValue> {
    if value >= low && value <= high { Ok(value) } else { Err(BadValue { field, value, expected }) }
}
