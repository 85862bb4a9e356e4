//! Order of modes by a published masking model: which of a body's modes nobody would miss first.
//!
//! ```text
//! level      L_m(t) = L₀ + 20 lg(a_m / a_max) − 8.686 d_m t              L₀: the loudest mode's, dB SPL
//! excitation of L at e_m on e:  L − 27 (e_m − e)                          e < e_m
//!                               L − 0.9 (24 − 0.2 (L − 40)) (e − e_m)     e ≥ e_m      at least 5 dB an ERB
//! hidden     L_m(t) + safety ≤ 10 lg(Σ_others 10^(E/10)) − 10, or ≤ the threshold in quiet; at t = 0, 10, 30, 100, 300 and 1000 ms
//! ```
//!
//! | symbol | here | source |
//! |---|---|---|
//! | e | ERB number, 21.4 lg(1 + 0.00437 f) | Glasberg & Moore 1990 |
//! | slopes | 27 dB an ERB down, level-dependent up | Terhardt 1979 (in Bark), 0.9 Bark an ERB |
//! | threshold in quiet | `quiet_db_spl` | Terhardt 1979 |
//! | −10 dB | a tone under a tone-like masker | **chosen**, between 6 (noise) and 18 dB (tones) of the published offsets |
//!
//! Modes are taken away one by one, always the one that is furthest below what hides it, and those that are left hide the others from
//! then on. So what stays hidden is hidden by what is really heard. The order is that of a level: at another one the slopes differ.
//! A mode that is left out is missing from the waveform all the same (10 to 22 dB below the whole on dense tables): the claim is inaudible by
//! this model at this level, not inaudible.

use asperity_dsp::mode::Mode;

/// When levels are compared, s.
const TIMES_S: [f64; 6] = [0.0, 0.01, 0.03, 0.1, 0.3, 1.0];
/// How far below the excitation of others a tone must lie, dB.
const OFFSET_DB: f64 = 10.0;
/// Slope of excitation towards lower frequencies, dB an ERB.
const DOWN_DB: f64 = 27.0;

/// A mode in the order of its importance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ranked {
    /// Its place among the modes that were given.
    pub index: usize,
    /// How far below what hides it the mode is when all less important ones are gone, at the time when it sticks out most, dB; below
    /// zero it is heard.
    pub margin_db: f64,
}

/// Modes from the most to the least important, where the loudest starts at `loudest_db_spl`.
///
/// The time grows with the square of the number of modes.
///
/// ```
/// use asperity_dsp::mode::Mode;
/// use asperity_fit::after::masking::{audible_count, perceptual_order};
///
/// let mode = |frequency_hz, amplitude| Mode { frequency_hz, decay_per_s: 10.0, amplitude, phase_rad: 0.0 };
/// // The second is a fiftieth of its neighbour, the third too, but two octaves away.
/// let modes = [mode(1000.0, 1.0), mode(1020.0, 0.02), mode(4000.0, 0.02)];
/// let order = perceptual_order(&modes, 70.0);
/// assert_eq!(order.iter().map(|ranked| ranked.index).collect::<Vec<_>>(), [0, 2, 1]);
/// assert_eq!(audible_count(&order, 6.0), 2);
/// ```
#[must_use]
#[expect(clippy::needless_range_loop, reason = "indices are those of the equations")]
pub fn perceptual_order(modes: &[Mode], loudest_db_spl: f64) -> Vec<Ranked> {
    let loudest = modes.iter().fold(0.0f64, |most, mode| most.max(mode.amplitude.abs()));
    let level = |mode: &Mode, t: f64| {
        let strength = (mode.amplitude.abs() / loudest.max(f64::MIN_POSITIVE)).max(1e-30);
        loudest_db_spl + 20.0 * strength.log10() - 8.686 * mode.decay_per_s * t
    };
    let erbs: Vec<f64> = modes.iter().map(|mode| erb_number(mode.frequency_hz)).collect();
    let levels: Vec<[f64; 6]> = modes.iter().map(|mode| TIMES_S.map(|t| level(mode, t))).collect();
    let quiet: Vec<f64> = modes.iter().map(|mode| quiet_db_spl(mode.frequency_hz)).collect();
    let reach =
        |from: usize, to: usize, time: usize| power(excitation_db(levels[from][time], erbs[from], erbs[to]));
    // What the others excite at each mode.
    let mut excited: Vec<[f64; 6]> = (0..modes.len())
        .map(|to| {
            [0, 1, 2, 3, 4, 5].map(|time| {
                (0..modes.len()).filter(|from| *from != to).map(|from| reach(from, to, time)).sum()
            })
        })
        .collect();
    let margin_db = |index: usize, excited: &[f64; 6]| {
        (0..TIMES_S.len())
            .map(|time| {
                let hidden_db = (10.0 * excited[time].max(1e-30).log10() - OFFSET_DB).max(quiet[index]);
                hidden_db - levels[index][time]
            })
            .fold(f64::INFINITY, f64::min)
    };
    let mut left: Vec<usize> = (0..modes.len()).collect();
    let mut order = Vec::with_capacity(modes.len());
    while !left.is_empty() {
        let margins = left.iter().map(|index| margin_db(*index, &excited[*index]));
        let furthest = margins.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((place, margin_db)) = furthest else { break };
        let gone = left.swap_remove(place);
        order.push(Ranked { index: gone, margin_db });
        for to in &left {
            for time in 0..TIMES_S.len() {
                excited[*to][time] = (excited[*to][time] - reach(gone, *to, time)).max(0.0);
            }
        }
    }
    order.reverse();
    order
}

/// How many modes of an order are left when all that are `safety_db` below what hides them are gone.
#[must_use]
pub fn audible_count(order: &[Ranked], safety_db: f64) -> usize {
    // From the least important on, until one is heard.
    order.len() - order.iter().rev().take_while(|ranked| ranked.margin_db >= safety_db).count()
}

/// ERB number of a frequency.
#[must_use]
pub fn erb_number(frequency_hz: f64) -> f64 {
    21.4 * (1.0 + 0.00437 * frequency_hz).log10()
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
    3.64 * khz.powf(-0.8) - 6.5 * (-0.6 * (khz - 3.3).powi(2)).exp() + 1e-3 * khz.powi(4)
}

/// Of a level, dB.
fn power(level_db: f64) -> f64 {
    10f64.powf(0.1 * level_db)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_threshold_in_quiet_and_the_scale_are_the_published_ones() {
        // Terhardt's curve: 3.4 dB at 1 kHz, lowest between 3 and 4 kHz; Glasberg and Moore: 15.6 ERB at 1 kHz.
        assert!((quiet_db_spl(1000.0) - 3.37).abs() < 0.02 && quiet_db_spl(3300.0) < -4.5);
        assert!((erb_number(1000.0) - 15.62).abs() < 0.02);
    }

    #[test]
    fn what_is_alone_is_never_hidden_and_what_nobody_hears_goes_first() {
        let mode =
            |frequency_hz, amplitude| Mode { frequency_hz, decay_per_s: 5.0, amplitude, phase_rad: 0.0 };
        let order = perceptual_order(&[mode(500.0, 1e-5), mode(2000.0, 1.0)], 70.0);
        assert_eq!([order[0].index, order[1].index], [1, 0]);
        assert_eq!(audible_count(&order, 6.0), 1);
        assert_eq!(audible_count(&perceptual_order(&[mode(500.0, 1.0)], 70.0), 0.0), 1);
        assert!(perceptual_order(&[], 70.0).is_empty());
    }
}
