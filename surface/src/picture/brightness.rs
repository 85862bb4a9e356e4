//! The brightness of a large picture: means of n × n pixels, without all of it as numbers first.

use super::{Channel, Picture, Problem, Samples};
use crate::raster::Raster;

impl Picture {
    /// Means of the brightness ([`Channel::Luma`]) of `n` × `n` pixels, at least 1, as 0–1; what
    /// does not fill one at the right and lower border is left out. To the bit the means of
    /// [`Picture::channel`]: a program that reads all of a picture first finds the same surface.
    ///
    /// # Errors
    /// When a value is not finite.
    pub fn brightness(&self, n: usize) -> Result<Raster, Problem> {
        let raster = match &self.samples {
            Samples::U8(samples) => self.means(samples, 255.0, n),
            Samples::U16(samples) => self.means(samples, 65_535.0, n),
            Samples::F32(samples) => {
                // Says where a value is not finite.
                if samples.iter().any(|v| !v.is_finite()) {
                    self.channel(Channel::Luma)?;
                }
                self.means(samples, 1.0, n)
            }
        };
        Ok(raster)
    }

    fn means<T: Copy + Into<f64>>(&self, samples: &[T], white: f64, n: usize) -> Raster {
        match self.channels {
            1 | 2 => self.means_by(samples, white, n, |pixel| pixel[0].into()),
            _ => self.means_by(samples, white, n, |pixel| {
                self.luma.of(pixel[0].into(), pixel[1].into(), pixel[2].into())
            }),
        }
    }

    fn means_by<T: Copy>(&self, samples: &[T], white: f64, n: usize, bright: impl Fn(&[T]) -> f64) -> Raster {
        let (width, height) = (self.width / n, self.height / n);
        let mut means = Raster::constant(width, height, 0.0);
        let share = 1.0 / (n * n) as f64;
        for (y, row) in samples.chunks_exact(self.width * self.channels).take(height * n).enumerate() {
            let to = &mut means.values[y / n * width..][..width];
            for (mean, pixels) in to.iter_mut().zip(row.chunks_exact(n * self.channels)) {
                *mean += share
                    * pixels.chunks_exact(self.channels).map(|pixel| bright(pixel) / white).sum::<f64>();
            }
        }
        means
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_means_are_those_of_the_whole_picture_s_brightness() {
        for channels in 1..=4_usize {
            let (w, h) = (11, 7);
            let numbers: Vec<u16> = (0..w * h * channels).map(|i| ((i * 7919) % 256) as u16).collect();
            let samples = [
                Samples::U8(numbers.iter().map(|&v| v as u8).collect()),
                Samples::U16(numbers.iter().map(|&v| 257 * v).collect()),
                Samples::F32(numbers.iter().map(|&v| f32::from(v) / 255.0).collect()),
            ];
            for samples in samples {
                let picture = Picture::new(w as u32, h as u32, samples).unwrap();
                let whole = picture.channel(Channel::Luma).unwrap().raster;
                for n in 1..=3 {
                    let found = picture.brightness(n).unwrap();
                    assert_eq!((found.width, found.height), (w / n, h / n));
                    for y in 0..h / n {
                        for x in 0..w / n {
                            let row = |j: usize| (0..n).map(|i| whole.at(x * n + i, y * n + j)).sum::<f64>();
                            let mean = (0..n).fold(0.0, |mean, j| mean + 1.0 / (n * n) as f64 * row(j));
                            assert_eq!(found.at(x, y), mean, "{channels} channels, {n}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_value_that_is_not_finite_is_found_where_it_is() {
        let bad = Picture::new(2, 1, Samples::F32(vec![0.0, f32::NAN])).unwrap();
        assert!(matches!(bad.brightness(2), Err(Problem::NotFinite { x: 1, y: 0 })));
    }
}
