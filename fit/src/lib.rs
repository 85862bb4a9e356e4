//! Offline, `f64`: one recorded impact becomes modes that ring.

pub mod amplitudes;
pub mod analysis;
pub mod esprit;
pub mod geometric_sum;
pub mod model_order;
pub mod noise_floor;
pub mod partial;
pub mod projection;
pub mod pruning;
pub mod refinement;
pub mod sub_band;
