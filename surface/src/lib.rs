//! Surfaces: sources of height that are sampled in real time.
//!
//! [`height_field`] is the trait through which the engine samples any surface along a contact path;
//! maps, solids, sand and combinations implement it. Tools that make maps from photographs and
//! normal maps are the crate `asperity-pictures`.

// Real time.
mod block;
#[cfg(feature = "brownian")]
pub mod brownian;
pub mod changed_tiles;
pub mod combine;
pub mod exclusive;
pub mod fade;
pub mod footprint;
pub mod force_output;
pub mod force_rendering;
pub mod grating;
pub mod height_field;
pub mod height_map;
pub mod lattice;
mod local_relief;
pub mod moving_picture;
mod opaque;
pub mod raster;
pub mod sand;
pub mod solid_materials;
pub mod solid_noise;
pub mod tiled;
pub mod tip_law;
pub mod triplanar;

// Maps in and out.
pub mod deband;
pub mod dilated;
#[cfg(feature = "image")]
pub mod image_io;
pub mod picture;
mod resample;
mod spline;
pub mod wrap;
