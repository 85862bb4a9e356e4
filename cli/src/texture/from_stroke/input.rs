//! Recordings and what is known beside them, as files and options say it.

use super::{Options, Unit};
use crate::columns::{Columns, is_table, is_time};
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
/// Pressing force above which numbers are more likely grams, N.
const HARDEST_N: f64 = 50.0;
/// Axes that one recording may have.
const MOST_AXES: usize = 3;

/// Probe, and the table of a scene that makes it.
pub(super) struct NamedProbe {
    pub(super) constants: Probe,
    pub(super) table: toml::Table,
}

/// Strokes of all files.
pub(super) struct Recorded {
    pub(super) strokes: Vec<Stroke>,
    pub(super) tangential_n: Option<Vec<f64>>,
    /// Remarks on how files were read.
    pub(super) remarks: Vec<String>,
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
    let mut recorded = Recorded { strokes: Vec::new(), tangential_n: None, remarks: Vec::new() };
    let mut files = Vec::new();
    for path in &options.strokes {
        files.push(if is_table(path) {
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
            File::Table(path, table) => {
                (axes(options, path, table, &mut recorded.remarks)?, rate(options, path, table)?)
            }
        };
        if options.unit.is_none() && options.ring.is_none() && (0.9..1.1).contains(&pull(&axes)) {
            recorded
                .remarks
                .push("the mean of the three axes is 1, as gravity's is in g (--unit g)".to_owned());
        }
        let mean_n = force.mean(0, axes[0].len());
        if mean_n > HARDEST_N {
            recorded
                .remarks
                .push(format!("a mean force of {mean_n:.0} N: forces are read as N (1 N presses as 102 g)"));
        }
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

/// Length of the mean of three axes; 0 of fewer, which tell no direction.
fn pull(axes: &[Vec<f64>]) -> f64 {
    let mean = |axis: &Vec<f64>| axis.iter().sum::<f64>() / axis.len().max(1) as f64;
    if axes.len() < MOST_AXES { 0.0 } else { axes.iter().map(|axis| mean(axis).powi(2)).sum::<f64>().sqrt() }
}

/// Columns of the recording.
fn axes(
    options: &Options,
    path: &Path,
    table: &Columns,
    remarks: &mut Vec<String>,
) -> Result<Vec<Vec<f64>>, CliError> {
    if !options.columns.is_empty() {
        return options.columns.iter().map(|name| table.column(name.trim()).map(<[f64]>::to_vec)).collect();
    }
    let other = [&options.speed, &options.force, &options.tangential].map(Option::as_deref);
    let names = table.names.iter().map(String::as_str).enumerate();
    let free: Vec<(usize, &str)> =
        names.filter(|(_, name)| !is_time(name) && !other.contains(&Some(*name))).collect();
    if free.is_empty() || free.len() > MOST_AXES {
        let what = format!("{} columns could be the recording: {}", free.len(), table.names.join(", "));
        return Err(CliError::file(path, what, "name them with --columns"));
    }
    if free.len() > 1 {
        let names = free.iter().map(|(_, name)| *name).collect::<Vec<_>>().join(", ");
        remarks.push(format!("{names}: axes of one recording, folded by power (--columns names others)"));
    }
    Ok(free.into_iter().map(|(i, _)| table.values[i].clone()).collect())
}

/// Rate of a table, Hz.
fn rate(options: &Options, path: &Path, table: &Columns) -> Result<f64, CliError> {
    let (own, given) = (table.rate_hz()?, options.rate);
    if let (Some(own), Some(given)) = (own, given)
        && (own / given - 1.0).abs() > 0.05
    {
        let what = format!("its times say {own:.4} Hz, --rate {given} Hz");
        return Err(CliError::file(
            path,
            what,
            "times must be in seconds; leave out --rate, or name the columns",
        ));
    }
    own.or(given).ok_or_else(|| CliError::file(path, "has no column time_s", "add it, or say --rate HZ"))
}
