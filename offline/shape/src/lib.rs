//! Bodies from their shape: a mesh and a material become modes that ring wherever the body is
//! struck.
//!
//! ```text
//! mesh_file ─► surface_mesh (repair, holes) ─► filling (sampling, delaunay, facets) ─► volume_mesh
//!                                                                                   │
//! damping_fit        surface_field ◄─ eigenmodes (lanczos, factor) ◄─ system (quadratic_tet)
//! ```
//! Offline and in f64; no game links it. Materials are uniform and isotropic: wood, which is
//! neither, comes out of tune. Levels are relative: nothing here has been compared with a measured
//! sound pressure.

pub mod body;
mod curved;
pub mod damping_fit;
mod delaunay;
mod dissection;
pub mod eigenmodes;
pub mod elastic;
mod error;
mod facets;
mod factor;
mod feature_lines;
pub mod filling;
pub mod gltf;
mod holes;
mod lanczos;
pub mod mesh;
pub mod mesh_file;
#[cfg(feature = "modes-file")]
pub mod modes_file;
mod msh;
mod obj;
mod parts;
mod ply;
mod polygon;
mod quadratic_tet;
pub mod repair;
pub mod ringing;
mod sampling;
mod stl;
pub mod surface_field;
pub mod surface_mesh;
pub mod system;
mod text;
mod triangle_tree;
pub mod unwrap;
pub mod volume_mesh;

pub use asperity_dsp::vector;
pub use body::{Fineness, Making, SolvedBody, make, make_as_fine_as};
pub use elastic::Elastic;
pub use error::ShapeError;
pub use mesh::Mesh;
pub use mesh_file::{load, load_part, parse};
