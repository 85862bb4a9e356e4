//! Surfaces: sources that are sampled in real time, and offline tools that make them.
//!
//! *Real time*: [`height_field`] is the trait through which the engine samples any surface along a
//! contact path; the other real-time files implement it.
//! *Offline* (feature `offline`): tools that make surfaces from pictures and from other surfaces.

// Real time.
pub mod answer;
mod block;
#[cfg(feature = "brownian")]
pub mod brownian;
pub mod changed_tiles;
pub mod combine;
pub mod exclusive;
pub mod fade;
pub mod footprint;
pub mod force_rendering;
pub mod height_field;
pub mod height_map;
pub mod lattice;
mod local_relief;
pub mod moving_picture;
pub mod raster;
pub mod sand;
pub mod solid_materials;
pub mod solid_noise;
pub mod tiled;
pub mod tip_law;
pub mod triplanar;

// Maps in and out.
pub mod deband;
#[cfg(feature = "image")]
pub mod image_io;
pub mod picture;
mod resample;
pub mod ridden;
mod spline;
pub mod stl;
pub mod wrap;

// Offline.
#[cfg(feature = "offline")]
pub mod borders;
#[cfg(feature = "offline")]
pub mod camera_noise;
#[cfg(feature = "offline")]
pub mod dark_is_deep;
#[cfg(feature = "offline")]
pub mod distribution;
#[cfg(feature = "offline")]
pub mod fft2;
#[cfg(feature = "offline")]
pub mod flat_ground;
#[cfg(feature = "offline")]
pub mod fractal_dimension;
#[cfg(feature = "offline")]
pub mod from_photo;
#[cfg(feature = "offline")]
pub mod gradient_field;
#[cfg(feature = "offline")]
pub mod histogram;
#[cfg(feature = "offline")]
pub mod light;
#[cfg(feature = "offline")]
pub mod metamer;
#[cfg(feature = "offline")]
pub mod normal_map;
#[cfg(feature = "offline")]
pub mod pyramid;
#[cfg(feature = "offline")]
pub mod relief_spectrum;
#[cfg(feature = "offline")]
pub mod shape_from_shading;
#[cfg(feature = "offline")]
mod side_by_side;
#[cfg(feature = "offline")]
pub mod spectral_envelope;
#[cfg(feature = "offline")]
pub mod spectral_resample;
#[cfg(feature = "offline")]
pub mod symmetry;
#[cfg(feature = "offline")]
mod waves;
