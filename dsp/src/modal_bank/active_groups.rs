//! The groups that ring: the others cost nothing until they are struck again.

use super::design::{GRID_SAMPLES, GroupState, ModeGroup};
use super::job::{Input, MAX_INPUTS};
use super::kernel::Kernel;
use super::shedding::{MODE_LEVELS, SheddingLevels};
use core::ops::Range;

/// Inputs of an ordinary call.
const FEW_INPUTS: usize = 4;

/// Which groups ring: of each section of the bank, one between two levels of modes left out, how
/// many leading ones. Within a section what rings longest stands first, and the sections stand in
/// the order of need ([`super::shedding_order`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ActiveGroups {
    /// Beginnings of the sections, and the end of the last.
    bounds: [usize; MODE_LEVELS + 1],
    groups: [usize; MODE_LEVELS],
    /// True where a section is rendered together with the one behind it. It changes on the grid
    /// only, because groups that are rendered together share what a turn that is cut keeps.
    joined: [bool; MODE_LEVELS],
    /// True where every group rings, as in a body that is being stroked: nothing is to be looked
    /// for then.
    all_ring: bool,
}

impl ActiveGroups {
    /// As states are, where modes are left out at these levels.
    pub(super) fn of(states: &[GroupState], levels: &SheddingLevels) -> Self {
        let mut bounds = [0; MODE_LEVELS + 1];
        for (section, level) in (1..MODE_LEVELS).zip((1..MODE_LEVELS).rev()) {
            bounds[section] = levels[level].clamp(bounds[section - 1], states.len());
        }
        bounds[MODE_LEVELS] = states.len();
        let (groups, joined) = ([0; MODE_LEVELS], [true; MODE_LEVELS]);
        let mut active_groups = Self { bounds, groups, joined, all_ring: false };
        for (groups, ends) in active_groups.groups.iter_mut().zip(bounds.windows(2)) {
            let states = &states[ends[0]..ends[1]];
            *groups = states.iter().rposition(|state| !state.is_at_rest()).map_or(0, |last| last + 1);
        }
        active_groups.join();
        active_groups
    }

    /// Nothing rings any more.
    pub(super) fn sleep(&mut self) {
        (self.groups, self.joined, self.all_ring) = ([0; MODE_LEVELS], [true; MODE_LEVELS], false);
    }

    /// Number of leading groups that hold all that are rendered at the moment.
    pub(super) fn groups(&self) -> usize {
        if self.all_ring {
            return self.bounds[MODE_LEVELS];
        }
        let last = self.groups.iter().rposition(|groups| *groups > 0);
        last.map_or(0, |section| self.bounds[section] + self.groups[section])
    }

    /// A section whose groups all ring goes on in the one behind, and so does one that sleeps
    /// before one that sleeps.
    fn join(&mut self) {
        for (section, joined) in self.joined.iter_mut().enumerate() {
            let (active_groups, next) =
                (self.groups[section], self.groups.get(section + 1).copied().unwrap_or(0));
            *joined = active_groups == self.bounds[section + 1] - self.bounds[section]
                || (active_groups == 0 && next == 0);
        }
        self.note_whether_all_ring();
    }

    fn note_whether_all_ring(&mut self) {
        let all_awake = self
            .groups
            .iter()
            .zip(self.bounds.windows(2))
            .all(|(active_groups, ends)| ends[0] + active_groups == ends[1]);
        self.all_ring = all_awake && self.joined == [true; MODE_LEVELS] && self.bounds[MODE_LEVELS] > 0;
    }

    /// Renders what rings, skipping what sleeps: groups wake with the first impulse that is not
    /// zero and are settled on the absolute grid. Of the groups the first [`Bank::driven`] hear
    /// anything; the others ring out. `shared`: one input without gains.
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
        let all = groups.len().min(states.len());
        let (groups, states, driven) = (&groups[..all], &mut states[..all], driven.min(all));
        let mut heard = [Input { impulses: &[], gains: &[] }; MOST];
        let heard = &mut heard[..inputs.len().min(MOST)];
        let samples = inputs.iter().fold(out.len(), |n, input| n.min(input.impulses.len()));
        let mut at = 0;
        while at < samples {
            let now = first_sample.wrapping_add(at as u64);
            let len = ((GRID_SAMPLES - now % GRID_SAMPLES) as usize).min(samples - at);
            let part = at..at + len;
            if self.sleeps(driven)
                && inputs[..heard.len()].iter().any(|input| is_struck(&input.impulses[part.clone()]))
            {
                self.wake(driven);
            }
            // Several runs are added up first: what `out` holds already must not come between them,
            // or bits would depend on who rings first.
            let (mut together, several) = (SILENCE, self.takes_several_calls(driven));
            let y = if several { &mut together[..len] } else { &mut out[part.clone()] };
            self.each_run(|run| {
                let (to_hear, deaf) = (run.start..run.end.min(driven), run.start.max(driven)..run.end);
                if !deaf.is_empty() {
                    kernel.render(now, &groups[deaf.clone()], &mut states[deaf], &SILENCE[..len], y);
                }
                if to_hear.is_empty() {
                    return;
                }
                for (heard, input) in heard.iter_mut().zip(inputs) {
                    let gains = input.gains.get(to_hear.start..).unwrap_or_default();
                    *heard = Input { impulses: &input.impulses[part.clone()], gains };
                }
                let (groups, states) = (&groups[to_hear.clone()], &mut states[to_hear]);
                match heard {
                    [input] if shared => kernel.render(now, groups, states, input.impulses, y),
                    _ => kernel.render_mixed(now, groups, states, heard, y),
                }
            });
            if several {
                out[part].iter_mut().zip(&together).for_each(|(sum, x)| *sum += x);
            }
            if now.wrapping_add(len as u64).is_multiple_of(GRID_SAMPLES) {
                for (from, active_groups) in self.bounds.iter().zip(&mut self.groups) {
                    let ringing = *from..from + *active_groups;
                    *active_groups = kernel.settle(&groups[ringing.clone()], &mut states[ringing], threshold);
                }
                self.join();
            }
            at += len;
        }
    }

    /// Tests whether any of the first `driven` groups sleeps.
    fn sleeps(&self, driven: usize) -> bool {
        if self.all_ring {
            return false;
        }
        let mut sections = self.groups.iter().zip(self.bounds.windows(2));
        sections.any(|(active_groups, ends)| ends[0] + active_groups < ends[1].min(driven))
    }

    /// Wakes the first `driven` groups.
    fn wake(&mut self, driven: usize) {
        for (active_groups, ends) in self.groups.iter_mut().zip(self.bounds.windows(2)) {
            *active_groups = (*active_groups).max(driven.clamp(ends[0], ends[1]) - ends[0]);
        }
        self.note_whether_all_ring();
    }

    /// Tests whether more than one run is rendered, or one of which a part is driven.
    fn takes_several_calls(&self, driven: usize) -> bool {
        if self.all_ring {
            return driven > 0 && driven < self.bounds[MODE_LEVELS];
        }
        let mut calls = 0;
        self.each_run(|run| calls += usize::from(run.start < driven) + usize::from(run.end > driven));
        calls > 1
    }

    /// Groups that are rendered together, run after run.
    fn each_run(&self, mut render: impl FnMut(Range<usize>)) {
        if self.all_ring {
            return render(0..self.bounds[MODE_LEVELS]);
        }
        let mut section = 0;
        while section < MODE_LEVELS {
            let (start, mut end) = (self.bounds[section], self.bounds[section]);
            loop {
                if self.groups[section] > 0 {
                    end = self.bounds[section] + self.groups[section];
                }
                if !self.joined[section] || section + 1 == MODE_LEVELS {
                    break;
                }
                section += 1;
            }
            if start < end {
                render(start..end);
            }
            section += 1;
        }
    }
}

/// Groups that are rendered.
#[derive(Debug)]
pub(super) struct Bank<'a> {
    /// The instructions.
    pub(super) kernel: Kernel,
    /// The modes, in the order of need.
    pub(super) groups: &'a [ModeGroup],
    /// Their states.
    pub(super) states: &'a mut [GroupState],
    /// Number of leading groups that the inputs drive.
    pub(super) driven: usize,
    /// Amplitude below which a mode is put to rest, output units.
    pub(super) threshold: f32,
}

const SILENCE: [f32; GRID_SAMPLES as usize] = [0.0; GRID_SAMPLES as usize];

/// Tests whether any impulse is not zero. All bits but the sign, or'ed: many at a time where `any`
/// looks at one.
fn is_struck(impulses: &[f32]) -> bool {
    impulses.iter().fold(0, |bits, u| bits | (u.to_bits() << 1)) != 0
}
