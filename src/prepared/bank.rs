//! Bank: the modes of one body in memory of its own, who strikes them, and how long.

use asperity_dsp::modal_bank::{GroupState, ModalBank, ModeGroup};
pub(crate) use asperity_dsp::modal_bank::{MODE_LEVELS, SheddingLevels};

/// Longest contact of an impact, s: 5 kg of foam that fall 5 cm. What would last longer lasts so long, at every rate, and is
/// counted ([`Stats::shortened`](crate::Stats::shortened)).
pub const LONGEST_CONTACT_S: f64 = 0.17;

/// The bank of a body.
pub(crate) type Bank = ModalBank<Box<[ModeGroup]>, Box<[GroupState]>>;

/// Which contact an input belongs to: a voice and the sample at which it began.
pub(crate) type Owner = (usize, u64);
