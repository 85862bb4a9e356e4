//! Power in bands, look by look and frame by frame.

use asperity_fft::{PowerSpectra, hann};

/// A band: from, to, Hz.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Band {
    pub(crate) low_hz: f64,
    pub(crate) high_hz: f64,
}

/// Beginnings of the windows on a signal, and their length, samples: at most `most`, evenly over
/// the whole.
pub(crate) fn looks(samples: usize, look: usize, most: usize) -> (Vec<usize>, usize) {
    let length = look.min(samples).max(1);
    let count = (samples / length).clamp(1, most);
    let room = samples.saturating_sub(length);
    let starts = (0..count).map(|i| if count == 1 { 0 } else { room * i / (count - 1) });
    (starts.collect(), length)
}

/// Power spectra of pieces of equal length through Hann windows.
pub(crate) struct Spectra {
    spectra: PowerSpectra,
    scale: f64,
    bin_hz: f64,
}

impl Spectra {
    pub(crate) fn new(length: usize, rate_hz: f64) -> Self {
        let spectra = PowerSpectra::new(hann(length, 0.0), length);
        let scale = 2.0 / (spectra.energy() * length as f64);
        Self { spectra, scale, bin_hz: rate_hz / length as f64 }
    }

    /// Mean square in each bin up to Nyquist.
    pub(crate) fn power(&self, piece: &[f64]) -> Vec<f64> {
        let power = self.spectra.of(piece.iter().copied());
        power.into_iter().map(|power| self.scale * power).collect()
    }

    /// Power of the bins whose centres lie in a band, each weighed by `weight(f)`. Whole bins, so
    /// that a line counts in one band only.
    pub(crate) fn in_band(&self, power: &[f64], band: Band, weight: impl Fn(f64) -> f64) -> f64 {
        let bin_of = |frequency_hz: f64| ((frequency_hz / self.bin_hz).ceil() as usize).clamp(1, power.len());
        let (first, end) = (bin_of(band.low_hz), bin_of(band.high_hz));
        (first..end.max(first)).map(|bin| power[bin] * weight(bin as f64 * self.bin_hz)).sum()
    }
}

/// Level of a power that is 1 at threshold, dB, nothing below threshold.
pub(crate) fn over_threshold_db(power: f64) -> f64 {
    10.0 * power.max(1.0).log10()
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub(crate) fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
