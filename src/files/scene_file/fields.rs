//! Reads a TOML table key by key, so that every refusal can name the place, the value and the
//! remedy.

use crate::files::{FileError, nearest};
use crate::parameters::Parameter;
use asperity_dsp::limits::Range;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// A table being read. Every key asked for becomes an accepted one; [`Fields::finish`] refuses the
/// rest.
#[derive(Debug)]
pub struct Fields {
    table: Table,
    place: String,
    accepted: Vec<&'static str>,
}

impl Fields {
    /// Reads `table`, which errors call `place` (empty at the top of the file).
    pub fn new(table: Table, place: impl Into<String>) -> Self {
        Self { table, place: place.into(), accepted: Vec::new() }
    }

    /// Renames the place, once the table's own name is known.
    pub fn rename(&mut self, place: impl Into<String>) {
        self.place = place.into();
    }

    /// An error at a key of this table.
    pub fn refuse(
        &self,
        key: &str,
        what: impl std::fmt::Display,
        right: impl std::fmt::Display,
    ) -> FileError {
        let at = if self.place.is_empty() { key.to_owned() } else { format!("{}: {key}", self.place) };
        FileError::new(at, what, right)
    }

    /// Tests whether a key is there; it counts as accepted.
    pub fn has(&mut self, key: &'static str) -> bool {
        self.accept(key);
        self.table.contains_key(key)
    }

    fn accept(&mut self, key: &'static str) {
        if !self.accepted.contains(&key) {
            self.accepted.push(key);
        }
    }

    /// Tests whether a key holds a list.
    pub fn is_list(&mut self, key: &'static str) -> bool {
        self.accept(key);
        matches!(self.table.get(key), Some(Value::Array(_)))
    }

    /// Takes a key's value out.
    pub fn take(&mut self, key: &'static str) -> Option<Value> {
        self.accept(key);
        self.table.remove(key)
    }

    fn wrong_kind(&self, key: &str, value: &Value, right: &str) -> FileError {
        self.refuse(key, format!("{} is not {right}", shown(value)), format!("write {right}"))
    }

    /// A number of the list of parameters.
    pub fn number(&mut self, of: &Parameter) -> Result<Option<f64>, FileError> {
        let Some(value) = self.take(of.key) else { return Ok(None) };
        let number = as_number(&value).ok_or_else(|| self.wrong_kind(of.key, &value, "a number"))?;
        if of.range.holds(number) {
            Ok(Some(number))
        } else {
            Err(self.refuse(of.key, format!("{} is refused", shown(&value)), right(of.range)))
        }
    }

    /// A number that must be there.
    pub fn needed_number(&mut self, of: &Parameter) -> Result<f64, FileError> {
        self.number(of)?.ok_or_else(|| self.missing(of.key, "a number"))
    }

    /// A number, or the default.
    pub fn number_or(&mut self, of: &Parameter, default: f64) -> Result<f64, FileError> {
        Ok(self.number(of)?.unwrap_or(default))
    }

    /// A whole number of the list of parameters.
    pub fn count(&mut self, of: &Parameter) -> Result<Option<usize>, FileError> {
        let whole = self.whole(of.key, of.range.low as u64, of.range.high as u64)?;
        Ok(whole.map(|whole| whole as usize))
    }

    /// A whole number.
    pub fn whole(&mut self, key: &'static str, low: u64, high: u64) -> Result<Option<u64>, FileError> {
        let Some(value) = self.take(key) else { return Ok(None) };
        let whole = value.as_integer().and_then(|whole| u64::try_from(whole).ok());
        match whole.filter(|whole| (low..=high).contains(whole)) {
            Some(whole) => Ok(Some(whole)),
            None => {
                let right = format!("must be a whole number from {low} to {high}");
                Err(self.refuse(key, format!("{} is refused", shown(&value)), right))
            }
        }
    }

    /// A seed of random numbers.
    pub fn seed(&mut self, of: &Parameter) -> Result<Option<u64>, FileError> {
        self.whole(of.key, of.range.low as u64, of.range.high as u64)
    }

    /// Text.
    pub fn text(&mut self, key: &'static str) -> Result<Option<String>, FileError> {
        match self.take(key) {
            None => Ok(None),
            Some(Value::String(text)) if !text.is_empty() => Ok(Some(text)),
            Some(value) => Err(self.wrong_kind(key, &value, "text in quotes")),
        }
    }

    /// Text that must be there.
    pub fn needed_text(&mut self, key: &'static str) -> Result<String, FileError> {
        self.text(key)?.ok_or_else(|| self.missing(key, "text in quotes"))
    }

    /// One of a few words; `None` when the key is missing.
    pub fn word<T: Copy>(&mut self, key: &'static str, words: &[(&str, T)]) -> Result<Option<T>, FileError> {
        let Some(text) = self.text(key)? else { return Ok(None) };
        match words.iter().find(|(word, _)| *word == text) {
            Some((_, meaning)) => Ok(Some(*meaning)),
            None => {
                let known: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
                Err(self.refuse(key, format!("\"{text}\" is unknown"), format!("must be {}", any_of(&known))))
            }
        }
    }

    /// Yes or no.
    pub fn flag(&mut self, key: &'static str) -> Result<Option<bool>, FileError> {
        match self.take(key) {
            None => Ok(None),
            Some(Value::Boolean(flag)) => Ok(Some(flag)),
            Some(value) => Err(self.wrong_kind(key, &value, "true or false")),
        }
    }

    /// A file named relative to `folder`.
    pub fn file(&mut self, key: &'static str, folder: &Path) -> Result<Option<PathBuf>, FileError> {
        Ok(self.text(key)?.map(|name| folder.join(name)))
    }

    /// Two numbers.
    pub fn pair(&mut self, of: &Parameter) -> Result<Option<[f64; 2]>, FileError> {
        let (key, allowed) = (of.key, of.range);
        let Some(value) = self.take(key) else { return Ok(None) };
        let numbers: Option<Vec<f64>> =
            value.as_array().and_then(|items| items.iter().map(as_number).collect());
        match numbers.as_deref() {
            Some([first, second]) if allowed.holds(*first) && allowed.holds(*second) => {
                Ok(Some([*first, *second]))
            }
            Some([_, _]) => Err(self.refuse(
                key,
                format!("{} is refused", shown(&value)),
                format!("each {}", right(allowed)),
            )),
            _ => Err(self.wrong_kind(key, &value, "two numbers, [u, v]")),
        }
    }

    /// Up to N numbers; `rest` stands for those that are not written.
    pub fn up_to<const N: usize>(
        &mut self,
        of: &Parameter,
        rest: f64,
    ) -> Result<Option<[f64; N]>, FileError> {
        let Some(value) = self.take(of.key) else { return Ok(None) };
        let numbers: Option<Vec<f64>> =
            value.as_array().and_then(|items| items.iter().map(as_number).collect());
        let Some(numbers) = numbers.filter(|numbers| (1..=N).contains(&numbers.len())) else {
            return Err(self.wrong_kind(of.key, &value, &format!("1 to {N} numbers")));
        };
        if let Some(number) = numbers.iter().find(|number| !of.range.holds(**number)) {
            return Err(self.refuse(
                of.key,
                format!("{number} is refused"),
                format!("each {}", right(of.range)),
            ));
        }
        Ok(Some(std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(rest))))
    }

    /// A vector.
    pub fn vector(&mut self, of: &Parameter) -> Result<Option<[f64; 3]>, FileError> {
        let Some(value) = self.take(of.key) else { return Ok(None) };
        let numbers: Option<Vec<f64>> =
            value.as_array().and_then(|items| items.iter().map(as_number).collect());
        let vector = numbers.and_then(|numbers| numbers.try_into().ok());
        vector.map(Some).ok_or_else(|| self.wrong_kind(of.key, &value, "three numbers, [x, y, z]"))
    }

    /// One number, which is the third of a vector, or all three; each in its range.
    pub fn number_or_vector(&mut self, of: &Parameter) -> Result<Option<[f64; 3]>, FileError> {
        let vector = if self.is_list(of.key) {
            self.vector(of)?
        } else {
            self.number(of)?.map(|number| [0.0, 0.0, number])
        };
        match vector {
            Some(vector) if !vector.iter().all(|x| of.range.holds(*x)) => Err(self.refuse(
                of.key,
                format!("{vector:?} is refused"),
                format!("each {}", right(of.range)),
            )),
            vector => Ok(vector),
        }
    }

    /// A table.
    pub fn table(&mut self, key: &'static str) -> Result<Option<Self>, FileError> {
        match self.take(key) {
            None => Ok(None),
            Some(Value::Table(table)) => Ok(Some(Self::new(table, self.inner(key)))),
            Some(value) => Err(self.wrong_kind(key, &value, "a table, { key = value }")),
        }
    }

    /// Numbers of a table whose keys are names, each in the range.
    pub fn numbers_by_name(self, range: Range) -> Result<Vec<(String, f64)>, FileError> {
        let read = |(name, value): (&String, &Value)| {
            let number = as_number(value).filter(|number| range.holds(*number));
            let refused = || self.refuse(name, format!("{} is refused", shown(value)), right(range));
            number.map(|number| (name.clone(), number)).ok_or_else(refused)
        };
        self.table.iter().map(read).collect()
    }

    /// An array of tables, `[[key]]`.
    pub fn tables(&mut self, key: &'static str) -> Result<Vec<Self>, FileError> {
        let Some(value) = self.take(key) else { return Ok(Vec::new()) };
        let right = format!("a list of tables, each begun with [[{key}]]");
        let Value::Array(items) = value else { return Err(self.wrong_kind(key, &value, &right)) };
        let mut tables = Vec::with_capacity(items.len());
        for (index, item) in items.into_iter().enumerate() {
            match item {
                Value::Table(table) => {
                    tables.push(Self::new(table, format!("{} {}", self.inner(key), index + 1)))
                }
                other => return Err(self.wrong_kind(key, &other, &right)),
            }
        }
        Ok(tables)
    }

    /// The place of a table inside this one.
    pub fn inner(&self, key: &str) -> String {
        if self.place.is_empty() { key.to_owned() } else { format!("{}: {key}", self.place) }
    }

    /// An error for a key that must be there; it names the one that stands in its place without
    /// its unit or with another.
    pub fn missing(&self, key: &str, right: &str) -> FileError {
        let right = format!("write {key} = {right}");
        let stem = key.rsplit_once('_').map_or(key, |(stem, _unit)| stem);
        let mut unknown = self.table.keys().filter(|written| !self.accepted.contains(&written.as_str()));
        match unknown.find(|written| written.starts_with(stem)) {
            Some(written) => self.refuse(written, "unknown key", right),
            None => self.refuse(key, "is missing", right),
        }
    }

    /// The table as it is, before anything is taken out.
    pub fn written(&self) -> Table {
        self.table.clone()
    }

    /// Every key that was not asked for, for somebody else to read.
    pub fn rest(self) -> Table {
        self.table
    }

    /// Refuses every key that was not asked for.
    pub fn finish(mut self) -> Result<(), FileError> {
        let unknown = self.table.keys().next().cloned();
        match unknown {
            None => Ok(()),
            Some(key) => {
                self.accepted.sort_unstable();
                let meant = nearest(&key, &self.accepted)
                    .map_or_else(String::new, |meant| format!("write {meant}; "));
                let right = format!("{meant}accepted here: {}", self.accepted.join(", "));
                Err(self.refuse(&key, "unknown key", right))
            }
        }
    }
}

fn right(allowed: Range) -> String {
    format!("must be {}", allowed.words)
}

/// Integers and floats alike.
pub fn as_number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// A value as TOML on one line.
fn written(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{text:?}"),
        Value::Integer(whole) => whole.to_string(),
        Value::Float(number) => format!("{number:?}").to_ascii_lowercase(),
        Value::Boolean(is) => is.to_string(),
        Value::Datetime(time) => time.to_string(),
        Value::Array(values) => format!("[{}]", values.iter().map(written).collect::<Vec<_>>().join(", ")),
        Value::Table(table) => {
            let entries = table.iter().map(|(key, value)| format!("{key} = {}", written(value)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
    }
}

/// A value as the user wrote it, cut when it is long.
pub fn shown(value: &Value) -> String {
    let text = written(value);
    match text.char_indices().nth(60) {
        Some((cut, _)) => format!("{}…", &text[..cut]),
        None => text,
    }
}

/// `a, b or c`.
pub fn any_of(words: &[String]) -> String {
    match words {
        [] => "nothing".to_owned(),
        [only] => only.clone(),
        [most @ .., last] => format!("{} or {last}", most.join(", ")),
    }
}
