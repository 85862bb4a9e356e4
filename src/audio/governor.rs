//! The load governor: when blocks run late, the least audible work goes first, and comes back
//! slowly.
//!
//! | level | what is left out |
//! |---|---|
//! | 1 | modes by a published masking model (`dsp::masking`, `dsp::modal_bank::shedding_order`): those that nobody hears, with 6 dB of safety; at least two fifths of each body, where nothing is hidden by the model or those that would fall asleep first, whichever keeps more. They hear nothing more and ring out, without a click |
//! | 2–9 | the contacts of lowest priority, an eighth at a time; they fade, and a move revives them later |
//!
//! The order is made when a body is added, for the level at which its loudest mode is heard: that
//! of its bus ([`AudioBus::pascals_at_full_scale`](crate::AudioBus::pascals_at_full_scale)), or
//! else 70 dB SPL. 4096 modes take a tenth of a second.
//!
//! What it costs: on measured tables of ceramic and wood the first level leaves 5 of 22 and 9 of 14
//! groups, and the ear's excitation is within 1 dB in every cell of an ERB and 20 ms
//! (`cli/tests/perceptual_order.rs`). After recovery the sound is that of an engine that was never
//! late. `asperity report` has a table of all levels.
//!
//! A level saves at least a tenth of what it acts on, or it is none: three more of modes saved
//! nothing of ten fingers on one body and a tenth of a bank alone, and four that took an octave of
//! the micro-relief each saved 1 to 11 % in all, left 15 to 3 % of the ear's cells within 1 dB and
//! what is felt 2 to 43 dB off, where the least of ten contacts is a tenth and leaves the other
//! nine as they are.
//!
//! *Its own lateness only.* A block may be late because the host did something else, and leaving
//! work out then costs sound and wins nothing. So what counts is the engine's own share, the median
//! of the last [`MEDIAN_OF`] reports: the level rises with every report above [`LATE`] while that
//! share is above [`EASY`], and falls by one in [`RECOVERY_S`] in which it is not. At a share of 1
//! % up to 15 late blocks in a row change nothing; work that does not fit is answered after 16
//! blocks.
//!
//! The level is a function of the reports and of the samples rendered alone: where no load is
//! reported, as offline, nothing is ever left out and every bit repeats.

use crate::resource::bank::MODE_LEVELS;

/// Share of the period from which a block counts as late.
pub(crate) const LATE: f32 = 0.8;
/// Share of the period below which there is room for more work.
pub(crate) const EASY: f32 = 0.5;
/// Time that the load must be easy for one level back, s.
pub(crate) const RECOVERY_S: f64 = 0.5;

/// Reports whose median is the engine's own share.
pub(crate) const MEDIAN_OF: usize = 31;

/// The level above which contacts go.
const MODES: u32 = MODE_LEVELS as u32 - 1;
const HIGHEST: u32 = MODES + 8;

/// Level that is left out at present.
pub(crate) struct Governor {
    enabled: bool,
    level: u32,
    /// Sample from which the load has been easy at the present level.
    easy_since: u64,
    recovery_samples: u64,
    /// Contacts that sounded when contacts first had to go.
    contacts: usize,
    /// True for each of the last reports that was above [`EASY`]; one bit a report, the newest
    /// lowest.
    busy: u32,
}

impl Governor {
    pub(crate) fn new(enabled: bool, sample_rate_hz: f64) -> Self {
        let recovery_samples = (RECOVERY_S * sample_rate_hz) as u64;
        Self { enabled, level: 0, easy_since: 0, recovery_samples, contacts: 0, busy: 0 }
    }

    /// Hears which share of its period the last block took.
    pub(crate) fn hear(&mut self, load: f32, position: u64, sounding: usize) {
        if !self.enabled {
            return;
        }
        self.busy = (self.busy << 1 | u32::from(load > EASY)) & ((1 << MEDIAN_OF) - 1);
        if !self.is_busy() {
            if position.saturating_sub(self.easy_since) >= self.recovery_samples {
                self.level = self.level.saturating_sub(1);
                self.easy_since = position;
            }
            return;
        }
        self.easy_since = position;
        if load > LATE {
            // Twice as late, twice as fast.
            let rise = if load > 2.0 * LATE { 2 } else { 1 };
            if self.level <= MODES {
                self.contacts = sounding;
            }
            self.level = (self.level + rise).min(HIGHEST);
        }
    }

    /// Tests whether the median of the last reports is above [`EASY`]: more than half of them are.
    fn is_busy(&self) -> bool {
        2 * self.busy.count_ones() as usize > MEDIAN_OF
    }

    /// The level as far as modes are left out, below [`MODE_LEVELS`].
    pub(crate) fn mode_level(&self) -> usize {
        self.level.min(MODES) as usize
    }

    /// Number of contacts that may sound, of at most `most`.
    pub(crate) fn contacts(&self, most: usize) -> usize {
        let gone = self.level.saturating_sub(MODES) as usize;
        if gone == 0 { most } else { (self.contacts - self.contacts * gone / 9).clamp(1, most) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 44_100.0;

    /// An engine that has been busy, but not late, and then hears `reports`.
    fn after(reports: impl IntoIterator<Item = f32>) -> Governor {
        heard([0.7; MEDIAN_OF].into_iter().chain(reports))
    }

    fn heard(reports: impl IntoIterator<Item = f32>) -> Governor {
        let mut governor = Governor::new(true, RATE);
        for (block, load) in reports.into_iter().enumerate() {
            governor.hear(load, 64 * block as u64, 10);
        }
        governor
    }

    #[test]
    fn modes_go_before_contacts_and_of_ten_contacts_one_a_level() {
        let at = |level: usize| {
            let governor = after(vec![0.9; level]);
            (governor.mode_level(), governor.contacts(64))
        };
        assert_eq!(at(0), (0, 64));
        assert_eq!(at(1), (1, 64));
        let contacts: Vec<usize> = (2..=9).map(|level| at(level).1).collect();
        assert_eq!(contacts, [9, 8, 7, 6, 5, 4, 3, 2]);
        assert_eq!(at(100), (1, 2));
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
    fn late_blocks_of_the_host_cost_nothing_where_the_engine_takes_one_percent() {
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
        assert_eq!(heard([1.2; MEDIAN_OF / 2 + 16]).level, HIGHEST);
    }

    #[test]
    fn a_load_that_is_no_number_changes_nothing() {
        assert_eq!(after([f32::NAN, f32::NEG_INFINITY]).level, 0);
        let mut off = Governor::new(false, RATE);
        off.hear(5.0, 0, 3);
        assert_eq!(off.level, 0);
    }
}
