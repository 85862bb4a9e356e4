//! Levels that nobody wrote: another stroke than the reference one lands near the reference levels
//! on every material, strikes that add up are kept from clipping, and bodies in pascals sound as
//! loud as they say.

use crate::common;

use asperity::files::Memory;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogHand, LogLine, Striker};
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::load::levels::{AUDIO_REFERENCE, HAPTIC_REFERENCE};
use asperity::offline::{self, Options, Render};
use asperity::{Engine, Material, SilenceReason};
use asperity_evidence::corpus::corpus;
use common::{peak, rms};
use std::path::Path;

fn rendered(toml: &str, files: &Memory, log: &ContactLog) -> Render {
    let file = SceneFile::parse(toml, Path::new("scene.toml")).unwrap();
    let overrides = Overrides { files, ..Overrides::default() };
    let Engine { scene, renderer, names, .. } = Engine::from_scene(&file, &overrides).unwrap();
    offline::render(scene, renderer, log, &names, &Options { tail_s: 0.0, ..Options::default() }).unwrap()
}

/// 0.1 m/s and 1 N, slanting, far from where the reference stroke runs.
fn other_stroke() -> ContactLog {
    let sample = |t: f64| ContactSample {
        uv: [0.05 + 0.06 * t / 0.14, 0.8 - 0.08 * t / 0.14],
        velocity_m_s: Some([0.06, -0.08]),
        normal_force_n: 1.0,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let mut lines = vec![LogLine { t: 0.0, event: LogEvent::begin(1, "s", 0, sample(0.0)) }];
    lines.extend((1..60).map(|step| {
        let t = f64::from(step) / 60.0;
        LogLine { t, event: LogEvent::moved(1, sample(t)) }
    }));
    lines.push(LogLine { t: 1.0, event: LogEvent::End { contact: 1 } });
    ContactLog { lines }
}

fn strike(t: f64, body: &str) -> LogLine {
    let event = LogEvent::Impact {
        body: body.to_owned(),
        other: None,
        speed_m_s: 0.5,
        mass_kg: 0.01,
        radius_m: 0.005,
        striker: Striker::Preset("steel".to_owned()),
        restitution: 1.0,
        position: 0,
        at_m: None,
        direction: None,
        hand: LogHand::default(),
    };
    LogLine { t, event }
}

const GROUNDS: [(&str, &str); 2] = [("flat", ""), ("stone", "solid = \"granite\"")];
/// Pictures of the corpus, as maps of 1 mm of relief.
const MAPS: [&str; 2] = ["Rock003_1K-PNG_Displacement.png", "Fabric061_1K-PNG_Displacement.png"];

fn scene(material: &str, probe: &str, ground: &str) -> String {
    format!(
        "[[body]]\nname = \"b\"\nstock = \"plate\"\nsize_m = 0.14\nmaterial = \"{material}\"\n\
         [[surface]]\nname = \"s\"\nbody = \"b\"\n{ground}\nwidth_m = 0.14\nheight_m = 0.14\n\
         [probe]\npreset = \"{probe}\"\n[[actuator]]\noutput = \"displacement\"\n"
    )
}

#[test]
fn another_stroke_lands_near_the_reference_levels_on_every_stock_material() {
    let (mut heard_within, mut cells) = (0, 0);
    let (mut least, mut most) = ([0.0f64; 2], [0.0f64; 2]);
    let mut files = Memory::new();
    let mut grounds = GROUNDS.map(|(name, line)| (name.to_owned(), line.to_owned())).to_vec();
    for name in MAPS {
        if let Some(file) = corpus(&format!("textures/{name}")) {
            files.add(name, std::fs::read(file).unwrap());
            grounds.push((name[..7].to_owned(), format!("displacement = \"{name}\"\nrelief_m = 1e-3")));
        }
    }
    for (index, preset) in Material::PRESETS.iter().enumerate() {
        // Maps take their time: on every fourth material.
        let grounds = if index % 4 == 0 { &grounds[..] } else { &grounds[..GROUNDS.len()] };
        for probe in ["fingertip", "stylus", "rigid"] {
            for (name, ground) in grounds {
                let render = rendered(&scene(preset.name, probe, ground), &files, &other_stroke());
                let of = [(&render.haptic[0], HAPTIC_REFERENCE), (&render.audio[0], AUDIO_REFERENCE)];
                let off_db = of.map(|(x, reference)| 20.0 * (rms(&x[8820..]) / reference).log10());
                if off_db.iter().any(|db| db.abs() > 4.0) {
                    println!(
                        "{}, {probe}, {name}: felt {:+.1}, heard {:+.1} dB",
                        preset.name, off_db[0], off_db[1]
                    );
                }
                cells += 1;
                heard_within += usize::from(off_db[1].abs() <= 6.0);
                for sense in 0..2 {
                    least[sense] = least[sense].min(off_db[sense]);
                    most[sense] = most[sense].max(off_db[sense]);
                }
                assert!(peak(&render.audio[0]) <= 1.0 && peak(&render.haptic[0]) <= 1.0);
            }
        }
    }
    println!("felt {:+.1} to {:+.1} dB, heard {:+.1} to {:+.1} dB", least[0], most[0], least[1], most[1]);
    println!("heard within 6 dB: {heard_within} of {cells}");
    assert!(least[0] >= -6.0 && most[0] <= 6.0, "felt: {least:?} {most:?}");
    assert!(heard_within == cells, "heard: {least:?} {most:?}");
}

#[test]
fn fifty_strikes_a_second_never_clip() {
    let (mut within, mut cells) = (0, 0);
    for preset in Material::PRESETS {
        let toml = scene(preset.name, "fingertip", GROUNDS[0].1);
        // As often as told, and the document's thirty milliseconds apart.
        for apart_s in [0.02, 0.03] {
            let lines = (0..50).map(|n| strike(apart_s * f64::from(n), "b")).collect();
            let render = rendered(&toml, &Memory::new(), &ContactLog { lines });
            let peak = peak(&render.audio[0]);
            println!("{}, {apart_s} s: peak {peak:.2}, limiter {:.1} dB", preset.name, render.limiter_db);
            assert!((0.02..=1.0).contains(&peak), "{}: {peak}", preset.name);
            within += usize::from(render.limiter_db <= 6.0);
            cells += 1;
        }
    }
    println!("{within} of {cells} within 6 dB");
    assert!(20 * within >= 19 * cells);
}

/// What was open: seventy decibels taken off a strike, and no word of it.
#[test]
fn a_hard_working_limiter_is_reported_with_the_keys_that_help() {
    let struck = |audio: &str, key: &str| {
        let plate = "name = \"b\"\nstock = \"plate\"\nsize_m = 0.14\nmaterial = \"glass\"";
        let toml = format!("[[body]]\n{plate}\n{key}\n[[actuator]]\nfull_scale = 1e-4\n[audio]\n{audio}\n");
        let lines = vec![strike(0.0, "b"), LogLine { t: 0.3, event: LogEvent::End { contact: 9 } }];
        rendered(&toml, &Memory::new(), &ContactLog { lines })
    };
    let message = |render: &Render| {
        render.why_silent.iter().find_map(|reason| match reason {
            SilenceReason::TurnedDown { by_db } => Some((*by_db, reason.to_string())),
            _ => None,
        })
    };
    // The gain with which a strike peaks at full scale.
    let full = 1e-3 / peak(&struck("gain = 1e-3\nlimit = false", "").audio[0]);
    for over_db in [20.0f64, 40.0, 70.0] {
        let gain = full * 10f64.powf(over_db / 20.0);
        let loud = struck(&format!("gain = {gain}\nlimit = true"), "");
        assert!(peak(&loud.audio[0]) <= 1.0);
        let (by_db, words) = message(&loud).expect("a limiter that works so hard is told");
        println!("{over_db} dB over full scale: {words}");
        assert!((by_db as f64 - over_db).abs() <= 2.0, "{by_db} of {over_db} dB");
        for key in ["gain of its bus", "strike_gain", "full_scale"] {
            assert!(words.contains(key), "{words}");
        }
        // What the words name mends it.
        let mended =
            struck(&format!("gain = {gain}\nlimit = true"), &format!("strike_gain = {}", full / gain));
        assert!(message(&mended).is_none() && mended.limiter_db < 1.0, "{} dB", mended.limiter_db);
    }
    // A limiter that only rounds peaks off is not a reason to be told.
    let near = struck(&format!("gain = {}\nlimit = true", 2.0 * full), "");
    assert!(message(&near).is_none() && near.limiter_db > 3.0, "{} dB", near.limiter_db);
    // Nor one that is not there.
    assert!(message(&struck(&format!("gain = {}\nlimit = false", 100.0 * full), "")).is_none());
}

#[test]
fn strikes_keep_their_balance_unless_mechanical_loudness_is_asked() {
    let body = |name: &str, material: &str, key: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nstock = \"plate\"\nsize_m = 0.14\nmaterial = \"{material}\"\n{key}\n\
             [[surface]]\nname = \"{name}-top\"\nbody = \"{name}\"\nwidth_m = 0.14\nheight_m = 0.14\n\
             roughness = 0.1\nmicro_relief_m = 1e-6\n"
        )
    };
    let opened = |toml: &str| {
        let file = SceneFile::parse(toml, Path::new("two.toml")).unwrap();
        Engine::from_scene(&file, &Overrides::default()).unwrap().levels
    };
    let found = opened(&(body("a", "glass", "") + &body("b", "wood", "")));
    assert!(found.strike_gain[0] < 0.3 && found.strike_gain[0] == found.strike_gain[1], "{found:?}");
    // One that is written is its own, and the others are found without it.
    let beside = opened(&(body("a", "glass", "strike_gain = 1.0") + &body("b", "wood", "")));
    assert!(beside.strike_gain[0] == 1.0 && beside.strike_gain[1] >= found.strike_gain[1], "{beside:?}");
    // With a gain of its own a bus leaves strikes alone.
    let written = opened(&(body("a", "glass", "") + "[audio]\ngain = 2.0\n"));
    assert_eq!(written.strike_gain, [1.0]);
    // What is turned down is turned down by as much as is told, and strokes are not.
    let toml = |key: &str| body("a", "glass", key) + "[audio]\ngain = 1e-3\nlimit = false\n";
    let struck = |key: &str| {
        let lines = vec![strike(0.0, "a"), LogLine { t: 0.3, event: LogEvent::End { contact: 9 } }];
        peak(&rendered(&toml(key), &Memory::new(), &ContactLog { lines }).audio[0])
    };
    assert!((struck("strike_gain = 0.25") / struck("") - 0.25).abs() < 1e-6);
    let mut stroked = other_stroke();
    stroked.lines.iter_mut().for_each(|line| {
        if let LogEvent::Begin { touching, .. } = &mut line.event {
            touching.surface = "a-top".to_owned();
        }
    });
    let [soft, plain] =
        ["strike_gain = 0.25", ""].map(|key| rendered(&toml(key), &Memory::new(), &stroked).audio);
    assert_eq!(soft, plain);
}

#[test]
fn a_body_added_later_is_as_loud_as_the_scene_files() {
    let body = |name: &str, key: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nstock = \"plate\"\nsize_m = 0.14\nmaterial = \"glass\"\n{key}\n"
        )
    };
    let top = "[[surface]]\nname = \"top\"\nbody = \"a\"\nwidth_m = 0.14\nheight_m = 0.14\nroughness = 0.1\nmicro_relief_m = 1e-6\n";
    let opened = |toml: &str| {
        let file = SceneFile::parse(toml, Path::new("one.toml")).unwrap();
        Engine::from_scene(&file, &Overrides::default()).unwrap()
    };
    let added = |toml: &str, key: &str| {
        let Engine { mut scene, .. } = opened(toml);
        let table = format!("stock = \"plate\"\nsize_m = 0.14\nmaterial = \"glass\"\n{key}");
        let body = scene.read_body(&table, Path::new(""), &Overrides::default()).unwrap();
        let id = scene.add_body(body).unwrap();
        scene.strike_gain_of(id).unwrap()
    };
    let silent = body("a", "") + top;
    let found = opened(&silent).levels.strike_gain[0];
    assert!(found < 0.5, "{found}");
    assert_eq!(added(&silent, ""), found);
    assert_eq!(added(&silent, "strike_gain = 0.9"), 0.9);
    // What one body says of itself is no policy for others.
    assert_eq!(added(&(body("a", "strike_gain = 0.01") + top), ""), 1.0);
    assert_eq!(added(&(silent + "[audio]\ngain = 2.0\n"), ""), 1.0);
}

#[test]
fn bodies_in_pascals_have_their_level_and_leave_neighbours_alone() {
    let modes = |unit: &str| {
        format!(
            "{{\"format\":\"asperity.modes\",\"version\":1,\"impulse_n_s\":0.01,{unit}\"modes\":[\
             {{\"frequency_hz\":800.0,\"decay_per_s\":8.0,\"amplitude\":0.4,\"phase_rad\":0.0}}]}}"
        )
    };
    let mut files = Memory::new();
    files.add("calibrated.modes.json", modes("\"unit\":\"pa_1m\","));
    files.add("relative.modes.json", modes(""));
    let toml = |audio: &str| {
        format!(
            "[[body]]\nname = \"c\"\nmodes = \"calibrated.modes.json\"\n[[body]]\nname = \"r\"\nmodes = \"relative.modes.json\"\n\
             [[surface]]\nname = \"s\"\nbody = \"r\"\nwidth_m = 0.14\nheight_m = 0.14\n\
             [[actuator]]\nfull_scale = 1e-4\n[audio]\n{audio}\nlimit = false\n"
        )
    };
    let struck = |audio: &str, body: &str| {
        let lines = vec![strike(0.0, body), LogLine { t: 0.4, event: LogEvent::End { contact: 9 } }];
        peak(&rendered(&toml(audio), &files, &ContactLog { lines }).audio[0])
    };
    // 10 g at 0.5 m/s that come back: 0.01 N·s, so the peak is some 0.4 Pa less what 2 ms of decay
    // and the pulse take.
    let plain = struck("gain = 1.0", "c");
    assert!((0.3..0.4).contains(&plain), "{plain}");
    for pascals in [0.5, 2.0] {
        let written = struck(&format!("gain = 1.0\npascals_at_full_scale = {pascals}"), "c");
        assert!((written * pascals / plain - 1.0).abs() < 1e-5, "{written}");
        let found = struck(&format!("pascals_at_full_scale = {pascals}"), "c");
        assert!((found * pascals / plain - 1.0).abs() < 1e-5, "{found}");
    }
    // The other body keeps the level that the policy gives it.
    let alone = struck("", "r");
    let beside = struck("pascals_at_full_scale = 2.0", "r");
    assert!((beside / alone - 1.0).abs() < 1e-5, "{beside} {alone}");
}

#[test]
fn buses_without_a_gain_share_one_except_those_in_pascals() {
    let gains = |audio: &str, surfaces: &str| {
        let toml = format!(
            "[[body]]\nname = \"plate\"\nstock = \"plate\"\nsize_m = 0.14\nmaterial = \"ceramic\"\nbus = \"left\"\n\
             [[body]]\nname = \"bowl\"\nstock = \"bowl\"\nsize_m = 0.2\nmaterial = \"glass\"\nbus = \"right\"\n\
             {surfaces}[[actuator]]\nfull_scale = 1e-4\n{audio}"
        );
        let file = SceneFile::parse(&toml, Path::new("two.toml")).unwrap();
        Engine::from_scene(&file, &Overrides::default()).unwrap().levels.gain
    };
    let surface = |body: &str, relief: &str| {
        format!(
            "[[surface]]\nname = \"{body}-top\"\nbody = \"{body}\"\nwidth_m = 0.14\nheight_m = 0.14\n{relief}"
        )
    };
    let rough = surface("plate", "roughness = 0.9\n") + &surface("bowl", "roughness = 0.2\n");
    let buses = |left: &str, right: &str| {
        format!("[[audio]]\nname = \"left\"\n{left}[[audio]]\nname = \"right\"\n{right}")
    };
    let shared = gains(&buses("", ""), &rough);
    assert!(shared[0] == shared[1] && shared[0] != 1.0, "{shared:?}");
    // One that is written is its own; the other is found for itself.
    let written = gains(&buses("gain = 3.0\n", ""), &rough);
    assert!(written[0] == 3.0 && written[1] != 3.0, "{written:?}");
    // A stock body tells pascals: nothing is to be found for its bus, whatever else sounds.
    let calibrated = gains(&buses("pascals_at_full_scale = 2.0\n", ""), &rough);
    assert!(calibrated[0] == 1.0 && calibrated[1] != 1.0, "{calibrated:?}");
}
