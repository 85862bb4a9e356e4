//! A rectangle of numbers: what every tool of this crate reads and writes.

/// One channel of an image, or a height map: rows from top to bottom, each from left to right.
///
/// Values are 0–1 for images and metres for heights; the maker of one says which.
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

    /// Raster with every value changed.
    #[must_use]
    pub fn map(&self, mut change: impl FnMut(f64) -> f64) -> Self {
        let values = self.values.iter().map(|&v| change(v)).collect();
        Self { width: self.width, height: self.height, values }
    }

    /// Divisor of the sides of `width` × `height` texels with which at most `most_texels` are
    /// left.
    #[must_use]
    pub fn reduction(width: usize, height: usize, most_texels: usize) -> usize {
        (1..=width.min(height)).find(|n| (width / n) * (height / n) <= most_texels).unwrap_or(1)
    }

    /// Rows become columns.
    #[must_use]
    pub fn transposed(&self) -> Self {
        const BLOCK: usize = 16; // texels: a block of both rasters stays in the first cache
        let (width, height) = (self.width, self.height);
        let mut values = vec![0.0; width * height];
        for top in (0..height).step_by(BLOCK) {
            for left in (0..width).step_by(BLOCK) {
                for y in top..(top + BLOCK).min(height) {
                    for x in left..(left + BLOCK).min(width) {
                        values[x * height + y] = self.values[y * width + x];
                    }
                }
            }
        }
        Self { width: height, height: width, values }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_become_columns() {
        let picture = Raster::from_fn(37, 21, |x, y| (100 * x + y) as f64);
        let turned = picture.transposed();
        assert!((turned.width, turned.height) == (21, 37) && turned.at(20, 5) == picture.at(5, 20));
        assert_eq!(turned.transposed(), picture);
    }
}
