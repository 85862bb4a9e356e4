//! Keys of a line of the contact log: a misspelt one would otherwise be no key at all.

use super::LogError;
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeMap;

/// Keys of any line.
const OF_ANY: &[&str] = &["t", "event", "version"];

/// An event's name, the keys that are read, and those of the format that this version reads past.
struct Keys {
    event: &'static str,
    read: &'static [&'static str],
    read_past: &'static [&'static str],
}

const EVENTS: [Keys; 4] = [
    Keys {
        event: "begin",
        read: &[
            "contact",
            "surface",
            "actuator",
            "probe",
            "holder",
            "gain",
            "importance",
            "uv",
            "velocity_m_s",
            "normal_force_n",
            "closing_m_s",
        ],
        read_past: &["at_m", "depth_m", "direction"],
    },
    Keys {
        event: "move",
        read: &["contact", "uv", "velocity_m_s", "normal_force_n", "closing_m_s"],
        read_past: &["actuator", "at_m", "depth_m", "gain", "importance", "direction"],
    },
    Keys { event: "end", read: &["contact"], read_past: &[] },
    Keys {
        event: "impact",
        read: &[
            "body",
            "other",
            "speed_m_s",
            "mass_kg",
            "radius_m",
            "striker",
            "restitution",
            "position",
            "actuator",
            "probe",
            "holder",
            "gain",
        ],
        read_past: &["at_m", "direction"],
    },
];

/// Keys that were read past, each where it was met first.
#[derive(Default)]
pub(super) struct Unread {
    keys: Vec<String>,
    pub(super) places: Vec<String>,
}

#[derive(Deserialize)]
struct Kind {
    event: String,
}

/// Refuses a key that the line's event does not know. What is no event at all is told when it is read.
pub(super) fn check(text: &str, place: impl Fn() -> String, unread: &mut Unread) -> Result<(), LogError> {
    let Ok(Kind { event }) = serde_json::from_str(text) else { return Ok(()) };
    let Some(known) = EVENTS.iter().find(|known| known.event == event) else { return Ok(()) };
    let Ok(line) = serde_json::from_str::<BTreeMap<String, IgnoredAny>>(text) else { return Ok(()) };
    for key in line.into_keys() {
        if OF_ANY.contains(&key.as_str()) || known.read.contains(&key.as_str()) {
            continue;
        }
        if !known.read_past.contains(&key.as_str()) {
            let right = known.right(&key);
            return Err(LogError::UnknownKey { place: place(), key, event: known.event, right });
        }
        if !unread.keys.contains(&key) {
            unread.places.push(format!("{}: {key}", place()));
            unread.keys.push(key);
        }
    }
    Ok(())
}

impl Keys {
    /// The key that was meant, where one begins like it; all of them otherwise.
    fn right(&self, key: &str) -> String {
        let mut accepted: Vec<&str> = [OF_ANY, self.read, self.read_past].concat();
        let alike = |known: &&&str| key.len() > 2 && (known.starts_with(key) || key.starts_with(**known));
        match accepted.iter().find(alike) {
            Some(meant) => format!("write {meant}"),
            None => {
                accepted.sort_unstable();
                format!("accepted here: {}", accepted.join(", "))
            }
        }
    }
}
