//! Outputs of a voice: what is felt of it, what it sends to the body, what was counted.

use super::rub_block::RubBlock;
use asperity_texture::height_field::MAX_BLOCK;

/// Outputs of one voice in a stretch of samples.
pub(crate) struct VoiceBlock {
    /// m or m/s², as the actuator plays it.
    pub(crate) haptic: [f64; MAX_BLOCK],
    /// Sent to the body, N·s.
    pub(crate) impulse_n_s: [f64; MAX_BLOCK],
    /// Rubbing of the body by friction.
    pub(crate) rub: RubBlock,
    /// True where `impulse_n_s` is more than zeros.
    pub(crate) excites: bool,
    pub(crate) collisions: u64,
    /// Contact forces beyond thirty times what pressed.
    pub(crate) blows: u64,
    /// Collisions that would have lasted longer.
    pub(crate) shortened: u64,
    pub(crate) resets: u64,
}

impl VoiceBlock {
    /// Nothing.
    pub(crate) fn new() -> Self {
        Self {
            haptic: [0.0; MAX_BLOCK],
            impulse_n_s: [0.0; MAX_BLOCK],
            rub: RubBlock::STILL,
            excites: false,
            collisions: 0,
            blows: 0,
            shortened: 0,
            resets: 0,
        }
    }

    /// Louder or softer, felt and heard; what rubs presses harder or less.
    pub(super) fn scale(&mut self, i: usize, gain: f64) {
        self.haptic[i] *= gain;
        self.impulse_n_s[i] *= gain;
        self.rub.normal_force_n[i] *= gain;
    }

    /// Brings what is heard and what is felt of `n` samples to their levels.
    pub(super) fn level(&mut self, n: usize, (heard, felt): (f64, f64)) {
        self.haptic[..n].iter_mut().for_each(|x| *x *= felt);
        self.impulse_n_s[..n].iter_mut().for_each(|x| *x *= heard);
    }

    /// A stretch begins of which some samples at its end stay silent.
    pub(super) fn begin(&mut self, silent: std::ops::Range<usize>) {
        self.silence(silent);
        self.rub.rubs = false;
    }

    /// Nothing felt and nothing heard of some samples.
    pub(super) fn silence(&mut self, samples: std::ops::Range<usize>) {
        self.haptic[samples.clone()].fill(0.0);
        self.impulse_n_s[samples.clone()].fill(0.0);
        self.rub.normal_force_n[samples].fill(0.0);
    }
}
