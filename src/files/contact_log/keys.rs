//! Keys of a line of the contact log: which each event needs and takes, and what they hold.
//! docs/formats/log.md has a table for each.

use super::object::Object;
use super::{LogError, VERSION};
use crate::files::nearest::{decimal_comma, nearest};
use crate::model::material::Material;
use serde_json::{Map, Value};

/// Keys of any line.
const OF_ANY: [&str; 3] = ["t", "event", "version"];

/// Type of a key's value.
#[derive(Clone, Copy)]
enum Holds {
    Number,
    /// A whole number up to this one.
    Whole(u64),
    Text,
    Pair,
    Triple,
    Striker,
    /// Any value: edits are read by their own type.
    Any,
}

/// Key and type of its value.
type Key = (&'static str, Holds);

/// A key that must be there, the keys that may be there instead, and what to write.
type Needed = (Key, &'static [&'static str], &'static str);

/// An event's name, the keys it needs, those it takes, and those of the format that this version
/// reads past.
struct Event {
    name: &'static str,
    needs: &'static [Needed],
    takes: &'static [Key],
    read_past: &'static [&'static str],
}

const CONTACT: Needed = (("contact", Holds::Whole(u64::MAX)), &[], "\"contact\":1, the number of the touch");
const UV: Needed = (("uv", Holds::Pair), &["at_m"], "\"uv\":[0.5,0.5]; or at_m, on a surface with a frame");
const FORCE: Needed = (
    ("normal_force_n", Holds::Number),
    &["depth_m", "at_m"],
    "\"normal_force_n\":0.5; or depth_m, on what gives way",
);

const fn edit(name: &'static str, takes: &'static [Key]) -> Event {
    Event { name, needs: &[], takes, read_past: &[] }
}

const BODY: &[Key] = &[
    ("body", Holds::Any),
    ("modes", Holds::Any),
    ("material", Holds::Any),
    ("bus", Holds::Any),
    ("gain", Holds::Any),
    ("strike_gain", Holds::Any),
    ("least_time_s", Holds::Any),
    ("variation", Holds::Any),
    ("mass_kg", Holds::Any),
];
const SURFACE: &[Key] =
    &[("surface", Holds::Any), ("is", Holds::Any), ("folder", Holds::Any), ("material", Holds::Any)];

const EVENTS: &[Event] = &[
    Event {
        name: "begin",
        needs: &[
            CONTACT,
            (("surface", Holds::Text), &[], "\"surface\":\"NAME\", a surface of the scene"),
            UV,
            FORCE,
        ],
        takes: &[
            ("actuator", Holds::Whole(u16::MAX as u64)),
            ("probe", Holds::Text),
            ("holder", Holds::Text),
            ("gain", Holds::Number),
            ("importance", Holds::Number),
            ("velocity_m_s", Holds::Pair),
            ("closing_m_s", Holds::Number),
            ("at_m", Holds::Triple),
            ("depth_m", Holds::Number),
            ("slip_m_s", Holds::Number),
            ("roll_radius_m", Holds::Number),
        ],
        read_past: &["direction"],
    },
    Event {
        name: "move",
        needs: &[CONTACT, UV, FORCE],
        takes: &[
            ("gain", Holds::Number),
            ("importance", Holds::Number),
            ("velocity_m_s", Holds::Pair),
            ("closing_m_s", Holds::Number),
            ("at_m", Holds::Triple),
            ("depth_m", Holds::Number),
            ("slip_m_s", Holds::Number),
            ("roll_radius_m", Holds::Number),
        ],
        read_past: &["actuator", "direction"],
    },
    Event { name: "end", needs: &[CONTACT], takes: &[], read_past: &[] },
    Event {
        name: "impact",
        needs: &[
            (("body", Holds::Text), &[], "\"body\":\"NAME\", a body of the scene"),
            (("speed_m_s", Holds::Number), &[], "\"speed_m_s\":1.0, the speed of approach"),
            (("mass_kg", Holds::Number), &[], "\"mass_kg\":0.05, the striker's mass"),
            (("radius_m", Holds::Number), &[], "\"radius_m\":0.01, the striker's radius where it hits"),
            (("striker", Holds::Striker), &[], "\"striker\":\"steel\", what the striker is made of"),
        ],
        takes: &[
            ("other", Holds::Text),
            ("restitution", Holds::Number),
            ("position", Holds::Whole(u64::MAX)),
            ("actuator", Holds::Whole(u16::MAX as u64)),
            ("probe", Holds::Text),
            ("holder", Holds::Text),
            ("gain", Holds::Number),
            ("at_m", Holds::Triple),
            ("direction", Holds::Triple),
        ],
        read_past: &[],
    },
    Event {
        name: "motion",
        needs: &[(("body", Holds::Text), &[], "\"body\":\"NAME\", a body of the scene")],
        takes: &[
            ("acceleration_m_s2", Holds::Triple),
            ("gravity_m_s2", Holds::Triple),
            ("angular_velocity_rad_s", Holds::Triple),
            ("centre_m", Holds::Triple),
        ],
        // Everything is in the body's own axes.
        read_past: &["rotation"],
    },
    edit("add_body", BODY),
    edit("replace_body", BODY),
    edit("remove_body", &[("body", Holds::Any)]),
    edit("body_bus", &[("body", Holds::Any), ("bus", Holds::Any)]),
    edit("body_send", &[("body", Holds::Any), ("bus", Holds::Any), ("gain", Holds::Any)]),
    edit("body_gain", &[("body", Holds::Any), ("gain", Holds::Any)]),
    edit("mute", &[("muted", Holds::Any)]),
    edit("pause", &[("paused", Holds::Any)]),
    edit("time_scale", &[("scale", Holds::Number), ("bend_pitch", Holds::Any)]),
    edit("pitch", &[("pitch", Holds::Number)]),
    edit("fade_all", &[]),
    edit("add_probe", &[("probe", Holds::Any), ("is", Holds::Any)]),
    edit("add_surface", SURFACE),
    edit("replace_surface", SURFACE),
    edit("remove_surface", &[("surface", Holds::Any)]),
    edit("change_surface", &[("surface", Holds::Any)]),
    edit("haptic_gain", &[("actuator", Holds::Any), ("gain", Holds::Any)]),
    edit("audio_gain", &[("bus", Holds::Any), ("gain", Holds::Any)]),
];

/// Keys that were read past, each where it was met first.
#[derive(Default)]
pub(super) struct Unread {
    keys: Vec<String>,
    pub(super) places: Vec<String>,
}

/// A checked line: its time, whether it edits the scene, and its keys but for time and version.
pub(super) struct Line {
    pub(super) t: f64,
    pub(super) is_edit: bool,
    pub(super) keys: Map<String, Value>,
}

/// Reads a line and checks every key of it; `None` for a line that only says the version.
pub(super) fn line(
    text: &str,
    place: &dyn Fn() -> String,
    unread: &mut Unread,
) -> Result<Option<Line>, LogError> {
    let Object(mut keys) = serde_json::from_str(text).map_err(|error| malformed(text, place(), &error))?;
    let refuse = |key: &str, what: String, right: String| LogError::Key {
        place: place(),
        key: key.into(),
        what,
        right,
    };
    let version = keys.remove("version");
    if let Some(version) = version.as_ref().filter(|version| version.as_u64() != Some(VERSION)) {
        return Err(LogError::Version { place: place(), version: version.to_string() });
    }
    if version.is_some() && keys.is_empty() {
        return Ok(None);
    }
    let event = event_of(&keys).map_err(|(key, what, right)| refuse(&key, what, right))?;
    for key in keys.keys().filter(|key| !OF_ANY.contains(&key.as_str()) && !event.reads(key)) {
        if !event.read_past.contains(&key.as_str()) {
            let (key, right) = (key.clone(), event.right(key));
            return Err(LogError::UnknownKey { place: place(), key, event: event.name, right });
        }
        if !unread.keys.contains(key) {
            unread.places.push(format!("{}: {key}", place()));
            unread.keys.push(key.clone());
        }
    }
    keys.retain(|key, value| !value.is_null() && !event.read_past.contains(&key.as_str()));
    let t = keys
        .remove("t")
        .ok_or_else(|| refuse("t", "is missing".into(), "write \"t\":0.5, its time in seconds".into()))?;
    let t =
        t.as_f64().ok_or_else(|| refuse("t", shown(&t), "must be a number, the time in seconds".into()))?;
    for ((name, _), or, example) in event.needs {
        if !keys.contains_key(*name) && !or.iter().any(|or| keys.contains_key(*or)) {
            return Err(refuse(
                name,
                format!("is missing in \"{}\"", event.name),
                format!("write {example}"),
            ));
        }
    }
    for (name, holds) in event.keys() {
        if let Some(value) = keys.get(name)
            && let Err(right) = holds.check(value)
        {
            return Err(refuse(name, shown(value), right));
        }
    }
    let is_edit = event.needs.is_empty();
    Ok(Some(Line { t, is_edit, keys }))
}

/// The event of a line, or what is wrong with it: key, what is wrong, what would be right.
fn event_of(keys: &Map<String, Value>) -> Result<&'static Event, (String, String, String)> {
    let usual = "\"begin\", \"move\", \"end\", \"impact\" or \"motion\"";
    let Some(written) = keys.get("event") else {
        let meant = keys.keys().find(|key| nearest(key, &["event"]).is_some());
        return Err(match meant {
            Some(key) => (key.clone(), "unknown key".into(), format!("write event, which is {usual}")),
            None => ("event".into(), "is missing".into(), format!("write \"event\":{usual}")),
        });
    };
    let word = written.as_str().unwrap_or_default();
    let names: Vec<&str> = EVENTS.iter().map(|event| event.name).collect();
    EVENTS.iter().find(|event| event.name == word).ok_or_else(|| {
        let right =
            nearest(word, &names).map_or(format!("must be {usual}"), |meant| format!("write \"{meant}\""));
        ("event".into(), format!("{written} is unknown"), right)
    })
}

impl Event {
    fn keys(&self) -> impl Iterator<Item = Key> {
        self.needs.iter().map(|(key, ..)| *key).chain(self.takes.iter().copied())
    }

    fn reads(&self, key: &str) -> bool {
        self.keys().any(|(name, _)| name == key)
    }

    /// The key that was meant, where one is near; all of them otherwise.
    fn right(&self, key: &str) -> String {
        let mut accepted: Vec<&str> = OF_ANY.to_vec();
        accepted.extend(self.keys().map(|(name, _)| name));
        accepted.extend(self.read_past);
        match nearest(key, &accepted) {
            Some(meant) => format!("write {meant}"),
            None => {
                accepted.sort_unstable();
                format!("accepted here: {}", accepted.join(", "))
            }
        }
    }
}

impl Holds {
    /// Checks a value; what would be right, where it is wrong.
    fn check(self, value: &Value) -> Result<(), String> {
        let numbers = |count: usize| {
            value.as_array().is_some_and(|all| all.len() == count && all.iter().all(Value::is_number))
        };
        let (holds, right) = match self {
            Self::Number => (value.is_number(), "must be a number"),
            Self::Whole(most) => {
                let holds = value.as_u64().is_some_and(|whole| whole <= most);
                (holds, "must be a whole number from 0 on")
            }
            Self::Text => (value.is_string(), "must be a name in quotes"),
            Self::Pair => (numbers(2), "must be two numbers, along u and along v: [0.1, 0.0]"),
            Self::Triple => (numbers(3), "must be three numbers, [x, y, z]"),
            Self::Striker => return striker(value),
            Self::Any => (true, ""),
        };
        if holds { Ok(()) } else { Err(right.to_owned()) }
    }
}

fn striker(value: &Value) -> Result<(), String> {
    match value {
        Value::String(name) if Material::by_name(name).is_some() => Ok(()),
        Value::String(name) => {
            let names = Material::names();
            let known: Vec<&str> = names.split(", ").collect();
            let meant =
                nearest(name, &known).map_or_else(String::new, |meant| format!("write \"{meant}\"; "));
            Err(format!("{meant}must be one of: {names}"))
        }
        Value::Object(_) => serde_json::from_value::<Material>(value.clone())
            .map(|_| ())
            .map_err(|error| format!("must hold the constants of a material ({error})")),
        _ => Err("must be a material's name in quotes, or a table of its constants".to_owned()),
    }
}

/// A value as it was written, cut when it is long.
fn shown(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(60) {
        Some((cut, _)) => format!("{}… is refused", &text[..cut]),
        None => format!("{text} is refused"),
    }
}

fn malformed(line: &str, place: String, error: &serde_json::Error) -> LogError {
    if let Some((key, word)) = no_number(line) {
        let right = "write a finite number, or leave out what is not known".to_owned();
        return LogError::Key { place, key, what: format!("{word} is no JSON"), right };
    }
    if !line.contains('{') && line.matches([',', ';', '\t']).count() > 1 {
        return LogError::Malformed { place, message: "is a row of a table (CSV), not of a log".to_owned() };
    }
    if let Some(right) = decimal_comma(line) {
        let message = format!("has a decimal comma; write {right}");
        return LogError::Malformed { place, message };
    }
    let text = error.to_string();
    let what = text.split(" at line ").next().unwrap_or_default();
    LogError::Malformed { place, message: format!("{what} at column {}", error.column()) }
}

/// The first number that other writers of JSON write and JSON does not have, and its key.
fn no_number(line: &str) -> Option<(String, &'static str)> {
    let at = |word: &'static str| {
        let places = line.match_indices(word).map(|(place, _)| place);
        let is_value = |place: &usize| line[..*place].trim_end().ends_with([':', '[', ',']);
        Some((places.into_iter().find(is_value)?, word))
    };
    let (place, word) = ["NaN", "-Infinity", "Infinity"].into_iter().filter_map(at).min()?;
    let (before, _) = line[..place].rsplit_once(':')?;
    let key = before.trim_end().trim_end_matches('"').rsplit('"').next()?;
    Some((key.to_owned(), word))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMATS: &str = include_str!("../../../docs/formats/log.md");

    /// The keys of a table of the document, and those that are needed.
    fn table(begins: &str) -> (Vec<&'static str>, Vec<&'static str>) {
        let rows = FORMATS.split_once(begins).map_or("", |(_, rest)| rest);
        let rows = rows.lines().skip(4).take_while(|line| line.starts_with('|'));
        let cells: Vec<Vec<&str>> = rows.map(|row| row.split('|').map(str::trim).collect()).collect();
        let name = |row: &Vec<&'static str>| row[1].trim_matches('`');
        let needed = cells.iter().filter(|row| row[2].contains("**needed**")).map(name).collect();
        (cells.iter().map(name).collect(), needed)
    }

    #[test]
    fn the_document_names_every_key_of_an_event() {
        for (name, begins) in
            [("begin", "`begin`: a contact lands."), ("impact", "`impact`: a rigid striker hits a body.")]
        {
            let event = EVENTS.iter().find(|event| event.name == name).unwrap();
            let (mut written, needed) = table(begins);
            let mut known: Vec<&str> = event.keys().map(|(key, _)| key).collect();
            written.sort_unstable();
            known.sort_unstable();
            assert_eq!(written, known, "{name}");
            assert_eq!(needed, event.needs.iter().map(|((key, _), ..)| *key).collect::<Vec<_>>(), "{name}");
        }
    }
}
