#![doc = include_str!("../README.md")]
//!
//! # The map of this crate
//!
//! | file | holds |
//! |---|---|
//! | `notice` | what a game should know of its things |
//! | `side` | one of the two: what it is to asperity, and how it moves |
//! | `pair` | one pair over time: lands, slides, rolls, rests, leaves |
//! | `face` | how long a thing lies along its stroke, and the probe for that |
//! | `step` | what of a pair's step follows from mechanics alone |
//! | `world` | a world of pairs from arrays |

mod face;
mod notice;
mod pair;
mod side;
mod step;
mod world;

pub use face::{FACES_M, Points, Probes};
pub use notice::{Notice, ODD_GRAVITY_M_S2, ODD_SIZE_M};
pub use pair::{Doing, Kind, Pair};
pub use side::{EDGE_RADIUS_M, Motion, Side, Thing, axis_radius_m, lies_across, mobility_per_kg, radius_m};
pub use step::{NOMINAL_FORCE_N, Solved, Step};
pub use world::{Collider, Contact, Form, Placed, World};

/// Vectors in space, m or m/s, and turns.
pub use glam::{Mat3, Vec3};
