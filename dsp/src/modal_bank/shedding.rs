//! Shedding: in which order a body's modes stand, so that a machine that is too slow leaves out
//! those that nobody would miss.
//!
//! ```text
//! groups that hear at level 1:  ⌈A(S) / 16⌉, at most G − ⌊2 G / 5⌋, at least one
//! A(S)                          modes that are left when all that are S = 6 dB or more below what hides them are gone (masking)
//! modes on one side of a level: by importance (masking), and among themselves by how long they ring
//! ```
//!
//! Importance is that of [`crate::masking`]. Where tables are dense the level leaves out most of
//! the work inaudibly (5 of 16 groups are left, 59 % of the bank's time is saved). Where
//! nothing hides anything it still takes two fifths, because a machine that is late has to be
//! helped. Where that is more than the model hides, what is heard goes on by the model, or by how
//! long it rings, whichever keeps more of the power: where the loudest stand close the model hides
//! each by the others until most are gone (256 modes of equal spacing, struck: −6.3 dB), and where
//! weak ones are spread it keeps more. A finer ladder saved nothing: levels of 0, −6 and −12 dB
//! took 4, 3 and 3 of those 16 groups where this one takes 5. Of a body with more than [`RANKED`]
//! modes those that stick out most over the threshold in quiet are ranked, and the others stand
//! behind them, hidden by those or not.

use super::{LANES, ringing_s};
use crate::masking::{self, Ranked, audible_count, perceptual_order};
use crate::mode::Mode;

/// Levels of modes left out: none, and what is not missed.
pub const MODE_LEVELS: usize = 2;

/// Sound pressure level of the loudest mode where it is unknown, dB: speech at one metre, and
/// where dense tables were compared.
pub const LOUDEST_DB_SPL: f64 = 70.0;

/// Distance of a mode below what hides it that goes at each level, dB.
pub const SAFETY_DB: [f64; MODE_LEVELS] = [f64::INFINITY, 6.0];

/// Modes that are ranked by what hides them: the time grows with their square.
pub const RANKED: usize = 512;

/// Number of leading groups that are driven at each level of modes left out.
pub type SheddingLevels = [usize; MODE_LEVELS];

/// The most groups that hear at a level.
const fn most_at(level: usize, groups: usize) -> usize {
    if level == 0 { groups } else { groups - 2 * groups / 5 }
}

/// Puts modes in the order in which a bank is best built of them, where impulses of about
/// `impulse_n_s` strike it and the loudest mode is at `loudest_db_spl`; returns how many groups of
/// it hear at each level. `order` has a place for each mode.
///
/// A body of one group stays in the order of ringing.
pub fn shedding_order(
    modes: &[Mode],
    impulse_n_s: f64,
    loudest_db_spl: f64,
    order: &mut [Ranked],
) -> SheddingLevels {
    let count = modes.len().min(order.len());
    let (modes, order) = (&modes[..count], &mut order[..count]);
    let groups = count.div_ceil(LANES);
    let mut levels = [groups; MODE_LEVELS];
    let rings = |ranked: &Ranked| ringing_s(&modes[ranked.index], impulse_n_s);
    let by_ringing = |ranked: &Ranked| [-rings(ranked), modes[ranked.index].frequency_hz];
    if groups > 1 {
        perceptual_order(modes, loudest_db_spl, RANKED, order);
        let needed = audible_count(order, SAFETY_DB[1]).div_ceil(LANES).max(1);
        levels[1] = needed.min(most_at(1, groups)).max(1);
        let (all, kept) = ((needed * LANES).min(count), (levels[1] * LANES).min(count));
        if levels[1] < needed && ringing_keeps_more(modes, &order[..all], kept, rings) {
            masking::sort(&mut order[..all], &by_ringing);
        }
    } else {
        order.iter_mut().enumerate().for_each(|(index, ranked)| ranked.index = index);
    }
    let mut from = 0;
    for kept in levels.iter().rev() {
        let until = (kept * LANES).min(count);
        if let Some(section) = order.get_mut(from..until) {
            masking::sort(section, &by_ringing);
        }
        from = until;
    }
    levels
}

/// Tests whether the `kept` modes that ring longest hold more than the first `kept`: of a strike's
/// power and of a stroke's, whichever suffers more.
fn ringing_keeps_more(modes: &[Mode], among: &[Ranked], kept: usize, rings: impl Fn(&Ranked) -> f64) -> bool {
    let holds = |of: &mut dyn Iterator<Item = &Ranked>| {
        of.fold([0.0; 2], |[struck, stroked], ranked| {
            let Mode { amplitude, decay_per_s, .. } = modes[ranked.index];
            let power = amplitude * amplitude;
            [struck + power, stroked + power / decay_per_s.max(1e-3)]
        })
    };
    // The time beyond which a mode is kept: found by halving.
    let (mut low, mut high) = (-1e9, 1e9);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if among.iter().filter(|ranked| rings(ranked) > middle).count() > kept {
            low = middle
        } else {
            high = middle
        }
    }
    let all = holds(&mut among.iter());
    let share = |[struck, stroked]: [f64; 2]| (struck / all[0]).min(stroked / all[1]);
    let longest = holds(&mut among.iter().filter(|ranked| rings(ranked) > high));
    share(longest) > share(holds(&mut among.iter().take(kept)))
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

    fn ordered(modes: &[Mode], order: &mut [Ranked]) -> SheddingLevels {
        shedding_order(modes, 1e-4, LOUDEST_DB_SPL, order)
    }

    #[test]
    fn what_each_level_leaves_out_is_what_the_masking_model_misses_least() {
        for count in [0, 1, 15, 16, 17, 100, 349] {
            let modes = body(count);
            let (mut by_need, mut order) =
                (std::vec![Ranked::default(); count], std::vec![Ranked::default(); count]);
            perceptual_order(&modes, LOUDEST_DB_SPL, count, &mut by_need);
            let levels = ordered(&modes, &mut order);
            assert_eq!(levels[0], count.div_ceil(LANES));
            assert!(
                levels.windows(2).all(|pair| pair[1] <= pair[0] && pair[1] >= pair[0].min(1)),
                "{levels:?}"
            );
            let hidden =
                |level: usize| audible_count(&by_need, SAFETY_DB[level]).div_ceil(LANES) == levels[level];
            let by_the_model = (1..MODE_LEVELS).take_while(|level| hidden(*level)).last().unwrap_or(0);
            for (level, groups) in levels.into_iter().enumerate().take(by_the_model + 1) {
                let kept = (groups * LANES).min(count);
                assert!(groups <= most_at(level, levels[0]));
                let audible = audible_count(&by_need, SAFETY_DB[level]);
                assert!(level == 0 || groups <= 1 || kept < audible + LANES);
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
    fn where_nothing_is_hidden_two_fifths_go_and_they_hold_the_least() {
        // Two thirds of an ERB apart: nothing hides anything.
        let modes: Vec<Mode> = (0..48)
            .map(|i| Mode {
                frequency_hz: 100.0 * 1.1f64.powi(i),
                decay_per_s: 3.0 + f64::from(i),
                amplitude: 1.0 / (1.0 + 0.1 * f64::from(i)),
                phase_rad: 0.0,
            })
            .collect();
        let mut order = std::vec![Ranked::default(); 48];
        assert_eq!(ordered(&modes, &mut order), [3, 2]);
        let mut first: Vec<usize> = order[..32].iter().map(|ranked| ranked.index).collect();
        first.sort_unstable();
        assert!(first.into_iter().eq(0..32), "{order:?}");
    }

    #[test]
    fn a_body_of_thousands_of_modes_puts_inaudible_ones_last() {
        let mut modes = body(3000);
        modes[1234].amplitude = 1e-9;
        let mut order = std::vec![Ranked::default(); 3000];
        perceptual_order(&modes, LOUDEST_DB_SPL, RANKED, &mut order);
        assert_eq!(order[2999].index, 1234);
        let mut seen: Vec<usize> = order.iter().map(|ranked| ranked.index).collect();
        seen.sort_unstable();
        assert!(seen.into_iter().eq(0..3000));
    }

    #[test]
    fn ordering_eight_times_the_modes_takes_far_less_than_sixty_fourfold() {
        let timed = |count: usize| {
            let modes = body(count);
            let mut order = std::vec![Ranked::default(); count];
            let mut least_s = f64::INFINITY;
            let mut levels = [0; MODE_LEVELS];
            for _ in 0..3 {
                let since = std::time::Instant::now();
                levels = ordered(&modes, &mut order);
                least_s = since.elapsed().as_secs_f64().min(least_s);
            }
            std::println!("{count} modes: {:.0} ms, groups at each level {levels:?}", 1e3 * least_s);
            (least_s, levels)
        };
        // 4096 take 45 ms on a quiet machine, and twenty times as long where an emulator runs this:
        // growth is the same on both.
        let ((few_s, _), (many_s, levels)) = (timed(512), timed(4096));
        assert!(many_s < 24.0 * few_s, "{few_s} s, {many_s} s");
        assert!(levels[1] < levels[0] / 2, "most are hidden: {levels:?}");
    }

    /// Group-seconds that a bank in this order is awake after one strike: groups sleep from the end
    /// of each section.
    fn awake_s(modes: &[Mode], order: &[usize], levels: &SheddingLevels, impulse_n_s: f64) -> f64 {
        let groups: Vec<f64> = order
            .chunks(LANES)
            .map(|group| {
                group.iter().map(|index| ringing_s(&modes[*index], impulse_n_s).max(0.0)).fold(0.0, f64::max)
            })
            .collect();
        let (mut from, mut sum) = (0, 0.0);
        for until in levels.iter().rev() {
            let mut until_s = 0.0;
            for end_s in groups[from..*until].iter().rev() {
                until_s = f64::max(until_s, *end_s);
                sum += until_s;
            }
            from = *until;
        }
        sum
    }

    #[test]
    fn ordering_by_need_keeps_bodies_awake_at_most_twice_as_long() {
        for count in [48, 100, 256, 349] {
            let modes = body(count);
            let mut order = std::vec![Ranked::default(); count];
            let levels = ordered(&modes, &mut order);
            let mut by_ringing: Vec<usize> = (0..count).collect();
            by_ringing.sort_by(|a, b| ringing_s(&modes[*b], 1e-4).total_cmp(&ringing_s(&modes[*a], 1e-4)));
            for impulse_n_s in [1e-6, 1e-4, 1e-2] {
                let own: Vec<usize> = order.iter().map(|ranked| ranked.index).collect();
                let all = [levels[0]; MODE_LEVELS];
                let ratio = awake_s(&modes, &own, &levels, impulse_n_s)
                    / awake_s(&modes, &by_ringing, &all, impulse_n_s);
                std::println!("{count} modes, {levels:?}, {impulse_n_s} N·s: {ratio:.2}");
                assert!(ratio < 2.0, "{count} modes, {impulse_n_s} N·s: {ratio}");
            }
        }
    }
}
