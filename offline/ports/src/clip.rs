//! Clip: a vibration as two envelopes, amplitude and frequency, and short strokes upon them.
//!
//! This is what phones and headsets play, whatever their files are called: a sine whose peak and
//! frequency go in straight lines from point to point. Amplitude 1 is a sine of peak 1 in the
//! samples that it was made from; frequency 0 to 1 spans the device's range. Its parts are written
//! as `.haptic` has them.

use crate::error::{PortError, within};
use serde::{Deserialize, Serialize};

/// Longest clip, s.
pub const LONGEST_S: f64 = 3600.0;

/// A stroke that stands above the envelope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Emphasis {
    /// 0 to 1, at least the envelope's.
    pub amplitude: f64,
    /// 0 to 1: from a dull knock to a sharp click.
    pub frequency: f64,
}

/// A point of the amplitude's envelope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AmplitudePoint {
    /// Seconds since the beginning.
    #[serde(rename = "time")]
    pub time_s: f64,
    /// 0 to 1.
    pub amplitude: f64,
    /// A stroke that begins here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emphasis: Option<Emphasis>,
}

/// A point of the frequency's envelope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FrequencyPoint {
    /// Seconds since the beginning.
    #[serde(rename = "time")]
    pub time_s: f64,
    /// 0 to 1 of the device's range.
    pub frequency: f64,
}

/// Who made a clip of what.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct About {
    /// The program that wrote it first.
    pub editor: String,
    /// Its author.
    pub author: String,
    /// Origin.
    pub source: String,
    /// The project it belongs to.
    pub project: String,
    /// Words to find it by.
    pub tags: Vec<String>,
    /// Description.
    pub description: String,
}

/// A vibration as two envelopes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Clip {
    /// At least two points, in time order; equal times are a jump.
    pub amplitude: Vec<AmplitudePoint>,
    /// In time order within the amplitude's; empty: the middle of the range throughout.
    pub frequency: Vec<FrequencyPoint>,
    /// Who made it.
    pub about: About,
}

/// Clip that was read, and what was left out or changed in reading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Read {
    /// The clip.
    pub clip: Clip,
    /// Sentences for the user.
    pub remarks: Vec<String>,
}

impl Clip {
    /// The time of its last amplitude point, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.amplitude.last().map_or(0.0, |point| point.time_s)
    }

    /// The clip itself when it keeps every rule: two points, a duration, times that do not fall,
    /// values from 0 to 1, no stroke below its envelope, no frequency outside the amplitude's time.
    ///
    /// # Errors
    /// The first rule that is broken, with its point.
    pub fn checked(self) -> Result<Self, PortError> {
        if self.amplitude.len() < 2 {
            let what = format!("has {} points", self.amplitude.len());
            return Err(PortError::new("amplitude", what, "must have at least 2"));
        }
        let mut before_s = 0.0;
        for (index, point) in self.amplitude.iter().enumerate() {
            let at = |field: &str| format!("amplitude[{index}].{field}");
            within(at("time"), point.time_s, [before_s, LONGEST_S])?;
            within(at("amplitude"), point.amplitude, [0.0, 1.0])?;
            if let Some(emphasis) = point.emphasis {
                within(at("emphasis.amplitude"), emphasis.amplitude, [point.amplitude, 1.0])?;
                within(at("emphasis.frequency"), emphasis.frequency, [0.0, 1.0])?;
            }
            before_s = point.time_s;
        }
        let (first_s, last_s) = (self.amplitude[0].time_s, self.duration_s());
        if (last_s as f32 - first_s as f32) <= 0.0 {
            return Err(PortError::new("amplitude", "lasts 0 s", "must last longer"));
        }
        let mut before_s = first_s;
        for (index, point) in self.frequency.iter().enumerate() {
            within(format!("frequency[{index}].time"), point.time_s, [before_s, last_s])?;
            within(format!("frequency[{index}].frequency"), point.frequency, [0.0, 1.0])?;
            before_s = point.time_s;
        }
        Ok(self)
    }

    /// Both envelopes on a grid of `rate_hz`: amplitude, and frequency 0 to 1.
    pub fn sampled(&self, rate_hz: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let count = (self.duration_s() * rate_hz - 1e-6).ceil().max(0.0) as usize;
        let mut amplitude = Line::new(self.amplitude.iter().map(|p| (p.time_s, p.amplitude)));
        let mut frequency = Line::new(self.frequency.iter().map(|p| (p.time_s, p.frequency)));
        let (starts_s, plain) = (self.amplitude.first().map_or(0.0, |p| p.time_s), self.frequency.is_empty());
        (0..count).map(move |n| {
            let time_s = n as f64 / rate_hz;
            let level = if time_s < starts_s { 0.0 } else { amplitude.at(time_s) };
            (level, if plain { 0.5 } else { frequency.at(time_s) })
        })
    }
}

/// Straight lines between points, read forwards.
pub(crate) struct Line<I: Iterator<Item = (f64, f64)>> {
    rest: I,
    from: (f64, f64),
    to: (f64, f64),
}

impl<I: Iterator<Item = (f64, f64)>> Line<I> {
    pub(crate) fn new(mut rest: I) -> Self {
        let first = rest.next().unwrap_or((0.0, 0.0));
        Self { rest, from: first, to: first }
    }

    /// The value at a time that is not before the last one asked for; held before the first point
    /// and behind the last.
    pub(crate) fn at(&mut self, time_s: f64) -> f64 {
        while time_s >= self.to.0 {
            let Some(next) = self.rest.next() else {
                return self.to.1;
            };
            (self.from, self.to) = (self.to, next);
        }
        if time_s <= self.from.0 {
            return self.from.1;
        }
        let part = (time_s - self.from.0) / (self.to.0 - self.from.0);
        self.from.1 + part * (self.to.1 - self.from.1)
    }
}
