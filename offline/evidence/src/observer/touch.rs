//! Features of a vibration that a fingertip has.

use crate::observer::constants::{
    FIRST_THIRD_OCTAVE_HZ, FRAME_S, LOOK_S, MOST_LOOKS, PLACES, THIRD_OCTAVES, TOUCH_GROUPS_HZ, touch_sd_db,
    touch_threshold_m,
};
use crate::observer::judge::{Feature, Percept};
use crate::observer::spectra::{Band, Spectra, deviation, looks, mean, over_threshold_db};
use std::f64::consts::PI;

/// Quantity of a haptic channel's samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Metres.
    Displacement,
    /// m/s².
    Acceleration,
}

/// Place of the hand, sample by sample: 0–1 across the plate, and the axis along which it moves (0:
/// u, 1: v).
#[derive(Debug, Clone, Copy)]
pub struct Hand<'a> {
    /// Along u and v.
    pub place: &'a [[f64; 2]],
    /// The axis of the stroke.
    pub axis: &'a [usize],
}

/// The centres of the third octaves, Hz.
#[must_use]
pub fn third_octave_hz(band: usize) -> f64 {
    FIRST_THIRD_OCTAVE_HZ * 2f64.powf(band as f64 / 3.0)
}

/// Features of a signal in SI units; with the place of the hand where the task gives it.
#[must_use]
pub fn felt(signal: &[f64], rate_hz: f64, unit: Unit, hand: Option<Hand<'_>>) -> Percept {
    let weight = |f: f64| {
        let per_m = match unit {
            Unit::Displacement => 1.0,
            Unit::Acceleration => (2.0 * PI * f).powi(2),
        };
        (touch_threshold_m(f) * per_m).powi(-2)
    };
    let (starts, length) = looks(signal.len(), (LOOK_S * rate_hz) as usize, MOST_LOOKS);
    let spectra = Spectra::new(length, rate_hz);
    let each: Vec<Vec<f64>> = starts.iter().map(|&at| spectra.power(&signal[at..at + length])).collect();
    let fewer = (starts.len() as f64).sqrt();
    let mut features = Vec::new();
    for band in 0..THIRD_OCTAVES {
        let centre_hz = third_octave_hz(band);
        let edges =
            Band { low_hz: centre_hz * 2f64.powf(-1.0 / 6.0), high_hz: centre_hz * 2f64.powf(1.0 / 6.0) };
        let levels: Vec<f64> =
            each.iter().map(|power| over_threshold_db(spectra.in_band(power, edges, weight))).collect();
        let seconds = (length * starts.len()) as f64 / rate_hz;
        let chance_db = chance_db((edges.high_hz - edges.low_hz) * seconds);
        features.push(Feature {
            value: mean(&levels),
            sd: touch_sd_db(centre_hz) / fewer,
            chance: chance_db,
        });
    }
    features.extend(fluctuations(signal, rate_hz, &TOUCH_GROUPS_HZ, weight, |f| touch_sd_db(f) / fewer));
    features.extend(places(signal, rate_hz, hand, &TOUCH_GROUPS_HZ, weight, touch_sd_db(125.0)));
    Percept { features }
}

/// Deviation of the level of Gaussian noise that is looked at for so many independent samples, dB.
pub(crate) fn chance_db(bandwidth_times_s: f64) -> f64 {
    10.0 / std::f64::consts::LN_10 / bandwidth_times_s.max(1.0).sqrt()
}

/// Deviation of the level from frame to frame, in each group of frequencies.
pub(crate) fn fluctuations(
    signal: &[f64],
    rate_hz: f64,
    groups_hz: &[f64],
    weight: impl Fn(f64) -> f64 + Copy,
    sd_db: impl Fn(f64) -> f64,
) -> Vec<Feature> {
    let (starts, length) = frames(signal.len(), rate_hz);
    let spectra = Spectra::new(length, rate_hz);
    let each: Vec<Vec<f64>> = starts.iter().map(|&at| spectra.power(&signal[at..at + length])).collect();
    let independent = (starts.len() as f64 / 2.0).max(1.0);
    groups_hz
        .windows(2)
        .map(|edges| {
            let band = Band { low_hz: edges[0], high_hz: edges[1] };
            let levels: Vec<f64> =
                each.iter().map(|power| over_threshold_db(spectra.in_band(power, band, weight))).collect();
            let centre_hz = (edges[0] * edges[1]).sqrt();
            let chance = chance_db(FRAME_S * (edges[1] - edges[0])) / (2.0 * independent).sqrt();
            Feature { value: deviation(&levels), sd: sd_db(centre_hz), chance }
        })
        .collect()
}

/// Level of all groups together in each part of the plate that the hand has crossed, along u and
/// along v.
pub(crate) fn places(
    signal: &[f64],
    rate_hz: f64,
    hand: Option<Hand<'_>>,
    groups_hz: &[f64],
    weight: impl Fn(f64) -> f64 + Copy,
    sd_db: f64,
) -> Vec<Feature> {
    let Some(hand) = hand else { return Vec::new() };
    let (starts, length) = frames(signal.len().min(hand.place.len()), rate_hz);
    let spectra = Spectra::new(length, rate_hz);
    let band = Band { low_hz: groups_hz[0], high_hz: groups_hz[groups_hz.len() - 1] };
    let mut sums = [[(0.0, 0usize); PLACES]; 2];
    for at in starts {
        let middle = at + length / 2;
        let axis = hand.axis[middle].min(1);
        let place = (hand.place[middle][axis].clamp(0.0, 0.999) * PLACES as f64) as usize;
        let (sum, count) = &mut sums[axis][place];
        *sum += over_threshold_db(spectra.in_band(&spectra.power(&signal[at..at + length]), band, weight));
        *count += 1;
    }
    let chance = chance_db(FRAME_S * (band.high_hz - band.low_hz));
    let level = |(sum, count): (f64, usize)| if count == 0 { f64::NAN } else { sum / count as f64 };
    sums.into_iter().flatten().map(|cell| Feature { value: level(cell), sd: sd_db, chance }).collect()
}

/// Half-overlapping frames.
fn frames(samples: usize, rate_hz: f64) -> (Vec<usize>, usize) {
    let length = ((FRAME_S * rate_hz) as usize).min(samples).max(1);
    ((0..=samples.saturating_sub(length)).step_by((length / 2).max(1)).collect(), length)
}
