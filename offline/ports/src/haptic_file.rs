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

use crate::clip::{About, AmplitudePoint, Clip, FrequencyPoint, Read};
use crate::error::PortError;
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
struct File {
    version: Version,
    #[serde(default)]
    metadata: About,
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
    amplitude: Vec<AmplitudePoint>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    frequency: Option<Vec<FrequencyPoint>>,
}

/// Reads a clip. Frequency points outside the amplitude's time, which early editors wrote, are left
/// out and reported.
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
    let Envelopes { amplitude, frequency } = file.signals.continuous.envelopes;
    let mut frequency = frequency.unwrap_or_default();
    let count = frequency.len();
    let bounds = amplitude.first().map_or(0.0, |p| p.time_s)..=amplitude.last().map_or(0.0, |p| p.time_s);
    frequency.retain(|p| bounds.contains(&p.time_s));
    let mut remarks = Vec::new();
    if frequency.len() < count {
        let lost = count - frequency.len();
        remarks.push(format!("{lost} frequency points outside the amplitude envelope are left out"));
    }
    Ok(Read { clip: Clip { amplitude, frequency, about: file.metadata }.checked()?, remarks })
}

/// Writes a clip as version 1.0.
///
/// # Errors
/// When the clip breaks a rule of the format.
pub fn write(clip: &Clip) -> Result<String, PortError> {
    let Clip { amplitude, frequency, about } = clip.clone().checked()?;
    let frequency = Some(frequency).filter(|points| !points.is_empty());
    let file = File {
        version: Version { major: 1, minor: 0, patch: 0 },
        metadata: about,
        signals: Signals { continuous: Continuous { envelopes: Envelopes { amplitude, frequency } } },
    };
    serde_json::to_string(&file).map_err(|error| PortError::new("haptic", error, "please report it"))
}
