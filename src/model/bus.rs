//! An audio bus: where the sound of bodies leaves.

/// Settings of the audio bus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AudioSettings {
    /// Linear gain.
    pub gain: f64,
    /// Whether a peak limiter keeps the output within ±1.
    pub limit: bool,
}

impl Default for AudioSettings {
    fn default() -> Self {
        Self { gain: 1.0, limit: false }
    }
}
