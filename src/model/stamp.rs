//! A point on the audio's time line.

/// A point on the audio's time line, in whole 1/256 of a sample: fine enough that a path ripples by
/// less than 10⁻⁵, and exact in a log, so that a recording replays to the bit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct Stamp(u64);

impl Stamp {
    const PER_SAMPLE: u64 = 256;

    pub(crate) fn at(samples: f64) -> Self {
        Self((samples * Self::PER_SAMPLE as f64).round().max(0.0) as u64)
    }

    pub(crate) fn whole(sample: u64) -> Self {
        Self(sample.saturating_mul(Self::PER_SAMPLE))
    }

    /// Stamp so many samples later.
    pub(crate) fn later(self, samples: u64) -> Self {
        Self(self.0.saturating_add(samples.saturating_mul(Self::PER_SAMPLE)))
    }

    /// The sample at or before it.
    pub(crate) fn sample(self) -> u64 {
        self.0 / Self::PER_SAMPLE
    }

    /// Distance beyond that sample, 0 to 255/256.
    pub(crate) fn fraction(self) -> f64 {
        (self.0 % Self::PER_SAMPLE) as f64 / Self::PER_SAMPLE as f64
    }

    /// In samples.
    pub(crate) fn samples(self) -> f64 {
        self.0 as f64 / Self::PER_SAMPLE as f64
    }
}
