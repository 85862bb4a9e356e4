//! Recorded strokes, and their power density window by window.

use crate::tool::Tool;
use asperity_fft::{PowerSpectra, hann};

/// Speed or force along a stroke.
#[derive(Debug, Clone, PartialEq)]
pub enum Track {
    /// One value throughout.
    Constant(f64),
    /// A value a sample.
    Samples(Vec<f64>),
}

impl Track {
    /// Value at a sample.
    #[must_use]
    pub fn at(&self, sample: usize) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Samples(values) => values.get(sample).copied().unwrap_or(0.0),
        }
    }

    /// Mean of the values from one sample on.
    #[must_use]
    pub fn mean(&self, from: usize, count: usize) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Samples(values) => {
                let part = &values[from.min(values.len())..(from + count).min(values.len())];
                part.iter().sum::<f64>() / part.len().max(1) as f64
            }
        }
    }

    /// Tests whether the values are known sample by sample.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        matches!(self, Self::Samples(_))
    }
}

/// One recorded stroke.
#[derive(Debug, Clone, PartialEq)]
pub struct Stroke {
    /// Recorded quantity in SI units, one row an axis, equally long; axes are folded by power.
    pub axes: Vec<Vec<f64>>,
    /// Samples a second.
    pub rate_hz: f64,
    /// Speed along the surface, m/s, not below 0.
    pub speed_m_s: Track,
    /// Pressing force, N.
    pub force_n: Track,
}

impl Stroke {
    /// Samples of an axis.
    #[must_use]
    pub fn len(&self) -> usize {
        self.axes.first().map_or(0, Vec::len)
    }

    /// Tests for a stroke without samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Length, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.len() as f64 / self.rate_hz
    }
}

/// Slower than this nothing is stroked, m/s.
pub const STANDSTILL_M_S: f64 = 1e-3;

/// Power density of a piece of a stroke.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Stroke that it is of, by its place in the list.
    pub stroke: usize,
    /// Mean speed, m/s.
    pub speed_m_s: f64,
    /// Mean force, N.
    pub force_n: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// One-sided density of bin i at i `bin_hz`, unit²/Hz, summed over the axes.
    pub density: Vec<f64>,
    /// Distance of two bins, Hz.
    pub bin_hz: f64,
    /// Time that it stands for, s: from it to the next.
    pub stands_for_s: f64,
    /// Power of the probe's response at each bin, once it is known ([`respond`]).
    pub response: Vec<f64>,
}

/// Gives every window the response of a tool at its own speed and force.
pub fn respond(windows: &mut [Window], tool: &Tool) {
    for window in windows {
        let Window { bin_hz, speed_m_s, force_n, rate_hz, .. } = *window;
        window.response = tool.power(window.density.len(), bin_hz, (speed_m_s, force_n), rate_hz);
    }
}

/// Half-overlapped Hann windows of a stroke.
#[must_use]
pub fn windows(stroke: &Stroke, index: usize, length_s: f64) -> Vec<Window> {
    let length = ((length_s * stroke.rate_hz) as usize).clamp(64, stroke.len().max(64));
    let hop = length / 2;
    let spectra = PowerSpectra::new(hann(length, 0.0), length);
    let power = spectra.energy();
    let mut from = 0;
    let mut all = Vec::new();
    while from + length <= stroke.len() {
        let mut density = vec![0.0; length / 2];
        for axis in &stroke.axes {
            let part = &axis[from..from + length];
            let mean = part.iter().sum::<f64>() / length as f64;
            for (sum, bin) in density.iter_mut().zip(spectra.of(part.iter().map(|x| x - mean))) {
                *sum += 2.0 * bin / (power * stroke.rate_hz);
            }
        }
        all.push(Window {
            stroke: index,
            speed_m_s: stroke.speed_m_s.mean(from, length),
            force_n: stroke.force_n.mean(from, length),
            rate_hz: stroke.rate_hz,
            density,
            bin_hz: stroke.rate_hz / length as f64,
            stands_for_s: hop as f64 / stroke.rate_hz,
            response: Vec::new(),
        });
        from += hop;
    }
    all
}
