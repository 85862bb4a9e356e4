//! Short-time spectra as a picture.
//!
//! Hann windows, doubled by zero padding; the level of a steady sine of amplitude A is 20 log₁₀ A,
//! so levels read in the unit of the signal. Where several bins fall into one row of the picture
//! the strongest counts, so that no partial is lost at the top of a logarithmic axis.

use super::{ColourBar, Picture, colour::Scale};
use asperity_fft::{PowerSpectra, hann, samples_from};

/// Settings of a spectrogram.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrogramOptions {
    /// Time of the first sample, seconds.
    pub start_s: f64,
    /// Length of a window, seconds; rounded to a power of two of samples.
    pub window_s: f64,
    /// Lowest frequency shown, Hz; above 0 when `log`.
    pub from_hz: f64,
    /// Highest frequency shown, Hz; cut to half the sample rate.
    pub to_hz: f64,
    /// Rows spaced evenly in log frequency.
    pub log: bool,
    /// Level at the top of the colour scale, dB; none = the strongest level in the picture.
    pub top_db: Option<f64>,
    /// Extent of the colour scale, dB.
    pub range_db: f64,
    /// Reference of the levels, above the colour bar: `dB re 1 µm`.
    pub unit: String,
    /// Added to every level, dB: 120 turns metres into micrometres.
    pub offset_db: f64,
    /// Columns of the picture at most.
    pub columns: usize,
    /// Rows of the picture.
    pub rows: usize,
}

impl Default for SpectrogramOptions {
    /// Audio: 20 Hz to 20 kHz on a logarithmic axis, windows of 46 ms, 80 dB.
    fn default() -> Self {
        Self {
            start_s: 0.0,
            window_s: 0.046,
            from_hz: 20.0,
            to_hz: 20_000.0,
            log: true,
            top_db: None,
            range_db: 80.0,
            unit: "dB".to_owned(),
            offset_db: 0.0,
            columns: 640,
            rows: 200,
        }
    }
}

/// Lowest level that is told from silence, dB.
const SILENCE_DB: f64 = -300.0;
/// Colours are this many, so that the picture packs well: steps of about 1 dB.
const LEVELS: f32 = 80.0;
/// Windows looked at in one column of a very long signal, at most.
const WINDOWS_A_COLUMN: usize = 4;

/// The spectrogram of a signal at `rate_hz`.
#[must_use]
pub fn spectrogram<S: Copy + Into<f64>>(
    samples: &[S],
    rate_hz: f64,
    options: &SpectrogramOptions,
) -> Picture {
    let to_hz = options.to_hz.min(rate_hz / 2.0);
    let from_hz = options.from_hz.clamp(if options.log { 1.0 } else { 0.0 }, to_hz * 0.5);
    let rows = options.rows.max(2);
    let edges: Vec<f64> = (0..=rows)
        .map(|row| {
            let part = row as f64 / rows as f64;
            if options.log {
                from_hz * (to_hz / from_hz).powf(part)
            } else {
                from_hz + (to_hz - from_hz) * part
            }
        })
        .collect();
    let columns = options.columns.clamp(2, 2000).min((samples.len() / 32).max(2));
    let levels = columns_of_levels(samples, rate_hz, options.window_s, columns, &edges);
    let found = levels.iter().copied().fold(SILENCE_DB, f64::max);
    let top_db = options.top_db.map_or(found, |top| top - options.offset_db);
    let bottom_db = top_db - options.range_db;
    let mut values = vec![0.0_f32; columns * rows];
    for (column, spectrum) in levels.chunks(rows).enumerate() {
        for (row, level) in spectrum.iter().enumerate() {
            let position = ((level - bottom_db) / options.range_db).clamp(0.0, 1.0) as f32;
            values[(rows - 1 - row) * columns + column] = (position * LEVELS).round() / LEVELS;
        }
    }
    if found <= SILENCE_DB {
        values.fill(0.0);
    }
    let shown_top = if found <= SILENCE_DB { 0.0 } else { top_db + options.offset_db };
    Picture {
        x: [options.start_s, options.start_s + samples.len() as f64 / rate_hz],
        y: [from_hz, to_hz],
        width: columns,
        height: rows,
        values,
        scale: Scale::Level,
        bar: Some(ColourBar { range: [shown_top - options.range_db, shown_top], unit: options.unit.clone() }),
    }
}

/// Levels in dB, column by column, row 0 lowest.
fn columns_of_levels<S: Copy + Into<f64>>(
    samples: &[S],
    rate_hz: f64,
    window_s: f64,
    columns: usize,
    edges: &[f64],
) -> Vec<f64> {
    let window_len = ((window_s * rate_hz).max(64.0) as usize).next_power_of_two().min(1 << 16);
    let fft_len = window_len * 2;
    let window = hann(window_len, 0.5);
    let scale = 2.0 / window.iter().sum::<f64>();
    let spectra = PowerSpectra::new(window, fft_len);
    let mut amplitude = vec![0.0_f64; fft_len / 2 + 1];
    let hop = samples.len() as f64 / columns as f64;
    let repeats = ((hop / window_len as f64).ceil() as usize).clamp(1, WINDOWS_A_COLUMN);
    let bin_hz = rate_hz / fft_len as f64;
    let mut levels = Vec::with_capacity(columns * (edges.len() - 1));
    for column in 0..columns {
        amplitude.fill(0.0);
        for repeat in 0..repeats {
            let part = (repeat as f64 + 0.5) / repeats as f64;
            let first = ((column as f64 + part) * hop) as isize - (window_len / 2) as isize;
            // Squares until the last: a root of every bin of every window would cost as much as the
            // transforms.
            for (best, bin) in amplitude.iter_mut().zip(spectra.of(samples_from(samples, first))) {
                *best = best.max(bin);
            }
        }
        amplitude.iter_mut().for_each(|square| *square = square.sqrt() * scale);
        levels.extend(edges.windows(2).map(|edge| level(&amplitude, edge[0] / bin_hz, edge[1] / bin_hz)));
    }
    levels
}

/// The strongest level between two fractional bins, interpolated when no bin lies between them.
fn level(amplitude: &[f64], from: f64, to: f64) -> f64 {
    let (first, last) = (from.ceil() as usize, to.floor() as usize);
    let last = last.min(amplitude.len() - 1);
    let strongest = if first <= last {
        amplitude[first..=last].iter().copied().fold(0.0, f64::max)
    } else {
        let middle = (from + to) / 2.0;
        let low = (middle.floor() as usize).min(amplitude.len() - 1);
        let high = (low + 1).min(amplitude.len() - 1);
        let part = middle - middle.floor();
        amplitude[low].max(1e-30).powf(1.0 - part) * amplitude[high].max(1e-30).powf(part)
    };
    (20.0 * strongest.max(1e-30).log10()).max(SILENCE_DB)
}

/// Power in third-octave bands from 12.5 Hz on: `[centre, level]`, dB re mean square 1.
#[must_use]
pub fn third_octaves<S: Copy + Into<f64>>(samples: &[S], rate_hz: f64) -> Vec<[f64; 2]> {
    let window_len = ((0.2 * rate_hz) as usize).next_power_of_two();
    let spectra = PowerSpectra::new(hann(window_len, 0.5), window_len);
    let weight = spectra.energy();
    let mut power = vec![0.0_f64; window_len / 2];
    let windows = (samples.len() * 2 / window_len).clamp(1, 200);
    for index in 0..windows {
        let first = index * samples.len().saturating_sub(window_len) / windows.max(2).saturating_sub(1);
        for (sum, bin) in power.iter_mut().zip(spectra.of(samples_from(samples, first as isize))) {
            *sum += 2.0 * bin / (weight * window_len as f64 * windows as f64);
        }
    }
    let bin_hz = rate_hz / window_len as f64;
    (-19..=13)
        .map(|band| 1000.0 * 2f64.powf(f64::from(band) / 3.0))
        .filter(|centre| centre * 1.13 < rate_hz / 2.0)
        .filter_map(|centre| {
            let edge = 2f64.powf(1.0 / 6.0);
            let from = (centre / edge / bin_hz).ceil() as usize;
            let to = ((centre * edge / bin_hz).ceil() as usize).clamp(from + 1, power.len());
            let sum: f64 = power.get(from..to)?.iter().sum();
            (sum > 0.0).then(|| [centre, 10.0 * sum.log10()])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_stands_at_its_frequency_with_its_level() {
        let rate_hz = 8_000.0;
        let tone: Vec<f64> = (0..8_000)
            .map(|n| 0.1 * (2.0 * std::f64::consts::PI * 500.0 * f64::from(n) / rate_hz).sin())
            .collect();
        let options = SpectrogramOptions { to_hz: 4_000.0, ..SpectrogramOptions::default() };
        let picture = spectrogram(&tone, rate_hz, &options);
        let top = picture.bar.as_ref().unwrap().range[1];
        assert!((top + 20.0).abs() < 0.1, "{top} dB");
        let column = picture.width / 2;
        let brightest = (0..picture.height)
            .max_by(|&a, &b| {
                let value = |row: usize| picture.values[row * picture.width + column];
                value(a).total_cmp(&value(b))
            })
            .unwrap();
        let part = 1.0 - (brightest as f64 + 0.5) / picture.height as f64;
        let frequency_hz = 20.0 * (200f64).powf(part);
        assert!((frequency_hz / 500.0 - 1.0).abs() < 0.06, "{frequency_hz} Hz");
    }

    #[test]
    fn silence_and_scraps_have_a_picture_too() {
        for samples in [vec![], vec![0.0_f32], vec![0.0; 10_000]] {
            let picture = spectrogram(&samples, 44_100.0, &SpectrogramOptions::default());
            assert!(picture.values.iter().all(|&value| value == 0.0));
            assert_eq!(picture.values.len(), picture.width * picture.height);
        }
    }

    #[test]
    fn a_third_octave_holds_the_power_of_its_tone() {
        let rate_hz = 44_100.0;
        let tone: Vec<f64> = (0..88_200)
            .map(|n| (2.0 * std::f64::consts::PI * 1_000.0 * f64::from(n) / rate_hz).sin())
            .collect();
        let bands = third_octaves(&tone, rate_hz);
        let strongest = bands.iter().max_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
        assert_eq!(strongest[0], 1_000.0);
        assert!((strongest[1] + 3.01).abs() < 0.05, "{} dB", strongest[1]);
    }
}
