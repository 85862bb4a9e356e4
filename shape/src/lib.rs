//! Bodies from their shape: a mesh and a material become modes that ring wherever the body is struck.

mod delaunay;
pub mod eigenmodes;
pub mod elastic;
mod error;
mod facets;
mod factor;
mod feature_lines;
pub mod filling;
mod lanczos;
pub mod mesh_file;
mod msh;
mod obj;
mod quadratic_tet;
mod sampling;
mod stl;
pub mod surface_mesh;
pub mod system;
mod triangle_tree;
pub mod vector;
pub mod volume_mesh;

pub use elastic::Elastic;
pub use error::ShapeError;
