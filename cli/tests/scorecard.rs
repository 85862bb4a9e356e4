//! `asperity scorecard`: figures beside their anchors, failures first, the same in every run.

use crate::support;

use serde_json::Value;
use std::fs;
use std::path::Path;
use support::{asperity, assert_refused, message};

/// A folder with the recording of one hit: three modes, and a note that is no sound.
fn hit(folder: &Path) {
    fs::create_dir(folder).unwrap();
    fs::write(folder.join("notes.txt"), "struck with a pen").unwrap();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut file = hound::WavWriter::create(folder.join("hit.wav"), spec).unwrap();
    for n in 0..44_100 {
        let t = f64::from(n - 2205) / 44_100.0;
        let mode = |hz: f64, decay: f64| (-decay * t).exp() * (std::f64::consts::TAU * hz * t).sin();
        let sample = if t > 0.0 { mode(440.0, 8.0) + mode(1210.0, 14.0) + mode(2530.0, 25.0) } else { 0.0 };
        file.write_sample(0.2 * sample as f32).unwrap();
    }
    file.finalize().unwrap();
}

#[test]
fn a_folder_without_a_recording_is_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    for missing in ["empty", "nowhere"] {
        let all = ["scorecard", "--quick", "--recordings", missing, "-o", "card"];
        assert_refused(&asperity(folder.path(), &all), &[missing, "folder of recordings"]);
        assert!(!folder.path().join("card/scorecard.json").exists());
    }
}

#[test]
fn two_quick_scorecards_are_one_but_for_speed_and_failures_come_first() {
    let folder = tempfile::tempdir().unwrap();
    hit(&folder.path().join("hits"));
    let card = |name: &str| -> Value {
        let all = ["scorecard", "--quick", "--json", "--recordings", "hits", "-o", name];
        let (status, out, err) = message(&asperity(folder.path(), &all));
        assert_eq!((status, err.as_str()), (0, ""));
        let written = fs::read_to_string(folder.path().join(name).join("scorecard.json")).unwrap();
        assert_eq!(out, written);
        let mut card: Value = serde_json::from_str(&out).unwrap();
        for row in card["rows"].as_array_mut().unwrap() {
            assert!(
                row["ours"].is_number() && row["command"].as_str().unwrap().starts_with("asperity "),
                "{row}"
            );
            assert!(row["bound"].as_array().unwrap().len() == 2 && row["source"].is_string(), "{row}");
            if row["name"].as_str().unwrap().starts_with("speed") {
                row["ours"] = Value::Null;
            }
        }
        card
    };
    let (one, two) = (card("one"), card("two"));
    assert_eq!(one, two);
    let rows = one["rows"].as_array().unwrap();
    let passes: Vec<bool> = rows.iter().map(|row| row["pass"].as_bool().unwrap()).collect();
    assert!(passes.windows(2).all(|pair| pair[0] <= pair[1]), "{passes:?}");
    let names: Vec<&str> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
    for begin in [
        "modal bank",
        "fit of made",
        "fit of 1 recording: SNR from the onset, median",
        "path behind its reports",
        "six plates by sound, second",
        "seven materials",
        "growth",
        "port ",
        "speed",
        "shuffled labels",
        "a plate against itself",
    ] {
        assert!(names.iter().any(|name| name.starts_with(begin)), "{begin}: {names:?}");
    }
    let matrix = &one["confusion"]["six plates by touch, first observer"];
    assert_eq!((matrix["labels"].as_array().unwrap().len(), &matrix["paper"]), (6, &Value::Null));
    assert_eq!(one["observers"][0]["sha256"].as_str().unwrap().len(), 64);
    let page = fs::read_to_string(folder.path().join("one/index.html")).unwrap();
    assert!(page.contains("six plates by both") && !page.contains("http") && !page.contains("<script"));
}
