//! The sub-bands of one image, to be read and edited.

use rustfft::num_complex::Complex64;

/// The sub-bands of one image, two real ones to a complex array; see [`Coefficients::get`].
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficients {
    pub(super) pairs: Vec<Vec<Complex64>>,
    /// Pair and half (0 = real, 1 = imaginary) of each sub-band.
    pub(super) places: Vec<(usize, usize)>,
}

impl Coefficients {
    /// Number of sub-bands.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The values of one sub-band, row by row, in the order of [`super::Pyramid::subbands`].
    ///
    /// # Panics
    /// When there is no such sub-band.
    #[must_use]
    pub fn get(&self, index: usize) -> Vec<f64> {
        let (pair, half) = self.places[index];
        self.pairs[pair].iter().map(|v| if half == 0 { v.re } else { v.im }).collect()
    }

    /// Replaces the values of one sub-band.
    ///
    /// # Panics
    /// When there is no such sub-band or `values` is not as long as it.
    pub fn set(&mut self, index: usize, values: &[f64]) {
        let (pair, half) = self.places[index];
        assert_eq!(values.len(), self.pairs[pair].len(), "a sub-band keeps its size");
        for (place, &value) in self.pairs[pair].iter_mut().zip(values) {
            *(if half == 0 { &mut place.re } else { &mut place.im }) = value;
        }
    }
}
