//! The load governor: when blocks run late, the least audible work goes first, and comes back slowly.
//!
//! | level | what is left out |
//! |---|---|
//! | 1–4 | the groups of modes that would fall asleep first, weak and fast decays, a fifth of each body at a time: under a steady force a mode holds a²/2d of energy, so they sound least. They hear nothing more and ring out, without a click |
//! | 5–8 | the finest octave of the micro-noise that still sounds, one a level |
//! | 9–16 | the contacts of lowest priority, an eighth at a time; they fade, and a move revives them later |
//!
//! What it costs, ten fingers that stroke a body of 80 modes (`tests/only_what_is_needed.rs`): levels 1–3 leave an error of
//! −108, −59 and −47 dB; level 4 takes all but 16 modes and 7 dB; levels 5–8 take 5–14 dB of sound and the grain of the
//! touch. After recovery the sound is that of an engine that was never late.
//!
//! The level rises with every report above [`LATE`] and falls by one in [`RECOVERY_S`] below [`EASY`].
//! It is a function of the reports and of the samples rendered alone: where no load is reported, as
//! offline, nothing is ever left out and every bit repeats.

/// Share of the period from which a block counts as late.
pub(crate) const LATE: f32 = 0.8;
/// Share of the period below which there is room for more work.
pub(crate) const EASY: f32 = 0.5;
/// How long the load must be easy for one level back, s.
pub(crate) const RECOVERY_S: f64 = 0.5;

const FIRST_OCTAVE: u32 = 4;
const FIRST_CONTACT: u32 = 8;
const HIGHEST: u32 = 16;

/// How much is left out at present.
pub(crate) struct Governor {
    enabled: bool,
    level: u32,
    /// Sample from which the load has been easy at the present level.
    easy_since: u64,
    recovery_samples: u64,
    /// Contacts that sounded when contacts first had to go.
    contacts: usize,
}

impl Governor {
    pub(crate) fn new(enabled: bool, sample_rate_hz: f64) -> Self {
        let recovery_samples = (RECOVERY_S * sample_rate_hz) as u64;
        Self { enabled, level: 0, easy_since: 0, recovery_samples, contacts: 0 }
    }

    /// Hears which share of its period the last block took.
    pub(crate) fn hear(&mut self, load: f32, position: u64, sounding: usize) {
        if !self.enabled {
            return;
        }
        if load > LATE {
            // Twice as late, twice as fast.
            let rise = if load > 2.0 * LATE { 2 } else { 1 };
            if self.level <= FIRST_CONTACT {
                self.contacts = sounding;
            }
            self.level = (self.level + rise).min(HIGHEST);
            self.easy_since = position;
        } else if load > EASY {
            self.easy_since = position;
        } else if position.saturating_sub(self.easy_since) >= self.recovery_samples {
            self.level = self.level.saturating_sub(1);
            self.easy_since = position;
        }
    }

    /// How many of a body's groups still hear what strikes it; at least one.
    pub(crate) fn groups_driven(&self, groups: usize) -> usize {
        let gone = self.level.min(FIRST_OCTAVE) as usize;
        groups - (groups * gone / 5).min(groups.saturating_sub(1))
    }

    /// How many of the octaves of micro-noise that would sound are left out.
    pub(crate) fn octaves_gone(&self) -> u32 {
        self.level.clamp(FIRST_OCTAVE, FIRST_CONTACT) - FIRST_OCTAVE
    }

    /// How many contacts may sound, of at most `most`.
    pub(crate) fn contacts(&self, most: usize) -> usize {
        let gone = self.level.saturating_sub(FIRST_CONTACT) as usize;
        if gone == 0 { most } else { (self.contacts - self.contacts * gone / 9).clamp(1, most) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 44_100.0;

    fn after(reports: impl IntoIterator<Item = f32>) -> Governor {
        let mut governor = Governor::new(true, RATE);
        for (block, load) in reports.into_iter().enumerate() {
            governor.hear(load, 64 * block as u64, 10);
        }
        governor
    }

    #[test]
    fn modes_go_before_noise_and_noise_before_contacts() {
        let at = |level: usize| {
            let governor = after(vec![0.9; level]);
            (governor.groups_driven(10), governor.octaves_gone(), governor.contacts(64))
        };
        assert_eq!(at(0), (10, 0, 64));
        assert_eq!(at(2), (6, 0, 64));
        assert_eq!(at(4), (2, 0, 64));
        assert_eq!(at(6), (2, 2, 64));
        assert_eq!(at(8), (2, 4, 64));
        assert_eq!(at(10), (2, 4, 8));
        assert_eq!(at(100), (2, 4, 2));
        assert_eq!(after([0.9; 100]).groups_driven(1), 1, "something always sounds");
    }

    #[test]
    fn work_comes_back_one_level_in_half_a_second_of_easy_blocks() {
        let blocks_a_level = (RECOVERY_S * RATE / 64.0) as usize + 1;
        let late = [0.9; 3];
        let easy = |blocks: usize| late.iter().copied().chain(vec![0.2; blocks]);
        assert_eq!(after(easy(blocks_a_level / 2)).level, 3);
        assert_eq!(after(easy(blocks_a_level + 2)).level, 2);
        assert_eq!(after(easy(4 * blocks_a_level)).level, 0);
        // Neither late nor easy: nothing changes.
        assert_eq!(after(late.iter().copied().chain(vec![0.7; 4 * blocks_a_level])).level, 3);
    }

    #[test]
    fn a_load_that_is_no_number_changes_nothing() {
        assert_eq!(after([f32::NAN, f32::NEG_INFINITY]).level, 0);
        let mut off = Governor::new(false, RATE);
        off.hear(5.0, 0, 3);
        assert_eq!(off.level, 0);
    }
}
