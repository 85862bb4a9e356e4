//! Contact logs: what a game reported, one JSON object a line, in time order.
//!
//! A log names surfaces and bodies as the scene file does; [`Names`] turns them into the ids of a
//! running [`Scene`](crate::Scene). Replaying a log offline gives the same samples as the live
//! engine that recorded it.

mod edit;
mod error;
mod keys;
mod names;
mod object;

use super::storage::{self, Disk, Files};
pub use crate::model::event::ContactSample;
use crate::model::event::Emphasis;
use crate::model::material::Material;
use crate::model::pickup::RigidMotion;
pub use edit::{LogBody, LogEdit, LogSurface};
pub use error::LogError;
use keys::Unread;
pub use names::Names;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;

/// The `version` that is read and written; a log without one is of this version.
pub const VERSION: u64 = 1;

/// One line of a log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LogLine {
    /// Game time, s.
    pub t: f64,
    /// Event.
    #[serde(flatten)]
    pub event: LogEvent,
}

/// Event, with names instead of ids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "lowercase")]
pub enum LogEvent {
    /// A contact lands.
    Begin {
        /// The contact's name.
        contact: u64,
        /// Surface, probe and actuator.
        #[serde(flatten)]
        touching: LogTouching,
        /// Place and manner.
        #[serde(flatten)]
        sample: ContactSample,
    },
    /// A contact goes on.
    Move {
        /// The contact's name.
        contact: u64,
        /// Place and manner.
        #[serde(flatten)]
        sample: ContactSample,
        /// Gain and importance from now on.
        #[serde(flatten)]
        emphasis: Emphasis,
    },
    /// A contact lifts off.
    End {
        /// The contact's name.
        contact: u64,
    },
    /// A rigid striker hits a body.
    Impact {
        /// Name of the body.
        body: String,
        /// Name of the striker's own body, when it rings too.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        other: Option<String>,
        /// Approach speed, m/s.
        speed_m_s: f64,
        /// Effective mass of the striker, kg.
        mass_kg: f64,
        /// Radius of curvature, m.
        radius_m: f64,
        /// Material of the striker.
        striker: Striker,
        /// Rebound over approach speed; missing: 1, the loss-free Hertz impact.
        #[serde(default = "loss_free")]
        restitution: f64,
        /// Which of the body's strike positions is hit; missing: 0.
        #[serde(default, skip_serializing_if = "is_first")]
        position: usize,
        /// Place that is hit, m in the body's frame; missing: at `position`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_m: Option<[f64; 3]>,
        /// Along what it is hit; missing: the inward normal.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        direction: Option<[f64; 3]>,
        /// The hand: who feels it and what it holds.
        #[serde(flatten)]
        hand: LogHand,
    },
    /// A body moves as a whole.
    Motion {
        /// Name of the body.
        body: String,
        /// Motion at this instant, in its own axes.
        #[serde(flatten)]
        motion: RigidMotion,
    },
    /// The scene was edited.
    #[serde(untagged)]
    Edit(LogEdit),
}

/// Surface, probe and actuator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LogTouching {
    /// Name of the surface.
    pub surface: String,
    /// Importance beside other contacts; missing: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub importance: Option<f64>,
    /// The hand: who feels it and what it holds.
    #[serde(flatten)]
    pub hand: LogHand,
}

/// Who feels it, what is held and what touches.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct LogHand {
    /// Haptic channel; missing: heard only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub actuator: Option<u16>,
    /// Name of the probe; missing: the scene's default one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probe: Option<String>,
    /// Name of the body that holds the probe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub holder: Option<String>,
    /// Linear gain of what is felt and heard; missing: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
}

/// A striker's material: a preset's name or its constants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Striker {
    /// One of [`Material::PRESETS`].
    Preset(String),
    /// Its constants; elastic ones are needed.
    Constants(Material),
}

fn is_first(position: &usize) -> bool {
    *position == 0
}

fn loss_free() -> f64 {
    1.0
}

/// Latest stamp a log may hold, s: a day.
pub const MAX_TIME_S: f64 = 86_400.0;

/// A whole log.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactLog {
    /// Its lines, in time order.
    pub lines: Vec<LogLine>,
}

impl ContactLog {
    /// Reads a `.jsonl` file.
    ///
    /// # Errors
    /// When it cannot be read, a line is not an event or has a key that its event does not know, or
    /// time runs backwards.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, LogError> {
        Self::load_from(&Disk, path)
    }

    /// [`load`](Self::load), from wherever the files lie.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, path: impl AsRef<Path>) -> Result<Self, LogError> {
        let path = path.as_ref();
        let text = storage::text(files, path)
            .map_err(|source| LogError::Unreadable { path: path.into(), source })?;
        Self::parse(&text, &path.display().to_string())
    }

    /// Reads the text of a log; `name` is what errors call it. Blank lines are skipped.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, name: &str) -> Result<Self, LogError> {
        Self::parse_telling(text, name).map(|(log, _)| log)
    }

    /// [`parse`](Self::parse), and what of the format this version reads past: `NAME:LINE: KEY`,
    /// each key where it is met first.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse_telling(text: &str, name: &str) -> Result<(Self, Vec<String>), LogError> {
        let (mut lines, mut unread) = (Vec::new(), Unread::default());
        let mut before = 0.0;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        for (index, text) in text.lines().enumerate().filter(|(_, text)| !text.trim().is_empty()) {
            let place = || format!("{name}:{}", index + 1);
            let Some(line) = keys::line(text, &place, &mut unread)? else { continue };
            let line = LogLine::of(line)
                .map_err(|error| LogError::Malformed { place: place(), message: error.to_string() })?;
            if line.t.is_nan() || line.t < before {
                return Err(LogError::TimeBackwards { place: place(), t: line.t, before });
            }
            if line.t > MAX_TIME_S {
                let what = format!("{:?} s is more than a day", line.t);
                return Err(LogError::Key {
                    place: place(),
                    key: "t".into(),
                    what,
                    right: "must be in seconds".into(),
                });
            }
            before = line.t;
            lines.push(line);
        }
        Ok((Self { lines }, unread.places))
    }

    /// Writes the log, one line an event.
    ///
    /// # Errors
    /// When `out` does.
    pub fn write(&self, mut out: impl Write) -> io::Result<()> {
        self.lines.iter().enumerate().try_for_each(|(index, line)| line.write(index == 0, &mut out))
    }

    /// The log as [`write`](Self::write) writes it.
    #[must_use]
    pub fn to_jsonl(&self) -> String {
        let mut text = Vec::new();
        // Memory refuses nothing.
        let _ = self.write(&mut text);
        String::from_utf8(text).unwrap_or_default()
    }

    /// Tests whether every event that is felt is felt on one of so many channels: on another it
    /// would be felt nowhere.
    ///
    /// # Errors
    /// [`LogError::Event`], the first.
    pub fn check_actuators(&self, channels: usize) -> Result<(), LogError> {
        let hand = |event: &LogEvent| match event {
            LogEvent::Begin { touching, .. } => touching.hand.actuator,
            LogEvent::Impact { hand, .. } => hand.actuator,
            LogEvent::Move { .. } | LogEvent::End { .. } | LogEvent::Motion { .. } | LogEvent::Edit(_) => {
                None
            }
        };
        let missing = |(index, line): (usize, &LogLine)| {
            let actuator = hand(&line.event).filter(|actuator| usize::from(*actuator) >= channels)?;
            Some(line.in_log(index, LogError::NoActuator { actuator, channels }))
        };
        self.lines.iter().enumerate().find_map(missing).map_or(Ok(()), Err)
    }

    /// Tests whether every place of a contact that has no `uv` lies on a surface with a frame;
    /// `has_frame` answers for a surface's name.
    ///
    /// # Errors
    /// [`LogError::Event`], the first.
    pub fn check_places(&self, has_frame: impl Fn(&str) -> bool) -> Result<(), LogError> {
        let mut touched = HashMap::new();
        for (index, line) in self.lines.iter().enumerate() {
            let (contact, sample) = match &line.event {
                LogEvent::Begin { contact, touching, sample } => {
                    touched.insert(*contact, &*touching.surface);
                    (contact, sample)
                }
                LogEvent::Move { contact, sample, .. } => (contact, sample),
                _ => continue,
            };
            let surface = touched.get(contact).filter(|surface| !has_frame(surface));
            if let (Some(surface), true, Some(_)) = (surface, sample.uv[0].is_nan(), sample.at_m) {
                let surface = (*surface).to_owned();
                return Err(line.in_log(index, LogError::NoFrame { surface }));
            }
        }
        Ok(())
    }

    /// Time of the last event on the audio's time line, s: that of the log but for its time scales.
    #[must_use]
    pub fn heard_s(&self) -> f64 {
        let (mut heard_s, mut before_s, mut scale) = (0.0, 0.0, 1.0);
        for LogLine { t, event } in &self.lines {
            heard_s += (t - before_s) / scale;
            before_s = *t;
            if let LogEvent::Edit(LogEdit::TimeScale { scale: to, .. } | LogEdit::Pitch { pitch: to }) = event
            {
                scale = to.clamp(0.01, 100.0);
            }
        }
        heard_s
    }

    /// Time of the last event, s; 0 for an empty log.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.lines.last().map_or(0.0, |line| line.t)
    }
}

impl LogHand {
    /// The engine's own probe, felt by a haptic channel.
    #[must_use]
    pub fn felt_by(actuator: u16) -> Self {
        Self { actuator: Some(actuator), ..Self::default() }
    }
}

impl LogLine {
    /// Lines of a contact on a surface: it begins with the first of its samples, each at its time,
    /// and ends at `end_s`.
    #[must_use]
    pub fn contact(
        contact: u64,
        (surface, hand): (&str, LogHand),
        samples: impl IntoIterator<Item = (f64, ContactSample)>,
        end_s: f64,
    ) -> Vec<Self> {
        let mut begins = Some(LogTouching { surface: surface.to_owned(), importance: None, hand });
        let line = |(t, sample): (f64, ContactSample)| {
            let event = match begins.take() {
                Some(touching) => LogEvent::Begin { contact, touching, sample },
                None => LogEvent::moved(contact, sample),
            };
            Self { t, event }
        };
        let end = Self { t: end_s, event: LogEvent::End { contact } };
        samples.into_iter().map(line).chain([end]).collect()
    }

    /// A line whose keys are checked.
    fn of(line: keys::Line) -> serde_json::Result<Self> {
        let keys = serde_json::Value::Object(line.keys);
        let event = if line.is_edit {
            LogEvent::Edit(serde_json::from_value(keys)?)
        } else {
            serde_json::from_value(keys)?
        };
        Ok(Self { t: line.t, event })
    }

    /// A problem with the line, which is the one of that index.
    pub(crate) fn in_log(&self, index: usize, problem: LogError) -> LogError {
        LogError::Event { number: index + 1, t: self.t, problem: Box::new(problem) }
    }

    /// Writes the line; the first of a log says the version.
    pub(crate) fn write(&self, is_first: bool, mut out: impl Write) -> io::Result<()> {
        #[derive(Serialize)]
        struct First<'a> {
            version: u64,
            #[serde(flatten)]
            line: &'a LogLine,
        }
        if is_first {
            serde_json::to_writer(&mut out, &First { version: VERSION, line: self })?;
        } else {
            serde_json::to_writer(&mut out, self)?;
        }
        out.write_all(b"\n")
    }
}

impl LogEvent {
    /// The engine's own probe lands on a surface, felt by a haptic channel.
    #[must_use]
    pub fn begin(contact: u64, surface: impl Into<String>, actuator: u16, sample: ContactSample) -> Self {
        let touching =
            LogTouching { surface: surface.into(), importance: None, hand: LogHand::felt_by(actuator) };
        Self::Begin { contact, touching, sample }
    }

    /// A strike on a body at its first position that loses nothing and that nobody feels.
    #[must_use]
    pub fn strike(
        body: impl Into<String>,
        speed_m_s: f64,
        striker: Striker,
        (mass_kg, radius_m): (f64, f64),
    ) -> Self {
        Self::Impact {
            body: body.into(),
            other: None,
            speed_m_s,
            mass_kg,
            radius_m,
            striker,
            restitution: 1.0,
            position: 0,
            at_m: None,
            direction: None,
            hand: LogHand::default(),
        }
    }

    /// A contact goes on.
    #[must_use]
    pub fn moved(contact: u64, sample: ContactSample) -> Self {
        Self::Move { contact, sample, emphasis: Emphasis::default() }
    }
}

#[cfg(test)]
mod tests;
