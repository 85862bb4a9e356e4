//! `asperity modes` from the outside: a mesh file in, a modes file of version 2 out, and one line
//! for what is refused.

use std::path::Path;
use std::process::{Command, Output};

fn asperity(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_asperity")).current_dir(folder).args(arguments).output().unwrap()
}

/// A bar 0.1 × 0.02 × 0.01 m.
const BAR: &str = "v 0 0 0\nv 0.1 0 0\nv 0.1 0.02 0\nv 0 0.02 0\nv 0 0 0.01\nv 0.1 0 0.01\nv 0.1 0.02 0.01\nv 0 0.02 0.01\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn a_mesh_becomes_a_body_that_can_be_struck_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bar.obj"), BAR).unwrap();
    let arguments = [
        "modes",
        "bar.obj",
        "--material",
        "steel",
        "--max-modes",
        "6",
        "-o",
        "bar.modes.json",
        "--plot",
        "bar.svg",
        "--json",
    ];
    let output = asperity(at, &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["modes"], 6);
    assert!((report["volume_m3"].as_f64().unwrap() / 2e-5 - 1.0).abs() < 1e-3);
    let model = asperity::ModalModel::load(at.join("bar.modes.json")).unwrap();
    let (shapes, unit) = asperity::load_shapes(at.join("bar.modes.json")).unwrap().unwrap();
    assert_eq!(unit, asperity::ShapeUnit::Relative);
    // The first bending mode of a free bar: its shape at the ends is 2/√m out of its plane, less
    // what turning of its sections takes of the energy (t/L = 0.1: about 4 %), and Timoshenko's
    // frequency is a little below Euler–Bernoulli's 1.028 (t/L²) √(E/ρ).
    let steel = asperity::Material::STEEL;
    let euler_hz = 1.028 * 0.01 / 0.01 * (steel.young_pa / steel.density_kg_m3).sqrt();
    let ratio = model.modes[0].frequency_hz / euler_hz;
    assert!((0.96..1.0).contains(&ratio), "{ratio}");
    let mass_kg = report["mass_kg"].as_f64().unwrap();
    let from_corner = |p: &[f64; 3]| p.iter().map(|x| x * x).sum::<f64>();
    let nearest = (0..shapes.points_m.len())
        .min_by(|&a, &b| from_corner(&shapes.points_m[a]).total_cmp(&from_corner(&shapes.points_m[b])));
    let end = nearest.unwrap();
    let at_end = f64::from(shapes.phi_per_sqrt_kg[0][end][2]).abs() * mass_kg.sqrt();
    assert!((0.95..1.0).contains(&(at_end / 2.0)), "{at_end}");
    assert!(std::fs::read_to_string(at.join("bar.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn shapes_beside_the_modes_file_equal_shapes_within_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bar.obj"), BAR).unwrap();
    let made = |more: &[&str]| {
        let all = [&["modes", "bar.obj", "--material", "steel", "--max-modes", "6"], more].concat();
        let output = asperity(at, &all);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    made(&["-o", "within.modes.json"]);
    made(&["-o", "beside.modes.json", "--shapes-beside"]);
    let sidecar = at.join("beside.modes.shapes");
    assert!(std::fs::read(&sidecar).unwrap().starts_with(b"ASPSHAP1"));
    let text = std::fs::read_to_string(at.join("beside.modes.json")).unwrap();
    assert!(text.contains("\"shapes_beside\":\"beside.modes.shapes\"") && !text.contains("phi_per_sqrt_kg"));
    let load = |name: &str| asperity::ModalModel::load(at.join(name)).unwrap();
    assert!(load("beside.modes.json") == load("within.modes.json"));
    made(&["-o", "packed.modes.json", "--shapes-glb"]);
    assert!(std::fs::read(at.join("packed.modes.glb")).unwrap().starts_with(b"glTF"));
    // Places are single precision there, and nothing else is.
    let (packed, mut wanted) = (load("packed.modes.json"), load("within.modes.json"));
    let mut shapes = wanted.shapes.as_deref().unwrap().clone();
    shapes.points_m.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
    wanted.shapes = Some(shapes.into());
    assert!(packed == wanted);
    let render = |name: &str| {
        let scene = format!(
            "contacts = \"hits.jsonl\"\n[[body]]\nname = \"bar\"\nmodes = \"{name}.modes.json\"\n[[actuator]]\noutput = \"displacement\"\n"
        );
        std::fs::write(at.join(format!("{name}.toml")), scene).unwrap();
        let output = asperity(at, &["render", &format!("{name}.toml"), "-o", name]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(at.join(format!("{name}.audio.wav"))).unwrap()
    };
    let hit = |t: f64, x: f64| {
        format!(
            "{{\"t\":{t},\"event\":\"impact\",\"body\":\"bar\",\"speed_m_s\":0.8,\"mass_kg\":0.01,\"radius_m\":0.005,\"striker\":\"steel\",\"at_m\":[{x},0.01,0.01]}}\n"
        )
    };
    std::fs::write(at.join("hits.jsonl"), hit(0.0, 0.002) + &hit(0.4, 0.031)).unwrap();
    assert!(render("beside") == render("within"));
    assert_eq!(render("packed").len(), render("within").len());
    std::fs::remove_file(sidecar).unwrap();
    let output = asperity(at, &["render", "beside.toml", "-o", "again"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!((output.status.code(), message.lines().count()), (Some(1), 1), "{message}");
    assert!(message.contains("shapes_beside") && message.contains("beside.modes.shapes"), "{message}");
    assert!(!at.join("again.audio.wav").exists());
}

#[test]
fn radiated_levels_are_pascals_and_low_bending_modes_are_weak() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bar.obj"), BAR).unwrap();
    for (name, more) in [("dry", None), ("air", Some("--radiation"))] {
        let file = format!("{name}.modes.json");
        let mut arguments = vec!["modes", "bar.obj", "--material", "steel", "--max-modes", "6", "-o", &file];
        arguments.extend(more);
        let output = asperity(at, &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let load = |name: &str| asperity::ModalModel::load(at.join(name)).unwrap();
    let (dry, air) = (load("dry.modes.json"), load("air.modes.json"));
    assert_eq!((dry.unit, air.unit), (asperity::ShapeUnit::Relative, asperity::ShapeUnit::PascalsAtOneMetre));
    let (dry_shapes, air_shapes) = (dry.shapes.unwrap(), air.shapes.unwrap());
    for m in 0..6 {
        assert!(air.modes[m].decay_per_s >= dry.modes[m].decay_per_s);
        // A surface that moved as one with the mode's rms velocity at full efficiency: ρ c √(S /
        // 4π), S = 6.4e-3 m² here.
        let most = 1.2 * 343.0 * (6.4e-3_f64 / (4.0 * std::f64::consts::PI)).sqrt() * dry_shapes.gains[m];
        assert!(
            air_shapes.gains[m] > 0.0 && air_shapes.gains[m] < 1.5 * most,
            "mode {m}: {} of {most}",
            air_shapes.gains[m]
        );
    }
}

#[test]
fn damping_is_learned_from_a_recorded_body() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bar.obj"), BAR).unwrap();
    let modes: Vec<String> = (1..20)
        .map(|i| 700.0 * f64::from(i))
        .map(|hz| {
            let decay = std::f64::consts::PI * 2e-3 * hz;
            format!(r#"{{"frequency_hz":{hz},"decay_per_s":{decay},"amplitude":1}}"#)
        })
        .collect();
    let text = format!(r#"{{"format":"asperity.modes","version":1,"modes":[{}]}}"#, modes.join(","));
    std::fs::write(at.join("hit.modes.json"), text).unwrap();
    let arguments = [
        "modes",
        "bar.obj",
        "--material",
        "glass",
        "--max-modes",
        "4",
        "--damping-from",
        "hit.modes.json",
        "-o",
        "o.modes.json",
    ];
    let output = asperity(at, &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for mode in asperity::ModalModel::load(at.join("o.modes.json")).unwrap().modes {
        let expected = std::f64::consts::PI * 2e-3 * mode.frequency_hz;
        assert!((mode.decay_per_s / expected - 1.0).abs() < 0.05, "{mode:?}");
    }
}

#[test]
fn what_is_no_body_is_one_line_and_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bar.obj"), BAR).unwrap();
    std::fs::write(at.join("sheet.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(at.join("empty.stl"), "").unwrap();
    std::fs::write(at.join("cut.msh"), "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0").unwrap();
    for (arguments, message) in [
        (vec!["sheet.obj", "--material", "steel"], "--thickness"),
        (vec!["empty.stl", "--material", "steel"], "empty"),
        (vec!["cut.msh", "--material", "steel"], "cut short"),
        (vec!["bar.obj"], "--material"),
        (vec!["bar.obj", "--young-pa", "1e9", "--poisson", "0.3"], "--density-kg-m3"),
        (vec!["bar.obj", "--material", "steel", "--poisson", "0.5"], "poisson"),
        (vec!["bar.obj", "--material", "steel", "--up-to", "1e6"], "--up-to"),
        (vec!["bar.obj", "--material", "steel", "--size", "0"], "--size"),
        (vec!["bar.obj", "--material", "steel", "--unit", "mm", "--max-modes", "6"], "bar.obj: modes[0]"),
        (vec!["bar.step", "--material", "steel"], "bar.step"),
    ] {
        let all: Vec<&str> = ["modes"].into_iter().chain(arguments).chain(["-o", "x.modes.json"]).collect();
        let output = asperity(at, &all);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.starts_with("error: ") && text.lines().count() == 1 && text.contains(message), "{text}");
        assert!(!at.join("x.modes.json").exists());
    }
}

/// Was an unknown key, though a scene may name a mesh.
#[test]
fn a_scene_with_a_mesh_sounds_as_with_its_modes_file() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bar.obj"), BAR).unwrap();
    let blow = r#"{"t":0.0,"event":"impact","body":"b","speed_m_s":0.5,"mass_kg":0.01,"radius_m":0.005,"striker":"steel","at_m":[0.1,0.01,0.01]}"#;
    std::fs::write(at.join("blow.jsonl"), format!("{blow}\n")).unwrap();
    let scene = |name: &str, body: &str| {
        let text = format!(
            "contacts = \"blow.jsonl\"\ntail_s = 0.3\n[[body]]\nname = \"b\"\nmaterial = \"steel\"\n{body}\n[audio]\ngain = 1.0\n"
        );
        std::fs::write(at.join(format!("{name}.toml")), text).unwrap();
        asperity(at, &["render", &format!("{name}.toml"), "-o", name])
    };
    let bytes = |name: &str| std::fs::read(at.join(format!("{name}.audio.wav"))).unwrap();
    for (size, options) in [("", &[][..]), ("size_m = 0.2", &["--size", "0.2"])] {
        let arguments =
            [&["modes", "bar.obj", "--material", "steel", "-o", "bar.modes.json"], options].concat();
        assert!(asperity(at, &arguments).status.success());
        assert!(scene("filed", "modes = \"bar.modes.json\"").status.success());
        let output = scene("solved", &format!("shape = \"bar.obj\"\n{size}"));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(bytes("filed") == bytes("solved"), "{size}");
    }
    std::fs::write(at.join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    for (body, parts) in [
        ("shape = \"flat.obj\"", ["body \"b\": shape", "flat.obj"]),
        ("shape = \"none.obj\"", ["body \"b\": shape", "none.obj"]),
        ("shape = \"bar.obj\"\nmodes = \"bar.modes.json\"", ["shape", "beside modes"]),
        ("shape = \"bar.obj\"\nstock = \"bar\"", ["shape", "beside stock"]),
    ] {
        let output = scene("refused", body);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), message.lines().count()), (Some(1), 1), "{message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
    }
}
