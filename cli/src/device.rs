//! `asperity device SWEEP -o MY.toml`: the profile of an actuator from a recorded sweep.

use crate::columns::{Columns, is_table};
use crate::error::CliError;
use crate::output::{self, Outputs};
use crate::progress::Progress;
use asperity_dsp::actuator::DeviceProfile;
use asperity_fit::device::{Measured, Sweep, measure};
use asperity_fit::recording::Sound;
use clap::Args;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Longest sweep, s.
const LONGEST_S: f64 = 120.0;

/// Make a device profile from a recorded sweep, for `equalise` and `limit` of an actuator
#[derive(Debug, Args)]
pub struct Options {
    /// WAV of two channels, drive ±1 and acceleration in m/s² (32-bit float), or a table with the
    /// columns time_s, drive, acceleration_m_s2
    #[arg(value_name = "SWEEP.(wav|csv)")]
    pub recording: PathBuf,
    /// Profile to write
    #[arg(short, long = "output", value_name = "MY.toml")]
    pub output: PathBuf,
    /// Name of the actuator
    #[arg(long, value_name = "TEXT", default_value = "Measured actuator")]
    pub label: String,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// When the sweep cannot be read or gives no profile, or the profile cannot be written.
pub fn run(options: &Options) -> Result<(), CliError> {
    let path = &options.recording;
    let sweep = if is_table(path) { of_table(path)? } else { of_sound(path)? };
    let progress = Progress::new("measuring", 1);
    let measured = measure(&sweep).map_err(|refused| CliError::file(path, refused.what, refused.right))?;
    drop(progress);
    let mut outputs = Outputs::new();
    outputs.write(&options.output, profile(options, &measured).as_bytes())?;
    outputs.commit()?;
    let Measured { profile, error, lag_s, cut_off } = &measured;
    let report =
        serde_json::json!({ "profile": profile, "error": error, "lag_s": lag_s, "cut_off": cut_off });
    output::say_report(&report, options.json, || {
        format!(
            "{}: {:.2} ± {:.2} Hz, Q {:.2} ± {:.2}, {:.0} to {:.0} Hz, {:.1} % of the samples cut off and left out",
            options.output.display(),
            profile.resonance_hz,
            error.resonance_hz,
            profile.quality,
            error.quality,
            profile.band_hz[0],
            profile.band_hz[1],
            100.0 * cut_off
        )
    })
}

fn of_table(path: &Path) -> Result<Sweep, CliError> {
    let table = Columns::read(path)?;
    let rate_hz = table.rate_hz()?.ok_or_else(|| {
        CliError::file(path, "has no column time_s", "needs time_s, drive, acceleration_m_s2")
    })?;
    let [drive, acceleration_m_s2] =
        [table.column("drive")?, table.column("acceleration_m_s2")?].map(<[f64]>::to_vec);
    if drive.len() as f64 > LONGEST_S * rate_hz {
        return Err(CliError::file(path, "lasts too long", format!("must last {LONGEST_S} s at most")));
    }
    Ok(Sweep { rate_hz, drive, acceleration_m_s2 })
}

fn of_sound(path: &Path) -> Result<Sweep, CliError> {
    let channel = |index| Sound::load(path, index, LONGEST_S).map_err(CliError::from_error);
    let drive = channel(0)?;
    if Sound::load(path, 1, LONGEST_S).is_err() {
        return Err(CliError::file(path, "has one channel", "must hold two: drive and acceleration"));
    }
    if Sound::load(path, 2, LONGEST_S).is_ok() {
        return Err(CliError::file(path, "has more than two channels", "must hold drive and acceleration"));
    }
    Ok(Sweep { rate_hz: drive.sample_rate_hz, drive: drive.samples, acceleration_m_s2: channel(1)?.samples })
}

/// Text of the profile.
fn profile(options: &Options, measured: &Measured) -> String {
    let name = options.recording.file_name().unwrap_or_default().to_string_lossy();
    let quoted = |text: &str| toml::Value::from(text).to_string();
    let mut text = format!("label = {}\n", quoted(&options.label));
    numbers(&mut text, &measured.profile);
    text += "\n# One standard error of each; inf: assumed.\n[error]\n";
    numbers(&mut text, &measured.error);
    text += "\n[source]\n";
    let by_fit = format!("fitted to the sweep {name}");
    for (key, source) in [
        ("resonance_hz", by_fit.as_str()),
        ("quality", &by_fit),
        ("felt_at_resonance_m", &by_fit),
        ("excursion_m", "largest felt motion of that sweep: what it was driven to, not its stop"),
        ("band_hz", "where the sweep departs by 1 dB at most from what was fitted"),
        ("rated_drive", "assumed: a full-scale sine may be held"),
        ("thermal_time_s", "assumed"),
    ] {
        let _ = writeln!(text, "{key} = {}", quoted(source));
    }
    text
}

fn numbers(text: &mut String, profile: &DeviceProfile) {
    let DeviceProfile {
        resonance_hz,
        quality,
        felt_at_resonance_m,
        excursion_m,
        band_hz: [low_hz, high_hz],
        rated_drive,
        thermal_time_s,
    } = profile;
    let _ = writeln!(
        text,
        "resonance_hz = {resonance_hz:?}\nquality = {quality:?}\nfelt_at_resonance_m = {felt_at_resonance_m:?}\n\
         excursion_m = {excursion_m:?}\nband_hz = [{low_hz:?}, {high_hz:?}]\nrated_drive = {rated_drive:?}\n\
         thermal_time_s = {thermal_time_s:?}"
    );
}
