//! The audio thread's half: never allocates, locks, waits or fails.

pub(crate) mod binding;
pub(crate) mod blows;
pub(crate) mod body_seat;
pub(crate) mod governor;
pub(crate) mod index_set;
pub(crate) mod outlets;
mod pool;
pub(crate) mod renderer;
pub(crate) mod seat;
pub(crate) mod shared;
pub(crate) mod smoothed;
pub(crate) mod voice;
