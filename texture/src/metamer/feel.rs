//! Tactile statistics of a reference, and surfaces that are given them.

use super::arrangement::{Correlation, correlation};
use super::bands::{Parts, Scratch};
use super::level::{Gait, Level, Task, add, on_grid};
use super::spectrum::with_amplitudes;
use super::terraces::are_terraces;
use super::{BORROWED, Distance, EMPTY_BAND, Metamer, MetamerOptions, Method, REACH, check_finite};
use crate::borders::{Borders, SplitBorders};
use crate::pyramid::{Kind, Pyramid, Sampling, Subband};
use crate::raster::Raster;
use asperity_dsp::DesignError;

/// Most that an original without relief is raised before it is mixed with the reference.
const MOST_GAIN: f64 = 1e6;
/// Part of the distance asked for at which starts on a coarser grid count as near enough.
const MARGIN: f64 = 0.9;

/// A reference on the texels of originals of one size: its sub-bands, heights and envelope.
#[derive(Debug, Clone)]
pub struct Feel {
    options: MetamerOptions,
    /// The part that tiles, and the steps at the borders.
    reference: SplitBorders,
    range: (f64, f64),
    level: Level,
    has_terraces: bool,
    scratch: Scratch,
}

impl Feel {
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
        Ok(Self { options: *options, reference, range, level, has_terraces: are_terraces(&whole), scratch })
    }

    /// Lowest and highest height of the reference.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        self.range
    }

    /// How far `image`, of the originals' size, is from the reference; `tiles`: its borders meet.
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

    /// Makes `original` feel like the reference. `stored` is given the heights and returns what is left of them in a file: that is
    /// measured and returned. `progress` is told the fraction done.
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
                let task = Task { passes: asked, parts: self.parts(seam.as_ref()), gait: Gait::Plain };
                let made = self.iterate(&ours.periodic, seam.as_ref(), task, &mut progress);
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

    /// Correlations of the sub-bands of an image with those of an original, and of the reference laid out over its size.
    fn arrangement(&mut self, original: &Raster, image: &Raster, tiles: bool) -> [Correlation; 2] {
        let borders = if tiles { Borders::Periodic } else { Borders::Smooth };
        let image = SplitBorders::of(image, borders).periodic;
        let reference = Raster::from_fn(image.width, image.height, |x, y| self.laid_out(x, y));
        let pyramid = &mut self.level.quick_bands().pyramid;
        [original, &reference].map(|other| correlation(&image, other, pyramid))
    }

    /// The reference's height at a texel of the original's grid, which it covers again and again.
    fn laid_out(&self, x: usize, y: usize) -> f64 {
        let reference = &self.reference.periodic;
        reference.at(x % reference.width, y % reference.height)
    }

    /// The slowest waves are left to the heights where the reference has others than a surface like the original can have: a
    /// tilt where it tiles, or waves of another size.
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

    /// Of terraces with a memory; of other surfaces, and where that does not come near enough, by a search.
    fn iterate(
        &mut self,
        original: &Raster,
        seam: Option<&Raster>,
        task: Task,
        progress: &mut impl FnMut(f64),
    ) -> Made {
        let Some(by_memory) = self.by_memory(original, seam, task) else {
            return self.search(original, seam, task, progress);
        };
        if by_memory.mean <= self.goal() {
            return by_memory;
        }
        let searched = self.search(original, seam, task, progress);
        if by_memory.mean < searched.mean { by_memory } else { searched }
    }

    /// Passes with a memory from the original itself, if the reference is terraces: others come to nothing there. Twice as many, where that is what
    /// lacks; of a large surface only where its coarser copy comes near.
    fn by_memory(&mut self, original: &Raster, seam: Option<&Raster>, task: Task) -> Option<Made> {
        let remembering = Task { gait: Gait::Remembering, ..task };
        let is_large = self.level.of_moderate_size().1 > 0;
        let is_hopeless = !self.has_terraces
            || is_large && self.try_coarsely(original, seam, remembering, 0.0).mean > 2.0 * self.goal();
        if is_hopeless {
            return None;
        }
        let made = self.try_out(original.clone(), seam, remembering, 0.0);
        let comes_nearer = made.mean > self.goal() && made.mean <= 2.0 * self.goal();
        if !comes_nearer {
            return Some(made);
        }
        let patiently = Task { passes: 2 * task.passes, ..remembering };
        let again = self.try_out(original.clone(), seam, patiently, 0.0);
        Some(if again.mean < made.mean { again } else { made })
    }

    /// Passes from the original, then with a memory, then with momentum, then from surfaces that have more and more of the reference's own
    /// arrangement, until the result is near enough. Of large maps this is tried on a coarser grid.
    fn search(
        &mut self,
        original: &Raster,
        seam: Option<&Raster>,
        task: Task,
        progress: &mut impl FnMut(f64),
    ) -> Made {
        let is_moderate = self.level.of_moderate_size().1 == 0;
        let mut best: Option<(Made, Task)> = None;
        let tries = self.tries(task);
        for (tried, &(share, task)) in tries.iter().enumerate() {
            let start = self.start(original, seam, share);
            let made = if is_moderate {
                self.try_out(start, seam, task, share)
            } else {
                self.try_coarsely(&start, seam, task, share)
            };
            let margin = if is_moderate { 1.0 } else { MARGIN };
            let is_near = made.mean <= margin * self.goal();
            if best.as_ref().is_none_or(|(best, _)| made.mean < best.mean) {
                best = Some((made, task));
            }
            progress((tried + 1) as f64 / (tries.len() + 1) as f64);
            if is_near {
                break;
            }
        }
        let (made, task) = best.expect("the original alone is always tried");
        if is_moderate {
            return made;
        }
        let begun = (made.borrowed, task);
        let [remembering, briskly] = [Gait::Remembering, Gait::Momentum].map(|gait| Task { gait, ..task });
        // Terraces are slopes on the coarser grid: only the fine one asks for a memory.
        let alone = (made.borrowed == 0.0 && task.gait == Gait::Plain).then_some((0.0, remembering));
        // What serves the coarser copy may not serve the surface itself, whose finest waves only it has.
        let most = self.options.borrow;
        let more = BORROWED.into_iter().filter(|&share| share > made.borrowed && share <= most);
        let more = more.step_by(2).map(|share| (share, briskly));
        self.nearest(original, seam, std::iter::once(begun).chain(alone).chain(more))
    }

    /// The nearest of what passes make of some starts, none of them tried after one that is near enough.
    fn nearest(
        &mut self,
        original: &Raster,
        seam: Option<&Raster>,
        tries: impl Iterator<Item = (f64, Task)>,
    ) -> Made {
        let mut best: Option<Made> = None;
        for (share, task) in tries {
            let start = self.start(original, seam, share);
            let made = self.try_out(start, seam, task, share);
            if best.as_ref().is_none_or(|best| made.mean < best.mean) {
                best = Some(made);
            }
            if best.as_ref().is_some_and(|best| best.mean <= self.goal()) {
                break;
            }
        }
        best.expect("at least one start")
    }

    /// Shares to borrow and how to go on from there.
    fn tries(&self, gently: Task) -> Vec<(f64, Task)> {
        let [remembering, briskly] = [Gait::Remembering, Gait::Momentum].map(|gait| Task { gait, ..gently });
        let shares = BORROWED.into_iter().filter(|share| *share <= self.options.borrow);
        let alone = [(0.0, gently), (0.0, remembering)];
        alone.into_iter().chain(shares.map(|share| (share, briskly))).collect()
    }

    fn settle(&mut self, start: Raster, seam: Option<&Raster>, task: Task, borrowed: f64) -> Made {
        let mut image = start;
        let until = self.options.until;
        let mut enough = |level: &mut Level, image: &Raster, scratch: &mut Scratch| {
            until.is_some_and(|until| {
                let distances = distances(level, image, scratch);
                mean(level, &distances) <= until
            })
        };
        let passes = self.level.settle(&mut image, seam, task, &mut self.scratch, &mut enough);
        Made { image, mean: f64::NAN, passes, borrowed }
    }

    /// As [`Self::settle`], unless a start that has borrowed is near enough as it is: of a pattern of few heights passes would
    /// only take it away.
    fn settle_unless_near(
        &mut self,
        start: Raster,
        seam: Option<&Raster>,
        task: Task,
        borrowed: f64,
    ) -> Made {
        if borrowed > 0.0 {
            let mean = self.mean_of(&start);
            if mean <= self.goal() {
                return Made { image: start, mean, passes: 0, borrowed };
            }
        }
        self.settle(start, seam, task, borrowed)
    }

    /// The same, and how near it came.
    fn try_out(&mut self, start: Raster, seam: Option<&Raster>, task: Task, borrowed: f64) -> Made {
        let made = self.settle_unless_near(start, seam, task, borrowed);
        Made { mean: self.mean_of(&made.image), ..made }
    }

    /// The passes on a coarser grid, and how near they came.
    fn try_coarsely(&mut self, start: &Raster, seam: Option<&Raster>, task: Task, borrowed: f64) -> Made {
        let (level, _) = self.level.of_moderate_size();
        let mut image = on_grid(start, Borders::Periodic, level.size);
        let seam = seam.map(|seam| on_grid(seam, Borders::Smooth, level.size));
        let passes = level.settle(&mut image, seam.as_ref(), task, &mut self.scratch, &mut |_, _, _| false);
        let distances = distances(level, &image, &mut self.scratch);
        Made { mean: mean(level, &distances), image, passes, borrowed }
    }

    /// What counts as near enough.
    fn goal(&self) -> f64 {
        self.options.until.unwrap_or(REACH)
    }

    /// Of every sample of every band, as the result is judged: as many samples as the waves need may show a fifth less.
    fn mean_of(&mut self, image: &Raster) -> f64 {
        let distances = distances(&mut self.level, image, &mut self.scratch);
        mean(&self.level, &distances)
    }

    /// The original, or a mixture of it (brought to the reference's mean and deviation) and the reference itself, which has
    /// the reference's heights.
    fn start(&mut self, original: &Raster, seam: Option<&Raster>, share: f64) -> Raster {
        if share == 0.0 {
            return original.clone();
        }
        let reference = &self.reference.periodic;
        let (ours, theirs) = (original.mean(), reference.mean());
        let gain = deviation(reference) / deviation(original).max(f64::MIN_POSITIVE);
        let mut start = Raster::from_fn(original.width, original.height, |x, y| {
            let matched = theirs + gain.min(MOST_GAIN) * (original.at(x, y) - ours);
            matched + share * (self.laid_out(x, y) - matched)
        });
        self.level.match_heights(&mut start, seam, &mut self.scratch);
        start
    }
}

/// What passes have made of a start.
struct Made {
    image: Raster,
    mean: f64,
    passes: usize,
    borrowed: f64,
}

/// A sub-band that the reference does not have cannot be measured in its own deviations.
fn floor(level: &Level) -> f64 {
    EMPTY_BAND * level.heights.deviation().max(f64::MIN_POSITIVE)
}

fn distances(level: &mut Level, image: &Raster, scratch: &mut Scratch) -> Vec<f64> {
    let floor = floor(level);
    level.full.distances(image, floor, scratch)
}

fn deviation(image: &Raster) -> f64 {
    let mean = image.mean();
    (image.values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / image.values.len() as f64).sqrt()
}

fn is_oriented(band: &Subband) -> bool {
    matches!(band.kind, Kind::Oriented { .. })
}

/// Mean over the oriented bands.
fn mean(level: &Level, distances: &[f64]) -> f64 {
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

    /// A diamond plate under rock at 1024² was 0.018 σ away by the samples its waves need, and 0.024 by all of them: the passes ended too early.
    #[test]
    fn a_start_of_a_large_surface_is_judged_by_all_samples_as_the_result_is() {
        let mut rng = Rng::new(17);
        let mut noise = |gain: f64| Raster::from_fn(272, 260, |x, _| (x % 9) as f64 + gain * rng.normal());
        let (reference, image) = (noise(0.5), noise(3.0));
        let mut feel = Feel::new(&reference, 272, 260, &MetamerOptions::default()).unwrap();
        let (trial, result) = (feel.mean_of(&image), feel.distance(&image, true).mean);
        assert!(trial > 0.1 && (trial - result).abs() < 1e-12, "{trial} {result}");
    }
}
