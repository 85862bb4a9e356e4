//! Columns of a modal table as other programs write them: separators, quotes, units in brackets,
//! damping in their terms.
//!
//! | column | becomes |
//! |---|---|
//! | `frequency`, `natural_frequency`, `f`, `fn`; in Hz, kHz or rad/s | `frequency_hz` |
//! | `damping_ratio`, `zeta`, `ζ`, in % where it says so | decay 2π f ζ |
//! | `q`, `q_factor`, `quality_factor` | decay π f / Q |
//! | `loss_factor`, `eta`, `η` | decay π f η |
//!
//! Units stand in brackets behind the name or at its end (`[kHz]`, `(%)`, `_khz`, `_percent`). A
//! column `damping` is read only with a unit: it may be a ratio or per cent.

use serde_json::Value;
use std::f64::consts::{PI, TAU};

/// A name and its numbers; not a number where there is none.
pub type Column = (String, Vec<f64>);

/// Columns of a text whose cells are set apart by commas, semicolons or tabs.
pub fn of_csv(text: &str) -> Vec<Column> {
    let text = text.trim_start_matches('\u{feff}');
    let is_told = |line: &&str| !line.trim().is_empty() && !line.starts_with('#');
    let head = text.lines().find(is_told).unwrap_or("");
    let separator = [';', '\t'].into_iter().find(|c| head.contains(*c)).unwrap_or(',');
    let lines: Vec<&str> = text.lines().filter(is_told).collect();
    let mut reader = csv::ReaderBuilder::new();
    reader.delimiter(separator as u8).flexible(true).has_headers(false).trim(csv::Trim::All);
    let text = lines.join("\n");
    let mut rows = reader.from_reader(text.as_bytes()).into_records().filter_map(Result::ok);
    let names = rows.next().unwrap_or_default();
    let mut columns: Vec<Column> = names.iter().map(|name| (name.to_owned(), Vec::new())).collect();
    for row in rows {
        for (i, (_, column)) in columns.iter_mut().enumerate() {
            let cell = row.get(i).unwrap_or("").trim_end_matches('%').trim();
            // Where semicolons separate, commas are decimal.
            let decimal = if separator == ',' { cell.to_owned() } else { cell.replace(',', ".") };
            column.push(decimal.parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

/// Columns of a list of objects with a number for each name, or of the first list of such in an
/// object.
pub fn of_rows(json: &Value) -> Option<Vec<Column>> {
    let is_rows = |value: &&Value| {
        value.as_array().is_some_and(|list| {
            !list.is_empty()
                && list.iter().all(|row| row.as_object().is_some_and(|r| r.values().any(Value::is_number)))
        })
    };
    let rows = match json {
        Value::Object(object) => object.values().find(is_rows)?,
        _ => Some(json).filter(is_rows)?,
    };
    let rows = rows.as_array()?;
    let names = rows[0].as_object()?.iter().filter(|(_, value)| value.is_number()).map(|(name, _)| name);
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap_or(f64::NAN);
    Some(names.map(|name| (name.clone(), rows.iter().map(|row| number(row, name)).collect())).collect())
}

/// Names without units, in lower case, and frequencies and decays in the terms of a modes file
/// beside what was there.
pub fn understood(columns: Vec<Column>) -> Vec<Column> {
    let named: Vec<(String, String, Vec<f64>)> = columns
        .into_iter()
        .map(|(name, values)| {
            let (name, unit) = name_and_unit(&name);
            (name, unit, values)
        })
        .collect();
    let mut known: Vec<Column> = Vec::new();
    for (name, unit, values) in &named {
        let plain = matches!(
            name.as_str(),
            "frequency" | "natural_frequency" | "f" | "fn" | "f_n" | "freq" | "omega"
        );
        let factor = match unit.as_str() {
            "khz" => 1e3,
            "rad/s" => 1.0 / TAU,
            _ if name == "omega" => 1.0 / TAU,
            _ => 1.0,
        };
        if plain {
            known.push(("frequency_hz".to_owned(), values.iter().map(|f| f * factor).collect()));
        } else {
            known.push((name.clone(), values.clone()));
        }
    }
    let hz = known
        .iter()
        .find(|(name, _)| matches!(name.as_str(), "frequency_hz" | "freq_hz" | "cf"))
        .map(|(_, values)| values.clone());
    let has_decay = known.iter().any(|(name, _)| name == "decay_per_s");
    let Some(hz) = hz.filter(|_| !has_decay) else { return known };
    let law = |name: &str, unit: &str| -> Option<fn(f64, f64) -> f64> {
        match (name, unit) {
            ("damping_ratio" | "zeta" | "ζ" | "damping", "%" | "percent" | "pct") => {
                Some(|hz, ratio| TAU * hz * ratio / 100.0)
            }
            ("damping_ratio" | "zeta" | "ζ", _) | ("damping", "-" | "1") => {
                Some(|hz, ratio| TAU * hz * ratio)
            }
            ("q" | "q_factor" | "quality_factor", _) => Some(|hz, q| PI * hz / q),
            ("loss_factor" | "eta" | "η", "%" | "percent" | "pct") => Some(|hz, eta| PI * hz * eta / 100.0),
            ("loss_factor" | "eta" | "η", _) => Some(|hz, eta| PI * hz * eta),
            _ => None,
        }
    };
    let decays = named.iter().find_map(|(name, unit, values)| {
        let law = law(name, unit)?;
        Some(hz.iter().zip(values).map(|(hz, value)| law(*hz, *value)).collect())
    });
    known.extend(decays.map(|decays| ("decay_per_s".to_owned(), decays)));
    known
}

/// `Natural frequency [kHz]` is `natural_frequency` in `khz`.
fn name_and_unit(name: &str) -> (String, String) {
    let lower = name.trim().to_lowercase();
    let (mut name, mut unit) = (lower.as_str(), "");
    if let Some((before, inside)) = lower.split_once(['[', '(']) {
        (name, unit) = (before, inside.trim_end_matches([']', ')']).trim());
    }
    let mut name = name.trim().replace([' ', '-'], "_");
    for suffix in ["_khz", "_percent", "_pct"] {
        if let Some(stem) = name.strip_suffix(suffix) {
            (name, unit) = (stem.to_owned(), suffix.trim_start_matches('_'));
        }
    }
    if let Some(stem) = name.strip_suffix('%') {
        (name, unit) = (stem.trim_end_matches('_').to_owned(), "%");
    }
    (name, unit.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decays(text: &str) -> (f64, f64) {
        let columns = understood(of_csv(text));
        let first = |wanted: &str| columns.iter().find(|(name, _)| name == wanted).unwrap().1[0];
        (first("frequency_hz"), first("decay_per_s"))
    }

    #[test]
    fn damping_in_the_terms_of_modal_analysis_is_the_same_decay() {
        // ζ = 0.5 % of 812.4 Hz: Q = 100, η = 0.01, 25.52 1/s.
        let expected = TAU * 812.4 * 0.005;
        for text in [
            "frequency_hz,damping_ratio\n812.4,0.005\n",
            "\u{feff}\"Natural frequency [Hz]\";\"Damping ratio [%]\"\r\n812,4;0,5\r\n",
            "Frequency (kHz)\tQ\n0.8124\t100\n",
            "freq_khz,loss_factor,\"shape, by eye\"\n0.8124,0.01,\"first, bending\"\n",
            "f,zeta_percent\n812.4,0.5\n",
            "freq,Damping [%]\n812.4,0.5%\n",
        ] {
            let (hz, decay) = decays(text);
            assert!(
                (hz - 812.4).abs() < 1e-9 && (decay / expected - 1.0).abs() < 1e-9,
                "{text}: {hz} {decay}"
            );
        }
        // A ratio or per cent: not guessed.
        assert!(understood(of_csv("freq,damping\n100,0.5\n")).iter().all(|(name, _)| name != "decay_per_s"));
        let rows = serde_json::json!({"modes": [{"frequency": 812.4, "zeta": 0.005, "name": "a"}]});
        let columns = understood(of_rows(&rows).unwrap());
        assert!((columns.last().unwrap().1[0] / expected - 1.0).abs() < 1e-9);
    }
}
