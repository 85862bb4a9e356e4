//! Mesh of a body as a file gives it: its volume, or its surface alone.

use crate::surface_mesh::SurfaceMesh;
use crate::volume_mesh::VolumeMesh;

/// A body's shape as it came.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// Cut into tetrahedra.
    Volume(VolumeMesh),
    /// Its surface only.
    Surface(SurfaceMesh),
}
