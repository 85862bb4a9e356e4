//! Force renderings of a relief (the thesis'): which way the force points that a relief answers
//! with.

/// Which way the force points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rendering {
    /// Out of the surface, from the rate of climbing.
    Orthogonal,
    /// Along the surface, from the slope.
    Lateral,
}
