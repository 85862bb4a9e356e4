//! `asperity render` from outside: its files, its report, its promises.

use crate::support;

use std::fs;
use support::{MODES, Scene, TOML, assert_refused, impact, message, stroke};

#[test]
fn a_render_writes_two_float_files_of_equal_length() {
    let scene = Scene::new();
    let (status, out, err) = message(&scene.render(&[]));
    assert_eq!((status, err.as_str()), (0, ""));
    assert!(out.contains("out.audio.wav"), "{out}");
    assert_eq!(scene.outputs(), ["out.audio.wav", "out.haptic.wav"]);
    let (audio, haptic) = (scene.samples("out.audio.wav"), scene.samples("out.haptic.wav"));
    assert_eq!(audio.len(), haptic.len());
    assert_eq!(audio.len(), 30_870);
    for samples in [&audio, &haptic] {
        assert!(samples.iter().all(|sample| sample.is_finite()));
        assert!(samples.iter().any(|&sample| sample != 0.0));
    }
}

#[test]
fn pickups_of_a_scene_are_written_a_channel_each() {
    let scene = Scene::new();
    let body = TOML.replace("[[body]]\n", "[[body]]\nmass_kg = 0.2\n");
    let pickup = |name: &str, factor: f64, more: &str| {
        format!("\n[[pickup]]\nname = \"{name}\"\nbody = \"bar\"\nfactor = {factor}\n{more}\n")
    };
    let toml = body + &pickup("mic", 1.0, "") + &pickup("half", 0.5, "quantity = \"velocity\"");
    scene.write("scene.toml", toml + &pickup("chip", 1.0, "sensor = \"adxl1005\""));
    let motion = "{\"t\":0.0,\"event\":\"motion\",\"body\":\"bar\",\"gravity_m_s2\":[0,0,-9.81]}\n";
    scene.write("stroke.jsonl", motion.to_owned() + &impact(0.3));
    let (status, _, err) = message(&scene.render(&[]));
    assert_eq!(status, 0, "{err}");
    assert_eq!(scene.outputs(), ["out.audio.wav", "out.haptic.wav", "out.pickup.wav"]);
    let (read, heard) = (scene.samples("out.pickup.wav"), scene.samples("out.audio.wav"));
    assert_eq!(read.len(), 3 * heard.len());
    // Before the blow there is gravity, and noise behind the sensor, in volts.
    let at = |s: f64| &read[3 * (s * 44_100.0) as usize..][..3];
    let before = at(0.2);
    assert!((before[0] / 9.81 - 1.0).abs() < 1e-3 && before[1] == 0.0, "{before:?}");
    assert!((before[2] / (9.81 * 2.039e-3) - 1.0).abs() < 0.1, "{before:?}");
    assert!(at(0.31)[0] != before[0] && at(0.31)[1] != 0.0);
    let toml = fs::read_to_string(scene.path("scene.toml")).unwrap();
    for (wrong, words) in [
        ("body = \"bar\"\nfactor = 1", "pickup 1 \"mic\": body"),
        ("name = \"half\"", "pickup 2: name: is used twice"),
        ("sensor = \"adxl1005\"", "pickup \"chip\": sensor: \"ear\" is unknown"),
    ] {
        let right = match wrong {
            "name = \"half\"" => "name = \"mic\"",
            "sensor = \"adxl1005\"" => "sensor = \"ear\"",
            _ => "body = \"bell\"\nfactor = 1",
        };
        scene.write("scene.toml", toml.replacen(wrong, right, 1));
        assert_refused(&scene.render(&[]), &[words]);
    }
}

#[test]
fn a_surface_excites_the_strike_position_it_names() {
    let scene = Scene::new();
    let peak = |scene: &Scene| scene.report(&[])["audio_peak"].as_f64().unwrap();
    let toml = format!("{TOML}\n[audio]\ngain = 1.0\n");
    scene.write("scene.toml", &toml);
    let own = peak(&scene);
    // Half as loud at position 1, a node of every mode at position 2.
    let modes = MODES.trim_end_matches('}');
    scene.write("bar.modes.json", format!("{modes},\"positions\":[[0.15,0.05],[0.0,0.0]]}}"));
    let at = |position: usize| {
        let surface = format!("body = \"bar\"\nstrike_position = {position}\nwidth_m");
        scene.write("scene.toml", toml.replace("body = \"bar\"\nwidth_m", &surface));
        peak(&scene)
    };
    assert!((at(0) / own - 1.0).abs() < 1e-3);
    assert!((at(1) / own - 0.5).abs() < 1e-3);
    assert_eq!(at(2), 0.0);
}

#[test]
fn json_is_one_object_with_the_promised_fields_and_nothing_else() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.5) + &impact(0.55));
    let report = scene.report(&["--plot", "--trace", "--force"]);
    for field in [
        "duration_s",
        "real_time_factor",
        "events",
        "micro_collisions",
        "impacts",
        "dropped",
        "quarantined",
        "stolen",
        "audio_peak",
    ] {
        assert!(report[field].is_number(), "{field}: {report}");
    }
    assert_eq!(report["events"], 32);
    assert_eq!(report["impacts"], 1);
    assert_eq!(report["haptic_peak"].as_array().unwrap().len(), 1);
    assert!((report["duration_s"].as_f64().unwrap() - 0.75).abs() < 1e-4);
    assert_eq!(
        scene.outputs(),
        ["out.audio.wav", "out.force.csv", "out.haptic.wav", "out.svg", "out.trace.csv"]
    );
}

#[test]
fn the_trace_has_a_row_for_every_sample_of_a_contact() {
    let scene = Scene::new();
    scene.report(&["--trace"]);
    let trace = fs::read_to_string(scene.path("out.trace.csv")).unwrap();
    let mut lines = trace.lines();
    assert_eq!(
        lines.next().unwrap(),
        "time_s,contact,u,v,height_m,normal_force_n,pad_m,pad_velocity_m_s,finger_m,contact_force_n,impulse_n_s"
    );
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == 11 && row.iter().all(|number| number.is_finite())));
    assert!(rows.len() >= 22_000, "{}", rows.len());
    for (index, row) in rows.iter().enumerate() {
        assert!((row[0] - index as f64 / 44_100.0).abs() < 1e-12, "row {index} at {}", row[0]);
        assert_eq!(row[1], 1.0);
    }
}

#[test]
fn the_haptic_file_is_the_traced_pad_when_nothing_is_filtered() {
    let scene = Scene::new();
    scene.write("scene.toml", TOML.replace("full_scale = 1.0", "full_scale = 1.0\nhighpass_hz = 0.0"));
    scene.report(&["--trace"]);
    let trace = fs::read_to_string(scene.path("out.trace.csv")).unwrap();
    let haptic = scene.samples("out.haptic.wav");
    let pads: Vec<f64> =
        trace.lines().skip(1).map(|line| line.split(',').nth(6).unwrap().parse().unwrap()).collect();
    for index in 4_000..20_000 {
        assert!((pads[index] - f64::from(haptic[index])).abs() < 1e-9, "sample {index}");
    }
}

#[test]
fn forces_come_once_a_millisecond_and_press_out_of_the_surface() {
    let scene = Scene::new();
    scene.report(&["--force"]);
    let table = fs::read_to_string(scene.path("out.force.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next().unwrap(), "time_s,contact,x_n,y_n,z_n");
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect();
    assert!((500..=530).contains(&rows.len()), "{}", rows.len());
    for pair in rows.windows(2) {
        assert!((pair[1][0] - pair[0][0] - 0.001).abs() < 1e-9);
    }
    let mean = rows[200..400].iter().map(|row| row[4]).sum::<f64>() / 200.0;
    assert!((mean - 0.6).abs() < 0.03, "mean normal force {mean} N");
    let friction = rows[200..400].iter().map(|row| row[2]).sum::<f64>() / 200.0;
    assert!(friction < -0.05, "friction {friction} N opposes the motion");
}

#[test]
fn forces_come_at_the_wanted_rate_with_the_same_mean() {
    let scene = Scene::new();
    let rows = |options: &[&str]| -> Vec<Vec<f64>> {
        scene.report(options);
        let table = fs::read_to_string(scene.path("out.force.csv")).unwrap();
        table.lines().skip(1).map(|line| line.split(',').map(|n| n.parse().unwrap()).collect()).collect()
    };
    let (thousand, five) = (rows(&["--force"]), rows(&["--force", "--force-rate", "5000"]));
    assert!((five.len() as f64 / thousand.len() as f64 - 5.0).abs() < 0.05);
    assert!(five.windows(2).all(|pair| (pair[1][0] - pair[0][0] - 2e-4).abs() < 1e-9));
    let mean =
        |rows: &[Vec<f64>], axis: usize| rows.iter().map(|row| row[axis]).sum::<f64>() / rows.len() as f64;
    for axis in 2..5 {
        let (a, b) = (mean(&thousand[100..400], axis), mean(&five[500..2000], axis));
        assert!((a - b).abs() < 0.002, "axis {axis}: {a} and {b} N");
    }
    for (rate, right) in [("0", "1 to 20000 Hz"), ("x", "not a number")] {
        let (status, _, error) = message(&scene.render(&["--force", "--force-rate", rate]));
        assert!(status == 2 && error.contains("--force-rate") && error.contains(right), "{error}");
    }
    let output = scene.render(&["--rate", "8000", "--force", "--force-rate", "9000"]);
    assert_refused(&output, &["--force-rate", "8000"]);
}

#[test]
fn blocks_of_any_size_and_repeated_runs_give_the_same_bytes() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.2) + &impact(0.21));
    let bytes = |block: &str| {
        scene.report(&["--block", block]);
        (fs::read(scene.path("out.audio.wav")).unwrap(), fs::read(scene.path("out.haptic.wav")).unwrap())
    };
    let reference = bytes("256");
    for block in ["1", "7", "64", "1000", "4096", "256"] {
        assert!(bytes(block) == reference, "block {block}");
    }
}

#[test]
fn options_beat_the_scene_file() {
    let scene = Scene::new();
    scene.write("scene.toml", format!("sample_rate_hz = 48000\nseed = 5\n{TOML}"));
    assert_eq!(scene.report(&[])["sample_rate_hz"], 48_000.0);
    let first = scene.samples("out.haptic.wav");
    assert_eq!(scene.report(&["--rate", "22050"])["sample_rate_hz"], 22_050.0);
    scene.report(&["--seed", "6"]);
    assert!(scene.samples("out.haptic.wav") != first);
    scene.report(&["--seed", "5"]);
    assert!(scene.samples("out.haptic.wav") == first);
    for integrator in ["semi-implicit-euler", "exact-event", "energy-conserving"] {
        for path in ["extrapolate", "hold", "hermite"] {
            scene.report(&["--integrator", integrator, "--path", path]);
        }
    }
}

#[test]
fn contacts_on_one_actuator_add_up_and_channels_keep_their_order() {
    let scene = Scene::new();
    scene.write("scene.toml", format!("{TOML}\n[[actuator]]\nfull_scale = 1.0\n"));
    let second = stroke(2, 0.5).replace("\"actuator\":0", "\"actuator\":1");
    scene.write("stroke.jsonl", second);
    let report = scene.report(&[]);
    let peaks: Vec<f64> =
        report["haptic_peak"].as_array().unwrap().iter().map(|peak| peak.as_f64().unwrap()).collect();
    assert!(peaks[0] == 0.0 && peaks[1] > 0.0, "{peaks:?}");
}

#[test]
fn nothing_is_written_when_the_run_fails() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.5).replace("plate", "ghost"));
    let refused = scene.render(&["--trace", "--force", "--plot", "--json"]);
    assert_refused(&refused, &["stroke.jsonl:1: surface: \"ghost\" is unknown", "plate"]);
    assert!(scene.outputs().is_empty(), "{:?}", scene.outputs());
}

#[test]
fn an_old_file_survives_a_failed_run() {
    let scene = Scene::new();
    scene.write("out.audio.wav", "precious");
    scene.write("stroke.jsonl", "{");
    assert_refused(&scene.render(&[]), &["stroke.jsonl:1"]);
    assert_eq!(fs::read(scene.path("out.audio.wav")).unwrap(), b"precious");
}

#[test]
fn a_place_that_cannot_be_written_is_named_before_any_work() {
    let scene = Scene::new();
    fs::create_dir(scene.path("taken.audio.wav")).unwrap();
    let run = |stem: &str| support::asperity(scene.folder.path(), &["render", "scene.toml", "-o", stem]);
    assert_refused(&run("missing/out"), &["missing", "does not exist"]);
    assert_refused(&run("taken"), &["is a folder"]);
    assert_refused(&run("/"), &["is not a file name"]);
}

#[test]
fn paths_inside_a_file_are_relative_to_that_file() {
    let scene = Scene::new();
    let elsewhere = tempfile::tempdir().unwrap();
    let toml = scene.path("scene.toml");
    let stem = elsewhere.path().join("there.v2");
    let output = support::asperity(
        elsewhere.path(),
        &["render", toml.to_str().unwrap(), "-o", stem.to_str().unwrap(), "--json"],
    );
    assert_eq!(message(&output).0, 0, "{}", message(&output).2);
    assert!(elsewhere.path().join("there.v2.audio.wav").exists());
}

#[test]
fn silence_in_is_exact_silence_out() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", "");
    let report = scene.report(&[]);
    assert_eq!((report["audio_peak"].as_f64(), report["events"].as_u64()), (Some(0.0), Some(0)));
    assert!(scene.samples("out.haptic.wav").iter().all(|&sample| sample == 0.0));
}
