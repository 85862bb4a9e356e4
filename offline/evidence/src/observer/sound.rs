//! Features of a sound that an ear has.

use crate::observer::constants::{
    DECAY_JND, ERB_NUMBERS, LOOK_S, MOST_LOOKS, SOUND_GROUPS_HZ, SOUND_LEVEL_SD_DB, hearing_threshold_db,
};
use crate::observer::judge::{Feature, Percept};
use crate::observer::spectra::{Band, Spectra, looks, mean, over_threshold_db};
use crate::observer::touch::{Hand, chance_db, fluctuations, places};

/// Power of the quietest pure tone, Pa²: 20 µPa at the threshold of its frequency.
pub(crate) fn threshold_pa2(frequency_hz: f64) -> f64 {
    4e-10 * 10f64.powf(hearing_threshold_db(frequency_hz.clamp(20.0, 18_000.0)) / 10.0)
}

/// Frequency of an ERB-number (Glasberg and Moore 1990).
fn erb_hz(number: f64) -> f64 {
    (10f64.powf(number / 21.4) - 1.0) / 4.37e-3
}

/// Features of a signal in pascals; `rings_from` is the sample from which the body is left alone,
/// if it is, and the hand's place counts where the task gives it.
#[must_use]
pub fn heard(signal: &[f64], rate_hz: f64, rings_from: Option<usize>, hand: Option<Hand<'_>>) -> Percept {
    let weight = |f: f64| 1.0 / threshold_pa2(f);
    let touched = &signal[..rings_from.unwrap_or(signal.len()).clamp(1, signal.len())];
    let (starts, length) = looks(touched.len(), (LOOK_S * rate_hz) as usize, MOST_LOOKS);
    let spectra = Spectra::new(length, rate_hz);
    let each: Vec<Vec<f64>> = starts.iter().map(|&at| spectra.power(&touched[at..at + length])).collect();
    let fewer = (starts.len() as f64).sqrt();
    let seconds = (length * starts.len()) as f64 / rate_hz;
    let mut features = Vec::new();
    for number in ERB_NUMBERS.0..=ERB_NUMBERS.1 {
        let band = Band { low_hz: erb_hz(number as f64 - 0.5), high_hz: erb_hz(number as f64 + 0.5) };
        let levels: Vec<f64> =
            each.iter().map(|power| over_threshold_db(spectra.in_band(power, band, weight))).collect();
        let chance = chance_db((band.high_hz - band.low_hz) * seconds);
        features.push(Feature { value: mean(&levels), sd: SOUND_LEVEL_SD_DB / fewer, chance });
    }
    features.extend(fluctuations(touched, rate_hz, &SOUND_GROUPS_HZ, weight, |_| SOUND_LEVEL_SD_DB / fewer));
    features.extend(places(touched, rate_hz, hand, &SOUND_GROUPS_HZ, weight, SOUND_LEVEL_SD_DB));
    let shorter_longer = [-(1.0 - DECAY_JND[0]).ln(), (1.0 + DECAY_JND[1]).ln()];
    let decay = rings_from.map_or(f64::NAN, |from| decay_per_s(&signal[from..], rate_hz).ln());
    features.push(Feature { value: decay, sd: 0.5 * (shorter_longer[0] + shorter_longer[1]), chance: 0.1 });
    Percept { features }
}

/// Decay of a ring over its first 30 dB, 1/s; NaN where there is none.
fn decay_per_s(ring: &[f64], rate_hz: f64) -> f64 {
    let length = (0.02 * rate_hz) as usize;
    let levels: Vec<f64> =
        ring.chunks_exact(length.max(1)).map(|x| x.iter().map(|x| x * x).sum::<f64>().ln()).collect();
    let Some(first) = levels.first().copied().filter(|first| first.is_finite()) else { return f64::NAN };
    let falls = levels.iter().take_while(|level| **level > first - 30.0 / 4.343).count();
    if falls < 2 {
        return f64::NAN;
    }
    // Power falls by e^(−2 d t).
    let dropped = 0.5 * (first - levels[falls - 1]) / ((falls - 1) as f64 * 0.02);
    if dropped > 0.0 { dropped } else { f64::NAN }
}
