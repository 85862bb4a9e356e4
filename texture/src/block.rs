//! Block: how many samples a source is asked for at once.

/// Longest block a source is ever asked for, samples.
pub const MAX_BLOCK: usize = 64;
