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
//! | [`contact`] | segment → where the striker may have let go |
//! | [`ringing`] | segment → is there anything but noise; partials → which stand out of steep noise |
//! | [`analysis`] | sum of modes → partials: levels, refinement, proof |
//! | [`tail_to_attack`], [`ranking`] | any other recording → partials: stages from the tail to the attack, those that are heard |
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
//! | [`mod@struck`] | partials → what the engine plays |
//! | [`fitted`] | what comes out |
//! | [`residual`] | what modes do not explain |
//! | [`scaling`] | modes → modes of another size or material |
//! | [`merge`] | fits of several strikes → one body with amplitudes per strike |
//! | [`table`] | modes ↔ CSV, and other programs' tables |
//! | [`partial`], [`geometric_sum`], [`projection`], [`normal_equations`] | the damped sinusoid, its sums, its passes over samples, its least squares |
//!
//! Real recordings (the test corpus), at most 60 modes against as many peaks of a short-time spectrum; resynthesis
//! SNR from the onset on, dB, the contact included (`cargo run --release -p asperity-fit --example recordings`):
//!
//! | recording | peaks | modes kept | fit |
//! |---|---|---|---|
//! | `glockenspiel_2096.57` | 8.6 | 15 | 14.9 |
//! | `js30_metal-ping-1` | 0.8 | 55 | 13.2 |
//! | `kenney_impactBell_heavy_000` | 1.6 | 42 | 25.2 |
//! | `kenney_impactGlass_light_000` | 15.5 | 24 | 29.1 |
//! | `kenney_impactMetal_light_000` | 16.2 | 18 | 27.5 |
//! | `sonicpi_perc_bell` | 0.1 | 49 | 21.7 |
//! | `vcsl_Agogo_High_v1_rr1_Mid` | 2.6 | 43 | 8.8 |
//! | `vcsl_Agogo_High_v2_rr1_Mid` | 0.8 | 44 | 8.1 |
//! | `vcsl_Agogo_High_v3_rr1_Mid` | 3.5 | 53 | 9.5 |
//! | `vcsl_Claves1_Hit_v3_rr1_Mid` | 1.6 | 35 | 7.2 |
//! | `vcsl_wood_click_ff` | 0.5 | 42 | 15.2 |
//! | `vcsl_xylo_medium_C5_ff` | 9.7 | 28 | 14.8 |
//! | `vcsl_xylo_medium_C5_pp` | 10.3 | 36 | 11.4 |
//! | `vibraphone_1255.513` | 13.8 | 16 | 15.9 |

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
pub mod onset;
mod packed_file;
pub mod partial;
pub mod projection;
pub mod pruning;
pub mod ranking;
pub mod recording;
pub mod refinement;
pub mod residual;
pub mod ringing;
pub mod scaling;
mod sound_file;
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

pub use fitted::{Fit, FittedMode, Warning};
pub use recording::{ChannelChoice, Recording, RecordingError, load};
pub use strike::{FitError, FitOptions, fit};
