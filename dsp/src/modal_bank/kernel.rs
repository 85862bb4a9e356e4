//! Entry points of the bank: how wide the vectors of a level are.

use super::design::{GRID_SAMPLES, GroupState, ModeGroup};
use super::job::{Feed, Input, Job, MAX_INPUTS};
use super::vector::len;
use super::walk::walk;
use super::{LANES, sleep};
use crate::simd::{Level, Set, at_level};

/// Operations of the bank on one level.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kernel(pub Level);

impl Kernel {
    /// Adds the bank's response to `impulses_n_s` to `out`; sample 0 of both is the absolute sample
    /// `first_sample`, which goes on where the last call ended. Every lane takes the one input at
    /// gain 1. Slices of unequal length are used as far as the shortest reaches.
    pub(super) fn render(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        impulses_n_s: &[f32],
        out: &mut [f32],
    ) {
        let input = [Input { impulses: impulses_n_s, gains: &[] }];
        self.walk(first_sample, groups, states, Feed { inputs: &input, shared: true }, out);
    }

    /// As [`Kernel::render`] for up to [`MAX_INPUTS`] inputs (more are not heard), each with a gain
    /// for every lane. Two inputs cost two to three more operations a mode and sample than the
    /// shared one.
    pub(super) fn render_mixed(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        inputs: &[Input<'_>],
        out: &mut [f32],
    ) {
        let inputs = &inputs[..inputs.len().min(MAX_INPUTS)];
        self.walk(first_sample, groups, states, Feed { inputs, shared: false }, out);
    }

    fn walk(
        self,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        feed: Feed<'_>,
        out: &mut [f32],
    ) {
        let samples = feed.inputs.iter().fold(out.len(), |n, input| n.min(input.impulses.len()));
        let mut count = groups.len().min(states.len());
        if !feed.shared {
            count = feed.inputs.iter().fold(count, |n, input| n.min(input.gains.len()));
        }
        if feed.inputs.is_empty() || count == 0 || samples == 0 {
            return;
        }
        let mut job = Job {
            groups: &groups[..count],
            states: &mut states[..count],
            feed,
            pairs: [0.0; GRID_SAMPLES as usize / 2],
        };
        let out = &mut out[..samples];
        at_level!(self.0, token => walk_by_width(token, first_sample, &mut job, out));
    }

    /// Puts lanes whose amplitude is below `threshold` (output units) exactly to rest and returns
    /// how many leading groups still ring; the rest need no rendering until the next input. Lanes
    /// that hold no finite number are put to rest as well.
    ///
    /// Call it at absolute multiples of [`super::GRID_SAMPLES`], or the output depends on the split
    /// into blocks.
    pub(super) fn settle(self, groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
        at_level!(self.0, _token => sleep::settle(groups, states, threshold))
    }
}

/// Cuts groups into vectors of the token's width; how many groups at most go at once is a matter of
/// registers.
#[inline(always)]
#[allow(unsafe_code)]
fn walk_by_width<T: Set>(token: T, first_sample: u64, job: &mut Job<'_>, out: &mut [f32]) {
    // SAFETY: `out` is no longer than any input, there is a group, and there are states and gains
    // of all.
    unsafe {
        // Constants, so that only what a level runs is compiled for it.
        match const { LANES / len::<T>() } {
            1 => walk::<T, 1, 4>(token, first_sample, job, out),
            2 => walk::<T, 2, 4>(token, first_sample, job, out),
            _ if const { T::FUSED } => walk::<T, 4, 3>(token, first_sample, job, out),
            _ => walk::<T, 4, 1>(token, first_sample, job, out),
        }
    }
}
