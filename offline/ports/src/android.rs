//! Android's vibrator: a waveform of levels and two kinds of envelope, as one JSON file for an app
//! to hand on.
//!
//! | key | for | rule kept |
//! |---|---|---|
//! | `waveform` | `VibrationEffect.createWaveform(timings_ms, amplitudes, repeat)`, API 26 | 1–255: a 0 inside stops the motor audibly; pieces of at least 1 ms |
//! | `basic_envelope` | `BasicEnvelopeBuilder.addControlPoint`, API 36 | intensity and sharpness 0–1, 20 to 1000 ms a point, ends at intensity 0 |
//! | `waveform_envelope` | `WaveformEnvelopeBuilder.addControlPoint`, API 36 | amplitude 0–1, Hz inside the device's range, 20 to 1000 ms, ends at amplitude 0 |
//!
//! A control point is reached *after* its duration, from the one before; the first from 0. What a
//! phone allows (how many points, how short) is known on the phone only: [`LEAST_MS`] and
//! [`MOST_MS`] are what every phone that has envelopes must allow (recalled).

use crate::clip::{Clip, Line};
use crate::device::Device;
use crate::error::PortError;
use serde::Serialize;
use std::f64::consts::TAU;

/// Shortest control point, ms.
pub const LEAST_MS: u64 = 20;
/// Longest control point, ms.
pub const MOST_MS: u64 = 1000;
/// Step of the waveform, ms.
const STEP_MS: u64 = 10;

/// The file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct File {
    /// Levels for any phone that has them.
    pub waveform: Waveform,
    /// For phones that know perceived intensity and sharpness.
    pub basic_envelope: Vec<BasicPoint>,
    /// For phones that know amplitude and frequency.
    pub waveform_envelope: Vec<WaveformPoint>,
}

/// Levels, each for its time.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Waveform {
    /// ms.
    pub timings_ms: Vec<u64>,
    /// 1 to 255.
    pub amplitudes: Vec<u8>,
    /// Index to repeat from; −1: not at all.
    pub repeat: i32,
}

/// A point of the perceptual envelope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BasicPoint {
    /// 0 to 1.
    pub intensity: f64,
    /// 0 to 1.
    pub sharpness: f64,
    /// Time to get here, ms.
    pub duration_ms: u64,
}

/// A point of the physical envelope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WaveformPoint {
    /// 0 to 1.
    pub amplitude: f64,
    /// Hz.
    pub frequency_hz: f64,
    /// Time to get here, ms.
    pub duration_ms: u64,
}

/// Output of a phone for a clip.
///
/// # Errors
/// When the clip breaks a rule.
pub fn file(clip: &Clip, device: &Device) -> Result<File, PortError> {
    let clip = clip.clone().checked()?;
    let waveform_envelope = envelope(&clip, device);
    let basic_envelope = waveform_envelope
        .iter()
        .map(|p| BasicPoint {
            // Intensity is felt as its square.
            intensity: rounded(p.amplitude.sqrt()),
            sharpness: rounded(device.frequency(p.frequency_hz)),
            duration_ms: p.duration_ms,
        })
        .collect();
    Ok(File { waveform: waveform(&clip), basic_envelope, waveform_envelope })
}

/// The file as JSON.
///
/// # Errors
/// As [`fn@file`].
pub fn write(clip: &Clip, device: &Device) -> Result<String, PortError> {
    serde_json::to_string(&file(clip, device)?)
        .map_err(|error| PortError::new("android", error, "please report it"))
}

fn rounded(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

/// The greatest level of every step: an envelope's, or a stroke's in the steps that it lasts.
fn waveform(clip: &Clip) -> Waveform {
    let total_ms = ((clip.duration_s() * 1e3).round() as u64).max(1);
    let mut level = Line::new(clip.amplitude.iter().map(|p| (p.time_s, p.amplitude)));
    let mut levels: Vec<(u64, f64)> = Vec::new();
    let mut from_ms = 0;
    while from_ms < total_ms {
        let to_ms = (from_ms + STEP_MS).min(total_ms);
        let mean = 0.5 * (level.at(from_ms as f64 * 1e-3 + 1e-9) + level.at(to_ms as f64 * 1e-3 - 1e-9));
        let steps_s = (from_ms as f64 * 1e-3 - 0.01)..(to_ms as f64 * 1e-3);
        let strokes =
            clip.amplitude.iter().filter(|p| steps_s.contains(&p.time_s)).filter_map(|p| p.emphasis);
        levels.push((to_ms - from_ms, strokes.map(|e| e.amplitude).fold(mean, f64::max)));
        from_ms = to_ms;
    }
    let (mut timings_ms, mut amplitudes): (Vec<u64>, Vec<u8>) = (Vec::new(), Vec::new());
    for (length_ms, level) in levels {
        let amplitude = (level * 255.0).round().clamp(1.0, 255.0) as u8;
        match (amplitudes.last(), timings_ms.last_mut()) {
            (Some(last), Some(timing)) if *last == amplitude => *timing += length_ms,
            _ => {
                amplitudes.push(amplitude);
                timings_ms.push(length_ms);
            }
        }
    }
    Waveform { timings_ms, amplitudes, repeat: -1 }
}

fn envelope(clip: &Clip, device: &Device) -> Vec<WaveformPoint> {
    let total_ms = ((clip.duration_s() * 1e3).round() as u64).max(LEAST_MS);
    let mut level = Line::new(clip.amplitude.iter().map(|p| (p.time_s, p.amplitude)));
    let mut tone = Line::new(clip.frequency.iter().map(|p| (p.time_s, p.frequency)));
    let plain = clip.frequency.is_empty();
    let count = (total_ms / LEAST_MS).max(1);
    let mut points: Vec<WaveformPoint> = Vec::with_capacity(count as usize);
    let mut before_ms = 0;
    for k in 1..=count {
        let at_ms = total_ms * k / count;
        let time_s = at_ms as f64 * 1e-3;
        let amplitude = if k == count { 0.0 } else { rounded(level.at(time_s).clamp(0.0, 1.0)) };
        let frequency_hz = rounded(device.hz(if plain { 0.5 } else { tone.at(time_s) }));
        let duration_ms = at_ms - before_ms;
        before_ms = at_ms;
        // What goes on without a change is one point, as long as it may be.
        let still = |last: &WaveformPoint| last.amplitude == amplitude && last.frequency_hz == frequency_hz;
        let flat_before = points.len() >= 2 && still(&points[points.len() - 2]);
        match points.last_mut() {
            Some(last) if still(last) && flat_before && last.duration_ms + duration_ms <= MOST_MS => {
                last.duration_ms += duration_ms;
            }
            _ => points.push(WaveformPoint { amplitude, frequency_hz, duration_ms }),
        }
    }
    points
}

/// Physical envelope after the format: a sine that goes from point to point.
#[must_use]
pub fn rendered(points: &[WaveformPoint], rate_hz: f64) -> Vec<f64> {
    let mut out = Vec::new();
    let (mut phase, mut time_s) = (0.0_f64, 0.0);
    let mut from = (0.0, points.first().map_or(0.0, |p| p.frequency_hz));
    for point in points {
        let length_s = point.duration_ms as f64 * 1e-3;
        let end = ((time_s + length_s) * rate_hz - 1e-6).ceil() as usize;
        while out.len() < end {
            let part = (out.len() as f64 / rate_hz - time_s) / length_s;
            out.push((from.0 + part * (point.amplitude - from.0)) * (TAU * phase).sin());
            phase = (phase + (from.1 + part * (point.frequency_hz - from.1)) / rate_hz).fract();
        }
        from = (point.amplitude, point.frequency_hz);
        time_s += length_s;
    }
    out
}
