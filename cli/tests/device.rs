//! `asperity device` from the outside: a made sweep becomes a profile that a scene takes.

use crate::support::{Scene, asperity, assert_refused, message};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const RATE_HZ: f64 = 4000.0;

/// Drive and acceleration of an actuator of 150 Hz, Q 6, 20 µm at resonance, in fine steps.
fn sweep(seconds: f64) -> Vec<[f64; 2]> {
    let (w0, q, felt_m, fine) = (TAU * 150.0, 6.0, 2e-5, 64);
    let octaves = 40f64.ln();
    let drive = |t: f64| 0.5 * (TAU * 15.0 * seconds / octaves * ((octaves * t / seconds).exp() - 1.0)).sin();
    let force = |t: f64, x: f64, v: f64| w0 * w0 * (felt_m / q * drive(t) - x) - w0 / q * v;
    let (mut x, mut v, h) = (0.0, 0.0, 1.0 / RATE_HZ / f64::from(fine));
    let mut rows = Vec::new();
    for n in 0..(seconds * RATE_HZ) as usize {
        let t = n as f64 / RATE_HZ;
        rows.push([drive(t), force(t, x, v)]);
        for i in 0..fine {
            // Second-order leap-frog with the damping taken half before, half after.
            let at = t + f64::from(i) * h;
            v += 0.5 * h * force(at, x, v);
            x += h * v;
            v = (v + 0.5 * h * w0 * w0 * (felt_m / q * drive(at + h) - x)) / (1.0 + 0.5 * h * w0 / q);
        }
    }
    rows
}

fn wav(path: &Path, rows: &[[f64; 2]]) {
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: RATE_HZ as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, spec).unwrap();
    rows.iter().flatten().for_each(|x| writer.write_sample(*x as f32).unwrap());
    writer.finalize().unwrap();
}

fn csv(path: &Path, rows: &[[f64; 2]]) {
    let mut text = "time_s,drive,acceleration_m_s2\n".to_owned();
    for (n, [drive, felt]) in rows.iter().enumerate() {
        writeln!(text, "{},{drive},{felt}", n as f64 / RATE_HZ).unwrap();
    }
    fs::write(path, text).unwrap();
}

#[test]
fn a_sweep_as_wav_or_table_becomes_a_profile() {
    let scene = Scene::new();
    let folder = scene.folder.path();
    let rows = sweep(4.0);
    wav(&folder.join("sweep.wav"), &rows);
    csv(&folder.join("sweep.csv"), &rows);
    for name in ["sweep.wav", "sweep.csv"] {
        let (status, out, err) = message(&asperity(folder, &["device", name, "-o", "my.toml", "--json"]));
        assert_eq!((status, err.as_str()), (0, ""));
        let report: serde_json::Value = serde_json::from_str(&out).unwrap();
        assert!((report["profile"]["quality"].as_f64().unwrap() / 6.0 - 1.0).abs() < 0.01, "{out}");
        let profile: toml::Table = fs::read_to_string(folder.join("my.toml")).unwrap().parse().unwrap();
        let number = |key: &str| profile[key].as_float().unwrap();
        assert!((number("resonance_hz") / 150.0 - 1.0).abs() < 2e-3, "{profile}");
        assert!((number("felt_at_resonance_m") / 2e-5 - 1.0).abs() < 0.01, "{profile}");
        let error = profile["error"].as_table().unwrap();
        for key in profile.keys().filter(|key| !["label", "error", "source"].contains(&key.as_str())) {
            assert!(error.contains_key(key) && profile["source"].as_table().unwrap().contains_key(key));
        }
        assert!(error["resonance_hz"].as_float().unwrap() < 0.5);
    }
    let equalised =
        crate::support::TOML.replace("full_scale = 1.0", "full_scale = 1e-5\nequalise = \"my.toml\"");
    scene.write("scene.toml", equalised);
    let (status, _, err) = message(&scene.render(&[]));
    assert_eq!((status, err.as_str()), (0, ""));
}

#[test]
fn a_recording_that_is_no_sweep_leaves_no_profile() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let rows = sweep(1.0);
    csv(&folder.join("short.csv"), &rows[..400]);
    wav(&folder.join("silent.wav"), &vec![[0.0, 0.0]; 4000]);
    fs::write(folder.join("other.csv"), "time_s,drive\n0,0\n0.1,1\n0.2,1\n").unwrap();
    for (name, part) in
        [("short.csv", "lasts 0.100 s"), ("silent.wav", "is silent"), ("other.csv", "acceleration_m_s2")]
    {
        assert_refused(&asperity(folder, &["device", name, "-o", "my.toml"]), &[name, part]);
        assert!(!folder.join("my.toml").exists());
    }
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(folder.join("mono.wav"), spec).unwrap();
    rows.iter().for_each(|[_, felt]| writer.write_sample(*felt as f32).unwrap());
    writer.finalize().unwrap();
    let output = asperity(folder, &["device", "mono.wav", "-o", "my.toml"]);
    assert_refused(&output, &["mono.wav", "has one channel", "drive and acceleration"]);
    let (status, _, err) = message(&asperity(folder, &["device", "short.csv", "-o", "short.csv"]));
    assert!(status == 1 && err.starts_with("error: "), "{err}");
}
