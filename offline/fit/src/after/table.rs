//! Modal tables: our own CSV, and tables of other programs.
//!
//! CSV with a header; columns are found by name, in any order:
//!
//! | quantity | names |
//! |---|---|
//! | frequency, Hz | `frequency_hz`, `freq_hz`, `freq`, `cf` |
//! | decay | `decay_per_s`; or `t60_s`, `rt` (60 dB in seconds) |
//! | amplitude | `amplitude`, `gain`; or `level_db`, `op` (decibels) |
//! | phase, rad | `phase_rad` (missing: 0) |
//!
//! Number lists under the same names (as sound-synthesis toolkits store modal data in JSON) are the
//! same table ([`from_columns`]).

use crate::body::fitted::FittedMode;
use asperity_dsp::mode::Mode;
use std::fmt::Write;

/// Why a table was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// A column is missing.
    #[error("modal table: no column for the {what}; one of {names} is needed")]
    NoColumn {
        /// Which quantity.
        what: &'static str,
        /// The names it goes by.
        names: &'static str,
    },
    /// A cell that is no number, or a number no body can have.
    #[error("modal table: row {row}: {what} is refused; {right}")]
    BadCell {
        /// Row, from 1, the header not counted.
        row: usize,
        /// The cell.
        what: String,
        /// Remedy.
        right: &'static str,
    },
    /// Not one mode.
    #[error("modal table: no rows; at least one mode is needed")]
    Empty,
}

const FREQUENCY: &[&str] = &["frequency_hz", "freq_hz", "freq", "cf"];
const DECAY: &[&str] = &["decay_per_s"];
const T60: &[&str] = &["t60_s", "t60", "rt"];
const AMPLITUDE: &[&str] = &["amplitude", "gain"];
const LEVEL: &[&str] = &["level_db", "op"];
const PHASE: &[&str] = &["phase_rad"];

/// Fitted modes as CSV, with their standard deviations.
#[must_use]
pub fn to_csv(modes: &[FittedMode]) -> String {
    let mut text = String::from(
        "frequency_hz,decay_per_s,amplitude,phase_rad,frequency_std_hz,decay_std_per_s,amplitude_std,phase_std_rad,energy\n",
    );
    for m in modes {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{}",
            m.frequency_hz,
            m.decay_per_s,
            m.amplitude,
            m.phase_rad,
            m.frequency_std_hz,
            m.decay_std_per_s,
            m.amplitude_std,
            m.phase_std_rad,
            m.energy
        );
    }
    text
}

/// Modes as CSV, without standard deviations.
#[must_use]
pub fn modes_to_csv(modes: &[Mode]) -> String {
    let mut text = String::from("frequency_hz,decay_per_s,amplitude,phase_rad\n");
    for m in modes {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{},{},{},{}", m.frequency_hz, m.decay_per_s, m.amplitude, m.phase_rad);
    }
    text
}

/// Modes of named columns of numbers.
///
/// # Errors
/// A missing column, a cell that is no number, a frequency not above 0, a negative decay, or no
/// rows.
pub fn from_columns(columns: &[(String, Vec<f64>)]) -> Result<Vec<Mode>, TableError> {
    let find = |names: &[&str]| {
        columns.iter().find(|(name, _)| names.contains(&name.as_str())).map(|(_, values)| values.as_slice())
    };
    let frequency = find(FREQUENCY)
        .ok_or(TableError::NoColumn { what: "frequency", names: "frequency_hz, freq_hz, freq, cf" })?;
    let decay = find(DECAY);
    let t60 = find(T60);
    if decay.is_none() && t60.is_none() {
        let names = "decay_per_s, t60_s, t60, rt, damping_ratio, q, loss_factor";
        return Err(TableError::NoColumn { what: "decay", names });
    }
    let (amplitude, level, phase) = (find(AMPLITUDE), find(LEVEL), find(PHASE));
    if amplitude.is_none() && level.is_none() {
        return Err(TableError::NoColumn { what: "amplitude", names: "amplitude, gain, level_db, op" });
    }
    if frequency.is_empty() {
        return Err(TableError::Empty);
    }
    (0..frequency.len())
        .map(|i| {
            let cell = |column: &[f64], what: &str, right: &'static str, ok: fn(f64) -> bool| {
                let value = column.get(i).copied().unwrap_or(f64::NAN);
                if value.is_finite() && ok(value) {
                    Ok(value)
                } else {
                    let value = if value.is_nan() { "that is missing".to_owned() } else { value.to_string() };
                    Err(TableError::BadCell { row: i + 1, what: format!("{what} {value}"), right })
                }
            };
            let decay_per_s = match (decay, t60) {
                (Some(decay), _) => cell(decay, "decay", "a decay at or above 0 would do", |d| d >= 0.0)?,
                (None, Some(t60)) => {
                    let seconds = cell(t60, "T60", "a time above 0 s would do", |t| t > 0.0)?;
                    3.0 * std::f64::consts::LN_10 / seconds
                }
                (None, None) => 0.0,
            };
            let amplitude = match (amplitude, level) {
                (Some(amplitude), _) => cell(amplitude, "amplitude", "a finite number would do", |_| true)?,
                (None, Some(level)) => {
                    10.0_f64.powf(cell(level, "level", "decibels would do", |l| l < 400.0)? / 20.0)
                }
                (None, None) => 0.0,
            };
            Ok(Mode {
                frequency_hz: cell(frequency, "frequency", "a frequency above 0 Hz would do", |f| f > 0.0)?,
                decay_per_s,
                amplitude,
                phase_rad: match phase {
                    Some(phase) => cell(phase, "phase", "radians would do", |_| true)?,
                    None => 0.0,
                },
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from_csv(text: &str) -> Result<Vec<Mode>, TableError> {
        let mut rows = text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
        let names = rows.next().unwrap_or_default();
        let rows: Vec<_> = rows.collect();
        let number = |row: &Vec<&str>, i: usize| row[i].parse().unwrap_or(f64::NAN);
        let column = |i: usize| rows.iter().map(|row| number(row, i)).collect();
        from_columns(
            &names.iter().enumerate().map(|(i, name)| (name.to_string(), column(i))).collect::<Vec<_>>(),
        )
    }

    #[test]
    fn modes_survive_csv_to_the_last_bit() {
        let mode = FittedMode {
            frequency_hz: 812.412_345_678_9,
            decay_per_s: 14.1,
            amplitude: 0.3,
            phase_rad: -1.25,
            frequency_std_hz: 1e-4,
            decay_std_per_s: 1e-3,
            amplitude_std: 1e-5,
            phase_std_rad: 1e-5,
            energy: 0.1,
        };
        assert_eq!(from_csv(&to_csv(&[mode, mode])).unwrap(), vec![mode.mode(); 2]);
    }

    #[test]
    fn other_programs_columns_are_understood() {
        let modes = from_csv("op, cf, rt\n-20, 440, 2.0\n").unwrap();
        assert!((modes[0].amplitude - 0.1).abs() < 1e-12 && (modes[0].t60_s() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_row_without_a_decay_says_so() {
        let error = from_csv("frequency_hz,decay_per_s,gain\n440,2,1\n880,,1\n").unwrap_err().to_string();
        assert!(error.contains("row 2") && error.contains("decay that is missing"), "{error}");
    }

    #[test]
    fn bad_tables_are_refused_in_one_line() {
        for text in [
            "",
            "freq\n1\n",
            "freq,t60\n1,2\n",
            "freq,t60,gain\n",
            "freq,t60,gain\n-1,2,3\n",
            "freq,t60,gain\nx,2,3\n",
        ] {
            let error = from_csv(text).unwrap_err().to_string();
            assert!(error.contains("; ") && !error.contains('\n'), "{error}");
        }
    }
}
