//! Masking: which of a body's modes nobody would miss first, by a published model of what hides a
//! tone.
//!
//! ```text
//! level      L_m(t) = L₀ + 20 lg(a_m / a_max) − 8.686 d_m t              after a strike; L₀: the loudest mode's, dB SPL
//!            L_m = L₀ + 20 lg((a_m/√d_m) / (a/√d)_max)                    under a stroke, a steady force without pitch
//! excitation of L at e_m on e:  L − 27 (e_m − e)                          e < e_m
//!                               L − 0.9 (24 − 0.2 (L − 40)) (e − e_m)     e ≥ e_m      at least 5 dB an ERB
//! hidden     L_m + safety ≤ 10 lg(Σ_others 10^(E/10)) − 10, or ≤ the threshold in quiet, at each time and under a stroke
//! ```
//!
//! | symbol | here | source |
//! |---|---|---|
//! | e | ERB number, 21.4 lg(1 + 0.00437 f) | Glasberg & Moore 1990 |
//! | slopes | 27 dB an ERB down, level-dependent up | Terhardt 1979 (in Bark), 0.9 Bark an ERB |
//! | threshold in quiet | [`quiet_db_spl`] | Terhardt 1979 |
//! | −10 dB | a tone under a tone-like masker | **chosen**, between 6 (noise) and 18 dB (tones) of the published offsets |
//! | t | 0, 10, 30, 100, 300 and 1000 ms | **chosen** |
//!
//! Modes are taken away one by one, always the one that is furthest below what hides it, and those
//! that are left hide the others from then on. So what stays hidden is hidden by what is really
//! heard. The order is that of a level: at another one the slopes differ. A mode that is left out
//! is missing from the waveform all the same (10 to 22 dB below the whole on dense tables): the
//! claim is inaudible by this model at this level, not inaudible. The time grows with the square of
//! the number of modes.

use crate::mode::Mode;

/// Times after a strike at which levels are compared, s.
const TIMES_S: [f64; 6] = [0.0, 0.01, 0.03, 0.1, 0.3, 1.0];
/// Levels of those, and of a stroke.
const SOUNDS: usize = TIMES_S.len() + 1;
/// Distance that a tone must lie below the excitation of others, as a power: −10 dB.
const OFFSET: f64 = 0.1;
/// Slope of excitation towards lower frequencies, dB an ERB.
const DOWN_DB: f64 = 27.0;
/// Excitation below this hides nothing, dB SPL.
const NOTHING_DB: f64 = -40.0;
/// A mode is heard for sure, and hides others for good, where it is less than this below what hides
/// it, dB.
const SAFE_DB: f64 = 6.0;
/// Power of the quietest level that is told apart: −600 dB.
const LEAST: f64 = 1e-60;

/// A mode in the order of its importance. Made by [`perceptual_order`], which works in it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ranked {
    /// Its place among the modes that were given.
    pub index: usize,
    /// Distance of the mode below what hides it when all less important ones are gone, at the time
    /// when it sticks out most, dB; below zero it is heard.
    pub margin_db: f64,
    erb: f64,
    quiet: f64,
    level_db: [f64; SOUNDS],
    /// One over its power.
    quietness: [f64; SOUNDS],
    /// Excitation by the others where it is.
    excited: [f64; SOUNDS],
}

/// Ranks modes from the most to the least important, where the loudest starts at `loudest_db_spl`;
/// `order` has a place for each of them.
///
/// The time grows with the square of `most`: of more modes than that only those that stick out most
/// over the threshold in quiet are compared with each other, and the others follow behind, by how
/// far they stick out of what those excite that are heard.
///
/// ```
/// use asperity_dsp::masking::{Ranked, audible_count, perceptual_order};
/// use asperity_dsp::mode::Mode;
///
/// let mode = |frequency_hz, amplitude| Mode { frequency_hz, decay_per_s: 10.0, amplitude, phase_rad: 0.0 };
/// // The second is a fiftieth of its neighbour, the third too, but two octaves away.
/// let modes = [mode(1000.0, 1.0), mode(1020.0, 0.02), mode(4000.0, 0.02)];
/// let mut order = [Ranked::default(); 3];
/// perceptual_order(&modes, 70.0, modes.len(), &mut order);
/// assert_eq!(order.map(|ranked| ranked.index), [0, 2, 1]);
/// assert_eq!(audible_count(&order, 6.0), 2);
/// ```
pub fn perceptual_order(modes: &[Mode], loudest_db_spl: f64, most: usize, order: &mut [Ranked]) {
    let count = modes.len().min(order.len());
    let (modes, order) = (&modes[..count], &mut order[..count]);
    let loudest = |of: &dyn Fn(&Mode) -> f64| modes.iter().map(of).fold(f64::MIN_POSITIVE, f64::max);
    let loudest = [loudest(&|mode| mode.amplitude.abs()), loudest(&stroked)];
    for (index, (mode, ranked)) in modes.iter().zip(order.iter_mut()).enumerate() {
        *ranked = heard(mode, index, loudest, loudest_db_spl);
    }
    if count > most {
        sort(order, &|ranked| [ranked.hidden(), 0.0]);
    }
    let count = count.min(most);
    let (order, others) = order.split_at_mut(count);
    for from in 0..count {
        let source = order[from];
        for to in (0..count).filter(|to| *to != from) {
            excite(&source, &mut order[to], 1.0);
        }
    }
    let mut left = count;
    while left > 0 {
        let hidden = order[..left].iter().map(Ranked::hidden).enumerate();
        let Some((place, hidden)) = hidden.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
        left -= 1;
        order.swap(place, left);
        order[left].margin_db = 10.0 * libm::log10(hidden);
        let gone = order[left];
        order[..left].iter_mut().for_each(|other| excite(&gone, other, -1.0));
    }
    for heard in order.iter().filter(|ranked| ranked.margin_db < SAFE_DB) {
        others.iter_mut().for_each(|other| excite(heard, other, 1.0));
    }
    others.iter_mut().for_each(|ranked| ranked.margin_db = 10.0 * libm::log10(ranked.hidden()));
    sort(others, &|ranked| [ranked.margin_db, 0.0]);
}

/// Puts modes in the rising order of two keys, then in that in which they were given; allocates
/// nothing. It is compiled once, not for each way of sorting.
pub(crate) fn sort(order: &mut [Ranked], keys: &dyn Fn(&Ranked) -> [f64; 2]) {
    order.sort_unstable_by(|a, b| {
        let (of_a, of_b) = (keys(a), keys(b));
        of_a[0].total_cmp(&of_b[0]).then(of_a[1].total_cmp(&of_b[1])).then(a.index.cmp(&b.index))
    });
}

/// Number of modes of an order that are left when all that are `safety_db` below what hides them
/// are gone.
#[must_use]
pub fn audible_count(order: &[Ranked], safety_db: f64) -> usize {
    // From the least important on, until one is heard.
    order.len() - order.iter().rev().take_while(|ranked| ranked.margin_db >= safety_db).count()
}

impl Ranked {
    /// Excitation that hides it over its own power, where it sticks out most.
    fn hidden(&self) -> f64 {
        let sounds = self.excited.iter().zip(&self.quietness);
        sounds
            .map(|(excited, quietness)| (OFFSET * excited).max(self.quiet) * quietness)
            .fold(f64::INFINITY, f64::min)
    }
}

/// Response of a mode to a steady force.
fn stroked(mode: &Mode) -> f64 {
    mode.amplitude.abs() / libm::sqrt(mode.decay_per_s.max(1e-3))
}

fn heard(mode: &Mode, index: usize, loudest: [f64; 2], loudest_db_spl: f64) -> Ranked {
    let below_db = |strength: f64, loudest: f64| 20.0 * libm::log10((strength / loudest).max(1e-30));
    let struck_db = below_db(mode.amplitude.abs(), loudest[0]);
    let mut level_db = [loudest_db_spl + below_db(stroked(mode), loudest[1]); SOUNDS];
    for (level_db, time_s) in level_db.iter_mut().zip(TIMES_S) {
        *level_db = loudest_db_spl + struck_db - 8.686 * mode.decay_per_s * time_s;
    }
    Ranked {
        index,
        margin_db: 0.0,
        erb: erb_number(mode.frequency_hz),
        quiet: power(quiet_db_spl(mode.frequency_hz)),
        level_db,
        quietness: level_db.map(|level_db| 1.0 / power(level_db).max(LEAST)),
        excited: [0.0; SOUNDS],
    }
}

/// Adds what one mode excites where another is, or takes it away.
fn excite(from: &Ranked, to: &mut Ranked, times: f64) {
    // It grows with the level: where the loudest excites nothing, nothing does.
    let most_db = from.level_db[0].max(from.level_db[SOUNDS - 1]);
    if excitation_db(most_db, from.erb, to.erb) < NOTHING_DB {
        return;
    }
    for (excited, level_db) in to.excited.iter_mut().zip(from.level_db) {
        let db = excitation_db(level_db, from.erb, to.erb);
        if db >= NOTHING_DB {
            *excited = (*excited + times * power(db)).max(0.0);
        }
    }
}

/// ERB number of a frequency.
///
/// ```
/// use asperity_dsp::masking::erb_number;
///
/// // One ERB at 1 kHz is 132.6 Hz wide.
/// assert!((erb_number(1066.3) - erb_number(933.7) - 1.0).abs() < 0.01);
/// ```
#[must_use]
pub fn erb_number(frequency_hz: f64) -> f64 {
    21.4 * libm::log10(1.0 + 0.00437 * frequency_hz)
}

/// Level that a tone of `level_db` at one ERB number excites at another, dB.
#[must_use]
pub fn excitation_db(level_db: f64, from_erb: f64, at_erb: f64) -> f64 {
    if at_erb < from_erb {
        return level_db - DOWN_DB * (from_erb - at_erb);
    }
    let slope_db = 0.9 * (24.0 - 0.2 * (level_db - 40.0));
    level_db - slope_db.max(5.0) * (at_erb - from_erb)
}

/// Threshold in quiet, dB SPL.
#[must_use]
pub fn quiet_db_spl(frequency_hz: f64) -> f64 {
    let khz = frequency_hz.clamp(20.0, 20_000.0) / 1000.0;
    let ear_canal = khz - 3.3;
    3.64 * libm::pow(khz, -0.8) - 6.5 * libm::exp(-0.6 * ear_canal * ear_canal) + 1e-3 * khz * khz * khz * khz
}

/// Power of a level, dB.
fn power(level_db: f64) -> f64 {
    libm::exp(level_db * (core::f64::consts::LN_10 / 10.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use std::vec::Vec;

    fn mode(frequency_hz: f64, amplitude: f64) -> Mode {
        Mode { frequency_hz, decay_per_s: 5.0, amplitude, phase_rad: 0.0 }
    }

    fn ranked(modes: &[Mode]) -> Vec<Ranked> {
        let mut order = std::vec![Ranked::default(); modes.len()];
        perceptual_order(modes, 70.0, modes.len(), &mut order);
        order
    }

    #[test]
    fn the_threshold_in_quiet_and_the_scale_are_the_published_ones() {
        // Terhardt's curve: 3.4 dB at 1 kHz, lowest between 3 and 4 kHz; Glasberg and Moore: 15.6
        // ERB at 1 kHz.
        assert!((quiet_db_spl(1000.0) - 3.37).abs() < 0.02 && quiet_db_spl(3300.0) < -4.5);
        assert!((erb_number(1000.0) - 15.62).abs() < 0.02);
    }

    #[test]
    fn what_is_alone_is_never_hidden_and_what_nobody_hears_goes_first() {
        let order = ranked(&[mode(500.0, 1e-5), mode(2000.0, 1.0)]);
        assert_eq!([order[0].index, order[1].index], [1, 0]);
        assert_eq!(audible_count(&order, 6.0), 1);
        assert_eq!(audible_count(&ranked(&[mode(500.0, 1.0)]), 0.0), 1);
        assert!(ranked(&[]).is_empty());
    }

    /// The equations of the module's head, pair by pair in decibels, of seeded bodies.
    #[test]
    fn every_margin_is_that_of_the_equations_of_remaining_modes() {
        for seed in 1..=20 {
            let mut rng = Rng::new(seed);
            let modes: Vec<Mode> = (0..60)
                .map(|_| Mode {
                    frequency_hz: 60.0 * 250f64.powf(rng.uniform()),
                    decay_per_s: 1.0 + 80.0 * rng.uniform(),
                    amplitude: 10f64.powf(-3.0 * rng.uniform()),
                    phase_rad: 0.0,
                })
                .collect();
            let order = ranked(&modes);
            let mut seen: Vec<usize> = order.iter().map(|ranked| ranked.index).collect();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..60));
            let most = modes.iter().map(|mode| mode.amplitude).fold(0.0, f64::max);
            let most_stroked = modes.iter().map(|m| m.amplitude / m.decay_per_s.sqrt()).fold(0.0, f64::max);
            let level = |mode: &Mode, sound: usize| match TIMES_S.get(sound) {
                Some(t) => 70.0 + 20.0 * (mode.amplitude / most).log10() - 8.686 * mode.decay_per_s * t,
                None => 70.0 + 20.0 * (mode.amplitude / mode.decay_per_s.sqrt() / most_stroked).log10(),
            };
            for place in 0..60 {
                let own = &modes[order[place].index];
                let margin_db = (0..SOUNDS).map(|sound| {
                    let others = order[..place].iter().map(|other| &modes[other.index]);
                    let excited: f64 = others
                        .map(|m| {
                            let erbs = (erb_number(m.frequency_hz), erb_number(own.frequency_hz));
                            10f64.powf(0.1 * excitation_db(level(m, sound), erbs.0, erbs.1))
                        })
                        .sum();
                    (10.0 * excited.max(1e-30).log10() - 10.0).max(quiet_db_spl(own.frequency_hz))
                        - level(own, sound)
                });
                let margin_db = margin_db.fold(f64::INFINITY, f64::min);
                assert!(
                    (margin_db - order[place].margin_db).abs() < 1e-3,
                    "{seed}, {place}: {margin_db} and not {}",
                    order[place].margin_db
                );
            }
        }
    }
}
