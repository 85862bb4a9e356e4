//! Bank: the modes of one body in memory of its own, who strikes them, and how long.

use asperity_dsp::modal_bank::{GroupState, ModalBank, ModeGroup};

/// Longest contact of an impact, s: 5 kg of foam that fall 5 cm. What would last longer lasts so long, at every rate, and is
/// counted ([`Stats::shortened`](crate::Stats::shortened)).
pub const LONGEST_CONTACT_S: f64 = 0.17;

/// The bank of a body.
pub(crate) type Bank = ModalBank<Box<[ModeGroup]>, Box<[GroupState]>>;

/// Which contact an input belongs to: a voice and the sample at which it began.
pub(crate) type Owner = (usize, u64);

/// Levels of modes left out, from none.
pub(crate) const MODE_LEVELS: usize = 5;

/// How many of a body's groups hear what strikes it at a level of modes left out.
pub(crate) fn groups_at(mode_level: usize, groups: usize) -> usize {
    groups - (groups * mode_level / MODE_LEVELS).min(groups.saturating_sub(1))
}
