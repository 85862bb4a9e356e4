//! Rounds that every search over levels repeats: a level's proposals join what is found, and what
//! is found becomes one mode a resonance, each proven.

use crate::noise::noise_floor::NoiseFloor;
use crate::proof::pruning::prune;
use crate::search::candidates::Search;
use crate::search::limits::Limits;
use crate::search::sub_band::Level;
use crate::sinusoid::amplitudes::fit_amplitudes;
use crate::sinusoid::partial::Partial;
use crate::sinusoid::refinement::refine;
use crate::ways::analysis::subtract;
use crate::ways::merging::merge_resonances;

/// Adds what one level sees in `signal` beside the partials that are `found`, all amplitudes fitted
/// anew; says whether there was anything.
pub(super) fn add_proposed(signal: &[f64], found: &mut Vec<Partial>, level: Level, limits: &Limits) -> bool {
    let residual = subtract(signal, found);
    let noise = NoiseFloor::of_residual(&residual, limits.rate_hz, limits.least_noise);
    let (proposed, _) = Search::strongest(limits, &noise).candidates(level, &residual);
    if proposed.is_empty() {
        return false;
    }
    found.extend(proposed);
    fit_amplitudes(signal, found);
    true
}

/// Rules by which partials are one resonance, and are proven.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounds {
    /// At most so many.
    pub most: usize,
    /// Part of a resonance's energy that its one mode may miss.
    pub merged_loss: f64,
    /// The Wald statistic of the faintest mode.
    pub proven: f64,
    /// Steps of a joint refinement after removals.
    pub steps: usize,
}

impl Rounds {
    /// Merges and prunes until nothing goes any more.
    pub fn run(&self, signal: &[f64], found: &mut Vec<Partial>, limits: &Limits) {
        for _ in 0..self.most {
            let merged = merge_resonances(signal, found, &limits.bounds, self.merged_loss);
            let residual = subtract(signal, found);
            let noise = NoiseFloor::by_time(&residual, limits.rate_hz, limits.least_noise);
            if prune(found, &noise, signal.len(), self.proven) + merged == 0 {
                break;
            }
            refine(signal, found, &limits.bounds, self.steps);
        }
    }
}
