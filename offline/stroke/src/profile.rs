//! Profile of a stroke: felt height at equal steps of place.

use crate::recording::Stroke;
use crate::tool::Tool;
use asperity_fft::num_complex::Complex;
use asperity_fft::{FftPlanner, PowerSpectra, hann};

/// Band of the recording that lines are looked for in, Hz.
const BAND_HZ: (f64, f64) = (15.0, 1200.0);
/// Places for each period of the highest frequency that is kept.
const PLACES_A_PERIOD: f64 = 4.0;
/// Bins of the padded spectrum for one of the unpadded.
const PADDED: usize = 4;

/// A height at equal steps of place.
pub(crate) struct Profile {
    pub(crate) height_m: Vec<f64>,
    pub(crate) step_m: f64,
    pub(crate) mean_speed_m_s: f64,
    rate_hz: f64,
}

/// Highest frequency that is kept at a rate, Hz.
fn top_hz(rate_hz: f64) -> f64 {
    BAND_HZ.1.min(0.4 * rate_hz)
}

/// Felt height of an axis within [`BAND_HZ`].
pub(crate) fn felt_height(axis: &[f64], stroke: &Stroke, tool: &Tool) -> Vec<f64> {
    let length = axis.len().next_power_of_two();
    let mean = axis.iter().sum::<f64>() / axis.len().max(1) as f64;
    let mut bins: Vec<Complex<f64>> = axis.iter().map(|x| Complex::new(x - mean, 0.0)).collect();
    bins.resize(length, Complex::default());
    let mut planner = FftPlanner::new();
    planner.plan_fft_forward(length).process(&mut bins);
    let force_n = stroke.force_n.mean(0, stroke.len());
    let bin_hz = stroke.rate_hz / length as f64;
    let top_hz = top_hz(stroke.rate_hz);
    for i in 0..=length / 2 {
        let hz = i as f64 * bin_hz;
        let gain = if (BAND_HZ.0..top_hz).contains(&hz) {
            tool.inverse(hz, force_n) / length as f64
        } else {
            Complex::default()
        };
        bins[i] *= gain;
        if i > 0 && i < length / 2 {
            bins[length - i] *= gain.conj();
        }
    }
    planner.plan_fft_inverse(length).process(&mut bins);
    bins[..axis.len()].iter().map(|bin| bin.re).collect()
}

/// Heights at equal steps of place, by cubics through the samples.
pub(crate) fn at_places(height_m: &[f64], path_m: &[f64], stroke: &Stroke) -> Profile {
    let total_m = path_m.last().copied().unwrap_or(0.0);
    let count = height_m.len();
    let places = count as f64 * (PLACES_A_PERIOD * top_hz(stroke.rate_hz) / stroke.rate_hz).min(1.0);
    let step_m = total_m / places.floor().max(1.0);
    let mut after = 0;
    let at = |i: usize| height_m[i.min(count - 1)];
    let heights = (0..places as usize)
        .map(|i| {
            let x = (i as f64 + 0.5) * step_m;
            while after + 1 < count && path_m[after] < x {
                after += 1;
            }
            let before = after.saturating_sub(1);
            let span = (path_m[after] - path_m[before]).max(1e-30);
            let t = ((x - path_m[before]) / span).clamp(0.0, 1.0);
            let (p0, p1, p2, p3) = (at(before.saturating_sub(1)), at(before), at(after), at(after + 1));
            p1 + 0.5
                * t
                * (p2 - p0 + t * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3 + t * (3.0 * (p1 - p2) + p3 - p0)))
        })
        .collect();
    Profile { height_m: heights, step_m, mean_speed_m_s: total_m / stroke.seconds(), rate_hz: stroke.rate_hz }
}

/// Padded power spectrum of a profile through a Hann window: amplitude² of a sine in a bin.
pub(crate) fn spectrum(profile: &Profile) -> (Vec<f64>, f64) {
    let count = profile.height_m.len();
    let length = (PADDED * count).next_power_of_two();
    let spectra = PowerSpectra::new(hann(count, 0.0), length);
    let scale = (4.0 / count as f64).powi(2);
    let power = spectra.of(profile.height_m.iter().copied());
    let power = power[..length / 2].iter().map(|power| scale * power).collect();
    (power, 1.0 / (length as f64 * profile.step_m))
}

/// Range of bins that holds the band that was kept.
pub(crate) fn held(profile: &Profile, bin_q: f64, bins: usize) -> (usize, usize) {
    let v = profile.mean_speed_m_s.max(1e-9);
    let low = (1.3 * BAND_HZ.0 / v / bin_q) as usize;
    let high = (0.8 * top_hz(profile.rate_hz) / v / bin_q) as usize;
    (low.max(8), high.min(bins))
}
