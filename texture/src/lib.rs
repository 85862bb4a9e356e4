//! What a surface is.
//!
//! *Real time*: [`height_field`] is the trait through which the engine samples any surface along a
//! contact path; the other real-time files implement it.
//! *Offline* (feature `offline`): tools that make surfaces from pictures and from other surfaces.

#[cfg(feature = "offline")]
pub mod fractal_dimension;
pub mod height_field;
pub mod raster;
#[cfg(feature = "offline")]
pub mod symmetry;
