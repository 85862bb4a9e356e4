//! Points of a vibration: an amplitude and a frequency some hundred times a second, for hardware
//! that plays no waveform.
//!
//! ```text
//! S(k)  = mean over two hops of (W x)²               sensation energy
//! p_b   ∝ mean over the last 40 ms of (B_b W x)²     share of a band
//! f̂_b   = f_b √(Σ (B_b W x)² / Σ (L_b W x)²)         where in the band it lies
//! f(k)  = f̂ of one band inside the device's range    the strongest, or drawn by the golden ratio
//! A(k)  = √(2 S) / |W(f)|                            a sine that is felt as much
//! ```
//!
//! | symbol | here | |
//! |---|---|---|
//! | W | [`crate::sensation`] | displacement → how much is felt |
//! | B_b, L_b | [`BANDS_HZ`] | half octaves of 2 poles, and their low-passes: B = L · s/ω_b; they get what is felt |
//! | A, f | [`Point`] | what the device plays from `tick / rate_hz` on |
//! | golden ratio | [`Tone::Drawn`] | ϕ k modulo 1 picks a band from the running sum of p: over some tens of milliseconds every band gets its share |
//!
//! Ours. What lies outside the device's range is played at its nearer end. It looks back only: the
//! point of a hop is known when the hop ends, and stands for its beginning. Any split into blocks
//! gives the same bits.

use crate::DesignError;
use crate::sensation::{Section, SectionState, Sensation, SensationState};

/// Centres of the bands, Hz: half octaves.
pub const BANDS_HZ: [f64; 11] = [20.0, 28.28, 40.0, 56.57, 80.0, 113.1, 160.0, 226.3, 320.0, 452.5, 640.0];
/// Quality of a half octave: 1/(2^¼ − 2^−¼).
const QUALITY: f64 = 2.871;
/// Slow motion that is not felt is kept away from the bands, Hz.
const SLOWEST_HZ: f64 = 8.0;
/// Memory of the bands, s: two periods of the slowest that is felt well.
const MEMORY_S: f64 = 0.04;
/// Border of low and high, Hz; as in the balance that reductions are judged by.
pub const SPLIT_HZ: f64 = 100.0;
/// Rates of a pad's two motors, Hz. **Assumed**: the class of pads with a heavy and a light weight.
pub const MOTORS_HZ: [f64; 2] = [60.0, 160.0];
/// Least sensation that is reported, of displacement 1; below it a point is silence.
const SILENCE: f64 = 1e-12;

/// Choice of the frequency of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// The band that is felt most.
    Strongest,
    /// Each band as often as it has a share of what is felt.
    #[default]
    Drawn,
}

/// Specification of the points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSettings {
    /// Points a second, 1 to 1000 and at most an eighth of the sample rate.
    pub rate_hz: f64,
    /// Range of the device, Hz, lowest and highest; 1 to 1000.
    pub band_hz: [f64; 2],
    /// Choice of the frequency.
    pub tone: Tone,
}

/// The design at one rate.
#[derive(Debug, Clone, PartialEq)]
pub struct PointDesign {
    settings: PointSettings,
    sample_rate_hz: f64,
    sensation: Sensation,
    slowest: Section,
    bands: [Section; BANDS_HZ.len()],
    /// Share that is left of the bands' energies after a hop.
    keep: f64,
}

/// A vibration between two ticks.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// It begins `tick / rate_hz` seconds after the first sample.
    pub tick: u64,
    /// Peak of the sine, in the unit of the samples.
    pub amplitude: f64,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
    /// Peak of a sine at the heavy motor's frequency that is felt as much as everything below 100
    /// Hz.
    pub low: f64,
    /// Level of the light motor and everything above.
    pub high: f64,
}

/// Memory of one signal.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PointState {
    samples: u64,
    tick: u64,
    slowest: SectionState,
    sensation: SensationState,
    bands: [SectionState; BANDS_HZ.len()],
    hop: Energies,
    /// The hop before of what is felt, and the bands over [`MEMORY_S`].
    smooth: Energies,
}

/// Energies summed over a hop.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Energies {
    count: f64,
    felt: f64,
    band: [f64; BANDS_HZ.len()],
    /// Samples of each band before it was differentiated, times its frequency.
    low: [f64; BANDS_HZ.len()],
}

impl PointDesign {
    /// # Errors
    /// When a number is outside its range; the error names the field.
    pub fn new(settings: PointSettings, sample_rate_hz: f64) -> Result<Self, DesignError> {
        let sensation = Sensation::new(sample_rate_hz)?;
        let most = (sample_rate_hz / 8.0).min(1000.0);
        let words = "from 1 to 1000 Hz and at most an eighth of the sample rate";
        DesignError::check("rate_hz", settings.rate_hz, words, |r| (1.0..=most).contains(&r))?;
        let [lowest, highest] = settings.band_hz;
        DesignError::check("band_hz", lowest, "from 1 to 1000 Hz", |f| (1.0..=1000.0).contains(&f))?;
        DesignError::check("band_hz", highest, "from the lowest to 1000 Hz", |f| {
            (lowest..=1000.0).contains(&f)
        })?;
        // A band beyond what is sampled repeats the highest that is.
        let bands = BANDS_HZ.map(|hz| Section::new(hz.min(0.4 * sample_rate_hz), QUALITY, sample_rate_hz));
        let slowest = Section::new(SLOWEST_HZ, core::f64::consts::FRAC_1_SQRT_2, sample_rate_hz);
        let keep = libm::exp(-1.0 / (settings.rate_hz * MEMORY_S));
        Ok(Self { settings, sample_rate_hz, sensation, slowest, bands, keep })
    }

    /// Points a second, Hz.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.settings.rate_hz
    }

    /// The first sample behind a tick.
    fn end(&self, tick: u64) -> u64 {
        libm::ceil((tick + 1) as f64 * self.sample_rate_hz / self.settings.rate_hz - 1e-9) as u64
    }
}

impl PointState {
    /// One sample; the point of the hop that it ends. A sample that is not finite counts as 0.
    #[inline]
    pub fn tick(&mut self, design: &PointDesign, sample: f64) -> Option<Point> {
        let x = self.slowest.tick(&design.slowest, if sample.is_finite() { sample } else { 0.0 }).high;
        let felt = self.sensation.tick(&design.sensation, x);
        self.hop.count += 1.0;
        self.hop.felt += felt * felt;
        for (index, (state, section)) in self.bands.iter_mut().zip(&design.bands).enumerate() {
            let out = state.tick(section, felt);
            self.hop.band[index] += out.band * out.band;
            self.hop.low[index] += out.low * out.low;
        }
        self.samples += 1;
        (self.samples >= design.end(self.tick)).then(|| self.end_of_hop(design))
    }

    fn end_of_hop(&mut self, design: &PointDesign) -> Point {
        let hop = core::mem::take(&mut self.hop);
        for index in 0..BANDS_HZ.len() {
            self.smooth.band[index] = hop.band[index] + design.keep * self.smooth.band[index];
            self.smooth.low[index] = hop.low[index] + design.keep * self.smooth.low[index];
        }
        let felt = (hop.felt + self.smooth.felt) / (hop.count + self.smooth.count);
        (self.smooth.felt, self.smooth.count) = (hop.felt, hop.count);
        let point = point(design, &self.smooth, felt, self.tick);
        self.tick += 1;
        point
    }
}

fn point(design: &PointDesign, bands: &Energies, felt: f64, tick: u64) -> Point {
    let [lowest, highest] = design.settings.band_hz;
    if felt < SILENCE * SILENCE {
        return Point { tick, frequency_hz: libm::sqrt(lowest * highest), ..Point::default() };
    }
    let mut frequency_hz = BANDS_HZ;
    let mut share = [0.0; BANDS_HZ.len()];
    for (index, centre_hz) in BANDS_HZ.into_iter().enumerate() {
        let (band, low) = (bands.band[index], bands.low[index]);
        // A tone on a band's skirt is known by its own frequency, not by the band's.
        let at = libm::sqrt(band / low.max(1e-300));
        frequency_hz[index] = (centre_hz * at).clamp(SLOWEST_HZ, 1000.0);
        share[index] = band;
    }
    let all: f64 = share.iter().sum();
    let chosen = match design.settings.tone {
        Tone::Strongest => {
            (0..share.len()).fold(0, |most, index| if share[index] > share[most] { index } else { most })
        }
        Tone::Drawn => drawn(&share, all, tick),
    };
    let tone_hz = frequency_hz[chosen].clamp(lowest, highest);
    let peak = libm::sqrt(2.0 * felt);
    let below: f64 =
        frequency_hz.iter().zip(&share).filter(|(hz, _)| **hz < SPLIT_HZ).map(|(_, share)| share).sum();
    let part = (below / all.max(1e-300)).clamp(0.0, 1.0);
    Point {
        tick,
        amplitude: peak / Sensation::gain(tone_hz),
        frequency_hz: tone_hz,
        low: peak * libm::sqrt(part) / Sensation::gain(MOTORS_HZ[0]),
        high: peak * libm::sqrt(1.0 - part) / Sensation::gain(MOTORS_HZ[1]),
    }
}

/// The band in which ϕ k modulo 1 falls when the shares lie end to end.
fn drawn(share: &[f64], all: f64, tick: u64) -> usize {
    // 2^64 / ϕ: the product wraps as the fraction does, without losing digits as the ticks grow.
    let part = tick.wrapping_mul(0x9E37_79B9_7F4A_7C15) as f64 / 18_446_744_073_709_551_616.0;
    let mut left = part * all;
    for (index, share) in share.iter().enumerate() {
        left -= share;
        if left < 0.0 {
            return index;
        }
    }
    share.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use core::f64::consts::TAU;
    use std::vec::Vec;

    const QUEST: PointSettings =
        PointSettings { rate_hz: 100.0, band_hz: [55.0, 200.0], tone: Tone::Strongest };

    fn points(settings: PointSettings, rate_hz: f64, samples: impl Iterator<Item = f64>) -> Vec<Point> {
        let design = PointDesign::new(settings, rate_hz).unwrap();
        let mut state = PointState::default();
        samples.filter_map(|x| state.tick(&design, x)).collect()
    }

    fn sine(frequency_hz: f64, peak: f64, rate_hz: f64) -> impl Iterator<Item = f64> {
        (0..(2.0 * rate_hz) as usize).map(move |n| peak * libm::sin(TAU * frequency_hz * n as f64 / rate_hz))
    }

    #[test]
    fn a_sine_comes_back_with_its_amplitude_and_frequency() {
        for rate_hz in [8e3, 44_100.0, 96e3] {
            for frequency_hz in [60.0, 75.0, 97.0, 130.0, 155.0, 190.0] {
                let points = points(QUEST, rate_hz, sine(frequency_hz, 0.3, rate_hz));
                assert!(points.iter().map(|point| point.tick).eq(0..200));
                // A hop holds half a period of what is slow, so a point by itself is off by a
                // decibel; their mean is not.
                for point in &points[50..] {
                    assert!((point.amplitude / 0.3 - 1.0).abs() < 0.15, "{rate_hz} {frequency_hz} {point:?}");
                    assert!(
                        (point.frequency_hz / frequency_hz - 1.0).abs() < 0.06,
                        "{frequency_hz} {point:?}"
                    );
                }
                let mean = points[50..].iter().map(|point| point.amplitude).sum::<f64>() / 150.0;
                assert!((mean / 0.3 - 1.0).abs() < 0.04, "{rate_hz} {frequency_hz}: {mean}");
            }
        }
    }

    #[test]
    fn unplayable_frequencies_move_to_the_devices_range_and_strength_stays() {
        for (frequency_hz, played_hz) in [(30.0, 55.0), (300.0, 200.0)] {
            let all = points(QUEST, 44_100.0, sine(frequency_hz, 0.1, 44_100.0));
            let mean = all[50..].iter().map(|p| p.amplitude).sum::<f64>() / 150.0;
            let want = 0.1 * Sensation::gain(frequency_hz) / Sensation::gain(played_hz);
            assert!((mean / want - 1.0).abs() < 0.05, "{mean} for {want}");
            assert!(all[50..].iter().all(|p| p.frequency_hz == played_hz));
        }
    }

    #[test]
    fn drawing_gives_two_tones_their_shares_and_the_motors_theirs() {
        // Felt alike: 70 Hz and 180 Hz.
        let (low, high) = (0.1 / Sensation::gain(70.0), 0.1 / Sensation::gain(180.0));
        let both = sine(70.0, low, 44_100.0).zip(sine(180.0, high, 44_100.0)).map(|(a, b)| a + b);
        let all = points(PointSettings { tone: Tone::Drawn, ..QUEST }, 44_100.0, both);
        let below = all[50..].iter().filter(|p| p.frequency_hz < 110.0).count();
        assert!((60..=90).contains(&below), "{below} of 150");
        for point in &all[50..] {
            let (low, high) = (point.low * Sensation::gain(60.0), point.high * Sensation::gain(160.0));
            assert!((0.06..0.14).contains(&low) && (0.06..0.14).contains(&high), "{point:?}");
        }
    }

    #[test]
    fn noise_is_felt_as_much_before_and_after() {
        let mut rng = Rng::new(11);
        let rate_hz = 48e3;
        let noise: Vec<f64> = (0..96_000).map(|_| rng.normal()).collect();
        let design = Sensation::new(rate_hz).unwrap();
        let mut state = SensationState::default();
        let felt: f64 = noise.iter().map(|x| state.tick(&design, *x).powi(2)).sum::<f64>() / 96_000.0;
        let all = points(PointSettings { tone: Tone::Drawn, ..QUEST }, rate_hz, noise.into_iter());
        let played: f64 =
            all.iter().map(|p| (p.amplitude * Sensation::gain(p.frequency_hz)).powi(2) / 2.0).sum::<f64>()
                / 200.0;
        assert!((played / felt - 1.0).abs() < 0.05, "{played} for {felt}");
    }

    #[test]
    fn bad_samples_are_nothing_and_silence_is_silence() {
        let all = points(QUEST, 8e3, (0..8000).map(|n| if n % 7 == 0 { f64::NAN } else { 0.0 }));
        assert!(all.iter().map(|point| point.tick).eq(0..100));
        assert!(all.iter().all(|p| p.amplitude == 0.0 && p.frequency_hz > 55.0));
    }

    #[test]
    fn impossible_settings_are_refused_by_field() {
        let refused = |settings| PointDesign::new(settings, 8e3).unwrap_err().field;
        assert_eq!(refused(PointSettings { rate_hz: 0.0, ..QUEST }), "rate_hz");
        assert_eq!(refused(PointSettings { rate_hz: 1001.0, ..QUEST }), "rate_hz");
        assert_eq!(refused(PointSettings { band_hz: [200.0, 55.0], ..QUEST }), "band_hz");
        assert_eq!(refused(PointSettings { band_hz: [f64::NAN, 55.0], ..QUEST }), "band_hz");
    }
}
