//! `.hjif`: MPEG's haptics as JSON (ISO/IEC 23090-31), written as one cubic curve that keeps the
//! waveform.
//!
//! What is written: profile Main, level 1, timescale 8000, one vibrotactile perception with one
//! channel of one `Curve` band, `Cubic`, one effect at position 0 whose keyframes lie where
//! [`crate::keyframes`] puts them. Amplitudes stay within ±1, which a player clamps to before it
//! applies the channel's gain.
//!
//! What is read: `Curve` (linear and cubic), `VectorialWave`, `Transient`, effects of the library.
//! Wavelet streams, composite effects and other curves are refused by name. Times are ticks of the
//! timescale throughout, as the standard says; the reference software differs for curve effects
//! that do not begin at 0.

use crate::error::{PortError, within};
use crate::keyframes;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Ticks a second of what is written; also the rate of its samples, Hz.
pub const TIMESCALE: f64 = 8000.0;
/// The date of every file: the same samples give the same bytes.
const DATE: &str = "2026-01-01";
/// Length of a transient, s.
const TRANSIENT_S: f64 = 0.022;
/// Rate at which files are rendered, Hz.
pub const RATE_HZ: f64 = 8000.0;

/// Written file, and its size.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// Number of keyframes.
    pub keyframes: usize,
    /// Output of a player, at 8 kHz.
    pub samples: Vec<f64>,
}

/// Writes samples at 8 kHz within ±1 by at most `points_per_s` keyframes a second, fewer when
/// `wanted_snr_db` is reached.
///
/// # Errors
/// When there are no samples, or one is beyond ±1.
pub fn write(
    samples: &[f64],
    points_per_s: f64,
    wanted_snr_db: f64,
    description: &str,
) -> Result<Written, PortError> {
    if samples.len() < 2 {
        return Err(PortError::new("samples", "are fewer than 2", "must last longer"));
    }
    for (n, x) in samples.iter().enumerate() {
        within(format!("samples[{n}]"), *x, [-1.0, 1.0])?;
    }
    let most = (points_per_s * samples.len() as f64 / RATE_HZ).floor().max(2.0) as usize;
    let kept = keyframes::keyframes(samples, most, wanted_snr_db);
    // As the file says them: rounded to five digits.
    let frames: Vec<(usize, f64)> =
        kept.iter().map(|&(n, value)| (n, ((value * 1e5).round() / 1e5).clamp(-1.0, 1.0))).collect();
    let mut list = String::with_capacity(60 * frames.len());
    for (tick, value) in &frames {
        let comma = if list.is_empty() { "" } else { "," };
        let value = if *value == 0.0 { 0.0 } else { *value };
        let _ = write!(list, "{comma}{{\"relative_position\":{tick},\"amplitude_modulation\":{value:?}}}");
    }
    let effect = json!({"effect_type": "Basis", "position": 0, "phase": 0.0, "base_signal": "Sine", "keyframes": "KEYFRAMES"});
    let band = json!({
        "band_type": "Curve", "curve_type": "Cubic", "lower_frequency_limit": 0, "upper_frequency_limit": 1000,
        "effects": [effect],
    });
    let channel = json!({
        "id": 0, "description": "", "gain": 1.0, "mixing_coefficient": 1.0, "body_part_mask": 0,
        "frequency_sampling": RATE_HZ as u32, "sample_count": samples.len(), "bands": [band],
    });
    let perception = json!({
        "id": 0, "avatar_id": 0, "description": description, "perception_modality": "Vibrotactile",
        "effect_library": [], "reference_devices": [], "unit_exponent": -3, "perception_unit_exponent": 0,
        "channels": [channel],
    });
    let head = json!({
        "version": "2023", "profile": "Main", "level": 1, "date": DATE, "description": description,
        "timescale": TIMESCALE as u32, "avatars": [], "syncs": [], "perceptions": [perception],
    });
    let text = head.to_string().replacen("\"KEYFRAMES\"", &format!("[{list}]"), 1);
    let mut played = keyframes::joined(&frames);
    played.truncate(samples.len());
    Ok(Written { text, keyframes: frames.len(), samples: played })
}

/// Renders one channel of a file at [`RATE_HZ`].
///
/// # Errors
/// When it is no such file, has no such channel, or uses what is not read.
pub fn rendered(text: &str, channel: usize) -> Result<Vec<f64>, PortError> {
    let right = "must be JSON with timescale and perceptions";
    let file: Value = serde_json::from_str(text).map_err(|error| PortError::new("hjif", error, right))?;
    let timescale =
        within("timescale", file.get("timescale").and_then(Value::as_f64).unwrap_or(1000.0), [1.0, 1e9])?;
    let perceptions = list(&file, "perceptions")?;
    let mut channels = Vec::new();
    for perception in perceptions {
        let library =
            perception.get("effect_library").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let exponent = perception.get("perception_unit_exponent").and_then(Value::as_f64).unwrap_or(0.0);
        let factor = 10f64.powf(within("perception_unit_exponent", exponent, [-12.0, 12.0])?);
        channels.extend(list(perception, "channels")?.iter().map(|channel| (channel, library, factor)));
    }
    let Some((channel, library, factor)) = channels.get(channel).copied() else {
        let what = format!("{channel} is not there");
        return Err(PortError::new("channel", what, format!("must be below {}", channels.len())));
    };
    let gain =
        factor * within("gain", channel.get("gain").and_then(Value::as_f64).unwrap_or(1.0), [-1e6, 1e6])?;
    let player = Player { timescale, library };
    let mut samples = vec![0.0; said_length(channel)?];
    for (index, band) in list(channel, "bands")?.iter().enumerate() {
        player.band(band, &mut samples).map_err(|error| error.within(format!("bands[{index}]")))?;
        samples.iter_mut().for_each(|x| *x = x.clamp(-1.0, 1.0));
    }
    if samples.is_empty() {
        return Err(PortError::new("bands", "hold no vibration", "must have an effect that lasts"));
    }
    samples.iter_mut().for_each(|x| *x *= gain);
    Ok(samples)
}

fn list<'a>(of: &'a Value, key: &str) -> Result<&'a [Value], PortError> {
    let found = of.get(key).and_then(Value::as_array);
    found.map(Vec::as_slice).ok_or_else(|| PortError::new(key, "is missing", "must be a list"))
}

/// Samples that the channel says it has; 0 where it says nothing.
fn said_length(channel: &Value) -> Result<usize, PortError> {
    let said = |key: &str| channel.get(key).and_then(Value::as_f64).filter(|x| *x > 0.0);
    let (Some(rate_hz), Some(count)) = (said("frequency_sampling"), said("sample_count")) else {
        return Ok(0);
    };
    let duration_s = within("sample_count", count / rate_hz, [0.0, crate::clip::LONGEST_S])?;
    Ok((duration_s * RATE_HZ).round() as usize)
}

struct Player<'a> {
    timescale: f64,
    library: &'a [Value],
}

/// A keyframe with what it says.
#[derive(Clone, Copy)]
struct Keyframe {
    time_s: f64,
    amplitude: Option<f64>,
    frequency_hz: Option<f64>,
}

impl Player<'_> {
    fn band(&self, band: &Value, samples: &mut Vec<f64>) -> Result<(), PortError> {
        let kind = band.get("band_type").and_then(Value::as_str).unwrap_or("nothing");
        let effects = list(band, "effects")?;
        for (index, effect) in effects.iter().enumerate() {
            let at = |error: PortError| error.within(format!("effects[{index}]"));
            let begins_s = self.seconds(effect, "position").map_err(at)?;
            let effect = self.resolved(effect).map_err(at)?;
            let frames = self.frames(effect).map_err(at)?;
            match kind {
                "Curve" => {
                    let cubic = match band.get("curve_type").and_then(Value::as_str).unwrap_or("Cubic") {
                        "Cubic" => true,
                        "Linear" => false,
                        other => {
                            return Err(PortError::new(
                                "curve_type",
                                format!("{other} is not read"),
                                "must be Cubic or Linear",
                            ));
                        }
                    };
                    curve(begins_s, &frames, cubic, samples);
                }
                "VectorialWave" => wave(begins_s, &frames, effect, samples).map_err(at)?,
                "Transient" => frames.iter().for_each(|frame| transient(begins_s, frame, samples)),
                other => {
                    let right = "must be Curve, VectorialWave or Transient";
                    return Err(PortError::new("band_type", format!("{other} is not read"), right));
                }
            }
        }
        Ok(())
    }

    fn seconds(&self, of: &Value, key: &str) -> Result<f64, PortError> {
        let ticks = of.get(key).and_then(Value::as_f64).unwrap_or(0.0);
        within(key, ticks / self.timescale, [0.0, crate::clip::LONGEST_S])
    }

    /// The effect itself, or the one of the library that it names.
    fn resolved<'v>(&'v self, effect: &'v Value) -> Result<&'v Value, PortError> {
        match effect.get("effect_type").and_then(Value::as_str) {
            Some("Basis") => Ok(effect),
            Some("Reference") => {
                let id = effect.get("id").and_then(Value::as_i64);
                let found =
                    self.library.iter().find(|e| e.get("id").and_then(Value::as_i64) == id && id.is_some());
                found.ok_or_else(|| {
                    PortError::new("id", "is not in the library", "must name an effect of effect_library")
                })
            }
            other => {
                let what = format!("{} is not read", other.unwrap_or("nothing"));
                Err(PortError::new("effect_type", what, "must be Basis or Reference"))
            }
        }
    }

    fn frames(&self, effect: &Value) -> Result<Vec<Keyframe>, PortError> {
        let mut before_s = 0.0;
        list(effect, "keyframes")?
            .iter()
            .enumerate()
            .map(|(index, frame)| {
                let at = |error: PortError| error.within(format!("keyframes[{index}]"));
                let time_s = self.seconds(frame, "relative_position").map_err(at)?;
                within("relative_position", time_s, [before_s, crate::clip::LONGEST_S]).map_err(at)?;
                before_s = time_s;
                let optional = |key: &str, range| {
                    frame
                        .get(key)
                        .and_then(Value::as_f64)
                        .map(|x| within(key, x, range))
                        .transpose()
                        .map_err(at)
                };
                let amplitude = optional("amplitude_modulation", [-1e6, 1e6])?;
                let frequency_hz = optional("frequency_modulation", [0.0, 1e5])?;
                Ok(Keyframe { time_s, amplitude, frequency_hz })
            })
            .collect()
    }
}

/// Adds to the samples from a time on; they grow as far as is needed.
fn add(samples: &mut Vec<f64>, from_s: f64, to_s: f64, mut value: impl FnMut(f64) -> f64) {
    let first = (from_s * RATE_HZ - 1e-6).ceil() as usize;
    let last = (to_s * RATE_HZ + 1e-6).floor() as usize;
    if samples.len() <= last && last >= first {
        samples.resize(last + 1, 0.0);
    }
    for (n, sample) in samples.iter_mut().enumerate().take(last + 1).skip(first) {
        *sample += value(n as f64 / RATE_HZ - from_s);
    }
}

fn curve(begins_s: f64, frames: &[Keyframe], cubic: bool, samples: &mut Vec<f64>) {
    let points: Vec<(f64, f64)> = frames.iter().filter_map(|f| f.amplitude.map(|a| (f.time_s, a))).collect();
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { return };
    let mut index = 0;
    add(samples, begins_s + first.0, begins_s + last.0, |since_s| {
        let time_s = since_s + first.0;
        while index + 2 < points.len() && points[index + 1].0 <= time_s + 1e-9 {
            index += 1;
        }
        let (a, b) = (points[index], points[(index + 1).min(points.len() - 1)]);
        let x = if b.0 > a.0 { ((time_s - a.0) / (b.0 - a.0)).clamp(0.0, 1.0) } else { 1.0 };
        a.1 + (b.1 - a.1) * if cubic && points.len() > 2 { (3.0 - 2.0 * x) * x * x } else { x }
    });
}

fn transient(begins_s: f64, frame: &Keyframe, samples: &mut Vec<f64>) {
    let (from_s, amplitude) = (begins_s + frame.time_s, frame.amplitude.unwrap_or(0.0));
    add(samples, from_s, from_s + TRANSIENT_S, |t| amplitude * (2.0 * TAU * t / TRANSIENT_S).sin());
}

fn wave(begins_s: f64, frames: &[Keyframe], effect: &Value, samples: &mut Vec<f64>) -> Result<(), PortError> {
    let Some(last_s) = frames.last().map(|frame| frame.time_s) else { return Ok(()) };
    let phase = within("phase", effect.get("phase").and_then(Value::as_f64).unwrap_or(0.0), [-1e3, 1e3])?;
    let shape = match effect.get("base_signal").and_then(Value::as_str).unwrap_or("Sine") {
        "Sine" => |turns: f64| (TAU * turns).sin(),
        "Square" => |turns: f64| if turns.rem_euclid(1.0) < 0.5 { 1.0 } else { -1.0 },
        "Triangle" => |turns: f64| 1.0 - 4.0 * ((turns - 0.25).round() - (turns - 0.25)).abs(),
        "SawToothUp" => |turns: f64| 2.0 * (turns - (turns + 0.5).floor()),
        "SawToothDown" => |turns: f64| 2.0 * ((turns + 0.5).floor() - turns),
        other => {
            let right = "must be Sine, Square, Triangle, SawToothUp or SawToothDown";
            return Err(PortError::new("base_signal", format!("{other} is unknown"), right));
        }
    };
    let amplitudes: Vec<_> = frames.iter().filter_map(|f| f.amplitude.map(|a| (f.time_s, a))).collect();
    let frequencies: Vec<_> = frames.iter().filter_map(|f| f.frequency_hz.map(|hz| (f.time_s, hz))).collect();
    let plain = amplitudes.is_empty();
    let mut amplitude = crate::clip::Line::new(amplitudes.into_iter());
    let mut frequency = crate::clip::Line::new(frequencies.into_iter());
    let mut turns = phase / TAU;
    add(samples, begins_s, begins_s + last_s, |time_s| {
        let y = if plain { 1.0 } else { amplitude.at(time_s) } * shape(turns);
        turns += frequency.at(time_s) / RATE_HZ;
        y
    });
    Ok(())
}
