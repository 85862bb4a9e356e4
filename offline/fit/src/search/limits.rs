//! Limits of an analysis.

use crate::options::{FitOptions, LARGEST_AMPLITUDE};
use crate::recording::Recording;
use crate::sinusoid::refinement::Bounds;
use std::f64::consts::PI;

/// Slowest decay that may be asked for as the fastest, 1/s: T60 = 60 s.
pub(crate) const LEAST_DECAY_PER_S: f64 = 0.115;
/// Lowest frequency analysed unless a lower one is asked for, Hz.
const LOWEST_HZ: f64 = 20.0;
/// A mode that falls by more nepers than this during the contact is not known at the onset: it is
/// part of the attack.
const BACK_NEPERS: f64 = 1.5;
/// Nothing so far below the strongest mode's energy is looked for, dB.
const FAINTEST_DB: f64 = -90.0;
/// Factor of what is kept that is far more: which of them are audible is decided before the last of
/// them are found and all have converged (a tile in a room, of whose 84 or 111 modes 32 may be
/// kept).
const FAR_MORE: usize = 2;

/// Bounds of an analysis, in units of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Bounds of every parameter.
    pub bounds: Bounds,
    /// Most partials.
    pub max_partials: usize,
    /// Most of these that are kept.
    pub kept: usize,
    /// Partials whose energy lies further than this below the strongest are dropped, as a ratio.
    pub least_energy: f64,
    /// Threads to use.
    pub threads: usize,
    /// Sample rate, for the width of the noise estimate.
    pub rate_hz: f64,
    /// Least noise variance (quantisation, rounding).
    pub least_noise: f64,
}

impl Limits {
    /// Tests whether `partials` are so many that most will not be kept.
    pub(crate) fn far_more_than_kept(&self, partials: usize) -> bool {
        partials > FAR_MORE * self.kept
    }

    /// Bounds of the analysis of `segment`, which begins `offset` samples after the onset.
    pub(crate) fn of(segment: &[f64], offset: usize, recording: &Recording, options: &FitOptions) -> Self {
        let rate = recording.sample_rate_hz;
        let peak = segment.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        // Modes outside the band are found as well, or what they leave would be taken for noise in
        // it.
        let low = options.band_hz.0.min(LOWEST_HZ);
        Self {
            bounds: Bounds {
                omega_low: 2.0 * PI * low.max(1.0) / rate,
                omega_high: 2.0 * PI * 0.49,
                // An undamped tone is fitted as it is; what is written down must die some day
                // (`suspicion`).
                delta_low: 1e-3 * LEAST_DECAY_PER_S / rate,
                delta_high: (options.fastest_decay_per_s / rate).min(BACK_NEPERS / offset.max(1) as f64),
                amplitude_high: LARGEST_AMPLITUDE * peak,
                energy_cost: 0.0,
            },
            max_partials: options.max_modes,
            kept: options.max_modes,
            least_energy: 10.0_f64.powf(0.1 * options.least_level_db.min(FAINTEST_DB)),
            threads: match options.threads {
                0 => std::thread::available_parallelism().map_or(1, |n| n.get().min(8)),
                n => n,
            },
            rate_hz: rate,
            // Rounding of the file, and of what rendered it: 120 dB under the peak.
            least_noise: (recording.quantum.powi(2) / 12.0).max(1e-12 * peak * peak),
        }
    }
}
