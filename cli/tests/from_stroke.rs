//! `asperity texture from-stroke` from the outside: a stroke that the engine rendered is read and
//! played elsewhere; what is no stroke is refused in one line.

use crate::support::{asperity, assert_refused, message};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

const RATE_HZ: f64 = 4000.0;

/// Acceleration-like noise whose spectrum falls, with a line.
fn vibration(seconds: f64, line_hz: f64) -> Vec<f64> {
    let mut state = 9u64;
    let mut low = 0.0;
    (0..(seconds * RATE_HZ) as usize)
        .map(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let white = (state >> 40) as f64 / f64::from(1u32 << 23) - 1.0;
            low += 0.2 * (white - low);
            0.3 * low + 0.05 * (TAU * line_hz * i as f64 / RATE_HZ).sin()
        })
        .collect()
}

fn csv(path: &Path, header: &str, rows: impl Iterator<Item = Vec<f64>>) {
    let mut text = format!("{header}\n");
    for row in rows {
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        writeln!(text, "{}", row.join(",")).unwrap();
    }
    fs::write(path, text).unwrap();
}

fn read(folder: &Path, more: &[&str]) -> Value {
    let mut arguments =
        vec!["texture", "from-stroke", "stroke.csv", "--probe", "stylus", "-o", "out", "--json"];
    arguments.extend(more);
    let (status, out, err) = message(&asperity(folder, &arguments));
    assert_eq!((status, err.as_str()), (0, ""));
    serde_json::from_str(&out).unwrap()
}

const SPEED: [&str; 4] = ["--speed", "0.12", "--force", "1.5"];

#[test]
fn a_stroke_with_a_line_becomes_a_surface_that_renders() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let rows = vibration(6.0, 150.0).into_iter().enumerate().map(|(i, a)| vec![i as f64 / RATE_HZ, a]);
    csv(&folder.join("stroke.csv"), "time_s,a", rows);
    let report = read(folder, &SPEED);
    let period_m = report["lines"][0]["period_m"].as_f64().unwrap();
    assert!((period_m / (0.12 / 150.0) - 1.0).abs() < 5e-4, "{period_m}");
    for octave in report["octaves"].as_array().unwrap() {
        let at = |key: &str| octave[key].as_f64().unwrap();
        assert!(at("rms_m") > 0.0 && at("rms_se_db") > at("sampling_se_db") && at("wavelength_m") > 0.0);
    }
    for file in report["files"].as_array().unwrap() {
        assert!(folder.join("out").join(file.as_str().unwrap()).is_file(), "{file}");
    }
    assert_eq!(
        report,
        serde_json::from_slice::<Value>(&fs::read(folder.join("out/surface.json")).unwrap()).unwrap()
    );
    let (status, _, err) = message(&asperity(folder, &["render", "out/scene.toml", "-o", "take"]));
    assert_eq!((status, err.as_str()), (0, ""));
}

#[test]
fn three_axes_and_columns_are_folded_and_give_friction() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let vibration = vibration(5.0, 90.0);
    let rows = vibration.iter().enumerate().map(|(i, a)| {
        let v = 0.1 + 0.01 * (TAU * 0.7 * i as f64 / RATE_HZ).sin();
        vec![*a, 0.3 * a, 0.2 * a, v, 1.5, 0.6]
    });
    csv(&folder.join("stroke.csv"), "x,y,z,v,f,drag", rows);
    let more = ["--rate", "4000", "--speed", "v", "--force", "f", "--tangential", "drag"];
    let report = read(folder, &more);
    assert!((report["friction"].as_f64().unwrap() - 0.4).abs() < 1e-3, "{}", report["friction"]);
}

#[test]
fn a_force_in_grams_is_not_read_without_a_remark() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    csv(&folder.join("stroke.csv"), "a,f", vibration(3.0, 90.0).iter().map(|a| vec![*a, 150.0]));
    let warnings = |force: &str| {
        read(folder, &["--rate", "4000", "--speed", "0.12", "--force", force])["warnings"].to_string()
    };
    assert!(warnings("f").contains("150 N"), "{}", warnings("f"));
    assert!(!warnings("1.5").contains("102 g"));
}

#[test]
fn tables_of_other_programs_are_read_as_the_same_stroke() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let vibration = vibration(4.0, 90.0);
    let alpha = |head: &str, separator: &str, comma: bool, more: &[&str]| {
        let mut text = format!("{head}\n");
        for (i, a) in vibration.iter().enumerate() {
            let row = [i as f64 / RATE_HZ, *a, 0.2 * a].map(|x| format!("{x:.9}")).join(separator);
            writeln!(text, "{}", if comma { row.replace('.', ",") } else { row }).unwrap();
        }
        fs::write(folder.join("stroke.csv"), text).unwrap();
        let report = read(folder, &[&SPEED[..], more].concat());
        assert!(report["warnings"][0].as_str().unwrap().contains("folded by power"), "{report}");
        report["alpha"].as_f64().unwrap()
    };
    let plain = alpha("time_s,x,y", ",", false, &[]);
    for (head, separator, comma) in [
        ("\u{feff}time_s;x;y", ";", true),
        ("Time (s)\tx\ty", "\t", true),
        ("time x y", " ", false),
        ("# a sensor, 4 kHz\nt,x,y", ",", false),
    ] {
        let other = alpha(head, separator, comma, &["--rate", "4000"]);
        assert!((other - plain).abs() < 1e-6, "{head}: {other}, not {plain}");
    }
    let arguments =
        ["texture", "from-stroke", "stroke.csv", "--probe", "stylus", "-o", "again", "--rate", "1000"];
    let words = asperity(folder, &[&arguments[..], &SPEED].concat());
    assert_refused(&words, &["its times say 4000", "--rate 1000 Hz"]);
}

#[test]
fn a_recording_that_is_no_stroke_is_refused_for_its_reason() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let good = vibration(3.0, 150.0);
    let one = |of: &dyn Fn(usize, f64) -> f64| {
        good.iter().enumerate().map(|(i, a)| vec![of(i, *a)]).collect::<Vec<_>>()
    };
    let refused = |rows: Vec<Vec<f64>>, more: &[&str], parts: &[&str]| {
        csv(&folder.join("stroke.csv"), "a", rows.into_iter());
        let mut arguments = vec!["texture", "from-stroke", "stroke.csv", "--probe", "stylus", "-o", "out"];
        arguments.extend(more);
        assert_refused(&asperity(folder, &arguments), parts);
        assert!(!folder.join("out").exists(), "something was left behind");
    };
    let rate = ["--rate", "4000", "--speed", "0.12", "--force", "1.5"];
    let clip = |_: usize, a: f64| a.clamp(-0.02, 0.02);
    refused(one(&clip), &rate, &["clipped", "lower gain"]);
    refused(one(&|_, _| 0.25), &rate, &["every sample is the same"]);
    refused(one(&|i, a| if i == 77 { f64::NAN } else { a }), &rate, &["sample 77"]);
    refused(one(&|_, a| a)[..2000].to_vec(), &rate, &["0.500 s long", "at least 1 s"]);
    refused(
        one(&|_, a| a),
        &["--rate", "100", "--speed", "0.1", "--force", "1"],
        &["rate", "at least 200 Hz"],
    );
    refused(one(&|_, a| a), &["--speed", "0.1", "--force", "1"], &["time_s", "--rate"]);
    refused(one(&|_, a| a), &["--rate", "4000", "--force", "1"], &["--speed", "is missing"]);
    refused(
        one(&|_, a| a),
        &["--rate", "4000", "--speed", "v", "--force", "1"],
        &["no column \"v\"", "its columns: a"],
    );
    refused(one(&|_, a| a), &["--rate", "4000", "--speed", "-0.1", "--force", "1"], &["--speed", "above 0"]);
    refused(
        one(&|_, a| a),
        &["--rate", "4000", "--speed", "0.1,0.2", "--force", "1"],
        &["2 values for 1 files"],
    );
    refused(one(&|_, a| 900.0 * a), &rate, &["leaves the ground", "press harder"]);
    fs::write(folder.join("stroke.csv"), "a\n0.1\nhello\n").unwrap();
    let arguments = ["texture", "from-stroke", "stroke.csv", "--probe", "stylus", "-o", "out"];
    assert_refused(&asperity(folder, &[&arguments[..], &rate].concat()), &["line 3", "hello"]);
    fs::write(folder.join("stroke.csv"), "0.1\n0.2\n").unwrap();
    assert_refused(&asperity(folder, &[&arguments[..], &rate].concat()), &["header line"]);
    let unknown = ["texture", "from-stroke", "stroke.csv", "--probe", "broom", "-o", "out"];
    assert_refused(&asperity(folder, &[&unknown[..], &rate].concat()), &["broom", "stylus"]);
}

#[test]
fn models_of_a_toolkit_are_read_by_their_format() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let model = |v: f64, f: f64, gain: f64, a: f64| {
        format!(
            "<model><ARcoeff><value>1</value><value>{a}</value></ARcoeff><MAcoeff><value>1</value></MAcoeff>\
             <var>0.01</var><gain>{gain}</gain><speedMod>{v}</speedMod><forceMod>{f}</forceMod></model>"
        )
    };
    let models =
        [(60.0, 0.8, 1.0), (60.0, 2.0, 1.3), (120.0, 1.0, 1.8), (200.0, 1.5, 2.8), (200.0, 3.0, 3.4)];
    let body: String =
        models.iter().enumerate().map(|(i, (v, f, g))| model(*v, *f, *g, -0.3 - 0.01 * i as f64)).collect();
    let text = format!(
        "<modelSet><material>felt</material><SpeedUnits>mm/s</SpeedUnits><mu>0.41</mu>{body}</modelSet>"
    );
    fs::write(folder.join("models.xml"), text).unwrap();
    let arguments = ["texture", "from-stroke", "models.xml", "--probe", "stylus", "-o", "out", "--json"];
    let (status, out, err) = message(&asperity(folder, &arguments));
    assert_eq!((status, err.as_str()), (0, ""));
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(report["friction"], 0.41);
    assert_eq!(report["recorded"].as_array().unwrap().len(), models.len());
    let (status, _, err) = message(&asperity(folder, &["render", "out/scene.toml", "-o", "take"]));
    assert_eq!((status, err.as_str()), (0, ""));
    fs::write(folder.join("models.xml"), "<modelSet></modelSet>").unwrap();
    assert_refused(&asperity(folder, &arguments[..7]), &["no model"]);
}
