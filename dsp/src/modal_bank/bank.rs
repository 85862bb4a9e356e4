//! The bank as it is used: modes with their memory, inputs in, sound out.
//!
//! ```text
//! out[n] += Σ modes (hₘ * Σ inputs gₘᵢ uᵢ)[n]          hₘ: the impulse response of mode m
//! ```
//!
//! Written plainly it is the loop of [`ReferenceMode`](super::ReferenceMode), one mode after the
//! other; the bank renders the same 16 modes at a time, in the instructions that its [`Level`]
//! stands for, and leaves out the groups that have rung out.

use super::active_groups::ActiveGroups;
use super::design::{GRID_SAMPLES, GroupState, LaneGains, ModeGroup};
use super::free_response::{self, FreeResponse};
use super::kernel::Kernel;
use super::shedding::{MODE_LEVELS, SheddingLevels};
use super::{Input, SLEEP_AMPLITUDE, retune, sleep};
use crate::simd::Level;

/// Inputs of a bank.
#[derive(Debug, Clone, Copy)]
pub enum Inputs<'a> {
    /// One input that every mode takes at gain 1: the impulse of each sample, N·s.
    One(&'a [f32]),
    /// Up to [`MAX_INPUTS`](super::MAX_INPUTS) inputs, each with a gain for every mode; more are
    /// not heard.
    ///
    /// Gains that change while something slides are two inputs: the same impulses once with the
    /// gains that were, fading out, and once with those that come, fading in. The sum is the
    /// straight line between both, sample by sample.
    Placed(&'a [Input<'a>]),
}

/// The modes of a body and what they remember, in memory of the caller's: slices, arrays or boxes
/// of equal length.
///
/// Design is [`design_groups`](super::design_groups), state is [`GroupState`]; this runs them.
///
/// ```
/// use asperity_dsp::modal_bank::{GroupOptions, GroupState, Inputs, ModalBank, design_groups};
/// use asperity_dsp::mode::Mode;
/// use asperity_dsp::simd::Level;
///
/// let modes = [Mode { frequency_hz: 440.0, decay_per_s: 6.0, amplitude: 1.0, phase_rad: 0.0 }];
/// let groups = design_groups(&modes, 48_000.0, &GroupOptions::default()).collect::<Result<Vec<_>, _>>()?;
/// let mut bank = ModalBank::new(Level::detect(), &groups[..], [GroupState::REST]);
///
/// let mut impulses_n_s = [0.0; 128];
/// impulses_n_s[0] = 1e-3;
/// let mut out = [0.0; 128];
/// bank.render(0, Inputs::One(&impulses_n_s), &mut out);
/// assert_eq!(bank.active_groups(), 1);
/// // A quarter of a period later it is at its peak.
/// assert!((out[27] - 1e-3).abs() < 1e-5);
/// # Ok::<(), asperity_dsp::DesignError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ModalBank<G, S> {
    kernel: Kernel,
    groups: G,
    states: S,
    active_groups: ActiveGroups,
    threshold: f32,
}

impl<G: AsRef<[ModeGroup]>, S: AsRef<[GroupState]> + AsMut<[GroupState]>> ModalBank<G, S> {
    /// A bank as its states say. Groups beyond the states are silent.
    ///
    /// Modes are best in falling order of [`ringing_s`](super::ringing_s), so that the groups that
    /// still ring are the first ones, or in the order of [`shedding_order`](super::shedding_order)
    /// and [`in_sections`](Self::in_sections).
    pub fn new(level: Level, groups: G, states: S) -> Self {
        let count = groups.as_ref().len().min(states.as_ref().len());
        let active_groups = ActiveGroups::of(&states.as_ref()[..count], &[count; MODE_LEVELS]);
        Self { kernel: Kernel(level), groups, states, active_groups, threshold: SLEEP_AMPLITUDE }
    }

    /// Falls asleep section by section, between each two levels at which groups are left out,
    /// because in each what rings longest stands first.
    #[must_use]
    pub fn in_sections(self, levels: &SheddingLevels) -> Self {
        let active_groups = ActiveGroups::of(&self.states.as_ref()[..self.groups()], levels);
        Self { active_groups, ..self }
    }

    /// A mode is put exactly to rest once its amplitude is below this, in units of the output; 0
    /// lets it ring on to the last bit. Without it, [`SLEEP_AMPLITUDE`].
    #[must_use]
    pub fn sleeping_below(mut self, amplitude: f32) -> Self {
        self.threshold = amplitude;
        self
    }

    /// Adds the response to the inputs to `out`; sample 0 of all of them is the absolute sample
    /// `first_sample`, which goes on where the last call ended. Slices of unequal length are used
    /// as far as the shortest reaches. Any split into blocks renders the same bits.
    ///
    /// Two placed inputs cost two to three more operations a mode and sample than the one that all
    /// modes share.
    pub fn render(&mut self, first_sample: u64, inputs: Inputs<'_>, out: &mut [f32]) {
        let all = self.groups();
        self.render_leading(all, first_sample, inputs, out);
    }

    /// As [`render`](Self::render); of the groups only the first `driven` hear anything, and the
    /// others ring out: what a machine that is too slow leaves out.
    pub fn render_leading(&mut self, driven: usize, first_sample: u64, inputs: Inputs<'_>, out: &mut [f32]) {
        let (groups, states) = (self.groups.as_ref(), self.states.as_mut());
        let bank = super::active_groups::Bank {
            kernel: self.kernel,
            groups,
            states,
            driven,
            threshold: self.threshold,
        };
        match inputs {
            Inputs::One(impulses) => {
                self.active_groups.run(bank, first_sample, &[Input { impulses, gains: &[] }], true, out);
            }
            Inputs::Placed(inputs) => self.active_groups.run(bank, first_sample, inputs, false, out),
        }
    }

    /// Zero-input response of the coming 64 samples, as `groups` have its modes ([`FreeResponse`]):
    /// groups beyond them are not heard.
    ///
    /// At an absolute multiple of [`GRID_SAMPLES`](super::GRID_SAMPLES), where states are as exact
    /// as they get.
    pub fn ahead(&self, groups: &[FreeResponse], out: &mut [f32; GRID_SAMPLES as usize]) {
        let active_groups = self.active_groups().min(groups.len());
        free_response::ahead(
            self.level(),
            &groups[..active_groups],
            &self.states.as_ref()[..active_groups],
            out,
        );
    }

    /// Silences all that rings.
    pub fn silence(&mut self) {
        self.states.as_mut().fill(GroupState::REST);
        self.active_groups.sleep();
    }

    /// Groups of [`LANES`](super::LANES) modes.
    pub fn groups(&self) -> usize {
        self.groups.as_ref().len().min(self.states.as_ref().len())
    }

    /// Number of leading groups that hold all that are rendered at the moment; the rest sleep until
    /// the next impulse.
    pub fn active_groups(&self) -> usize {
        self.active_groups.groups()
    }

    /// Tests whether every mode is exactly at rest.
    pub fn is_at_rest(&self) -> bool {
        self.states.as_ref().iter().all(GroupState::is_at_rest)
    }

    /// Energy of the ringing: the sum over the modes of the squared amplitude, output units
    /// squared; within a turn of four samples that of its beginning.
    pub fn energy(&self) -> f32 {
        let each = self.groups.as_ref().iter().zip(self.states.as_ref());
        each.map(|(group, state)| sleep::energy(group, state)).sum()
    }

    /// The instructions it runs in.
    pub fn level(&self) -> Level {
        self.kernel.0
    }
}

impl<G: AsMut<[ModeGroup]>, S: AsMut<[GroupState]>> ModalBank<G, S> {
    /// Gives a group other frequencies, decays and amplitudes while it rings: each mode goes on at
    /// its level and phase, and no energy comes from nowhere. A mode that is silent before or after
    /// comes to rest. Groups that are not there are left alone.
    ///
    /// Between two calls of [`render`](Self::render) of which the second begins at an absolute
    /// multiple of four samples, best of [`GRID_SAMPLES`](super::GRID_SAMPLES): within a turn of
    /// four the states are still those of its beginning.
    pub fn retune(&mut self, index: usize, group: &ModeGroup) {
        let (groups, states) = (self.groups.as_mut(), self.states.as_mut());
        if let (Some(old), Some(state)) = (groups.get_mut(index), states.get_mut(index)) {
            retune::retune(old, group, state);
            *old = *group;
        }
    }
}

/// Gain of each lane of the groups from one input, of one gain for each mode; the lanes that are
/// left over take nothing.
pub fn lane_gains(gains: impl IntoIterator<Item = f32>) -> impl Iterator<Item = LaneGains> {
    let mut gains = gains.into_iter().peekable();
    core::iter::from_fn(move || {
        gains.peek()?;
        Some(LaneGains(core::array::from_fn(|_| gains.next().unwrap_or(0.0))))
    })
}
