//! Noise floor of the recording.
//!
//! Standstill shows it bin by bin. Without one, what does not fall any more at the top of the band
//! is taken for white: the largest white power that leaves the bands above 150 Hz on a
//! straight line of a power law through the probe.

use crate::recording::{STANDSTILL_M_S, Window};
use crate::{db, running_sums};

/// Lowest band that a white floor is read from, Hz.
const WHITE_FROM_HZ: f64 = 150.0;
/// Share of the rate up to which a sensor's own filter leaves the floor white.
const WHITE_TO_RATE: f64 = 0.4;
/// Bands an octave that the line is laid through.
const BANDS_AN_OCTAVE: f64 = 3.0;
/// Floors tried: from the lowest band down, dB apart.
const STEP_DB: f64 = 0.5;
const STEPS: usize = 80;

/// Floor of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Floor {
    /// Density at each bin, unit²/Hz.
    pub density: Vec<f64>,
    /// True where standstill gave it.
    pub from_standstill: bool,
    /// Level of the floor over the recording's, from 20 Hz to 1 kHz, dB.
    pub over_signal_db: f64,
}

/// Floor of windows of one length.
#[must_use]
pub fn find(windows: &[Window]) -> Floor {
    let (still, moving): (Vec<&Window>, Vec<&Window>) =
        windows.iter().partition(|window| window.speed_m_s < STANDSTILL_M_S);
    let bins = windows.first().map_or(0, |window| window.density.len());
    let bin_hz = windows.first().map_or(1.0, |window| window.bin_hz);
    let mean = |windows: &[&Window]| -> Vec<f64> {
        let count = windows.len().max(1) as f64;
        (0..bins).map(|i| windows.iter().map(|w| w.density[i]).sum::<f64>() / count).collect()
    };
    let signal = mean(&moving);
    let from_standstill = still.len() >= 2;
    let density =
        if from_standstill { smooth(&mean(&still)) } else { vec![white(&signal, bin_hz, &moving); bins] };
    let band = (20.0 / bin_hz) as usize..((1000.0 / bin_hz) as usize).min(bins);
    let power = |density: &[f64]| density[band.clone()].iter().sum::<f64>();
    let over_signal_db = db(power(&density)) - db(power(&signal));
    Floor { density, from_standstill, over_signal_db }
}

/// Means over a sixth of an octave: a second of standstill has few windows.
fn smooth(density: &[f64]) -> Vec<f64> {
    let sums = running_sums(density);
    let near = |i: usize| {
        let reach = (i / 16).max(2);
        let (from, to) = (i.saturating_sub(reach), (i + reach + 1).min(density.len()));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..density.len()).map(near).collect()
}

/// White density under a power law through the probe.
fn white(signal: &[f64], bin_hz: f64, moving: &[&Window]) -> f64 {
    let count = moving.len().max(1) as f64;
    let Some(middle) = moving.get(moving.len() / 2) else { return 0.0 };
    let (rate_hz, response) = (middle.rate_hz, &middle.response);
    let ratio = 2f64.powf(0.5 / BANDS_AN_OCTAVE);
    let mut bands = Vec::new();
    let mut centre_hz = WHITE_FROM_HZ;
    while centre_hz * ratio < WHITE_TO_RATE * rate_hz {
        let from = (centre_hz / ratio / bin_hz) as usize;
        let to = ((centre_hz * ratio / bin_hz) as usize).min(signal.len());
        let mean = |values: &[f64]| values[from..to].iter().sum::<f64>() / (to - from).max(1) as f64;
        bands.push((centre_hz.ln(), mean(signal), mean(response), ((to - from) as f64 * count).max(1.0)));
        centre_hz *= ratio * ratio;
    }
    let least = bands.iter().map(|band| band.1).fold(f64::INFINITY, f64::min);
    if bands.len() < 5 || !least.is_finite() {
        return 0.0;
    }
    let misfit = |floor: f64| {
        let points: Vec<[f64; 3]> = bands
            .iter()
            .map(|(x, power, response, bins)| {
                let left = (power - floor).max(1e-3 * power);
                // Variance of a level, nepers: of the power, seen over what the floor leaves.
                let deviation = power / left / bins.sqrt() + 0.01;
                [*x, (left / response.max(f64::MIN_POSITIVE)).ln(), deviation.powi(-2)]
            })
            .collect();
        residual(&points)
    };
    let none = misfit(0.0);
    let tried = (1..STEPS).map(|step| least * 10f64.powf(-0.1 * STEP_DB * step as f64));
    let best = tried
        .map(|floor| (misfit(floor), floor))
        .fold((none - 2.0, 0.0), |best, now| if now.0 < best.0 { now } else { best });
    best.1
}

/// Weighted squares beside the best line.
fn residual(points: &[[f64; 3]]) -> f64 {
    let sum = |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(of).sum::<f64>();
    let w = sum(&|p| p[2]);
    let (x, y) = (sum(&|p| p[2] * p[0]) / w, sum(&|p| p[2] * p[1]) / w);
    let xx = sum(&|p| p[2] * (p[0] - x).powi(2));
    let slope = sum(&|p| p[2] * (p[0] - x) * (p[1] - y)) / xx.max(f64::MIN_POSITIVE);
    sum(&|p| p[2] * (p[1] - y - slope * (p[0] - x)).powi(2))
}
