//! Peak meter of an audio bus.

use asperity_surface::height_field::MAX_BLOCK;

/// A peak meter: up at once, down slowly.
pub(super) struct Meter {
    peak: f32,
    /// Peak of the present [`MAX_BLOCK`] samples.
    now: f32,
    /// Share that is left of the peak after [`MAX_BLOCK`] samples.
    fall: f32,
}

/// Time in which a meter falls by 20 dB, s.
const METER_FALL_S: f64 = 0.5;

impl Meter {
    pub(super) fn new(sample_rate_hz: f64) -> Self {
        let fall = libm::pow(0.1, MAX_BLOCK as f64 / (METER_FALL_S * sample_rate_hz)) as f32;
        Self { peak: 0.0, now: 0.0, fall }
    }

    /// Level, linear.
    pub(super) fn peak(&self) -> f32 {
        self.peak
    }

    pub(super) fn watch(&mut self, samples: &[f32]) {
        self.now = samples.iter().fold(self.now, |peak, x| peak.max(x.abs()));
    }

    /// Once every [`MAX_BLOCK`] samples.
    pub(super) fn settle(&mut self) {
        let fallen = self.peak * self.fall;
        self.peak = std::mem::take(&mut self.now).max(if fallen < 1e-9 { 0.0 } else { fallen });
    }
}
