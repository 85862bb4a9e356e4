//! A rectangle of numbers: what every tool of this crate reads and writes.

/// One channel of an image, or a height map: rows from top to bottom, each from left to right.
///
/// Values are 0–1 for images and metres for heights; whoever makes one says which.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Raster {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width · height` values, top row first.
    pub values: Vec<f64>,
}

impl Raster {
    /// A raster of one value.
    #[must_use]
    pub fn constant(width: usize, height: usize, value: f64) -> Self {
        Self { width, height, values: vec![value; width * height] }
    }

    /// A raster whose texel in column x, row y is `value(x, y)`.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, mut value: impl FnMut(usize, usize) -> f64) -> Self {
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                values.push(value(x, y));
            }
        }
        Self { width, height, values }
    }

    /// The value in column x, row y.
    ///
    /// # Panics
    /// Outside the raster.
    #[inline]
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> f64 {
        debug_assert!(x < self.width);
        self.values[y * self.width + x]
    }

    /// Row y.
    ///
    /// # Panics
    /// Outside the raster.
    #[must_use]
    pub fn row(&self, y: usize) -> &[f64] {
        &self.values[y * self.width..(y + 1) * self.width]
    }

    /// The same raster with every value changed.
    #[must_use]
    pub fn map(&self, mut change: impl FnMut(f64) -> f64) -> Self {
        let values = self.values.iter().map(|&v| change(v)).collect();
        Self { width: self.width, height: self.height, values }
    }

    /// Smallest and largest value; (∞, −∞) when there is none.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        self.values.iter().fold(start, |(low, high), &v| (low.min(v), high.max(v)))
    }

    /// Mean value; 0 when there is none.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len().max(1) as f64
    }
}
