//! Maximum-likelihood partials, one for each resonance.

pub mod merging;
pub mod refinement;
