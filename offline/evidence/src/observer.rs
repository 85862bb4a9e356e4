//! A frozen observer: told apart by it means told apart by a machine with people's noise, and no
//! better.
//!
//! A classifier without noise parts surfaces that no finger parts. This one has a signal only
//! through what the literature says a hand and an ear know of it: nothing below threshold, levels
//! to within a difference threshold, four looks at most, and a slip now and then. No constant of it
//! was fitted to an answer that it is asked to give; [`constants`] names where each comes from, and
//! [`constants_sha256`] is printed beside every result, so that a changed judge is seen.
//!
//! ```text
//! signal → band levels over threshold (looks of 1 s)           [`touch`], [`sound`]
//!        → fluctuation of three groups in frames of 0.1 s
//!        → level by the place of the hand, where the task gives it
//!        → + κ σ N(0, 1) each                                   [`judge`]
//!        → the class whose templates make it most likely; a guess in 2 % of trials
//! ```
//! κ = 1 is the observer; ½ and 2 are printed beside it because σ is known to about a factor of
//! two, and κ = 0 is the classifier without noise, the ceiling. Templates are rendered with other
//! seeds, paths, speeds and forces than what is asked.

pub mod constants;
pub mod judge;
pub mod second;
pub mod sound;
mod spectra;
pub mod touch;

pub use constants::constants_sha256;
pub use judge::{Confusion, Judge, Percept};
