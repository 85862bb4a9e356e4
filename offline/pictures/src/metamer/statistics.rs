//! Tactile statistics of a reference, and surfaces that are given them.

use super::arrangement::{Correlation, correlation};
use super::bands::{Parts, Scratch};
use super::level::{Level, Schedule, Sought, Task, add, on_grid};
use super::spectrum::with_amplitudes;
use super::terraces::{ground_under, heights_of_terraces};
use super::{Distance, EMPTY_BAND, Metamer, MetamerOptions, Method, check_finite};
use crate::borders::{Borders, SplitBorders};
use crate::pyramid::{Kind, Pyramid, Sampling, Subband};
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;
use asperity_surface::wrap::Wrap;

/// A reference on the texels of originals of one size: its sub-bands, heights and envelope.
#[derive(Debug, Clone)]
pub struct Statistics {
    pub(super) options: MetamerOptions,
    /// The part that tiles, and the steps at the borders.
    pub(super) reference: SplitBorders,
    range: (f64, f64),
    pub(super) level: Level,
    /// The reference, if it is terraces.
    pub(super) terraces: Option<Raster>,
    /// The ground under them, once it is asked for.
    pub(super) ground: Option<Box<Statistics>>,
    pub(super) scratch: Scratch,
}

impl Statistics {
    /// Analyses `reference` for originals of `width` × `height`.
    ///
    /// # Errors
    /// As [`super::metamer`].
    pub fn new(
        reference: &Raster,
        width: usize,
        height: usize,
        options: &MetamerOptions,
    ) -> Result<Self, DesignError> {
        check_finite("reference", reference)?;
        let MetamerOptions { bands, orientations, scale, .. } = *options;
        DesignError::check("scale", scale, "within 1/64 to 64", |s| (1.0 / 64.0..=64.0).contains(&s))?;
        let borders = options.borders.decide(reference);
        let range = reference.range();
        // Borders are split on the original's texels: a step that is resampled rings.
        let whole = scaled(reference, scale, borders).map(|v| v.clamp(range.0, range.1));
        let reference = SplitBorders::of(&whole, borders);
        let mut scratch = Scratch::default();
        let level = Level::new(&reference, [width, height], [bands, orientations], &mut scratch)?;
        let terraces = heights_of_terraces(&whole).map(|_| whole);
        Ok(Self { options: *options, reference, range, level, terraces, ground: None, scratch })
    }

    /// Lowest and highest height of the reference.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// Distance of `image`, of the originals' size, from the reference; `tiles`: its borders meet.
    #[must_use]
    pub fn distance(&mut self, image: &Raster, tiles: bool) -> Distance {
        let borders = if tiles { Borders::Periodic } else { Borders::Smooth };
        let split = SplitBorders::of(image, borders);
        let subbands = distances(&mut self.level, &split.periodic, &mut self.scratch);
        let heights = self.scratch.matcher.histogram(&image.values);
        Distance {
            mean: mean(&self.level, &subbands),
            subbands,
            heights: heights.distance(&self.level.heights)
                / self.level.heights.deviation().max(floor(&self.level)),
        }
    }

    /// Makes `original` feel like the reference. `stored` is given the heights and returns what is
    /// left of them in a file: that is measured and returned. `progress` gets the fraction done.
    ///
    /// # Errors
    /// When the original holds numbers that are not finite.
    ///
    /// # Panics
    /// When it has another size than was planned.
    pub fn metamer(
        &mut self,
        original: &Raster,
        stored: impl FnOnce(Raster) -> Raster,
        mut progress: impl FnMut(f64),
    ) -> Result<Metamer, DesignError> {
        check_finite("original", original)?;
        assert_eq!([original.width, original.height], self.level.size, "an original of the size planned");
        let borders = self.options.borders.decide(original);
        let ours = SplitBorders::of(original, borders);
        // A surface that tiles keeps no step at its borders, nor does one whose reference has none.
        let seam = ours.seam_like(&self.reference);
        let before = self.distance(original, borders == Borders::Periodic);
        let (mut passes, mut borrowed) = (1, 0.0);
        let mut image = match self.options.method {
            Method::SinglePass => self.single_pass(&ours.periodic)?,
            Method::Spectrum => with_amplitudes(&ours.periodic, &self.reference.periodic),
            Method::Iterated(asked) => {
                let task = Task { passes: asked, parts: self.parts(seam.as_ref()), gait: Schedule::Plain };
                let sought = Sought { original: &ours.periodic, seam: seam.as_ref(), task };
                let made = self.iterate(sought, &mut progress)?;
                (passes, borrowed) = (made.passes, made.borrowed);
                made.image
            }
        };
        add(&mut image, seam.as_ref(), 1.0);
        let image = stored(image);
        let tileable = seam.is_none();
        let after = self.distance(&image, tileable);
        let subbands = self.level.full.pyramid.subbands().to_vec();
        let [with_original, with_reference] = self.arrangement(&ours.periodic, &image, tileable);
        Ok(Metamer {
            image,
            subbands,
            before,
            after,
            tileable,
            passes,
            borrowed,
            correlation_with_original: with_original.in_place,
            correlation_with_reference: with_reference.highest,
            shift_from_reference_px: with_reference.shift_px,
        })
    }

    /// Statistics of the ground under the reference, if that is terraces; it is to be put back.
    pub(super) fn take_ground(&mut self) -> Result<Option<Box<Self>>, DesignError> {
        if self.ground.is_some() {
            return Ok(self.ground.take());
        }
        let Some(terraces) = &self.terraces else { return Ok(None) };
        let tiles = self.reference.smooth.is_none();
        let (wrap, borders) =
            if tiles { (Wrap::Repeat, Borders::Periodic) } else { (Wrap::Clamp, Borders::Smooth) };
        let Some(ground) = ground_under(terraces, wrap) else { return Ok(None) };
        let options = MetamerOptions { borders, scale: 1.0, ..self.options };
        let [width, height] = self.level.size;
        Ok(Some(Box::new(Self::new(&ground, width, height, &options)?)))
    }

    /// Tolerance of every sample of every band, as the result is judged: as many samples as the
    /// waves need may show a fifth less.
    pub(super) fn mean_of(&mut self, image: &Raster) -> f64 {
        let distances = distances(&mut self.level, image, &mut self.scratch);
        mean(&self.level, &distances)
    }

    /// Correlations of the sub-bands of an image with those of an original, and of the reference
    /// laid out over its size.
    fn arrangement(&mut self, original: &Raster, image: &Raster, tiles: bool) -> [Correlation; 2] {
        let borders = if tiles { Borders::Periodic } else { Borders::Smooth };
        let image = SplitBorders::of(image, borders).periodic;
        let reference = Raster::from_fn(image.width, image.height, |x, y| self.laid_out(x, y));
        let pyramid = &mut self.level.quick_bands().pyramid;
        [original, &reference].map(|other| correlation(&image, other, pyramid))
    }

    /// The reference's height at a texel of the original's grid, which it covers again and again.
    pub(super) fn laid_out(&self, x: usize, y: usize) -> f64 {
        let reference = &self.reference.periodic;
        reference.at(x % reference.width, y % reference.height)
    }

    /// The slowest waves are left to the heights where the reference has others than a surface like
    /// the original can have: a tilt where it tiles, or waves of another size.
    fn parts(&self, seam: Option<&Raster>) -> Parts {
        let Raster { width, height, .. } = self.reference.periodic;
        let has_tilt = self.reference.smooth.is_some() && seam.is_none();
        if has_tilt || [width, height] != self.level.size { Parts::AllButTheSlowest } else { Parts::All }
    }

    /// The document's: the oriented bands once, each by the ranks of its values.
    fn single_pass(&mut self, original: &Raster) -> Result<Raster, DesignError> {
        let MetamerOptions { bands, orientations, .. } = self.options;
        let pyramid = |of: &Raster| Pyramid::new(of.width, of.height, bands, orientations, Sampling::Full);
        let reference = &self.reference.periodic;
        let wanted = pyramid(reference)?.split(&reference.values);
        let mut pyramid = pyramid(original)?;
        let mut split = pyramid.split(&original.values);
        for index in (0..split.len()).filter(|&index| is_oriented(&pyramid.subbands()[index])) {
            let histogram = self.scratch.matcher.histogram(wanted.get(index));
            self.scratch.matcher.run(split.get_mut(index), &histogram);
        }
        Ok(pyramid.join(&split))
    }
}

/// A sub-band that the reference does not have cannot be measured in its own deviations.
fn floor(level: &Level) -> f64 {
    EMPTY_BAND * level.heights.deviation().max(f64::MIN_POSITIVE)
}

pub(super) fn distances(level: &mut Level, image: &Raster, scratch: &mut Scratch) -> Vec<f64> {
    let floor = floor(level);
    level.full.distances(image, floor, scratch)
}

pub(super) fn deviation(image: &Raster) -> f64 {
    let mean = image.mean();
    (image.values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / image.values.len() as f64).sqrt()
}

fn is_oriented(band: &Subband) -> bool {
    matches!(band.kind, Kind::Oriented { .. })
}

/// Mean over the oriented bands.
pub(super) fn mean(level: &Level, distances: &[f64]) -> f64 {
    let subbands = level.full.pyramid.subbands().iter().zip(distances);
    let oriented = subbands.filter(|(band, _)| is_oriented(band));
    let (sum, count) = oriented.fold((0.0, 0.0), |(sum, count), (_, distance)| (sum + distance, count + 1.0));
    sum / count
}

/// The reference on the original's texels.
fn scaled(reference: &Raster, scale: f64, borders: Borders) -> Raster {
    let side = |n: usize| ((n as f64 / scale).round() as usize).max(1);
    on_grid(reference, borders, [side(reference.width), side(reference.height)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_dsp::rng::Rng;

    /// A diamond plate under rock at 1024² was 0.018 σ away by the samples its waves need, and
    /// 0.024 by all of them: the passes ended too early.
    #[test]
    fn the_start_of_a_large_surface_is_judged_by_all_samples() {
        let mut rng = Rng::new(17);
        let mut noise = |gain: f64| Raster::from_fn(272, 260, |x, _| (x % 9) as f64 + gain * rng.normal());
        let (reference, image) = (noise(0.5), noise(3.0));
        let mut feel = Statistics::new(&reference, 272, 260, &MetamerOptions::default()).unwrap();
        let (trial, result) = (feel.mean_of(&image), feel.distance(&image, true).mean);
        assert!(trial > 0.1 && (trial - result).abs() < 1e-12, "{trial} {result}");
    }
}
