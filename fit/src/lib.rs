//! Offline, `f64`: one recorded impact becomes modes that ring.
//!
//! ```text
//! y(t) = Σ amplitude · e^(−decay_per_s t) · sin(2π frequency_hz t + phase_rad)      t from the onset
//! ```
//! The files in the order of the way from a WAV file to a body:
//!
//! | file | from → to |
//! |---|---|
//! | `sound_file`, `wav_file`, `packed_file` | WAV; FLAC, Ogg → frames |
//! | [`recording`] | file → one channel |
//! | [`onset`] | channel → strikes, and the best of them |
//! | [`strike`] | strike → modes: the whole way ([`fit`]) |
//! | [`sum_of_modes`] | segment → may it be a sum of modes in noise |
//! | `ways` | segment → modes as one of three: a sum of modes, a push and a sum of modes, neither |
//! | [`contact`] | segment → where the striker may have let go |
//! | [`ringing`] | segment → is there anything but noise; partials → which stand out of steep noise |
//! | [`analysis`] | sum of modes → partials: levels, refinement, proof |
//! | [`tail_to_attack`], [`ranking`] | any other recording → partials: stages from the tail to the attack, those that are heard |
//! | [`merging`], `one_mode` | partials of one stage, of all stages → one for each resonance |
//! | `candidates` | residual → what may be modes |
//! | [`sub_band`] | segment → decimated bands |
//! | [`noise_floor`] | segment → noise variance per frequency |
//! | [`tilt`] | residual → noise that is steep over frequency |
//! | [`model_order`] | band → does it hold modes, how many |
//! | [`esprit`] | band → poles |
//! | [`amplitudes`] | poles → amplitudes |
//! | [`refinement`] | partials → maximum-likelihood partials |
//! | [`pruning`] | partials → proven partials with standard deviations |
//! | [`suspicion`], [`warning`] | partials → warnings: hum, no decay, not exponential |
//! | `rumble` | partials → those from the lowest partial of the body on |
//! | [`mod@struck`] | partials → what the engine plays |
//! | [`fitted`] | what comes out |
//! | [`residual`] | what modes do not explain |
//! | [`scaling`] | modes → modes of another size or material |
//! | [`merge`] | fits of several strikes → one body with amplitudes per strike |
//! | [`table`] | modes ↔ CSV, and other programs' tables |
//! | [`partial`], [`geometric_sum`], [`projection`], [`normal_equations`] | the damped sinusoid, its sums, its passes over samples, its least squares |
//!
//! On real recordings: `cargo run --release -p asperity-fit --example recordings` (60 modes against as many peaks of a
//! short-time spectrum) and `--example struck` (as the engine plays them).

pub mod amplitudes;
pub mod analysis;
mod candidates;
pub mod contact;
pub mod esprit;
pub mod fitted;
pub mod geometric_sum;
pub mod limits;
mod median_spectrum;
pub mod merge;
pub mod merging;
pub mod model_order;
pub mod noise_floor;
pub mod normal_equations;
mod one_mode;
pub mod onset;
mod options;
mod packed_file;
pub mod partial;
pub mod projection;
pub mod pruning;
pub mod ranking;
pub mod recording;
pub mod refinement;
pub mod residual;
pub mod ringing;
mod rumble;
pub mod scaling;
mod sound_file;
mod sound_format;
pub mod strike;
pub mod struck;
pub mod sub_band;
pub mod sum_of_modes;
pub mod suspicion;
pub mod table;
pub mod tail_to_attack;
pub mod tilt;
pub mod warning;
mod wav_file;
mod ways;

pub use fitted::{Fit, FittedMode, Warning};
pub use options::FitOptions;
pub use recording::{ChannelChoice, Recording, RecordingError, load};
pub use strike::{FitError, fit};
