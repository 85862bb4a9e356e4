//! `.haptic` 1.0: two envelopes as JSON.
//!
//! ```json
//! {"version":{"major":1,"minor":0,"patch":0},"metadata":{"editor":"","author":"","source":"","project":"","tags":[],"description":""},
//!  "signals":{"continuous":{"envelopes":{
//!    "amplitude":[{"time":0.0,"amplitude":0.2,"emphasis":{"amplitude":0.6,"frequency":0.7}},{"time":1.0,"amplitude":0.0}],
//!    "frequency":[{"time":0.0,"frequency":0.5}]}}}}
//! ```
//! Everything lies in 0–1; at least two amplitude points, times that do not fall, strokes not below
//! the envelope, no frequency point outside the amplitude's time. Times are read as `f32` by the
//! public reader, so a clip must last in `f32` too.

use crate::clip::{About, AmplitudePoint, Clip, Emphasis, FrequencyPoint, Read};
use crate::error::PortError;
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct File {
    version: Version,
    #[serde(default)]
    metadata: Metadata,
    signals: Signals,
}

#[derive(Serialize, Deserialize)]
struct Version {
    major: u32,
    // The vendor's reader asks for the major number alone.
    #[serde(default)]
    minor: u32,
    #[serde(default)]
    patch: u32,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default)]
struct Metadata {
    editor: String,
    author: String,
    source: String,
    project: String,
    tags: Vec<String>,
    description: String,
}

#[derive(Serialize, Deserialize)]
struct Signals {
    continuous: Continuous,
}

#[derive(Serialize, Deserialize)]
struct Continuous {
    envelopes: Envelopes,
}

#[derive(Serialize, Deserialize)]
struct Envelopes {
    amplitude: Vec<FileAmplitude>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    frequency: Option<Vec<FileFrequency>>,
}

#[derive(Serialize, Deserialize)]
struct FileAmplitude {
    time: f64,
    amplitude: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    emphasis: Option<FileEmphasis>,
}

#[derive(Serialize, Deserialize)]
struct FileEmphasis {
    amplitude: f64,
    frequency: f64,
}

#[derive(Serialize, Deserialize)]
struct FileFrequency {
    time: f64,
    frequency: f64,
}

/// Reads a clip. Frequency points outside the amplitude's time, which early editors wrote, are left
/// out and told.
///
/// # Errors
/// When it is no `.haptic` of version 1, or breaks another rule of the format.
pub fn parse(text: &str) -> Result<Read, PortError> {
    let file: File = serde_json::from_str(text).map_err(|error| {
        PortError::new("haptic", error, "must be JSON with version and signals.continuous.envelopes")
    })?;
    if file.version.major != 1 {
        let Version { major, minor, patch } = file.version;
        return Err(PortError::new("version", format!("{major}.{minor}.{patch} is unknown"), "must be 1.x"));
    }
    let envelopes = file.signals.continuous.envelopes;
    let emphasis = |e: FileEmphasis| Emphasis { amplitude: e.amplitude, frequency: e.frequency };
    let amplitude: Vec<AmplitudePoint> = envelopes
        .amplitude
        .into_iter()
        .map(|p| AmplitudePoint {
            time_s: p.time,
            amplitude: p.amplitude,
            emphasis: p.emphasis.map(emphasis),
        })
        .collect();
    let frequency = envelopes.frequency.unwrap_or_default();
    let count = frequency.len();
    let bounds = amplitude.first().map_or(0.0, |p| p.time_s)..=amplitude.last().map_or(0.0, |p| p.time_s);
    let frequency: Vec<FrequencyPoint> = frequency
        .into_iter()
        .filter(|p| bounds.contains(&p.time))
        .map(|p| FrequencyPoint { time_s: p.time, frequency: p.frequency })
        .collect();
    let mut told = Vec::new();
    if frequency.len() < count {
        let lost = count - frequency.len();
        told.push(format!("{lost} frequency points outside the amplitude envelope are left out"));
    }
    let Metadata { editor, author, source, project, tags, description } = file.metadata;
    let about = About { editor, author, source, project, tags, description };
    Ok(Read { clip: Clip { amplitude, frequency, about }.checked()?, told })
}

/// Writes a clip as version 1.0.
///
/// # Errors
/// When the clip breaks a rule of the format.
pub fn write(clip: &Clip) -> Result<String, PortError> {
    let clip = clip.clone().checked()?;
    let amplitude = clip.amplitude.iter().map(|p| FileAmplitude {
        time: p.time_s,
        amplitude: p.amplitude,
        emphasis: p.emphasis.map(|e| FileEmphasis { amplitude: e.amplitude, frequency: e.frequency }),
    });
    let frequency = clip.frequency.iter().map(|p| FileFrequency { time: p.time_s, frequency: p.frequency });
    let frequency: Vec<FileFrequency> = frequency.collect();
    let About { editor, author, source, project, tags, description } = clip.about;
    let file = File {
        version: Version { major: 1, minor: 0, patch: 0 },
        metadata: Metadata { editor, author, source, project, tags, description },
        signals: Signals {
            continuous: Continuous {
                envelopes: Envelopes {
                    amplitude: amplitude.collect(),
                    frequency: (!frequency.is_empty()).then_some(frequency),
                },
            },
        },
    };
    serde_json::to_string(&file).map_err(|error| PortError::new("haptic", error, "please report it"))
}
