//! Modal tables of other programs become modes files.
//!
//! CSV with the columns of [`asperity_fit::after::table`] or of `columns`, a modes file, or JSON:
//! one object of equally long number lists, a list of such objects with a `name` each, or rows:
//! objects with a number for each column. Beside these are known:
//!
//! | key | meaning |
//! |---|---|
//! | `freq_ratio`, `ratio` | frequency over `--base-hz` |
//! | `ratio_or_negative_fixed_hz` | the same; negative: fixed, in Hz |
//! | `pole_radius` | decay per sample at `--table-rate` |
//! | `gains` | one list a strike position |
//!
//! Rows that are no mode (a frequency of 0 stands for "none" in some tables) are left out with a
//! warning.

use super::columns;
use crate::error::CliError;
use crate::paths::has_end;
use asperity::{MAX_POSITIONS, ModalModel};
use asperity_dsp::mode::Mode;
use asperity_fit::after::table;
use serde_json::{Map, Value};
use std::path::Path;

/// Largest table, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// Names of columns with levels.
const LEVELS: [&str; 4] = ["amplitude", "gain", "level_db", "op"];

/// Numbers that stand for what a table lacks.
#[derive(Debug, Clone, Default)]
pub struct Missing {
    /// Which object of a list.
    pub entry: Option<String>,
    /// Frequency of a ratio of 1, Hz.
    pub base_hz: Option<f64>,
    /// 60 dB decay time where the table has none, s.
    pub t60_s: Option<f64>,
    /// Rate of a table's pole radii, Hz.
    pub table_rate_hz: f64,
}

/// An imported body.
pub struct Imported {
    /// Its modes, amplitudes of the first strike position.
    pub modes: Vec<Mode>,
    /// Amplitudes at further strike positions.
    pub positions: Vec<Vec<f64>>,
    /// Impulse that the file names, if it is a modes file.
    pub impulse_n_s: Option<f64>,
    /// Modes that were left out.
    pub warnings: Vec<String>,
}

/// Tests whether a file is a table by its name.
pub fn is_table(path: &Path) -> bool {
    has_end(path, &["json"]) || crate::columns::is_table(path)
}

/// Reads a table.
///
/// # Errors
/// When the file cannot be read, is no table, or lacks what `missing` does not supply.
pub fn read(path: &Path, missing: &Missing) -> Result<Imported, CliError> {
    let size = std::fs::metadata(path).map_err(|error| CliError::read(path, &error))?.len();
    if size > MAX_BYTES {
        return Err(CliError::file(path, format!("is {} MB long", size >> 20), "a table has at most 64 MB"));
    }
    let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
    let in_file = |error: CliError| error.within(path.display());
    if crate::columns::is_table(path) {
        return of_columns(columns::of_csv(&text)).map_err(in_file);
    }
    let text = text.trim_start_matches('\u{feff}');
    let json: Value = serde_json::from_str(text).map_err(|error| {
        CliError::file(path, format!("is no JSON ({error})"), "name a table in JSON or CSV")
    })?;
    if json.get("format").and_then(Value::as_str) == Some("asperity.modes") {
        let model = ModalModel::parse(text).map_err(|error| in_file(CliError::from_error(error)))?;
        return Ok(Imported {
            modes: model.modes,
            positions: model.positions,
            impulse_n_s: Some(model.impulse_n_s),
            warnings: Vec::new(),
        });
    }
    if let Some(columns) = columns::of_rows(&json).filter(|_| missing.entry.is_none()) {
        return of_columns(columns).map_err(in_file);
    }
    let entry = entry(&json, missing.entry.as_deref()).map_err(in_file)?;
    body(entry, missing).map_err(in_file)
}

/// Modes of columns as they were read; of amplitude 1 where none is given, as tables of modal
/// analysis have them.
fn of_columns(columns: Vec<columns::Column>) -> Result<Imported, CliError> {
    let mut columns = columns::understood(columns);
    let mut warnings = without_placeholders(&mut columns, &mut []);
    if !columns.iter().any(|(name, _)| LEVELS.contains(&name.as_str())) {
        let rows = columns.first().map_or(0, |(_, values)| values.len());
        columns.push(("amplitude".to_owned(), vec![1.0; rows]));
        warnings.push("the table has no amplitudes: all modes have 1".to_owned());
    }
    let modes = table::from_columns(&columns).map_err(CliError::from_error)?;
    Ok(Imported { modes, positions: Vec::new(), impulse_n_s: None, warnings })
}

/// The object to read.
fn entry<'a>(json: &'a Value, wanted: Option<&str>) -> Result<&'a Map<String, Value>, CliError> {
    let name = |entry: &'a Value| entry.get("name").and_then(Value::as_str).unwrap_or("");
    match json {
        Value::Object(object) => Ok(object),
        Value::Array(list) => {
            let known =
                list.iter().map(|entry| format!("\"{}\"", name(entry))).collect::<Vec<_>>().join(", ");
            let found = match wanted {
                None if list.len() == 1 => list.first(),
                None => {
                    let what = format!("holds {} bodies", list.len());
                    return Err(CliError::new("--entry", what, format!("name one of: {known}")));
                }
                Some(wanted) => list.iter().find(|entry| name(entry) == wanted),
            };
            found.and_then(Value::as_object).ok_or_else(|| {
                let what = format!("\"{}\" is unknown", wanted.unwrap_or(""));
                CliError::new("--entry", what, format!("name one of: {known}"))
            })
        }
        _ => Err(CliError::new("table", "is no object of number lists", "see `asperity fit --help`")),
    }
}

fn body(entry: &Map<String, Value>, missing: &Missing) -> Result<Imported, CliError> {
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    let mut positions: Vec<Vec<f64>> = Vec::new();
    for (key, value) in entry {
        if key == "gains" {
            let lists = value.as_array().map(Vec::as_slice).unwrap_or_default();
            positions = lists.iter().filter_map(numbers).collect();
        } else if let Some(numbers) = numbers(value) {
            columns.push((key.clone(), numbers));
        }
    }
    let mut columns = columns::understood(columns);
    let scaled = |key: &str, columns: &[(String, Vec<f64>)]| {
        let found = columns.iter().find(|(name, _)| name == key);
        found.map(|(_, values)| values.clone())
    };
    for key in ["freq_ratio", "ratio", "ratio_or_negative_fixed_hz"] {
        if let Some(ratios) = scaled(key, &columns) {
            let base_hz = missing.base_hz.ok_or_else(|| {
                CliError::new(key, "the table has ratios only", "say with --base-hz what 1 is, in Hz")
            })?;
            let hz = |r: &f64| if *r < 0.0 { -r } else { r * base_hz };
            columns.push(("frequency_hz".to_owned(), ratios.iter().map(hz).collect()));
        }
    }
    if let Some(radii) = scaled("pole_radius", &columns) {
        let decay = |r: &f64| -r.ln() * missing.table_rate_hz;
        columns.push(("decay_per_s".to_owned(), radii.iter().map(decay).collect()));
    }
    let rows = columns.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    let has = |names: &[&str]| columns.iter().any(|(name, _)| names.contains(&name.as_str()));
    let (decays, levels) = (has(&["decay_per_s", "t60_s", "t60", "rt"]), has(&LEVELS));
    if !decays {
        let t60_s = missing.t60_s.ok_or_else(|| {
            CliError::new("table", "has no decays", "say with --t60 how long its modes ring, in s")
        })?;
        columns.push(("t60_s".to_owned(), vec![t60_s; rows]));
    }
    if !levels {
        let first = if positions.is_empty() { vec![1.0; rows] } else { positions.remove(0) };
        columns.push(("amplitude".to_owned(), first));
    }
    let warnings = without_placeholders(&mut columns, &mut positions);
    let modes = table::from_columns(&columns).map_err(CliError::from_error)?;
    positions.truncate(MAX_POSITIONS - 1);
    if let Some(odd) = positions.iter().find(|amplitudes| amplitudes.len() != modes.len()) {
        let what = format!("{} gains for {} modes", odd.len(), modes.len());
        return Err(CliError::new("gains", what, "must be one gain for every mode"));
    }
    Ok(Imported { modes, positions, impulse_n_s: None, warnings })
}

/// A list of nothing but numbers.
fn numbers(value: &Value) -> Option<Vec<f64>> {
    let list = value.as_array().filter(|list| !list.is_empty())?;
    list.iter().map(Value::as_f64).collect()
}

/// Takes out rows whose frequency is 0.
fn without_placeholders(columns: &mut [(String, Vec<f64>)], positions: &mut [Vec<f64>]) -> Vec<String> {
    let names = ["frequency_hz", "freq_hz", "freq", "cf"];
    let Some((_, hz)) = columns.iter().find(|(name, _)| names.contains(&name.as_str())) else {
        return Vec::new();
    };
    let keep: Vec<bool> = hz.iter().map(|hz| *hz != 0.0).collect();
    let gone = keep.iter().filter(|keep| !**keep).count();
    for values in columns.iter_mut().map(|(_, values)| values).chain(positions) {
        let mut row = 0;
        values.retain(|_| {
            row += 1;
            keep.get(row - 1).copied().unwrap_or(true)
        });
    }
    if gone == 0 { Vec::new() } else { vec![format!("{gone} rows with a frequency of 0 are left out")] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imported(json: &str, missing: &Missing) -> Result<Imported, String> {
        let json: Value = serde_json::from_str(json).unwrap();
        let remarks = |error: CliError| error.to_string();
        entry(&json, missing.entry.as_deref()).and_then(|entry| body(entry, missing)).map_err(remarks)
    }

    #[test]
    fn ratios_pole_radii_and_gains_by_position_become_modes() {
        let table = r#"[{"name":"a","ratio_or_negative_fixed_hz":[1.0,4.0,-2443.0],"pole_radius":[0.9996,0.9994,0.999],
            "gains":[[1.0,0.5,0.2],[0.3,-0.4,0.1]]},{"name":"b"}]"#;
        let missing =
            Missing { entry: Some("a".into()), base_hz: Some(440.0), t60_s: None, table_rate_hz: 44_100.0 };
        let body = imported(table, &missing).unwrap();
        let hz: Vec<f64> = body.modes.iter().map(|mode| mode.frequency_hz).collect();
        assert_eq!(hz, [440.0, 1760.0, 2443.0]);
        assert!((body.modes[0].decay_per_s - 17.6435).abs() < 1e-3);
        assert_eq!((body.modes[1].amplitude, body.positions.as_slice()), (0.5, &[vec![0.3, -0.4, 0.1]][..]));
    }

    #[test]
    fn what_a_table_lacks_is_asked_for_by_option() {
        let ratios = r#"{"ratio":[1.0,0.0,2.9]}"#;
        let mut missing = Missing { table_rate_hz: 44_100.0, ..Missing::default() };
        assert!(imported(ratios, &missing).err().unwrap().contains("--base-hz"));
        missing.base_hz = Some(100.0);
        assert!(imported(ratios, &missing).err().unwrap().contains("--t60"));
        missing.t60_s = Some(0.5);
        let body = imported(ratios, &missing).unwrap();
        assert_eq!((body.modes.len(), body.warnings.len()), (2, 1));
        let two = r#"[{"name":"a","ratio":[1.0]},{"name":"b","ratio":[1.0]}]"#;
        assert!(imported(two, &missing).err().unwrap().contains("\"a\", \"b\""));
        assert!(imported("3", &missing).is_err());
    }
}
