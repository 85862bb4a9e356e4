//! Nothing is lost in silence: what a render refuses, loses or clips it says, with what mends it.

use crate::support;

use std::fmt::Write as _;
use support::{MODES, Scene, TOML, assert_refused, impact, message, stroke};

/// What a render of this log prints without `--json`; it succeeds, and says the same in `warnings`.
fn said(toml: &str, log: &str) -> String {
    let scene = Scene::new();
    scene.write("scene.toml", toml);
    scene.write("stroke.jsonl", log);
    let (status, out, err) = message(&scene.render(&[]));
    assert_eq!((status, err.as_str()), (0, ""), "{out}");
    let message: Vec<&str> = out.lines().filter_map(|line| line.strip_prefix("warning: ")).collect();
    let report = scene.report(&[]);
    let warnings: Vec<&str> =
        report["warnings"].as_array().unwrap().iter().filter_map(|w| w.as_str()).collect();
    assert_eq!(message, warnings);
    message.join("\n")
}

fn assert_says(said: &str, parts: &[&str]) {
    for part in parts {
        assert!(said.contains(part), "{said:?}\nlacks\n{part}");
    }
}

#[test]
fn an_ordinary_render_warns_of_nothing() {
    assert_eq!(said(TOML, &(stroke(1, 0.5) + &impact(0.55))), "");
}

#[test]
fn refused_events_are_counted_with_the_first_of_them_and_its_field() {
    let slow = stroke(1, 0.5)
        .replace("\"velocity_m_s\":[0.08,0.0]", "\"velocity_m_s\":[0.08,0.0],\"slip_m_s\":-1.0");
    let said = said(TOML, &slow);
    assert_says(
        &said,
        &["30 of 31 events were refused, the first at t = 0 s", "slip_m_s: -1 is refused; must be"],
    );
    assert_says(&said, &["the audio is silence", "every haptic channel is silence"]);
}

#[test]
fn moves_under_another_number_are_told_with_the_contact_and_the_time() {
    let log = stroke(1, 0.5).replace("\"move\",\"contact\":1", "\"move\",\"contact\":7");
    assert_says(
        &said(TOML, &log),
        &["speak of a contact that is not there, the first of contact 7 at t = 0.0", "\"begin\""],
    );
}

#[test]
fn a_contact_that_is_never_ended_is_told_to_have_faded() {
    let log: String = stroke(3, 0.2)
        .lines()
        .filter(|line| !line.contains("\"end\""))
        .fold(String::new(), |log, line| log + line + "\n");
    let toml = TOML.replace("tail_s = 0.2", "tail_s = 0.6");
    assert_says(
        &said(&toml, &log),
        &["1 contact faded", "for 0.25 s, the first contact 3 after t = 0.", "\"end\""],
    );
}

#[test]
fn voices_that_were_stolen_are_told() {
    let mut log = String::new();
    for contact in 0..70 {
        writeln!(
            log,
            r#"{{"t":0.0,"event":"begin","contact":{contact},"surface":"plate","uv":[0.1,0.5],"velocity_m_s":[0.1,0.0],"normal_force_n":0.5}}"#
        )
        .unwrap();
    }
    assert_says(&said(TOML, &log), &["6 contacts were silenced because more than 64 sounded at once"]);
}

#[test]
fn wrong_force_units_standing_times_and_constant_blows_are_reported() {
    let heavy = stroke(1, 0.5).replace("\"normal_force_n\":0.6", "\"normal_force_n\":600");
    assert_says(
        &said(TOML, &heavy),
        &["30 reports press a finger or a light tool with 600 N", "is it in mN, or in grams?"],
    );
    let at_once = |line: &str| format!("{{\"t\":0,{}\n", line.split_once(',').unwrap().1);
    let stands: String = stroke(1, 0.5).lines().map(at_once).collect();
    assert_says(&said(TOML, &stands), &["29 reports came at one time, 0 s", "goes on from step to step"]);
    let every: String = (0..40).map(|step| impact(f64::from(step) / 60.0)).collect();
    assert_says(
        &said(TOML, &every),
        &["40 impacts in a row struck one body", "\"begin\", moves and \"end\""],
    );
}

#[test]
fn a_file_of_silence_is_explained() {
    let mute = format!("{TOML}\n[audio]\ngain = 0.0\n");
    assert_says(
        &said(&mute, &stroke(1, 0.3)),
        &["the audio is silence", "gain under [audio] is 0; raise it"],
    );
    let no_body = TOML.replace("body = \"bar\"\n", "");
    assert_says(
        &said(&no_body, &stroke(1, 0.3)),
        &["the audio is silence", "write body = \"NAME\" in [[surface]]"],
    );
    assert_says(
        &said(TOML, &impact(0.1)),
        &["every haptic channel is silence", "no contact begins in the log"],
    );
    assert_says(&said(TOML, ""), &["the log holds no event"]);
    let rests = r#"{"t":0.0,"event":"begin","contact":1,"surface":"plate","uv":[0.1,0.5],"velocity_m_s":[0,0],"normal_force_n":0.5}
{"t":0.2,"event":"end","contact":1}
"#;
    assert_says(&said(TOML, rests), &["every haptic channel is silence", "no contact moved"]);
}

#[test]
fn a_haptic_channel_beyond_full_scale_is_told_and_the_remedy_works() {
    let loud = TOML.replace("full_scale = 1.0", "full_scale = 1e-8");
    let log = stroke(1, 0.3);
    assert_says(&said(&loud, &log), &["haptic channel 0 peaks at", "raise full_scale", "limit = true there"]);
    let scene = Scene::new();
    scene.write("scene.toml", loud.replace("1e-8", "1e-8\nlimit = true"));
    scene.write("stroke.jsonl", log);
    let report = scene.report(&[]);
    let peak = report["haptic_peak"][0].as_f64().unwrap();
    assert!(peak <= 1.0 && peak > 0.9, "{peak}");
    // So deep a limiter squeezes all that is felt into one level; some decibels are what it is for.
    assert_says(&report["warnings"].to_string(), &["a limiter turned down by up to", "raise full_scale"]);
    let by_db = report["limiter_db"].as_f64().unwrap();
    let raised = 1e-8 * 10.0_f64.powf((by_db - 9.0) / 20.0);
    scene.write("scene.toml", loud.replace("1e-8", &format!("{raised:e}\nlimit = true")));
    let report = scene.report(&[]);
    assert!(report["limiter_db"].as_f64().unwrap() > 6.0, "{report}");
    assert!(report["warnings"].as_array().unwrap().is_empty(), "{report}");
}

#[test]
fn an_unknown_log_key_is_refused_and_an_unused_one_reported() {
    let scene = Scene::new();
    scene.write("stroke.jsonl", stroke(1, 0.2).replacen("velocity_m_s", "velocity", 1));
    assert_refused(
        &scene.render(&[]),
        &["stroke.jsonl:1: velocity", "unknown key of \"begin\"", "write velocity_m_s"],
    );
    let place = stroke(1, 0.2).replacen("\"contact\":1,", "\"contact\":1,\"direction\":[0,0,1],", 1);
    assert_says(&said(TOML, &place), &["stroke.jsonl:1: direction: is a key of the format"]);
}

#[test]
fn a_recording_in_place_of_modes_is_answered_with_fit() {
    let scene = Scene::new();
    scene.write("bar.modes.json", [b"RIFF\xff\xfe\x80".as_slice(), MODES.as_bytes()].concat());
    assert_refused(&scene.render(&[]), &["bar.modes.json", "asperity fit"]);
}

#[test]
fn sand_too_coarse_for_its_tool_is_refused_with_the_cells_needed() {
    let scene = Scene::new();
    let sand = "sand = { cells = 16, tool_radius_m = 0.002 }\nwidth_m = 0.1";
    scene.write("scene.toml", TOML.replace("width_m = 0.1", sand).replace("roughness = 0.7\n", ""));
    assert_refused(&scene.render(&[]), &["sand: cells", "16 is refused", "must be at least 25"]);
}

#[test]
fn an_impact_that_lasts_longer_than_is_played_is_told() {
    let foam = impact(0.1)
        .replace("\"mass_kg\":0.01", "\"mass_kg\":900.0")
        .replace("\"striker\":\"steel\"", "\"striker\":\"rubber\"");
    let slow = foam.replace("\"speed_m_s\":0.5", "\"speed_m_s\":0.001");
    assert_says(&said(TOML, &slow), &["1 impact or micro-collision would outlast", "(0.17 s"]);
}

#[test]
fn each_output_that_is_silent_is_told_with_its_own_reason() {
    let unnamed = stroke(1, 0.3).replace("\"actuator\":0,", "");
    assert_says(
        &said(TOML, &unnamed),
        &[
            "every haptic channel is silence: nothing in the log names it; write \"actuator\":0 in the \"begin\"",
        ],
    );
    let two = format!("{TOML}\n[[actuator]]\nfull_scale = 1.0\n");
    let message = said(&two, &stroke(1, 0.3));
    assert_says(
        &message,
        &["haptic channel 1 is silence: nothing in the log names it; write \"actuator\":1"],
    );
    assert!(!message.contains("channel 0") && !message.contains("audio"), "{message}");
    let buses = format!("{TOML}\n[[audio]]\nname = \"room\"\n[[audio]]\nname = \"hand\"\n");
    let message = said(&buses, &stroke(1, 0.3));
    assert_says(
        &message,
        &["audio bus \"hand\" is silence: no body plays on it; write bus = \"hand\" in a [[body]]"],
    );
    let muted = stroke(1, 0.3).replace("\"event\":\"begin\"", "\"event\":\"begin\",\"gain\":0");
    let message = said(TOML, &muted);
    assert_says(&message, &["the audio is silence", "\"gain\" is 0 in every begin and impact of the log"]);
    assert_says(&message, &["every haptic channel is silence: \"gain\" is 0"]);
    let unheard = TOML.replace("roughness = 0.7", "roughness = 0.7\nexcitation = []");
    assert_says(
        &said(&unheard, &stroke(1, 0.3)),
        &["sends nothing to its body; write excitation = \"both\""],
    );
}

#[test]
fn felt_impacts_and_answering_sand_are_not_called_silent() {
    let felt = impact(0.1).replace("\"striker\"", "\"actuator\":0,\"striker\"");
    let message = said(TOML, &felt);
    assert!(!message.contains("haptic"), "{message}");
    let sand = TOML.replace("roughness = 0.7", "sand = { cells = 64, depth_m = 0.02 }");
    let deep = stroke(1, 0.3).replace("\"normal_force_n\":0.6", "\"depth_m\":0.004");
    assert_ne!(deep, stroke(1, 0.3));
    let message = said(&sand, &deep);
    assert!(!message.contains("no contact was pressed"), "{message}");
}

#[test]
fn a_log_that_contradicts_itself_is_told_with_both_speeds() {
    let log = stroke(1, 0.5).replace("\"velocity_m_s\":[0.08,", "\"velocity_m_s\":[80,");
    assert_ne!(log, stroke(1, 0.5));
    assert_says(
        &said(TOML, &log),
        &["uv moves at 0.08", "where velocity_m_s says 80.000 m/s", "is velocity_m_s in mm/s?"],
    );
}

#[test]
fn a_blow_told_after_the_rebound_is_told_to_have_no_speed() {
    let still = impact(0.1).replace("\"speed_m_s\":0.5", "\"speed_m_s\":0.0");
    assert!(still.contains("\"speed_m_s\":0.0"), "{still}");
    let back = impact(0.2).replace("\"speed_m_s\":0.5", "\"speed_m_s\":-0.5");
    let one = said(TOML, &(stroke(1, 0.5) + &still.replace("\"t\":0.1", "\"t\":0.55")));
    assert_eq!(
        one,
        "1 impact was silent for its speed_m_s of 0 or below, the first at t = 0.55 s; write the speed of approach before the blow, not after it"
    );
    let both = said(TOML, &(still + &back));
    assert_says(&both, &["2 impacts were silent for their speed_m_s of 0 or below, the first at t = 0.1 s"]);
    assert!(!both.contains("1e4 N"), "{both}");
}

#[test]
fn inaudible_stock_bodies_are_reported_and_huge_ones_need_no_mass() {
    let stock = |keys: &str| TOML.replace("modes = \"bar.modes.json\"\nmaterial = \"steel\"", keys);
    let small = stock("stock = \"bar\"\nsize_m = 0.002\nmaterial = \"steel\"");
    assert_ne!(small, TOML);
    for toml in [
        small,
        stock(
            "stock = \"bar\"\nsize_m = 0.2\nmaterial = { young_pa = 2e11, poisson = 0.3, density_kg_m3 = 1.9 }",
        ),
    ] {
        let said = said(&toml, &impact(0.1));
        assert_says(&said, &["body \"bar\" rings outside 16 Hz to 20 kHz only", "size_m or its material"]);
    }
    let huge = stock("stock = \"block\"\nsize_m = 20.0\nmaterial = \"steel\"");
    assert!(!said(&huge, &impact(0.1)).contains("mass_kg"));
}

#[test]
fn micrometres_as_full_scale_are_told() {
    let micrometres = TOML.replace("full_scale = 1.0", "full_scale = 100.0");
    let said = said(&micrometres, &stroke(1, 0.5));
    assert_says(&said, &["actuator 0: full_scale = 100 is metres", "if these are micrometres, write 1e-4"]);
}

#[test]
fn logs_of_other_programs_are_refused_with_line_key_and_reason() {
    let scene = Scene::new();
    let good = stroke(1, 0.1);
    let nan = good.replacen("\"normal_force_n\":0.6", "\"normal_force_n\": NaN", 1);
    let place = good.replace("\"uv\":[0.1,0.5]", "\"at_m\":[0.01,0.05,0.0]");
    assert!(nan != good && place != good, "{good}");
    for (log, parts) in [
        (nan, &["stroke.jsonl:1: normal_force_n: NaN is no JSON; write a finite number"][..]),
        (
            good.replacen("[0.08,0.0]", "[0.08,-Infinity]", 1),
            &["stroke.jsonl:1: velocity_m_s: -Infinity is no JSON"],
        ),
        (
            "time,u,v,force\n0,0.1,0.2,0.5\n".to_owned(),
            &["stroke.jsonl:1: is a row of a table (CSV)", "one JSON object a line"],
        ),
        (place, &["stroke.jsonl:1: at_m: surface \"plate\" has no frame", "[surface.frame]"]),
    ] {
        scene.write("stroke.jsonl", log);
        assert_refused(&scene.render(&[]), parts);
    }
    // A mark of the byte order, as Windows' editors write it, is no fault.
    scene.write("stroke.jsonl", format!("\u{feff}{good}"));
    assert!(scene.report(&[])["events"].as_u64().unwrap() > 1);
    scene.write("scene.toml", "time,u,v,force\n0,0.1,0.2,0.5\n");
    assert_refused(&scene.render(&[]), &["is a table (CSV), not a scene", "one JSON object a line"]);
    scene.write("scene.toml", TOML.replace("roughness = 0.7", "solid = \"rough-glas\""));
    assert_refused(&scene.render(&[]), &["rough-glass"]);
}
