//! What the engine plays of the partials, and what they leave.

pub mod residual;
pub mod struck;
