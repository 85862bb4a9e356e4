//! Fits WAV files and prints a table: `recordings MAX_MODES FILE…`; the baseline is STFT peaks.

use asperity_evidence::impact::render_fast;
use asperity_evidence::process::cpu_seconds;
use asperity_evidence::score::snr_db;
use asperity_evidence::stft_peaks::stft_peaks;
use asperity_fit::{ChannelChoice, FitOptions, fit, load};

fn main() {
    let mut args = std::env::args().skip(1);
    let max_modes = args.next().and_then(|n| n.parse().ok()).unwrap_or(60);
    println!("file                               modes offset_ms  snr  from_onset  noise_db  s  strongest");
    for path in args {
        let recording = match load(&path, ChannelChoice::Loudest) {
            Ok(recording) => recording,
            Err(error) => {
                println!("error: {error}");
                continue;
            }
        };
        let clock = cpu_seconds();
        let options = FitOptions { max_modes, threads: 1, ..FitOptions::default() };
        match fit(&recording, &options, &mut |_| {}) {
            Err(error) => println!("error: {error}"),
            Ok(fit) => {
                let seconds = cpu_seconds() - clock;
                let top: Vec<String> = fit
                    .modes
                    .iter()
                    .take(3)
                    .map(|m| format!("{:.2}/{:.2}", m.frequency_hz, m.decay_per_s))
                    .collect();
                let from = fit.onset_sample;
                let to = ((fit.end_s - recording.starts_at_s) * recording.sample_rate_hz).round() as usize;
                let mean = recording.samples[recording.samples.len() * 3 / 4..].iter().sum::<f64>()
                    / (recording.samples.len() - recording.samples.len() * 3 / 4) as f64;
                let sound: Vec<f64> = recording.samples[from..to].iter().map(|x| x - mean).collect();
                let rate = recording.sample_rate_hz;
                let peaks = stft_peaks(&sound, rate, max_modes);
                let baseline = snr_db(&sound, &render_fast(&peaks, rate, sound.len()));
                println!(
                    "baseline {baseline:6.2} dB  {:36} {:4} {:6.2} {:7.2} {:7.2} {:7.1} {:6.2}  {}",
                    fit.source,
                    fit.modes.len(),
                    1e3 * fit.start_offset_s,
                    fit.resynthesis_snr_db,
                    fit.snr_from_onset_db,
                    fit.noise_floor_db,
                    seconds,
                    top.join(" ")
                );
                for warning in &fit.warnings {
                    println!("      {warning}");
                }
            }
        }
    }
}
