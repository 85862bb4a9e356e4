//! Options of a fit, and its summary of the recording.

/// Largest amplitude of a mode, in peaks of the recording.
pub(crate) const LARGEST_AMPLITUDE: f64 = 8.0;

/// Options of a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FitOptions {
    /// Most modes.
    pub max_modes: usize,
    /// Lowest and highest frequency, Hz; the upper one is also bounded by 0.49 of the rate.
    pub band_hz: (f64, f64),
    /// Modes whose energy lies further than this below the strongest one's are dropped, dB
    /// (negative).
    pub least_level_db: f64,
    /// Fastest decay, 1/s.
    pub fastest_decay_per_s: f64,
    /// From the onset to where modes are fitted, s; `None` finds out.
    pub start_offset_s: Option<f64>,
    /// Which strike of the recording, from 1; `None` takes the best.
    pub strike: Option<usize>,
    /// Threads for the bands; 0 takes what the machine has, up to 8.
    pub threads: usize,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            max_modes: 150,
            band_hz: (20.0, f64::INFINITY),
            least_level_db: -90.0,
            fastest_decay_per_s: 1500.0,
            start_offset_s: None,
            strike: None,
            threads: 0,
        }
    }
}

/// The analysed part, in samples of the recording.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) onset: usize,
    pub(crate) end: usize,
}
