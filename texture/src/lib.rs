//! What a surface is.
//!
//! *Real time*: [`height_field`] is the trait through which the engine samples any surface along a
//! contact path; the other real-time files implement it.
//! *Offline* (feature `offline`): tools that make surfaces from pictures and from other surfaces.

#[cfg(feature = "brownian")]
pub mod brownian;
pub mod change;
pub mod combine;
pub mod fade;
pub mod height_field;
pub mod lattice;
pub mod raster;
pub mod sand;
pub mod solid_materials;
pub mod solid_noise;
