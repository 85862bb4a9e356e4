//! Noise: its variance at every frequency, from a recording or from what a fit leaves of one.
//!
//! | file | from → to |
//! |---|---|
//! | [`median_spectrum`] | samples → a spectrum that modes hardly raise |
//! | [`noise_floor`] | samples → noise variance per frequency |
//! | [`tilt`] | residual → noise that is steep over frequency |

pub(crate) mod median_spectrum;
pub(crate) mod noise_floor;
pub(crate) mod tilt;
