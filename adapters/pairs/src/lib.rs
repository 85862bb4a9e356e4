#![doc = include_str!("../README.md")]
//!
//! # The map of this crate
//!
//! | file | holds |
//! |---|---|
//! | `side` | one of the two: what it is to asperity, and how it moves |
//! | `pair` | one pair over time: lands, slides, rolls, rests, leaves |

mod pair;
mod side;

pub use pair::{Doing, Kind, Pair, Solved, Step};
pub use side::{EDGE_RADIUS_M, Motion, Side, Thing, mobility_per_kg, radius_m};

/// Vectors in space, m or m/s.
pub use glam::Vec3;
