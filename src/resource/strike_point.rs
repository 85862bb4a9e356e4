//! Place: the place of a touch on a body.

use crate::model::strike_field::StrikePlace;

/// Place of a touch on a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StrikePoint {
    /// A place of its surface, for a body that has shapes.
    pub(crate) place: Option<StrikePlace>,
    /// One of its strike positions, for one that has none.
    pub(crate) position: usize,
}

impl StrikePoint {
    /// Place that the body's own amplitudes belong to.
    pub(crate) const FIRST: Self = Self { place: None, position: 0 };
}
