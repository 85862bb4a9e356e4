//! The statistics that a test suite has no time for, in full: `statistics`
//!
//! 50 draws of two modes 1 Hz apart (T60 2 s, 20 dB), 40 draws of every colour of noise, 30 s and
//! 10 minutes of audio, and the most memory the process ever held.

use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_evidence::coloured_noise::{COLOURS, Colour, noise};
use asperity_evidence::impact::{render_fast, with_noise};
use asperity_evidence::process::{cpu_seconds, peak_mib};
use asperity_fit::{ChannelChoice, FitOptions, FittedMode, Recording, fit, load};

const RATE_HZ: f64 = 44_100.0;

fn fitted(samples: Vec<f64>) -> asperity_fit::Fit {
    let recording = Recording::from_samples("made", samples, RATE_HZ).expect("it is a recording");
    fit(&recording, &FitOptions { threads: 1, ..FitOptions::default() }, &mut |_| {})
        .expect("it can be fitted")
}

fn main() {
    if std::env::args().nth(1).as_deref() == Some("long") {
        long(30.0);
        return;
    }
    println!("pairs 1 Hz apart, both found: {} of 50 (48 or more)", pairs(50, 4242));
    for (name, colour) in COLOURS {
        println!("{name:22} without a mode: {} of 40 (38 or more)", silent(40, 9000, colour));
    }
    for pole in [0.02, 0.005] {
        let silent = from_rest(20, 9200, pole);
        println!("one-pole {pole} from rest, without a mode: {silent} of 20 (19 or more)");
    }
    long(30.0);
    long(600.0);
    println!("most memory held so far: {:.0} MiB", peak_mib());
}

/// In how many draws both modes of a pair were found, within a fifth of their distance, and nothing
/// else.
fn pairs(draws: u32, seed: u64) -> usize {
    let mut rng = Rng::new(seed);
    let decay_per_s = 3.0 * std::f64::consts::LN_10 / 2.0;
    (0..draws)
        .filter(|_| {
            let mode =
                |frequency_hz, phase_rad| Mode { frequency_hz, decay_per_s, amplitude: 0.5, phase_rad };
            let hz = 200.0 * 20.0_f64.powf(rng.uniform());
            let turn = 2.0 * std::f64::consts::PI;
            let truth = vec![mode(hz, turn * rng.uniform()), mode(hz + 1.0, turn * rng.uniform())];
            let made = with_noise(truth, 20.0, &mut rng, RATE_HZ, 2.0);
            let found: Vec<Mode> = fitted(made.noisy).modes.iter().map(FittedMode::mode).collect();
            let near = |t: &Mode| found.iter().any(|f| (f.frequency_hz - t.frequency_hz).abs() < 0.2);
            found.len() == 2 && made.truth.iter().all(near)
        })
        .count()
}

/// How many draws of 2 s of noise give no mode.
fn silent(draws: u64, seed: u64, colour: Colour) -> usize {
    (0..draws).filter(|draw| fitted(noise(colour, 88_200, RATE_HZ, 0, seed + draw)).modes.is_empty()).count()
}

/// The same of a one-pole low-pass of white noise that begins with nothing.
fn from_rest(draws: u64, seed: u64, pole: f64) -> usize {
    (0..draws)
        .filter(|draw| {
            let (mut rng, mut last) = (Rng::new(seed + draw), 0.0);
            let mut next = || {
                last += pole * (rng.normal() - last);
                0.1 * last
            };
            let samples = (0..88_200).map(|_| next()).collect();
            fitted(samples).modes.is_empty()
        })
        .count()
}

/// A file of so many seconds, 30 modes that ring up to 20 s, 50 dB over the noise.
fn long(seconds: f64) {
    let mut rng = Rng::new(31);
    let count = (seconds * RATE_HZ) as usize;
    let modes: Vec<Mode> = (0..30)
        .map(|k| Mode {
            frequency_hz: 80.0 * 1.19_f64.powi(k),
            decay_per_s: 0.35 * 1.18_f64.powi(k),
            amplitude: 0.2 / f64::from(1 + k % 7),
            phase_rad: f64::from(k),
        })
        .collect();
    let ringing = render_fast(&modes, RATE_HZ, count.min((60.0 * RATE_HZ) as usize));
    let path = std::env::temp_dir().join(format!("asperity-long-{}.wav", std::process::id()));
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(&path, spec).expect("a temporary file can be written");
    for n in 0..count {
        let x = 0.3 * ringing.get(n).copied().unwrap_or(0.0) + 1e-4 * rng.normal();
        writer.write_sample((32_767.0 * x).round() as i16).expect("a sample can be written");
    }
    writer.finalize().expect("the file can be finished");
    drop(ringing);
    let clock = cpu_seconds();
    let recording = load(&path, ChannelChoice::Loudest).expect("the file is a recording");
    let options = FitOptions { threads: 1, ..FitOptions::default() };
    let fit = fit(&recording, &options, &mut |_| {}).expect("it can be fitted");
    let found = modes
        .iter()
        .filter(|t| fit.modes.iter().any(|m| (m.frequency_hz / t.frequency_hz - 1.0).abs() < 1e-4));
    println!(
        "{seconds:.0} s of audio: {:.1} s of CPU, {} of 30 modes found, {} in all, {:.0} MiB held at most",
        cpu_seconds() - clock,
        found.count(),
        fit.modes.len(),
        peak_mib()
    );
    std::fs::remove_file(path).expect("the temporary file can be removed");
}
