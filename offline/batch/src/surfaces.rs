//! Surfaces: what a specification lets fingers touch, copied beside the shards so that a data set
//! holds all it is made of.
//!
//! A choice is a scene file, whose first surface is touched, or a table with the keys of a
//! `[[surface]]`. Every picture and modes file that it names is copied to `DIR/surfaces/HASH/NAME`
//! (HASH: of its bytes), and the choice's paths are written anew.

use crate::spec::{Spec, SplitBy, sha256};
use crate::whole_file;
use asperity::files::FileError;
use asperity::files::scene_file::SceneFile;
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Digits of a file's hash that its folder is called by.
const DIGITS: usize = 16;
/// Place of the copies in a data set.
const FOLDER: &str = "surfaces";

/// One choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its name in records: the scene file's, the table's `name`, or its place.
    pub name: String,
    /// A whole scene; its first surface is touched, its paths lie below the data set's folder.
    pub scene: Table,
}

/// Every choice of a specification, with its files copied below `folder`.
///
/// # Errors
/// When a choice names no file, or none that can be read, or the copy cannot be written.
pub fn choices(spec: &Spec, folder: &Path) -> Result<Vec<Choice>, FileError> {
    let home = spec.path.parent().unwrap_or(Path::new(""));
    let mut all: Vec<Choice> = Vec::new();
    for (value, place) in spec.says.surface.choice.iter().zip(1..) {
        let field = format!("surface.choice {place}");
        match value {
            Value::String(pattern) => {
                for path in matching(&home.join(pattern)).map_err(|error| error.within(&field))? {
                    all.push(from_scene(&path, folder)?);
                }
            }
            Value::Table(table) => all.push(from_table(table, home, folder, &field)?),
            _ => {
                let right = "a scene file's name, or a table with the keys of a [[surface]]";
                return Err(FileError::new(field, "is neither text nor a table", right));
            }
        }
    }
    distinct(all)
}

/// Names are what splits go by: no two choices may share one.
fn distinct(mut all: Vec<Choice>) -> Result<Vec<Choice>, FileError> {
    for place in 1..all.len() {
        let (before, after) = all.split_at_mut(place);
        if before.iter().any(|choice| choice.name == after[0].name) {
            after[0].name = format!("{}-{}", after[0].name, place + 1);
        }
    }
    Ok(all)
}

/// The files that a name with `*` in its last part stands for, in order.
fn matching(pattern: &Path) -> Result<Vec<PathBuf>, FileError> {
    let name = pattern.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let Some((front, back)) = name.split_once('*') else { return Ok(vec![pattern.to_owned()]) };
    let folder = pattern.parent().unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).map_err(|error| FileError::read(folder, &error))?;
    let fits = |path: &PathBuf| {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        name.len() >= front.len() + back.len()
            && name.starts_with(front)
            && name.ends_with(back)
            && path.is_file()
    };
    let mut paths: Vec<PathBuf> =
        entries.filter_map(Result::ok).map(|entry| entry.path()).filter(fits).collect();
    paths.sort();
    if paths.is_empty() {
        return Err(FileError::file(
            pattern,
            "no file is called so",
            "a name with * must stand for at least one scene file",
        ));
    }
    Ok(paths)
}

fn from_scene(path: &Path, folder: &Path) -> Result<Choice, FileError> {
    let text = fs::read_to_string(path).map_err(|error| FileError::read(path, &error))?;
    let file = SceneFile::parse(&text, path)?;
    if file.surfaces.is_empty() {
        return Err(FileError::file(path, "has no [[surface]]", "name a scene with a surface to touch"));
    }
    let mut scene: Table =
        text.parse().map_err(|error| FileError::from_error(error).within(path.display()))?;
    copy_files(&mut scene, &file, path.parent().unwrap_or(Path::new("")), folder)?;
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    Ok(Choice { name, scene })
}

fn from_table(table: &Table, home: &Path, folder: &Path, field: &str) -> Result<Choice, FileError> {
    let text = |key: &str| table.get(key).and_then(Value::as_str).map(str::to_owned);
    let name = text("name")
        .or_else(|| text("solid"))
        .unwrap_or_else(|| field.replace("surface.choice ", "surface-"));
    let mut surface = table.clone();
    surface.insert("name".into(), Value::String(name.clone()));
    for side in ["width_m", "height_m"] {
        surface.entry(side).or_insert(Value::Float(0.1));
    }
    let mut scene = Table::new();
    scene.insert("surface".into(), Value::Array(vec![Value::Table(surface)]));
    let mut known = scene.clone();
    // Distributions are no values yet; only the names of files are looked for.
    without_distributions(&mut known);
    let written = toml::to_string(&known).map_err(|error| FileError::from_error(error).within(field))?;
    let path = home.join("spec");
    let own = |error: FileError| error.out_of(path.display()).out_of(format!("surface 1 \"{name}\""));
    let file = SceneFile::parse(&written, &path).map_err(|error| own(error).within(field))?;
    copy_files(&mut scene, &file, home, folder)?;
    Ok(Choice { name, scene })
}

/// Takes out what is drawn later, so that a scene can be read for the files that it names.
fn without_distributions(table: &mut Table) {
    let is_drawn = |value: &Value| {
        value.as_table().is_some_and(|inner| {
            ["uniform", "log_uniform", "normal", "choice"].iter().any(|name| inner.contains_key(*name))
        })
    };
    table.retain(|_, value| !is_drawn(value));
    for value in table.iter_mut().map(|(_, value)| value) {
        match value {
            Value::Table(inner) => without_distributions(inner),
            Value::Array(values) => {
                values.iter_mut().filter_map(Value::as_table_mut).for_each(without_distributions)
            }
            _ => {}
        }
    }
}

/// Copies what the scene names and writes the copies' paths in its place.
fn copy_files(scene: &mut Table, file: &SceneFile, home: &Path, folder: &Path) -> Result<(), FileError> {
    for path in file.named_files() {
        let copied = copy(path, folder)?;
        let is_it = |text: &str| home.join(text) == path;
        replace(scene, &is_it, &copied);
    }
    Ok(())
}

fn replace(table: &mut Table, is_it: &dyn Fn(&str) -> bool, by: &str) {
    table.iter_mut().for_each(|(_, value)| replace_value(value, is_it, by));
}

fn replace_value(value: &mut Value, is_it: &dyn Fn(&str) -> bool, by: &str) {
    match value {
        Value::String(text) if is_it(text) => by.clone_into(text),
        Value::Table(table) => replace(table, is_it, by),
        Value::Array(values) => values.iter_mut().for_each(|value| replace_value(value, is_it, by)),
        _ => {}
    }
}

/// Copies a file below the data set's folder and returns its path there. What a modes file keeps
/// beside itself comes along.
fn copy(path: &Path, folder: &Path) -> Result<String, FileError> {
    let bytes = fs::read(path).map_err(|error| FileError::read(path, &error))?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let hash = &sha256(&bytes)[..DIGITS];
    let to = folder.join(FOLDER).join(hash);
    fs::create_dir_all(&to).map_err(|error| FileError::write(&to, &error))?;
    if let Some(beside) = shapes_beside(&bytes) {
        let from = path.parent().unwrap_or(Path::new("")).join(&beside);
        let shapes = fs::read(&from).map_err(|error| FileError::read(&from, &error))?;
        whole_file::write_once(&to.join(beside), &shapes)?;
    }
    whole_file::write_once(&to.join(&name), &bytes)?;
    Ok(format!("{FOLDER}/{hash}/{name}"))
}

/// The file that a modes file names for its shapes.
fn shapes_beside(bytes: &[u8]) -> Option<String> {
    let json: serde_json::Value = serde_json::from_slice(bytes).ok()?;
    json.get("shapes_beside")?.as_str().map(str::to_owned)
}

/// Which part a stroke belongs to. By surface, the surfaces are put into an order by the seed and
/// the parts cut from it, so that each has its share of surfaces to within one.
#[must_use]
pub fn split(spec: &Spec, surface: usize, surfaces: usize, stroke: u64) -> &'static str {
    let place = match spec.says.split.by {
        SplitBy::Surface => {
            let key =
                |i: usize| crate::draw::Draws { seed: spec.says.seed, stroke: i as u64 }.bits("split", 0)[0];
            let before = (0..surfaces).filter(|i| (key(*i), *i) < (key(surface), surface)).count();
            (before as f64 + 0.5) / surfaces as f64
        }
        SplitBy::Stroke => crate::draw::Draws { seed: spec.says.seed, stroke }.unit("split"),
    };
    let says = &spec.says.split;
    if place < says.train {
        "train"
    } else if place < says.train + says.validation {
        "validation"
    } else {
        "test"
    }
}
