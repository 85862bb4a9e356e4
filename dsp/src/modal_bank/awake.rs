//! The groups that ring: the others cost nothing until they are struck again.

use super::design::{GRID_SAMPLES, GroupState, ModeGroup};
use super::job::{Input, MAX_INPUTS};
use super::kernel::Kernel;

/// Inputs of an ordinary call.
const FEW_INPUTS: usize = 4;

/// How many leading groups ring.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Awake {
    groups: usize,
}

impl Awake {
    /// So many groups ring.
    pub(super) const fn of(groups: usize) -> Self {
        Self { groups }
    }

    /// Groups that are rendered at the moment.
    pub(super) const fn groups(&self) -> usize {
        self.groups
    }

    /// Renders what rings, skipping what sleeps: groups wake with the first impulse that is not zero and are settled on the absolute
    /// grid. Of the groups the first [`Bank::driven`] hear anything; the others ring out. `shared`: one input without gains.
    pub(super) fn run(
        &mut self,
        bank: Bank<'_>,
        first_sample: u64,
        inputs: &[Input<'_>],
        shared: bool,
        out: &mut [f32],
    ) {
        // A table for all inputs costs as much as some samples of a short block.
        if inputs.len() <= FEW_INPUTS {
            self.run_inputs::<FEW_INPUTS>(bank, first_sample, inputs, shared, out);
        } else {
            self.run_inputs::<MAX_INPUTS>(bank, first_sample, inputs, shared, out);
        }
    }

    fn run_inputs<const MOST: usize>(
        &mut self,
        bank: Bank<'_>,
        first_sample: u64,
        inputs: &[Input<'_>],
        shared: bool,
        out: &mut [f32],
    ) {
        let Bank { kernel, groups, states, driven, threshold } = bank;
        let mut heard = [Input { impulses: &[], gains: &[] }; MOST];
        let heard = &mut heard[..inputs.len().min(MOST)];
        let samples = inputs.iter().fold(out.len(), |n, input| n.min(input.impulses.len()));
        let driven = driven.min(groups.len()).min(states.len());
        let mut at = 0;
        while at < samples {
            let now = first_sample.wrapping_add(at as u64);
            let len = ((GRID_SAMPLES - now % GRID_SAMPLES) as usize).min(samples - at);
            for (heard, input) in heard.iter_mut().zip(inputs) {
                *heard = Input { impulses: &input.impulses[at..at + len], gains: input.gains };
            }
            let y = &mut out[at..at + len];
            if self.groups < driven && heard.iter().any(|input| is_struck(input.impulses)) {
                self.groups = driven;
            }
            let awake = self.groups.min(groups.len()).min(states.len());
            let (groups, states) = (&groups[..awake], &mut states[..awake]);
            let driven = driven.min(awake);
            let (deaf, deaf_states) = (&groups[driven..], &mut states[driven..]);
            if !deaf.is_empty() {
                kernel.render(now, deaf, deaf_states, &SILENCE[..len], y);
            }
            let (groups_heard, states_heard) = (&groups[..driven], &mut states[..driven]);
            match heard {
                [input] if shared => kernel.render(now, groups_heard, states_heard, input.impulses, y),
                _ => kernel.render_mixed(now, groups_heard, states_heard, heard, y),
            }
            if now.wrapping_add(len as u64).is_multiple_of(GRID_SAMPLES) {
                self.groups = kernel.settle(groups, states, threshold);
            }
            at += len;
        }
    }
}

/// What is rendered.
#[derive(Debug)]
pub(super) struct Bank<'a> {
    /// The instructions.
    pub(super) kernel: Kernel,
    /// The modes, slowest decay first.
    pub(super) groups: &'a [ModeGroup],
    /// Their states.
    pub(super) states: &'a mut [GroupState],
    /// How many leading groups hear the inputs.
    pub(super) driven: usize,
    /// Amplitude below which a mode is put to rest, output units.
    pub(super) threshold: f32,
}

const SILENCE: [f32; GRID_SAMPLES as usize] = [0.0; GRID_SAMPLES as usize];

/// Whether any impulse is not zero. All bits but the sign, or'ed: many at a time where `any` looks at one.
fn is_struck(impulses: &[f32]) -> bool {
    impulses.iter().fold(0, |bits, u| bits | (u.to_bits() << 1)) != 0
}
