//! Memory of a map's own in which short blocks are worked out.
//!
//! Whole blocks are worked out on the stack, where the memory is that of the map before: for each of many maps their own would be far away. To clear it
//! costs a short block more than that.

use crate::spline::{Places, Samples};

/// Longest short block, samples.
pub(super) const SHORT: usize = 16;

/// It holds nothing between two blocks.
#[derive(Debug)]
pub(super) struct Short {
    pub(super) places: Places,
    pub(super) samples: Samples,
}

impl Short {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self { places: Places::new(), samples: Samples::EMPTY })
    }
}

impl Clone for Short {
    fn clone(&self) -> Self {
        *Self::new()
    }
}
