use super::*;

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
    assert_eq!(message, "surface \"tils\" is unknown; must be one of: tiles");
}

#[test]
fn time_running_backwards_is_refused_with_its_line() {
    let backwards = LOG.replace("\"t\":0.2", "\"t\":0.001");
    let message = ContactLog::parse(&backwards, "log").unwrap_err().to_string();
    assert!(message.starts_with("log:3: t = 0.001 s comes after 0.0167 s"), "{message}");
    assert!(ContactLog::parse(r#"{"t":-1.0,"event":"end","contact":1}"#, "log").is_err());
}

#[test]
fn a_key_that_no_event_knows_is_refused_with_its_line_and_the_key_that_was_meant() {
    let told = |text: &str| ContactLog::parse(text, "log").unwrap_err().to_string();
    let line =
        r#"{"t":0.0,"event":"move","contact":1,"uv":[0.1,0.5],"velocity":[0.1,0.0],"normal_force_n":1}"#;
    assert_eq!(told(line), "log:1: velocity: unknown key of \"move\"; write velocity_m_s");
    let message = told(&format!("{LOG}{}", line.replace("velocity", "colour")));
    assert!(
        message.starts_with("log:5: colour: unknown key of \"move\"; accepted here: actuator, "),
        "{message}"
    );
    assert!(message.contains("velocity_m_s") && !message.contains("probe"), "{message}");
    // A forgotten unit is told before the key that is missing for it.
    assert!(
        told(&line.replace("velocity", "gain").replace("force_n", "force")).ends_with("write normal_force_n")
    );
    assert!(told(r#"{"t":0.0,"event":"end","contact":1,"uv":[0,0]}"#).contains("accepted here: contact, "));
}

#[test]
fn every_key_of_the_format_is_accepted_and_those_read_past_are_told() {
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
    assert_eq!((touching.actuator, touching.gain), (Some(Actuator(0)), 1.0));
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
