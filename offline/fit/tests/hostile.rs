//! Inputs that break naive fits: each gives a result with warnings or one typed error, quickly;
//! never a panic, a growing mode, or giants that cancel.

use asperity_dsp::mode::Mode;
use asperity_dsp::rng::Rng;
use asperity_evidence::impact::render;
use asperity_fit::{ChannelChoice, Fit, FitError, FitOptions, Recording, RecordingError, Warning, fit, load};

const RATE_HZ: f64 = 44_100.0;

fn recording(samples: Vec<f64>) -> Recording {
    Recording::from_samples("made", samples, RATE_HZ).unwrap()
}

fn fitted(samples: Vec<f64>) -> Fit {
    let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let options = FitOptions { threads: 1, max_modes: 60, ..FitOptions::default() };
    let fit = fit(&recording(samples), &options, &mut |_| {}).unwrap();
    for mode in &fit.modes {
        assert!(mode.decay_per_s > 0.0 && mode.frequency_hz > 0.0, "{mode:?}");
        // 8 peaks at the fitted part's start, carried back over the start offset.
        let back = (mode.decay_per_s * fit.start_offset_s).exp();
        assert!(mode.amplitude <= 8.1 * peak * back, "{mode:?} against a peak of {peak}");
    }
    fit
}

fn body() -> Vec<Mode> {
    (0..6)
        .map(|k| Mode {
            frequency_hz: 300.0 * 1.7_f64.powi(k),
            decay_per_s: 6.0 * 1.5_f64.powi(k),
            amplitude: 0.3 / f64::from(k + 1),
            phase_rad: f64::from(k),
        })
        .collect()
}

fn noisy(mut samples: Vec<f64>, level: f64, seed: u64) -> Vec<f64> {
    let mut rng = Rng::new(seed);
    samples.iter_mut().for_each(|x| *x += level * rng.normal());
    samples
}

#[test]
fn silence_a_constant_and_numbers_that_are_none_are_refused() {
    let refusal = |samples: Vec<f64>| Recording::from_samples("made", samples, RATE_HZ).unwrap_err();
    assert!(matches!(refusal(vec![0.0; 44_100]), RecordingError::Silent { .. }));
    assert!(matches!(refusal(vec![0.25; 44_100]), RecordingError::Silent { .. }));
    let mut samples = render(&body(), RATE_HZ, 4410);
    samples[99] = f64::NAN;
    assert!(matches!(refusal(samples.clone()), RecordingError::NotFinite { index: 99, .. }));
    samples[99] = f64::INFINITY;
    assert!(matches!(refusal(samples), RecordingError::NotFinite { index: 99, .. }));
    assert!(matches!(refusal(vec![1.0, -1.0, 1.0]), RecordingError::TooShort { samples: 3, .. }));
    let slow = Recording::from_samples("made", vec![0.5; 100], 10.0).unwrap_err();
    assert!(matches!(slow, RecordingError::Rate { .. }));
}

#[test]
fn noise_gives_no_modes_and_says_so() {
    let fit = fitted(noisy(vec![0.0; 44_100], 0.1, 5));
    assert!(fit.modes.is_empty() && fit.warnings.contains(&Warning::NoModes), "{:?}", fit.warnings);
}

#[test]
fn a_pure_sine_is_one_mode_that_is_called_undamped() {
    let sine = Mode { frequency_hz: 1000.3, decay_per_s: 0.0, amplitude: 0.5, phase_rad: 0.0 };
    let fit = fitted(noisy(render(&[sine], RATE_HZ, 66_150), 1e-4, 6));
    assert!((fit.modes[0].frequency_hz - 1000.3).abs() < 0.01, "{:?}", fit.modes);
    assert_eq!(fit.modes.len(), 1, "{:?}", fit.modes);
    assert!(fit.warnings.iter().any(|w| matches!(w, Warning::Undamped { .. })), "{:?}", fit.warnings);
    let growing: Vec<f64> =
        (0..44_100).map(|n| (f64::from(n) / 44_100.0).exp() * (0.2 * f64::from(n)).sin() * 0.2).collect();
    fitted(growing);
}

#[test]
fn short_sounds_give_what_there_is_and_a_warning() {
    for milliseconds in [2, 8, 40] {
        let count = 44_100 * milliseconds / 1000;
        let fit = fitted(noisy(render(&body(), RATE_HZ, count), 1e-4, 7));
        assert!(fit.warnings.iter().any(|w| matches!(w, Warning::TooShort { .. })), "{:?}", fit.warnings);
    }
}

#[test]
fn clipping_is_found_and_fitted_around() {
    let clipped: Vec<f64> =
        render(&body(), RATE_HZ, 66_150).iter().map(|x| (3.0 * x).clamp(-0.5, 0.5)).collect();
    let fit = fitted(noisy(clipped, 0.0, 8));
    assert!(fit.warnings.iter().any(|w| matches!(w, Warning::Clipped { .. })), "{:?}", fit.warnings);
    assert!(fit.modes.iter().any(|m| (m.frequency_hz - 300.0).abs() < 0.5));
}

#[test]
fn an_offset_is_removed() {
    let samples = render(&body(), RATE_HZ, 66_150).iter().map(|x| x + 0.1).collect();
    let fit = fitted(noisy(samples, 1e-4, 9));
    assert!(fit.warnings.iter().any(|w| matches!(w, Warning::Offset { .. })), "{:?}", fit.warnings);
    for mode in body() {
        assert!(fit.modes.iter().any(|m| (m.frequency_hz - mode.frequency_hz).abs() < 0.1), "{mode:?}");
    }
}

#[test]
fn the_longer_ringing_of_two_strikes_is_fitted_by_default() {
    let mut samples = vec![0.0; 4410];
    samples.extend(render(&body(), RATE_HZ, 61_740));
    for (n, x) in render(&body(), RATE_HZ, 36_150).into_iter().enumerate() {
        samples[30_000 + n] += x;
    }
    let samples = noisy(samples, 1e-4, 10);
    let strike = |strike| {
        let options = FitOptions { threads: 1, max_modes: 60, strike, ..FitOptions::default() };
        fit(&recording(samples.clone()), &options, &mut |_| {})
    };
    // Its strikes, the one that was taken first.
    let message = |fit: &Fit| {
        fit.warnings.iter().find_map(|w| match w {
            Warning::SecondStrike { taken, taken_s, others_s } => Some((*taken, *taken_s, others_s.clone())),
            _ => None,
        })
    };
    let (best, first) = (strike(None).unwrap(), strike(Some(1)).unwrap());
    let (taken, at_s, others_s) = message(&best).unwrap();
    assert!(taken == 2 && (at_s - 30_000.0 / RATE_HZ).abs() < 1e-3 && (others_s[0] - 0.1).abs() < 1e-3);
    let (taken, at_s, _) = message(&first).unwrap();
    assert!(taken == 1 && (at_s - 0.1).abs() < 5e-4 && first.end_s < 30_000.0 / RATE_HZ);
    for fit in [&best, &first] {
        for mode in body() {
            assert!(fit.modes.iter().any(|m| (m.frequency_hz - mode.frequency_hz).abs() < 0.5), "{mode:?}");
        }
    }
    let error = strike(Some(3)).unwrap_err().to_string();
    assert!(error.contains("strike 3 is not there") && error.contains("2 (0.680 s)"), "{error}");
}

/// Puts something before the strike.
type Strikes<'a> = &'a dyn Fn(&mut Vec<f64>);

#[test]
fn noise_before_the_real_strike_is_not_taken_for_it() {
    let onset = 22_050;
    let strike = |level: f64, at: usize, samples: &mut [f64]| {
        let ringing = render(&body(), RATE_HZ, samples.len() - at);
        samples[at..].iter_mut().zip(ringing).for_each(|(x, y)| *x += level * y);
    };
    let hum = |n: usize| 0.05 * (2.0 * std::f64::consts::PI * 50.0 * n as f64 / RATE_HZ).sin();
    let cases: [(&str, Strikes); 5] = [
        ("soft first", &|x| strike(0.3, 6000, x)),
        ("noise from the first sample", &|x| *x = noisy(std::mem::take(x), 0.03, 3)),
        ("hum", &|x| x.iter_mut().enumerate().for_each(|(n, x)| *x += hum(n))),
        ("a weaker one after", &|x| strike(0.5, 80_000, x)),
        ("a bounce before and two after", &|x| {
            [(0.2, 15_000), (0.3, 90_000), (0.2, 95_000)]
                .into_iter()
                .for_each(|(level, at)| strike(level, at, x))
        }),
    ];
    for (name, disturb) in cases {
        let mut samples = vec![0.0; 100_000];
        strike(1.0, onset, &mut samples);
        disturb(&mut samples);
        let strikes = asperity_fit::recording::onset::find(&noisy(samples, 1e-4, 4), RATE_HZ);
        let best = strikes.strike(strikes.best());
        assert!(best.onset.abs_diff(onset) < 40, "{name}: {} of {:?}", best.onset, strikes.onsets);
    }
}

#[test]
fn options_out_of_range_are_refused_by_name() {
    let recording = recording(render(&body(), RATE_HZ, 44_100));
    let plain = FitOptions::default();
    for options in [
        FitOptions { max_modes: 0, ..plain.clone() },
        FitOptions { band_hz: (500.0, 100.0), ..plain.clone() },
        FitOptions { band_hz: (f64::NAN, 100.0), ..plain.clone() },
        FitOptions { least_level_db: 3.0, ..plain.clone() },
        FitOptions { start_offset_s: Some(-1.0), ..plain.clone() },
    ] {
        let error = fit(&recording, &options, &mut |_| {}).unwrap_err();
        assert!(matches!(error, FitError::Option { .. }), "{error}");
    }
}

fn folder() -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("asperity-fit-hostile-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn files_of_every_width_are_read_and_broken_ones_are_named() {
    let folder = folder();
    let sound = render(&body(), RATE_HZ, 22_050);
    for bits in [8, 16, 24, 32] {
        let path = folder.join(format!("{bits}.wav"));
        let spec = hound::WavSpec {
            channels: 2,
            sample_rate: 44_100,
            bits_per_sample: bits,
            sample_format: hound::SampleFormat::Int,
        };
        let mut writer = hound::WavWriter::create(&path, spec).unwrap();
        let full = 2.0_f64.powi(i32::from(bits) - 1) - 1.0;
        for x in &sound {
            writer.write_sample((0.1 * x * full).round() as i32).unwrap();
            writer.write_sample((0.9 * x * full).round() as i32).unwrap();
        }
        writer.finalize().unwrap();
        let recording = load(&path, ChannelChoice::Loudest).unwrap();
        let tolerance = 2.0 * 0.5_f64.powi(i32::from(bits) - 1) + 1e-6;
        for (read, x) in recording.samples.iter().zip(&sound) {
            assert!((read - 0.9 * x).abs() < tolerance, "{bits} bits: {read} {x}");
        }
        assert!(load(&path, ChannelChoice::Index(1)).is_ok() && load(&path, ChannelChoice::Mix).is_ok());
        let error = load(&path, ChannelChoice::Index(2)).unwrap_err().to_string();
        assert!(error.contains("channels 0 to 1"), "{error}");
    }
    let bytes = std::fs::read(folder.join("16.wav")).unwrap();
    std::fs::write(folder.join("cut.wav"), &bytes[..bytes.len() / 2 + 1]).unwrap();
    assert!(load(folder.join("cut.wav"), ChannelChoice::Loudest).unwrap().truncated);
    std::fs::write(folder.join("text.wav"), "this is no sound at all\n".repeat(100)).unwrap();
    std::fs::write(folder.join("head.wav"), &bytes[..30]).unwrap();
    std::fs::write(folder.join("empty.wav"), b"").unwrap();
    for name in ["text.wav", "head.wav", "empty.wav", "missing.wav"] {
        let error = load(folder.join(name), ChannelChoice::Loudest).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("; ") && !error.contains('\n'), "{error}");
    }
    // Any byte of the header may be wrong; whatever comes of it, it is no panic.
    let mut rng = Rng::new(4);
    for _ in 0..400 {
        let mut damaged = bytes[..4000].to_vec();
        damaged[(rng.next_u32() % 60) as usize] = rng.next_u32() as u8;
        std::fs::write(folder.join("damaged.wav"), &damaged).unwrap();
        let _ = load(folder.join("damaged.wav"), ChannelChoice::Loudest);
    }
    std::fs::remove_dir_all(folder).unwrap();
}
