//! Search for a surface with the reference's feel: ways, starts and gaits one after the other,
//! until one comes near enough.

use super::bands::Scratch;
use super::level::{Level, Schedule, Sought, Task, on_grid};
use super::statistics::{Statistics, deviation, distances, mean};
use super::{BORROWED, REACH};
use crate::borders::Borders;
use asperity_dsp::DesignError;
use asperity_surface::raster::Raster;

/// Most that an original without relief is raised before it is mixed with the reference.
const MOST_GAIN: f64 = 1e6;
/// Part of the distance asked for at which starts on a coarser grid count as near enough.
const MARGIN: f64 = 0.9;
/// Times the distance asked for up to which passes over terraces have a prospect.
const MOST_DISTANCE_RATIO: f64 = 2.0;
/// Passes of the first round, where there are more.
const PROMISING: f64 = 5.0;
/// Texels that rounds over terraces may pass over, all together, and most rounds in a row. Source:
/// ours; at 1024² these are two, three seconds each.
const TEXELS: usize = 2 << 20;
const MOST_ROUNDS: usize = 6;
/// Share of the distance that a round may leave at the most for another one to be worth it.
const WORTH: f64 = 0.95;

/// Result of passes from a start.
#[derive(Debug, Clone)]
pub(super) struct Candidate {
    pub image: Raster,
    pub mean: f64,
    pub passes: usize,
    pub borrowed: f64,
}

impl Candidate {
    fn nearer(self, other: Self) -> Self {
        if other.mean < self.mean { other } else { self }
    }
}

/// Start of passes, and how they go on from there.
#[derive(Debug, Clone, Copy)]
struct Attempt {
    /// Share of the reference's own arrangement in the start.
    share: f64,
    task: Task,
}

impl Statistics {
    /// Start of a search: of a flat reference nothing but a flat surface; of terraces with a
    /// memory, then from the ground under them; of other surfaces, and where both have no prospect,
    /// by a search.
    pub(super) fn iterate(
        &mut self,
        sought: Sought,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Candidate, DesignError> {
        let goal = self.goal();
        let [w, h] = self.level.size;
        let (low, high) = self.range();
        if low == high {
            return Ok(Candidate { image: Raster::constant(w, h, low), mean: 0.0, passes: 0, borrowed: 0.0 });
        }
        let rounds = TEXELS / (w * h);
        let by_memory = self.by_memory(sought, rounds / 2);
        if let Some(made) = by_memory.as_ref().filter(|made| made.mean <= goal) {
            return Ok(made.clone());
        }
        let left = if by_memory.is_some() { rounds / 2 } else { rounds };
        let both = [by_memory, self.by_ground(sought, left)?];
        let by_steps = both.into_iter().flatten().reduce(Candidate::nearer);
        // What a search borrows is worth its time where little else comes near: of patterns.
        if let Some(made) = by_steps.as_ref().filter(|made| made.mean <= MOST_DISTANCE_RATIO * goal) {
            return Ok(made.clone());
        }
        let searched = self.search(sought, progress);
        Ok(by_steps.into_iter().fold(searched, Candidate::nearer))
    }

    /// Passes with a memory from the original itself, if the reference is terraces: others come to
    /// nothing there. Of a large surface only where its coarser copy comes near.
    fn by_memory(&mut self, sought: Sought, rounds: usize) -> Option<Candidate> {
        self.terraces.as_ref()?;
        self.is_near_enough(sought.original, sought)
            .then(|| self.rounds(sought.original.clone(), sought, rounds))
    }

    /// Search from what the original becomes under the ground of the reference.
    fn by_ground(&mut self, sought: Sought, rounds: usize) -> Result<Option<Candidate>, DesignError> {
        let Sought { original, seam, task } = sought;
        let Some(mut ground) = self.take_ground()? else { return Ok(None) };
        let start = if self.is_moderate() {
            Some(ground.search(sought, &mut |_| {}))
        } else {
            let coarsely = |ground: &mut Self, start: Raster, with| ground.try_coarsely(&start, seam, with);
            let tries = ground.tries(task);
            let (made, with) = ground.nearest(sought, tries, MARGIN, coarsely);
            self.is_near_enough(&made.image, sought).then(|| match rounds {
                // The ground is smooth: the finest grids have hardly more of it, and their time is
                // better spent on a round.
                0..=2 => {
                    let image = on_grid(&made.image, Borders::Periodic, self.level.size);
                    Candidate { image, ..made }
                }
                _ => {
                    let start = ground.start(original, seam, with.share);
                    ground.try_out(start, seam, with)
                }
            })
        };
        self.ground = Some(ground);
        Ok(start
            .map(|start| Candidate { borrowed: start.borrowed, ..self.rounds(start.image, sought, rounds) }))
    }

    /// Tests whether passes with a memory bring the coarser copy of a large surface near.
    fn is_near_enough(&mut self, start: &Raster, sought: Sought) -> bool {
        let with = remembering(sought.task);
        self.is_moderate()
            || self.try_coarsely(start, sought.seam, with).mean <= MOST_DISTANCE_RATIO * self.goal()
    }

    /// Passes with a memory over all grids, and again from what they have made, while that comes
    /// nearer: on the coarser grids terraces are slopes, whose edges move further than on the fine
    /// one. One round at least.
    fn rounds(&mut self, start: Raster, sought: Sought, most: usize) -> Candidate {
        let with = remembering(sought.task);
        let mut made = self.try_out(start, sought.seam, with);
        let mut is_worth_it = made.mean <= PROMISING * self.goal();
        for _ in 1..most.min(MOST_ROUNDS) {
            if made.mean <= self.goal() || !is_worth_it {
                break;
            }
            let next = self.try_out(made.image.clone(), sought.seam, with);
            is_worth_it = next.mean <= WORTH * made.mean;
            let passes = made.passes + next.passes;
            made = Candidate { passes, ..made.nearer(next) };
        }
        made
    }

    /// Passes from the original, then with a memory, then with momentum, then from surfaces that
    /// have more and more of the reference's own arrangement, until the result is near enough. Of
    /// large maps this is tried on a coarser grid.
    fn search(&mut self, sought: Sought, progress: &mut dyn FnMut(f64)) -> Candidate {
        let Sought { seam, task, .. } = sought;
        let tries = self.tries(task);
        let count = (tries.len() + 1) as f64;
        let mut tried = 0.0;
        let mut noted = |made: Candidate| {
            tried += 1.0;
            progress(tried / count);
            made
        };
        if self.is_moderate() {
            let make = |feel: &mut Self, start: Raster, with| noted(feel.try_out(start, seam, with));
            return self.nearest(sought, tries, 1.0, make).0;
        }
        let coarsely = |feel: &mut Self, start: Raster, with| noted(feel.try_coarsely(&start, seam, with));
        let (made, begun) = self.nearest(sought, tries, MARGIN, coarsely);
        // Terraces are slopes on the coarser grid: only the fine one asks for a memory.
        let alone = (made.borrowed == 0.0 && begun.task.gait == Schedule::Plain).then_some(remembering(task));
        // What serves the coarser copy may not serve the surface itself, whose finest waves only it
        // has.
        let most = self.options.borrow;
        let more = BORROWED.into_iter().filter(|&share| share > made.borrowed && share <= most);
        let more = more.step_by(2).map(|share| briskly(share, task));
        let tries = std::iter::once(begun).chain(alone).chain(more);
        self.nearest(sought, tries, 1.0, |feel, start, with| feel.try_out(start, seam, with)).0
    }

    /// The nearest of what `make` does with some starts, and which it was; none is tried after one
    /// within `margin` of the goal.
    fn nearest(
        &mut self,
        sought: Sought,
        tries: impl IntoIterator<Item = Attempt>,
        margin: f64,
        mut make: impl FnMut(&mut Self, Raster, Attempt) -> Candidate,
    ) -> (Candidate, Attempt) {
        let mut best: Option<(Candidate, Attempt)> = None;
        for with in tries {
            let start = self.start(sought.original, sought.seam, with.share);
            let made = make(self, start, with);
            let is_near = made.mean <= margin * self.goal();
            if best.as_ref().is_none_or(|(best, _)| made.mean < best.mean) {
                best = Some((made, with));
            }
            if is_near {
                break;
            }
        }
        best.expect("the original alone is always tried")
    }

    /// Shares to borrow and how to go on from there.
    fn tries(&self, gently: Task) -> Vec<Attempt> {
        let shares = BORROWED.into_iter().filter(|share| *share <= self.options.borrow);
        let alone = [Attempt { share: 0.0, task: gently }, remembering(gently)];
        alone.into_iter().chain(shares.map(|share| briskly(share, gently))).collect()
    }

    /// Passes on this grid from a start, and how near they came.
    fn try_out(&mut self, start: Raster, seam: Option<&Raster>, with: Attempt) -> Candidate {
        // Of a pattern of few heights passes would only take away what a start has borrowed.
        if with.share > 0.0 {
            let mean = self.mean_of(&start);
            if mean <= self.goal() {
                return Candidate { image: start, mean, passes: 0, borrowed: with.share };
            }
        }
        let mut image = start;
        let until = self.options.until;
        let mut enough = |level: &mut Level, image: &Raster, scratch: &mut Scratch| {
            until.is_some_and(|until| {
                let distances = distances(level, image, scratch);
                mean(level, &distances) <= until
            })
        };
        let passes = self.level.settle(&mut image, seam, with.task, &mut self.scratch, &mut enough);
        Candidate { mean: self.mean_of(&image), image, passes, borrowed: with.share }
    }

    /// The passes on a coarser grid, and how near they came.
    fn try_coarsely(&mut self, start: &Raster, seam: Option<&Raster>, with: Attempt) -> Candidate {
        let (level, _) = self.level.of_moderate_size();
        let mut image = on_grid(start, Borders::Periodic, level.size);
        let seam = seam.map(|seam| on_grid(seam, Borders::Smooth, level.size));
        let scratch = &mut self.scratch;
        let passes = level.settle(&mut image, seam.as_ref(), with.task, scratch, &mut |_, _, _| false);
        let distances = distances(level, &image, scratch);
        Candidate { mean: mean(level, &distances), image, passes, borrowed: with.share }
    }

    fn is_moderate(&mut self) -> bool {
        self.level.of_moderate_size().1 == 0
    }

    /// Distance that counts as near enough.
    fn goal(&self) -> f64 {
        self.options.until.unwrap_or(REACH)
    }

    /// The original, or a mixture of it (brought to the reference's mean and deviation) and the
    /// reference itself, which has the reference's heights.
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

/// The original itself, with a memory.
fn remembering(task: Task) -> Attempt {
    Attempt { share: 0.0, task: Task { gait: Schedule::Remembering, ..task } }
}

/// So much of the reference, with momentum.
fn briskly(share: f64, task: Task) -> Attempt {
    Attempt { share, task: Task { gait: Schedule::Momentum, ..task } }
}
