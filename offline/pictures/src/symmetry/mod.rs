//! Repeated patterns: the lattice of a picture, its averaged cell, what is left, and the wallpaper
//! group.
//!
//! Source: thesis ch. 7 (statistical feature matrix, Def. 7.3–7.7; lattices from point clouds,
//! §7.2.2). The document's user tunes a threshold and two widths; here nothing is tuned, and "no
//! symmetry" is an answer.
//!
//! | step | file |
//! |---|---|
//! | light taken out | `detrend` |
//! | distortion of every shift | `feature_matrix` |
//! | its minima | `minima` |
//! | lattice, or none | `search`, `nodes` |
//! | lattice of a map that tiles and repeats few times | `torus` |
//! | averaged primitive, symmetric part, residual | `cell` |
//! | lattice by the document's own steps, with its threshold | `document` |
//! | one translation where there are not two; one of 7 groups | `frieze`, `frieze_group` |
//! | point group, one of 17 groups, mean within the fundamental domain | `wallpaper`, `operation` |

mod cell;
mod detrend;
mod document;
mod every_direction;
mod feature_matrix;
mod frieze;
mod frieze_group;
mod lattice;
mod minima;
mod nodes;
mod operation;
mod search;
mod torus;
mod wallpaper;

pub use cell::{AveragedCell, Separation, averaged_cell, separate, with_cell};
pub(crate) use cell::{averaged_even_cell, even_steadiness};
pub(crate) use detrend::detrended;
pub use document::{DocumentSearch, document_lattice};
pub use feature_matrix::{Distortion, FeatureMatrix, absolute_feature_matrix, feature_matrix};
pub use frieze::{Frieze, find_frieze};
pub use frieze_group::FriezeGroup;
pub use lattice::Lattice;
pub use search::{MERIT_LIMIT, SMALLEST_SIDE, best_lattice, find_lattice};
pub use wallpaper::{CellSymmetry, WallpaperGroup, wallpaper_group};
