//! Which modes of a body need not be computed because nobody can hear them, whatever the distance.
//!
//! A mode goes when it starts more than `level_db` below the loudest, or when a louder mode that lasts at
//! least as long masks it all the time. Masking follows the tonal model of ISO/IEC 11172-3, annex D.1
//! (psychoacoustic model 1), on Traunmüller's Bark scale: a masker of level L at z hides
//!
//! ```text
//! L − 6.025 − 0.275 z + slope(Δz)         slope = 17 Δz − 0.4 L + 11   −3 ≤ Δz < −1
//!                                                 (0.4 L + 6) Δz       −1 ≤ Δz < 0
//!                                                 −17 Δz                0 ≤ Δz < 1
//!                                                 −17 − (Δz − 1)(17 − 0.15 L)   1 ≤ Δz < 8
//! ```
//! L needs a listening level: the loudest mode is put at [`Culling::loudest_db_spl`] (assumed). Levels
//! are those at the strike; since the masker decays no faster, the distance can only grow. The figures of
//! the standard are recalled, not copied from its text.

use crate::mode::Mode;

/// What counts as inaudible.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Culling {
    /// Modes that start further below the loudest are dropped, dB. Infinite: none.
    pub level_db: f64,
    /// Drop modes that a louder, longer one masks.
    pub masking: bool,
    /// Sound pressure level given to the loudest mode, dB.
    pub loudest_db_spl: f64,
}

impl Culling {
    /// Only what starts 120 dB below the loudest, which no reproduction can show.
    pub const NEGLIGIBLE: Self = Self { level_db: 120.0, masking: false, loudest_db_spl: 80.0 };
}

impl Default for Culling {
    /// 80 dB, with masking, at 80 dB SPL (assumed: a loud but comfortable object).
    fn default() -> Self {
        Self { level_db: 80.0, masking: true, loudest_db_spl: 80.0 }
    }
}

/// Marks in `keep` which modes are worth computing at `sample_rate_hz` and returns how many. Modes at or
/// above Nyquist go as well. Entries of `keep` beyond the modes are left alone.
pub fn audible(modes: &[Mode], sample_rate_hz: f64, culling: &Culling, keep: &mut [bool]) -> usize {
    let sounds = |mode: &Mode| mode.amplitude != 0.0 && mode.frequency_hz < 0.5 * sample_rate_hz;
    let loudest = modes.iter().filter(|m| sounds(m)).fold(0.0_f64, |a, m| a.max(m.amplitude.abs()));
    let level = |mode: &Mode| culling.loudest_db_spl + 20.0 * libm::log10(mode.amplitude.abs() / loudest);
    let mut count = 0;
    for (mode, keep) in modes.iter().zip(keep.iter_mut()) {
        *keep = sounds(mode) && level(mode) >= culling.loudest_db_spl - culling.level_db;
        if *keep && culling.masking {
            let masks = |other: &Mode| {
                sounds(other)
                    && other.decay_per_s <= mode.decay_per_s
                    && level(mode) < masked_below_db(level(other), other.frequency_hz, mode.frequency_hz)
            };
            *keep = !modes.iter().any(masks);
        }
        count += usize::from(*keep);
    }
    count
}

/// The level below which a tone at `probe_hz` is hidden by one of `level_db` at `masker_hz`.
fn masked_below_db(level_db: f64, masker_hz: f64, probe_hz: f64) -> f64 {
    let z = bark(masker_hz);
    let dz = bark(probe_hz) - z;
    let slope = match dz {
        dz if (-3.0..-1.0).contains(&dz) => 17.0 * dz - 0.4 * level_db + 11.0,
        dz if (-1.0..0.0).contains(&dz) => (0.4 * level_db + 6.0) * dz,
        dz if (0.0..1.0).contains(&dz) => -17.0 * dz,
        dz if (1.0..8.0).contains(&dz) => -17.0 - (dz - 1.0) * (17.0 - 0.15 * level_db),
        _ => return f64::NEG_INFINITY,
    };
    level_db - 6.025 - 0.275 * z + slope
}

/// Critical-band rate (Traunmüller 1990).
fn bark(frequency_hz: f64) -> f64 {
    26.81 * frequency_hz / (1960.0 + frequency_hz) - 0.53
}
