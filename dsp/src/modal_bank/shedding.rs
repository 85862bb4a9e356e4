//! Shedding: in which order a body's modes stand, so that a machine that is too slow leaves out those that nobody would miss.
//!
//! ```text
//! groups that hear at level k:  G − ⌊G k/5⌋, at least one          k = 0 … 4
//! modes between two levels:     by importance (masking), and among themselves by how long they ring
//! ```
//!
//! Importance is that of [`crate::masking`] with the loudest mode at [`LOUDEST_DB_SPL`]. Within a level what rings longest comes first, so that the
//! groups that still ring are the first ones as far as the levels allow. Of a body with more than [`RANKED`] modes those that stick out most over
//! the threshold in quiet are ranked, and the others stand behind them.

use super::{LANES, ringing_s};
use crate::masking::{Ranked, perceptual_order};
use crate::mode::Mode;

/// Levels of modes left out, from none.
pub const MODE_LEVELS: usize = 5;

/// Sound pressure level of the loudest mode for which the order is made, dB: speech at one metre, and where dense tables were compared.
pub const LOUDEST_DB_SPL: f64 = 70.0;

/// Modes that are ranked by what hides them: the time grows with their square.
pub const RANKED: usize = 600;

/// How many of a body's groups hear what strikes it at a level of modes left out.
#[must_use]
pub fn groups_at(mode_level: usize, groups: usize) -> usize {
    groups - (groups * mode_level / MODE_LEVELS).min(groups.saturating_sub(1))
}

/// Puts modes in the order in which a bank is best built of them, where impulses of about `impulse_n_s` strike it. `order` has a place
/// for each.
pub fn shedding_order(modes: &[Mode], impulse_n_s: f64, order: &mut [Ranked]) {
    let count = modes.len().min(order.len());
    let (modes, order) = (&modes[..count], &mut order[..count]);
    perceptual_order(modes, LOUDEST_DB_SPL, RANKED, order);
    let groups = count.div_ceil(LANES);
    let rings = |ranked: &Ranked| ringing_s(&modes[ranked.index], impulse_n_s);
    let mut from = 0;
    for level in (0..MODE_LEVELS).rev() {
        let until = (groups_at(level, groups) * LANES).min(count);
        if from < until {
            order[from..until]
                .sort_unstable_by(|a, b| rings(b).total_cmp(&rings(a)).then(a.index.cmp(&b.index)));
            from = until;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use std::vec::Vec;

    fn body(count: usize) -> Vec<Mode> {
        let mut rng = Rng::new(3);
        let mode = |_| Mode {
            frequency_hz: 60.0 * 250f64.powf(rng.uniform()),
            decay_per_s: 1.0 + 80.0 * rng.uniform(),
            amplitude: 10f64.powf(-3.0 * rng.uniform()),
            phase_rad: 0.0,
        };
        (0..count).map(mode).collect()
    }

    #[test]
    fn what_each_level_leaves_out_is_what_the_masking_model_misses_least() {
        for count in [1, 15, 16, 17, 100, 349] {
            let modes = body(count);
            let (mut by_need, mut order) =
                (std::vec![Ranked::default(); count], std::vec![Ranked::default(); count]);
            perceptual_order(&modes, LOUDEST_DB_SPL, count, &mut by_need);
            shedding_order(&modes, 1e-4, &mut order);
            let groups = count.div_ceil(LANES);
            for level in 0..MODE_LEVELS {
                let kept = (groups_at(level, groups) * LANES).min(count);
                let set = |order: &[Ranked]| {
                    let mut set: Vec<usize> = order[..kept].iter().map(|ranked| ranked.index).collect();
                    set.sort_unstable();
                    set
                };
                assert_eq!(set(&order), set(&by_need), "{count} modes, level {level}");
            }
        }
    }

    #[test]
    fn a_body_of_thousands_of_modes_is_ordered_with_what_nobody_hears_last() {
        let mut modes = body(3000);
        modes[1234].amplitude = 1e-9;
        let mut order = std::vec![Ranked::default(); 3000];
        perceptual_order(&modes, LOUDEST_DB_SPL, RANKED, &mut order);
        assert_eq!(order[2999].index, 1234);
        let mut seen: Vec<usize> = order.iter().map(|ranked| ranked.index).collect();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..3000));
    }

    /// Group-seconds that a bank in this order is awake after one strike: groups sleep from the end of each section.
    fn awake_s(modes: &[Mode], order: &[usize], sections: usize, impulse_n_s: f64) -> f64 {
        let groups: Vec<f64> = order
            .chunks(LANES)
            .map(|group| {
                group.iter().map(|index| ringing_s(&modes[*index], impulse_n_s).max(0.0)).fold(0.0, f64::max)
            })
            .collect();
        let (mut from, mut sum) = (0, 0.0);
        for level in (0..sections).rev() {
            let until = groups_at(level, groups.len());
            let mut until_s = 0.0;
            for end_s in groups[from..until].iter().rev() {
                until_s = f64::max(until_s, *end_s);
                sum += until_s;
            }
            from = until;
        }
        sum
    }

    #[test]
    fn a_struck_body_in_the_order_of_need_is_awake_at_most_twice_as_long_as_in_that_of_ringing() {
        for count in [48, 100, 256, 349] {
            let modes = body(count);
            let mut order = std::vec![Ranked::default(); count];
            shedding_order(&modes, 1e-4, &mut order);
            let mut by_ringing: Vec<usize> = (0..count).collect();
            by_ringing.sort_by(|a, b| ringing_s(&modes[*b], 1e-4).total_cmp(&ringing_s(&modes[*a], 1e-4)));
            for impulse_n_s in [1e-6, 1e-4, 1e-2] {
                let own: Vec<usize> = order.iter().map(|ranked| ranked.index).collect();
                let ratio = awake_s(&modes, &own, MODE_LEVELS, impulse_n_s)
                    / awake_s(&modes, &by_ringing, 1, impulse_n_s);
                std::println!("{count} modes, {impulse_n_s} N·s: {ratio:.2}");
                assert!(ratio < 2.0, "{count} modes, {impulse_n_s} N·s: {ratio}");
            }
        }
    }
}
