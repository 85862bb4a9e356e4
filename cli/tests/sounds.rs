//! `asperity strike` and `asperity stroke` from the outside: one command, a folder of sounds.

use crate::support;

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use support::{Scene, asperity, assert_refused, message};

fn json_of(folder: &Path, arguments: &[&str]) -> Value {
    let (status, out, err) = message(&asperity(folder, arguments));
    assert_eq!((status, err.as_str()), (0, ""), "{arguments:?}");
    serde_json::from_str(&out).unwrap()
}

fn samples(path: &Path) -> Vec<f32> {
    let mut reader =
        hound::WavReader::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let spec = reader.spec();
    match spec.sample_format {
        hound::SampleFormat::Float => reader.samples::<f32>().map(Result::unwrap).collect(),
        hound::SampleFormat::Int => {
            let whole = f64::from(1u32 << (spec.bits_per_sample - 1));
            reader.samples::<i32>().map(|x| (f64::from(x.unwrap()) / whole) as f32).collect()
        }
    }
}

fn names(report: &Value) -> Vec<String> {
    report["files"].as_array().unwrap().iter().map(|file| file["name"].as_str().unwrap().to_owned()).collect()
}

/// A grey map of waves.
fn map(path: &Path) {
    let pixels =
        (0..64 * 64).map(|i| (128.0 + 100.0 * (f64::from(i % 64) * std::f64::consts::TAU / 8.0).sin()) as u8);
    let mut pgm = b"P5 64 64 255\n".to_vec();
    pgm.extend(pixels);
    fs::write(path, pgm).unwrap();
}

#[test]
fn one_command_makes_ten_differing_hits_that_a_seed_repeats() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arguments = ["strike", "bowl", "-o", "hits", "--takes", "10", "--json"];
    let report = json_of(folder, &arguments);
    let names = names(&report);
    assert_eq!(names.len(), 10);
    assert_eq!(names[0], "ceramic-bowl-wood-1m_s-01");
    let sounds: BTreeSet<Vec<u8>> =
        names.iter().map(|name| fs::read(folder.join(format!("hits/{name}.wav"))).unwrap()).collect();
    assert_eq!(sounds.len(), 10, "two takes are the same");
    let again = json_of(folder, &["strike", "bowl", "-o", "again", "--takes", "10", "--json"]);
    assert_eq!(report["files"], again["files"]);
    for name in &names {
        let read = |set: &str| fs::read(folder.join(format!("{set}/{name}.wav"))).unwrap();
        assert_eq!(read("hits"), read("again"), "{name}");
        assert!(!folder.join(format!("hits/{name}.haptic.wav")).exists());
    }
    let other = json_of(folder, &["strike", "bowl", "-o", "other", "--takes", "10", "--seed", "2", "--json"]);
    assert_ne!(report["files"], other["files"]);
    // The loudest sample of the set lies 1 dB below full scale.
    let loudest = report["files"].as_array().unwrap().iter().map(|file| file["peak_dbfs"].as_f64().unwrap());
    assert!((loudest.fold(f64::MIN, f64::max) + 1.0).abs() < 0.01);
}

#[test]
fn render_repeats_a_sound_from_its_scene_and_log() {
    let scene = Scene::new();
    let folder = scene.folder.path();
    map(&folder.join("map.pgm"));
    for arguments in [
        vec!["strike", "can-that-is-no-stock.modes.json"],
        vec!["strike", "bar", "--with", "steel", "rubber", "--speeds", "0.3,2", "--position", "1"],
        vec!["stroke", "scene.toml", "--seconds", "0.5", "--probe", "stylus"],
        vec!["stroke", "map.pgm", "--seconds", "0.5", "--speed", "0.05,0.2", "--path", "circle"],
        vec!["stroke", "scene.toml", "--path", "stroke.jsonl"],
    ] {
        fs::copy(folder.join("bar.modes.json"), folder.join("can-that-is-no-stock.modes.json")).unwrap();
        let _ = fs::remove_dir_all(folder.join("a/set"));
        let mut all = arguments.clone();
        all.extend(["-o", "a/set", "--bits", "32", "--json"]);
        let report = json_of(folder, &all);
        for name in names(&report) {
            let toml = format!("a/set/{name}.toml");
            json_of(folder, &["render", &toml, "-o", "take", "--json"]);
            let (ours, theirs) =
                (samples(&folder.join(format!("a/set/{name}.wav"))), samples(&folder.join("take.audio.wav")));
            assert_eq!(ours, theirs, "{name}");
            assert!(ours.iter().any(|x| *x != 0.0), "{name}");
            let felt = folder.join(format!("a/set/{name}.haptic.wav"));
            assert_eq!(felt.exists(), arguments[0] == "stroke");
            if felt.exists() {
                assert_eq!(samples(&felt), samples(&folder.join("take.haptic.wav")), "{name}");
            }
        }
    }
}

#[test]
fn a_sound_begins_with_the_blow_and_ends_with_its_decay() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let report =
        json_of(folder, &["strike", "plate", "--material", "wood", "-o", "set", "--bits", "24", "--json"]);
    let sound = samples(&folder.join(format!("set/{}.wav", names(&report)[0])));
    let peak = sound.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    let first = sound.iter().position(|x| x.abs() > 1e-3 * peak).unwrap();
    assert!(first < 44, "{first} samples of silence");
    // 80 dB below the peak, within a step of 24 bits.
    assert!(sound.last().unwrap().abs() >= 0.99e-4 * peak && sound.len() < 44_100);
    assert_eq!(report["files"][0]["seconds"].as_f64().unwrap(), sound.len() as f64 / 44_100.0);
}

#[test]
fn a_loop_follows_itself_without_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    map(&folder.join("map.pgm"));
    for (path, seconds) in [("line", 1.0), ("circle", 3.0), ("zigzag", 1.3)] {
        let length = seconds.to_string();
        let arguments =
            ["stroke", "map.pgm", "-o", "set", "--path", path, "--loop", "--seconds", &length, "--json"];
        let report = json_of(folder, &arguments);
        let name = &names(&report)[0];
        assert!(name.ends_with("-loop"), "{name}");
        let repeats = report["assumed"].to_string().contains("the loop repeats every");
        assert_eq!(repeats, path == "circle", "{}", report["assumed"]);
        for end in ["wav", "haptic.wav"] {
            let sound = samples(&folder.join(format!("set/{name}.{end}")));
            assert_eq!(sound.len(), (seconds * 44_100.0_f64).round() as usize);
            let inside = sound.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
            let seam = (sound[0] - sound[sound.len() - 1]).abs();
            assert!(seam <= inside && inside > 0.0, "{path} {end}: {seam} beside {inside}");
        }
    }
}

#[test]
fn a_photograph_is_stroked_in_one_command_with_its_width_stated() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let pixels: Vec<u8> = (0..96 * 96)
        .flat_map(|i| {
            let grey = if i % 96 % 16 < 3 || i / 96 % 16 < 3 { 60 } else { 180 };
            [grey, grey - 30, grey - 50]
        })
        .collect();
    let mut ppm = b"P6 96 96 255\n".to_vec();
    ppm.extend(pixels);
    fs::write(folder.join("wall.ppm"), ppm).unwrap();
    let report = json_of(folder, &["stroke", "wall.ppm", "-o", "set", "--seconds", "0.4", "--json"]);
    let assumed = report["assumed"].to_string();
    assert!(assumed.contains("taken to be 15 mm wide (--width-m says another width)"), "{assumed}");
    assert!(!assumed.contains("warning"), "{assumed}");
    let doubts = report["warnings"].to_string();
    assert!(doubts.contains("which way up the heights are is a guess"), "{doubts}");
    let report = json_of(folder, &["stroke", "set/wall-surface", "-o", "more", "--seconds", "0.4", "--json"]);
    assert_eq!(names(&report), ["wall-surface-fingertip-0.1m_s-0.6N-line"]);
}

#[test]
fn a_clipped_recording_that_is_struck_is_said_to_be_clipped() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 22_050,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(folder.join("too loud.wav"), spec).unwrap();
    for n in -1000..12_000 {
        let t = f64::from(n.max(0)) / 22_050.0;
        let ringing = 3.0 * (-12.0 * t).exp() * (std::f64::consts::TAU * 640.0 * t).sin();
        writer.write_sample((32_767.0 * ringing.clamp(-1.0, 1.0)) as i16).unwrap();
    }
    writer.finalize().unwrap();
    let report = json_of(folder, &["strike", "too loud.wav", "-o", "hits", "--json"]);
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("clipping"), "{report}");
    assert!(report["assumed"].to_string().contains("of PLA"), "{report}");
    // Takes keep their numbers, and a fit of one's own stays what it is.
    fs::rename(folder.join("too loud.wav"), folder.join("pan.take2.wav")).unwrap();
    fs::write(folder.join("pan.take2.modes.json"), "mine").unwrap();
    let report = json_of(folder, &["strike", "pan.take2.wav", "-o", ".", "--json"]);
    assert_eq!(names(&report), ["pan.take2-wood-1m_s"]);
    assert_eq!(fs::read_to_string(folder.join("pan.take2.modes.json")).unwrap(), "mine");
}

#[test]
fn unplayable_things_name_the_helping_verb_and_leave_no_folder() {
    let scene = Scene::new();
    let folder = scene.folder.path();
    map(&folder.join("map.pgm"));
    fs::write(folder.join("mug.obj"), "v 0 0 0\n").unwrap();
    fs::write(folder.join("hit.wav"), "RIFF").unwrap();
    for (arguments, parts) in [
        (vec!["strike", "kettle"], vec!["kettle: is no file and no stock body", "bowl"]),
        (vec!["strike", "mug.obj"], vec!["is a mesh", "asperity modes"]),
        (vec!["strike", "map.png"], vec!["map.png: is no file"]),
        (vec!["strike", "scene.toml"], vec!["asperity stroke"]),
        (vec!["strike", "bowl", "--at", "0,0,0"], vec!["--at: bowl has no shapes", "--position"]),
        (vec!["strike", "bowl", "--position", "9"], vec!["--position"]),
        (vec!["strike", "bar.modes.json", "--size", "0.2"], vec!["--size: is for stock bodies"]),
        (vec!["stroke", "hit.wav"], vec!["asperity strike"]),
        (vec!["stroke", "nothing"], vec!["nothing: no such file"]),
        (vec!["stroke", "map.pgm", "--probe", "broom"], vec!["--probe: \"broom\" is unknown", "stylus"]),
        (vec!["stroke", "map.pgm", "--material", "cheese"], vec!["--material: \"cheese\" is unknown"]),
        (vec!["stroke", "scene.toml", "--width-m", "0.2"], vec!["--width-m: is for maps and photographs"]),
        (vec!["stroke", "scene.toml", "--surface", "top"], vec!["--surface: \"top\" is unknown", "plate"]),
        (vec!["stroke", "scene.toml", "--path", "stroke.jsonl", "--loop"], vec!["--loop: stands beside"]),
        (
            vec!["stroke", "scene.toml", "--path", "stroke.jsonl", "--speed", "0.2"],
            vec!["--speed: stands beside"],
        ),
        (vec!["stroke", "scene.toml", "--material", "stone"], vec!["--material", "stock = \"plate\""]),
    ] {
        let mut all = arguments.clone();
        all.extend(["-o", "out"]);
        assert_refused(&asperity(folder, &all), &parts);
        assert!(!folder.join("out").exists(), "{arguments:?} left a folder");
    }
}

#[cfg(unix)]
#[test]
fn an_input_is_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    map(&folder.join("map.pgm"));
    fs::create_dir(folder.join("out")).unwrap();
    let output = folder.join("out/map-fingertip-0.1m_s-0.6N-line.wav");
    std::os::unix::fs::symlink(folder.join("map.pgm"), &output).unwrap();
    let before = fs::read(folder.join("map.pgm")).unwrap();
    let refused = asperity(folder, &["stroke", "map.pgm", "-o", "out", "--seconds", "0.3"]);
    assert_refused(&refused, &["map-fingertip-0.1m_s-0.6N-line.wav", "input"]);
    assert_eq!(fs::read(folder.join("map.pgm")).unwrap(), before);
    assert_eq!(fs::read_dir(folder.join("out")).unwrap().count(), 1);
}

/// Peak of a WAV file.
fn peak(path: &Path) -> f32 {
    samples(path).iter().fold(0.0, |peak, x| peak.max(x.abs()))
}

#[test]
fn cloth_and_cushions_are_struck_and_stroked_though_they_have_no_modes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (stock, name) in [("sheet", "cloth-sheet"), ("cushion", "foam-cushion")] {
        let report = json_of(folder, &["strike", stock, "-o", stock, "--json"]);
        let sound = folder.join(format!("{stock}/{name}-wood-1m_s.wav"));
        assert!((peak(&sound) - 0.89).abs() < 0.01, "{}", peak(&sound));
        // It does not ring.
        assert!(report["files"][0]["seconds"].as_f64().unwrap() < 1.0, "{report}");
    }
    // A thing too small to be heard says so.
    let small = asperity(folder, &["strike", "bar", "--size", "0.002", "-o", "small"]);
    assert_refused(&small, &["bar", "outside 16 Hz to 20 kHz", "--size, --material"]);
    map(&folder.join("map.pgm"));
    for (material, stock) in [("cloth", "sheet"), ("carpet", "cushion"), ("steel", "plate")] {
        let arguments =
            ["stroke", "map.pgm", "--material", material, "--seconds", "0.3", "-o", material, "--json"];
        let report = json_of(folder, &arguments);
        let name = &names(&report)[0];
        assert!(report["assumed"].to_string().contains(&format!("on a {stock} of {material}")), "{report}");
        let scene = fs::read_to_string(folder.join(format!("{material}/{name}.toml"))).unwrap();
        assert!(scene.contains(&format!("stock = \"{stock}\"")), "{scene}");
        assert!(peak(&folder.join(format!("{material}/{name}.wav"))) > 0.5);
    }
}

#[test]
fn a_photograph_rings_as_the_material_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let photo = image::RgbImage::from_fn(96, 96, |x, y| {
        let joint = x % 24 < 3 || y % 12 < 2;
        let grain = (x * 7 + y * 13) % 11;
        image::Rgb(if joint { [90, 85, 80] } else { [150 + grain as u8, 70, 50] })
    });
    photo.save(folder.join("wall.png")).unwrap();
    let arguments = ["stroke", "wall.png", "--material", "brick", "--seconds", "0.3", "-o", "set", "--json"];
    let report = json_of(folder, &arguments);
    let name = &names(&report)[0];
    let scene = fs::read_to_string(folder.join(format!("set/{name}.toml"))).unwrap();
    assert!(scene.contains("material = \"brick\"") && scene.contains("displacement.png"), "{scene}");
    assert!(peak(&folder.join(format!("set/{name}.wav"))) > 0.5);
    let wrong = ["stroke", "wall.png", "--material", "brik", "-o", "other"];
    assert_refused(&asperity(folder, &wrong), &["--material", "\"brik\" is unknown", "brick"]);
}
