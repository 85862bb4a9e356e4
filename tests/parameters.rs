//! The list of parameters is what the reader of scene files accepts and what
//! `docs/formats/scene.md` says.
//!
//! `ASPERITY_WRITE_DOCS=1 cargo test --release parameters::` writes the tables of the document
//! anew.

use asperity::files::scene_file::{SceneFile, Source};
use asperity::parameters::{ALL, Changes, Parameter};
use std::fmt::Write;
use std::path::Path;

const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/formats/scene.md");
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
fn every_parameter_is_named_once_with_unit_and_default() {
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
    let written = match (parameter.key, parameter.components) {
        (key, 1) => format!("{key} = {value}"),
        (key @ "v_axis", _) => format!("{key} = [0, {value}, 0]"),
        (key @ "direction", _) => format!("{key} = [{value}, 0, 0]"),
        (key @ "u_axis", _) => format!("{key} = [{value}, 0, 0]"),
        (key, components) => format!("{key} = [{}]", vec![value; components].join(", ")),
    };
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
            "mu_static" | "slip_speed_m_s" => in_surface(format!("excitation = [\"friction\"]\n{written}")),
            "mu_kinetic" => in_surface(format!("excitation = \"friction\"\nmu_static = 10.0\n{written}")),
            _ => in_surface(written),
        },
        "probe" | "audio" | "actuator" => {
            let brackets = if parameter.table == "actuator" { ("[[", "]]") } else { ("[", "]") };
            let of_a_tip = parameter.key.starts_with("tip_") || parameter.key == "asperity_radius_m";
            let other = if of_a_tip { "preset = \"stylus\"\n" } else { "" };
            format!("{}{}{}\n{other}{written}", brackets.0, parameter.table, brackets.1)
        }
        "pickup" => format!("[[body]]\nname = \"b\"\n[[pickup]]\nname = \"p\"\nbody = \"b\"\n{written}\n"),
        "sand" => in_surface(format!("sand = {{ {written} }}")),
        "sand.layers" => {
            let other = if parameter.key == "from_m" { "hardness = 1.0" } else { "from_m = 0.01" };
            in_surface(format!("sand = {{ layers = [{{ {written}, {other} }}] }}"))
        }
        "sand.buried" => {
            let keys = ["u_m", "v_m", "top_m", "half_u_m", "half_v_m", "height_m", "hardness"];
            let others = keys.into_iter().filter(|key| *key != parameter.key);
            let others: String = others.map(|key| format!(", {key} = 0.01")).collect();
            in_surface(format!("sand = {{ buried = [{{ {written}{others} }}] }}"))
        }
        "sand.tool" => {
            let other = if parameter.key == "width_m" { "relief_m = 0.01" } else { "width_m = 0.01" };
            in_surface(format!("sand = {{ tool = {{ map = \"t.png\", {written}, {other} }} }}"))
        }
        "solid" => {
            let of_grating = match parameter.key {
                "pitch_m" => "\"grating\", kind = \"sine\", amplitude_m = 1e-5",
                "duty" => "\"grating\", kind = \"ridges\", amplitude_m = 1e-5, pitch_m = 1e-3",
                _ => "\"wood\"",
            };
            in_surface(format!("solid = {{ preset = {of_grating}, {written} }}"))
        }
        "brownian" => {
            let others =
                [("hurst", "0.5"), ("rms_m", "1e-4")].into_iter().filter(|(key, _)| *key != parameter.key);
            let others: String = others.map(|(key, value)| format!(", {key} = {value}")).collect();
            in_surface(format!("brownian = {{ {written}{others} }}"))
        }
        "lattice" => {
            let other = if parameter.key == "t1_m" { "t2_m = [0.1, 0]" } else { "t1_m = [0.1, 0]" };
            in_surface(format!("relief_m = 1e-3\nlattice = {{ cell = \"c.png\", {written}, {other} }}"))
        }
        "surface.frame" => in_surface(format!("frame = {{ {written} }}")),
        "crossfade" => in_surface(format!("crossfade = {{ from = {{}}, to = {{}}, {written} }}")),
        "event" => return None,
        other => panic!("no scene for {other}"),
    })
}

#[test]
fn the_reader_takes_both_ends_of_every_range_and_nothing_beyond() {
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
            // Of a direction the length counts.
            let directs = parameter.key.ends_with("_axis") || parameter.key == "direction";
            let value = if directs { value.max(0.0) } else { value };
            // A seed may be as great as a whole number of a file.
            let Some(outcome) = read(value).filter(|_| parameter.key != "seed" || value < 0.0) else {
                continue;
            };
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
    let asperity::surface::sand::Tool::Sphere { radius_m } = design.tool else { panic!("not a sphere") };
    let config = asperity::Config::default();
    let actuator = file.actuators[0].settings;
    let text = format!("{SURFACE}width_m = 1.0\nheight_m = 1.0\nexcitation = [\"friction\"]\n");
    let rubbed = SceneFile::parse(&text, Path::new("scene.toml")).unwrap();
    let friction = rubbed.surfaces[0].stick_slip.unwrap();
    let mut read = vec![
        ("", "sample_rate_hz", config.sample_rate_hz),
        ("", "tail_s", file.tail_s),
        ("surface", "strike_position", file.surfaces[0].strike_position as f64),
        ("surface", "mu_static", friction.mu_static),
        ("surface", "mu_kinetic", friction.mu_kinetic),
        ("surface", "slip_speed_m_s", friction.slip_speed_m_s),
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
    let numbers = probe.iter().filter(|(key, _)| *key != "tip");
    read.extend(numbers.map(|(key, value)| ("probe", key.as_str(), value.as_f64().unwrap())));
    for (table, key, value) in &read {
        let parameter =
            asperity::parameters::find(table, key).unwrap_or_else(|| panic!("{table} {key} is not listed"));
        assert_eq!(parameter.default, Some(*value), "{table} {key}");
    }
    // Factors that leave things as they are, and what an event may leave out.
    let listed =
        ALL.iter().filter(|parameter| parameter.default.is_some() && parameter.table != "event").count();
    assert_eq!(
        listed,
        read.len() + ["residual", "least_time_s", "variation", "scale", "compliance_m_n", "flow_m_s"].len()
    );
}

#[test]
fn contradicting_friction_is_refused_by_name() {
    for (lines, message) in [
        ("mu_static = 0.5", "mu_static: stands without friction"),
        ("excitation = [\"force\"]\nslip_speed_m_s = 0.1", "slip_speed_m_s: stands without friction"),
        ("excitation = [\"friction\"]\nmu_static = 0.2\nmu_kinetic = 0.4", "must be at most mu_static, 0.2"),
        ("excitation = [\"bow\"]", "friction"),
    ] {
        let text = format!("{SURFACE}width_m = 1.0\nheight_m = 1.0\n{lines}\n");
        let error = SceneFile::parse(&text, Path::new("scene.toml")).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
    // Less than what slides by default: what is not written follows it.
    let text =
        format!("{SURFACE}width_m = 1.0\nheight_m = 1.0\nexcitation = \"friction\"\nmu_static = 0.1\n");
    let file = SceneFile::parse(&text, Path::new("scene.toml")).unwrap();
    assert_eq!(file.surfaces[0].stick_slip.unwrap().mu_kinetic, 0.1);
}
