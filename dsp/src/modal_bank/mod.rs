//! Modal bank: the modes of a body, struck by impulses (Hasti §III-D).
//!
//! ```text
//! y(t) = Σ aᵢ e^(−dᵢ t) sin(2π fᵢ t + φᵢ)        H(z) = (b₀ + b₁ z⁻¹) / (1 − 2R cos θ z⁻¹ + R² z⁻²)
//! b₀ = a sin φ     b₁ = a R sin(θ − φ)     R = e^(−d step)     θ = 2π f step
//! ```
//! run in *delta form*, the modes across the lanes of the vector unit, two samples u, u' a step and
//! four a turn:
//!
//! ```text
//! d ← R² d − m y + u        y ← y + d        out += (b₀ + b₁) y − b₁ d        m = 1 − 2R cos θ + R²
//!
//! in  w = y − d,  v = (1 − g) y + g d,  g = R² − m:
//! v ← (1 − m) v − m (1 + g) w + u + u'        w ← (1 + g) v + (g² − m) w + u
//! ```
//!
//! and the four outputs after v and w, from what an impulse sounds like n samples later (h₀ = b₀):
//!
//! ```text
//! out_n += hₙ₊₁ (v − w) + hₙ₊₂ w + h₀ u_n + h₁ u_n₋₁ + …        n = 0…3
//! ```
//!
//! | symbol | here |
//! |---|---|
//! | aᵢ, dᵢ, fᵢ, φᵢ | [`crate::mode::Mode`] |
//! | u | the impulse of the sample, N·s: force × step, so that the level does not depend on the rate |
//! | the rows of v and w; the four outputs | one lane of [`ModeGroup`] |
//! | v, w | one lane of [`GroupState`] |
//!
//! Changes to the paper, and their effect:
//! - *Delta form, not the paper's direct form.* Same H(z); in `f32` the direct form is 5 cents off
//!   at 30 Hz and 44.1 kHz and 81 cents at 192 kHz, the delta form under 0.01 cent at both.
//! - *Two samples a step.* v and w are the coordinates in which both impulses of a pair enter with
//!   gain 1: one is the same as an impulse in the last but one sample and another (v − w) in the
//!   last. A mode and sample costs four multiply-adds, phase included, where the plain delta form
//!   needs four and an addition, and its chain of dependent operations is half as long.
//! - *Four samples a turn.* Two steps with the same coefficients in registers, and four outputs
//!   from the states before them. Those are a filter of two taps over h₁…h₅, which takes five
//!   products instead of eight (Winograd's F(4, 2)): 13 multiply-adds a turn and three additions,
//!   for which AVX2 has a third unit. With AVX2 10–13 % faster than two samples at a time with the
//!   states of each pair, and nothing is lost (see *Trim*). What the impulses of a turn send to its
//!   own outputs is one sum for all modes. Turns begin at absolute multiples of four; a block that
//!   cuts one keeps what was heard in the state.
//! - *Trim.* Coefficients have few digits in `f32` (T60 up to 0.1 % off, and hundreds of samples of
//!   white force −92 dB). What the stored step lacks of the exact one is multiplied into the state
//!   once in 64 samples of an absolute grid: T60 within 0.006 %, pitch within 2e-4 cent for 30 Hz
//!   at up to 192 kHz, and a whole bank −114 to −122 dB from the reference (−110 where products are
//!   rounded apart), for 0.06 operations a mode and sample where keeping 1 − R² apart costs a whole
//!   one.
//! - *Phase.* φ costs one operation of four. It is needed even for the paper's φ = 0, because
//!   [`GroupOptions::impulse_kernel_compensation`] turns each mode by the angle of the impulse
//!   ring's kernel.
//! - Modes at or above the Nyquist frequency are silent.
//! - Several inputs with a gain a lane ([`Inputs::Placed`]): strike positions, or the few modes of
//!   several bodies in one group.
//!
//! Sample n of the output depends on no split into blocks; the order of summation is fixed, and the
//! same for every instruction set with a fused multiply-add. In an `f32` that rings out, denormal
//! numbers would slow the bank a hundredfold; each lane is zeroed long before, below
//! [`SLEEP_AMPLITUDE`].
//!
//! [`ModalBank`] is its face: the modes and their memory, which instructions run them, and what
//! sleeps. [`FreeResponse`] predicts what they will do by themselves, [`Culling`] says which modes
//! are worth it, [`OnsetCorrection`] what the impulse ring takes from the beginning of a strike.

mod active_groups;
mod bank;
mod culling;
mod design;
mod direct;
mod free_response;
mod job;
mod kernel;
mod onset_correction;
mod phasor;
mod reference;
mod retune;
mod set;
mod shedding;
mod sleep;
mod sums;
mod vector;
mod walk;

pub use bank::{Inputs, ModalBank, lane_gains};
pub use culling::{Culling, audible};
pub use design::{
    GRID_SAMPLES, GroupOptions, GroupState, LaneGains, ModeGroup, design_group, design_groups, sort_by_decay,
};
pub use free_response::FreeResponse;
pub use job::{Input, MAX_INPUTS};
pub use onset_correction::{OnsetCorrection, OnsetSamples};
pub use phasor::{LaneSums, PhasorGroup, PhasorState, total};
pub use reference::{ReferenceMode, ReferenceState};
pub use shedding::{LOUDEST_DB_SPL, MODE_LEVELS, RANKED, SAFETY_DB, SheddingLevels, shedding_order};
pub use sleep::{SLEEP_AMPLITUDE, ringing_s};

/// Modes in a group.
pub const LANES: usize = 16;
