//! The load governor: when blocks run late, the least audible work goes first, and comes back
//! slowly.
//!
//! | leaves out | |
//! |---|---|
//! | modes | by a published masking model (`dsp::masking`, `dsp::modal_bank::shedding_order`): inaudible ones, with 6 dB of safety; at least two fifths of each body, where nothing is hidden by the model or those that would fall asleep first, whichever keeps more. They take no more input and ring out, without a click |
//! | contacts | those of lowest priority, as many at a time as are a tenth of the cost; they fade, and a move revives them later |
//!
//! A level saves at least a tenth of the one before, or it is none. Modes are the first level
//! where they save so much, beside contacts of [`MODES_A_CONTACT`] each; otherwise they go
//! together with the first contacts. There are no more levels than there are contacts to take: an
//! engine with four fingers comes back after three half seconds.
//!
//! The order of modes is made when a body is added, for the level at which its loudest mode is
//! heard: that of its bus
//! ([`AudioBus::pascals_at_full_scale`](crate::AudioBus::pascals_at_full_scale)), or else 70 dB
//! SPL. 4096 modes take a tenth of a second.
//!
//! Cost and gain: on measured tables of ceramic and wood modes leave 5 of 22 and 9 of 14 groups,
//! and the ear's excitation is within 1 dB in every cell of an ERB and 20 ms
//! (`cli/tests/perceptual_order.rs`). After recovery the sound is that of an engine that was
//! never late. `asperity report` has a table of all levels. A finger that is left out is missed:
//! one of ten leaves 63 % of the cells within 1 dB. Cheaper contacts in place of fewer were
//! measured and are no levels: an octave of the micro-relief less saved 1 to 11 % in all and
//! moved what is felt by 2 to 43 dB; the `fast` preset's contacts save 15 %.
//!
//! *Its own lateness only.* A block may be late because the host did something else, and leaving
//! work out then costs sound and wins nothing. So what counts is the engine's own share, the median
//! of the last [`MEDIAN_OF`] reports: the level rises with every report above [`OVERLOAD_SHARE`]
//! while that share is above [`HEADROOM_SHARE`], and falls by one in [`RECOVERY_S`] in which it is
//! not. At a share of 1 % up to 15 late blocks in a row change nothing; work that does not fit is
//! answered after 16 blocks.
//!
//! The level is a function of the reports and of the samples rendered alone: where no load is
//! reported, as offline, nothing is ever left out and every bit repeats.

use crate::resource::bank::MODE_LEVELS;

/// Share of the period from which a block counts as late.
pub(crate) const OVERLOAD_SHARE: f32 = 0.8;
/// Share of the period below which there is room for more work.
pub(crate) const HEADROOM_SHARE: f32 = 0.5;
/// Time that the load must be easy for one level back, s.
pub(crate) const RECOVERY_S: f64 = 0.5;

/// Reports whose median is the engine's own share.
pub(crate) const MEDIAN_OF: usize = 31;

/// Modes that take as long as one contact: 0.11 ns each beside 110 to 160 (AVX2).
const MODES_A_CONTACT: usize = 1000;
/// Levels of contacts at most: the strongest stay.
const CONTACT_LEVELS: u32 = 8;

/// Work of a block.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Work {
    /// Contacts that sound.
    pub(crate) contacts: usize,
    /// Modes that ring.
    pub(crate) modes: usize,
    /// Ringing modes that can be left out.
    pub(crate) spared: usize,
}

impl Work {
    /// Tests whether modes alone save a tenth of it.
    fn modes_pay(self) -> bool {
        10 * self.spared >= self.modes + MODES_A_CONTACT * self.contacts
    }

    /// Contacts that are a tenth of it once what can be spared of the modes is.
    fn a_level(self) -> usize {
        let cost = self.modes - self.spared + MODES_A_CONTACT * self.contacts;
        cost.div_ceil(10 * MODES_A_CONTACT).max(1)
    }

    /// Levels of contacts: the last one leaves one at least.
    fn contact_levels(self) -> u32 {
        let levels = self.contacts.saturating_sub(1) / self.a_level();
        (levels as u32).min(CONTACT_LEVELS)
    }
}

/// Level that is left out at present.
pub(crate) struct Governor {
    enabled: bool,
    level: u32,
    /// Levels that take no contact: one where modes alone [pay](Work::modes_pay).
    modes_first: u32,
    /// Sample from which the load has been easy at the present level.
    easy_since: u64,
    recovery_samples: u64,
    /// Work that was there when contacts first had to go.
    work: Work,
    /// True for each of the last reports that was above [`HEADROOM_SHARE`]; one bit a report, the
    /// newest lowest.
    busy: u32,
}

impl Governor {
    pub(crate) fn new(enabled: bool, sample_rate_hz: f64) -> Self {
        let recovery_samples = (RECOVERY_S * sample_rate_hz) as u64;
        let work = Work::default();
        Self { enabled, level: 0, modes_first: 0, easy_since: 0, recovery_samples, work, busy: 0 }
    }

    /// Takes the share of its period that the last block took; `work` counts where it is
    /// late.
    pub(crate) fn update(&mut self, load: f32, position: u64, work: Work) {
        if !self.enabled {
            return;
        }
        self.busy = (self.busy << 1 | u32::from(load > HEADROOM_SHARE)) & ((1 << MEDIAN_OF) - 1);
        if !self.is_busy() {
            if position.saturating_sub(self.easy_since) >= self.recovery_samples {
                self.level = self.level.saturating_sub(1);
                self.easy_since = position;
            }
            return;
        }
        self.easy_since = position;
        if load > OVERLOAD_SHARE {
            // Twice as late, twice as fast.
            let rise = if load > 2.0 * OVERLOAD_SHARE { 2 } else { 1 };
            if self.level <= self.modes_first {
                self.work = work;
            }
            if self.level == 0 {
                self.modes_first = u32::from(self.work.modes_pay());
            }
            let highest = self.modes_first + self.work.contact_levels();
            self.level = (self.level + rise).min(highest.max(self.level));
        }
    }

    /// Tests whether the median of the last reports is above [`HEADROOM_SHARE`]: more than half of
    /// them are.
    fn is_busy(&self) -> bool {
        2 * self.busy.count_ones() as usize > MEDIAN_OF
    }

    /// The level of modes that are left out, below [`MODE_LEVELS`].
    pub(crate) fn mode_level(&self) -> usize {
        (self.level as usize).min(MODE_LEVELS - 1)
    }

    /// Number of contacts that may sound, of at most `most`.
    pub(crate) fn contacts(&self, most: usize) -> usize {
        let gone = self.level.saturating_sub(self.modes_first) as usize;
        if gone == 0 {
            return most;
        }
        self.work.contacts.saturating_sub(gone * self.work.a_level()).clamp(1, most.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 44_100.0;

    /// Ten contacts on a body whose modes are most of the work.
    const RINGING: Work = Work { contacts: 10, modes: 10_000, spared: 6000 };

    /// An engine that has been busy, but not late, and then gets `reports`.
    fn after(reports: impl IntoIterator<Item = f32>) -> Governor {
        working(RINGING, [0.7; MEDIAN_OF].into_iter().chain(reports))
    }

    fn heard(reports: impl IntoIterator<Item = f32>) -> Governor {
        working(RINGING, reports)
    }

    fn working(work: Work, reports: impl IntoIterator<Item = f32>) -> Governor {
        let mut governor = Governor::new(true, RATE);
        for (block, load) in reports.into_iter().enumerate() {
            governor.update(load, 64 * block as u64, work);
        }
        governor
    }

    /// Levels of modes and numbers of contacts, level by level, until nothing more goes.
    fn stiffness_table(work: Work) -> Vec<(usize, usize)> {
        let at = |late: usize| {
            let governor = working(work, [0.7; MEDIAN_OF].into_iter().chain(vec![0.9; late]));
            (governor.level as usize == late).then(|| (governor.mode_level(), governor.contacts(64)))
        };
        (0..).map_while(at).collect()
    }

    #[test]
    fn modes_go_before_contacts_where_they_cost_a_tenth() {
        let silent = Work { contacts: 10, modes: 0, spared: 0 };
        let contacts: Vec<usize> = stiffness_table(silent).iter().map(|(_, contacts)| *contacts).collect();
        assert_eq!(contacts, [64, 9, 8, 7, 6, 5, 4, 3, 2]);
        assert_eq!(stiffness_table(RINGING), [(0, 64), (1, 64), (1, 8), (1, 6), (1, 4), (1, 2)]);
        assert_eq!(after(vec![0.9; 100]).contacts(64), 2);
        let small = Work { contacts: 10, modes: 100, spared: 40 };
        assert_eq!(stiffness_table(small), [(0, 64), (1, 8), (1, 6), (1, 4), (1, 2)]);
    }

    #[test]
    fn four_fingers_on_a_small_body_return_soon() {
        let few = Work { contacts: 4, modes: 100, spared: 40 };
        assert_eq!(stiffness_table(few), [(0, 64), (1, 3), (1, 2), (1, 1)]);
        // One finger, or none on a body whose modes are all heard: nothing can go.
        assert_eq!(stiffness_table(Work { contacts: 1, ..few }), [(0, 64)]);
        assert_eq!(stiffness_table(Work { contacts: 0, modes: 100, spared: 0 }), [(0, 64)]);
        // A body that rings alone, and one finger on thousands of modes.
        assert_eq!(stiffness_table(Work { contacts: 0, ..few }), [(0, 64), (1, 64)]);
        assert_eq!(stiffness_table(Work { contacts: 1, modes: 4096, spared: 3000 }), [(0, 64), (1, 64)]);
    }

    /// Costs in modes, as [`MODES_A_CONTACT`] weighs them.
    #[test]
    fn every_level_saves_a_tenth_of_the_one_before() {
        for contacts in 1..=64 {
            for (modes, spared) in [(0, 0), (100, 40), (1000, 700), (10_000, 6000), (100_000, 90_000)] {
                let cost = |(level, left): &(usize, usize)| {
                    (modes - level * spared) + MODES_A_CONTACT * (*left).min(contacts)
                };
                for pair in stiffness_table(Work { contacts, modes, spared }).windows(2) {
                    let (before, after) = (cost(&pair[0]), cost(&pair[1]));
                    assert!(10 * (before - after) >= before, "{contacts}, {modes}: {pair:?}");
                }
            }
        }
    }

    #[test]
    fn work_comes_back_one_level_in_half_a_second_of_easy_blocks() {
        let blocks_a_level = (RECOVERY_S * RATE / 64.0) as usize + 1;
        // As long as the median takes to notice.
        let blocks_a_level = blocks_a_level + MEDIAN_OF / 2;
        let late = [0.9; 3];
        let easy = |blocks: usize| late.iter().copied().chain(vec![0.2; blocks]);
        assert_eq!(after(easy(blocks_a_level / 2)).level, 3);
        assert_eq!(after(easy(blocks_a_level + 2)).level, 2);
        assert_eq!(after(easy(4 * blocks_a_level)).level, 0);
        // Neither late nor easy: nothing changes.
        assert_eq!(after(late.iter().copied().chain(vec![0.7; 4 * blocks_a_level])).level, 3);
    }

    #[test]
    fn late_blocks_cost_nothing_where_the_engine_takes_one_percent() {
        for late in [1, 3, 8, 15] {
            let easy = |blocks| std::iter::repeat_n(0.01, blocks);
            let reports = easy(100).chain(std::iter::repeat_n(4.0, late)).chain(easy(100));
            for blocks in 100..200 + late {
                assert_eq!(heard(reports.clone().take(blocks)).level, 0, "{late} late, block {blocks}");
            }
        }
        // Now and then, for a minute.
        let now_and_then = (0..41_000).map(|block| if block % 3 == 0 { 4.0 } else { 0.01 });
        assert_eq!(heard(now_and_then).level, 0);
    }

    #[test]
    fn work_that_does_not_fit_is_answered_within_32_blocks() {
        assert_eq!(heard([1.2; MEDIAN_OF / 2]).level, 0);
        assert_eq!(heard([1.2; MEDIAN_OF / 2 + 1]).level, 1);
        let highest = RINGING.contact_levels() + 1;
        assert_eq!(heard([1.2; MEDIAN_OF / 2 + 16]).level, highest);
    }

    #[test]
    fn a_load_that_is_no_number_changes_nothing() {
        assert_eq!(after([f32::NAN, f32::NEG_INFINITY]).level, 0);
        let mut off = Governor::new(false, RATE);
        off.update(5.0, 0, RINGING);
        assert_eq!(off.level, 0);
    }
}
