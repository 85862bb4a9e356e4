//! Maximum-likelihood partials, one for each resonance, and the proof that each is there.

pub mod merging;
pub mod pruning;
pub mod refinement;
