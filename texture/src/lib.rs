//! What a surface is.
//!
//! *Real time*: [`height_field`] is the trait through which the engine samples any surface along a
//! contact path; the other real-time files implement it.
//! *Offline* (feature `offline`): tools that make surfaces from pictures and from other surfaces.

#[cfg(feature = "offline")]
pub mod borders;
#[cfg(feature = "offline")]
pub mod fft2;
pub mod height_field;
#[cfg(feature = "offline")]
pub mod histogram;
#[cfg(feature = "offline")]
pub mod metamer;
#[cfg(feature = "offline")]
pub mod pyramid;
pub mod raster;
#[cfg(feature = "offline")]
pub mod resample;
