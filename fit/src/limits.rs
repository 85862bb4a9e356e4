//! Limits of an analysis.

use crate::refinement::Bounds;

/// What bounds an analysis, in units of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Bounds of every parameter.
    pub bounds: Bounds,
    /// Most partials.
    pub max_partials: usize,
    /// Partials whose energy lies further than this below the strongest are dropped, as a ratio.
    pub least_energy: f64,
    /// Threads to use.
    pub threads: usize,
    /// Sample rate, for the width of the noise estimate.
    pub rate_hz: f64,
    /// Least noise variance (quantisation, rounding).
    pub least_noise: f64,
}
