//! Partials of a sound, found in its spectra without any model.

use asperity_dsp::mode::Mode;
use asperity_fft::{FftPlanner, num_complex::Complex};
use std::f64::consts::PI;

/// Modes so near a late partial, Hz, are listed with it.
const NEAR_HZ: f64 = 8.0;
/// The late part, s after the onset.
const LATE_S: (f64, f64) = (0.3, 0.6);
/// What is looked for: within this of the loudest, this far over the surroundings; absent from this
/// on, dB.
const WITHIN_DB: f64 = 25.0;
const OVER_DB: f64 = 15.0;
const ABSENT_DB: f64 = 20.0;
/// Half width of the surroundings, Hz.
const AROUND_HZ: f64 = 150.0;
/// Where partials whose decay is compared are found, s after the onset; frames of the level, and
/// their step, s.
const DECAYING_S: (f64, f64) = (0.01, 0.16);
const FRAME_S: f64 = 0.046;
const STEP_S: f64 = 0.01;
/// How far down a decay is followed, and how far over the end of the sound it must stay, dB.
const FOLLOWED_DB: f64 = 35.0;
const OVER_END_DB: f64 = 10.0;

/// A late partial: its frequency, Hz, and by how much `played` is too quiet there, dB.
pub struct Late {
    pub hz: f64,
    pub missing_db: f64,
}

impl Late {
    pub fn absent(&self) -> bool {
        self.missing_db > ABSENT_DB
    }

    /// With those of `modes` that lie near it, as frequency/decay/amplitude.
    pub fn text(&self, modes: &[Mode]) -> String {
        let near = modes.iter().filter(|m| (m.frequency_hz - self.hz).abs() < NEAR_HZ);
        let near = near.map(|m| format!(" {:.2}/{:.2}/{:.1e}", m.frequency_hz, m.decay_per_s, m.amplitude));
        let absent = if self.absent() { "absent" } else { "" };
        format!(
            "    late {:8.1} Hz {:6.1} dB {absent:6}{}",
            self.hz,
            self.missing_db,
            near.collect::<String>()
        )
    }
}

/// The late partials of `sound`, and how much of each `played` misses.
pub fn late_partials(sound: &[f64], played: &[f64], rate: f64) -> Vec<Late> {
    let part = |x: &[f64], (from, to): (f64, f64)| {
        let at = |s: f64| (s * rate) as usize;
        (at(to) <= x.len()).then(|| x[at(from)..at(to)].to_vec())
    };
    let middle = 0.5 * (LATE_S.0 + LATE_S.1);
    let Some(late) = part(sound, LATE_S) else { return Vec::new() };
    let (Some(first), Some(second)) = (part(sound, (LATE_S.0, middle)), part(sound, (middle, LATE_S.1)))
    else {
        return Vec::new();
    };
    let found = peaks(&spectrum_db(&late), rate);
    let played = played[(LATE_S.0 * rate) as usize..(LATE_S.1 * rate) as usize].to_vec();
    let falls = |hz: &f64| level_db(&second, *hz, rate) < level_db(&first, *hz, rate) - 0.5;
    let missing = |hz: f64| level_db(&late, hz, rate) - level_db(&played, hz, rate);
    found.into_iter().filter(falls).map(|hz| Late { hz, missing_db: missing(hz) }).collect()
}

/// Relative errors of one partial's decay.
pub struct DecayError {
    /// Of the slope of its level.
    pub level: f64,
    /// Of the slope of the energy still to come, which beats sway less (Schroeder 1965).
    pub energy: f64,
    /// Of both, their signs kept: the two know of each other no more than that they look at the
    /// same partial.
    pub both: f64,
}

/// Errors of the decays of the strong partials.
pub fn decay_errors(sound: &[f64], played: &[f64], rate: f64) -> Vec<DecayError> {
    let at = |s: f64| (s * rate) as usize;
    let early = &sound[at(DECAYING_S.0).min(sound.len())..at(DECAYING_S.1).min(sound.len())];
    if early.len() < 1024 {
        return Vec::new();
    }
    peaks(&spectrum_db(early), rate)
        .into_iter()
        .filter_map(|hz| {
            let frames = levels(sound, hz, rate);
            let end = *frames.last()?;
            let followed = frames
                .iter()
                .position(|&l| l < (frames[0] - FOLLOWED_DB).max(end + OVER_END_DB))
                .unwrap_or(frames.len());
            if followed < 6 {
                return None;
            }
            let theirs = &frames[..followed];
            let ours = &levels(played, hz, rate)[..followed];
            // What does not fall has no decay.
            let falls = slope(theirs) < -0.02;
            let level = slope(ours) / slope(theirs) - 1.0;
            let energy = slope(&to_come(ours)) / slope(&to_come(theirs)) - 1.0;
            falls.then(|| DecayError {
                level: level.abs(),
                energy: energy.abs(),
                both: (0.5 * (level + energy)).abs(),
            })
        })
        .collect()
}

/// The energy still to come, dB, of the first seven tenths (after that it falls for want of what
/// follows).
fn to_come(levels: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut backwards: Vec<f64> = levels
        .iter()
        .rev()
        .map(|level| {
            sum += 10.0_f64.powf(0.1 * level);
            10.0 * sum.log10()
        })
        .collect();
    backwards.reverse();
    backwards.truncate((levels.len() * 7 / 10).max(4));
    backwards
}

/// Hann-windowed, padded fourfold.
fn spectrum_db(x: &[f64]) -> Vec<f64> {
    let size = (4 * x.len()).next_power_of_two();
    let mut buffer = vec![Complex::new(0.0, 0.0); size];
    for (n, (b, sample)) in buffer.iter_mut().zip(x).enumerate() {
        b.re = sample * hann(n, x.len());
    }
    FftPlanner::new().plan_fft_forward(size).process(&mut buffer);
    buffer[..size / 2].iter().map(|v| 10.0 * v.norm_sqr().max(1e-30).log10()).collect()
}

fn hann(n: usize, count: usize) -> f64 {
    0.5 - 0.5 * (2.0 * PI * n as f64 / count as f64).cos()
}

/// Frequencies of the peaks, Hz.
fn peaks(spectrum: &[f64], rate: f64) -> Vec<f64> {
    let bin_hz = 0.5 * rate / spectrum.len() as f64;
    let most = spectrum.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let half = (AROUND_HZ / bin_hz) as usize;
    (1..spectrum.len() - 1)
        .filter(|&k| {
            let level = spectrum[k];
            if level < most - WITHIN_DB || level < spectrum[k - 1] || level <= spectrum[k + 1] {
                return false;
            }
            let mut around = spectrum[k.saturating_sub(half)..(k + half).min(spectrum.len())].to_vec();
            let middle = around.len() / 2;
            level > *around.select_nth_unstable_by(middle, f64::total_cmp).1 + OVER_DB
        })
        .map(|k| k as f64 * bin_hz)
        .filter(|hz| *hz > 30.0)
        .collect()
}

/// Level of one frequency in a Hann window over `x`, dB.
fn level_db(x: &[f64], hz: f64, rate: f64) -> f64 {
    let turn = Complex::from_polar(1.0, -2.0 * PI * hz / rate);
    let (mut z, mut sum) = (Complex::new(1.0, 0.0), Complex::new(0.0, 0.0));
    let count = x.len();
    for (n, x) in x.iter().enumerate() {
        sum += z * (x * hann(n, count));
        z *= turn;
    }
    10.0 * sum.norm_sqr().max(1e-30).log10()
}

/// The level of one frequency over time, dB.
fn levels(x: &[f64], hz: f64, rate: f64) -> Vec<f64> {
    let (length, step) = ((FRAME_S * rate) as usize, (STEP_S * rate) as usize);
    let starts = (step..x.len().saturating_sub(length)).step_by(step);
    starts.map(|start| level_db(&x[start..start + length], hz, rate)).collect()
}

/// Of a straight line through `levels`, dB a step.
fn slope(levels: &[f64]) -> f64 {
    let n = levels.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = levels.iter().sum::<f64>() / n;
    let (mut up, mut down) = (0.0, 0.0);
    for (i, level) in levels.iter().enumerate() {
        let t = i as f64 - middle;
        up += t * (level - mean);
        down += t * t;
    }
    up / down
}
