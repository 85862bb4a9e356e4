//! Tone track: the spectrum about every node, and one tone of it.

use crate::felt::{RATE_HZ, weight};
use crate::score::centres_hz;
use asperity_fft::{PowerSpectra, hann, samples_from};

/// Window of a spectrum, samples of 8 kHz: 64 ms.
const WINDOW: usize = 512;
/// Transformed with as many zeros behind it: 7.8 Hz a bin.
const LENGTH: usize = 1024;

/// Which tone of a moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Choice {
    Strongest,
    Drawn,
}

/// Shares of what is felt about every node, by frequency inside the device's range.
pub(crate) struct ToneTrack {
    /// Frequencies of the cells, Hz.
    cells_hz: Vec<f64>,
    /// Nearest third octave of each cell.
    octave: Vec<usize>,
    /// Node by node.
    shares: Vec<Vec<f32>>,
}

impl ToneTrack {
    pub(crate) fn new(samples: &[f64], time_s: &[f64], band_hz: [f64; 2]) -> Self {
        let bin_hz = RATE_HZ / LENGTH as f64;
        let [lowest, highest] = band_hz;
        let inner = (lowest / bin_hz).ceil() as usize..=(highest / bin_hz).floor() as usize;
        let mut cells_hz = vec![lowest];
        cells_hz
            .extend(inner.clone().map(|bin| bin as f64 * bin_hz).filter(|hz| *hz > lowest && *hz < highest));
        cells_hz.push(highest);
        let centres: Vec<f64> = centres_hz(band_hz).collect();
        let octave = cells_hz.iter().map(|hz| nearest(&centres, *hz)).collect();
        let weights: Vec<f64> = (0..LENGTH / 2).map(|bin| weight(bin as f64 * bin_hz).powi(2)).collect();
        let spectra = PowerSpectra::new(hann(WINDOW, 0.5), LENGTH);
        let shares = time_s
            .iter()
            .map(|t| {
                let first = (t * RATE_HZ).round() as isize - WINDOW as isize / 2;
                let power = spectra.of(samples_from(samples, first));
                let mut share = vec![0.0_f32; cells_hz.len()];
                for bin in 1..LENGTH / 2 {
                    let hz = bin as f64 * bin_hz;
                    let cell = cells_hz.partition_point(|cell| *cell < hz).min(cells_hz.len() - 1);
                    share[cell] += (power[bin] * weights[bin]) as f32;
                }
                share
            })
            .collect();
        Self { cells_hz, octave, shares }
    }

    /// One frequency a node; a third octave with tilt 2 is drawn twice as often as its share.
    pub(crate) fn hz(&self, choice: Choice, tilt: &[f64]) -> Vec<f64> {
        let lean = |cell: usize| tilt.get(self.octave[cell]).copied().unwrap_or(1.0);
        let tilted = |share: &[f32]| -> Vec<f64> {
            share.iter().enumerate().map(|(cell, s)| f64::from(*s) * lean(cell)).collect()
        };
        let mut last_hz = (self.cells_hz[0] * self.cells_hz[self.cells_hz.len() - 1]).sqrt();
        self.shares
            .iter()
            .enumerate()
            .map(|(node, share)| {
                let share = tilted(share);
                let all: f64 = share.iter().sum();
                // In silence the tone stays where it was.
                if all > 0.0 {
                    last_hz = match choice {
                        Choice::Strongest => self.strongest(&share),
                        Choice::Drawn => self.drawn(&share, all, node),
                    };
                }
                last_hz
            })
            .collect()
    }

    /// The centre of the strongest cell and its neighbours.
    fn strongest(&self, share: &[f64]) -> f64 {
        let peak = (0..share.len()).fold(0, |most, cell| if share[cell] > share[most] { cell } else { most });
        let near = peak.saturating_sub(1)..(peak + 2).min(share.len());
        let (mut sum, mut moment) = (0.0, 0.0);
        for cell in near {
            sum += share[cell];
            moment += share[cell] * self.cells_hz[cell];
        }
        moment / sum
    }

    fn drawn(&self, share: &[f64], all: f64, node: usize) -> f64 {
        let golden = (node as f64 * 0.618_033_988_749_894_9).fract();
        let mut left = golden * all;
        for (cell, share) in share.iter().enumerate() {
            left -= share;
            if left < 0.0 {
                return self.cells_hz[cell];
            }
        }
        self.cells_hz[self.cells_hz.len() - 1]
    }
}

fn nearest(centres: &[f64], hz: f64) -> usize {
    let away = |k: usize| (centres[k] / hz).ln().abs();
    (0..centres.len()).fold(0, |best, k| if away(k) < away(best) { k } else { best })
}
