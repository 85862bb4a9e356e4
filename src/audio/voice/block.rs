//! Memory of a stretch: the signals between the stages, and what leaves a voice.

use super::profile::Profile;
use super::{PadSample, PathPoint};
use crate::link::stats::Counts;
use crate::link::tap::ContactRows;
use asperity_dsp::hertz::FORCE_HISTORY;
use asperity_dsp::micro_contact::QuarticCorrection;
use asperity_surface::height_field::MAX_BLOCK;
use std::ops::Range;

/// Outputs of the stages, in their order; one for all voices.
pub(crate) struct Scratch {
    pub(super) points: [PathPoint; MAX_BLOCK],
    pub(super) profile: Profile,
    pub(super) quartic_correction: [[QuarticCorrection; 2]; MAX_BLOCK],
    pub(super) rows: [PadSample; MAX_BLOCK],
    /// Rows of a tool's tip.
    pub(super) tip_rows: [PadSample; MAX_BLOCK],
    /// Impulses of the alternating force behind those of the stretch before, N·s.
    pub(super) force_n_s: [f64; FORCE_HISTORY + MAX_BLOCK],
    pub(super) shown: ContactRows,
    /// Boxed: with several threads it changes hands, and is not copied.
    pub(crate) out: Box<VoiceBlock>,
}

/// Outputs of one voice.
pub(crate) struct VoiceBlock {
    /// m or m/s², as the actuator plays it.
    pub(crate) haptic: [f64; MAX_BLOCK],
    /// Sent to the body, N·s.
    pub(crate) impulse_n_s: [f64; MAX_BLOCK],
    /// True where `impulse_n_s` is more than zeros.
    pub(crate) excites: bool,
    pub(crate) rub: RubBlock,
    pub(crate) counts: Counts,
}

/// Rubbing of the body by friction.
pub(crate) struct RubBlock {
    pub(crate) rubs: bool,
    /// Line of the motion: a unit vector of u and v.
    pub(crate) along: [f64; 2],
    pub(crate) sweep_m_s: [f64; MAX_BLOCK],
    pub(crate) normal_force_n: [f64; MAX_BLOCK],
}

impl Scratch {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self {
            points: [PathPoint::default(); MAX_BLOCK],
            profile: Profile::new(),
            quartic_correction: [[[0.0; 4]; 2]; MAX_BLOCK],
            rows: [PadSample::default(); MAX_BLOCK],
            tip_rows: [PadSample::default(); MAX_BLOCK],
            force_n_s: [0.0; FORCE_HISTORY + MAX_BLOCK],
            shown: ContactRows::new(),
            out: Box::new(VoiceBlock::new()),
        })
    }
}

impl VoiceBlock {
    /// Silence.
    pub(crate) fn new() -> Self {
        let none = [0.0; MAX_BLOCK];
        let rub = RubBlock { rubs: false, along: [1.0, 0.0], sweep_m_s: none, normal_force_n: none };
        Self { haptic: none, impulse_n_s: none, excites: false, rub, counts: Counts::default() }
    }

    /// Begins a stretch whose samples from `silent` on stay silent.
    pub(super) fn begin(&mut self, silent: Range<usize>) {
        self.haptic[silent.clone()].fill(0.0);
        self.impulse_n_s[silent.clone()].fill(0.0);
        self.rub.normal_force_n[silent].fill(0.0);
        self.rub.rubs = false;
    }

    /// Scales all that one sample gives.
    pub(super) fn scale(&mut self, i: usize, gain: f64) {
        self.haptic[i] *= gain;
        self.impulse_n_s[i] *= gain;
        self.rub.normal_force_n[i] *= gain;
    }

    /// Brings what is heard and what is felt of `n` samples to their levels.
    pub(super) fn level(&mut self, n: usize, (sound, felt): (f64, f64)) {
        self.haptic[..n].iter_mut().for_each(|x| *x *= felt);
        self.impulse_n_s[..n].iter_mut().for_each(|x| *x *= sound);
    }
}
