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
use crate::clip::{Clip, Read};
use crate::error::PortError;
use serde::Serialize;

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

#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct File {
    version: f64,
    pattern: Vec<Item>,
}

#[derive(Serialize)]
enum Item {
    Event(Event),
    ParameterCurve(Curve),
}

#[derive(Serialize, Default)]
#[serde(rename_all = "PascalCase")]
struct Event {
    time: f64,
    event_type: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    event_duration: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    event_waveform_path: Option<String>,
    event_parameters: Vec<Parameter>,
}

#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct Parameter {
    #[serde(rename = "ParameterID")]
    parameter_id: &'static str,
    parameter_value: f64,
}

#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct Curve {
    #[serde(rename = "ParameterID")]
    parameter_id: &'static str,
    time: f64,
    parameter_curve_control_points: Vec<ControlPoint>,
}

#[derive(Serialize)]
#[serde(rename_all = "PascalCase")]
struct ControlPoint {
    time: f64,
    parameter_value: f64,
}

fn parameters(intensity: f64, sharpness: f64) -> Vec<Parameter> {
    vec![
        Parameter { parameter_id: "HapticIntensity", parameter_value: intensity },
        Parameter { parameter_id: "HapticSharpness", parameter_value: sharpness },
    ]
}

/// Points split into curves of at most [`MOST_POINTS`], the joints repeated.
fn curves(parameter_id: &'static str, points: &[(f64, f64)]) -> impl Iterator<Item = Item> {
    let mut first = 0;
    std::iter::from_fn(move || {
        if first >= points.len() {
            return None;
        }
        let last = (first + MOST_POINTS).min(points.len());
        let time = points[first].0;
        let control = |(t, value): &(f64, f64)| ControlPoint { time: t - time, parameter_value: *value };
        let parameter_curve_control_points = points[first..last].iter().map(control).collect();
        first = if last == points.len() { last } else { last - 1 };
        Some(Item::ParameterCurve(Curve { parameter_id, time, parameter_curve_control_points }))
    })
}

fn text(pattern: Vec<Item>) -> Result<String, PortError> {
    serde_json::to_string(&File { version: 1.0, pattern })
        .map_err(|error| PortError::new("ahap", error, "please report it"))
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
    let strokes: Vec<Item> = strokes
        .map(|(time, e)| {
            let event_parameters = parameters(e.amplitude.sqrt(), e.frequency);
            Item::Event(Event { time, event_type: "HapticTransient", event_parameters, ..Event::default() })
        })
        .collect();
    let mut pattern = Vec::new();
    if let Some(path) = sound {
        let volume = Parameter { parameter_id: "AudioVolume", parameter_value: 1.0 };
        let event_waveform_path = Some(path.to_owned());
        let event_parameters = vec![volume];
        let event =
            Event { event_type: "AudioCustom", event_waveform_path, event_parameters, ..Event::default() };
        pattern.push(Item::Event(event));
    }
    if clip.amplitude.iter().all(|p| p.amplitude == 0.0) && !strokes.is_empty() {
        pattern.extend(strokes);
        return Ok(Files { main: text(pattern)?, transients: None });
    }
    let (begins_s, ends_s) = (clip.amplitude[0].time_s, clip.duration_s());
    let mut time = begins_s;
    while time < ends_s {
        let event_duration = Some((ends_s - time).min(LONGEST_EVENT_S));
        let event_parameters = parameters(1.0, 0.0);
        let event = Event {
            time,
            event_type: "HapticContinuous",
            event_duration,
            event_parameters,
            ..Event::default()
        };
        pattern.push(Item::Event(event));
        time += LONGEST_EVENT_S;
    }
    let intensity = intensities(&clip);
    let sharpness: Vec<_> = match clip.frequency.as_slice() {
        [] => vec![(begins_s, 0.5), (ends_s, 0.5)],
        points => points.iter().map(|p| (p.time_s, p.frequency)).collect(),
    };
    pattern.extend(curves("HapticIntensityControl", &intensity));
    pattern.extend(curves("HapticSharpnessControl", &sharpness));
    let transients = if strokes.is_empty() { None } else { Some(text(strokes)?) };
    Ok(Files { main: text(pattern)?, transients })
}

/// Reads a clip: continuous events times their curves, transients as strokes. Sounds and parameters
/// that are no vibration are told.
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
