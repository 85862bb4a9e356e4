//! Surfaces from pictures: photographs, normal maps, analysis, tactile metamers, files to print.
//!
//! Offline: nothing of it is part of a game's build. Inputs and outputs are
//! [`Raster`](asperity_surface::raster::Raster)s, which the engine reads as maps.
//!
//! | you have | begin with |
//! |---|---|
//! | a photograph | [`photograph`], [`from_photo`] |
//! | a normal map | [`normal_map`], [`gradient_field`] |
//! | a map that should only feel alike | [`metamer`] |
//! | a question about a map | [`fractal_dimension`], [`symmetry`] |
//! | a printer | [`stl`] |

pub mod borders;
pub mod camera_noise;
pub mod darkness_prior;
pub mod distribution;
pub mod fft2;
pub mod flat_ground;
pub mod fractal_dimension;
pub mod from_photo;
pub mod gradient_field;
pub mod histogram;
pub mod light;
pub mod metamer;
pub mod normal_map;
pub mod photograph;
pub mod pyramid;
pub mod relief_spectrum;
pub mod shape_from_shading;
mod side_by_side;
pub mod spectral_envelope;
pub mod spectral_resample;
pub mod stl;
pub mod symmetry;
mod waves;
