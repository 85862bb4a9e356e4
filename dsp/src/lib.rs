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
//! | [`butterworth`] | positions → smooth positions |
//! | [`gradient_noise_3d`] | a point in space → solid noise and its gradient |
#![no_std]

#[cfg(any(feature = "std", test))]
extern crate std;

pub mod butterworth;
mod error;
pub mod gradient_noise_3d;
pub mod mode;
pub mod rng;

pub use error::DesignError;
