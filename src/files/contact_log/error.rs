//! Refusals of a log: which line, what is wrong there, what would be right.

use super::VERSION;
use crate::files::{FileError, nearest};
use std::io;
use std::path::PathBuf;

/// Why a log, or a line of it, was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// The file cannot be read.
    #[error("{}: cannot be read ({source}); give a readable contact log", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        source: io::Error,
    },
    /// A line is not an event.
    #[error(
        "{place}: {message}; must be one JSON object a line with \"t\", \"event\" and the fields of that event"
    )]
    Malformed {
        /// File and line.
        place: String,
        /// Fault.
        message: String,
    },
    /// A key is missing, or holds what it cannot.
    #[error("{place}: {key}: {what}; {right}")]
    Key {
        /// File and line.
        place: String,
        /// The key.
        key: String,
        /// Fault of it.
        what: String,
        /// Remedy.
        right: String,
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
    /// A format that this program does not know.
    #[error("{place}: version: {version} is unknown; must be {VERSION}, or missing")]
    Version {
        /// File and line.
        place: String,
        /// Written value.
        version: String,
    },
    /// An edit where only events can be used.
    #[error("an edit of the scene; must be an event, or replayed by offline::render")]
    Edit,
    /// A render that its tap has stopped.
    #[error("stopped before its end; render again")]
    Stopped,
    /// A contact that would be felt on a channel which is not there.
    #[error(
        "actuator: {actuator} is not in the scene; must be below {channels}, the number of [[actuator]] tables"
    )]
    NoActuator {
        /// The channel.
        actuator: u16,
        /// Number that there is.
        channels: usize,
    },
    /// A place of the body, on a surface that does not lie in it.
    #[error(
        "at_m: surface \"{surface}\" has no frame that gives its uv; write [surface.frame] in the scene, or \"uv\" in the log"
    )]
    NoFrame {
        /// Name of the surface.
        surface: String,
    },
    /// An edit that cannot be made.
    #[error("t = {t} s: {problem}")]
    CannotEdit {
        /// Its time, s.
        t: f64,
        /// Fault.
        problem: FileError,
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
    /// An event of a log that a scene cannot take.
    #[error("event {number} at t = {t} s: {problem}")]
    Event {
        /// Its number among the log's events, from 1.
        number: usize,
        /// Its time, s.
        t: f64,
        /// Fault of it.
        problem: Box<Self>,
    },
    /// A name the scene does not know.
    #[error("{kind}: \"{name}\" is unknown; {}", one_of(kind, name, known))]
    UnknownName {
        /// "surface", "body", "probe", "holder" or "striker".
        kind: &'static str,
        /// The name.
        name: String,
        /// Every name that would be right.
        known: String,
    },
}

impl LogError {
    /// The error with the line of the log's text that it speaks of; `name` is what errors call the
    /// log.
    #[must_use]
    pub fn in_text(self, text: &str, name: &str) -> FileError {
        let Self::Event { number, problem, .. } = self else {
            return FileError::from_error(self).within(name);
        };
        let is_event = |line: &&str| line.contains("\"event\"");
        let lines = text.lines().enumerate().filter(|(_, line)| is_event(line));
        let line = lines.map(|(index, _)| index + 1).nth(number - 1).unwrap_or(number);
        FileError::from_error(problem).within(format!("{name}:{line}"))
    }
}

/// Names that would be right, the one that was meant first.
fn one_of(kind: &str, name: &str, known: &str) -> String {
    if known.is_empty() {
        return format!("the scene names no {kind}; leave it out, or give the scene one with that name");
    }
    let names: Vec<&str> = known.split(", ").collect();
    let meant = nearest(name, &names).filter(|_| names.len() > 1);
    meant.map_or_else(String::new, |meant| format!("write \"{meant}\"; "))
        + &format!("must be one of: {known}")
}
