//! `asperity fit`: one recorded impact becomes a body that rings.
//!
//! | file | what |
//! |---|---|
//! | [`import`] | tables of other programs, in the recording's place |
//! | [`modes_file`] | `NAME.modes.json` with standard deviations and the residual's summary |
//! | [`options`] | what can be asked for |
//! | [`picture`] | waves and spectrograms of recording, struck body and what is left |
//! | [`places`] | where the merged strikes were made on a body with shapes |
//! | [`report`] | what `--json` and the terminal say |

mod columns;
mod import;
mod modes_file;
mod options;
mod picture;
mod places;
mod report;

pub use options::Options;
pub use report::Report;

use crate::error::CliError;
use crate::output::{self, Outputs, check_destination};
use crate::progress::Progress;
use crate::wav;
use asperity_dsp::diffuse::DiffuseBand;
use asperity_dsp::mode::Mode;
use asperity_fit::after::scaling::{DampingLaw, rescale_bands, scale_size, transfer_damping};
use asperity_fit::after::strikes::{Merged, merge};
use asperity_fit::after::table;
use asperity_fit::body::residual::Burst;
use asperity_fit::{ChannelChoice, Fit, Recording};
use places::PlacesReport;
use report::TableReport;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Steps of the progress bar.
const STEPS: u64 = 200;

/// Runs the verb.
///
/// # Errors
/// When the recording cannot be read or fitted, an option is out of range, or a file cannot be
/// written.
pub fn run(options: &Options) -> Result<(), CliError> {
    if import::is_table(&options.recording) {
        let report = import_table(options)?;
        return output::say_report(&report, options.json, || report.in_words(options));
    }
    let report = fit(options)?;
    output::say_report(&report, options.json, || report.in_words(options))
}

/// Fits and writes the files; the report is what `--json` prints.
///
/// # Errors
/// As [`run`].
pub fn fit(options: &Options) -> Result<Report, CliError> {
    let started = Instant::now();
    check_options(options)?;
    let channel = channel(&options.channel)?;
    let (recording, fit) = fitted(&options.recording, channel, options)?;
    let law = material(options)?;
    let changed = |modes: &[Mode]| changed(options, law.as_ref(), modes);
    let mut outputs = Outputs::new();
    let plain: Vec<Mode> = fit.modes.iter().map(asperity_fit::FittedMode::mode).collect();
    let burst = options.burst_ms.map(|ms| fit.burst(1e-3 * ms));
    let mut bands = if options.bands { fit.diffuse() } else { Vec::new() };
    if let Some(path) = &options.plot {
        let svg = picture::svg(&recording, &fit, burst.as_ref(), &bands);
        let svg = svg.map_err(|refused| CliError::from_error(refused).within(path.display()))?;
        outputs.write(path, svg.as_bytes())?;
    }
    rescale_bands(&mut bands, &plain, options.scale_size.unwrap_or(1.0), law.as_ref());
    let (mut places, mut several) = (None, None);
    if options.others().next().is_none() {
        let body = modes_file::Body::fitted(&fit, &changed(&plain), options.impulse);
        let body = body.with_burst(burst).with_bands(&bands);
        modes_file::write(&mut outputs, &options.output, &body)?;
    } else {
        let first = First { recording: &recording, fit: &fit, burst, bands: &bands };
        let (merged, others) = write_strikes(&mut outputs, options, channel, first, &changed)?;
        let recordings: Vec<&Path> =
            std::iter::once(&options.recording).chain(options.others()).map(PathBuf::as_path).collect();
        let mesh = options.mesh.as_deref();
        places = mesh.map(|mesh| PlacesReport::new(mesh, &merged, &recordings)).transpose()?;
        several = Some((merged.strikes[0].len(), others));
    }
    if let Some(path) = &options.csv {
        outputs.write(path, table::to_csv(&fit.modes).as_bytes())?;
    }
    if let Some(path) = &options.residual {
        write_samples(&mut outputs, path, &fit.residual.samples, fit.sample_rate_hz)?;
    }
    if let Some(path) = &options.resynthesis {
        write_samples(&mut outputs, path, &fit.resynthesis(), fit.sample_rate_hz)?;
    }
    outputs.commit()?;
    let mut report = Report::new(&fit, DampingLaw::of(&plain), started.elapsed().as_secs_f64());
    report.places = places;
    if let Some((modes, others)) = several {
        report.modes = modes;
        options.others().zip(&others).for_each(|(path, fit)| report.warn_of(path, fit));
    }
    Ok(report)
}

/// Modes of another size or material, as the options say.
fn changed(options: &Options, law: Option<&DampingLaw>, modes: &[Mode]) -> Vec<Mode> {
    let sized = options.scale_size.map_or_else(|| modes.to_vec(), |size| scale_size(modes, size));
    law.map_or_else(|| sized.clone(), |law| transfer_damping(&sized, law))
}

/// Turns a table into a modes file.
fn import_table(options: &Options) -> Result<TableReport, CliError> {
    check_options(options)?;
    let of_recording = [
        ("--residual", options.residual.is_some()),
        ("--resynthesis", options.resynthesis.is_some()),
        ("--plot", options.plot.is_some()),
        ("--merge", !options.merge.is_empty()),
        ("--family", options.family),
        ("--burst-ms", options.burst_ms.is_some()),
        ("--bands", options.bands),
        ("--strike", options.strike.is_some()),
    ];
    if let Some((option, _)) = of_recording.into_iter().find(|(_, given)| *given) {
        return Err(CliError::new(option, "a table has no sound", "leave it out, or name a recording"));
    }
    let missing = import::Missing {
        entry: options.entry.clone(),
        base_hz: options.base_hz,
        t60_s: options.t60,
        table_rate_hz: options.table_rate,
    };
    let mut table = import::read(&options.recording, &missing)?;
    let law = material(options)?;
    table.modes = changed(options, law.as_ref(), &table.modes);
    let source = options.recording.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let mut outputs = Outputs::new();
    let impulse_n_s = table.impulse_n_s.unwrap_or(options.impulse);
    let body = modes_file::Body::plain(&source, &table.modes, impulse_n_s).with_positions(&table.positions);
    modes_file::write(&mut outputs, &options.output, &body)?;
    if let Some(path) = &options.csv {
        outputs.write(path, table::modes_to_csv(&table.modes).as_bytes())?;
    }
    outputs.commit()?;
    Ok(TableReport::new(&table.modes, table.positions.len(), table.warnings))
}

/// Refuses what cannot work before the work.
fn check_options(options: &Options) -> Result<(), CliError> {
    let positive = |name: &str, value: f64| {
        if value.is_finite() && value > 0.0 {
            Ok(())
        } else {
            Err(CliError::new(name, format!("{value} is refused"), "must be a number above 0"))
        }
    };
    positive("--impulse", options.impulse)?;
    options.scale_size.map_or(Ok(()), |size| positive("--scale-size", size))?;
    options.base_hz.map_or(Ok(()), |hz| positive("--base-hz", hz))?;
    options.t60.map_or(Ok(()), |seconds| positive("--t60", seconds))?;
    positive("--table-rate", options.table_rate)?;
    let longest_ms = 1e3 * asperity::LONGEST_RESIDUAL_S;
    if let Some(ms) = options.burst_ms.filter(|ms| !(*ms > 0.0 && *ms <= longest_ms)) {
        let right = format!("must be above 0 and at most {longest_ms} ms");
        return Err(CliError::new("--burst-ms", format!("{ms} is refused"), right));
    }
    let others = options.others().count();
    if others >= asperity::MAX_POSITIONS {
        let right = format!("at most {} more strikes fit a body", asperity::MAX_POSITIONS - 1);
        let option = if options.family { "--family" } else { "--merge" };
        return Err(CliError::new(option, format!("{others} are too many"), right));
    }
    check_destination(&options.output)?;
    for path in [&options.residual, &options.resynthesis, &options.plot, &options.csv].into_iter().flatten() {
        check_destination(path)?;
    }
    Ok(())
}

fn channel(text: &str) -> Result<ChannelChoice, CliError> {
    match text {
        "loudest" => Ok(ChannelChoice::Loudest),
        "mix" => Ok(ChannelChoice::Mix),
        number => number.parse().map(ChannelChoice::Index).map_err(|_| {
            CliError::new(
                "--channel",
                format!("{text} is refused"),
                "must be loudest, mix or a number from 0",
            )
        }),
    }
}

fn fitted(path: &Path, channel: ChannelChoice, options: &Options) -> Result<(Recording, Fit), CliError> {
    let recording = asperity_fit::load(path, channel).map_err(CliError::from_error)?;
    let mut progress = Progress::new("fitting", STEPS);
    let fit = asperity_fit::fit(&recording, &options.fit_options(), &mut |done| progress.reach(done))
        .map_err(CliError::from_error)?;
    Ok((recording, fit))
}

/// The damping law to give the body.
fn material(options: &Options) -> Result<Option<DampingLaw>, CliError> {
    let Some(text) = &options.material else { return Ok(None) };
    if let Some((alpha, beta)) = text.split_once(',')
        && let (Ok(alpha_per_s), Ok(beta_s)) = (alpha.trim().parse::<f64>(), beta.trim().parse::<f64>())
    {
        let fine = alpha_per_s >= 0.0 && beta_s >= 0.0 && alpha_per_s + beta_s > 0.0;
        if fine && alpha_per_s.is_finite() && beta_s.is_finite() {
            return Ok(Some(DampingLaw { alpha_per_s, beta_s }));
        }
        return Err(CliError::new(
            "--material",
            format!("{text} is refused"),
            "α and β must be at or above 0, not both 0",
        ));
    }
    let path = Path::new(text);
    let model = asperity::ModalModel::load(path).map_err(CliError::from_error)?;
    DampingLaw::of(&model.modes).map(Some).ok_or_else(|| {
        CliError::file(path, "has no damped mode to learn a law from", "name a modes file with damped modes")
    })
}

/// The first strike of several, and what the body has of it besides modes.
struct First<'a> {
    recording: &'a Recording,
    fit: &'a Fit,
    burst: Option<Burst>,
    bands: &'a [DiffuseBand],
}

/// Several strikes: one body with a strike position each, and `OUT.strike0.modes.json` and so on;
/// returns the fits of all but the first as well.
fn write_strikes(
    outputs: &mut Outputs,
    options: &Options,
    channel: ChannelChoice,
    first: First<'_>,
    changed: &dyn Fn(&[Mode]) -> Vec<Mode>,
) -> Result<(Merged, Vec<Fit>), CliError> {
    let First { recording, fit, burst, bands } = first;
    let others =
        options.others().map(|path| fitted(path, channel, options)).collect::<Result<Vec<_>, CliError>>()?;
    let strikes: Vec<(&Recording, &Fit)> =
        std::iter::once((recording, fit)).chain(others.iter().map(|(r, f)| (r, f))).collect();
    let merged = merge(&strikes);
    let body = modes_file::Body::plain(&fit.source, &changed(&merged.strikes[0]), options.impulse)
        .with_positions(&merged.positions())
        .of_takes(options.family)
        .with_burst(burst)
        .with_bands(bands);
    modes_file::write(outputs, &options.output, &body)?;
    for (s, modes) in merged.strikes.iter().enumerate() {
        let name = options.output.to_string_lossy();
        let stem = name.strip_suffix(".modes.json").unwrap_or(&name);
        let path = PathBuf::from(format!("{stem}.strike{s}.modes.json"));
        let body = modes_file::Body::plain(&strikes[s].1.source, &changed(modes), options.impulse);
        modes_file::write(outputs, &path, &body)?;
    }
    Ok((merged, others.into_iter().map(|(_, fit)| fit).collect()))
}

fn write_samples(outputs: &mut Outputs, path: &Path, samples: &[f64], rate_hz: f64) -> Result<(), CliError> {
    let samples: Vec<f32> = samples.iter().map(|&x| x as f32).collect();
    wav::write(outputs, path, &[&samples], rate_hz)
}
