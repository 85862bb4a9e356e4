//! Fits, by this build or by another one's program.

use asperity_dsp::mode::Mode;
use asperity_evidence::process::cpu_seconds;
use asperity_fit::{ChannelChoice, FitOptions, FittedMode, fit, load};
use serde_json::Value;
use std::process::Command;

/// What is scored.
pub struct Fitted {
    pub cpu_s: f64,
    pub modes: Vec<Mode>,
    pub burst: Vec<f32>,
    pub onset_s: f64,
    pub end_s: f64,
    pub told_snr_db: f64,
    pub warnings: Vec<String>,
}

/// The fit of this build, one thread.
pub fn in_process(path: &str, burst_s: f64) -> Result<Fitted, String> {
    let recording = load(path, ChannelChoice::Loudest).map_err(|error| error.to_string())?;
    let clock = cpu_seconds();
    let options = FitOptions { threads: 1, ..FitOptions::default() };
    let fit = fit(&recording, &options, &mut |_| {}).map_err(|error| error.to_string())?;
    Ok(Fitted {
        cpu_s: cpu_seconds() - clock,
        modes: fit.modes.iter().map(FittedMode::mode).collect(),
        burst: fit.burst(burst_s).samples.iter().map(|&x| x as f32).collect(),
        onset_s: fit.onset_s,
        end_s: fit.end_s,
        told_snr_db: fit.snr_from_onset_db,
        warnings: fit.warnings.iter().map(ToString::to_string).collect(),
    })
}

/// The fit of a program `asperity`.
pub fn by_program(program: &str, path: &str, burst_s: f64) -> Result<Fitted, String> {
    let out = std::env::temp_dir().join(format!("asperity-struck-{}.modes.json", std::process::id()));
    let burst_ms = format!("{}", 1e3 * burst_s);
    let began = children_s();
    let run = Command::new(program)
        .args(["fit", path, "--json", "--burst-ms", &burst_ms, "-o"])
        .arg(&out)
        .output()
        .map_err(|error| format!("{program}: {error}"))?;
    let cpu_s = children_s() - began;
    if !run.status.success() {
        return Err(String::from_utf8_lossy(&run.stderr).trim().to_owned());
    }
    let report: Value = serde_json::from_slice(&run.stdout).map_err(|error| error.to_string())?;
    let text = std::fs::read_to_string(&out).map_err(|error| error.to_string())?;
    let file: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    std::fs::remove_file(&out).map_err(|error| error.to_string())?;
    let number = |value: &Value| value.as_f64().unwrap_or(0.0);
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let mode = |mode: &Value| Mode {
        frequency_hz: number(&mode["frequency_hz"]),
        decay_per_s: number(&mode["decay_per_s"]),
        amplitude: number(&mode["amplitude"]),
        phase_rad: number(&mode["phase_rad"]),
    };
    Ok(Fitted {
        cpu_s,
        modes: list(&file["modes"]).iter().map(mode).collect(),
        burst: list(&file["residual"]["samples"]).iter().map(|x| number(x) as f32).collect(),
        onset_s: number(&report["onset_s"]),
        end_s: number(&file["fit"]["end_s"]),
        told_snr_db: number(&report["snr_from_onset_db"]),
        warnings: list(&report["warnings"]).iter().filter_map(|w| Some(w.as_str()?.to_owned())).collect(),
    })
}

/// Processor time of the child processes that have ended, s (Linux; in hundredths).
fn children_s() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit(')').next().unwrap_or_default();
    let ticks = |field: usize| after_name.split_whitespace().nth(field).and_then(|t| t.parse::<f64>().ok());
    // cutime and cstime are the 16th and 17th fields, the 14th and 15th after the name and the
    // state.
    0.01 * (ticks(13).unwrap_or(0.0) + ticks(14).unwrap_or(0.0))
}
