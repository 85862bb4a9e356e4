//! The analysis of a segment that is a sum of modes in noise: levels from long to short, joint
//! refinement, proof, once more. It ends at the statistical bound; a segment that is no such sum is
//! told apart ([`crate::search::sum_of_modes`] before, [`Analysis::explained`] after) and left to
//! [`crate::ways::tail_to_attack`].
//!
//! Nothing of this is done where nothing rings ([`crate::proof::ringing`]).
//!
//! 1. Levels D = 512, 128, 32, 8, 2 (at 2 s and 44.1 kHz; the first leaves about 170 samples a
//!    band). At each: split what is unexplained into bands, take the poles of every band whose gate
//!    opens, join them to what is known, refit all jointly on the part of the segment after the
//!    level's span, and remove what is not proven. Long modes are thus known before short ones are
//!    looked for, and one window never has to suit both.
//! 2. Joint refinement over the whole segment, proof, refinement.
//! 3. The same on the residual, with the noise measured again in the residual, until nothing is
//!    added, or until what is there explains a segment that dies away and is far more than is kept.
//! 4. Proof once more where the noise is steep over frequency.

use crate::noise::noise_floor::NoiseFloor;
use crate::proof::pruning::{prune, prune_redundant, threshold};
use crate::proof::ringing::{anything_rings, is_steep_noise, standing_out};
use crate::proof::suspicion::energy_spectrum;
use crate::search::candidates::{SPAN_NEPERS, Search};
use crate::search::limits::Limits;
use crate::search::sub_band::Level;
use crate::sinusoid::amplitudes::{contributions, fit_amplitudes};
use crate::sinusoid::partial::Partial;
use crate::sinusoid::projection::synthesise;
use crate::sinusoid::refinement::refine;
use crate::ways::merging::merge_cancelling;
use std::f64::consts::PI;

/// A segment of so many times the energy that its quiet end has is one that dies away, and no
/// noise.
const DYING: f64 = 100.0;
/// Most passes over the levels.
const PASSES: usize = 3;
/// Accepted steps of a refinement within a level, after removals, and at the end.
const LEVEL_STEPS: usize = 3;
/// A residual with this many times the noise's power is no noise.
const MISFIT: f64 = 2.0;
/// Most rounds of merging and refitting.
const MERGING_ROUNDS: usize = 15;
/// Most rounds of one level.
const LEVEL_ROUNDS: usize = 3;
/// Until they are proven there may be this many times as many partials as are allowed in the end: a
/// hundred modes at 60 dB need 1.6 times the usual 150.
const UNPROVEN: f64 = 2.0;
/// Limit where fewer than `FEW` are asked for: then most recordings hold more than that, and the
/// sooner this shows the likelier the few are the same in every strike of one bell.
const UNPROVEN_FEW: f64 = 1.5;
const FEW: usize = 100;
const FINAL_STEPS: usize = 12;
/// Rounds of the last refinement of what is a sum of modes: until it has converged, which modes
/// closer than their bandwidths, whose valley is narrow and bent, may take long to.
const LAST_STEPS: usize = 200;

/// Result of an analysis.
#[derive(Debug, Clone)]
pub struct Analysis {
    /// The partials, amplitudes at the first sample of the segment.
    pub partials: Vec<Partial>,
    /// Noise measured in the residual.
    pub noise: NoiseFloor,
    /// Segment minus partials.
    pub residual: Vec<f64>,
    /// True where more was there than `max_partials` allowed.
    pub capped: bool,
    /// True where the partials leave no more than noise.
    pub explained: bool,
}

impl Analysis {
    /// Analysis of a segment in which nothing rings.
    pub(crate) fn nothing(segment: &[f64], noise: NoiseFloor) -> Self {
        Self { partials: Vec::new(), noise, residual: segment.to_vec(), capped: false, explained: true }
    }
}

/// Analyses `segment`; `progress` gets the part done, 0 to 1. What explains it is proven, but not
/// converged: [`settle`].
pub fn analyse(segment: &[f64], limits: &Limits, progress: &mut dyn FnMut(f64)) -> Analysis {
    let mut work = Work {
        segment,
        limits: *limits,
        noise: NoiseFloor::estimate(segment, limits.rate_hz, limits.least_noise),
        partials: Vec::new(),
        capped: false,
        missed: Vec::new(),
    };
    let band = (limits.bounds.omega_low, limits.bounds.omega_high);
    if !anything_rings(segment, band, limits.least_noise) {
        progress(1.0);
        return Analysis::nothing(segment, work.noise);
    }
    work.passes(progress);
    // Steep noise leaves more than a smooth floor until it is followed.
    if !work.capped {
        work.follow_tilt();
    }
    let explained = !work.capped && !work.leaves_more_than_noise();
    let residual = subtract(segment, &work.partials);
    progress(1.0);
    Analysis { partials: work.partials, noise: work.noise, residual, capped: work.capped, explained }
}

/// Refits what explains `segment` until it has converged, and merges what cancels.
pub fn settle(analysis: &mut Analysis, segment: &[f64], limits: &Limits) {
    if analysis.partials.is_empty() {
        return;
    }
    let mut work = Work {
        segment,
        limits: *limits,
        noise: analysis.noise.clone(),
        partials: std::mem::take(&mut analysis.partials),
        capped: analysis.capped,
        missed: Vec::new(),
    };
    work.settle(LAST_STEPS);
    for _ in 0..MERGING_ROUNDS {
        if merge_cancelling(segment, &mut work.partials, &work.limits.bounds) == 0 {
            break;
        }
        work.settle(FINAL_STEPS);
    }
    analysis.explained = !work.leaves_more_than_noise();
    analysis.residual = subtract(segment, &work.partials);
    analysis.partials = work.partials;
}

/// `signal` minus `partials`.
#[must_use]
pub fn subtract(signal: &[f64], partials: &[Partial]) -> Vec<f64> {
    let mut residual = synthesise(partials, signal.len());
    residual.iter_mut().zip(signal).for_each(|(r, s)| *r = s - *r);
    residual
}

struct Work<'a> {
    segment: &'a [f64],
    limits: Limits,
    noise: NoiseFloor,
    partials: Vec<Partial>,
    capped: bool,
    /// Poles that were tried without, and missed.
    missed: Vec<Partial>,
}

impl Work<'_> {
    /// All levels, joint refinement and proof, until nothing is added or more is there than may be.
    fn passes(&mut self, progress: &mut dyn FnMut(f64)) {
        let levels = Level::ladder(self.segment.len());
        let energy = self.segment.iter().map(|x| x * x).sum::<f64>();
        let dies_away = energy > DYING * self.noise.mean_variance() * self.segment.len() as f64;
        for pass in 0..PASSES {
            let known = self.partials.len();
            let mut added = 0;
            for (i, &level) in levels.iter().enumerate() {
                progress(0.9 * (pass * levels.len() + i) as f64 / (PASSES * levels.len()) as f64);
                added += self.level(level, pass > 0);
                if self.capped {
                    return;
                }
            }
            if pass > 0 && added == 0 {
                break;
            }
            self.settle(FINAL_STEPS);
            self.measure_noise();
            self.missed.clear();
            while self.prune_proven() > 0 {
                self.settle(LEVEL_STEPS);
            }
            if pass > 0 && self.partials.len() <= known {
                break;
            }
            if self.limits.far_more_than_kept(self.partials.len())
                && dies_away
                && !self.leaves_more_than_noise()
            {
                break;
            }
        }
        let mut partials = std::mem::take(&mut self.partials);
        self.cap(&mut partials, self.segment.len());
        self.partials = partials;
    }

    /// Tests whether the residual, within the band looked at, is more than what the quiet end of
    /// the segment has of noise. Steep noise that goes on as it began is noise, too, although no
    /// smooth floor explains it.
    fn leaves_more_than_noise(&self) -> bool {
        let residual = subtract(self.segment, &self.partials);
        if is_steep_noise(&residual, self.limits.rate_hz, self.limits.least_noise) {
            return false;
        }
        let quiet = NoiseFloor::estimate(&residual, self.limits.rate_hz, self.limits.least_noise);
        let spectrum = energy_spectrum(&residual);
        let omega = |k: usize| PI * k as f64 / spectrum.len() as f64;
        let bounds = &self.limits.bounds;
        let (mut left, mut noise) = (0.0, 0.0);
        for (k, energy) in spectrum.iter().enumerate() {
            if (bounds.omega_low..=bounds.omega_high).contains(&omega(k)) {
                left += energy;
                noise += quiet.variance_at(omega(k)) * residual.len() as f64 / spectrum.len() as f64;
            }
        }
        left > MISFIT * noise
    }

    /// Removes what only steep noise proves.
    fn follow_tilt(&mut self) {
        self.prune_by_tilt();
        let residual = subtract(self.segment, &self.partials);
        if !is_steep_noise(&residual, self.limits.rate_hz, self.limits.least_noise) {
            return;
        }
        let standing = standing_out(&residual, &self.partials, self.limits.least_noise);
        if standing.contains(&false) {
            let mut standing = standing.into_iter();
            self.partials.retain(|_| standing.next() != Some(false));
            self.settle(FINAL_STEPS);
            self.prune_by_tilt();
        }
    }

    /// Removes what is not proven against noise that is followed over parts of an octave.
    fn prune_by_tilt(&mut self) {
        loop {
            let residual = subtract(self.segment, &self.partials);
            self.measure_noise();
            self.noise = self.noise.clone().following(&residual);
            self.missed.clear();
            if self.prune_proven() == 0 {
                break;
            }
            self.settle(LEVEL_STEPS);
        }
    }

    /// Removes what the whole segment does not miss; says how many.
    fn prune_proven(&mut self) -> usize {
        let (noise, bounds) = (&self.noise, &self.limits.bounds);
        prune_redundant(self.segment, &mut self.partials, noise, bounds, &mut self.missed)
    }

    /// The noise as the residual shows it now.
    fn measure_noise(&mut self) {
        let residual = subtract(self.segment, &self.partials);
        self.noise = NoiseFloor::of_residual(&residual, self.limits.rate_hz, self.limits.least_noise);
    }

    /// Looks for new partials at one level and refits, again while strong ones hid weak ones; says
    /// how many it proposed. `whole`: refit over the whole segment, not only after the level's
    /// span.
    fn level(&mut self, level: Level, whole: bool) -> usize {
        let mut proposed = 0;
        for _ in 0..LEVEL_ROUNDS {
            let residual = subtract(self.segment, &self.partials);
            let search = Search::thorough(&self.limits, &self.noise);
            let (found, hidden) = search.candidates(level, &residual);
            if found.is_empty() {
                break;
            }
            proposed += found.len();
            self.join(&found, level.span(), if whole { 0 } else { level.span() });
            if !hidden || self.capped {
                break;
            }
        }
        proposed
    }

    /// Refits what is known together with `found` (amplitudes unknown) from sample `start` on.
    fn join(&mut self, found: &[Partial], span: usize, start: usize) {
        let offset = start as f64;
        let (alive, frozen): (Vec<Partial>, Vec<Partial>) =
            self.partials.iter().partition(|p| p.delta * offset < SPAN_NEPERS);
        let frozen_late: Vec<Partial> = frozen.iter().map(|p| p.moved(offset)).collect();
        let target = subtract(&self.segment[start..], &frozen_late);
        let mut active: Vec<Partial> = alive.iter().map(|p| p.moved(offset)).collect();
        active.extend(found);
        fit_amplitudes(&target, &mut active);
        if active.len() > self.unproven() {
            self.cap(&mut active, target.len());
        }
        self.drop_faint(&mut active, target.len(), self.unproven());
        let mut bounds = self.limits.bounds;
        if start > 0 {
            bounds.amplitude_high = f64::INFINITY;
            bounds.delta_high = bounds.delta_high.min(1.5 * SPAN_NEPERS / span as f64);
        }
        refine(&target, &mut active, &bounds, LEVEL_STEPS);
        while if start > 0 {
            prune(&mut active, &self.noise, target.len(), threshold(target.len()))
        } else {
            prune_redundant(&target, &mut active, &self.noise, &bounds, &mut self.missed)
        } > 0
        {
            refine(&target, &mut active, &bounds, LEVEL_STEPS);
        }
        self.cap(&mut active, target.len());
        self.partials = frozen;
        // What would have been absurdly loud at the start was over before the window.
        let early = active.iter().map(|p| p.moved(-offset));
        self.partials.extend(early.filter(|p| p.c.norm() <= self.limits.bounds.amplitude_high));
    }

    /// Joint refinement over the whole segment.
    fn settle(&mut self, steps: usize) {
        refine(self.segment, &mut self.partials, &self.limits.bounds, steps);
        let mut partials = std::mem::take(&mut self.partials);
        if self.drop_faint(&mut partials, self.segment.len(), self.unproven()) > 0 {
            refine(self.segment, &mut partials, &self.limits.bounds, steps);
        }
        self.partials = partials;
    }

    fn unproven(&self) -> usize {
        let most = self.limits.max_partials;
        (if most < FEW { UNPROVEN_FEW } else { UNPROVEN } * most as f64) as usize
    }

    /// No more proven partials than are allowed. Candidates are many, and no sign of it.
    fn cap(&mut self, partials: &mut Vec<Partial>, count: usize) {
        let most = self.limits.max_partials;
        if partials.len() > most {
            self.capped = true;
            self.drop_faint(partials, count, most);
        }
    }

    /// Keeps the `most` strongest by energy, within the level limit; says how many went.
    fn drop_faint(&self, partials: &mut Vec<Partial>, count: usize, most: usize) -> usize {
        let before = partials.len();
        if partials.len() > most {
            let worth = contributions(partials, count);
            let mut ranked: Vec<(f64, Partial)> = worth.into_iter().zip(partials.drain(..)).collect();
            ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
            partials.extend(ranked.into_iter().take(most).map(|(_, p)| p));
        }
        let strongest = partials.iter().map(|p| p.energy(count)).fold(0.0, f64::max);
        if strongest > 0.0 {
            partials.retain(|p| p.energy(count) >= strongest * self.limits.least_energy);
        }
        partials.sort_by(|a, b| a.omega.total_cmp(&b.omega));
        before - partials.len()
    }
}
