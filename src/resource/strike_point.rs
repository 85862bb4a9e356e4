//! Place: the place of a touch on a body.

use crate::model::strike_field::StrikePlace;

/// Place of a touch on a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StrikePoint {
    /// A place of its surface, for a body that has shapes.
    pub(crate) place: Option<StrikePlace>,
    /// One of its strike positions, for one that has none.
    pub(crate) position: usize,
    /// Another of these, and its share of the strike.
    pub(crate) other: (usize, f32),
    /// Seed of the bands of noise that a silent body wakes with; 0 = its own.
    pub(crate) seed: u32,
}

impl StrikePoint {
    /// Place that the body's own amplitudes belong to.
    pub(crate) const FIRST: Self = Self::new(None, 0);

    pub(crate) const fn new(place: Option<StrikePlace>, position: usize) -> Self {
        Self { place, position, other: (0, 0.0), seed: 0 }
    }

    /// Strike positions of a body, and the share of the strike at each; a position that it does not
    /// have counts as its last.
    pub(crate) fn shares(&self, positions: usize) -> impl Iterator<Item = (usize, f64)> + use<> {
        let (other, share) = (self.other.0, f64::from(self.other.1));
        [(self.position.min(positions - 1), 1.0 - share), (other, share)]
            .into_iter()
            .filter(|(_, share)| *share != 0.0)
    }
}
