use super::*;
use crate::model::event::{ChannelId, ContactEvent, Impact};
use crate::model::id::{BodyId, ProbeId, SurfaceId};
use std::collections::HashMap;

const LOG: &str = r#"{"t":0.0,"event":"begin","contact":1,"surface":"tiles","actuator":0,"uv":[0.1,0.5],"velocity_m_s":[0.08,0.0],"normal_force_n":0.6,"closing_m_s":0.05}
{"t":0.0167,"event":"move","contact":1,"uv":[0.11,0.5],"normal_force_n":0.62}
{"t":0.2,"event":"impact","body":"tile","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"steel"}
{"t":0.9,"event":"end","contact":1}
"#;

fn surface() -> SurfaceId {
    SurfaceId::from_bits(3 << 32)
}

fn body() -> BodyId {
    BodyId::from_bits(4 << 32)
}

fn names() -> Names {
    Names {
        surfaces: HashMap::from([("tiles".to_owned(), surface())]),
        bodies: HashMap::from([("tile".to_owned(), body()), ("pen".to_owned(), body())]),
        probes: HashMap::from([("stylus".to_owned(), ProbeId::from_bits(1 << 32))]),
    }
}

#[test]
fn the_documented_lines_are_read_and_written_back() {
    let log = ContactLog::parse(LOG, "log").unwrap();
    assert_eq!(log.lines.len(), 4);
    assert_eq!(log.end_s(), 0.9);
    let mut text = Vec::new();
    log.write(&mut text).unwrap();
    assert_eq!(ContactLog::parse(std::str::from_utf8(&text).unwrap(), "copy").unwrap(), log);
}

#[test]
fn names_become_the_ids_of_the_scene() {
    let log = ContactLog::parse(LOG, "log").unwrap();
    let events: Vec<_> = log.lines.iter().map(|l| l.event.resolve(&names()).unwrap()).collect();
    assert!(matches!(events[0], ContactEvent::Begin { touching, .. } if touching.surface == surface()));
    assert!(matches!(
        events[2],
        ContactEvent::Impact(Impact { body: id, striker: Material::STEEL, .. }) if id == body()
    ));
}

#[test]
fn an_unknown_name_is_answered_with_the_names_there_are() {
    let line: LogLine = serde_json::from_str(&LOG.lines().next().unwrap().replace("tiles", "tils")).unwrap();
    let message = line.event.resolve(&names()).unwrap_err().to_string();
    assert_eq!(message, "surface: \"tils\" is unknown; must be one of: tiles");
}

#[test]
fn time_running_backwards_is_refused_with_its_line() {
    let backwards = LOG.replace("\"t\":0.2", "\"t\":0.001");
    let message = ContactLog::parse(&backwards, "log").unwrap_err().to_string();
    assert!(message.starts_with("log:3: t = 0.001 s comes after 0.0167 s"), "{message}");
    assert!(ContactLog::parse(r#"{"t":-1.0,"event":"end","contact":1}"#, "log").is_err());
}

#[test]
fn an_unknown_key_is_refused_with_line_and_likely_key() {
    let words = |text: &str| ContactLog::parse(text, "log").unwrap_err().to_string();
    let line =
        r#"{"t":0.0,"event":"move","contact":1,"uv":[0.1,0.5],"velocity":[0.1,0.0],"normal_force_n":1}"#;
    assert_eq!(words(line), "log:1: velocity: unknown key of \"move\"; write velocity_m_s");
    let message = words(&format!("{LOG}{}", line.replace("velocity", "colour")));
    assert!(
        message.starts_with("log:5: colour: unknown key of \"move\"; accepted here: actuator, "),
        "{message}"
    );
    assert!(message.contains("velocity_m_s") && !message.contains("probe"), "{message}");
    // A forgotten unit is told before the key that is missing for it.
    assert!(
        words(&line.replace("velocity", "gain").replace("force_n", "force"))
            .ends_with("write normal_force_n")
    );
    assert!(words(r#"{"t":0.0,"event":"end","contact":1,"uv":[0,0]}"#).contains("accepted here: contact, "));
}

#[test]
fn every_key_of_the_format_is_accepted_and_unused_ones_reported() {
    let begin = r#"{"t":0,"event":"begin","version":1,"contact":1,"surface":"tiles","actuator":0,"uv":[0,0],"velocity_m_s":[0,0],
        "normal_force_n":1,"closing_m_s":0.1,"probe":"stylus","holder":"pen","at_m":[0,0,0],"depth_m":0.001,"gain":1,
        "importance":1,"direction":[0,0,1]}"#;
    let strike = r#"{"t":0.1,"event":"impact","body":"tile","other":"tile","speed_m_s":1,"mass_kg":0.01,"radius_m":0.01,
        "striker":"steel","restitution":0.5,"position":0,"at_m":[0,0,0],"direction":[0,0,1],"holder":"pen","actuator":0,"gain":2}"#;
    let text = format!("{}\n{}\n", begin.replace('\n', ""), strike.replace('\n', ""));
    let (log, unread) = ContactLog::parse_telling(&text, "log").unwrap();
    assert_eq!(log.lines.len(), 2);
    assert!(unread.contains(&"log:1: direction".to_owned()), "{unread:?}");
    let begun = log.lines[0].event.resolve(&names()).unwrap();
    let ContactEvent::Begin { touching, .. } = begun else { panic!("{begun:?}") };
    assert_eq!((touching.probe, touching.holder), (Some(ProbeId::from_bits(1 << 32)), Some(body())));
    assert_eq!((touching.actuator, touching.gain), (Some(ChannelId(0)), 1.0));
    let struck = log.lines[1].event.resolve(&names()).unwrap();
    assert!(matches!(struck, ContactEvent::Impact(Impact { gain: 2.0, holder: Some(_), .. })), "{struck:?}");
    assert!(ContactLog::parse_telling(LOG, "log").unwrap().1.is_empty());
}

#[test]
fn broken_lines_are_refused_with_their_place() {
    for broken in ["{", "[]", r#"{"t":0.0,"event":"jump"}"#, r#"{"t":1e300,"event":"end","contact":1}"#] {
        let message = ContactLog::parse(broken, "log").unwrap_err().to_string();
        assert!(message.starts_with("log:1: "), "{message}");
    }
}

#[test]
fn a_log_says_its_version_and_one_of_another_is_refused() {
    let log = ContactLog::parse(LOG, "log").unwrap();
    let mut text = Vec::new();
    log.write(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.starts_with("{\"version\":1,\"t\":0.0,\"event\":\"begin\""), "{text}");
    assert_eq!(text.matches("version").count(), 1);
    for future in [text.replace("\"version\":1", "\"version\":2"), format!("{{\"version\":2}}\n{LOG}")] {
        let message = ContactLog::parse(&future, "log").unwrap_err().to_string();
        assert_eq!(message, "log:1: version: 2 is unknown; must be 1, or missing");
    }
    assert_eq!(ContactLog::parse(&format!("{{\"version\":1}}\n{LOG}"), "log").unwrap(), log);
    assert!(ContactLog::parse("{\"version\":\"1\"}", "log").is_err());
}

/// Slips of a line: what is written, what stands there instead, and what is told of it.
const SLIPS: [(&str, &str, &str); 32] = [
    ("\"event\":\"begin\",", "", "event: is missing; write \"event\":\"begin\", "),
    ("\"event\"", "\"Event\"", "Event: unknown key; write event, "),
    ("\"event\"", "\"type\"", "type: unknown key; write event, "),
    ("\"begin\"", "\"Begin\"", "event: \"Begin\" is unknown; write \"begin\""),
    ("\"begin\"", "\"began\"", "event: \"began\" is unknown; write \"begin\""),
    ("\"begin\"", "\"start\"", "event: \"start\" is unknown; write \"begin\""),
    (
        "\"begin\"",
        "\"jump\"",
        "event: \"jump\" is unknown; must be \"begin\", \"move\", \"end\", \"impact\" or \"motion\"",
    ),
    ("\"begin\"", "7", "event: 7 is unknown; must be \"begin\", "),
    ("\"t\":0.0,", "", "t: is missing; write \"t\":"),
    ("\"t\":0.0", "\"time\":0.0", "time: unknown key of \"begin\"; write t"),
    ("\"t\":0.0", "\"t\":\"0.0\"", "t: \"0.0\" is refused; must be a number, the time in seconds"),
    ("\"t\":0.0", "\"t\":9e9", "t: 9000000000.0 s is more than a day; must be in seconds"),
    ("\"contact\":1,", "", "contact: is missing in \"begin\"; write \"contact\":1"),
    ("\"contact\":1", "\"contact\":-1", "contact: -1 is refused; must be a whole number from 0 on"),
    ("\"contact\":1", "\"contact\":\"finger\"", "contact: \"finger\" is refused; must be a whole number"),
    ("\"contact\"", "\"id\"", "id: unknown key of \"begin\"; write contact"),
    ("\"surface\":\"tiles\",", "", "surface: is missing in \"begin\"; write \"surface\":\"NAME\""),
    ("\"surface\":\"tiles\"", "\"surface\":0", "surface: 0 is refused; must be a name in quotes"),
    ("\"actuator\":0", "\"actuator\":0.5", "actuator: 0.5 is refused; must be a whole number"),
    ("\"uv\":[0.1,0.5],", "", "uv: is missing in \"begin\"; write \"uv\":[0.5,0.5]; or at_m"),
    ("[0.1,0.5]", "\"0.1,0.5\"", "uv: \"0.1,0.5\" is refused; must be two numbers"),
    ("[0.1,0.5]", "[0.1,0.5,0.0]", "uv: [0.1,0.5,0.0] is refused; must be two numbers"),
    ("[0.1,0.5]", "{\"x\":0.1,\"y\":0.5}", "uv: {\"x\":0.1,\"y\":0.5} is refused; must be two numbers"),
    ("[0.1,0.5]", "[0.1,null]", "uv: [0.1,null] is refused; must be two numbers"),
    ("\"uv\"", "\"UV\"", "UV: unknown key of \"begin\"; write uv"),
    ("[0.08,0.0]", "0.08", "velocity_m_s: 0.08 is refused; must be two numbers, along u and along v"),
    (
        "\"normal_force_n\":0.6,",
        "",
        "normal_force_n: is missing in \"begin\"; write \"normal_force_n\":0.5; or depth_m",
    ),
    ("0.6", "\"0.6\"", "normal_force_n: \"0.6\" is refused; must be a number"),
    ("normal_force_n", "force", "force: unknown key of \"begin\"; write normal_force_n"),
    ("normal_force_n", "normal_froce_n", "normal_froce_n: unknown key of \"begin\"; write normal_force_n"),
    ("\"closing_m_s\":0.05", "\"uv\":[0,0]", "uv: is written twice at column "),
    ("0.05}", "0.05,}", "trailing comma at column "),
];

const IMPACT_SLIPS: [(&str, &str, &str); 8] = [
    ("\"body\":\"tile\",", "", "body: is missing in \"impact\"; write \"body\":\"NAME\""),
    ("\"speed_m_s\":0.8,", "", "speed_m_s: is missing in \"impact\"; write \"speed_m_s\":1.0"),
    ("\"mass_kg\":0.01,", "", "mass_kg: is missing in \"impact\"; write \"mass_kg\":0.05"),
    ("\"radius_m\":0.005,", "", "radius_m: is missing in \"impact\"; write \"radius_m\":0.01"),
    (",\"striker\":\"steel\"", "", "striker: is missing in \"impact\"; write \"striker\":\"steel\""),
    ("\"steel\"", "\"stele\"", "striker: \"stele\" is refused; write \"steel\"; must be one of: "),
    (
        "\"steel\"",
        "{\"young_pa\":1e9}",
        "striker: {\"young_pa\":1000000000.0} is refused; must hold the constants",
    ),
    ("\"mass_kg\"", "\"mass\"", "mass: unknown key of \"impact\"; write mass_kg"),
];

#[test]
fn a_slip_is_reported_with_line_key_cause_and_remedy() {
    let lines: Vec<&str> = LOG.lines().collect();
    let of_begin = SLIPS.iter().map(|slip| (lines[0], slip));
    let of_impact = IMPACT_SLIPS.iter().map(|slip| (lines[2], slip));
    for (line, (from, to, words)) in of_begin.chain(of_impact) {
        let slipped = line.replacen(from, to, 1);
        assert_ne!(slipped, line, "{from}");
        // Behind a line that only says the version, and an empty one.
        let message =
            ContactLog::parse(&format!("{{\"version\":1}}\n\n{slipped}\n"), "log").unwrap_err().to_string();
        assert!(message.starts_with(&format!("log:3: {words}")), "{message}\nis not\n{words}");
        assert_eq!(message.lines().count(), 1);
    }
}

#[test]
fn an_unknown_name_or_channel_is_reported_with_its_line() {
    let text = format!("{{\"version\":1}}\n\n{}", LOG.replace("\"tile\"", "\"tilee\""));
    let log = ContactLog::parse(&text, "log").unwrap();
    let words = log.check_names(&names()).unwrap_err();
    assert!(words.to_string().starts_with("event 3 at t = 0.2 s: body: \"tilee\" is unknown; "), "{words}");
    let line = words.in_text(&text, "log").to_string();
    assert_eq!(line, "log:5: body: \"tilee\" is unknown; write \"tile\"; must be one of: pen, tile");
    let line = log.check_actuators(0).unwrap_err().in_text(&text, "log").to_string();
    assert!(line.starts_with("log:3: actuator: 0 is not in the scene; must be below 0"), "{line}");
    let unnamed = Names { probes: HashMap::new(), ..names() };
    let probe = LOG.replacen("\"uv\"", "\"probe\":\"pen\",\"uv\"", 1);
    let words = ContactLog::parse(&probe, "log").unwrap().check_names(&unnamed).unwrap_err().to_string();
    assert!(words.ends_with("probe: \"pen\" is unknown; the scene names no probe; leave it out, or give the scene one with that name"), "{words}");
}
