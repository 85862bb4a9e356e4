//! A surface from recorded strokes: the probe is taken off, time becomes place, and what is left is
//! the felt relief by octaves, with lines where it repeats.
//!
//! ```text
//! P(f) = C(f) · |H(f, F)|² · S(f/v) / v + N(f)
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | P | [`recording::Window`] | one-sided power density of the recording, windows of 0.4 s |
//! | v, F | [`recording::Stroke`] | speed and force, each window's own mean |
//! | H | [`tool::Tool`] | recorded quantity over felt height, from the contact law |
//! | N | [`floor`] | noise of the sensor: from standstill, or the white part of the top |
//! | C | [`colour`] | response of the recording rig, which several speeds tell from the ground |
//! | S | [`relief`] | power density of the felt height over wavenumbers q = f/v, m²·m |
//!
//! The felt height is that after the tip has ridden over the ground. It plays through the same tip
//! as it was felt; [`octaves`] says what the engine's own law of a tip leaves of each octave, so
//! that none is weighed twice.

pub mod checks;
pub mod colour;
mod compliance;
pub mod floor;
pub mod lines;
pub mod models;
pub mod octave_noise;
pub mod octaves;
pub mod pattern;
pub mod power_law;
mod profile;
pub mod recording;
pub mod relief;
pub mod report;
pub mod surface;
pub mod tool;
mod wander;

pub use compliance::Compliance;
pub use recording::{Stroke, Track};
pub use surface::{Options, StrokeSurface, fit};
pub use tool::{Quantity, Tool};

/// Recording that the model does not explain, or that is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field}: {what}; {expected}")]
pub struct StrokeError {
    /// Field or part of the recording.
    pub field: &'static str,
    /// Fault, with its figure.
    pub what: String,
    /// Remedy.
    pub expected: String,
}

impl StrokeError {
    fn new(field: &'static str, what: impl Into<String>, expected: impl Into<String>) -> Self {
        // Readers of XML quote what they find, line breaks too.
        let what = what.into().split(char::is_control).collect::<Vec<_>>().join(" ");
        Self { field, what, expected: expected.into() }
    }
}

/// Sums of so many first values, from none on.
fn running_sums(values: &[f64]) -> Vec<f64> {
    let sums = values.iter().scan(0.0, |sum, value| {
        *sum += value;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}

/// Power as a level, dB.
#[must_use]
pub fn db(power: f64) -> f64 {
    10.0 * power.max(f64::MIN_POSITIVE).log10()
}
