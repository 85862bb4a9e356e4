//! Which partials are proven, and what is to be said against them.

pub mod pruning;
pub mod suspicion;
pub mod warning;
