//! Keys of a line of the contact log: a misspelt one would otherwise be no key at all.

use super::{LogError, VERSION};
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

const BODY: &[&str] = &["body", "modes", "material", "bus", "gain", "strike_gain", "mass_kg"];
const SURFACE: &[&str] = &["surface", "is", "folder", "material"];

const fn edit(event: &'static str, read: &'static [&'static str]) -> Keys {
    Keys { event, read, read_past: &[] }
}

const EVENTS: &[Keys] = &[
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
            "at_m",
            "depth_m",
            "slip_m_s",
            "roll_radius_m",
        ],
        read_past: &["direction"],
    },
    Keys {
        event: "move",
        read: &[
            "contact",
            "gain",
            "importance",
            "uv",
            "velocity_m_s",
            "normal_force_n",
            "closing_m_s",
            "at_m",
            "depth_m",
            "slip_m_s",
            "roll_radius_m",
        ],
        read_past: &["actuator", "direction"],
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
            "at_m",
            "direction",
        ],
        read_past: &[],
    },
    edit("add_body", BODY),
    edit("replace_body", BODY),
    edit("remove_body", &["body"]),
    edit("body_bus", &["body", "bus"]),
    edit("body_gain", &["body", "gain"]),
    edit("mute", &["muted"]),
    edit("pause", &["paused"]),
    edit("fade_all", &[]),
    edit("add_probe", &["probe", "is"]),
    edit("add_surface", SURFACE),
    edit("replace_surface", SURFACE),
    edit("remove_surface", &["surface"]),
    edit("change_surface", &["surface"]),
    edit("haptic_gain", &["actuator", "gain"]),
    edit("audio_gain", &["bus", "gain"]),
];

/// Keys that were read past, each where it was met first.
#[derive(Default)]
pub(super) struct Unread {
    keys: Vec<String>,
    pub(super) places: Vec<String>,
}

#[derive(Deserialize)]
struct Kind {
    #[serde(default)]
    event: Option<String>,
    #[serde(default)]
    version: Option<serde_json::Value>,
}

/// Refuses a version that is not ours and a key that the line's event does not know; tells whether the line is an event, not a
/// version alone. What is no event at all is told when it is read.
pub(super) fn check(text: &str, place: impl Fn() -> String, unread: &mut Unread) -> Result<bool, LogError> {
    let Ok(Kind { event, version }) = serde_json::from_str(text) else { return Ok(true) };
    let says_version = version.is_some();
    if let Some(version) = version.filter(|version| version.as_u64() != Some(VERSION)) {
        return Err(LogError::Version { place: place(), version: version.to_string() });
    }
    let Some(event) = event else { return Ok(!says_version) };
    let Some(known) = EVENTS.iter().find(|known| known.event == event) else { return Ok(true) };
    let Ok(line) = serde_json::from_str::<BTreeMap<String, IgnoredAny>>(text) else { return Ok(true) };
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
    Ok(true)
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
