//! Report of a render: what `--json` prints and the plain words are made from.

use asperity::Isa;
use asperity::load::levels::Levels;
use asperity::offline::Render;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

/// Output of `--json`.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Length of both WAV files.
    pub duration_s: f64,
    /// Seconds of signal per second of signal processing, without loading and writing.
    pub real_time_factor: f64,
    /// Events applied.
    pub events: u64,
    /// Onsets of contact within strokes.
    pub micro_collisions: u64,
    /// Strikes by rigid bodies.
    pub impacts: u64,
    /// Events lost because the queue was full.
    pub dropped: u64,
    /// Events refused for a bad number, and contacts reset after their numbers went bad.
    pub quarantined: u64,
    /// Contacts silenced because a more important one needed their voice.
    pub stolen: u64,
    /// Largest sample of the audio channel, absolute.
    pub audio_peak: f32,
    /// Peak of each audio bus.
    pub bus_peak: Vec<f32>,
    /// Largest sample of each haptic channel, absolute.
    pub haptic_peak: Vec<f32>,
    /// Events of contacts that nobody began, or whose voice was stolen.
    pub orphaned: u64,
    /// m or m/s² at sample value 1 of each haptic channel, written or by the level policy.
    pub full_scale: Vec<f64>,
    /// n of a finger's displacement ∝ Fⁿ of each haptic channel, written or by the level policy.
    pub felt_force_exponent: Vec<f64>,
    /// Gain of the audio, written or by the level policy; a list where there are several buses.
    pub gain: Value,
    /// Gain of impacts beside strokes of each body, written or by the level policy.
    pub strike_gain: Vec<f64>,
    /// By how much the peak limiters turned down at most, dB.
    pub limiter_db: f64,
    /// Contacts faded because nothing was heard of them.
    pub lapsed: u64,
    /// Rate of both WAV files.
    pub sample_rate_hz: f64,
    /// Instruction set of the kernels whose last bits depend on it.
    pub kernel: Isa,
    /// Surfaces of sand as they lie afterwards, by name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub sand: BTreeMap<String, SandReport>,
    /// Every file written.
    pub files: Vec<PathBuf>,
    /// Events refused, lost or clipped, and why a file is silence: one line each, with what mends
    /// it.
    pub warnings: Vec<String>,
}

/// A surface of sand after the last contact, settled.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct SandReport {
    /// Volume before the first contact.
    pub volume_before_m3: f64,
    /// Volume now.
    pub volume_after_m3: f64,
    /// Steepest slope.
    pub max_slope_deg: f64,
    /// Deepest that a contact stood below the untouched bed, m, before its walls slid.
    pub print_m: f64,
    /// Height of one grey step of its picture.
    pub metres_per_grey: f64,
    /// Height of black above the bottom of the bed.
    pub lowest_m: f64,
}

fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak, sample| sample.abs().max(peak))
}

/// Report of a render; files, sand and warnings come later.
pub(super) fn report(render: &Render, kernel: Isa, levels: Levels, watching: Duration) -> Report {
    let stats = &render.stats;
    let processing_s = render.processing.saturating_sub(watching).as_secs_f64().max(1e-9);
    Report {
        duration_s: render.duration_s(),
        real_time_factor: render.duration_s() / processing_s,
        events: stats.events,
        micro_collisions: stats.micro_collisions,
        impacts: stats.impacts,
        dropped: stats.dropped,
        quarantined: stats.quarantined + stats.refused,
        stolen: stats.stolen,
        audio_peak: render.audio.iter().map(|bus| peak(bus)).fold(0.0, f32::max),
        bus_peak: render.audio.iter().map(|bus| peak(bus)).collect(),
        haptic_peak: render.haptic.iter().map(|channel| peak(channel)).collect(),
        full_scale: levels.full_scale,
        felt_force_exponent: levels.felt_force_exponent,
        gain: one_or_all(levels.gain),
        strike_gain: levels.strike_gain,
        limiter_db: render.limiter_db,
        orphaned: stats.orphaned,
        lapsed: stats.lapsed,
        sample_rate_hz: render.sample_rate_hz,
        kernel,
        sand: BTreeMap::new(),
        files: Vec::new(),
        warnings: Vec::new(),
    }
}

/// A number where there is one bus, a list where there are several.
fn one_or_all(gain: Vec<f64>) -> Value {
    match gain.as_slice() {
        [only] => Value::from(*only),
        all => Value::from(all.to_vec()),
    }
}
