//! Recorded samples as tables of text: a header line, a row a sample.

use crate::error::CliError;
use crate::paths::has_end;
use std::path::{Path, PathBuf};

/// Name of the column of times, s.
pub const TIME: &str = "time_s";
/// Share by which steps of time may differ.
const UNEVEN: f64 = 0.05;

/// Tests whether a file is a table by its ending.
#[must_use]
pub fn is_table(path: &Path) -> bool {
    has_end(path, &["csv", "tsv", "txt"])
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
    /// Reads commas, semicolons or tabs.
    ///
    /// # Errors
    /// When the file cannot be read or is no table of numbers.
    pub fn read(path: &Path) -> Result<Self, CliError> {
        let text = std::fs::read(path).map_err(|error| CliError::read(path, &error))?;
        let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
        let header = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let delimiter = [b';', b'\t', b','].into_iter().find(|d| header.contains(d)).unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text);
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
        for row in 0u64.. {
            if !reader.read_record(&mut record).map_err(refused)? {
                break;
            }
            for (column, field) in record.iter().enumerate() {
                let number: f64 = field.parse().map_err(|_| {
                    let what = format!("line {}: {}: \"{field}\" is no number", row + 2, names[column]);
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

    /// Rate of the rows, Hz; none without a column `time_s`.
    ///
    /// # Errors
    /// When its times do not rise evenly.
    pub fn rate_hz(&self) -> Result<Option<f64>, CliError> {
        let Some(time) = self.names.iter().position(|name| name == TIME).map(|i| &self.values[i]) else {
            return Ok(None);
        };
        let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
        let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
        if let Some(row) = steps.clone().position(|step| step.is_nan() || step <= 0.0) {
            let what = format!("time_s does not rise at row {}", row + 2);
            return Err(CliError::file(&self.path, what, "must be in seconds, one row a sample"));
        }
        let uneven = steps.map(|step| (step / mean - 1.0).abs()).fold(0.0, f64::max);
        if uneven > UNEVEN {
            let what = format!("steps of time_s differ by {:.0} %", 100.0 * uneven);
            return Err(CliError::file(&self.path, what, "resample to equal steps"));
        }
        Ok(Some(1.0 / mean))
    }
}
