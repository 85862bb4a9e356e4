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
//! | [`trajectory`] | sparse contact events → path, velocity and force at every sample |
//! | [`butterworth`] | the path's smoothing filter, and every high-pass |
//! | [`fractal_noise`], [`gradient_noise_2d`] | path → 1/f^α micro-relief |
//! | [`gradient_noise_3d`] | a point in space → solid noise and its gradient |
//! | [`micro_contact`] | profile heights and normal force → pad, contact force, collisions |
//! | [`hertz`] | impacts → force pulses → impulses a sample |
//! | [`mobility`] | force pulses → what the hand feels of an impact |
//! | [`mode`], [`modal_bank`] | impulses → sound |
//! | [`diffuse`] | impulses → noise between the modes |
//! | [`masking`] | modes → the order in which nobody would miss them |
//! | [`held`] | contacts that press on a body → its pitches and decays |
//! | [`radiation`] | motion of a surface → pressure at 1 m |
//! | [`damping`] | a material → the decays of its modes |
//! | [`rolling`] | profile → what a rolling thing feels of it |
//! | [`stick_slip`] | sweep and normal force → friction force, with the body that gives way |
//! | [`tangential`] | friction force → skin dragged sideways |
//! | [`actuator`] | pad motion → haptic samples |
//! | [`sensation`], [`vibration_points`] | haptic samples → points for hardware that plays no waveform |
//! | [`limits`] | what all of them accept |
//! | [`simd`] | instruction sets, chosen at run time |
//! | [`rng`] | seeded numbers for all of them |
//! | [`pair`] | two filters in one register |
#![no_std]

#[cfg(any(feature = "std", test))]
extern crate std;

pub mod actuator;
pub mod bessel;
pub mod butterworth;
pub mod damping;
pub mod diffuse;
mod error;
pub mod fractal_noise;
pub mod gradient_noise_2d;
pub mod gradient_noise_3d;
pub mod held;
pub mod hertz;
pub mod limits;
pub mod masking;
pub mod micro_contact;
pub mod mobility;
pub mod modal_bank;
pub mod mode;
pub mod pair;
pub mod radiation;
pub mod rng;
pub mod rolling;
pub mod sensation;
pub mod sensor;
pub mod simd;
pub mod stick_slip;
pub mod tangential;
pub mod trajectory;
pub mod vector;
pub mod vibration_points;

pub use error::DesignError;
