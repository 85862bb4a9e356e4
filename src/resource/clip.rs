//! Authored clip on its way to a haptic channel: resampled, in the channel's unit, its ends faded.

use super::sinc;
use crate::model::clip::Clip;

/// Fade at either end, s: no step, whatever the clip begins with.
const FADE_S: f64 = 0.002;

/// A clip that plays, or waits for its time.
pub(crate) struct PlayingClip {
    pub(crate) channel: usize,
    /// Its first sample, of the rate inside.
    pub(crate) starts: u64,
    /// Gain of strokes meanwhile.
    pub(crate) ducking: f64,
    /// m, m/s² or N.
    pub(crate) samples: Box<[f64]>,
}

impl PlayingClip {
    pub(crate) fn new(clip: &Clip, (channel, full_scale): (usize, f64), starts: u64, rate_hz: f64) -> Self {
        let mut samples: Box<[f64]> = sinc::resampled(&clip.samples, clip.rate_hz, rate_hz)
            .into_iter()
            .map(|x| clip.gain * full_scale * f64::from(x))
            .collect();
        let fade = ((FADE_S * rate_hz) as usize).min(samples.len() / 2);
        let last = samples.len() - 1;
        for i in 0..fade {
            let rise = 0.5 - 0.5 * libm::cos(std::f64::consts::PI * (i as f64 + 0.5) / fade as f64);
            samples[i] *= rise;
            samples[last - i] *= rise;
        }
        Self { channel, starts, ducking: clip.ducking, samples }
    }

    /// One past its last sample.
    pub(crate) fn ends(&self) -> u64 {
        self.starts + self.samples.len() as u64
    }
}
