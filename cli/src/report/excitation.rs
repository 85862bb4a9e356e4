//! Excitation that the ear misses where something is left out: differences of its excitation, with
//! spreading and the threshold in quiet (`asperity_dsp::masking`), in cells of an ERB and 20 ms of
//! what was rendered.

use asperity_dsp::masking::{erb_number, excitation_db, quiet_db_spl};
use asperity_fft::{PowerSpectra, hann};
use serde::Serialize;

const FRAME_S: f64 = 0.02;
/// From 100 Hz to 15 kHz.
const ERBS: std::ops::Range<i32> = 4..40;
/// Bands of an ERB in which levels are measured.
const BANDS_AN_ERB: usize = 4;
/// The loudest frame of the whole, dB SPL.
const LOUDEST_DB_SPL: f64 = 70.0;
/// Share of the cells that are within what is stated.
const MOST: f64 = 0.99;

/// Missed excitation.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Missed {
    /// In 99 of 100 cells the difference is at most this, dB.
    pub excitation_db: f64,
    /// Share of the cells within 1 dB.
    pub within_1_db: f64,
}

/// Mean squares of every frame in bands of a quarter of an ERB, by Hann windows.
fn frames(sound: &[f64], rate_hz: f64) -> Vec<Vec<f64>> {
    let count = (FRAME_S * rate_hz) as usize;
    let spectra = PowerSpectra::new(hann(count, 0.0), count);
    let in_bands = |frame: &[f64]| {
        let powers = spectra.of(frame.iter().copied());
        let mut bands = vec![0.0; BANDS_AN_ERB * ERBS.end as usize + 16];
        for (bin, own) in powers.iter().enumerate().take(count / 2).skip(1) {
            let band = (BANDS_AN_ERB as f64 * erb_number(bin as f64 * rate_hz / count as f64)) as usize;
            if let Some(power) = bands.get_mut(band) {
                // The squares of the window are 3/8 in the mean.
                *power += 2.0 * own / (count as f64 * count as f64 * 0.375);
            }
        }
        bands
    };
    sound.chunks_exact(count).map(in_bands).collect()
}

/// Excitation in each ERB, with the threshold in quiet, as a power; `loudest` is a mean square.
fn excited(bands: &[f64], loudest: f64) -> impl Iterator<Item = f64> {
    let power = |db: f64| 10f64.powf(0.1 * db);
    ERBS.map(move |erb| {
        let (erb, hz) = (f64::from(erb), (10f64.powf(f64::from(erb) / 21.4) - 1.0) / 0.00437);
        let of = |(band, mean_square): (usize, &f64)| {
            let level_db = LOUDEST_DB_SPL + 10.0 * (mean_square / loudest).max(1e-30).log10();
            power(excitation_db(level_db, (band as f64 + 0.5) / BANDS_AN_ERB as f64, erb))
        };
        bands.iter().enumerate().map(of).sum::<f64>() + power(quiet_db_spl(hz))
    })
}

/// Missed excitation of a sound; both begin together.
pub fn missed(less: &[f64], whole: &[f64], rate_hz: f64) -> Missed {
    missed_in_the_mean([(less, whole)].into_iter(), rate_hz)
}

/// Mean over several sounds, as strikes whose modes begin at other phases: two tones within an ERB
/// beat, and of a beat it is chance which frame it falls in.
pub fn missed_in_the_mean<'a>(pairs: impl Iterator<Item = (&'a [f64], &'a [f64])>, rate_hz: f64) -> Missed {
    let [mut less, mut whole] = [Vec::new(), Vec::new()];
    for (one, other) in pairs {
        for (sum, sound) in [(&mut less, one), (&mut whole, other)] {
            let frames = frames(sound, rate_hz);
            if sum.is_empty() {
                *sum = frames;
            } else {
                let both = sum.iter_mut().flatten().zip(frames.into_iter().flatten());
                both.for_each(|(sum, power): (&mut f64, f64)| *sum += power);
            }
        }
    }
    let loudest = whole.iter().map(|bands| bands.iter().sum::<f64>()).fold(f64::MIN_POSITIVE, f64::max);
    let cells = less.iter().zip(&whole).flat_map(|(less, whole)| {
        let pairs = excited(less, loudest).zip(excited(whole, loudest));
        pairs.map(|(a, b)| (10.0 * (a / b).log10()).abs()).collect::<Vec<f64>>()
    });
    let mut apart_db: Vec<f64> = cells.collect();
    apart_db.sort_by(f64::total_cmp);
    let within = apart_db.iter().filter(|apart| **apart <= 1.0).count();
    Missed {
        excitation_db: crate::measure::quantile(&apart_db, MOST),
        within_1_db: within as f64 / apart_db.len().max(1) as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_sound_misses_nothing_and_a_masked_tone_misses_less() {
        let tone = |hz: f64, amplitude: f64| {
            (0..44_100).map(move |n| amplitude * (std::f64::consts::TAU * hz * f64::from(n) / 44_100.0).sin())
        };
        let with =
            |hz: f64| -> Vec<f64> { tone(1000.0, 1.0).zip(tone(hz, 0.02)).map(|(a, b)| a + b).collect() };
        let alone: Vec<f64> = tone(1000.0, 1.0).collect();
        let same = missed(&alone, &alone, 44_100.0);
        assert_eq!((same.excitation_db, same.within_1_db), (0.0, 1.0));
        let (near, far) = (with(1050.0), with(6000.0));
        let (near, far) = (missed(&alone, &near, 44_100.0), missed(&alone, &far, 44_100.0));
        assert!(near.within_1_db > 0.99 && far.excitation_db > 6.0, "{near:?} {far:?}");
    }
}
