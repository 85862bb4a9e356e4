//! Pure kernels of asperity: what happens to one sample, and nothing else.
//!
//! Nothing in this crate allocates, reads a clock or a file, starts a thread, keeps a global or
//! panics on sample data. *Design* (fallible, `f64`, once), *coefficients* (plain data) and *state*
//! (infallible, once a sample) are three different things, so that one design serves many contacts.
//!
//! The files in the order of the signal path (Hasti, Fig. 2):
//!
//! | file | from → to |
//! |---|---|
//! | [`trajectory`] | sparse contact events → position, velocity and force a sample |
//! | [`butterworth`] | positions → smooth positions |
//! | [`fractal_noise`] | place and roughness → micro-relief |
//! | [`gradient_noise_2d`] | place → one octave of it |
#![no_std]

#[cfg(any(feature = "std", test))]
extern crate std;

pub mod butterworth;
mod error;
pub mod fractal_noise;
pub mod gradient_noise_2d;
pub mod mode;
pub mod rng;
pub mod trajectory;

pub use error::DesignError;
