//! What passes from stage to stage during one stretch; made once, used by every voice in turn.

use super::ac_coupling::Coupled;
use super::between::Closeness;
use super::block::VoiceBlock;
use super::exciters::ForceRun;
use super::pad::Pad;
use super::profile::Profile;
use super::watching::Shown;
use super::{PadSample, PathPoint};
use asperity_dsp::micro_contact::{Bend, LANES};
use asperity_texture::height_field::MAX_BLOCK;

/// Outputs of the stages, in their order.
pub(crate) struct Scratch {
    /// Contacts that go side by side; one alone has the first.
    pub(super) lanes: [Lane; LANES],
    pub(super) coupled: Coupled,
    pub(super) profile: Profile,
    pub(super) force: ForceRun,
    pub(super) shown: Shown,
    /// Boxed: where several threads render it changes hands, and is not copied.
    pub(crate) out: Box<VoiceBlock>,
}

/// What of one contact waits while others are at the same stage.
#[derive(Clone, Copy)]
pub(super) struct Lane {
    pub(super) points: [PathPoint; MAX_BLOCK],
    /// The profile, m, and what presses, N.
    pub(super) height_m: [f64; MAX_BLOCK],
    pub(super) force_n: [f64; MAX_BLOCK],
    pub(super) rows: [PadSample; MAX_BLOCK],
    /// What the profile does between samples, and how closely that is known.
    pub(super) bends: [[Bend; 2]; MAX_BLOCK],
    pub(super) looks: Closeness,
    /// How often its pad was begun anew, and blows among the rows.
    pub(super) resets: u64,
    pub(super) blows: u64,
}

impl Lane {
    /// A row of this lane's contact for each of its heights.
    pub(super) fn press(&mut self, pad: &mut Pad, n: usize) {
        let (heights_m, forces_n) = (&self.height_m[..n], &self.force_n[..n]);
        pad.run(heights_m, forces_n, self.looks.ground(n, &self.bends), &mut self.rows[..n]);
    }
}

impl Scratch {
    pub(crate) fn new() -> Box<Self> {
        let lane = Lane {
            points: [PathPoint::default(); MAX_BLOCK],
            height_m: [0.0; MAX_BLOCK],
            force_n: [0.0; MAX_BLOCK],
            rows: [PadSample::default(); MAX_BLOCK],
            bends: [[[0.0; 4]; 2]; MAX_BLOCK],
            looks: Closeness::AtSamples,
            resets: 0,
            blows: 0,
        };
        Box::new(Self {
            lanes: [lane; LANES],
            coupled: Coupled::new(),
            profile: Profile::new(),
            force: ForceRun::new(),
            shown: Shown::new(),
            out: Box::new(VoiceBlock::new()),
        })
    }
}
