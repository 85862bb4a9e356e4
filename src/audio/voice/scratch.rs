//! Signals that pass from stage to stage during one stretch; made once, used by every voice in
//! turn.

use super::block::VoiceBlock;
use super::exciters::ForceRun;
use super::profile::Profile;
use super::watching::Shown;
use super::{PadSample, PathPoint};
use asperity_dsp::micro_contact::Bend;
use asperity_texture::height_field::MAX_BLOCK;

/// Outputs of the stages, in their order.
pub(crate) struct Scratch {
    pub(super) points: [PathPoint; MAX_BLOCK],
    pub(super) profile: Profile,
    /// Bends of the profile between samples.
    pub(super) bends: [[Bend; 2]; MAX_BLOCK],
    pub(super) rows: [PadSample; MAX_BLOCK],
    pub(super) force: ForceRun,
    pub(super) shown: Shown,
    /// Boxed: where several threads render it changes hands, and is not copied.
    pub(crate) out: Box<VoiceBlock>,
}

impl Scratch {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self {
            points: [PathPoint::default(); MAX_BLOCK],
            profile: Profile::new(),
            bends: [[[0.0; 4]; 2]; MAX_BLOCK],
            rows: [PadSample::default(); MAX_BLOCK],
            force: ForceRun::new(),
            shown: Shown::new(),
            out: Box::new(VoiceBlock::new()),
        })
    }
}
