//! Offline, `f64`: one recorded impact becomes modes that ring.
//!
//! ```text
//! y(t) = Σ amplitude · e^(−decay_per_s t) · sin(2π frequency_hz t + phase_rad)      t from the onset
//! ```
//! The whole way is [`fit`] (`strike`); its rooms, in the order in which each may use those above
//! it:
//!
//! | room | from → to |
//! |---|---|
//! | [`recording`] | WAV, FLAC, Ogg → one channel → its strikes, and the best of them |
//! | `sinusoid` | the damped sinusoid, its sums in closed form, its joint least squares |
//! | `noise` | residual → noise variance per frequency, however steep |
//! | [`proof`] | partials → those that the data prove, and warnings about the others |
//! | `search` | residual → bands, poles in them, candidates for modes |
//! | `ways` | sound → partials: as a sum of modes, a push and a sum of modes, or from the tail to the attack |
//! | [`body`] | partials → what the engine will play, and what that leaves of the recording |
//! | [`device`] | a recorded sweep → the profile of an actuator |
//! | [`after`] | modes → other sizes and materials, several strikes of one body, tables |
//!
//! On real recordings: `cargo run --release -p asperity-fit --example recordings` (60 modes against
//! as many peaks of a short-time spectrum) and `--example struck` (as the engine plays them).

pub mod after;
pub mod body;
pub mod device;
mod noise;
mod options;
pub mod proof;
pub mod recording;
mod search;
mod sinusoid;
mod strike;
mod ways;

pub use body::fitted::{Fit, FittedMode};
pub use options::FitOptions;
pub use proof::warning::Warning;
pub use recording::{ChannelChoice, Recording, RecordingError, load};
pub use strike::{FitError, fit};
