//! Authored clips: a waveform that plays on a haptic channel beside what is rendered.

use super::bad_value::{BadValue, within};
use asperity_dsp::limits::{self, Range};

const RATE_HZ: Range = Range::new(100.0, 384e3, "100 to 384000 Hz");
const LENGTH_S: Range = Range::above(0.0, 600.0, "one at least, for 600 s at most");
const SAMPLE: Range = Range::new(-1e6, 1e6, "finite, within ±1e6");
const DUCKING: Range = Range::new(0.0, 1.0, "0 to 1");

/// A waveform for [`Scene::play_clip`](crate::Scene::play_clip). `.haptic`, AHAP and WAV become one
/// by `asperity_ports::oscillator::rendered` and a WAV reader.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Samples, 1 = the channel's full scale.
    pub samples: Vec<f32>,
    /// Their rate, Hz; 100 to 384,000.
    pub rate_hz: f64,
    /// Linear gain, 0–1000.
    pub gain: f64,
    /// Gain of strokes and blows on the channel while it plays, 0–1; 1 by default.
    pub ducking: f64,
}

impl Clip {
    /// At gain 1, beside strokes as they are.
    #[must_use]
    pub fn new(samples: Vec<f32>, rate_hz: f64) -> Self {
        Self { samples, rate_hz, gain: 1.0, ducking: 1.0 }
    }

    pub(crate) fn check(&self) -> Result<(), BadValue> {
        within("rate_hz", self.rate_hz, RATE_HZ)?;
        within("gain", self.gain, limits::impact::GAIN)?;
        within("ducking", self.ducking, DUCKING)?;
        within("samples", self.samples.len() as f64 / self.rate_hz, LENGTH_S)?;
        self.samples.iter().try_for_each(|x| within("samples", f64::from(*x), SAMPLE).map(drop))
    }
}
