//! Scratch memory of a map: places and samples of the block at hand.

use crate::spline::{Places, Samples};

/// What a block is worked out in; it holds nothing between two blocks.
#[derive(Debug)]
pub(super) struct Beside {
    pub(super) places: Places,
    pub(super) samples: Samples,
    pub(super) blend: Blend,
}

/// Two levels that are blended.
#[derive(Debug)]
pub(super) struct Blend {
    pub(super) places: Places,
    pub(super) finer: Samples,
    pub(super) coarser: Samples,
}

impl Beside {
    pub(super) fn new() -> Box<Self> {
        let blend = Blend { places: Places::new(), finer: Samples::EMPTY, coarser: Samples::EMPTY };
        Box::new(Self { places: Places::new(), samples: Samples::EMPTY, blend })
    }
}

impl Clone for Beside {
    fn clone(&self) -> Self {
        *Self::new()
    }
}
