//! `asperity demo`, `headroom` and `report` from outside.

use crate::support;

use std::fs;
use std::path::Path;
use std::time::Instant;
use support::{asperity, message};

fn samples(path: &Path) -> Vec<f32> {
    let mut reader = hound::WavReader::open(path).unwrap();
    reader.samples::<f32>().map(Result::unwrap).collect()
}

fn rms(samples: &[f32]) -> f64 {
    (samples.iter().map(|&sample| f64::from(sample).powi(2)).sum::<f64>() / samples.len() as f64).sqrt()
}

/// Five knocks each on four bodies: heard, and what does not ring is gone between them.
fn every_knock_is_heard(demo: &Path) {
    let audio = samples(&demo.join("knuckle.audio.wav"));
    let log = fs::read_to_string(demo.join("knuckle.jsonl")).unwrap();
    let lines = log.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let mut knocks = 0;
    for knock in lines {
        knocks += 1;
        let from = |after_s: f64| ((knock["t"].as_f64().unwrap() + after_s) * 44_100.0) as usize;
        let [at_first, later] =
            [0.0, 0.09].map(|s| 20.0 * rms(&audio[from(s)..from(s + 0.03)]).max(1e-9).log10());
        let body = knock["body"].as_str().unwrap();
        println!("{body}: {at_first:.1} dBFS, then {later:.1}");
        assert!(at_first > -60.0, "{body}: {at_first} dB");
        if ["box", "curtain"].contains(&body) {
            assert!(later < at_first - 8.0, "{body}: {at_first}, then {later} dB");
        }
    }
    assert_eq!(knocks, 20);
}

#[test]
fn the_demo_writes_scenes_that_sound_with_pictures_and_an_index() {
    let folder = tempfile::tempdir().unwrap();
    let began = Instant::now();
    let (status, out, err) = message(&asperity(folder.path(), &["demo"]));
    assert_eq!((status, err.as_str()), (0, ""));
    // Ten seconds on two idle cores; tests share them with others.
    assert!(began.elapsed().as_secs() < 60, "took {:?}", began.elapsed());
    assert!(out.contains("index.html"), "{out}");
    let demo = folder.path().join("demo-out");
    let index = fs::read_to_string(demo.join("index.html")).unwrap();
    let readme = fs::read_to_string(demo.join("README.txt")).unwrap();
    let mut scenes = 0;
    for entry in fs::read_dir(&demo).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        scenes += 1;
        let name = path.file_stem().unwrap().to_str().unwrap();
        let audio = samples(&demo.join(format!("{name}.audio.wav")));
        let haptic = samples(&demo.join(format!("{name}.haptic.wav")));
        assert_eq!(audio.len(), haptic.len(), "{name}");
        assert!(audio.iter().chain(&haptic).all(|sample| sample.is_finite()), "{name}");
        let peak = audio.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
        assert!((0.02..=1.0).contains(&peak), "{name} peaks at {peak}");
        if !["struck", "knuckle", "answering", "bowl"].contains(&name) {
            let peak = haptic.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
            assert!((0.02..=1.0).contains(&peak), "{name} is felt with {peak}");
        }
        assert!(fs::read_to_string(demo.join(format!("{name}.svg"))).unwrap().ends_with("</svg>\n"));
        assert!(
            index.contains(&format!("{name}.audio.wav")) && readme.contains(&format!("{name}: ")),
            "{name}"
        );
    }
    assert!(scenes >= 8, "{scenes} scenes");
    every_knock_is_heard(&demo);
    let plate = |name: &str| samples(&demo.join(format!("{name}.audio.wav")));
    let (matte_first, shiny_first) = (plate("matte-shiny"), plate("shiny-matte"));
    let slow = 13_000..35_000;
    assert!(
        rms(&matte_first[slow.clone()]) > 2.0 * rms(&shiny_first[slow]),
        "the matte half is louder than the shiny one"
    );
    // Every material is heard while it is stroked, not only where the finger lands.
    let log = fs::read_to_string(demo.join("materials.jsonl")).unwrap();
    let lines = log.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let heard: Vec<(String, f64)> = lines
        .filter(|line| line["event"] == "begin")
        .map(|line| {
            let at = |after_s: f64| ((line["t"].as_f64().unwrap() + after_s) * 44_100.0) as usize;
            let level_db = 20.0 * rms(&plate("materials")[at(0.35)..at(0.75)]).log10();
            (line["surface"].as_str().unwrap().to_owned(), level_db)
        })
        .collect();
    assert!(heard.len() == 7 && heard.iter().all(|(_, level_db)| *level_db > -45.0), "{heard:?}");
    let softest = heard.iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    let loudest = heard.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    assert_eq!((softest.0.as_str(), loudest.0.as_str()), ("pebbles", "sandpaper"), "{heard:?}");
}

#[test]
fn headroom_reports_every_promised_row() {
    let folder = tempfile::tempdir().unwrap();
    let began = Instant::now();
    let (status, out, err) = message(&asperity(folder.path(), &["headroom", "--json"]));
    assert_eq!((status, err.as_str()), (0, ""));
    // Half a minute on two idle cores; tests share theirs with others.
    assert!(began.elapsed().as_secs() < 180, "took {:?}", began.elapsed());
    let report: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(
        report["cpu"].is_string()
            && report["block_frames"].is_number()
            && report["sample_rate_hz"].is_number()
    );
    let rows = |list: &str| report[list].as_array().unwrap().clone();
    for scene in rows("scenes") {
        assert!(scene["name"].is_string());
        for field in
            ["contacts", "modes", "real_time_factor", "samples_per_s", "block_p50_us", "block_p99_9_us"]
        {
            assert!(scene[field].is_number(), "{scene}");
        }
    }
    let banks: Vec<u64> = rows("modal_bank").iter().map(|row| row["modes"].as_u64().unwrap()).collect();
    assert_eq!(banks, [16, 64, 256, 1024, 4096]);
    assert!(rows("modal_bank").iter().all(|row| row["mode_samples_per_s"].as_f64().unwrap() > 1e6));
    let contact = rows("contact");
    let integrators: Vec<&str> = contact.iter().map(|row| row["integrator"].as_str().unwrap()).collect();
    assert_eq!(integrators, ["semi-implicit-euler", "exact-event", "energy-conserving"]);
    // The whole chain of one contact beside the kernels that it is made of: the rest is glue, and
    // it may not grow.
    let kernels = &report["kernels"];
    assert_eq!(kernels["rows"].as_array().unwrap().len(), 6);
    let times = kernels["chain_over_kernels"].as_f64().unwrap();
    println!("the chain takes {times:.2} times its kernels: {kernels}");
    assert!((1.0..2.5).contains(&times), "{kernels}");
    let pairs = report["paired"]["rows"].as_array().unwrap();
    for what in [
        "64 contacts beside 1, each",
        "blocks of 16 frames beside 64",
        "2 threads beside 1",
        "2 threads, helper asleep",
    ] {
        assert!(pairs.iter().any(|pair| pair["what"] == what), "{what}");
    }
    assert!(pairs.iter().all(|pair| pair["times_the_first"].as_f64().unwrap() > 0.0), "{pairs:?}");
    assert!(report["paired"]["two_busy_loops"].as_f64().unwrap() > 0.0);
}

#[test]
fn the_report_covers_every_axis_with_named_references() {
    let folder = tempfile::tempdir().unwrap();
    let (status, _, err) = message(&asperity(folder.path(), &["report", "-o", "figures"]));
    assert_eq!((status, err.as_str()), (0, ""));
    let path = |name: &str| folder.path().join("figures").join(name);
    let text = fs::read_to_string(path("speed_vs_error.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows = report["rows"].as_array().unwrap();
    let error = |choice: &str| {
        let row = rows.iter().find(|row| row["choice"] == choice).unwrap();
        row["error"].as_f64().unwrap()
    };
    for axis in
        ["integrator", "path", "map filter", "noise octaves", "mode culling", "number format", "block size"]
    {
        let members: Vec<_> = rows.iter().filter(|row| row["axis"] == axis).collect();
        assert!(members.len() >= 3, "{axis}");
        for row in members {
            assert!(row["ns_per_sample"].as_f64().unwrap() > 0.0, "{row}");
            assert!(row["error"].as_f64().unwrap() >= 0.0, "{row}");
            assert!(!row["reference"].as_str().unwrap().is_empty(), "{row}");
        }
    }
    assert!(error("exact-event") < error("semi-implicit-euler"));
    assert!(error("semi-implicit-euler") < error("semi-implicit-euler-explicit"));
    assert!(error("extrapolate") < 0.1 * error("hold"));
    assert!(error("band-limited") < 0.1 * error("hold"));
    assert!(error("cubic B-spline with slope and mip levels") < 0.01 * error("bilinear (not offered)"));
    assert_eq!(error("4096 frames"), 0.0);
    assert!(path("speed_vs_error.svg").exists() && path("speed_vs_error.md").exists());
}
