//! Scenes with several buses, probes and held bodies, from outside.

use crate::support;

use support::{MODES, Scene, TOML, assert_refused, stroke};

/// The plain scene with a pen on a second bus, a stylus, and what more is written.
fn with(more: &str) -> Scene {
    let scene = Scene::new();
    let pen =
        "[[body]]\nname = \"pen\"\nmodes = \"bar.modes.json\"\nmaterial = \"steel\"\nbus = \"right\"\n\n";
    let buses = "\n[[audio]]\nname = \"left\"\ngain = 1.0\n[[audio]]\nname = \"right\"\ngain = 1.0\n";
    let probes = "\n[[probe]]\npreset = \"fingertip\"\n[[probe]]\nname = \"stylus\"\npreset = \"stylus\"\n";
    scene.write(
        "scene.toml",
        TOML.replace("[[surface]]", &format!("{pen}[[surface]]")) + buses + probes + more,
    );
    scene
}

/// One channel of an interleaved file of two.
fn channel(samples: &[f32], index: usize) -> Vec<f32> {
    samples.iter().skip(index).step_by(2).copied().collect()
}

#[test]
fn a_bus_a_channel_and_only_the_body_that_is_touched_sounds() {
    let scene = with("");
    let report = scene.report(&[]);
    let audio = scene.samples("out.audio.wav");
    assert!(channel(&audio, 0).iter().any(|x| *x != 0.0));
    assert!(channel(&audio, 1).iter().all(|x| *x == 0.0), "nobody touched the pen");
    let peaks: Vec<f64> =
        report["bus_peak"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    assert_eq!(peaks, [report["audio_peak"].as_f64().unwrap(), 0.0]);
}

#[test]
fn a_held_pen_rings_on_its_own_bus_with_opposite_sign() {
    let scene = with("");
    let held = stroke(1, 0.5).replacen(
        "\"actuator\":0",
        "\"actuator\":0,\"holder\":\"pen\",\"probe\":\"stylus\"",
        1,
    );
    let blow = r#"{"t":0.6,"event":"impact","body":"bar","speed_m_s":0.4,"mass_kg":0.01,"radius_m":0.005,"striker":"steel","holder":"pen"}"#;
    scene.write("stroke.jsonl", format!("{held}{blow}\n"));
    let report = scene.report(&[]);
    assert_eq!(report["warnings"].as_array().map_or(0, Vec::len), 0, "{report}");
    let audio = scene.samples("out.audio.wav");
    let (bar, pen) = (channel(&audio, 0), channel(&audio, 1));
    assert!(bar.iter().any(|x| x.abs() > 1e-3));
    assert!(bar.iter().zip(&pen).all(|(bar, pen)| *bar == -*pen));
    // The blow is felt by the hand: the channel moves although the stroke has ended.
    let haptic = scene.samples("out.haptic.wav");
    assert!(haptic[26_500..27_500].iter().any(|x| x.abs() > 1e-7));
}

#[test]
fn a_contact_without_an_actuator_is_heard_and_not_felt() {
    let scene = with("");
    scene.write("stroke.jsonl", stroke(1, 0.5).replacen(",\"actuator\":0", "", 1));
    let report = scene.report(&[]);
    assert!(report["audio_peak"].as_f64().unwrap() > 0.0);
    assert_eq!(report["haptic_peak"][0].as_f64(), Some(0.0));
}

#[test]
fn missing_names_and_contradicting_tables_are_refused() {
    let scene = with("");
    let log = |from: &str, to: &str| scene.write("stroke.jsonl", stroke(1, 0.5).replacen(from, to, 1));
    log("\"actuator\":0", "\"actuator\":0,\"probe\":\"broom\"");
    assert_refused(&scene.render(&[]), &["stroke.jsonl:1: probe: \"broom\" is unknown", "stylus"]);
    log("\"actuator\":0", "\"holder\":\"hand\"");
    assert_refused(&scene.render(&[]), &["holder: \"hand\" is unknown", "pen"]);
    log("\"event\":\"move\"", "\"event\":\"move\",\"probe\":\"stylus\"");
    assert_refused(&scene.render(&[]), &["stroke.jsonl:2: probe"]);
    scene.write("stroke.jsonl", stroke(1, 0.5));
    let refused = |text: String, parts: &[&str]| {
        scene.write("scene.toml", text);
        scene.write("bar.modes.json", MODES);
        assert_refused(&scene.render(&[]), parts);
    };
    let plain = TOML.to_owned();
    let bus = TOML.replace("material = \"steel\"", "bus = \"left\"");
    refused(bus.clone(), &["body \"bar\": bus", "\"left\" is unknown", "[[audio]]"]);
    refused(bus + "[[audio]]\nname = \"right\"\n", &["buses of this scene: \"right\""]);
    refused(
        plain.clone() + "[[audio]]\nname = \"a\"\n[[audio]]\nname = \"a\"\n",
        &["audio 2: name", "used twice"],
    );
    refused(plain.clone() + "[[audio]]\nname = \"a\"\n[[audio]]\ngain = 1\n", &["audio 2: name", "missing"]);
    refused(plain.clone() + "[[probe]]\n[[probe]]\n", &["probe 2: name"]);
    refused(
        plain + "[[probe]]\nname = \"x\"\npreset = \"broom\"\n",
        &["probe \"x\"", "preset", "\"stylus\""],
    );
}
