//! Inputs that are wrong, damaged, absurd or too many: one `error:` line, or a finite render that
//! counts what it left out. Never a panic, never a sample that is not finite.

use crate::support;

use std::fmt::Write as _;
use support::{MODES, Scene, TOML, assert_refused, stroke};

fn assert_finite(scene: &Scene) {
    for name in ["out.audio.wav", "out.haptic.wav"] {
        assert!(scene.samples(name).iter().all(|sample| sample.is_finite()), "{name}");
    }
}

#[test]
fn logs_that_are_no_logs_are_refused_with_their_line() {
    let scene = Scene::new();
    let good = stroke(1, 0.1);
    for (bad, part) in [
        (r#"{"t":0.2,"event":"jump","contact":1}"#, "stroke.jsonl:8"),
        (r#"{"t":NaN,"event":"end","contact":1}"#, "stroke.jsonl:8"),
        (r#"{"t":Infinity,"event":"end","contact":1}"#, "stroke.jsonl:8"),
        (r#"{"t":1e999,"event":"end","contact":1}"#, "stroke.jsonl:8"),
        (r#"{"t":1e300,"event":"end","contact":1}"#, "stroke.jsonl:8"),
        (r#"{"t":0.01,"event":"end","contact":1}"#, "time order"),
        (r#"{"t":-1,"event":"end","contact":1}"#, "stroke.jsonl:8"),
        (r#"{"t":0.2,"event":"move","contact":1,"uv":[0.1]}"#, "stroke.jsonl:8"),
        (r#"{"t":0.2,"event":"end","contact":-4}"#, "stroke.jsonl:8"),
        (r#"{"t":0.2,"event":"end""#, "stroke.jsonl:8"),
        ("\u{0}\u{1}garbage", "stroke.jsonl:8"),
        ("[1,2,3]", "stroke.jsonl:8"),
    ] {
        scene.write("stroke.jsonl", format!("{good}{bad}\n"));
        assert_refused(&scene.render(&["--json"]), &[part]);
        assert!(scene.outputs().is_empty());
    }
    scene.write("stroke.jsonl", [0xff, 0xfe, 0x00, 0x80]);
    assert_refused(&scene.render(&[]), &["stroke.jsonl"]);
}

#[test]
fn unknown_names_are_answered_with_the_known_ones() {
    let scene = Scene::new();
    let impact =
        |body: &str, striker: &str| support::impact(0.1).replace("bar", body).replace("steel", striker);
    for (log, parts) in [
        (stroke(1, 0.1).replace("plate", "plat"), ["\"plat\"", "plate"]),
        (impact("bra", "steel"), ["\"bra\"", "bar"]),
        (impact("bar", "cheese"), ["\"cheese\"", "steel"]),
    ] {
        scene.write("stroke.jsonl", log);
        assert_refused(&scene.render(&[]), &parts);
    }
}

#[test]
fn absurd_places_are_left_out_and_absurd_magnitudes_held() {
    let scene = Scene::new();
    for (from, to) in [
        ("\"uv\":[0.1,0.5]", "\"uv\":[1e300,0.5]"),
        // Magnitudes are held at their limits.
        ("\"velocity_m_s\":[0.08,0.0]", "\"velocity_m_s\":[1e300,-1e300]"),
        ("\"normal_force_n\":0.6", "\"normal_force_n\":1e300"),
        ("\"normal_force_n\":0.6", "\"normal_force_n\":-1e300"),
        ("\"closing_m_s\":0.05", "\"closing_m_s\":1e300"),
    ] {
        let log = stroke(1, 0.3);
        assert!(log.contains(from), "{from}");
        scene.write("stroke.jsonl", log.replace(from, to));
        let report = scene.report(&[]);
        let left_out = report["quarantined"].as_u64().unwrap() > 0;
        assert_eq!(left_out, to.contains("uv"), "{to}: {report}");
        assert_finite(&scene);
    }
}

#[test]
fn strokes_at_the_edge_of_the_possible_stay_finite() {
    let scene = Scene::new();
    for (from, to) in [
        ("\"normal_force_n\":0.6", "\"normal_force_n\":10000.0"),
        ("\"normal_force_n\":0.6", "\"normal_force_n\":0.0"),
        ("\"normal_force_n\":0.6", "\"normal_force_n\":-3.0"),
        ("\"velocity_m_s\":[0.08,0.0]", "\"velocity_m_s\":[100.0,-100.0]"),
        ("\"closing_m_s\":0.05", "\"closing_m_s\":100.0"),
        (",0.5]", ",999999.0]"),
        ("\"velocity_m_s\":[0.08,0.0],", ""),
    ] {
        scene.write("stroke.jsonl", stroke(1, 0.2).replace(from, to));
        for integrator in ["semi-implicit-euler", "exact-event", "energy-conserving"] {
            let _ = scene.report(&["--integrator", integrator]);
            assert_finite(&scene);
        }
    }
}

#[test]
fn stiff_light_and_heavy_probes_stay_finite() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.1));
    for probe in [
        "contact_stiffness_n_m = 1e9",
        "contact_stiffness_n_m = 1.0",
        "pad_mass_kg = 1e-6",
        "pad_damping_n_s_m = 0.0\ncontact_stiffness_n_m = 1e8",
        "pad_damping_n_s_m = 1e4",
        "finger_mass_kg = 1e-5",
        "pad_stiffness_n_m = 1e7\npad_mass_kg = 1e-6\nfinger_mass_kg = 100.0",
    ] {
        scene.write("scene.toml", format!("{TOML}\n[probe]\n{probe}\n"));
        for rate in ["8000", "44100", "192000"] {
            let _ = scene.report(&["--rate", rate]);
            assert_finite(&scene);
        }
    }
}

#[test]
fn a_hundred_thousand_events_in_a_tenth_of_a_second_are_survived() {
    let scene = Scene::new();
    let mut log = stroke(1, 0.05).lines().next().unwrap().to_owned() + "\n";
    for index in 0..100_000 {
        let t = f64::from(index) * 1e-6;
        let u = 0.1 + 1e-6 * f64::from(index);
        let _ = writeln!(
            log,
            r#"{{"t":{t},"event":"move","contact":1,"uv":[{u},0.5],"velocity_m_s":[0.1,0.0],"normal_force_n":0.5}}"#
        );
    }
    scene.write("stroke.jsonl", log);
    let report = scene.report(&[]);
    let lost = report["dropped"].as_u64().unwrap();
    assert!(report["events"].as_u64().unwrap() + lost <= 100_001);
    assert_finite(&scene);
}

#[test]
fn a_thousand_contacts_at_once_steal_voices_and_say_so() {
    let scene = Scene::new();
    let mut log = String::new();
    for contact in 0..1000 {
        let first = stroke(contact, 0.1).lines().next().unwrap().to_owned();
        let _ = writeln!(log, "{first}");
    }
    for contact in 0..1000 {
        let _ = writeln!(log, r#"{{"t":0.1,"event":"end","contact":{contact}}}"#);
    }
    scene.write("stroke.jsonl", log);
    let report = scene.report(&[]);
    assert_eq!(report["stolen"].as_u64().unwrap(), 1000 - 64);
    assert_finite(&scene);
}

#[test]
fn sixty_four_contacts_sound_without_stealing() {
    let scene = Scene::new();
    let mut lines: Vec<String> = (0..64)
        .flat_map(|contact| stroke(contact, 0.1).lines().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    let time = |line: &str| -> f64 { line[5..line.find(',').unwrap()].parse().unwrap() };
    lines.sort_by(|a, b| time(a).total_cmp(&time(b)));
    scene.write("stroke.jsonl", lines.join("\n"));
    let report = scene.report(&[]);
    assert_eq!((report["stolen"].as_u64(), report["dropped"].as_u64()), (Some(0), Some(0)));
    assert_finite(&scene);
}

#[test]
fn events_of_contacts_that_nobody_began_do_no_harm() {
    let scene = Scene::new();
    let log: String = stroke(1, 0.2).lines().skip(1).fold(String::new(), |log, line| log + line + "\n");
    scene.write("stroke.jsonl", log);
    assert!(scene.report(&[])["orphaned"].as_u64().unwrap() > 0);
    assert!(scene.samples("out.audio.wav").iter().all(|&sample| sample == 0.0));
}

#[test]
fn a_day_of_silence_is_refused_instead_of_filling_the_memory() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.1) + r#"{"t":86400.0,"event":"end","contact":1}"#);
    assert_refused(&scene.render(&[]), &["stroke.jsonl", "86400 s"]);
}

#[test]
fn maps_that_are_no_maps_are_refused_with_their_name() {
    let scene = Scene::new();
    let with_map = TOML.replace("roughness = 0.7", "displacement = \"map.png\"\nrelief_m = 0.001");
    scene.write("scene.toml", &with_map);
    assert_refused(&scene.render(&[]), &["map.png"]);
    let png = small_png();
    for (name, bytes) in [
        ("empty", Vec::new()),
        ("text", b"not a picture".to_vec()),
        ("half", png[..png.len() / 2].to_vec()),
        ("header only", png[..33].to_vec()),
        ("enormous", enormous_png()),
    ] {
        scene.write("map.png", &bytes);
        let refused = scene.render(&[]);
        assert_refused(&refused, &["map.png"]);
        assert!(scene.outputs().is_empty(), "{name}");
    }
    scene.write("map.png", &png);
    let _ = scene.report(&[]);
    assert_finite(&scene);
    scene.write("scene.toml", with_map.replace("relief_m", "channel = \"a\"\nrelief_m"));
    assert_refused(&scene.render(&[]), &["map.png", "alpha"]);
}

/// An 8 × 8 grey ramp.
fn small_png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let ramp = image::GrayImage::from_fn(8, 8, |x, y| image::Luma([(x * 16 + y) as u8]));
    ramp.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// A PNG whose header claims 60000 × 60000 texels; the checksum of the header is right.
fn enormous_png() -> Vec<u8> {
    let mut png = small_png();
    png[16..20].copy_from_slice(&60_000u32.to_be_bytes());
    png[20..24].copy_from_slice(&60_000u32.to_be_bytes());
    let crc = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    png
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

#[test]
fn modes_that_no_body_has_are_refused_with_their_place() {
    let scene = Scene::new();
    for (from, to) in [
        ("\"decay_per_s\":20.0", "\"decay_per_s\":-20.0"),
        ("\"decay_per_s\":20.0", "\"decay_per_s\":1e300"),
        ("\"frequency_hz\":700.0", "\"frequency_hz\":0.0"),
        ("\"frequency_hz\":700.0", "\"frequency_hz\":NaN"),
        ("\"amplitude\":0.3", "\"amplitude\":1e300"),
        ("\"version\":1", "\"version\":4"),
        ("asperity.modes", "other.modes"),
        ("\"impulse_n_s\":0.01", "\"impulse_n_s\":0.0"),
    ] {
        scene.write("bar.modes.json", MODES.replace(from, to));
        assert_refused(&scene.render(&[]), &[]);
    }
    scene.write("bar.modes.json", &MODES[..MODES.len() / 2]);
    assert_refused(&scene.render(&[]), &["bar.modes.json"]);
}

#[test]
fn scene_files_with_absurd_numbers_are_refused_by_key() {
    let scene = Scene::new();
    for (from, to, key) in [
        ("width_m = 0.1", "width_m = nan", "width_m"),
        ("width_m = 0.1", "width_m = 1e300", "width_m"),
        ("height_m = 0.1", "height_m = -inf", "height_m"),
        ("tail_s = 0.2", "tail_s = 1e300", "tail_s"),
        ("full_scale = 1.0", "full_scale = 0", "full_scale"),
        ("material = \"steel\"", "material = \"cheese\"", "material"),
        (
            "material = \"steel\"",
            "material = { young_pa = inf, poisson = 0.3, density_kg_m3 = 1000 }",
            "young_pa",
        ),
        ("roughness = 0.7", "roughnes = 0.7", "roughnes"),
        ("body = \"bar\"", "body = \"bra\"", "body"),
        ("full_scale = 1.0", "full_scale = 1.0\nequalise = \"tooth\"", "equalise"),
        ("roughness = 0.7", "solid = \"cheese\"", "solid"),
        ("contacts = \"stroke.jsonl\"", "", "contacts"),
        ("contacts = \"stroke.jsonl\"", "contacts = \"nothing.jsonl\"", "nothing.jsonl"),
    ] {
        assert!(TOML.contains(from), "{from}");
        scene.write("scene.toml", TOML.replace(from, to));
        assert_refused(&scene.render(&["--json"]), &[key]);
    }
    scene.write("scene.toml", [0xff, 0x00, 0x9f]);
    assert_refused(&scene.render(&[]), &["scene.toml"]);
    assert_refused(&support::asperity(scene.folder.path(), &["render", ".", "-o", "out"]), &["is a folder"]);
}

#[test]
fn a_missing_channel_is_refused_with_the_number_of_channels() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.3).replace("\"actuator\":0", "\"actuator\":9"));
    assert_refused(&scene.render(&[]), &["stroke.jsonl:1: actuator: 9", "must be below 1"]);
}
