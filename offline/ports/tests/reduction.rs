//! Reduction: what is left is felt alike, on recordings that nothing was tuned on.

use asperity_dsp::rng::Rng;
use asperity_evidence::corpus::corpus;
use asperity_ports::reduction::{Options, reduce};
use asperity_ports::{Clip, Device, felt, oscillator, resample, score::Reference};
use std::f64::consts::TAU;
use std::path::Path;

pub fn wav(path: &Path) -> (Vec<f64>, f64) {
    let mut reader = hound::WavReader::open(path).unwrap();
    let spec = reader.spec();
    let full = 2f64.powi(i32::from(spec.bits_per_sample) - 1);
    let all: Vec<f64> = match spec.sample_format {
        hound::SampleFormat::Float => reader.samples::<f32>().map(|x| f64::from(x.unwrap())).collect(),
        hound::SampleFormat::Int => reader.samples::<i32>().map(|x| f64::from(x.unwrap()) / full).collect(),
    };
    (all.into_iter().step_by(usize::from(spec.channels)).collect(), f64::from(spec.sample_rate))
}

/// What a public analysis does by default: an envelope follower, and the spectral centroid for the
/// frequency, 60 points a second.
fn envelope_and_centroid(samples: &[f64], rate_hz: f64, device: &Device) -> Clip {
    use asperity_ports::{AmplitudePoint, FrequencyPoint};
    let x = resample::resampled(samples, rate_hz, felt::RATE_HZ);
    let step = (felt::RATE_HZ / 60.0) as usize;
    let (attack, release) = ((-1.0 / (0.002 * felt::RATE_HZ)).exp(), (-1.0 / (0.03 * felt::RATE_HZ)).exp());
    let mut level: f64 = 0.0;
    let (mut amplitude, mut frequency) = (Vec::new(), Vec::new());
    for (n, sample) in x.iter().enumerate() {
        let size = sample.abs();
        let keep = if size > level { attack } else { release };
        level = size + keep * (level - size);
        if n % step == 0 {
            let time_s = n as f64 / felt::RATE_HZ;
            let part = &x[n.saturating_sub(256)..(n + 256).min(x.len())];
            // Centroid of the power from differences: √(Σ ẋ² / Σ x²).
            let slope: f64 = part.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
            let power: f64 = part.iter().map(|x| x * x).sum();
            let hz = if power > 0.0 { (slope / power).sqrt() * felt::RATE_HZ / TAU } else { 55.0 };
            amplitude.push(AmplitudePoint { time_s, amplitude: level.min(1.0), emphasis: None });
            frequency.push(FrequencyPoint { time_s, frequency: device.frequency(hz) });
        }
    }
    Clip { amplitude, frequency, ..Clip::default() }
}

/// Every WAV file of the corpus' impacts, in the order of their names: none of them chose a number
/// of the reduction.
#[test]
fn recordings_are_felt_alike_on_a_headsets_controller() {
    let Some(folder) = corpus("impacts") else { return };
    let mut paths: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "wav"));
    paths.sort();
    let device = Device::quest();
    let (mut ours_db, mut plainly_db) = (Vec::new(), Vec::new());
    for path in &paths {
        let (samples, rate_hz) = wav(path);
        let reduction = reduce(&samples, rate_hz, &device, &Options::default(), &mut |_| {}).unwrap();
        let score = reduction.score;
        let plain = envelope_and_centroid(&samples, rate_hz, &device);
        let original: Vec<f64> = reduction.original.iter().map(|x| x / reduction.gain).collect();
        let left = oscillator::rendered(&plain, &device, felt::RATE_HZ);
        let peer = Reference::new(&original, device.band_hz).score(&left);
        let name = path.file_name().unwrap().to_string_lossy();
        println!(
            "{name}: {score:?}, {} points; plainly {:.1} dB",
            reduction.clip.amplitude.len(),
            peer.in_band_error_db
        );
        assert!(score.balance_db <= 6.0 && score.level_bias_db.abs() <= 1.0, "{name}: {score:?}");
        assert!(score.envelope_correlation >= 0.93, "{name}: {score:?}");
        ours_db.push(score.in_band_error_db);
        plainly_db.push(peer.in_band_error_db);
    }
    let mean = |db: &[f64]| db.iter().sum::<f64>() / db.len() as f64;
    println!(
        "first five {:.2} dB, all {} {:.2} dB; plainly {:.2} dB",
        mean(&ours_db[..5]),
        ours_db.len(),
        mean(&ours_db),
        mean(&plainly_db)
    );
    assert!(mean(&ours_db[..5]) <= 5.0);
    // Some of them ring above the device's range only: what is felt of that comes back inside it,
    // where nothing was.
    assert!(mean(&ours_db) <= 6.0);
    assert!(mean(&plainly_db) >= mean(&ours_db) + 6.0);
}

#[test]
fn a_sine_inside_the_range_comes_back_as_itself() {
    let wave: Vec<f64> = (0..44_100).map(|n| 0.5 * (TAU * 120.0 * f64::from(n) / 44_100.0).sin()).collect();
    let reduction = reduce(&wave, 44_100.0, &Device::quest(), &Options::default(), &mut |_| {}).unwrap();
    assert_eq!(reduction.gain, 1.0);
    assert!(
        reduction.score.in_band_error_db < 1.0 && reduction.score.level_bias_db.abs() < 0.3,
        "{:?}",
        reduction.score
    );
    for point in &reduction.clip.amplitude {
        if (0.1..0.9).contains(&point.time_s) {
            assert!((point.amplitude - 0.5).abs() < 0.05, "{point:?}");
        }
    }
    assert!((reduction.clip.duration_s() - 1.0).abs() < 1e-6);
}

#[test]
fn too_strong_frames_are_scaled_and_weak_ones_stay() {
    let wave = |peak: f64| -> Vec<f64> {
        (0..8000).map(|n| peak * (TAU * 120.0 * f64::from(n) / 8000.0).sin()).collect()
    };
    let device = Device::quest();
    let strong = reduce(&wave(4.0), 8000.0, &device, &Options::default(), &mut |_| {}).unwrap();
    assert!((strong.gain * 4.0 - 1.0).abs() < 0.15, "{}", strong.gain);
    let weak = reduce(&wave(0.01), 8000.0, &device, &Options::default(), &mut |_| {}).unwrap();
    assert_eq!(weak.gain, 1.0);
    let raised =
        reduce(&wave(0.01), 8000.0, &device, &Options { normalise: true, ..Options::default() }, &mut |_| {})
            .unwrap();
    let peak = raised.clip.amplitude.iter().map(|p| p.amplitude).fold(0.0, f64::max);
    assert!((peak - 1.0).abs() < 1e-5 && raised.gain > 50.0);
}

#[test]
fn any_clip_that_keeps_the_rules_comes_out_or_one_line() {
    let mut rng = Rng::new(17);
    let device = Device::quest();
    for case in 0..40 {
        let count = [2, 3, 17, 400, 3000, 9000][case % 6];
        let rate_hz = [100.0, 8000.0, 44_100.0, 48_000.0, 192_000.0][case % 5];
        let size = 10f64.powf(-12.0 + 20.0 * rng.uniform());
        let samples: Vec<f64> = match case % 4 {
            0 => (0..count).map(|_| size * rng.normal()).collect(),
            1 => vec![size; count],
            2 => (0..count).map(|n| if n == count / 2 { size } else { 0.0 }).collect(),
            _ => vec![0.0; count],
        };
        let points_per_s = [1.0, 30.0, 250.0, 4000.0][case % 4];
        let options = Options {
            points_per_s: Some(points_per_s),
            strokes_s: vec![0.0, 0.01, 1e9],
            ..Options::default()
        };
        let reduction = reduce(&samples, rate_hz, &device, &options, &mut |_| {})
            .unwrap_or_else(|error| panic!("{case}: {error}"));
        let most = ((points_per_s * count as f64 / rate_hz) as usize).max(2);
        assert!(
            reduction.clip.amplitude.len() <= most,
            "{case}: {} of {most}",
            reduction.clip.amplitude.len()
        );
        asperity_ports::haptic_file::write(&reduction.clip).unwrap();
    }
    for bad in [vec![], vec![1.0], vec![0.0, f64::NAN], vec![0.0, f64::INFINITY], vec![1e40, 0.0]] {
        let error = reduce(&bad, 8000.0, &device, &Options::default(), &mut |_| {}).unwrap_err();
        assert!(error.to_string().starts_with("sample"), "{error}");
    }
    assert!(reduce(&[0.0, 1.0], f64::NAN, &device, &Options::default(), &mut |_| {}).is_err());
}
