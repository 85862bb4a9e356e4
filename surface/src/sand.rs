//! Sand: a surface that gives way, keeps its volume, and slides to its angle of repose.
//!
//! ```text
//! tool ──► cut what is above its lower surface, heap it on the rim and ahead     tool
//!      ──► let slide what is steeper than the talus angle θ                      erosion
//! F_r = k_s (e^{k_c d} − 1)  upwards,  F_f = −k_f v |F_r|  against the motion    law
//! ```
//!
//! | file | one concept |
//! |---|---|
//! | [`grid`] | heights as whole numbers, so that volume is kept exactly |
//! | [`tool`] | any tool by its lower height map: cutting and heaping |
//! | [`erosion`] | sliding to the angle of repose, on active tiles only |
//! | [`law`] | depth and force, drag, wetness, layers, grains |
//! | [`buried`] | stones and shells in it |
//! | [`simulation`] | contacts that drag tools, frame by frame |
//! | [`patch`] | what the audio half sees: 64 × 64 heights around a contact |
//! | `around` | the sand around a contact: its level, and what a patch shows of it |
//! | [`source`] | the surface itself |
//! | `hand_over` | rings between the audio half and the simulation, whose ends never wait |
//! | [`worker`] | the other end of the hand-over, on a thread of its own |
//!
//! Source: Beneš, Dorjgotov, Arns & Bertoline, "Granular Material Interactive Manipulation" (2006).
//! What we read differently or changed is said in each file. The authors' open points that are
//! ours: arbitrary tools, correct volume, wetness, layers, stones and shells, and that sand is
//! heard.

mod around;
pub mod buried;
pub mod erosion;
pub mod grid;
mod hand_over;
pub mod law;
pub mod patch;
mod pose;
pub mod simulation;
pub mod source;
pub mod tool;
pub mod worker;

pub use buried::{Buried, MAX_BURIED};
pub use grid::{SandGrid, SandPicture};
pub use law::{Layer, MAX_LAYERS, SandLaw};
pub use simulation::{SandDesign, SandFigures, SandSimulation};
pub use source::SandSource;
pub use tool::Tool;
pub use worker::{SandThread, SandWorker};
