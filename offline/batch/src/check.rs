//! Check: every value that a specification may draw is tried before anything is rendered.
//!
//! Each section (a choice, `surface`, `body`, `probe`) is read at both ends of its ranges and with
//! each value of its choices, the other sections at their first; each key of `finger` likewise.
//! Values that can be rendered and are hardly meant are doubts, with the likeliest unit.

use crate::distribution::{ends, ends_of_table};
use crate::path::Shape;
use crate::spec::{Spec, unknown};
use crate::stroke::{finger_numbers, in_range, scene_of, sections};
use crate::surfaces::Choice;
use asperity::files::FileError;
use asperity::files::scene_file::SceneFile;
use std::collections::BTreeMap;
use std::path::Path;
use toml::{Table, Value};

/// Most of a key that is meant, and units that it may have been written in, in its own.
type Usual = (&'static str, f64, &'static [(&'static str, f64)]);
const USUAL: [Usual; 7] = [
    ("force_n", 30.0, &[("grams", 9.81e-3), ("millinewtons", 1e-3)]),
    ("speed_m_s", 3.0, &[("mm/s", 1e-3), ("cm/s", 1e-2)]),
    ("duration_s", 60.0, &[("milliseconds", 1e-3)]),
    ("size_m", 5.0, &[("centimetres", 1e-2), ("millimetres", 1e-3)]),
    ("width_m", 5.0, &[("millimetres", 1e-3), ("centimetres", 1e-2)]),
    ("height_m", 5.0, &[("millimetres", 1e-3), ("centimetres", 1e-2)]),
    ("relief_m", 0.05, &[("millimetres", 1e-3), ("micrometres", 1e-6)]),
];

/// Doubts about a specification whose every draw can be used.
///
/// # Errors
/// At the first value that is refused; the message names the specification and the key.
pub fn check(spec: &Spec, choices: &[Choice], folder: &Path) -> Result<Vec<String>, FileError> {
    let mut doubts = BTreeMap::new();
    let within = |error: FileError| error.at_line_in(&spec.text).within(spec.path.display());
    fingers(spec, &mut doubts).map_err(within)?;
    for choice in choices {
        scenes(spec, choice, folder, &mut doubts).map_err(within)?;
    }
    Ok(doubts.into_iter().filter_map(|(field, range)| doubt(&field, range)).collect())
}

/// Deviations from the mean that the draws of this many strokes stay within.
fn deviations(strokes: u64) -> f64 {
    1.0 + (2.0 * (strokes as f64).ln()).sqrt()
}

fn fingers(spec: &Spec, ranges: &mut BTreeMap<String, [f64; 2]>) -> Result<(), FileError> {
    let wide = deviations(spec.says.strokes);
    for (name, value, range, right) in finger_numbers(&spec.says.finger) {
        let field = format!("finger.{name}");
        for end in ends(value, &field, wide)? {
            let number = in_range(&field, &end, range, right)?;
            let from_nothing = value.as_table().is_some_and(|table| !table.contains_key("choice"));
            if name == "force_n" && number == 0.0 && !from_nothing {
                let right = "must be above 0; a finger presses with 0.1 to 10 N";
                return Err(FileError::new(field, "0 touches nothing", right));
            }
            widen(ranges, &field, number);
        }
        if name == "force_n" && ranges.get(&field).is_some_and(|[_, most]| *most == 0.0) {
            return Err(FileError::new(field, "0 touches nothing", "must be above 0, up to 1e4 N"));
        }
    }
    for path in ends(&spec.says.finger.path, "finger.path", wide)? {
        let name = path.as_str().unwrap_or_default();
        Shape::from_name(name).map_err(|_| unknown("finger.path", name, "line, arc, back-and-forth"))?;
    }
    Ok(())
}

fn scenes(
    spec: &Spec,
    choice: &Choice,
    folder: &Path,
    ranges: &mut BTreeMap<String, [f64; 2]>,
) -> Result<(), FileError> {
    let wide = deviations(spec.says.strokes);
    let path = folder.join("check.toml");
    let sections = sections(spec, choice);
    let all = sections.map(|(table, field)| ends_of_table(table, field, wide));
    let all = all.into_iter().collect::<Result<Vec<Vec<Table>>, _>>()?;
    for (section, tables) in all.iter().enumerate() {
        // The first of each is tried with the first choice.
        for table in tables.iter().skip(usize::from(section > 0)) {
            let mut tried = [0, 1, 2, 3].map(|section| all[section][0].clone());
            tried[section] = table.clone();
            let scene =
                toml::to_string(&scene_of(spec, tried, None, "check", 0)).map_err(FileError::from_error)?;
            let file = SceneFile::parse(&scene, &path).map_err(|error| error.out_of(path.display()))?;
            if let Some(missing) = file.named_files().into_iter().find(|path| !path.is_file()) {
                let name = missing.strip_prefix(folder).unwrap_or(missing);
                let right = "name it in a choice under [surface], whose files are copied";
                return Err(FileError::file(name, "is no file of the data set", right));
            }
        }
        for table in tables {
            numbers(&Value::Table(table.clone()), sections[section].1, ranges);
        }
    }
    Ok(())
}

/// Numbers of the keys that have a usual range.
fn numbers(value: &Value, field: &str, ranges: &mut BTreeMap<String, [f64; 2]>) {
    match value {
        Value::Table(table) => {
            table.iter().for_each(|(key, value)| numbers(value, &format!("{field}.{key}"), ranges));
        }
        Value::Array(values) => values.iter().for_each(|value| numbers(value, field, ranges)),
        Value::Float(number) => widen(ranges, field, *number),
        Value::Integer(number) => widen(ranges, field, *number as f64),
        _ => {}
    }
}

fn widen(ranges: &mut BTreeMap<String, [f64; 2]>, field: &str, number: f64) {
    let range = ranges.entry(field.to_owned()).or_insert([number; 2]);
    *range = [range[0].min(number), range[1].max(number)];
}

/// A range that goes beyond what is usual, in words.
fn doubt(field: &str, [least, most]: [f64; 2]) -> Option<String> {
    let key = field.rsplit('.').next().unwrap_or(field);
    let (_, usual, units) = USUAL.iter().find(|(known, usual, _)| *known == key && most > *usual)?;
    let shown = |of: f64| {
        let number = |x: f64| format!("{}", (x * of * 1e6).round() / 1e6);
        if least == most { number(most) } else { format!("{} to {}", number(least), number(most)) }
    };
    let unit = units.iter().find(|(_, of)| most * of <= *usual);
    let meant = unit.map_or_else(
        || "check its unit".to_owned(),
        |(unit, of)| format!("if these are {unit}, write {}", shown(*of)),
    );
    Some(format!("{field} is {}, beyond the usual {usual}; {meant}", shown(1.0)))
}
