//! The set of occupied places, in order, so that the empty ones cost nothing.

/// Ascending numbers of the places in use. All memory is made at the start.
pub(crate) struct IndexSet(Vec<usize>);

impl IndexSet {
    /// None of `capacity` places.
    pub(crate) fn new(capacity: usize) -> Self {
        Self(Vec::with_capacity(capacity))
    }

    /// Notes that a place is in use.
    pub(crate) fn insert(&mut self, place: usize) {
        if let Err(at) = self.0.binary_search(&place) {
            // Never more places than there is memory for: every place is noted once.
            self.0.insert(at, place);
        }
    }

    /// Drops the places for which `in_use` is false.
    pub(crate) fn retain(&mut self, mut in_use: impl FnMut(usize) -> bool) {
        self.0.retain(|place| in_use(*place));
    }

    /// Number of them.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// The place in use with this rank, below [`len`](Self::len).
    pub(crate) fn at(&self, rank: usize) -> usize {
        self.0[rank]
    }

    /// The places in use, in ascending order whatever happened before.
    pub(crate) fn iter(&self) -> impl Iterator<Item = usize> + '_ {
        self.0.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_listed_once_and_in_order() {
        let mut used = IndexSet::new(8);
        for place in [5, 2, 7, 2, 0, 5] {
            used.insert(place);
        }
        assert_eq!(used.iter().collect::<Vec<_>>(), [0, 2, 5, 7]);
        used.retain(|place| place != 2);
        assert_eq!((used.len(), used.at(1)), (3, 5));
    }
}
