//! The list of parameters is what the reader of scene files accepts and what `docs/formats.md` says.
//!
//! `ASPERITY_WRITE_DOCS=1 cargo test --release --test parameters` writes the tables of the document anew.

use asperity::files::scene_file::{SceneFile, Source};
use asperity::parameters::{ALL, Changes, Parameter};
use std::fmt::Write;
use std::path::Path;

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/formats.md");
const BEGIN: &str = "<!-- parameters -->\n";
const END: &str = "<!-- end of parameters -->";

/// One table a table of the file.
fn tables() -> String {
    let mut text = String::new();
    let mut table = None;
    for parameter in ALL {
        if table != Some(parameter.table) {
            table = Some(parameter.table);
            let name = match parameter.table {
                "" => "The top of the file".to_owned(),
                "event" => "A line of a contact log".to_owned(),
                name => format!("`{name}`"),
            };
            let separator = if text.is_empty() { "" } else { "\n" };
            write!(
                text,
                "{separator}| {name} | must be | default | new value | what it is |\n|---|---|---|---|---|\n"
            )
            .unwrap();
        }
        let default = match parameter.default {
            None => "–".to_owned(),
            Some(default) if parameter.whole => format!("{default}"),
            Some(default) => format!("{default:?}"),
        };
        let changes = match parameter.changes {
            Changes::Sounding => "sounding",
            Changes::Anew => "anew",
            Changes::Opened => "opened",
            Changes::Event => "event",
        };
        let source =
            if parameter.source.is_empty() { String::new() } else { format!(" ({})", parameter.source) };
        let Parameter { key, range, meaning, .. } = parameter;
        writeln!(text, "| `{key}` | {} | {default} | {changes} | {meaning}{source} |", range.words).unwrap();
    }
    text
}

#[test]
fn the_document_has_the_tables_of_the_list() {
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let (front, rest) = document.split_once(BEGIN).expect("where the tables begin");
    let (written, back) = rest.split_once(END).expect("where they end");
    if std::env::var_os("ASPERITY_WRITE_DOCS").is_some() {
        std::fs::write(DOCUMENT, format!("{front}{BEGIN}{}{END}{back}", tables())).unwrap();
        return;
    }
    assert_eq!(written, tables(), "ASPERITY_WRITE_DOCS=1 writes them anew");
}

#[test]
fn every_parameter_is_named_once_with_its_unit_and_a_default_within_its_range() {
    for (index, parameter) in ALL.iter().enumerate() {
        let Parameter { table, key, unit, range, default, .. } = parameter;
        let again = ALL[..index].iter().any(|before| (before.table, before.key) == (*table, *key));
        assert!(!again, "{table} {key} twice");
        assert!(default.is_none_or(|default| range.holds(default)), "{table} {key}: {default:?}");
        assert!(!parameter.meaning.is_empty());
        if !unit.is_empty() && !unit.starts_with("cells per") {
            assert!(
                range.words.contains(unit) || range.words.contains("surface"),
                "{table} {key}: {}",
                range.words
            );
        }
        assert_eq!(asperity::parameters::find(table, key), Some(*parameter));
    }
}

const SURFACE: &str = "[[surface]]\nname = \"s\"\n";

/// A scene file that writes one key with a value; none for a line of a contact log.
fn scene(parameter: &Parameter, value: &str) -> Option<String> {
    let written = format!("{} = {value}", parameter.key);
    let size = "width_m = 1.0\nheight_m = 1.0\n";
    let in_surface = |line: String| format!("{SURFACE}{size}{line}\n");
    Some(match parameter.table {
        "" => written,
        "body" => {
            let other = if parameter.key == "size_m" { "stock = \"bar\"" } else { "" };
            format!("[[body]]\nname = \"b\"\n{written}\n{other}")
        }
        "material" => {
            let others = [("young_pa", "1e9"), ("poisson", "0.3"), ("density_kg_m3", "1e3")];
            let others = others.into_iter().filter(|(key, _)| *key != parameter.key);
            let others: String = others.map(|(key, value)| format!(", {key} = {value}")).collect();
            format!("[[body]]\nname = \"b\"\nmaterial = {{ {written}{others} }}")
        }
        "surface" => match parameter.key {
            "width_m" => format!("{SURFACE}height_m = 1.0\n{written}"),
            "height_m" => format!("{SURFACE}width_m = 1.0\n{written}"),
            _ => in_surface(written),
        },
        "probe" | "audio" | "actuator" => {
            let brackets = if parameter.table == "actuator" { ("[[", "]]") } else { ("[", "]") };
            format!("{}{}{}\n{written}", brackets.0, parameter.table, brackets.1)
        }
        "sand" => in_surface(format!("sand = {{ {written} }}")),
        "sand.layers" => {
            let other = if parameter.key == "from_m" { "hardness = 1.0" } else { "from_m = 0.01" };
            in_surface(format!("sand = {{ layers = [{{ {written}, {other} }}] }}"))
        }
        "sand.tool" => {
            let other = if parameter.key == "width_m" { "relief_m = 0.01" } else { "width_m = 0.01" };
            in_surface(format!("sand = {{ tool = {{ map = \"t.png\", {written}, {other} }} }}"))
        }
        "solid" => in_surface(format!("solid = {{ preset = \"wood\", {written} }}")),
        "brownian" => {
            let other = if parameter.key == "hurst" { "rms_m = 1e-4" } else { "hurst = 0.5" };
            in_surface(format!("brownian = {{ {written}, {other} }}"))
        }
        "crossfade" => in_surface(format!("crossfade = {{ from = {{}}, to = {{}}, {written} }}")),
        "event" => return None,
        other => panic!("no scene for {other}"),
    })
}

#[test]
fn the_reader_takes_both_ends_of_every_range_and_refuses_what_is_beyond_in_its_words() {
    let mut tried = 0;
    for parameter in ALL {
        let number = |x: f64| match () {
            () if x.is_nan() => "nan".to_owned(),
            () if parameter.whole => format!("{}", x as i64),
            () => format!("{x:e}"),
        };
        let read = |value: f64| {
            let text = scene(parameter, &number(value))?;
            Some(SceneFile::parse(&text, Path::new("scene.toml")).map_err(|error| error.to_string()))
        };
        let range = parameter.range;
        let low = if range.above { range.low.abs().max(1e-9) * 1.0001 } else { range.low };
        for inside in [low, range.high] {
            let Some(outcome) = read(inside) else { continue };
            assert!(outcome.is_ok(), "{} {}: {outcome:?}", parameter.table, parameter.key);
            tried += 1;
        }
        let step = if parameter.whole { 1.0 } else { 1e-3 * (range.high - range.low) };
        for beyond in [range.low - step, range.high + step, if range.above { range.low } else { f64::NAN }] {
            let value = if beyond.is_nan() && parameter.whole { range.low - step } else { beyond };
            let Some(outcome) = read(value) else { continue };
            let refusal = outcome.expect_err(parameter.key);
            let words = if parameter.whole {
                "must be a whole number from".to_owned()
            } else {
                range.words.to_owned()
            };
            assert!(refusal.contains(parameter.key) && refusal.contains(&words), "{refusal}\nlacks {words}");
            tried += 1;
        }
    }
    assert!(tried > 200, "{tried}");
}

#[test]
fn what_is_not_written_is_as_the_list_says() {
    let text = format!("{SURFACE}width_m = 1.0\nheight_m = 1.0\nsand = {{}}\n");
    let file = SceneFile::parse(&text, Path::new("scene.toml")).unwrap();
    let Source::Sand(sand) = &file.surfaces[0].source else { panic!("not sand") };
    let (law, design) = (&sand.design.law, &sand.design);
    let asperity::texture::sand::Tool::Sphere { radius_m } = design.tool else { panic!("not a sphere") };
    let config = asperity::Config::default();
    let actuator = file.actuators[0].settings;
    let mut read = vec![
        ("", "sample_rate_hz", config.sample_rate_hz),
        ("", "tail_s", file.tail_s),
        ("surface", "strike_position", file.surfaces[0].strike_position as f64),
        ("actuator", "highpass_hz", actuator.highpass_hz),
        ("sand", "cells", design.cells as f64),
        ("sand", "depth_m", design.depth_m),
        ("sand", "talus_deg", design.talus_deg),
        ("sand", "stiffness_n", law.stiffness_n),
        ("sand", "exponent_per_m", law.exponent_per_m),
        ("sand", "drag_s_per_m", law.drag_s_per_m),
        ("sand", "wetness", law.wetness),
        ("sand", "grain_m", law.grain_m),
        ("sand", "cap_n", law.cap_n),
        ("sand", "tool_radius_m", radius_m),
    ];
    let probe = serde_json::to_value(file.probe).unwrap();
    let probe = probe.as_object().unwrap();
    read.extend(probe.iter().map(|(key, value)| ("probe", key.as_str(), value.as_f64().unwrap())));
    for (table, key, value) in &read {
        let parameter =
            asperity::parameters::find(table, key).unwrap_or_else(|| panic!("{table} {key} is not listed"));
        assert_eq!(parameter.default, Some(*value), "{table} {key}");
    }
    // Factors that leave things as they are, and what an event may leave out.
    let listed =
        ALL.iter().filter(|parameter| parameter.default.is_some() && parameter.table != "event").count();
    assert_eq!(listed, read.len() + ["residual", "scale", "compliance_m_n", "flow_m_s"].len());
}
