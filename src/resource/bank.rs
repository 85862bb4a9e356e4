//! Bank: the modes of one body in memory of its own, who strikes them, and how long.

use crate::model::modal_model::MAX_POSITIONS;
use asperity_dsp::DesignError;
use asperity_dsp::modal_bank::{GroupState, LANES, ModalBank, ModeGroup, OnsetCorrection, OnsetSamples};
pub(crate) use asperity_dsp::modal_bank::{MODE_LEVELS, SheddingLevels};
use asperity_dsp::mode::Mode;

/// Longest contact of an impact, s: 5 kg of foam that fall 5 cm. What would last longer lasts so
/// long, at every rate, and is counted ([`Stats::shortened`](crate::Stats::shortened)).
pub const LONGEST_CONTACT_S: f64 = 0.17;

/// The bank of a body.
pub(crate) type Bank = ModalBank<Box<[ModeGroup]>, Box<[GroupState]>>;

/// Which contact an input belongs to: a voice and the sample at which it began.
pub(crate) type ContactKey = (usize, u64);

/// Deficit of a bank of these modes in the first samples of a strike, for each place and each level
/// of modes left out.
pub(crate) fn first_samples(
    modes: &[(Mode, [f32; MAX_POSITIONS])],
    places: usize,
    levels: &SheddingLevels,
    sample_rate_hz: f64,
) -> Result<Vec<[OnsetCorrection; MODE_LEVELS]>, DesignError> {
    let mut sums = vec![OnsetSamples::NOTHING; places];
    let mut all = vec![[OnsetCorrection::NOTHING; MODE_LEVELS]; places];
    for (group, modes) in modes.chunks(LANES).enumerate() {
        for (mode, shares) in modes {
            let missing = OnsetSamples::of(mode, sample_rate_hz)?;
            for (sum, share) in sums.iter_mut().zip(shares) {
                sum.add(&missing, f64::from(*share));
            }
        }
        for level in (0..MODE_LEVELS).filter(|level| levels[*level] == group + 1) {
            for (place, sum) in all.iter_mut().zip(&sums) {
                place[level] = sum.first_samples();
            }
        }
    }
    Ok(all)
}
