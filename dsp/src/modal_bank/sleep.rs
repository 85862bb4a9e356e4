//! Sleep: what has rung out is put exactly to rest and costs nothing until it is struck again.

use super::Kernel;
use super::design::{GRID_SAMPLES, GroupState, ModeGroup};

/// Amplitudes beyond this are no vibration but a broken state, which is put to rest.
const ABSURD_AMPLITUDE: f32 = 1e15;

/// −120 dB of full scale for a bank whose output is full scale at 1.
pub const SLEEP_AMPLITUDE: f32 = 1e-6;

/// See [`Kernel::settle`].
#[inline(always)]
pub(super) fn settle(groups: &[ModeGroup], states: &mut [GroupState], threshold: f32) -> usize {
    let (low, high) = (threshold * threshold, ABSURD_AMPLITUDE * ABSURD_AMPLITUDE);
    let mut awake = 0;
    for (i, (group, state)) in groups.iter().zip(states).enumerate() {
        let mut rings = 0_u32;
        for (lane, (y, d)) in state.y.iter_mut().zip(&mut state.d).enumerate() {
            let a = group.level[lane] * *y;
            let b = group.quad_y[lane] * *y + group.quad_d[lane] * *d;
            let square = a * a + b * b;
            // False for NaN as well.
            let keep = (square >= low) & (square < high) & (square > 0.0);
            *y = if keep { *y } else { 0.0 };
            *d = if keep { *d } else { 0.0 };
            rings += u32::from(keep);
        }
        if rings > 0 {
            awake = i + 1;
        }
    }
    awake
}

/// Energy of a group's ringing: the sum over its lanes of the squared amplitude, output units squared.
#[must_use]
pub fn energy(group: &ModeGroup, state: &GroupState) -> f32 {
    let mut sum = 0.0;
    for lane in 0..super::LANES {
        let a = group.level[lane] * state.y[lane];
        let b = group.quad_y[lane] * state.y[lane] + group.quad_d[lane] * state.d[lane];
        sum += a * a + b * b;
    }
    sum
}

/// Renders only the groups that ring. Designed from modes that [`super::sort_by_decay`] has sorted, the
/// groups fall asleep from the end.
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
        let samples = out.len().min(impulses_n_s.len());
        let mut at = 0;
        while at < samples {
            let now = first_sample.wrapping_add(at as u64);
            let len = ((GRID_SAMPLES - now % GRID_SAMPLES) as usize).min(samples - at);
            let (impulses, y) = (&impulses_n_s[at..at + len], &mut out[at..at + len]);
            // All bits but the sign, or'ed: many at a time where `any` looks at one.
            let struck = || impulses.iter().fold(0, |bits, u| bits | (u.to_bits() << 1)) != 0;
            if self.groups < groups.len() && struck() {
                self.groups = groups.len();
            }
            let awake = self.groups.min(groups.len()).min(states.len());
            let (groups, states) = (&groups[..awake], &mut states[..awake]);
            kernel.render(now, groups, states, impulses, y);
            if now.wrapping_add(len as u64).is_multiple_of(GRID_SAMPLES) {
                self.groups = kernel.settle(groups, states, threshold);
            }
            at += len;
        }
    }
}
