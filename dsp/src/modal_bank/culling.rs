//! Culling of inaudible modes: those that nobody can hear need not be computed, whatever the
//! distance.
//!
//! A mode goes when it starts more than `level_db` below the loudest, or when a louder mode that
//! lasts at least as long masks it all the time. Masking follows the tonal model of ISO/IEC
//! 11172-3, annex D.1 (psychoacoustic model 1), on Traunmüller's Bark scale: a masker of level L at
//! z hides
//!
//! ```text
//! L − 6.025 − 0.275 z + slope(Δz)         slope = 17 Δz − 0.4 L + 11   −3 ≤ Δz < −1
//!                                                 (0.4 L + 6) Δz       −1 ≤ Δz < 0
//!                                                 −17 Δz                0 ≤ Δz < 1
//!                                                 −17 − (Δz − 1)(17 − 0.15 L)   1 ≤ Δz < 8
//! ```
//! L needs a listening level: the loudest mode is put at [`Culling::loudest_db_spl`] (assumed).
//! Levels are those at the strike; since the masker decays no faster, the distance can only grow.
//! The figures of the standard are recalled, not copied from its text.

use crate::mode::Mode;

/// Limits of audibility.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
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

/// Marks in `keep` which modes are worth computing at `sample_rate_hz` and returns how many. Modes
/// at or above Nyquist go as well. Entries of `keep` beyond the modes are left alone.
///
/// The time is proportional to the modes: maskers are looked up in bands of a tenth of a Bark, each
/// of which remembers the loudest seen so far. Nothing audible goes for that; where modes are
/// sorted by [`super::sort_by_decay`] hardly anything masked stays, in another order more may.
pub fn audible(modes: &[Mode], sample_rate_hz: f64, culling: &Culling, keep: &mut [bool]) -> usize {
    let sounds = |mode: &Mode| mode.amplitude != 0.0 && mode.frequency_hz < 0.5 * sample_rate_hz;
    let loudest = modes.iter().filter(|m| sounds(m)).fold(0.0_f64, |a, m| a.max(m.amplitude.abs()));
    let level = |mode: &Mode| culling.loudest_db_spl + 20.0 * libm::log10(mode.amplitude.abs() / loudest);
    for (mode, keep) in modes.iter().zip(keep.iter_mut()) {
        *keep = sounds(mode) && level(mode) >= culling.loudest_db_spl - culling.level_db;
    }
    if culling.masking {
        let hide = |pass: &mut dyn Iterator<Item = (&Mode, &mut bool)>| {
            let mut maskers = Maskers::default();
            for (mode, keep) in pass.filter(|(mode, _)| sounds(mode)) {
                let tone = Tone {
                    level_db: level(mode),
                    bark: bark(mode.frequency_hz),
                    decay_per_s: mode.decay_per_s,
                };
                *keep = *keep && !maskers.hide(&tone);
                maskers.add(tone);
            }
        };
        // Maskers last at least as long; the second pass is for equally long ones further on.
        hide(&mut modes.iter().zip(keep.iter_mut()));
        let count = modes.len().min(keep.len());
        hide(&mut modes[..count].iter().zip(keep[..count].iter_mut()).rev());
    }
    keep.iter().take(modes.len()).filter(|keep| **keep).count()
}

/// A mode as the ear hears it.
#[derive(Debug, Clone, Copy)]
struct Tone {
    level_db: f64,
    bark: f64,
    decay_per_s: f64,
}

/// Bands in a Bark.
const BANDS_PER_BARK: f64 = 10.0;
/// Up to the end of the scale, 26.28 Bark.
const BANDS: usize = 270;

/// The loudest tone of every band. What a tone hides grows with its level, so a quieter one in the
/// same band hardly ever hides more.
struct Maskers([Option<Tone>; BANDS]);

impl Default for Maskers {
    fn default() -> Self {
        Self([None; BANDS])
    }
}

impl Maskers {
    fn band(bark: f64) -> usize {
        // The scale begins at −0.53.
        (((bark + 0.53) * BANDS_PER_BARK).max(0.0) as usize).min(BANDS - 1)
    }

    fn add(&mut self, tone: Tone) {
        let loudest = &mut self.0[Self::band(tone.bark)];
        if loudest.is_none_or(|known| known.level_db < tone.level_db) {
            *loudest = Some(tone);
        }
    }

    /// Tests whether a tone that lasts as long or longer hides this one.
    fn hide(&self, tone: &Tone) -> bool {
        // Maskers reach 8 Bark up and 3 down.
        let near = Self::band(tone.bark - 8.0)..=Self::band(tone.bark + 3.0);
        self.0[near].iter().flatten().any(|masker| {
            masker.decay_per_s <= tone.decay_per_s && tone.level_db < masked_below_db(masker, tone.bark)
        })
    }
}

/// The level below which a tone at `bark` is hidden.
fn masked_below_db(masker: &Tone, bark: f64) -> f64 {
    let Tone { level_db, bark: z, .. } = *masker;
    let dz = bark - z;
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
