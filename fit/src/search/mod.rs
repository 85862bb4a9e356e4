//! What may be a mode: bands, their order, poles.

pub(crate) mod candidates;
pub mod esprit;
pub mod model_order;
pub mod sub_band;
