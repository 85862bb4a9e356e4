//! The analysis of a recording that is no sum of modes: from the tail to the attack, in stages.
//!
//! Fitted all at once, a recording is fitted where it is loud: modes are spent on the attack, and
//! quiet partials that ring long are left out, although they are what is heard for most of the
//! time. So a stage begins where the attack is long over, fits what is there, and leaves it alone;
//! the next one begins earlier and fits what the former leave.
//!
//! | stage | from, s | modes may fall until there by | places it may take |
//! |---|---|---|---|
//! | 1–3 | 0.2, 0.05, 0.012 | 1.5 nepers | 45 % of those left |
//! | 4 | 0 | – | the rest |
//!
//! A mode is continued back to the onset, where the engine strikes it, and grows by at most the
//! nepers of the table. What falls faster is fitted along with the others, up to three times as
//! fast, so that it does not bend them; but its place is in a later stage, and it is given up
//! before this one ends.
//!
//! Within a stage levels from long to short propose the few strongest poles of every band, all are
//! refitted jointly, and of more than may be kept those are kept that are heard
//! ([`crate::ways::ranking`]). What is one resonance becomes one mode ([`crate::ways::merging`]).
//! At the end all but the first stage's, which are the tail, are refitted together, their energy at
//! a small cost, so that pairs do not grow against each other where nothing is an exponential, and
//! what several stages found of one resonance becomes one mode (`one_mode`). What then still rings
//! late and was lost on the way gets the places that are left (`late_lines`).
//!
//! Giving strong partials the slope of their level down to 35 dB instead of the decay by energy was
//! tried: decays of the 14 recordings 3.5 % off for 7.2 (pooled), of 32 others as before, but 15 of
//! 56 late partials absent for 8. So it is not done.
//!
//! Struck by the engine, against the former single fit of everything (14 recordings): late partials
//! absent 7 of 56 for 19, signal to error from the onset 20 dB for 13.8 (median). By the sum of the
//! modes themselves late lines take 8 of 56 to 6.

use crate::noise::noise_floor::NoiseFloor;
use crate::search::limits::Limits;
use crate::search::sub_band::Level;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::refinement::{Bounds, refine};
use crate::ways::analysis::{Analysis, subtract};
use crate::ways::late_lines::late_lines;
use crate::ways::one_mode::one_mode_each;
use crate::ways::ranking::keep_heard;
use crate::ways::rounds::{Rounds, add_proposed};

/// Beginnings of the stages, s after the onset.
const STAGES_S: [f64; 4] = [0.2, 0.05, 0.012, 0.0];
/// By how much a mode may fall from the onset until its stage begins.
const BACK_NEPERS: f64 = 1.5;
/// Factor by which a mode may fall faster while a stage is fitted.
const FASTER: f64 = 3.0;
/// Part of the places left that a stage but the last may take.
const PLACES: f64 = 0.45;
/// A stage needs this many samples.
const SHORTEST: usize = 2048;
/// Places of a level before it is refined, over those of its stage.
const UNREFINED: f64 = 1.5;
/// Most passes of the last stage over the levels, while there are places left.
const PASSES: usize = 2;
/// Steps of a joint refinement in a level, and of all at the end.
const LEVEL_STEPS: usize = 6;
const LAST_STEPS: usize = 8;
/// Most refinements of all at the end, each after second modes have gone.
const LAST_ROUNDS: usize = 6;
/// Miss of one mode of a resonance in a stage: 24 dB below it, so that all together miss less than
/// 18; a mode is proven whose amplitude is as large as its standard deviation.
const ROUNDS: Rounds = Rounds { most: 6, merged_loss: 0.004, proven: 1.0, steps: 3 };
/// A later stage adds nothing within so many half widths of a strong partial of the tail (within so
/// much of the strongest one's energy there) unless it falls so many times as fast, as the attack
/// does.
const HALF_WIDTHS: f64 = 3.0;
const STRONG: f64 = 0.01;
const OF_THE_ATTACK: f64 = 4.0;
/// Cost of a partial's own energy in a stage, and at the end.
const STAGE_ENERGY_COST: f64 = 1e-3;
const ENERGY_COST: f64 = 1e-4;

/// Analyses `segment`, which begins at the onset; `progress` gets the part done, 0 to 1.
pub fn analyse_from_the_tail(segment: &[f64], limits: &Limits, progress: &mut dyn FnMut(f64)) -> Analysis {
    let (mut tail, mut attack): (Vec<Partial>, Vec<Partial>) = (Vec::new(), Vec::new());
    let mut capped = false;
    for (i, from_s) in STAGES_S.into_iter().enumerate() {
        progress(i as f64 / STAGES_S.len() as f64);
        let start = (from_s * limits.rate_hz).round() as usize;
        if start > 0 && segment.len() < start + SHORTEST {
            continue;
        }
        let known = [tail.as_slice(), &attack].concat();
        let left = limits.max_partials.saturating_sub(known.len());
        let places = if start == 0 { left } else { (PLACES * left as f64) as usize };
        if places == 0 {
            continue;
        }
        let residual = subtract(segment, &known);
        let mut stage = Stage::new(&residual[start..], start, places, limits, &tail);
        stage.run();
        capped |= stage.capped && start == 0;
        if i == 0 {
            stage.one_mode_each();
        }
        if i == 0 { &mut tail } else { &mut attack }.extend(stage.at_onset());
    }
    attack.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    let bounds = Bounds { energy_cost: ENERGY_COST, ..limits.bounds };
    let target = subtract(segment, &tail);
    let strong = strong(&tail, segment.len());
    for _ in 0..LAST_ROUNDS {
        refine(&target, &mut attack, &bounds, LAST_STEPS);
        let before = attack.len();
        attack.retain(|p| !is_second(p, &strong));
        if attack.len() == before {
            break;
        }
    }
    one_mode_each(segment, &target, &tail, &mut attack, limits, &bounds);
    let mut partials = [tail, attack].concat();
    partials.extend(late_lines(segment, &partials, limits));
    partials.sort_by(|a, b| a.omega.total_cmp(&b.omega));
    let residual = subtract(segment, &partials);
    let noise = NoiseFloor::by_time(&residual, limits.rate_hz, limits.least_noise);
    progress(1.0);
    Analysis { partials, noise, residual, capped, explained: false }
}

/// Fit from one place on.
struct Stage<'a> {
    target: &'a [f64],
    start: usize,
    limits: Limits,
    places: usize,
    /// Strong partials of the tail, which are one mode each already.
    strong: Vec<Partial>,
    found: Vec<Partial>,
    capped: bool,
}

impl<'a> Stage<'a> {
    fn new(target: &'a [f64], start: usize, places: usize, limits: &Limits, tail: &[Partial]) -> Self {
        let mut limits = *limits;
        limits.bounds.energy_cost = STAGE_ENERGY_COST;
        if start > 0 {
            limits.bounds.delta_high = limits.bounds.delta_high.min(FASTER * BACK_NEPERS / start as f64);
        }
        let strong = strong(tail, target.len());
        Self { target, start, limits, places, strong, found: Vec::new(), capped: false }
    }

    fn run(&mut self) {
        for _ in 0..PASSES {
            for level in Level::ladder(self.target.len()) {
                self.level(level);
            }
            if self.start > 0 || self.found.len() >= self.places {
                break;
            }
        }
        self.leave_to_later_stages();
        // What is one resonance is one mode, and none is fainter than what all leave where it
        // sounds.
        ROUNDS.run(self.target, &mut self.found, &self.limits);
        self.leave_to_later_stages();
    }

    /// Makes one mode of what the tail has of one resonance: it is never looked at again.
    fn one_mode_each(&mut self) {
        one_mode_each(self.target, self.target, &[], &mut self.found, &self.limits, &self.limits.bounds);
    }

    /// Gives up what would grow by too much until the onset, and second modes of what the tail has.
    fn leave_to_later_stages(&mut self) {
        let strong = &self.strong;
        self.found.retain(|p| !is_second(p, strong));
        if self.start > 0 {
            let slow = BACK_NEPERS / self.start as f64;
            self.found.retain(|p| p.delta <= slow);
        }
    }

    /// Joins what one level proposes.
    fn level(&mut self, level: Level) {
        if !add_proposed(self.target, &mut self.found, level, &self.limits) {
            return;
        }
        self.keep((UNREFINED * self.places as f64) as usize);
        refine(self.target, &mut self.found, &self.limits.bounds, LEVEL_STEPS);
        self.capped |= self.keep(self.places);
    }

    /// Keeps the `most` that are heard best, and none below the level limit; says whether more were
    /// there.
    fn keep(&mut self, most: usize) -> bool {
        let count = self.target.len();
        let more = self.found.len() > most;
        keep_heard(&mut self.found, count, most, self.limits.rate_hz);
        let strongest = self.found.iter().map(|p| p.energy(count)).fold(0.0, f64::max);
        let least = strongest * self.limits.least_energy;
        self.found.retain(|p| p.energy(count) >= least);
        self.found.sort_by(|a, b| a.omega.total_cmp(&b.omega));
        more
    }

    /// The partials as the onset has them, none of them absurd there.
    fn at_onset(&self) -> Vec<Partial> {
        let early = self.found.iter().map(|p| p.moved(-(self.start as f64)));
        early.filter(|p| p.c.norm() <= self.limits.bounds.amplitude_high).collect()
    }
}

/// The partials of the tail that no later stage may double.
fn strong(tail: &[Partial], count: usize) -> Vec<Partial> {
    let most = tail.iter().map(|p| p.energy(count)).fold(0.0, f64::max);
    tail.iter().filter(|p| p.energy(count) > STRONG * most).copied().collect()
}

/// Tests whether a partial is a second mode of a resonance that the tail has.
fn is_second(partial: &Partial, strong: &[Partial]) -> bool {
    strong.iter().any(|of| {
        let near = (partial.omega - of.omega).abs() < HALF_WIDTHS * of.delta;
        near && partial.delta < OF_THE_ATTACK * of.delta
    })
}
