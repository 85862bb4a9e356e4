//! What is noise: its floor, its slope, and whether there is anything else.

pub(crate) mod median_spectrum;
pub mod noise_floor;
pub mod ringing;
pub mod tilt;
