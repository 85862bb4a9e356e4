//! The damped sinusoid: its sums, its passes over samples, its least squares.

pub mod amplitudes;
pub mod geometric_sum;
pub mod normal_equations;
pub mod partial;
pub mod projection;
