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
//!
//! The rooms, each above those it uses: [`damped`] and [`noise`], then [`proof`], [`refine`], [`search`], [`stages`], [`played`], [`after`]; [`sound`]
//! holds the files and the strikes in them.
//!
//! On real recordings: `cargo run --release -p asperity-fit --example recordings` (60 modes against as many peaks of a
//! short-time spectrum) and `--example struck` (as the engine plays them).

pub mod fitted;
pub mod limits;
mod options;
pub mod strike;

pub mod after;
pub mod damped;
pub mod noise;
pub mod played;
pub mod proof;
pub mod refine;
pub mod search;
pub mod sound;
pub mod stages;

pub use after::{merge, scaling, table};
pub use damped::{amplitudes, geometric_sum, normal_equations, partial, projection};
pub use fitted::{Fit, FittedMode, Warning};
pub use noise::{noise_floor, ringing, tilt};
pub use options::FitOptions;
pub use played::{residual, struck};
pub use proof::{suspicion, warning};
pub use refine::{merging, pruning, refinement};
pub use search::{esprit, model_order, sub_band};
pub use sound::recording::{ChannelChoice, Recording, RecordingError, load};
pub use sound::{onset, recording};
pub use stages::{analysis, contact, ranking, sum_of_modes, tail_to_attack};
pub use strike::{FitError, fit};
