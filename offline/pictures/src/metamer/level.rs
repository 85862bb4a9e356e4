//! Passes on one grid, after those on the grid twice as coarse.
//!
//! ```text
//! x ← y + s (A(y) − y) + m (y − y before) + k (x − y)         y ← H(x)
//! ```
//! | symbol | here |
//! |---|---|
//! | A | every sub-band takes the reference's histogram, all together take its spectral envelope |
//! | H | the heights take the reference's histogram: last, so that plateaus stay flat and nothing leaves its range |
//! | s; m, k | [`BAND_STEP`]; of these two one at the most, by [`Schedule`] |
//!
//! What a coarser grid has changed is added by its spectrum before the first pass here. So long
//! waves, which on the fine grid move by a texel a pass, are at their place at a sixteenth of the
//! work. Without momentum and coarser grids 50 passes leave 0.05–0.07 of σ on maps with plateaus (a
//! walkway, a diamond plate), with them 20 leave 0.010–0.018.
//!
//! Of terraces H takes back every move that does not lift a place to the next height, so that
//! passes without a memory come to rest where all moves are small. Term k keeps what was taken back
//! until it suffices (the error feedback of V. Elser, "Phase retrieval by iterated projections",
//! JOSA A 20, 2003, without its reflection, which left twice as much): of fractal ground cut to 3,
//! 6 and 12 heights 0.018, 0.014 and 0.006 σ are left instead of 0.041, 0.041 and 0.032, and
//! 0.5–0.8 of the original's arrangement, where before the reference had to lend all of its own.

use super::bands::{Bands, Parts, Scratch};
use crate::borders::{Borders, SplitBorders};
use crate::fft2::Fft2;
use crate::histogram::Histogram;
use crate::spectral_envelope::Envelope;
use crate::spectral_resample::{resample, resample_mirrored};
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;

/// Factor of each pass's move of the surface along the change that matching the bands makes. Beyond
/// 1: the change is the same from pass to pass, only smaller.
const BAND_STEP: f64 = 1.7;
/// Share of a pass's move that the next one repeats, where it must: surfaces without plateaus come
/// near without, and momentum carries them away from the original's arrangement (correlation of the
/// sub-bands 0.8–0.9 without, 0.4–0.6 with it).
const MOMENTUM: f64 = 0.8;
/// Share of what the heights took back that is still there a pass later. Source: ours, the best of
/// 0.8, 0.9, 0.95 and 1 on terraces, islands and dots of two heights.
const KEPT: f64 = 0.95;
/// First passes that go no further than the change itself: only once the amplitudes are near the
/// reference's does overshooting not turn the original's sub-bands over.
const GENTLE_PASSES: usize = 2;
/// Part of the passes, at the end, without momentum.
const CALM_PART: usize = 4;
/// Part of the passes, at the end, that keep nothing of what the heights took back.
const FORGETFUL_PART: usize = 8;
/// Most that imposing the envelope changes an amplitude in one pass.
const MOST_GAIN: f64 = 2.0;
/// Side of the grid, texels, that gets the passes asked for. Coarser ones get up to [`MOST_PASSES`]
/// times as many, finer ones fewer, by their sides: each octave costs twice the one below it.
const SIDE: f64 = 256.0;
const MOST_PASSES: f64 = 2.0;
/// Fewest passes of a fine grid, if as many are asked for.
const FEWEST_PASSES: usize = 4;
/// Last passes on grids finer than [`SIDE`] that see every band in full; the others see as many
/// samples as its waves need.
const FULL_PASSES: usize = 1;

/// Target that surfaces on one grid are matched to.
#[derive(Debug, Clone)]
pub(super) struct Level {
    pub size: [usize; 2],
    /// Every band as large as the image, as in the document.
    pub full: Bands,
    /// Every band as large as its waves need; on fine grids.
    reduced: Option<Bands>,
    /// Target of the whole reference, with its borders.
    pub heights: Histogram,
    envelope: Envelope,
    power: Vec<f64>,
    pub coarser: Option<Box<Level>>,
}

/// Movement of a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Task {
    /// Passes asked for.
    pub passes: usize,
    pub parts: Parts,
    pub gait: Schedule,
}

/// Task: a surface, and the one to be made of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sought<'a> {
    /// The part of it that tiles, and what is added for its heights.
    pub original: &'a Raster,
    pub seam: Option<&'a Raster>,
    pub task: Task,
}

/// Steps of a pass beyond the change that matching the bands makes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Schedule {
    /// Nothing: this keeps the most of the original's arrangement.
    Plain,
    /// It goes on from where it would be had the heights taken nothing back ([`KEPT`]): for
    /// terraces.
    Remembering,
    /// It repeats part of the last move ([`MOMENTUM`]).
    Momentum,
}

impl Schedule {
    /// This one, or nothing beyond the change in the passes that begin and end all of them:
    /// momentum would turn bands over while steps are gentle, a memory of them does no harm.
    fn in_pass(self, pass: usize, all: usize) -> Self {
        let (first, last) = match self {
            Self::Plain => (0, 0),
            Self::Remembering => (0, all / FORGETFUL_PART),
            Self::Momentum => (GENTLE_PASSES, all / CALM_PART),
        };
        if pass <= first || pass + last > all { Self::Plain } else { self }
    }

    /// Addition to a height, and what is carried to the next pass: the height before, or the one
    /// before the heights were matched.
    fn add(self, value: f64, change: f64, carried: f64) -> (f64, f64) {
        match self {
            Self::Plain => (value + change, value),
            Self::Momentum => (value + change + MOMENTUM * (value - carried), value),
            Self::Remembering => {
                let moved = value + change + KEPT * (carried - value);
                (moved, moved)
            }
        }
    }
}

impl Level {
    /// For images of `size`, like `reference`.
    pub fn new(
        reference: &SplitBorders,
        size: [usize; 2],
        [bands, orientations]: [usize; 2],
        scratch: &mut Scratch,
    ) -> Result<Self, DesignError> {
        let design = [bands, orientations];
        let tiling = &reference.periodic;
        let full = Bands::new(tiling, size, design, scratch)?;
        let is_large = texels_a_side(size) > SIDE;
        let reduced = is_large.then(|| full.reduced(tiling, scratch));
        let coarser = (bands > 1).then(|| {
            let [w, h] = [tiling.width, tiling.height].map(|n| n.div_ceil(2));
            let smooth = reference.smooth.as_ref().map(|smooth| resample_mirrored(smooth, w, h));
            let small = SplitBorders { periodic: resample(tiling, w, h), smooth };
            Self::new(&small, size.map(|n| n.div_ceil(2)), [bands - 1, orientations], scratch)
        });
        let mut whole = tiling.clone();
        add(&mut whole, reference.smooth.as_ref(), 1.0);
        let theirs = Envelope::new(tiling.width, tiling.height);
        Ok(Self {
            size,
            full,
            reduced: reduced.transpose()?,
            heights: scratch.matcher.histogram(&whole.values),
            envelope: Envelope::new(size[0], size[1]),
            power: theirs.power(&Fft2::new(tiling.width, tiling.height).spectrum(&tiling.values)),
            coarser: coarser.transpose()?.map(Box::new),
        })
    }

    /// Passes on this grid, of those asked for. Terraces get more of them where others need few:
    /// their edges are on the fine grid alone.
    pub fn passes(&self, asked: usize, gait: Schedule) -> usize {
        let share = (SIDE / texels_a_side(self.size)).min(MOST_PASSES);
        let share = if gait == Schedule::Remembering && share < 1.0 { share.sqrt() } else { share };
        ((asked as f64 * share).round() as usize).max(asked.min(FEWEST_PASSES))
    }

    /// The first grid, from here to coarser ones, of no more texels than [`SIDE`]²; how many steps
    /// away it is.
    pub fn of_moderate_size(&mut self) -> (&mut Self, usize) {
        let steps = self.steps_to_moderate_size();
        let level = (0..steps).fold(self, |level, _| level.coarser.as_mut().expect("steps were counted"));
        (level, steps)
    }

    fn steps_to_moderate_size(&self) -> usize {
        match &self.coarser {
            Some(coarser) if texels_a_side(self.size) > SIDE => 1 + coarser.steps_to_moderate_size(),
            _ => 0,
        }
    }

    /// Moves `image`, to which `seam` is added for its heights, towards the reference, and returns
    /// the passes done on this grid. `enough` is asked after each.
    pub fn settle(
        &mut self,
        image: &mut Raster,
        seam: Option<&Raster>,
        task: Task,
        scratch: &mut Scratch,
        enough: &mut dyn FnMut(&mut Self, &Raster, &mut Scratch) -> bool,
    ) -> usize {
        self.settle_coarser(image, seam, task, scratch);
        let passes = self.passes(task.passes, task.gait);
        let power = self.power_of(task.parts);
        let mut carried = image.values.clone();
        let mut made = Vec::new();
        for pass in 1..=passes {
            let fine_bands = self.reduced.as_mut().filter(|_| pass + FULL_PASSES <= passes);
            let bands = fine_bands.unwrap_or(&mut self.full);
            bands.match_all(&image.values, task.parts, scratch);
            if pass < passes {
                self.envelope.impose(&mut scratch.sum, &power, MOST_GAIN);
            }
            bands.pyramid.image(&scratch.sum, &mut made);
            let band_step = if pass <= GENTLE_PASSES { 1.0 } else { BAND_STEP };
            let gait = task.gait.in_pass(pass, passes);
            for ((value, goal), carried) in image.values.iter_mut().zip(&made).zip(&mut carried) {
                (*value, *carried) = gait.add(*value, band_step * (goal - *value), *carried);
            }
            self.match_heights(image, seam, scratch);
            if enough(self, image, scratch) {
                return pass;
            }
        }
        passes
    }

    /// The bands as large as their waves need: a third of the work, and nearly the same distances.
    pub fn quick_bands(&mut self) -> &mut Bands {
        self.reduced.as_mut().unwrap_or(&mut self.full)
    }

    /// Gives `image` and `seam` together the reference's heights, through changes of `image`.
    pub fn match_heights(&self, image: &mut Raster, seam: Option<&Raster>, scratch: &mut Scratch) {
        add(image, seam, 1.0);
        scratch.matcher.run(&mut image.values, &self.heights);
        add(image, seam, -1.0);
    }

    fn settle_coarser(
        &mut self,
        image: &mut Raster,
        seam: Option<&Raster>,
        task: Task,
        scratch: &mut Scratch,
    ) {
        let Some(coarser) = &mut self.coarser else { return };
        let [w, h] = coarser.size;
        let before = resample(image, w, h);
        let mut change = before.clone();
        let seam = seam.map(|seam| resample_mirrored(seam, w, h));
        coarser.settle(&mut change, seam.as_ref(), task, scratch, &mut |_, _, _| false);
        add(&mut change, Some(&before), -1.0);
        add(image, Some(&resample(&change, self.size[0], self.size[1])), 1.0);
    }

    /// The envelope that is imposed: none on the waves of a low residual that is left alone.
    fn power_of(&self, parts: Parts) -> Vec<f64> {
        if parts == Parts::All {
            return self.power.clone();
        }
        let bands = self.full.pyramid.subbands().iter().map(|band| band.wavelength_px);
        Envelope::only_below(&self.power, bands.filter(|px| px.is_finite()).fold(0.0, f64::max))
    }
}

/// Adds `sign` times `other`, if there is one.
pub(super) fn add(image: &mut Raster, other: Option<&Raster>, sign: f64) {
    let Some(other) = other else { return };
    for (value, other) in image.values.iter_mut().zip(&other.values) {
        *value += sign * other;
    }
}

/// An image on another grid.
pub(super) fn on_grid(image: &Raster, borders: Borders, [width, height]: [usize; 2]) -> Raster {
    if (width, height) == (image.width, image.height) {
        return image.clone();
    }
    let by = if borders == Borders::Periodic { resample } else { resample_mirrored };
    by(image, width, height)
}

fn texels_a_side([width, height]: [usize; 2]) -> f64 {
    ((width * height) as f64).sqrt()
}
