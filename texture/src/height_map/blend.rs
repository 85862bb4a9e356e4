//! Two levels of a map that are blended.

use crate::spline::{Places, Samples};

/// Buffers that a block is blended from; they hold nothing between two blocks.
pub(super) struct Blend {
    pub(super) places: Places,
    pub(super) finer: Samples,
    pub(super) coarser: Samples,
}

impl Blend {
    pub(super) const fn new() -> Self {
        Self { places: Places::new(), finer: Samples::EMPTY, coarser: Samples::EMPTY }
    }
}
