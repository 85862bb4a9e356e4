//! Memory in which a block of a map is worked out.
//!
//! It belongs to the block that is filled, which the caller has at hand: one of every map's own
//! would be far away, one on the stack would have to be cleared for every block.

use super::{Places, Samples};

/// It holds nothing between two blocks.
#[derive(Debug, Clone)]
pub(crate) struct Working {
    pub(crate) places: Places,
    pub(crate) samples: Samples,
    /// Two levels that are blended.
    pub(crate) levels: [Samples; 2],
}

impl Working {
    pub(crate) const fn new() -> Self {
        Self { places: Places::new(), samples: Samples::EMPTY, levels: [Samples::EMPTY; 2] }
    }
}
