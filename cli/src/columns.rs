//! Recorded samples as tables of text: a header line, a row a sample.

use crate::error::CliError;
use crate::paths::has_end;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Names of the column of times, s, in small letters.
const TIMES: [&str; 6] = ["time_s", "time", "t", "t_s", "time (s)", "time [s]"];
/// Share by which steps of time may differ.
const UNEVEN: f64 = 0.05;

/// Tests whether a file is a table by its ending.
#[must_use]
pub fn is_table(path: &Path) -> bool {
    has_end(path, &["csv", "tsv", "txt"])
}

/// Tests whether a column holds times by its name.
#[must_use]
pub fn is_time(name: &str) -> bool {
    TIMES.contains(&name.to_lowercase().as_str())
}

/// A table with a header line: names and numbers of its columns.
#[derive(Debug)]
pub struct Columns {
    path: PathBuf,
    /// Names of the columns.
    pub names: Vec<String>,
    /// Numbers of each.
    pub values: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads columns parted by commas, semicolons, tabs or spaces, decimal commas where no comma
    /// parts them.
    ///
    /// # Errors
    /// When the file cannot be read or is no table of numbers.
    pub fn read(path: &Path) -> Result<Self, CliError> {
        let bytes = std::fs::read(path).map_err(|error| CliError::read(path, &error))?;
        let text = str::from_utf8(&bytes)
            .map_err(|_| CliError::file(path, "is no text in UTF-8", "save it as CSV in UTF-8"))?;
        let text = text.trim_start_matches('\u{feff}');
        let header = text.lines().find(|line| !line.starts_with('#')).unwrap_or_default().trim();
        let delimiter = [';', '\t', ','].into_iter().find(|d| header.contains(*d));
        let spaced = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(";");
        let (text, delimiter) = match delimiter {
            None if header.contains(' ') => {
                (Cow::Owned(text.lines().map(spaced).collect::<Vec<_>>().join("\n")), b';')
            }
            found => (Cow::Borrowed(text), found.map_or(b',', |d| d as u8)),
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let refused = |error: csv::Error| CliError::file(path, error, "must be a table with a header line");
        let names: Vec<String> = reader.headers().map_err(refused)?.iter().map(str::to_owned).collect();
        if names.iter().any(|name| name.parse::<f64>().is_ok()) {
            return Err(CliError::file(
                path,
                "begins with numbers",
                "must begin with a header line that names the columns",
            ));
        }
        let mut values = vec![Vec::new(); names.len()];
        let mut record = csv::StringRecord::new();
        while reader.read_record(&mut record).map_err(refused)? {
            for (column, field) in record.iter().enumerate() {
                let decimal =
                    if delimiter == b',' { Cow::from(field) } else { field.replace(',', ".").into() };
                let number: f64 = decimal.parse().map_err(|_| {
                    let line = record.position().map_or(0, csv::Position::line);
                    let what = format!("line {line}: {}: \"{field}\" is no number", names[column]);
                    CliError::file(path, what, "must be a number in every row")
                })?;
                values[column].push(number);
            }
        }
        if values.first().is_none_or(|first| first.len() < 2) {
            return Err(CliError::file(path, "holds no rows", "must hold one row a sample"));
        }
        Ok(Self { path: path.to_owned(), names, values })
    }

    /// Numbers of a column.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn column(&self, name: &str) -> Result<&[f64], CliError> {
        let place = self.names.iter().position(|known| known == name).ok_or_else(|| {
            let what = format!("has no column \"{name}\"");
            CliError::file(&self.path, what, format!("its columns: {}", self.names.join(", ")))
        })?;
        Ok(&self.values[place])
    }

    /// Rate of the rows, Hz; none without a column of times.
    ///
    /// # Errors
    /// When its times do not rise evenly.
    pub fn rate_hz(&self) -> Result<Option<f64>, CliError> {
        let Some(time) = self.names.iter().position(|name| is_time(name)).map(|i| &self.values[i]) else {
            return Ok(None);
        };
        let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
        let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
        if let Some(row) = steps.clone().position(|step| step.is_nan() || step <= 0.0) {
            let what = format!("time does not rise at row {}", row + 2);
            return Err(CliError::file(&self.path, what, "must be in seconds, one row a sample"));
        }
        let uneven = steps.map(|step| (step / mean - 1.0).abs()).fold(0.0, f64::max);
        if uneven > UNEVEN {
            let what = format!("steps of time differ by {:.0} %", 100.0 * uneven);
            return Err(CliError::file(&self.path, what, "resample to equal steps"));
        }
        Ok(Some(1.0 / mean))
    }
}
