//! `asperity fit` from outside: what it writes, the round trip through the engine, tables, several
//! strikes, and inputs that are no good recording of one strike.

use crate::support;

use serde_json::Value;
use std::path::Path;
use support::{asperity, assert_refused, message};

const RATE_HZ: u32 = 44_100;

/// Frequency Hz, decay 1/s, amplitude.
const BODY: [(f64, f64, f64); 5] =
    [(431.0, 9.0, 0.3), (1187.0, 14.0, 0.2), (1190.5, 17.0, 0.1), (2960.0, 30.0, 0.12), (5210.0, 55.0, 0.08)];

fn ringing(seconds: f64, gains: [f64; 5]) -> Vec<f64> {
    let count = (seconds * f64::from(RATE_HZ)) as usize;
    let at = |n: usize| {
        let t = n as f64 / f64::from(RATE_HZ);
        let mode = |((hz, decay, amplitude), gain): (&(f64, f64, f64), f64)| {
            gain * amplitude * (-decay * t).exp() * (2.0 * std::f64::consts::PI * hz * t).sin()
        };
        BODY.iter().zip(gains).map(mode).sum()
    };
    (0..count).map(at).collect()
}

/// A noise of the size of a 16-bit step and more, the same every time.
fn noisy(samples: Vec<f64>, level: f64) -> Vec<f64> {
    let mut state = 1u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    samples.into_iter().map(|x| x + level * (0..4).map(|_| next()).sum::<f64>()).collect()
}

fn write(path: &Path, samples: &[f64]) {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, spec).unwrap();
    for x in samples {
        writer.write_sample((32_767.0 * x.clamp(-1.0, 1.0)).round() as i16).unwrap();
    }
    writer.finalize().unwrap();
}

fn recording(folder: &Path, name: &str) {
    let mut samples = vec![0.0; 4410];
    samples.extend(ringing(1.0, [1.0; 5]));
    write(&folder.join(name), &noisy(samples, 1e-4));
}

/// Runs `fit` with `--json` and returns the report.
fn fit(folder: &Path, arguments: &[&str]) -> Value {
    let mut all = vec!["fit", "--json"];
    all.extend(arguments);
    let (status, out, err) = message(&asperity(folder, &all));
    assert_eq!((status, err.as_str()), (0, ""), "{arguments:?}");
    serde_json::from_str(&out).unwrap()
}

fn modes(folder: &Path, name: &str) -> Vec<[f64; 3]> {
    let text = std::fs::read_to_string(folder.join(name)).unwrap();
    let file: Value = serde_json::from_str(&text).unwrap();
    let list = file["modes"].as_array().unwrap();
    let number = |mode: &Value, key: &str| mode[key].as_f64().unwrap();
    list.iter().map(|m| ["frequency_hz", "decay_per_s", "amplitude"].map(|key| number(m, key))).collect()
}

fn nearest(modes: &[[f64; 3]], hz: f64) -> [f64; 3] {
    *modes.iter().min_by(|a, b| (a[0] - hz).abs().total_cmp(&(b[0] - hz).abs())).unwrap()
}

fn says(report: &Value, warning: &str) -> bool {
    report["warnings"].as_array().unwrap().iter().any(|w| w.as_str().unwrap().contains(warning))
}

#[test]
fn one_command_writes_modes_table_residual_resynthesis_and_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    recording(folder, "hit.wav");
    let report = fit(
        folder,
        &[
            "hit.wav",
            "-o",
            "hit.modes.json",
            "--csv",
            "hit.csv",
            "--residual",
            "left.wav",
            "--resynthesis",
            "alone.wav",
            "--plot",
            "hit.svg",
            "--burst-ms",
            "20",
        ],
    );
    assert_eq!(report["modes"], 5);
    assert!((report["onset_s"].as_f64().unwrap() - 0.1).abs() < 5e-4);
    assert!(report["resynthesis_snr_db"].as_f64().unwrap() > 40.0, "{report}");
    assert!(report["noise_floor_db"].as_f64().unwrap() < -70.0 && report["seconds"].is_number());
    for (hz, decay, amplitude) in BODY {
        let found = nearest(&modes(folder, "hit.modes.json"), hz);
        assert!((found[0] / hz - 1.0).abs() < 1e-4, "{found:?}");
        assert!(
            (found[1] / decay - 1.0).abs() < 0.02 && (found[2] / amplitude - 1.0).abs() < 0.05,
            "{found:?}"
        );
    }
    let table = std::fs::read_to_string(folder.join("hit.csv")).unwrap();
    assert_eq!(table.lines().count(), 6);
    assert!(table.starts_with("frequency_hz,decay_per_s,amplitude,phase_rad"), "{table}");
    let picture = std::fs::read_to_string(folder.join("hit.svg")).unwrap();
    assert!(picture.contains("the struck body: modes and burst") && picture.ends_with("</svg>\n"));
    let samples = |name: &str| {
        let mut reader = hound::WavReader::open(folder.join(name)).unwrap();
        reader.samples::<f32>().map(|x| f64::from(x.unwrap())).collect::<Vec<_>>()
    };
    let mut original = hound::WavReader::open(folder.join("hit.wav")).unwrap();
    let sum = samples("left.wav").into_iter().zip(samples("alone.wav")).map(|(a, b)| a + b);
    for (sum, x) in sum.zip(original.samples::<i16>()) {
        assert!(
            (sum - f64::from(x.unwrap()) / 32_768.0).abs() < 1e-3,
            "residual and modes are the recording"
        );
    }
    let body = asperity_model(folder, "hit.modes.json");
    let burst = body.residual.unwrap();
    assert_eq!((burst.samples.len(), burst.sample_rate_hz), (882, 44_100.0));
}

fn asperity_model(folder: &Path, name: &str) -> asperity::ModalModel {
    asperity::ModalModel::load(folder.join(name)).unwrap()
}

#[test]
fn a_fitted_body_struck_and_fitted_again_is_the_same_body() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::copy(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/tile_strike.wav"),
        folder.join("tile.wav"),
    )
    .unwrap();
    let told_of = fit(folder, &["tile.wav", "-o", "tile.modes.json", "--max-modes", "32"]);
    // Modes of a tile in a room left 27.8 dB below the strike when they were cut from a sum of 111.
    let snr_db = told_of["snr_from_onset_db"].as_f64().unwrap();
    assert!(snr_db > 29.0, "{snr_db} dB");
    let scene =
        "contacts = \"hit.jsonl\"\ntail_s = 1.5\n[[body]]\nname = \"tile\"\nmodes = \"tile.modes.json\"\n";
    std::fs::write(folder.join("scene.toml"), scene).unwrap();
    let hit = r#"{"t":0.1,"event":"impact","body":"tile","speed_m_s":0.5,"mass_kg":0.005,"radius_m":0.002,"striker":"steel"}"#;
    std::fs::write(folder.join("hit.jsonl"), format!("{hit}\n")).unwrap();
    let (status, _, err) = message(&asperity(folder, &["render", "scene.toml", "-o", "take"]));
    assert_eq!((status, err.as_str()), (0, ""));
    fit(folder, &["take.audio.wav", "-o", "again.modes.json"]);
    let (first, again) = (modes(folder, "tile.modes.json"), modes(folder, "again.modes.json"));
    assert!(first.len() >= 10, "{}", first.len());
    // What the tile rings with: modes that last, down to 36 dB under the strongest. The others are
    // its strike.
    let energy = |[_, decay, amplitude]: &[f64; 3]| amplitude * amplitude / decay;
    let ringing = || first.iter().filter(|mode| mode[1] < 100.0);
    let strongest = ringing().map(energy).fold(0.0, f64::max);
    let body: Vec<_> = ringing().filter(|mode| energy(mode) > 2.5e-4 * strongest).collect();
    assert!(body.len() >= 5, "{first:?}");
    for &&[hz, decay, _] in &body {
        let found = nearest(&again, hz);
        assert!((found[0] / hz - 1.0).abs() < 1e-5, "{hz} Hz came back as {}", found[0]);
        assert!((found[1] / decay - 1.0).abs() < 0.01, "{hz} Hz: {decay}/s came back as {}", found[1]);
        // One mode each: they crowded at 750 to 791 Hz and traded places. What the room adds lies
        // 40 dB below.
        let near = body.iter().filter(|other| (other[0] / hz - 1.0).abs() < 0.01);
        assert_eq!(near.count(), 1, "{hz} Hz of {first:?}");
    }
}

#[test]
fn limits_and_rescaling_do_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    recording(folder, "hit.wav");
    let count = |arguments: &[&str]| {
        let all = [&["hit.wav", "-o", "x.modes.json"], arguments].concat();
        fit(folder, &all)["modes"].as_u64().unwrap()
    };
    assert_eq!(count(&["--from-hz", "1000", "--to-hz", "4000"]), 3);
    assert_eq!(count(&["--min-level", "-12"]), 2);
    assert!(count(&["--max-modes", "2"]) <= 2);
    count(&["--scale-size", "2"]);
    let half = modes(folder, "x.modes.json");
    assert!(BODY.iter().all(|(hz, ..)| (nearest(&half, 0.5 * hz)[0] / (0.5 * hz) - 1.0).abs() < 1e-4));
    count(&["--material", "100,0"]);
    let damped = modes(folder, "x.modes.json").iter().map(|m| m[1]).sum::<f64>() / 5.0;
    assert!((50.0..200.0).contains(&damped), "{damped}");
}

#[test]
fn several_strikes_become_strike_positions_of_one_body() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    recording(folder, "a.wav");
    let gains = [0.4, -0.8, 1.0, 1.5, 0.6];
    write(&folder.join("b.wav"), &noisy(ringing(1.0, gains), 1e-4));
    fit(folder, &["a.wav", "-o", "body.modes.json", "--merge", "b.wav"]);
    let body = asperity_model(folder, "body.modes.json");
    assert_eq!((body.modes.len(), body.position_count()), (5, 2));
    for (i, mode) in body.modes.iter().enumerate() {
        let k = BODY.iter().position(|(hz, ..)| (hz / mode.frequency_hz - 1.0).abs() < 1e-4).unwrap();
        let share = body.positions[0][i] / mode.amplitude;
        assert!((share - gains[k]).abs() < 0.05, "{} Hz: {share}", mode.frequency_hz);
    }
    assert_eq!(modes(folder, "body.strike1.modes.json").len(), 5);
    // Takes of one object are the same body, named one after the other.
    fit(folder, &["a.wav", "b.wav", "--family", "-o", "family.modes.json"]);
    // The positions of a family are takes of one blow, those of a merged body places.
    assert!(!body.takes);
    let family = asperity::ModalModel { takes: true, ..body };
    assert_eq!(asperity_model(folder, "family.modes.json"), family);
}

#[test]
fn a_family_counts_its_modes_and_warns_of_every_take() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write(&folder.join("a.wav"), &noisy(ringing(1.0, [1.0, 1.0, 1.0, 0.0, 1.0]), 1e-4));
    let loud: Vec<f64> = ringing(1.0, [1.0; 5]).iter().map(|x| 2.5 * x).collect();
    write(&folder.join("too loud.wav"), &noisy(loud, 1e-4));
    let report = fit(folder, &["a.wav", "too loud.wav", "--family", "-o", "family.modes.json"]);
    let body = asperity_model(folder, "family.modes.json");
    assert!(body.modes.len() > 4, "{report}");
    assert_eq!(report["modes"], body.modes.len());
    assert!(report["warnings"].to_string().contains("too loud.wav: clipping"), "{report}");
}

/// Sides of a plate held at its edges, m, and the places where it is struck.
const PLATE_M: [f64; 2] = [0.4, 0.3];
const STRUCK_M: [[f64; 2]; 4] = [[0.07, 0.05], [0.16, 0.06], [0.06, 0.13], [0.18, 0.12]];

/// The first nine shapes of that plate: orders along both sides.
fn plate_shape(mode: usize, [x, y]: [f64; 2]) -> f64 {
    let [a, b] = [1 + mode % 3, 1 + mode / 3].map(|n| n as f64 * std::f64::consts::PI);
    (a * x / PLATE_M[0]).sin() * (b * y / PLATE_M[1]).sin()
}

fn plate_hz(mode: usize) -> f64 {
    let [a, b] = [1 + mode % 3, 1 + mode / 3].map(|n| n as f64);
    210.0 * (a * a + 1.7 * b * b)
}

/// A modes file of version 2 with these shapes, computed `stiffer` times as high; `shape` says
/// whose each mode has.
fn plate_file(path: &Path, stiffer: f64, shape: impl Fn(usize) -> usize) {
    let [columns, rows] = [21, 16];
    let point = |n: usize| [n % columns, n / columns];
    let at = |n: usize| {
        let [i, j] = point(n);
        [PLATE_M[0] * i as f64 / (columns - 1) as f64, PLATE_M[1] * j as f64 / (rows - 1) as f64]
    };
    let points: Vec<[f64; 3]> = (0..columns * rows).map(|n| [at(n)[0], at(n)[1], 0.0]).collect();
    let cells = (0..columns * rows).filter(|n| point(*n)[0] + 1 < columns && point(*n)[1] + 1 < rows);
    let triangles: Vec<[usize; 3]> =
        cells.flat_map(|n| [[n, n + 1, n + columns + 1], [n, n + columns + 1, n + columns]]).collect();
    let phi = |m: usize| -> Vec<[f64; 3]> {
        (0..columns * rows).map(|n| [0.0, 0.0, plate_shape(shape(m), at(n))]).collect()
    };
    let mode = |m: usize| serde_json::json!({"frequency_hz": stiffer * plate_hz(m), "decay_per_s": 8.0, "amplitude": 0.1, "phase_rad": 1.5});
    let file = serde_json::json!({
        "format": "asperity.modes", "version": 2, "impulse_n_s": 1.0, "unit": "relative",
        "modes": (0..9).map(mode).collect::<Vec<_>>(),
        "shapes": {"points_m": points, "triangles": triangles, "gains": vec![1.0; 9],
            "phi_per_sqrt_kg": (0..9).map(phi).collect::<Vec<_>>(), "struck_point": 30},
    });
    std::fs::write(path, file.to_string()).unwrap();
}

#[test]
fn strikes_on_a_plate_are_assigned_to_their_places() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (strike, at) in STRUCK_M.iter().enumerate() {
        let hard = 1.0 - 0.15 * strike as f64;
        let sample = |n: usize| {
            let t = n as f64 / f64::from(RATE_HZ);
            let mode = |m: usize| {
                let decay = (-(6.0 + m as f64) * t).exp();
                hard * 0.1 * plate_shape(m, *at) * decay * (std::f64::consts::TAU * plate_hz(m) * t).sin()
            };
            (0..9).map(mode).sum::<f64>()
        };
        let mut samples = vec![0.0; 4410];
        samples.extend((0..2 * RATE_HZ as usize).map(sample));
        write(&folder.join(format!("{strike}.wav")), &noisy(samples, 1e-4));
    }
    plate_file(&folder.join("plate.modes.json"), 1.04, |m| m);
    plate_file(&folder.join("other.modes.json"), 1.04, |m| (4 * m + 3) % 9);
    let merged = ["0.wav", "-o", "body.modes.json", "--merge", "1.wav", "2.wav", "3.wav"];
    let placed = |mesh: &str| fit(folder, &[&merged[..], &["--mesh", mesh]].concat())["places"].clone();
    let found = placed("plate.modes.json");
    let body = std::fs::read(folder.join("body.modes.json")).unwrap();
    println!("{found}");
    assert_eq!(found["modes"], 9);
    assert!((found["frequency_factor"].as_f64().unwrap() * 1.04 - 1.0).abs() < 0.005);
    for (strike, at) in found["strikes"].as_array().unwrap().iter().zip(STRUCK_M) {
        // A plate's four quarters are alike.
        let found = [0, 1].map(|axis| strike["at_m"][axis].as_f64().unwrap());
        let off = [0, 1].map(|a| found[a].min(PLATE_M[a] - found[a]) - at[a]);
        assert!(off[0].hypot(off[1]) < 0.025, "{strike} for {at:?}");
    }
    let (own, other) =
        (found["r_squared"].as_f64().unwrap(), placed("other.modes.json")["r_squared"].clone());
    println!("R² {own:.4}, with other shapes {other}");
    assert!(own > 0.97 && other.as_f64().unwrap() < 0.9 * own);
    // The check changes nothing in what is written.
    fit(folder, &merged);
    assert!(body == std::fs::read(folder.join("body.modes.json")).unwrap());
    let refused = |mesh: &str, parts: &[&str]| {
        let all = [&["fit"], &merged[..], &["--mesh", mesh]].concat();
        assert_refused(&asperity(folder, &all), parts);
    };
    std::fs::copy(folder.join("body.modes.json"), folder.join("plain.modes.json")).unwrap();
    refused("plain.modes.json", &["plain.modes.json", "no mode shapes", "version 2"]);
    plate_file(&folder.join("high.modes.json"), 60.0, |m| m);
    refused("high.modes.json", &["high.modes.json", "in the recordings"]);
    let alone = asperity(folder, &["fit", "0.wav", "-o", "x.modes.json", "--mesh", "plate.modes.json"]);
    assert_eq!(alone.status.code(), Some(2));
}

#[test]
fn tables_of_other_programs_become_bodies_that_the_engine_reads() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    put("a.json", r#"{"cf":[440.0,880.0],"op":[-20.0,-40.0],"rt":[2.0,0.5],"synthMethod":"x"}"#);
    put("b.json", r#"[{"name":"bar","freq_ratio":[1.0,3.3],"gains":[[1.0,0.5],[0.2,-0.9]]},{"name":"no"}]"#);
    put("c.csv", "freq,t60,gain\n100,1,0.5\n250,0.5,0.25\n");
    assert_eq!(fit(folder, &["a.json", "-o", "a.modes.json", "--csv", "a.csv"])["modes"], 2);
    assert!((modes(folder, "a.modes.json")[0][2] - 0.1).abs() < 1e-12);
    let bar = ["b.json", "-o", "b.modes.json", "--entry", "bar", "--base-hz", "200", "--t60", "0.5"];
    assert_eq!(fit(folder, &bar)["positions"], 2);
    assert_eq!(asperity_model(folder, "b.modes.json").positions, [vec![0.2, -0.9]]);
    fit(folder, &["c.csv", "-o", "c.modes.json"]);
    // A spreadsheet's tabs, refused as "no header of a sound file".
    put("d.tsv", "Mode\tFrequency [Hz]\tLoss factor\n1\t100\t0.004\n2\t250\t0.006\n");
    assert_eq!(fit(folder, &["d.tsv", "-o", "d.modes.json"])["modes"], 2);
    // What was exported is imported again, and a modes file can be rescaled.
    fit(folder, &["a.csv", "-o", "again.modes.json"]);
    assert_eq!(modes(folder, "a.modes.json"), modes(folder, "again.modes.json"));
    fit(folder, &["c.modes.json", "-o", "d.modes.json", "--scale-size", "0.5"]);
    assert!((modes(folder, "d.modes.json")[0][0] - 200.0).abs() < 1e-9);
    put("bad.json", "[1, 2");
    put("none.json", "{\"cf\":[1.0]}");
    put("bad.csv", "freq\n1\n");
    let refused = |arguments: &[&str], parts: &[&str]| {
        let all = [&["fit", "-o", "x.modes.json"], arguments].concat();
        assert_refused(&asperity(folder, &all), parts);
        assert!(!folder.join("x.modes.json").exists());
    };
    refused(&["bad.json"], &["bad.json"]);
    refused(&["none.json"], &["none.json", "--t60"]);
    refused(&["bad.csv"], &["bad.csv", "decay"]);
    refused(&["b.json"], &["--entry", "\"bar\""]);
    refused(&["b.json", "--entry", "bar"], &["--base-hz"]);
    refused(&["c.csv", "--plot", "x.svg"], &["--plot"]);
}

#[test]
fn the_modal_tables_of_the_corpus_are_imported() {
    let Some(corpus) = asperity_evidence::corpus::corpus("") else { return };
    let folder = tempfile::tempdir().unwrap();
    for (file, arguments, modes) in [
        ("tdw_ceramic_0_mm.json", &[][..], 349),
        ("tdw_wood_medium_0_mm.json", &[][..], 224),
        ("tdw_stone_1_mm.json", &[][..], 10),
        ("faust_measured_bodies.json", &["--entry", "roundBigCenter"][..], 40),
        ("faust_bells_bars.json", &["--entry", "marimbaBar", "--base-hz", "220", "--t60", "0.4"][..], 50),
        ("stk_modalbar.json", &["--entry", "Marimba", "--base-hz", "220"][..], 4),
        ("csound_modal_ratios.json", &["--entry", "Dahina tabla", "--base-hz", "200", "--t60", "1"][..], 6),
    ] {
        let path = corpus.join("modal").join(file);
        let all = [&[path.to_str().unwrap(), "-o", "x.modes.json"], arguments].concat();
        let report = fit(folder.path(), &all);
        assert_eq!(report["modes"], modes, "{file}: {report}");
        assert_eq!(asperity_model(folder.path(), "x.modes.json").modes.len(), modes, "{file}");
    }
}

#[test]
fn whatever_is_recorded_gives_a_result_with_warnings_and_no_absurd_mode() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let sine: Vec<f64> = (0..33_000).map(|n| 0.5 * (0.1431 * f64::from(n)).sin()).collect();
    let loud = ringing(0.7, [1.0; 5]).into_iter().map(|x| (4.0 * x).clamp(-0.6, 0.6)).collect();
    let mut twice = ringing(0.8, [1.0; 5]);
    ringing(0.4, [0.8; 5]).into_iter().enumerate().for_each(|(n, x)| twice[17_000 + n] += x);
    let offset = ringing(0.7, [1.0; 5]).into_iter().map(|x| x + 0.1).collect();
    for (name, samples, warning) in [
        ("noise.wav", vec![0.0; 33_000], "no modes"),
        ("sine.wav", sine, "undamped"),
        ("short.wav", ringing(0.008, [1.0; 5]), "too short"),
        ("clipped.wav", loud, "clipping"),
        ("dc.wav", offset, "offset"),
        ("twice.wav", twice, "second strike"),
    ] {
        let level = match name {
            "noise.wav" => 0.05,
            "clipped.wav" => 0.0,
            _ => 1e-4,
        };
        write(&folder.join(name), &noisy(samples, level));
        let report = fit(folder, &[name, "-o", "x.modes.json", "--max-modes", "40"]);
        assert!(says(&report, warning), "{name}: {report}");
        for [hz, decay, amplitude] in modes(folder, "x.modes.json") {
            assert!(
                hz > 0.0 && decay > 0.0 && (0.0..=16.0).contains(&amplitude),
                "{name}: {hz} {decay} {amplitude}"
            );
        }
    }
}

#[test]
fn a_body_that_the_engine_would_refuse_is_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(folder.join("loud.wav"), spec).unwrap();
    for (n, x) in noisy(vec![0.0; 30_000], 1e18).into_iter().enumerate() {
        writer.write_sample((x * (-5e-4 * n as f64).exp()) as f32).unwrap();
    }
    writer.finalize().unwrap();
    let all = ["fit", "loud.wav", "-o", "x.modes.json", "--bands", "--max-modes", "4", "--plot", "x.svg"];
    assert_refused(&asperity(folder, &all), &["x.svg", "energy", "is refused"]);
    assert!(!folder.join("x.modes.json").exists() && !folder.join("x.svg").exists());
}

#[test]
fn files_that_are_no_recordings_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    recording(folder, "good.wav");
    let bytes = std::fs::read(folder.join("good.wav")).unwrap();
    write(&folder.join("silence.wav"), &vec![0.0; 30_000]);
    write(&folder.join("constant.wav"), &vec![0.25; 30_000]);
    std::fs::write(folder.join("text.wav"), "no sound at all\n".repeat(99)).unwrap();
    std::fs::write(folder.join("empty.wav"), "").unwrap();
    std::fs::write(folder.join("head.wav"), &bytes[..30]).unwrap();
    for name in ["silence.wav", "constant.wav", "text.wav", "empty.wav", "head.wav", "missing.wav", "."] {
        assert_refused(&asperity(folder, &["fit", name, "-o", "x.modes.json"]), &[name]);
    }
    for (option, value) in [
        ("--impulse", "0"),
        ("--max-modes", "0"),
        ("--scale-size", "-1"),
        ("--material", "x"),
        ("--channel", "left"),
        ("--channel", "3"),
        ("--from-hz", "40000"),
        ("--start-ms", "-4"),
        ("--burst-ms", "9999"),
    ] {
        let argument = format!("{option}={value}");
        let run = asperity(folder, &["fit", "good.wav", "-o", "x.modes.json", &argument]);
        assert_refused(&run, &[]);
    }
    assert!(!folder.join("x.modes.json").exists());
    // A file that breaks off is a recording with a warning.
    std::fs::write(folder.join("cut.wav"), &bytes[..bytes.len() / 2 + 1]).unwrap();
    assert!(says(&fit(folder, &["cut.wav", "-o", "x.modes.json"]), "truncated"));
}

#[test]
fn of_ten_minutes_the_strike_is_found_and_fitted() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 8_000,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(folder.join("long.wav"), spec).unwrap();
    for (n, noise) in noisy(vec![0.0; 600 * 8_000], 1e-4).into_iter().enumerate() {
        let t = n as f64 / 8_000.0 - 300.0;
        let ring = if t < 0.0 { 0.0 } else { 0.5 * (-2.0 * t).exp() * (6000.0 * t).sin() };
        writer.write_sample((32_767.0 * (ring + noise)).round() as i16).unwrap();
    }
    writer.finalize().unwrap();
    let report = fit(folder, &["long.wav", "-o", "x.modes.json"]);
    assert_eq!(report["modes"], 1, "{report}");
    assert!((report["onset_s"].as_f64().unwrap() - 300.0).abs() < 1e-3 && says(&report, "long file"));
}
