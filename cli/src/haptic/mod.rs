//! `asperity haptic`: from a waveform to what hardware plays, and between its formats.

mod input;
mod picture;
mod port;

use crate::error::CliError;
use crate::output::{self, Outputs, check_destination};
use crate::progress::Progress;
use asperity_ports::score::{Reference, Score};
use asperity_ports::{Clip, Device, felt, oscillator, reduction, resample};
use clap::Args;
use input::Input;
pub use input::strokes_s;
use port::Port;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Steps of the progress bar.
const STEPS: u64 = 200;
/// A clip whose peak lies below this is hardly felt on most devices.
const FAINT: f64 = 0.05;

/// Turn a vibration into what phones, headsets and pads play, or one such file into another
#[derive(Debug, Args)]
pub struct Options {
    /// Samples of displacement, a scene with its contact log, or a clip
    #[arg(value_name = "IN.(wav|flac|ogg|toml|haptic|ahap|hjif)")]
    pub input: PathBuf,
    /// Way of writing: an envelope of two curves, a waveform in few points, or samples of what is
    /// left
    #[arg(short, long = "output", value_name = "OUT.(haptic|ahap|hjif|android.json|pcm.wav|wav)")]
    pub output: PathBuf,
    #[command(flatten)]
    pub port: PortOptions,
    /// Channel of the WAV file or of the clip, actuator of the scene, from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub channel: usize,
    /// Scores the distance between what is left and what was
    #[arg(long)]
    pub score: bool,
    /// Picture of what was and of what is left
    #[arg(long, value_name = "OUT.svg")]
    pub plot: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Settings of a port.
#[derive(Debug, Args)]
pub struct PortOptions {
    /// Device that plays it: quest, console, iphone, lra-170, or a profile (TOML, or an actuator
    /// configuration)
    #[arg(long, value_name = "NAME|FILE", default_value = "quest")]
    pub device: String,
    /// Most envelope points a second
    #[arg(long, value_name = "HZ")]
    pub points: Option<f64>,
    /// Bring the peak to 1 even where it lies below
    #[arg(long)]
    pub normalise: bool,
    /// Sound that an .ahap plays in step: its path beside the file
    #[arg(long, value_name = "SOUND.wav")]
    pub sound: Option<String>,
}

/// The object of `--json`.
#[derive(Debug, Serialize)]
struct Report {
    duration_s: f64,
    points: usize,
    gain: f64,
    device: String,
    band_hz: [f64; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    way: Option<&'static str>,
    #[serde(flatten)]
    score: Option<Score>,
    warnings: Vec<String>,
    files: Vec<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// When the input is none of the formats or breaks one's rules, an option is out of range, or a
/// file cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let port = Port::of(&options.output)?;
    check_destination(&options.output)?;
    options.plot.as_deref().map_or(Ok(()), check_destination)?;
    if let Some(points) = options.port.points.filter(|hz| !(1.0..=4000.0).contains(hz)) {
        return Err(CliError::new("--points", format!("{points} is refused"), "must be 1 to 4000 Hz"));
    }
    if let Some(sound) = &options.port.sound {
        let beside = options.output.parent().unwrap_or(Path::new("")).join(sound);
        if !beside.is_file() {
            let right = format!("name it as seen from {}", options.output.display());
            return Err(CliError::new("--sound", format!("{} is not there", beside.display()), right));
        }
    }
    let device = device(&options.port.device)?;
    let input = input::read(&options.input, options.channel, &device)?;
    let mut outputs = Outputs::new();
    let made = made(input, &port, &options.output, &device, &options.port, &mut outputs)?;
    let score = options.score.then(|| Reference::new(&made.original, device.band_hz).score(&made.left));
    if let Some(path) = &options.plot {
        let title = format!("{}, as it was and as left for: {}", name_of(&options.input), device.label);
        outputs.write(path, picture::svg(&title, &made, &device).as_bytes())?;
    }
    let report = Report {
        duration_s: made.duration_s,
        points: made.points,
        gain: made.gain,
        device: device.label.clone(),
        band_hz: device.band_hz,
        way: made.way,
        score,
        warnings: made.warnings,
        files: outputs.commit()?,
    };
    output::say_report(&report, options.json, || in_words(&report, &options.output))
}

/// Writes the haptic channel of a render as a port; what `render --port` does.
///
/// # Errors
/// As [`run`].
pub fn write_port(
    samples: Vec<f64>,
    rate_hz: f64,
    strokes_s: Vec<f64>,
    path: &Path,
    outputs: &mut Outputs,
) -> Result<Vec<String>, CliError> {
    let port = Port::of(path)?;
    let device = Device::quest();
    let plain = PortOptions { device: "quest".to_owned(), points: None, normalise: false, sound: None };
    let input = Input::Samples { samples, rate_hz, strokes_s, remarks: Vec::new(), source: name_of(path) };
    Ok(made(input, &port, path, &device, &plain, outputs)?.warnings)
}

/// Result, and both signals at 8 kHz.
struct Made {
    duration_s: f64,
    points: usize,
    gain: f64,
    way: Option<&'static str>,
    original: Vec<f64>,
    left: Vec<f64>,
    clip: Option<Clip>,
    warnings: Vec<String>,
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn device(name: &str) -> Result<Device, CliError> {
    if let Some(device) = Device::shipped(name) {
        return Ok(device);
    }
    let path = Path::new(name);
    let text = std::fs::read_to_string(path).map_err(|error| {
        let right = format!("must be one of {}, or a profile's file", Device::NAMES.join(", "));
        CliError::new("--device", format!("{name} cannot be read ({error})"), right)
    })?;
    Device::parse(&text).map_err(|error| CliError::from_error(error.within(name)))
}

fn made(
    input: Input,
    port: &Port,
    path: &Path,
    device: &Device,
    options: &PortOptions,
    outputs: &mut Outputs,
) -> Result<Made, CliError> {
    match input {
        Input::Clip { clip, remarks } => {
            let left = oscillator::rendered(&clip, device, felt::RATE_HZ);
            let mut made = Made {
                duration_s: clip.duration_s(),
                points: clip.amplitude.len(),
                gain: 1.0,
                way: None,
                original: left.clone(),
                left,
                clip: None,
                warnings: remarks,
            };
            if port.is_waveform() {
                port.write_samples(&mut made, felt::RATE_HZ, path, device, options, outputs)?;
            } else {
                port.write_clip(&clip, path, device, options, outputs)?;
                made.clip = Some(clip);
            }
            Ok(made)
        }
        Input::Samples { samples, rate_hz, strokes_s, remarks, source } => {
            if port.is_waveform() {
                let mut made = whole(samples, rate_hz, remarks, options)
                    .map_err(|e| CliError::from_error(e.within(&source)))?;
                port.write_samples(&mut made, felt::RATE_HZ, path, device, options, outputs)?;
                return Ok(made);
            }
            reduced(&samples, rate_hz, strokes_s, remarks, &source, port, path, device, options, outputs)
        }
    }
}

/// Samples at 8 kHz with the gain that makes them fit ±1.
fn whole(
    samples: Vec<f64>,
    rate_hz: f64,
    remarks: Vec<String>,
    options: &PortOptions,
) -> Result<Made, asperity_ports::PortError> {
    let mut original = reduction::checked(&samples, rate_hz)?;
    let peak = original.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let gain = if peak > 1.0 || (options.normalise && peak > 0.0) { 1.0 / peak } else { 1.0 };
    original.iter_mut().for_each(|x| *x = (*x * gain).clamp(-1.0, 1.0));
    Ok(Made {
        duration_s: samples.len() as f64 / rate_hz,
        points: 0,
        gain,
        way: None,
        left: original.clone(),
        original,
        clip: None,
        warnings: remarks,
    })
}

#[allow(clippy::too_many_arguments)]
fn reduced(
    samples: &[f64],
    rate_hz: f64,
    strokes_s: Vec<f64>,
    remarks: Vec<String>,
    source: &str,
    port: &Port,
    path: &Path,
    device: &Device,
    options: &PortOptions,
    outputs: &mut Outputs,
) -> Result<Made, CliError> {
    let mut progress = Progress::new("reducing", STEPS);
    let about = asperity_ports::clip::About {
        editor: format!("asperity {}", env!("CARGO_PKG_VERSION")),
        source: source.to_owned(),
        ..Default::default()
    };
    let settings = reduction::Options {
        points_per_s: options.points.or(Some(device.points_per_s.min(250.0))),
        strokes_s,
        normalise: options.normalise,
        way: None,
        about,
    };
    let reduction = reduction::reduce(samples, rate_hz, device, &settings, &mut |done| progress.reach(done))
        .map_err(|error| CliError::from_error(error.within(source)))?;
    drop(progress);
    let mut warnings = remarks;
    let peak = reduction.clip.amplitude.iter().map(|p| p.amplitude).fold(0.0, f64::max);
    if peak == 0.0 {
        warnings.push("nothing is felt in it: every sample is 0".to_owned());
    } else if peak < FAINT {
        warnings.push(format!(
            "the clip's peak is {peak:.2e} of what the device can; --normalise brings it to 1"
        ));
    }
    if *port == Port::Wav {
        port.write_left(&reduction.left, felt::RATE_HZ, path, outputs)?;
    } else {
        port.write_clip(&reduction.clip, path, device, options, outputs)?;
    }
    Ok(Made {
        duration_s: reduction.clip.duration_s(),
        points: reduction.clip.amplitude.len(),
        gain: reduction.gain,
        way: Some(reduction.way.name()),
        original: reduction.original,
        left: reduction.left,
        clip: Some(reduction.clip),
        warnings,
    })
}

/// To the device's own rate.
fn at_rate(samples: &[f64], rate_hz: f64) -> Vec<f64> {
    resample::resampled(samples, felt::RATE_HZ, rate_hz)
}

fn in_words(report: &Report, path: &Path) -> String {
    let score = report.score.map_or(String::new(), |score| {
        format!(
            "\nwhat is left: third octaves in band off by {:.1} dB, balance {:.1} dB, level {} dB, envelope {:.3}",
            score.in_band_error_db,
            score.balance_db,
            asperity_plot::decibels(score.level_bias_db),
            score.envelope_correlation
        )
    });
    format!(
        "{}: {:.2} s, {} points, gain {:.3}, for {} ({} to {} Hz){score}{}",
        path.display(),
        report.duration_s,
        report.points,
        report.gain,
        report.device,
        report.band_hz[0],
        report.band_hz[1],
        output::warned(&report.warnings)
    )
}
