//! A scene file as it is tuned: every number that the registry holds, in the tables
//! that the file has, and the text around them as it is.

use crate::error::CliError;
use asperity::parameters::{self, Changes, Parameter};
use serde::Serialize;
use std::path::Path;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// A number, or a vector, that can be turned.
#[derive(Debug, Serialize)]
pub struct Setting {
    /// Path of a number: the keys and numbers of the tables around it, with points between.
    path: String,
    /// Label of that path: `surface "tiles" · sand`.
    place: String,
    key: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    /// The range in words.
    range: &'static str,
    whole: bool,
    components: usize,
    default: Option<f64>,
    /// Value in the file; empty where it has none.
    value: Vec<f64>,
    /// Moment at which a new value is heard: `sounding`, `anew` or `opened`.
    changes: &'static str,
    meaning: &'static str,
    source: &'static str,
}

/// A scene file that is being changed.
#[derive(Clone)]
pub struct Document {
    inner: DocumentMut,
}

impl Document {
    /// Takes the text of a scene file.
    ///
    /// # Errors
    /// When it is no TOML.
    pub fn parse(text: &str, path: &Path) -> Result<Self, CliError> {
        let inner = text.parse().map_err(|error: toml_edit::TomlError| {
            CliError::file(path, error.message(), "write TOML, as docs/formats/scene.md shows")
        })?;
        Ok(Self { inner })
    }

    /// The text, comments and all.
    pub fn text(&self) -> String {
        self.inner.to_string()
    }

    /// Everything that can be turned, in the file's order.
    pub fn settings(&self) -> Vec<Setting> {
        let mut found = Vec::new();
        gather(self.inner.as_table(), &Place::default(), &mut found);
        found
    }

    /// Writes numbers at a key of a table, or takes the key out, so that its default counts.
    ///
    /// # Errors
    /// When there is no such table, the registry has no such number, or it is out of its range.
    pub fn set(&mut self, path: &str, key: &str, numbers: &[f64]) -> Result<(), CliError> {
        let names: Vec<&str> = steps(path).filter(|step| step.parse::<usize>().is_err()).collect();
        let at = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        let unknown =
            || CliError::new(&at, "is no number of a scene file", "see docs/formats/scene.md, Every number");
        let parameter =
            table_of(&names).and_then(|table| parameters::find(table, key)).ok_or_else(unknown)?;
        if !numbers.is_empty() && numbers.len() != parameter.components {
            let right = format!("write {}", parameter.components);
            return Err(CliError::new(&at, format!("has {} numbers", numbers.len()), right));
        }
        if let Some(bad) = numbers.iter().find(|number| !parameter.range.holds(**number)) {
            return Err(CliError::new(
                &at,
                format!("{bad} is refused"),
                format!("must be {}", parameter.range.words),
            ));
        }
        let missing = || CliError::new(&at, "stands in no table of this file", "open the scene again");
        let table = table_at(self.inner.as_table_mut(), path).ok_or_else(missing)?;
        write(table, parameter, numbers);
        Ok(())
    }
}

/// Position of the walk through a file.
#[derive(Clone, Default)]
struct Place {
    path: String,
    names: Vec<String>,
    label: String,
}

impl Place {
    fn into(&self, key: &str, number: Option<usize>, table: &dyn TableLike) -> Self {
        let point = |text: &str| if text.is_empty() { String::new() } else { format!("{text}.") };
        let index = number.map_or_else(String::new, |number| format!(".{number}"));
        let name = table.get("name").and_then(Item::as_str);
        let called = match (name, number) {
            (Some(name), _) => format!("{key} \"{name}\""),
            (None, Some(number)) => format!("{key} {}", number + 1),
            (None, None) => key.to_owned(),
        };
        let label = if self.label.is_empty() { called } else { format!("{} · {called}", self.label) };
        let names = self.names.iter().cloned().chain([key.to_owned()]).collect();
        Self { path: format!("{}{key}{index}", point(&self.path)), names, label }
    }
}

/// The registry's name of a table, by the keys that lead to it.
fn table_of(names: &[impl AsRef<str>]) -> Option<&'static str> {
    let has =
        |name: &str| parameters::ALL.iter().map(|parameter| parameter.table).find(|table| *table == name);
    if names.is_empty() {
        return has("");
    }
    let words: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    (0..words.len()).find_map(|from| has(&words[from..].join("."))).filter(|table| *table != "event")
}

fn gather(table: &dyn TableLike, place: &Place, found: &mut Vec<Setting>) {
    if let Some(name) = table_of(&place.names) {
        let here = parameters::ALL.iter().filter(|parameter| parameter.table == name);
        found.extend(here.filter_map(|parameter| setting(table, place, parameter)));
    }
    for (key, item) in table.iter() {
        match item {
            Item::ArrayOfTables(tables) => {
                for (number, inner) in tables.iter().enumerate() {
                    gather(inner, &place.into(key, Some(number), inner), found);
                }
            }
            Item::Value(Value::Array(values)) => {
                for (number, value) in values.iter().enumerate() {
                    if let Some(inner) = value.as_inline_table() {
                        gather(inner, &place.into(key, Some(number), inner), found);
                    }
                }
            }
            _ => {
                if let Some(inner) = item.as_table_like() {
                    gather(inner, &place.into(key, None, inner), found);
                }
            }
        }
    }
}

/// Number in the file; none where it has something else, as a preset's name or a map.
fn setting(table: &dyn TableLike, place: &Place, parameter: &'static Parameter) -> Option<Setting> {
    let value = match table.get(parameter.key) {
        None => Vec::new(),
        Some(item) => numbers(item)?,
    };
    Some(Setting {
        path: place.path.clone(),
        place: if place.label.is_empty() { "scene".to_owned() } else { place.label.clone() },
        key: parameter.key,
        unit: parameter.unit,
        low: parameter.range.low,
        high: parameter.range.high,
        range: parameter.range.words,
        whole: parameter.whole,
        components: parameter.components,
        default: parameter.default,
        value,
        changes: match parameter.changes {
            Changes::Sounding => "sounding",
            Changes::Anew => "anew",
            Changes::Opened | Changes::Event => "opened",
        },
        meaning: parameter.meaning,
        source: parameter.source,
    })
}

fn numbers(item: &Item) -> Option<Vec<f64>> {
    let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
    match item.as_value()? {
        Value::Array(values) => values.iter().map(number).collect(),
        value => number(value).map(|number| vec![number]),
    }
}

/// Keys and numbers of a path.
fn steps(path: &str) -> impl Iterator<Item = &str> {
    path.split('.').filter(|step| !step.is_empty())
}

fn table_at<'a>(root: &'a mut dyn TableLike, path: &str) -> Option<&'a mut dyn TableLike> {
    let mut table = root;
    let mut steps = steps(path).peekable();
    while let Some(key) = steps.next() {
        let number = steps.next_if(|step| step.parse::<usize>().is_ok()).and_then(|step| step.parse().ok());
        let item = table.get_mut(key)?;
        table = match (item, number) {
            (Item::ArrayOfTables(tables), Some(number)) => tables.get_mut(number)?,
            (Item::Value(Value::Array(values)), Some(number)) => {
                values.get_mut(number)?.as_inline_table_mut()?
            }
            (item, None) => item.as_table_like_mut()?,
            _ => return None,
        };
    }
    Some(table)
}

/// Puts a value in the place of the one before, with the comment behind it.
fn write(table: &mut dyn TableLike, parameter: &Parameter, numbers: &[f64]) {
    let one = |number: f64| if parameter.whole { Value::from(number as i64) } else { Value::from(number) };
    let mut value = match numbers {
        [] => {
            table.remove(parameter.key);
            return;
        }
        [number] if parameter.components == 1 => one(*number),
        several => Value::Array(several.iter().copied().map(one).collect()),
    };
    match table.get_mut(parameter.key).and_then(Item::as_value_mut) {
        Some(old) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        None => {
            table.insert(parameter.key, Item::Value(value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "# My scene.\nseed = 1 # of the noise\n\n[[surface]]\nname = \"tiles\" # blue\nwidth_m = 0.14 # what uv spans\nheight_m = 0.14\n\
        sand = { cells = 64, depth_m = 0.03 } # soft\n[surface.frame]\norigin_m = [0, 0, 0.5] # there\n\n[[actuator]]\nfull_scale = 1e-4\n";

    fn document() -> Document {
        Document::parse(SCENE, Path::new("scene.toml")).unwrap()
    }

    #[test]
    fn what_is_turned_changes_and_every_other_byte_stays() {
        let mut turned = document();
        turned.set("surface.0", "width_m", &[0.2]).unwrap();
        turned.set("surface.0.sand", "depth_m", &[0.01]).unwrap();
        turned.set("surface.0.frame", "origin_m", &[0.0, 0.25, 0.5]).unwrap();
        turned.set("", "seed", &[7.0]).unwrap();
        let expected = SCENE
            .replace("width_m = 0.14", "width_m = 0.2")
            .replace("depth_m = 0.03", "depth_m = 0.01")
            .replace("[0, 0, 0.5]", "[0.0, 0.25, 0.5]")
            .replace("seed = 1", "seed = 7");
        assert_eq!(turned.text(), expected);
    }

    #[test]
    fn a_number_missing_from_the_file_is_added_and_removed_again() {
        let mut turned = document();
        turned.set("surface.0", "micro_relief_m", &[2e-5]).unwrap();
        assert!(turned.text().contains("micro_relief_m = 0.00002"), "{}", turned.text());
        turned.set("surface.0", "micro_relief_m", &[]).unwrap();
        assert_eq!(turned.text(), SCENE);
    }

    #[test]
    fn every_number_is_told_with_its_unit_range_and_place() {
        let settings = document().settings();
        let find =
            |path: &str, key: &str| settings.iter().find(|one| one.path == path && one.key == key).unwrap();
        let width = find("surface.0", "width_m");
        assert_eq!((width.value.as_slice(), width.unit, width.changes), (&[0.14][..], "m", "anew"));
        assert_eq!(find("surface.0.sand", "depth_m").place, "surface \"tiles\" · sand");
        assert_eq!(find("surface.0.frame", "origin_m").value, [0.0, 0.0, 0.5]);
        assert!(find("surface.0", "friction").value.is_empty());
        assert_eq!(find("actuator.0", "highpass_hz").default, Some(10.0));
        assert_eq!(find("", "seed").value, [1.0]);
        assert!(settings.iter().all(|one| one.low <= one.high && !one.range.is_empty()));
    }

    #[test]
    fn what_is_wrong_is_refused_and_changes_nothing() {
        let mut turned = document();
        for (path, key, numbers) in [
            ("surface.0", "width_m", &[-1.0][..]),
            ("surface.0", "width_m", &[f64::NAN]),
            ("surface.0", "width_m", &[0.1, 0.1]),
            ("surface.9", "width_m", &[0.1]),
            ("surface", "width_m", &[0.1]),
            ("surface.0", "name", &[0.1]),
            ("event", "uv", &[0.1]),
            ("nowhere.7.x", "width_m", &[0.1]),
        ] {
            assert!(turned.set(path, key, numbers).is_err(), "{path}.{key} {numbers:?}");
        }
        assert_eq!(turned.text(), SCENE);
    }
}
