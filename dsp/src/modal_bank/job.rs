//! A job of the bank: groups, states and inputs, and the pieces they are cut into.

use super::design::{GRID_SAMPLES, GroupState, LaneGains, ModeGroup, TURN};

/// Most inputs of a bank.
pub const MAX_INPUTS: usize = 64;

/// One of several inputs of a bank.
#[derive(Debug, Clone, Copy)]
pub struct Input<'a> {
    /// Impulse of each sample, N·s.
    pub impulses: &'a [f32],
    /// Gain of each lane from it, one entry a group ([`super::lane_gains`]).
    pub gains: &'a [LaneGains],
}

/// The inputs of one call; `shared` means one input, gain 1.
#[derive(Clone, Copy)]
pub(super) struct Feed<'a> {
    pub inputs: &'a [Input<'a>],
    pub shared: bool,
}

pub(super) struct Job<'a> {
    pub groups: &'a [ModeGroup],
    pub states: &'a mut [GroupState],
    pub feed: Feed<'a>,
    /// The two impulses of each pair of the chunk's whole turns, added; of the shared input only.
    pub pairs: [f32; GRID_SAMPLES as usize / 2],
}

impl Job<'_> {
    /// Once for all modes what each would add up again.
    #[inline(always)]
    pub(super) fn add_pairs(&mut self, chunk: Chunk) {
        if let (true, [input]) = (self.feed.shared, self.feed.inputs) {
            let heard = &input.impulses[chunk.at + chunk.skipped()..chunk.at + chunk.len];
            for (sum, pair) in self.pairs.iter_mut().zip(heard.as_chunks::<2>().0) {
                *sum = pair[0] + pair[1];
            }
        }
    }
}

/// Some samples within one turn of the grid.
#[derive(Clone, Copy)]
pub(super) struct Chunk {
    /// Place in the block at which it begins.
    pub at: usize,
    pub len: usize,
    /// Which sample of a turn it begins with.
    pub phase: usize,
    /// It ends on the grid, where states are trimmed.
    pub ends_on_grid: bool,
}

impl Chunk {
    /// Samples before its first whole turn.
    pub fn skipped(&self) -> usize {
        ((TURN - self.phase) % TURN).min(self.len)
    }
}

/// Which group and which lane of it a set begins with.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub from: usize,
    pub lane: usize,
}
