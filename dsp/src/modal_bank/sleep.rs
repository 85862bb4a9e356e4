//! Sleep: what has rung out is put exactly to rest and costs nothing until it is struck again.

use super::Kernel;
use super::design::{GRID_SAMPLES, GroupState, ModeGroup};
use super::job::{Input, MAX_INPUTS};
use crate::mode::Mode;

/// Amplitudes beyond this are no vibration but a broken state, which is put to rest.
const ABSURD_AMPLITUDE: f32 = 1e15;

/// −160 dB of full scale for a bank whose output is full scale at 1. A quiet stroke peaks near 1e-4: at
/// −120 dB of full scale its modes fell asleep audibly, 40 dB below the stroke.
pub const SLEEP_AMPLITUDE: f32 = 1e-8;

/// See [`Kernel::settle`].
#[inline(always)]
pub(super) fn settle(groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
    let (low, high) = (threshold * threshold, ABSURD_AMPLITUDE * ABSURD_AMPLITUDE);
    let mut awake = 0;
    for (i, (group, state)) in groups.iter().zip(states).enumerate() {
        let mut rings = 0_u32;
        for (lane, (v, w)) in state.v.iter_mut().zip(&mut state.w).enumerate() {
            let a = group.now[0][lane] * *v + group.now[1][lane] * *w;
            let b = group.quarter[0][lane] * *v + group.quarter[1][lane] * *w;
            let square = a * a + b * b;
            // False for NaN as well.
            let keep = (square >= low) & (square < high) & (square > 0.0);
            *v = if keep { *v } else { 0.0 };
            *w = if keep { *w } else { 0.0 };
            rings += u32::from(keep);
        }
        if rings > 0 {
            awake = i + 1;
        }
    }
    awake
}

/// Energy of a group's ringing: the sum over its lanes of the squared amplitude, output units squared; within
/// a turn of four samples that of its beginning.
#[must_use]
pub fn energy(group: &ModeGroup, state: &GroupState) -> f32 {
    let mut sum = 0.0;
    for lane in 0..super::LANES {
        let a = group.now[0][lane] * state.v[lane] + group.now[1][lane] * state.w[lane];
        let b = group.quarter[0][lane] * state.v[lane] + group.quarter[1][lane] * state.w[lane];
        sum += a * a + b * b;
    }
    sum
}

/// How long a mode rings until it is below [`SLEEP_AMPLITUDE`], s, once an impulse of `impulse_n_s` has struck it; below
/// 0 when it never gets there, infinite when it does not decay.
///
/// Groups of modes in falling order of it fall asleep from the end and together: on synthetic bodies of 100 modes
/// they take 5–35 % less work than in order of decay alone, and what goes first under load sounds less.
#[must_use]
pub fn ringing_s(mode: &Mode, impulse_n_s: f64) -> f64 {
    let nepers = libm::log(mode.amplitude.abs() * impulse_n_s / f64::from(SLEEP_AMPLITUDE));
    if mode.decay_per_s > 0.0 || nepers < 0.0 { nepers / mode.decay_per_s } else { f64::INFINITY }
}

/// Renders only the groups that ring. Designed from modes in falling order of [`ringing_s`], the groups fall asleep
/// from the end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Awake {
    groups: usize,
}

impl Awake {
    /// Groups that are rendered at the moment.
    #[must_use]
    pub const fn groups(&self) -> usize {
        self.groups
    }

    /// As [`Kernel::render`], skipping what sleeps: groups wake with the first impulse that is not zero
    /// and are settled at `threshold` on the absolute grid. Bit-identical for every split into blocks.
    #[allow(clippy::too_many_arguments)]
    pub fn render(
        &mut self,
        kernel: Kernel,
        first_sample: u64,
        groups: &[ModeGroup],
        states: &mut [GroupState],
        impulses_n_s: &[f32],
        out: &mut [f32],
        threshold: f32,
    ) {
        let input = [Input { impulses: impulses_n_s, gains: &[] }];
        let bank = Bank { kernel, groups, states, driven: groups.len(), threshold };
        self.run(bank, first_sample, &input, true, out);
    }

    /// As [`Self::render`] for up to [`MAX_INPUTS`] inputs with a gain for every lane (without gains: one
    /// input that every lane hears), of which only the first [`Bank::driven`] groups hear anything; the
    /// others ring out.
    pub fn render_bank(&mut self, bank: Bank<'_>, first_sample: u64, inputs: &[Input<'_>], out: &mut [f32]) {
        let shared = inputs.len() == 1 && inputs.first().is_some_and(|input| input.gains.is_empty());
        self.run(bank, first_sample, inputs, shared, out);
    }

    fn run(
        &mut self,
        bank: Bank<'_>,
        first_sample: u64,
        inputs: &[Input<'_>],
        shared: bool,
        out: &mut [f32],
    ) {
        let Bank { kernel, groups, states, driven, threshold } = bank;
        let mut heard = [Input { impulses: &[], gains: &[] }; MAX_INPUTS];
        let heard = &mut heard[..inputs.len().min(MAX_INPUTS)];
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

/// What [`Awake::render_bank`] renders.
#[derive(Debug)]
pub struct Bank<'a> {
    /// The instructions.
    pub kernel: Kernel,
    /// The modes, slowest decay first.
    pub groups: &'a [ModeGroup],
    /// Their states.
    pub states: &'a mut [GroupState],
    /// How many leading groups hear the inputs.
    pub driven: usize,
    /// Amplitude below which a mode is put to rest, output units.
    pub threshold: f32,
}

const SILENCE: [f32; GRID_SAMPLES as usize] = [0.0; GRID_SAMPLES as usize];

/// Whether any impulse is not zero. All bits but the sign, or'ed: many at a time where `any` looks at one.
fn is_struck(impulses: &[f32]) -> bool {
    impulses.iter().fold(0, |bits, u| bits | (u.to_bits() << 1)) != 0
}
