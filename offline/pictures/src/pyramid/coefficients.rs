//! The sub-bands of one image, to be read and edited.

/// The sub-bands of one image in the order of [`super::Pyramid::subbands`]; empty by default, to be
/// filled by [`super::Pyramid::split_into`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coefficients {
    /// One sub-band after the other: in one piece, allocators keep the memory from one image to the
    /// next.
    pub(super) values: Vec<f64>,
    /// Ends of the sub-bands.
    pub(super) ends: Vec<usize>,
}

impl Coefficients {
    /// Number of sub-bands.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Tests whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The values of one sub-band, row by row.
    ///
    /// # Panics
    /// When there is no such sub-band.
    #[must_use]
    pub fn get(&self, index: usize) -> &[f64] {
        &self.values[self.range(index)]
    }

    /// The values of one sub-band, to be edited.
    ///
    /// # Panics
    /// When there is no such sub-band.
    pub fn get_mut(&mut self, index: usize) -> &mut [f64] {
        let range = self.range(index);
        &mut self.values[range]
    }

    /// Replaces the values of one sub-band.
    ///
    /// # Panics
    /// When there is no such sub-band or `values` is not as long as it.
    pub fn set(&mut self, index: usize, values: &[f64]) {
        self.get_mut(index).copy_from_slice(values);
    }

    fn range(&self, index: usize) -> std::ops::Range<usize> {
        let start = if index == 0 { 0 } else { self.ends[index - 1] };
        start..self.ends[index]
    }
}
