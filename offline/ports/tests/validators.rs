//! The formats' own decoders, made by others, read what is written here.
//!
//! `ASPERITY_VALIDATORS` names the folder in which `meta-validate`, `meta-render` and `hjif-synth`
//! stand; without it these tests say that they skip.

use asperity_dsp::rng::Rng;
use asperity_ports::reduction::{Options, reduce};
use asperity_ports::{Device, ahap, haptic_file, hjif, oscillator};
use std::f64::consts::TAU;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

fn tool(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("ASPERITY_VALIDATORS") else {
        println!("skipped: ASPERITY_VALIDATORS names no folder with {name}");
        return None;
    };
    let path = PathBuf::from(folder).join(name);
    assert!(path.exists(), "{} is not there", path.display());
    Some(path)
}

/// Vibrations of every kind: a chirp, noise in bursts, decaying strikes, silence with a click.
fn vibrations() -> Vec<Vec<f64>> {
    let mut rng = Rng::new(23);
    let second = |f: &mut dyn FnMut(f64) -> f64| -> Vec<f64> {
        (0..20_000).map(|n| f(f64::from(n) / 8000.0)).collect()
    };
    vec![
        second(&mut |t| 0.8 * (TAU * (40.0 + 80.0 * t) * t).sin()),
        second(&mut |t| if (4.0 * t).fract() < 0.5 { 0.2 * rng.normal() } else { 0.0 }),
        second(&mut |t| (TAU * 170.0 * t).sin() * (-12.0 * (t % 0.4)).exp()),
        second(&mut |t| if t == 1.0 { 1.0 } else { 0.0 }),
    ]
}

fn folder(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&path).unwrap();
    path
}

#[test]
fn metas_strict_validator_accepts_every_haptic_file_and_its_model_every_ahap() {
    let Some(validate) = tool("meta-validate") else { return };
    let folder = folder("meta");
    let mut files = Vec::new();
    for (index, wave) in vibrations().iter().enumerate() {
        for points in [2.0, 60.0, 250.0] {
            let options =
                Options { points_per_s: Some(points), strokes_s: vec![0.0, 1.0], ..Options::default() };
            let clip = reduce(wave, 8000.0, &Device::quest(), &options, &mut |_| {}).unwrap().clip;
            let stem = folder.join(format!("{index}-{points}"));
            let mut put = |ending: &str, text: &str| {
                let path = stem.with_extension(ending);
                std::fs::write(&path, text).unwrap();
                files.push(path);
            };
            put("haptic", &haptic_file::write(&clip).unwrap());
            let both = ahap::write(&clip, None).unwrap();
            put("ahap", &both.main);
            if let Some(strokes) = &both.transients {
                put("transients.ahap", strokes);
            }
        }
    }
    let remarks = Command::new(validate).args(&files).output().unwrap();
    let remarks = String::from_utf8(remarks.stdout).unwrap();
    assert_eq!(remarks.lines().count(), files.len(), "{remarks}");
    for line in remarks.lines() {
        assert!(line.contains(": valid, ") || line.contains(": parsed, "), "{line}");
    }
    println!("{} files accepted", files.len());
}

#[test]
fn metas_own_renderer_makes_of_a_clip_what_ours_does() {
    let Some(render) = tool("meta-render") else { return };
    for wave in vibrations() {
        let device = Device::quest();
        let clip = reduce(&wave, 8000.0, &device, &Options::default(), &mut |_| {}).unwrap().clip;
        let ours = oscillator::rendered(&clip, &device, 8000.0);
        let mut list = format!("8000 {} {} {}\n", ours.len(), device.band_hz[0], device.band_hz[1]);
        let mut lines: Vec<(f64, String)> = Vec::new();
        // A ramp begins where the point before it lies.
        let mut ramps = |kind: char, points: &[(f64, f64)]| {
            lines.push((points[0].0, format!("{kind} {} {} 0\n", points[0].0, points[0].1)));
            for pair in points.windows(2) {
                lines.push((
                    pair[0].0,
                    format!("{kind} {} {} {}\n", pair[0].0, pair[1].1, pair[1].0 - pair[0].0),
                ));
            }
        };
        ramps('A', &clip.amplitude.iter().map(|p| (p.time_s, p.amplitude)).collect::<Vec<_>>());
        ramps('F', &clip.frequency.iter().map(|p| (p.time_s, p.frequency)).collect::<Vec<_>>());
        lines.sort_by(|a, b| a.0.total_cmp(&b.0));
        lines.iter().for_each(|(_, line)| list.push_str(line));
        let mut child = Command::new(&render).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(list.as_bytes()).unwrap();
        let bytes = child.wait_with_output().unwrap().stdout;
        let theirs: Vec<f64> =
            bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect();
        assert_eq!(theirs.len(), ours.len());
        let score = asperity_ports::score::Reference::new(&theirs, device.band_hz).score(&ours);
        println!("{score:?}");
        // It begins a ramp on the next whole sample, so phases drift; levels and third octaves do
        // not.
        assert!(
            score.in_band_error_db < 1.0
                && score.level_bias_db.abs() < 0.2
                && score.envelope_correlation > 0.995,
            "{score:?}"
        );
    }
}

#[test]
fn mpegs_synthesiser_returns_a_curves_own_samples() {
    let Some(synth) = tool("hjif-synth") else { return };
    let folder = folder("mpeg");
    let mut rng = Rng::new(29);
    let mut slow = [0.0; 4];
    let mut waves = vibrations();
    waves.truncate(1);
    waves.push((0..16_000).map(|n| 0.9 * (TAU * 150.0 * f64::from(n) / 8000.0).sin()).collect());
    // Noise below about 300 Hz.
    waves.push(
        (0..16_000)
            .map(|_| {
                slow.iter_mut().fold(rng.normal(), |x, y| {
                    *y += 0.22 * (x - *y);
                    *y
                })
            })
            .collect(),
    );
    for (index, wave) in waves.iter().enumerate() {
        let wave: Vec<f64> = wave.iter().map(|x| x.clamp(-1.0, 1.0)).collect();
        let written = hjif::write(&wave, 4000.0, 40.0, "test").unwrap();
        let (input, output) = (folder.join(format!("{index}.hjif")), folder.join(format!("{index}.wav")));
        std::fs::write(&input, &written.text).unwrap();
        let remarks = Command::new(&synth).arg("-f").arg(&input).arg("-o").arg(&output).output().unwrap();
        // The standard's schema is not public, so that the synthesiser cannot find it says nothing
        // about the file.
        let words: String = String::from_utf8_lossy(&remarks.stderr)
            .lines()
            .filter(|line| !line.contains("JSON schema"))
            .collect();
        assert!(
            remarks.status.success() && !words.contains("nvalid") && !words.contains("Missing"),
            "{words}"
        );
        let mut reader = hound::WavReader::open(&output).unwrap();
        let theirs: Vec<f64> = reader.samples::<i32>().map(|x| f64::from(x.unwrap()) / 32_768.0).collect();
        let snr_db = |shift: isize| {
            let pairs: Vec<(f64, f64)> = (8..wave.len().min(theirs.len()) as isize - 8)
                .map(|n| (wave[n as usize], theirs[(n + shift) as usize]))
                .collect();
            let energy: f64 = pairs.iter().map(|(a, _)| a * a).sum();
            let error: f64 = pairs.iter().map(|(a, b)| (a - b).powi(2)).sum();
            10.0 * (energy / error.max(1e-30)).log10()
        };
        let best = (-4..=4).max_by(|a, b| snr_db(*a).total_cmp(&snr_db(*b))).unwrap();
        println!("{index}: {:.1} dB, {best} samples shifted, {} keyframes", snr_db(0), written.keyframes);
        assert_eq!(best, 0);
        assert!(snr_db(0) >= 30.0, "{} dB", snr_db(0));
    }
}
