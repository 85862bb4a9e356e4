//! AHAP: events and parameter curves of Core Haptics.
//!
//! | in a clip | in the file |
//! |---|---|
//! | amplitude a | `HapticIntensityControl` √a, because an intensity is felt as its square; a ramp bends and is cut as on reading |
//! | frequency f | `HapticSharpnessControl` f |
//! | duration | `HapticContinuous` events of intensity 1 and sharpness 0, at most 30 s each |
//! | a stroke | `HapticTransient` of intensity √a and sharpness f |
//!
//! A curve holds at most [`MOST_POINTS`] points; a longer one is split, and the point at the joint
//! stands in both. A curve begins at its own `Time`, its points count from there. Curves scale
//! *every* event of their pattern, so strokes that stand beside curves go into a second file.
//! `AudioCustom` plays a sound file in step.

use crate::ahap_reader::{Pieces, parts};
use crate::clip::{Clip, Emphasis, Read};
use crate::error::PortError;
use serde_json::{Value, json};

/// Most points of a curve.
pub const MOST_POINTS: usize = 16;
/// Longest continuous event, s.
pub const LONGEST_EVENT_S: f64 = 30.0;

/// The files of a clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Files {
    /// Envelopes; strokes too where there is no envelope that would scale them.
    pub main: String,
    /// Strokes, where they cannot stand beside the curves.
    pub transients: Option<String>,
}

fn parameters(intensity: f64, sharpness: f64) -> Value {
    json!([
        { "ParameterID": "HapticIntensity", "ParameterValue": intensity },
        { "ParameterID": "HapticSharpness", "ParameterValue": sharpness },
    ])
}

/// Points split into curves of at most [`MOST_POINTS`], the joints repeated.
fn curves(parameter: &'static str, points: &[(f64, f64)]) -> impl Iterator<Item = Value> {
    let mut first = 0;
    std::iter::from_fn(move || {
        let begins_s = points.get(first)?.0;
        let last = (first + MOST_POINTS).min(points.len());
        let control = |(t, value): &(f64, f64)| json!({ "Time": t - begins_s, "ParameterValue": value });
        let part: Vec<Value> = points[first..last].iter().map(control).collect();
        first = if last == points.len() { last } else { last - 1 };
        Some(json!({ "ParameterCurve": {
            "ParameterID": parameter, "Time": begins_s, "ParameterCurveControlPoints": part,
        } }))
    })
}

fn text(pattern: &[Value]) -> String {
    json!({ "Version": 1.0, "Pattern": pattern }).to_string()
}

/// Intensities that are straight in between where the clip's amplitudes are.
fn intensities(clip: &Clip) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = clip.amplitude.iter().take(1).map(|p| (p.time_s, p.amplitude.sqrt())).collect();
    for pair in clip.amplitude.windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        let (a, b) = (from.amplitude.sqrt(), to.amplitude.sqrt());
        let lasts_s = to.time_s - from.time_s;
        if lasts_s > 0.0 {
            let between = parts(&[a], &[b]).into_iter().filter(|part| *part > 0.0 && *part < 1.0);
            points.extend(between.map(|part| {
                let intensity = a + part * (b - a);
                let share = (intensity * intensity - from.amplitude) / (to.amplitude - from.amplitude);
                (from.time_s + share.clamp(0.0, 1.0) * lasts_s, intensity)
            }));
        }
        points.push((to.time_s, b));
    }
    points
}

/// Writes a clip; with the path of a sound that plays in step, if any.
///
/// # Errors
/// When the clip breaks a rule.
pub fn write(clip: &Clip, sound: Option<&str>) -> Result<Files, PortError> {
    let clip = clip.clone().checked()?;
    let strokes = clip.amplitude.iter().filter_map(|p| p.emphasis.map(|e| (p.time_s, e)));
    let stroke = |(time_s, e): (f64, Emphasis)| {
        json!({ "Event": {
            "Time": time_s, "EventType": "HapticTransient",
            "EventParameters": parameters(e.amplitude.sqrt(), e.frequency),
        } })
    };
    let strokes: Vec<Value> = strokes.map(stroke).collect();
    let mut pattern = Vec::new();
    if let Some(path) = sound {
        pattern.push(json!({ "Event": {
            "Time": 0.0, "EventType": "AudioCustom", "EventWaveformPath": path,
            "EventParameters": [{ "ParameterID": "AudioVolume", "ParameterValue": 1.0 }],
        } }));
    }
    if clip.amplitude.iter().all(|p| p.amplitude == 0.0) && !strokes.is_empty() {
        pattern.extend(strokes);
        return Ok(Files { main: text(&pattern), transients: None });
    }
    let (begins_s, ends_s) = (clip.amplitude[0].time_s, clip.duration_s());
    let mut time = begins_s;
    while time < ends_s {
        pattern.push(json!({ "Event": {
            "Time": time, "EventType": "HapticContinuous",
            "EventDuration": (ends_s - time).min(LONGEST_EVENT_S), "EventParameters": parameters(1.0, 0.0),
        } }));
        time += LONGEST_EVENT_S;
    }
    let intensity = intensities(&clip);
    let sharpness: Vec<_> = match clip.frequency.as_slice() {
        [] => vec![(begins_s, 0.5), (ends_s, 0.5)],
        points => points.iter().map(|p| (p.time_s, p.frequency)).collect(),
    };
    pattern.extend(curves("HapticIntensityControl", &intensity));
    pattern.extend(curves("HapticSharpnessControl", &sharpness));
    let transients = (!strokes.is_empty()).then(|| text(&strokes));
    Ok(Files { main: text(&pattern), transients })
}

/// Reads a clip: continuous events times their curves, transients as strokes. Sounds and parameters
/// that are no vibration are reported.
///
/// # Errors
/// When it is no AHAP, or a number is no time or value.
pub fn parse(source: &str) -> Result<Read, PortError> {
    parse_all(&[source])
}

/// Reads a clip whose strokes lie in a file of their own.
///
/// # Errors
/// As [`parse`].
pub fn parse_both(main: &str, transients: &str) -> Result<Read, PortError> {
    parse_all(&[main, transients])
}

fn parse_all(sources: &[&str]) -> Result<Read, PortError> {
    let mut pieces = Pieces::default();
    for source in sources {
        pieces.add_file(source)?;
    }
    pieces.clip()
}
