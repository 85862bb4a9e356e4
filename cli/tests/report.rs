//! `asperity report` from outside: its tables, its scenes, and its errors against an integration
//! that shares no code with the engine.

use crate::support;

use serde_json::Value;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use support::{asperity, message};

const CASES: [&str; 6] = ["smooth", "rough", "bouncing", "steep", "fast", "light"];
/// Seeds that the report does not draw its profiles from.
const UNSEEN: std::ops::Range<u64> = 101..125;
/// So many of them are enough where strokes forget how they came to where they are.
const FORGETTING: usize = 4;
const RATE_HZ: f64 = 44_100.0;
/// Of the heights that are integrated over.
const FINE: usize = 8;

/// The report, made once for all tests.
fn report() -> (&'static Path, &'static Value) {
    static MADE: OnceLock<(tempfile::TempDir, Value)> = OnceLock::new();
    let (folder, report) = MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let (status, _, err) = message(&asperity(folder.path(), &["report", "-o", "."]));
        assert_eq!((status, err.as_str()), (0, ""));
        let text = fs::read_to_string(folder.path().join("speed_vs_error.json")).unwrap();
        (folder, serde_json::from_str(&text).unwrap())
    });
    (folder.path(), report)
}

fn rows(axis: &str) -> Vec<&'static Value> {
    report().1["rows"].as_array().unwrap().iter().filter(|row| row["axis"] == axis).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

#[test]
fn every_integrator_has_its_error_on_every_named_case() {
    let integrators = rows("integrator");
    assert_eq!(integrators.len(), 4);
    for row in integrators {
        let cases = row["cases"].as_array().unwrap();
        let names: Vec<&str> = cases.iter().map(|case| case["name"].as_str().unwrap()).collect();
        assert_eq!(names, CASES);
        let errors: Vec<f64> = cases
            .iter()
            .flat_map(|case| ["displacement", "contact_force", "output"].map(|of| number(&case[of])))
            .collect();
        let worst = errors.iter().copied().fold(0.0, f64::max);
        let mean = (errors.iter().map(|error| error.ln()).sum::<f64>() / errors.len() as f64).exp();
        assert_eq!([number(&row["error"]), number(&row["worst"])], [worst; 2]);
        assert!((number(&row["geometric_mean"]) / mean - 1.0).abs() < 1e-9);
        println!("{}: worst {worst:.2e}, geometric mean {mean:.2e}", row["choice"]);
        for case in cases {
            println!("    {case}");
        }
    }
}

#[test]
fn every_case_is_a_scene_that_renders() {
    let folder = report().0.join("cases");
    for name in CASES {
        let stem = format!("{name}.out");
        let (status, out, err) =
            message(&asperity(&folder, &["render", &format!("{name}.toml"), "-o", &stem, "--json"]));
        assert_eq!((status, err.as_str()), (0, ""), "{name}");
        let render: Value = serde_json::from_str(&out).unwrap();
        assert!(number(&render["audio_peak"]) > 0.0 && number(&render["haptic_peak"][0]) > 0.0, "{name}");
    }
}

/// Columns of a trace.
#[derive(Default)]
struct Trace {
    begin: usize,
    height_m: Vec<f64>,
    pad_m: Vec<f64>,
    pad_m_s: Vec<f64>,
    finger_m: Vec<f64>,
    force_n: Vec<f64>,
}

fn trace(folder: &Path, scene: &str, more: &[&str], rate_hz: f64) -> Trace {
    let mut arguments = vec!["render", scene, "-o", "take", "--trace"];
    arguments.extend(more);
    let (status, _, err) = message(&asperity(folder, &arguments));
    assert_eq!((status, err.as_str()), (0, ""));
    let text = fs::read_to_string(folder.join("take.trace.csv")).unwrap();
    let mut trace = Trace::default();
    for (index, line) in text.lines().skip(1).enumerate() {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        if index == 0 {
            trace.begin = (fields[0] * rate_hz).round() as usize;
        }
        trace.height_m.push(fields[4]);
        trace.pad_m.push(fields[6]);
        trace.pad_m_s.push(fields[7]);
        trace.finger_m.push(fields[8]);
        trace.force_n.push(fields[9]);
    }
    trace
}

/// The fingertip of the cases: m_s, k_s, b_s, m_f, k_m.
const PROBE: [f64; 5] = [0.15e-3, 1000.0, 2.0, 0.02, 2e5];

/// Rates of change of pad and finger, places and speeds.
fn rates([x, v, y, w]: [f64; 4], height_m: f64, force_n: f64) -> [f64; 4] {
    let [pad_kg, spring, damper, finger_kg, stiffness] = PROBE;
    let between = spring * (x - y) + damper * (v - w);
    let contact = stiffness * (height_m - x).max(0.0);
    [v, (contact - between) / pad_kg, w, (between - force_n) / finger_kg]
}

/// A cubic through four heights, between the second and the third.
fn cubic(h: &[f64], x: f64) -> f64 {
    let [a, b, c, d] = [h[0], h[1], h[2], h[3]];
    b + 0.5 * x * (c - a + x * (2.0 * a - 5.0 * b + 4.0 * c - d + x * (3.0 * (b - c) + d - a)))
}

impl Trace {
    /// What the probe does at a sample: places and speeds of pad and finger.
    fn state(&self, sample: usize, rate_hz: f64) -> [f64; 4] {
        let finger_m_s = 0.5 * (self.finger_m[sample + 1] - self.finger_m[sample - 1]) * rate_hz;
        [self.pad_m[sample], self.pad_m_s[sample], self.finger_m[sample], finger_m_s]
    }
}

/// Pad displacement and mean contact force of each fine step (the mean belongs to the step that
/// ends there), by the classical Runge–Kutta scheme in four steps each, from what the probe does at
/// a sample: how a contact is led in is not asked here.
fn integrated(trace: &Trace, from: usize, force_n: f64) -> (Vec<f64>, Vec<f64>) {
    const STEPS: usize = 4;
    let fine_hz = RATE_HZ * FINE as f64;
    let h = 1.0 / (fine_hz * STEPS as f64);
    let mut state = trace.state(from, fine_hz);
    let (mut pads, mut means) = (vec![state[0]; from + 1], vec![force_n; from + 1]);
    let add = |a: [f64; 4], b: [f64; 4], s: f64| [0, 1, 2, 3].map(|i| a[i] + s * b[i]);
    for four in trace.height_m[from - 1..].windows(4) {
        let mut sum = 0.0;
        for step in 0..STEPS {
            let at = |part: f64| cubic(four, (step as f64 + part) / STEPS as f64);
            let [h0, h1, h2] = [at(0.0), at(0.5), at(1.0)];
            let k1 = rates(state, h0, force_n);
            let k2 = rates(add(state, k1, 0.5 * h), h1, force_n);
            let k3 = rates(add(state, k2, 0.5 * h), h1, force_n);
            let k4 = rates(add(state, k3, h), h2, force_n);
            let push = |state: [f64; 4], height: f64| PROBE[4] * (height - state[0]).max(0.0);
            sum += push(state, h0);
            let middle = push(add(state, k2, 0.5 * h), h1);
            for i in 0..4 {
                state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
            sum += 4.0 * middle + push(state, h2);
        }
        pads.push(state[0]);
        means.push(sum / (6 * STEPS) as f64);
    }
    (pads, means)
}

/// Rms of the difference over the alternating rms of the reference.
fn relative_error(found: &[f64], reference: &[f64]) -> f64 {
    let mean = reference.iter().sum::<f64>() / reference.len() as f64;
    let apart: f64 = found.iter().zip(reference).map(|(a, b)| (a - b).powi(2)).sum();
    let all: f64 = reference.iter().map(|r| (r - mean).powi(2)).sum();
    (apart / all).sqrt()
}

/// A folder with a case's scene on ground of another seed.
fn unseen(case: &str, seed: u64) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let from = report().0.join("cases");
    for name in ["plate.modes.json".to_owned(), format!("{case}.jsonl"), format!("{case}.toml")] {
        fs::copy(from.join(&name), folder.path().join(&name)).unwrap();
    }
    // Numbers from a seed, 0 to 1.
    let mut state = seed;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let height: Option<Box<dyn Fn(f64) -> f64>> = match case {
        "smooth" => {
            let waves: Vec<[f64; 2]> =
                (0..3).map(|_| [47.0 + (93.0 * uniform()).round(), uniform()]).collect();
            Some(Box::new(move |x| {
                0.5 + waves.iter().map(|[n, phase]| (TAU * (n * x + phase)).sin()).sum::<f64>() / 6.0
            }))
        }
        "bouncing" => {
            let (periods, phase) = (124.0 + (32.0 * uniform()).round(), uniform());
            Some(Box::new(move |x| 0.5 + 0.5 * (TAU * (periods * x + phase)).sin()))
        }
        "steep" => {
            let (teeth, phase) = (25.0 + (6.0 * uniform()).round(), uniform());
            Some(Box::new(move |x| {
                let along = (teeth * x + phase).fract();
                if along < 0.94 { along / 0.94 } else { (1.0 - along) / 0.06 }
            }))
        }
        _ => None,
    };
    if let Some(height) = height {
        let grey =
            |x: u32, _| image::Luma([(height((f64::from(x) + 0.5) / 2048.0) * 65_535.0).round() as u16]);
        image::ImageBuffer::from_fn(2048, 4, grey).save(folder.path().join(format!("{case}.png"))).unwrap();
    }
    let path = folder.path().to_owned();
    (folder, path)
}

/// Whether a stroke whose path is moved by a picometre moves the pad, and presses on it, as it did,
/// within −80 dB.
fn forgets(case: &str, seed: u64) -> bool {
    let (_keep, folder) = unseen(case, seed);
    let (scene, log, seed) = (format!("{case}.toml"), folder.join(format!("{case}.jsonl")), seed.to_string());
    let here = trace(&folder, &scene, &["--seed", &seed], RATE_HZ);
    let moved = fs::read_to_string(&log).unwrap();
    let moved = moved.lines().map(|line| {
        let mut line: Value = serde_json::from_str(line).unwrap();
        if let Some(u) = line["uv"][0].as_f64() {
            line["uv"][0] = (u + 1e-12 / 0.14).into();
        }
        format!("{line}\n")
    });
    fs::write(&log, moved.collect::<String>()).unwrap();
    let there = trace(&folder, &scene, &["--seed", &seed], RATE_HZ);
    let compared = (0.1 * RATE_HZ) as usize..(0.4 * RATE_HZ) as usize;
    assert!(there.pad_m != here.pad_m, "{case}: it was not moved");
    // What is heard is as far apart as the force.
    [(&there.pad_m, &here.pad_m), (&there.force_n, &here.force_n)]
        .into_iter()
        .all(|(there, here)| relative_error(&there[compared.clone()], &here[compared.clone()]) < 1e-4)
}

#[test]
fn stated_errors_hold_within_a_factor_of_two() {
    let mut wrong = Vec::new();
    for case in CASES {
        let scene = format!("{case}.toml");
        let integrators = rows("integrator");
        // As the report states them: of strokes that forget, if there are two, otherwise of all.
        let forget: Vec<u64> = UNSEEN.take(FORGETTING).filter(|seed| forgets(case, *seed)).collect();
        let seeds = if forget.len() > 1 { forget } else { UNSEEN.collect() };
        println!("{case}: seeds {seeds:?}");
        let mut squares = vec![[0.0; 2]; integrators.len()];
        for seed in seeds.iter().copied() {
            let (_keep, folder) = unseen(case, seed);
            let seed = seed.to_string();
            let fine_hz = RATE_HZ * FINE as f64;
            let fine = trace(&folder, &scene, &["--seed", &seed, "--rate", &fine_hz.to_string()], fine_hz);
            let log = fs::read_to_string(folder.join(format!("{case}.jsonl"))).unwrap();
            let first: Value = serde_json::from_str(log.lines().next().unwrap()).unwrap();
            let (pads, means) =
                integrated(&fine, (0.05 * fine_hz) as usize, number(&first["normal_force_n"]));
            for (row, squares) in integrators.iter().zip(&mut squares) {
                let choice = row["choice"].as_str().unwrap();
                let own = trace(&folder, &scene, &["--seed", &seed, "--integrator", choice], RATE_HZ);
                let ahead = if choice.starts_with("semi-implicit") { FINE / 2 } else { 0 };
                let (mut pad_m, mut force_n) = (Vec::new(), Vec::new());
                let compared = (0.1 * RATE_HZ) as usize..(0.4 * RATE_HZ) as usize;
                for n in compared.clone() {
                    let at = (own.begin + n) * FINE - fine.begin;
                    pad_m.push(pads[at]);
                    let end = at + ahead + 1;
                    force_n.push(means[end - FINE..end].iter().sum::<f64>() / FINE as f64);
                }
                squares[0] += relative_error(&own.pad_m[compared.clone()], &pad_m).powi(2);
                squares[1] += relative_error(&own.force_n[compared], &force_n).powi(2);
            }
        }
        for (row, squares) in integrators.iter().zip(&squares) {
            let stated =
                row["cases"].as_array().unwrap().iter().find(|stated| stated["name"] == case).unwrap();
            for (of, square) in ["displacement", "contact_force"].into_iter().zip(squares) {
                let (found, stated) = ((square / seeds.len() as f64).sqrt(), number(&stated[of]));
                let ratio = found / stated;
                println!(
                    "{case}, {}, {of}: stated {stated:.2e}, found {found:.2e}, {ratio:.2}",
                    row["choice"]
                );
                if !(0.5..=2.0).contains(&ratio) {
                    wrong.push(format!("{case}, {}, {of}: {ratio:.2}", row["choice"]));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn presets_err_less_the_more_they_cost_and_tell_which_stage_errs() {
    let presets = report().1["end_to_end"].as_array().unwrap();
    let names: Vec<&str> = presets.iter().map(|preset| preset["preset"].as_str().unwrap()).collect();
    assert_eq!(names, ["fast", "default", "accurate"]);
    for preset in presets {
        println!("{preset:#}");
        let sum: f64 = preset["stages"].as_object().unwrap().values().map(number).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{preset}");
        assert!(number(&preset["ns_per_sample"]) > 0.0);
    }
    let error_db = |which: usize| number(&presets[which]["error_db"]);
    assert!(error_db(2) < error_db(1) && error_db(1) < error_db(0) - 15.0);
    // What each is felt and heard as where the contact forgets how it came to where it is. In
    // `fast` the ground is looked at midway between samples, in `light` at the quarters too.
    // `rough` hardly forgets: of other seeds it does not.
    let most = [
        ("default", "smooth", -85.0, -68.0),
        ("default", "bouncing", -72.0, -60.0),
        ("default", "steep", -80.0, -52.0),
        ("default", "fast", -65.0, -52.0),
        ("default", "light", -70.0, -55.0),
        ("accurate", "smooth", -105.0, -64.0),
        ("accurate", "bouncing", -95.0, -72.0),
        ("accurate", "steep", -100.0, -70.0),
        ("accurate", "fast", -95.0, -67.0),
        ("accurate", "light", -95.0, -70.0),
    ];
    for (preset, name, felt_db, heard_db) in most {
        let preset = presets.iter().find(|found| found["preset"] == preset).unwrap();
        let cases = preset["cases"].as_array().unwrap();
        let case = cases.iter().find(|case| case["name"] == name).unwrap();
        assert!(case["contractive"] == true && number(&case["felt_db"]) <= felt_db, "{case}");
        assert!(number(&case["heard_db"]) <= heard_db, "{case}");
    }
}

#[test]
fn sixty_reports_a_second_keep_coarse_gratings_and_rough_levels() {
    let strokes = report().1["from_reports"].as_array().unwrap();
    for stroke in strokes {
        println!("{stroke}");
        if stroke["name"] == "rough plate" {
            assert!(
                number(&stroke["felt_levels_db"]).max(number(&stroke["heard_levels_db"])) <= 1.0,
                "{stroke}"
            );
        } else {
            assert!(number(&stroke["felt_db"]).max(number(&stroke["heard_db"])) <= -30.0, "{stroke}");
        }
    }
    assert_eq!(strokes.len(), 6);
}

#[test]
fn every_choice_has_its_errors_on_the_named_cases() {
    let contact = ["displacement", "contact_force", "output"].as_slice();
    for (axis, fields, some) in [
        ("integrator", contact, None),
        ("oversampling", contact, None),
        ("path, on the cases", contact, None),
        ("map filter, on the cases", contact, Some(["smooth", "bouncing", "steep"])),
        ("noise octaves, on the cases", contact, Some(["rough", "fast", "light"])),
        ("exciter", &["output"], None),
        ("mode culling", &["output"], None),
        ("mode sleep, on the cases", &["output"], None),
        ("load shedding", &["output"], None),
        ("number format", &["output"], None),
    ] {
        let rows = rows(axis);
        // Load leaves out modes at one level.
        let least = if axis == "load shedding" { 2 } else { 3 };
        assert!(rows.len() >= least, "{axis}");
        let wanted: Vec<&str> = some.map_or(CASES.to_vec(), |some| some.to_vec());
        for row in rows {
            let cases = row["cases"].as_array().unwrap();
            let names: Vec<&str> = cases.iter().map(|case| case["name"].as_str().unwrap()).collect();
            assert_eq!(names, wanted, "{axis}");
            let errors: Vec<f64> =
                cases.iter().flat_map(|case| fields.iter().map(|of| number(&case[*of]))).collect();
            assert_eq!(number(&row["worst"]), errors.iter().copied().fold(0.0, f64::max), "{axis}");
            assert_eq!(row["latency_ms"].is_number(), axis.starts_with("path"), "{axis}");
            println!(
                "{axis}, {}: {:.1e} worst, {:.1e}",
                row["choice"],
                number(&row["worst"]),
                number(&row["geometric_mean"])
            );
        }
    }
}

#[test]
fn more_inner_samples_err_less_and_the_finer_map_reading_wins() {
    let means = |axis| -> Vec<f64> { rows(axis).iter().map(|row| number(&row["geometric_mean"])).collect() };
    let inner = means("oversampling");
    assert!(inner.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{inner:?}");
    let maps = means("map filter, on the cases");
    assert!(maps[2] < 0.3 * maps[1] && maps[1] < maps[0], "{maps:?}");
}

#[test]
fn every_level_of_load_saves_and_states_its_losses() {
    let levels = report().1["load"].as_array().unwrap();
    assert_eq!(levels.len(), 6);
    for level in levels {
        println!("{level}");
    }
    for (of, least) in [("stroke", 0.9), ("strike", 0.99)] {
        let within: Vec<f64> = levels.iter().map(|level| number(&level[of]["within_1_db"])).collect();
        assert_eq!(within[0], 1.0);
        assert!(within[1] >= least, "the first level is hardly heard: {within:?}");
        assert_eq!(number(&levels[0][of]["excitation_db"]), 0.0);
    }
    // A tenth each by the engine's own weights; shares are medians of blocks in turn.
    let shares: Vec<f64> = levels.iter().map(|level| number(&level["share"])).collect();
    assert!(shares.windows(2).all(|pair| pair[1] < 0.95 * pair[0]), "{shares:?}");
    assert!(shares[5] < 0.5, "{shares:?}");
    // Modes are not felt.
    assert!(levels[..2].iter().all(|level| number(&level["felt_worst_db"]) == 0.0));
    let text = fs::read_to_string(report().0.join("speed_vs_error.md")).unwrap();
    assert!(text.contains("## levels of load"));
    // A page that a person reads.
    assert!(text.lines().count() <= 100, "{} lines", text.lines().count());
}
