//! The game thread's half: takes resources and reports, checks them, stamps them, sends them.

pub(crate) mod clipping;
pub(crate) mod clock;
pub(crate) mod contradiction;
pub(crate) mod levels;
pub(crate) mod places;
pub(crate) mod recording;
pub(crate) mod scene;
pub(crate) mod silence;
pub(crate) mod slips;
pub(crate) mod tip;
pub(crate) mod variation;
