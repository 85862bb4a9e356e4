//! Contact logs: what a game reported, one JSON object a line, in time order.
//!
//! A log names surfaces and bodies as the scene file does; [`Names`] turns them into the ids of a
//! running [`Scene`](crate::Scene). Replaying a log offline gives the same samples as the live engine
//! that recorded it.

mod keys;

use crate::model::event::{Actuator, BodyId, ContactEvent, ContactId, ContactSample, Impact, SurfaceId};
use crate::model::material::Material;
use keys::Unread;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// One line of a log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LogLine {
    /// Game time, s.
    pub t: f64,
    /// What happened.
    #[serde(flatten)]
    pub event: LogEvent,
}

/// What happened, with names instead of ids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "lowercase")]
pub enum LogEvent {
    /// A contact lands.
    Begin {
        /// The contact's name.
        contact: u64,
        /// Name of the surface.
        surface: String,
        /// Haptic channel.
        #[serde(default)]
        actuator: u16,
        /// Where and how.
        #[serde(flatten)]
        sample: LogSample,
    },
    /// A contact goes on.
    Move {
        /// The contact's name.
        contact: u64,
        /// Where and how.
        #[serde(flatten)]
        sample: LogSample,
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
        /// What the striker is made of.
        striker: Striker,
        /// Rebound over approach speed; missing: 1, the loss-free Hertz impact.
        #[serde(default = "loss_free")]
        restitution: f64,
        /// Which of the body's strike positions is hit; missing: 0.
        #[serde(default, skip_serializing_if = "is_first")]
        position: usize,
    },
}

/// A striker's material: a preset's name or its elastic constants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Striker {
    /// One of [`Material::PRESETS`].
    Preset(String),
    /// Elastic constants.
    Constants(Material),
}

/// Where and how a contact touches.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LogSample {
    /// Texture coordinates.
    pub uv: [f64; 2],
    /// Tangential velocity, m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_m_s: Option<[f64; 2]>,
    /// Normal force, N.
    pub normal_force_n: f64,
    /// Approach speed at landing, m/s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub closing_m_s: f64,
}

fn is_first(position: &usize) -> bool {
    *position == 0
}

fn loss_free() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl From<LogSample> for ContactSample {
    fn from(s: LogSample) -> Self {
        Self {
            uv: s.uv,
            velocity_m_s: s.velocity_m_s,
            normal_force_n: s.normal_force_n,
            closing_m_s: s.closing_m_s,
        }
    }
}

impl From<ContactSample> for LogSample {
    fn from(s: ContactSample) -> Self {
        Self {
            uv: s.uv,
            velocity_m_s: s.velocity_m_s,
            normal_force_n: s.normal_force_n,
            closing_m_s: s.closing_m_s,
        }
    }
}

/// Which id of a running scene a name stands for.
#[derive(Debug, Clone, Default)]
pub struct Names {
    /// Surfaces by name.
    pub surfaces: HashMap<String, SurfaceId>,
    /// Bodies by name.
    pub bodies: HashMap<String, BodyId>,
}

/// Why a log, or a line of it, was refused.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); give a readable contact log", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A line is not an event.
    #[error(
        "{place}: {message}; must be one JSON object a line with \"t\", \"event\" and the fields of that event"
    )]
    Malformed {
        /// File and line.
        place: String,
        /// What is wrong.
        message: String,
    },
    /// A line has a key that its event does not know.
    #[error("{place}: {key}: unknown key of \"{event}\"; {right}")]
    UnknownKey {
        /// File and line.
        place: String,
        /// The key.
        key: String,
        /// The event that does not know it.
        event: &'static str,
        /// The key that was meant, or every key that would be right.
        right: String,
    },
    /// Time runs backwards.
    #[error("{place}: t = {t} s comes after {before} s; events must be in time order, from 0 s on")]
    TimeBackwards {
        /// File and line.
        place: String,
        /// The offending stamp, s.
        t: f64,
        /// The stamp before it, s.
        before: f64,
    },
    /// A name the scene does not know.
    #[error("{kind} \"{name}\" is unknown; must be one of: {known}")]
    UnknownName {
        /// "surface", "body" or "striker".
        kind: &'static str,
        /// The name.
        name: String,
        /// Every name that would be right.
        known: String,
    },
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
    /// When it cannot be read, a line is not an event or has a key that its event does not know, or time
    /// runs backwards.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, LogError> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path)
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

    /// [`parse`](Self::parse), and what of the format this version reads past: `NAME:LINE: KEY`, each key
    /// where it is met first.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse_telling(text: &str, name: &str) -> Result<(Self, Vec<String>), LogError> {
        let (mut lines, mut unread) = (Vec::new(), Unread::default());
        let mut before = 0.0;
        for (index, text) in text.lines().enumerate().filter(|(_, text)| !text.trim().is_empty()) {
            let place = || format!("{name}:{}", index + 1);
            keys::check(text, place, &mut unread)?;
            let line: LogLine = serde_json::from_str(text)
                .map_err(|error| LogError::Malformed { place: place(), message: error.to_string() })?;
            if line.t.is_nan() || line.t < before {
                return Err(LogError::TimeBackwards { place: place(), t: line.t, before });
            }
            if line.t > MAX_TIME_S {
                let message = format!("t = {:?} s is more than a day", line.t);
                return Err(LogError::Malformed { place: place(), message });
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
        for line in &self.lines {
            serde_json::to_writer(&mut out, line)?;
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    /// Time of the last event, s; 0 for an empty log.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.lines.last().map_or(0.0, |line| line.t)
    }
}

impl LogEvent {
    /// The event for a scene whose ids `names` gives.
    ///
    /// # Errors
    /// When the event names a surface, body or striker that is not there.
    pub fn resolve(&self, names: &Names) -> Result<ContactEvent, LogError> {
        Ok(match self {
            Self::Begin { contact, surface, actuator, sample } => ContactEvent::Begin {
                contact: ContactId(*contact),
                surface: find("surface", surface, &names.surfaces)?,
                actuator: Actuator(*actuator),
                sample: (*sample).into(),
            },
            Self::Move { contact, sample } => ContactEvent::moved(ContactId(*contact), (*sample).into()),
            Self::End { contact } => ContactEvent::end(ContactId(*contact)),
            Self::Impact { body, other, speed_m_s, mass_kg, radius_m, striker, restitution, position } => {
                ContactEvent::Impact(Impact {
                    body: find("body", body, &names.bodies)?,
                    other: other.as_ref().map(|name| find("body", name, &names.bodies)).transpose()?,
                    speed_m_s: *speed_m_s,
                    mass_kg: *mass_kg,
                    radius_m: *radius_m,
                    striker: striker.material()?,
                    restitution: *restitution,
                    position: *position,
                })
            }
        })
    }
}

impl Striker {
    fn material(&self) -> Result<Material, LogError> {
        match self {
            Self::Constants(material) => Ok(*material),
            Self::Preset(name) => Material::by_name(name).ok_or_else(|| LogError::UnknownName {
                kind: "striker",
                name: name.clone(),
                known: Material::names(),
            }),
        }
    }
}

fn find<Id: Copy>(kind: &'static str, name: &str, ids: &HashMap<String, Id>) -> Result<Id, LogError> {
    ids.get(name).copied().ok_or_else(|| {
        let mut known: Vec<_> = ids.keys().map(String::as_str).collect();
        known.sort_unstable();
        LogError::UnknownName { kind, name: name.into(), known: known.join(", ") }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = r#"{"t":0.0,"event":"begin","contact":1,"surface":"tiles","actuator":0,"uv":[0.1,0.5],"velocity_m_s":[0.08,0.0],"normal_force_n":0.6,"closing_m_s":0.05}
{"t":0.0167,"event":"move","contact":1,"uv":[0.11,0.5],"normal_force_n":0.62}
{"t":0.2,"event":"impact","body":"tile","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"steel"}
{"t":0.9,"event":"end","contact":1}
"#;

    fn names() -> Names {
        Names {
            surfaces: HashMap::from([("tiles".to_owned(), SurfaceId(3))]),
            bodies: HashMap::from([("tile".to_owned(), BodyId(4))]),
        }
    }

    #[test]
    fn the_documented_lines_are_read_and_written_back() {
        let log = ContactLog::parse(LOG, "log").unwrap();
        assert_eq!(log.lines.len(), 4);
        assert_eq!(log.end_s(), 0.9);
        let mut text = Vec::new();
        log.write(&mut text).unwrap();
        assert_eq!(ContactLog::parse(std::str::from_utf8(&text).unwrap(), "copy").unwrap(), log);
    }

    #[test]
    fn names_become_the_ids_of_the_scene() {
        let log = ContactLog::parse(LOG, "log").unwrap();
        let events: Vec<_> = log.lines.iter().map(|l| l.event.resolve(&names()).unwrap()).collect();
        assert!(matches!(events[0], ContactEvent::Begin { surface: SurfaceId(3), .. }));
        assert!(matches!(
            events[2],
            ContactEvent::Impact(Impact { body: BodyId(4), striker: Material::STEEL, .. })
        ));
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_names_there_are() {
        let line: LogLine =
            serde_json::from_str(&LOG.lines().next().unwrap().replace("tiles", "tils")).unwrap();
        let message = line.event.resolve(&names()).unwrap_err().to_string();
        assert_eq!(message, "surface \"tils\" is unknown; must be one of: tiles");
    }

    #[test]
    fn time_running_backwards_is_refused_with_its_line() {
        let backwards = LOG.replace("\"t\":0.2", "\"t\":0.001");
        let message = ContactLog::parse(&backwards, "log").unwrap_err().to_string();
        assert!(message.starts_with("log:3: t = 0.001 s comes after 0.0167 s"), "{message}");
        assert!(ContactLog::parse(r#"{"t":-1.0,"event":"end","contact":1}"#, "log").is_err());
    }

    #[test]
    fn a_key_that_no_event_knows_is_refused_with_its_line_and_the_key_that_was_meant() {
        let told = |text: &str| ContactLog::parse(text, "log").unwrap_err().to_string();
        let line =
            r#"{"t":0.0,"event":"move","contact":1,"uv":[0.1,0.5],"velocity":[0.1,0.0],"normal_force_n":1}"#;
        assert_eq!(told(line), "log:1: velocity: unknown key of \"move\"; write velocity_m_s");
        let message = told(&format!("{LOG}{}", line.replace("velocity", "colour")));
        assert!(
            message.starts_with("log:5: colour: unknown key of \"move\"; accepted here: actuator, "),
            "{message}"
        );
        assert!(message.contains("velocity_m_s") && !message.contains("probe"), "{message}");
        // A forgotten unit is told before the key that is missing for it.
        assert!(
            told(&line.replace("velocity", "gain").replace("force_n", "force"))
                .ends_with("write normal_force_n")
        );
        assert!(
            told(r#"{"t":0.0,"event":"end","contact":1,"uv":[0,0]}"#).contains("accepted here: contact, ")
        );
    }

    #[test]
    fn every_key_of_the_format_is_accepted_and_those_read_past_are_told() {
        let begin = r#"{"t":0,"event":"begin","version":1,"contact":1,"surface":"tiles","actuator":0,"uv":[0,0],"velocity_m_s":[0,0],
            "normal_force_n":1,"closing_m_s":0.1,"probe":"stylus","holder":"pen","at_m":[0,0,0],"depth_m":0.001,"gain":1,
            "importance":1,"direction":[0,0,1]}"#;
        let strike = r#"{"t":0.1,"event":"impact","body":"tile","other":"tile","speed_m_s":1,"mass_kg":0.01,"radius_m":0.01,
            "striker":"steel","restitution":0.5,"position":0,"at_m":[0,0,0],"direction":[0,0,1],"holder":"pen","actuator":0,"gain":2}"#;
        let text = format!("{}\n{}\n", begin.replace('\n', ""), strike.replace('\n', ""));
        let (log, unread) = ContactLog::parse_telling(&text, "log").unwrap();
        assert_eq!(log.lines.len(), 2);
        assert!(unread.contains(&"log:1: probe".to_owned()), "{unread:?}");
        assert!(ContactLog::parse_telling(LOG, "log").unwrap().1.is_empty());
    }

    #[test]
    fn broken_lines_are_refused_with_their_place() {
        for broken in ["{", "[]", r#"{"t":0.0,"event":"jump"}"#, r#"{"t":1e300,"event":"end","contact":1}"#] {
            let message = ContactLog::parse(broken, "log").unwrap_err().to_string();
            assert!(message.starts_with("log:1: "), "{message}");
        }
    }
}
