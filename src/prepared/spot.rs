//! Where something touches a body.

use crate::model::strike_field::StrikePlace;

/// Where something touches a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    /// A place of its surface, for a body that has shapes.
    pub(crate) place: Option<StrikePlace>,
    /// One of its strike positions, for one that has none.
    pub(crate) position: usize,
}

impl Spot {
    /// Where the body's own amplitudes belong.
    pub(crate) const FIRST: Self = Self { place: None, position: 0 };
}
