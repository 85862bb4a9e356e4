//! Offline, `f64`: one recorded impact becomes modes that ring.
//!
//! ```text
//! y(t) = Σ amplitude · e^(−decay_per_s t) · sin(2π frequency_hz t + phase_rad)      t from the onset
//! ```
//! The files in the order of the way from a WAV file to a body:
//!
//! | file | from → to |
//! |---|---|
//! | [`recording`] | file → one channel |
//! | [`onset`] | channel → one strike |
//! | [`strike`] | strike → modes: the whole way ([`fit`]) |
//! | [`analysis`] | segment → partials: levels, refinement, proof |
//! | `candidates` | residual → what may be modes |
//! | [`sub_band`] | segment → decimated bands |
//! | [`noise_floor`] | segment → noise variance per frequency |
//! | [`tilt`] | residual → noise that is steep over frequency |
//! | [`model_order`] | band → does it hold modes, how many |
//! | [`esprit`] | band → poles |
//! | [`amplitudes`] | poles → amplitudes |
//! | [`refinement`] | partials → maximum-likelihood partials |
//! | [`pruning`] | partials → proven partials with standard deviations |
//! | [`suspicion`] | partials → warnings: hum, no decay, not exponential |
//! | [`fitted`] | what comes out |
//! | [`residual`] | what modes do not explain |
//! | [`scaling`] | modes → modes of another size or material |
//! | [`merge`] | fits of several strikes → one body with amplitudes per strike |
//! | [`table`] | modes ↔ CSV, and other programs' tables |
//! | [`partial`], [`geometric_sum`], [`projection`], [`normal_equations`] | the damped sinusoid, its sums, its passes over samples, its least squares |

pub mod amplitudes;
pub mod analysis;
mod candidates;
pub mod contact;
pub mod esprit;
pub mod fitted;
pub mod geometric_sum;
pub mod merge;
pub mod merging;
pub mod model_order;
pub mod noise_floor;
pub mod normal_equations;
pub mod onset;
pub mod partial;
pub mod projection;
pub mod pruning;
pub mod recording;
pub mod refinement;
pub mod residual;
pub mod scaling;
pub mod strike;
pub mod sub_band;
pub mod suspicion;
pub mod table;
pub mod tilt;

pub use fitted::{Fit, FittedMode, Warning};
pub use recording::{ChannelChoice, Recording, RecordingError, load};
pub use strike::{FitError, FitOptions, fit};
