//! Recordings and what is known beside them, as files and options say it.

use super::{Options, Unit};
use crate::error::CliError;
use asperity::files::scene_file::probe_of;
use asperity::{ModalModel, Mode};
use asperity_dsp::micro_contact::Probe;
use asperity_fit::FittedMode;
use asperity_fit::recording::Sound;
use asperity_stroke::tool::Ring;
use asperity_stroke::{Quantity, Stroke, Track};
use std::path::{Path, PathBuf};

/// Standard gravity, m/s².
const G_M_S2: f64 = 9.806_65;
/// Impulse of a recorded hit, N·s: that of `fit`.
const HIT_N_S: f64 = 0.01;
/// Longest recording, s.
const LONGEST_S: f64 = 600.0;
/// Axes that one recording may have.
const MOST_AXES: usize = 3;
/// Share by which steps of time may differ.
const UNEVEN: f64 = 0.05;
/// Names under which files hold other things than the recording.
const TIME: &str = "time_s";

/// Probe, and the table of a scene that makes it.
pub(super) struct NamedProbe {
    pub(super) constants: Probe,
    pub(super) table: toml::Table,
}

/// Strokes of all files.
pub(super) struct Recorded {
    pub(super) strokes: Vec<Stroke>,
    pub(super) tangential_n: Option<Vec<f64>>,
}

/// The preset, or the probe of a file.
pub(super) fn probe(name: &str) -> Result<NamedProbe, CliError> {
    let path = Path::new(name);
    let table = if path.extension().is_some_and(|end| end == "toml") {
        let text = std::fs::read_to_string(path).map_err(|error| CliError::read(path, &error))?;
        let table: toml::Table = text
            .parse()
            .map_err(|error: toml::de::Error| CliError::file(path, error.message(), "must be TOML"))?;
        match table.get("probe") {
            Some(toml::Value::Table(probe)) => probe.clone(),
            _ => table,
        }
    } else {
        toml::Table::from_iter([("preset".to_owned(), toml::Value::String(name.to_owned()))])
    };
    let constants = probe_of(table.clone()).map_err(CliError::from_error)?;
    Ok(NamedProbe { constants, table })
}

/// Recorded quantity: sound where a ring is given.
pub(super) fn quantity(options: &Options) -> Result<Quantity, CliError> {
    let Some(path) = &options.ring else {
        return Ok(if options.unit == Some(Unit::Um) {
            Quantity::Displacement
        } else {
            Quantity::Acceleration
        });
    };
    let (modes, impulse_n_s): (Vec<Mode>, f64) = if path.extension().is_some_and(|end| end == "json") {
        let model = ModalModel::load(path).map_err(CliError::from_error)?;
        (model.modes, model.impulse_n_s)
    } else {
        let recording =
            asperity_fit::load(path, asperity_fit::ChannelChoice::default()).map_err(CliError::from_error)?;
        let fit = asperity_fit::fit(&recording, &asperity_fit::FitOptions::default(), &mut |_| ())
            .map_err(CliError::from_error)?;
        (fit.modes.iter().map(FittedMode::mode).collect(), HIT_N_S)
    };
    let for_one = |mode: &Mode| Mode { amplitude: mode.amplitude / impulse_n_s, ..*mode };
    Ok(Quantity::Sound(Ring(modes.iter().map(for_one).collect())))
}

/// The rig's response.
pub(super) fn colour(path: &Path) -> Result<Vec<(f64, f64)>, CliError> {
    let table = Columns::read(path)?;
    let (hz, db) = (table.column("frequency_hz")?, table.column("gain_db")?);
    let rows: Vec<(f64, f64)> = hz.iter().copied().zip(db.iter().copied()).collect();
    if rows.is_empty() || rows.windows(2).any(|pair| pair[0].0 >= pair[1].0) || rows[0].0 <= 0.0 {
        return Err(CliError::file(
            path,
            "frequency_hz does not rise from above 0",
            "write one row a third octave, rising",
        ));
    }
    Ok(rows)
}

/// All recordings.
pub(super) fn strokes(options: &Options) -> Result<Recorded, CliError> {
    let mut recorded = Recorded { strokes: Vec::new(), tangential_n: None };
    let mut files = Vec::new();
    for path in &options.strokes {
        let is_table = path
            .extension()
            .is_some_and(|end| ["csv", "tsv", "txt"].iter().any(|known| end.eq_ignore_ascii_case(known)));
        files.push(if is_table {
            File::Table(path, Columns::read(path)?)
        } else {
            File::Sound(path, sound(path)?)
        });
    }
    for (index, file) in files.iter().enumerate() {
        let speed = track(options.speed.as_deref(), "speed", "m/s", (index, files.len()), file)?;
        let force = track(options.force.as_deref(), "force", "N", (index, files.len()), file)?;
        let (axes, rate_hz) = match file {
            File::Sound(_, (axes, rate_hz)) => (axes.clone(), *rate_hz),
            File::Table(path, table) => (axes(options, path, table)?, rate(options, path, table)?),
        };
        let unit = match options.unit {
            Some(Unit::G) => G_M_S2,
            Some(Unit::Um) => 1e-6,
            _ => 1.0,
        };
        let scaled = |axis: Vec<f64>| axis.into_iter().map(|x| x * unit).collect();
        if let (Some(name), File::Table(_, table)) = (&options.tangential, file) {
            recorded.tangential_n.get_or_insert(table.column(name)?.to_vec());
        }
        // Forth and back is one speed along the path.
        let speed_m_s = match speed {
            Track::Samples(values) => Track::Samples(values.into_iter().map(f64::abs).collect()),
            constant => constant,
        };
        recorded.strokes.push(Stroke {
            axes: axes.into_iter().map(scaled).collect(),
            rate_hz,
            speed_m_s,
            force_n: force,
        });
    }
    Ok(recorded)
}

/// A file that was read.
enum File<'a> {
    Sound(&'a PathBuf, (Vec<Vec<f64>>, f64)),
    Table(&'a PathBuf, Columns),
}

fn sound(path: &Path) -> Result<(Vec<Vec<f64>>, f64), CliError> {
    let first = Sound::load(path, 0, LONGEST_S).map_err(CliError::from_error)?;
    let mut axes = vec![first.samples];
    while axes.len() < MOST_AXES {
        match Sound::load(path, axes.len(), LONGEST_S) {
            Ok(further) => axes.push(further.samples),
            Err(_) => break,
        }
    }
    Ok((axes, first.sample_rate_hz))
}

/// Speed or force: numbers, or a column.
fn track(
    said: Option<&str>,
    what: &'static str,
    unit: &str,
    (index, files): (usize, usize),
    file: &File<'_>,
) -> Result<Track, CliError> {
    let option = format!("--{what}");
    let Some(said) = said else {
        let right = format!("say it in {unit}, or name its column");
        return Err(CliError::new(option, "is missing", right));
    };
    let numbers: Option<Vec<f64>> = said.split(',').map(|part| part.trim().parse().ok()).collect();
    match (numbers, file) {
        (Some(numbers), _) if numbers.len() == files || numbers.len() == 1 => {
            let value = numbers[index.min(numbers.len() - 1)];
            if !(value.is_finite() && value > 0.0) {
                return Err(CliError::new(option, format!("{value} is refused"), "must be above 0"));
            }
            Ok(Track::Constant(value))
        }
        (Some(numbers), _) => {
            let what = format!("has {} values for {files} files", numbers.len());
            Err(CliError::new(option, what, "write one value, or one a file"))
        }
        (None, File::Table(_, table)) => Ok(Track::Samples(table.column(said)?.to_vec())),
        (None, File::Sound(path, _)) => {
            let what = format!("\"{said}\" is no number, and sound has no columns");
            Err(CliError::new(option, what, format!("write it in {unit}")).within(path.display()))
        }
    }
}

/// Columns of the recording.
fn axes(options: &Options, path: &Path, table: &Columns) -> Result<Vec<Vec<f64>>, CliError> {
    if !options.columns.is_empty() {
        return options.columns.iter().map(|name| table.column(name.trim()).map(<[f64]>::to_vec)).collect();
    }
    let other =
        [Some(TIME), options.speed.as_deref(), options.force.as_deref(), options.tangential.as_deref()];
    let free: Vec<usize> =
        (0..table.names.len()).filter(|i| !other.contains(&Some(table.names[*i].as_str()))).collect();
    if free.is_empty() || free.len() > MOST_AXES {
        let what = format!("{} columns could be the recording: {}", free.len(), table.names.join(", "));
        return Err(CliError::file(path, what, "name them with --columns"));
    }
    Ok(free.into_iter().map(|i| table.values[i].clone()).collect())
}

/// Rate of a table, Hz.
fn rate(options: &Options, path: &Path, table: &Columns) -> Result<f64, CliError> {
    let Some(time) = table.names.iter().position(|name| name == TIME).map(|i| &table.values[i]) else {
        return options
            .rate
            .ok_or_else(|| CliError::file(path, "has no column time_s", "add it, or say --rate HZ"));
    };
    let steps = time.windows(2).map(|pair| pair[1] - pair[0]);
    let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    if let Some(row) = steps.clone().position(|step| step.is_nan() || step <= 0.0) {
        let what = format!("time_s does not rise at row {}", row + 2);
        return Err(CliError::file(path, what, "must be in seconds, one row a sample"));
    }
    let uneven = steps.map(|step| (step / mean - 1.0).abs()).fold(0.0, f64::max);
    if uneven > UNEVEN {
        let what = format!("steps of time_s differ by {:.0} %", 100.0 * uneven);
        return Err(CliError::file(path, what, "resample to equal steps"));
    }
    Ok(1.0 / mean)
}

/// A table with a header line.
pub(super) struct Columns {
    path: PathBuf,
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

impl Columns {
    /// Reads commas, semicolons or tabs.
    fn read(path: &Path) -> Result<Self, CliError> {
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

    fn column(&self, name: &str) -> Result<&[f64], CliError> {
        let place = self.names.iter().position(|known| known == name).ok_or_else(|| {
            let what = format!("has no column \"{name}\"");
            CliError::file(&self.path, what, format!("its columns: {}", self.names.join(", ")))
        })?;
        Ok(&self.values[place])
    }
}
