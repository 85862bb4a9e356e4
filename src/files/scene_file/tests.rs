use super::*;
use crate::model::excitation::Excitation;
use crate::model::material::Material;
use asperity_surface::force_rendering::Rendering;
use asperity_surface::picture::Channel;
use asperity_surface::sand::Layer;
use asperity_surface::solid_materials::SolidMaterial;

#[path = "../../../tests/fuzz/mutation.rs"]
mod mutation;

fn parse(text: &str) -> Result<SceneFile, String> {
    SceneFile::parse(text, Path::new("dir/scene.toml")).map_err(|error| error.to_string())
}

fn refusal(text: &str) -> String {
    parse(text).unwrap_err()
}

const SURFACE: &str = "[[surface]]\nname = \"tiles\"\nwidth_m = 0.14\nheight_m = 0.14\n";

#[test]
fn the_scene_of_the_interface_is_read_as_written() {
    let scene = parse(
        r#"
sample_rate_hz = 44100
seed = 1
contacts = "stroke.jsonl"
tail_s = 1.0
[[body]]
name = "tile"
modes = "tile.modes.json"
material = "ceramic"
[[surface]]
name = "tiles"
body = "tile"
displacement = "tiles_disp.png"
roughness = "tiles_rough.png"
width_m = 0.14
height_m = 0.14
relief_m = 0.004
micro_relief_m = 2e-6
wrap = "repeat"
excitation = "both"
[probe]
preset = "fingertip"
[[actuator]]
output = "displacement"
full_scale = 1e-4
highpass_hz = 10.0
equalise = "none"
[audio]
gain = 1.0
limit = false
"#,
    )
    .unwrap();
    assert_eq!(scene.sample_rate_hz, Some(44_100.0));
    assert_eq!(scene.contacts.as_deref(), Some(Path::new("dir/stroke.jsonl")));
    assert_eq!(scene.bodies[0].material, Some(Material::CERAMIC));
    let surface = &scene.surfaces[0];
    assert_eq!((surface.width_m, surface.micro_relief_m), (0.14, Some(2e-6)));
    assert!(matches!(&surface.source, Source::Map { image, relief_m, invert: false }
        if image.path == Path::new("dir/tiles_disp.png") && *relief_m == 0.004));
    assert_eq!(scene.actuators.len(), 1);
    assert_eq!((scene.actuators[0].full_scale, scene.actuators[0].settings.highpass_hz), (Some(1e-4), 10.0));
    assert_eq!(surface.excitation, Excitation::BOTH);
}

#[test]
fn a_surface_may_lie_on_another_strike_position_of_its_body() {
    let position =
        |line: &str| parse(&format!("{SURFACE}{line}")).map(|scene| scene.surfaces[0].strike_position);
    assert_eq!(position(""), Ok(0));
    assert_eq!(position("strike_position = 3"), Ok(3));
    assert!(position("strike_position = 16").unwrap_err().contains("strike_position"));
}

#[test]
fn every_source_of_the_interface_is_read() {
    let source = |line: &str| parse(&format!("{SURFACE}{line}")).unwrap().surfaces[0].source.clone();
    assert_eq!(source(""), Source::Flat);
    let gravel = Box::new(SolidMaterial::Gravel.parameters());
    assert_eq!(source("solid = \"gravel\""), Source::Solid { parameters: gravel, seed: None });
    let flowing = source("solid = { preset = \"gravel\", flow_m_s = 0.1 }");
    assert_eq!(source("solid = \"gravel\"\nflow_m_s = 0.1"), flowing);
    assert!(matches!(
        source("brownian = { hurst = 0.5, rms_m = 1e-4 }"),
        Source::Brownian(Brownian { hurst: 0.5, graph: false, force: None, .. })
    ));
    let lattice = "relief_m = 0.001\nlattice = { cell = \"cell.png\", t1_m = [0.01, 0.0], t2_m = [0, 0.01] }";
    assert!(matches!(source(lattice), Source::Lattice(lattice) if lattice.t2_m == [0.0, 0.01]));
    let sand = "sand = { cells = 512, depth_m = 0.05, talus_deg = 30.0, stiffness_n = 1000.0, \
                exponent_per_m = 1.0, drag_s_per_m = 20.0, tool_radius_m = 0.005 }";
    let Source::Sand(written) = source(sand) else { panic!("not sand") };
    let Source::Sand(default) = source("sand = {}") else { panic!("not sand") };
    assert_eq!(written, default);
}

#[test]
fn sources_are_put_together_from_tables_like_a_surfaces_own() {
    let source = |line: &str| parse(&format!("{SURFACE}{line}")).unwrap().surfaces[0].source.clone();
    let Source::Sum(parts) = source(
        "sum = [{ solid = \"sand\", scale = 0.5 }, { displacement = \"d.png\", relief_m = 1e-3 }, {}]",
    ) else {
        panic!("not a sum")
    };
    assert!(matches!(&parts[0], Source::Scale(solid, 0.5) if matches!(**solid, Source::Solid { .. })));
    assert!(matches!(&parts[1], Source::Map { image, .. } if image.path == Path::new("dir/d.png")));
    assert_eq!(parts[2], Source::Flat);
    let Source::Scale(mask, -1.0) = source(
        "scale = -1.0\nmask = { image = \"m.png\", channel = \"g\", inside = { solid = \"wood\" }, \
         outside = { brownian = { hurst = 0.2, rms_m = 1e-5, graph = true, force = \"lateral\" } } }",
    ) else {
        panic!("not scaled")
    };
    let Source::Mask { image, outside, .. } = *mask else { panic!("not a mask") };
    assert_eq!((image.path.as_path(), image.channel), (Path::new("dir/m.png"), Channel::G));
    let graph = Brownian { hurst: 0.2, rms_m: 1e-5, seed: None, cells: None, graph: true, force: None };
    assert_eq!(*outside, Source::Brownian(Brownian { force: Some(Rendering::Lateral), ..graph }));
    let fade = "crossfade = { from = { solid = { preset = \"wood\", octaves = 3 } }, to = {}, at_s = 0.25 }";
    let Source::Crossfade { from, at_s: 0.25, .. } = source(fade) else { panic!("not a crossfade") };
    assert!(matches!(*from, Source::Solid { parameters, .. } if parameters.modules[0].octaves == 3));
    let Source::Sand(sand) = source(
        "sand = { layers = [{ from_m = 0.002, hardness = 4 }, { from_m = 0.01, hardness = 0.5 }], \
         buried = [{ u_m = 0.05, v_m = 0.03, top_m = 0.002, half_u_m = 0.008, half_v_m = 0.004, height_m = 0.003, hardness = 30 }], \
         tool = { map = \"bar.png\", width_m = 0.02, relief_m = 0.01 } }",
    ) else {
        panic!("not sand")
    };
    let layers = [(0.002, 4.0), (0.01, 0.5)].map(|(from_m, hardness)| Some(Layer { from_m, hardness }));
    assert_eq!(sand.design.law.layers, [layers[0], layers[1], None, None]);
    let stone = sand.design.law.buried[0].unwrap();
    assert_eq!((stone.at_m, stone.top_m, stone.half_m), ([0.05, 0.03], 0.002, [0.008, 0.004]));
    assert_eq!((stone.height_m, stone.hardness, sand.design.law.buried[1]), (0.003, 30.0, None));
    assert_eq!(sand.tool.map(|tool| tool.width_m), Some(0.02));
}

#[test]
fn parts_of_a_source_are_refused_by_their_own_place() {
    for (line, parts) in [
        ("sum = [{ solid = 3 }]", &["sum 1: solid: 3 is no material"][..]),
        ("sum = [{ solid = \"sand\", width_m = 1.0 }]", &["sum 1: width_m: unknown key", "crossfade"]),
        ("sum = []", &["sum: is empty"]),
        ("mask = { image = \"m.png\", inside = {} }", &["mask: outside: is missing"]),
        ("solid = \"sand\"\nsand = {}", &["sand: stands beside solid"]),
        ("crossfade = { from = {}, to = {} }", &["crossfade: at_s: is missing"]),
        ("brownian = { hurst = 0.5, rms_m = 1e-4, force = \"up\" }", &["brownian: force", "lateral"]),
        ("sand = { layers = [{ from_m = 0.0, hardness = 1 }] }", &["layers 1: from_m", "above 0"]),
        (
            "sand = { buried = [{ u_m = 0.1, v_m = 0.1, top_m = 0.0, half_u_m = 0.0 }] }",
            &["buried 1: half_u_m", "1e-4"],
        ),
        ("sand = { tool_radius_m = 0.01, tool = { map = \"a.png\" } }", &["tool: stands beside"]),
    ] {
        let refusal = refusal(&format!("{SURFACE}{line}"));
        for part in parts {
            assert!(refusal.contains(part), "{refusal}\nlacks {part}");
        }
    }
}

#[test]
fn roughness_is_a_number_a_map_or_gloss() {
    let roughness = |line: &str| parse(&format!("{SURFACE}{line}")).unwrap().surfaces[0].roughness.clone();
    assert_eq!(roughness("roughness = 0.25"), RoughnessEntry::Number(Some(0.25)));
    assert_eq!(roughness("gloss = 1"), RoughnessEntry::Number(Some(0.0)));
    assert!(matches!(roughness("gloss = \"g.png\""), RoughnessEntry::Map { gloss: true, .. }));
    assert_eq!(roughness(""), RoughnessEntry::Number(None));
}

#[test]
fn an_unknown_key_is_refused_with_its_place_and_the_accepted_ones() {
    assert_eq!(
        refusal("[audio]\ngian = 2.0"),
        "dir/scene.toml: audio: gian: unknown key; write gain; accepted here: gain, limit, name, pascals_at_full_scale"
    );
    let line = refusal(&format!("{SURFACE}colour = 1"));
    assert!(line.starts_with("dir/scene.toml: surface 1 \"tiles\": colour: unknown key;"), "{line}");
    // A needed key with another unit, or with none, is no missing key.
    let surface = "[[surface]]\nname = \"s\"\nheight_m = 0.1\n";
    for key in ["width_cm", "width"] {
        let line = refusal(&format!("{surface}{key} = 14"));
        assert!(line.ends_with(&format!(": {key}: unknown key; write width_m = a number")), "{line}");
    }
    assert!(refusal(surface).ends_with(": width_m: is missing; write width_m = a number"));
    assert!(line.contains("displacement") && line.contains("width_m") && line.contains("roughness_channel"));
}

#[test]
fn numbers_out_of_range_are_named_with_what_would_be_right() {
    for (text, part) in [
        ("tail_s = nan", "tail_s: nan is refused; must be 0 to 600 s"),
        ("tail_s = \"long\"", "tail_s: \"long\" is not a number; write a number"),
        ("sample_rate_hz = 1e300", "sample_rate_hz: 1"),
        ("seed = -1", "seed: -1 is refused; must be a whole number from 0 to"),
        ("[probe]\npad_mass_kg = inf", "probe: pad_mass_kg: inf is refused"),
        ("[[actuator]]\nfull_scale = 0.0", "actuator 1: full_scale: 0.0 is refused"),
        (
            "[[actuator]]\noutput = \"smell\"",
            "\"smell\" is unknown; must be \"displacement\", \"acceleration\", \"tangential\" or \"force\"",
        ),
        ("[[body]]\nname = \"b\"\nmaterial = 3", "body 1 \"b\": material: 3 is not a material"),
        (
            "[[body]]\nname = \"b\"\nmaterial = { young_pa = 1e9 }",
            "body 1 \"b\": material: poisson: is missing",
        ),
        ("[[surface]]\nwidth_m = 1", "surface 1: name: is missing"),
        ("surface = 3", "surface: 3 is not a list of tables"),
    ] {
        let line = refusal(text);
        assert!(line.contains(part), "{line}\nlacks\n{part}");
        assert_eq!(line.lines().count(), 1);
    }
}

#[test]
fn surfaces_that_contradict_themselves_are_refused() {
    for (lines, part) in [
        ("solid = \"gravel\"\nsand = {}", "sand: stands beside solid; write one of"),
        ("roughness = 0.5\ngloss = 0.5", "gloss: stands beside roughness"),
        ("roughness = 2", "roughness: 2 is refused; must be 0 to 1, or name an image"),
        ("displacement = \"d.png\"", "relief_m: is missing"),
        ("relief_m = 0.1\nlattice = { cell = \"c.png\", t1_m = [1, 1], t2_m = [2, 2] }", "spans no cell"),
        ("body = \"ghost\"", "body: \"ghost\" is unknown; bodies of this scene: nothing"),
    ] {
        let line = refusal(&format!("{SURFACE}{lines}"));
        assert!(line.contains(part), "{line}\nlacks\n{part}");
    }
    assert!(refusal(&format!("{SURFACE}{SURFACE}")).contains("surface 2 \"tiles\": name: is used twice"));
}

#[test]
fn broken_toml_names_its_line() {
    assert!(refusal("seed = 1\ntail_s = = 3").contains("line 2:"), "{}", refusal("seed = 1\ntail_s = = 3"));
    assert!(refusal("\u{0}").starts_with("dir/scene.toml: line 1:"));
}

/// The scene target of the fuzzing: the engine's other files are in the engine's `tests/fuzz.rs`.
#[test]
fn any_scene_file_is_read_or_refused_by_name() {
    let scene = r#"
sample_rate_hz = 44100
seed = 1
contacts = "stroke.jsonl"
tail_s = 1.0
[[body]]
name = "tile"
modes = "tile.modes.json"
material = { young_pa = 7e10, poisson = 0.24, density_kg_m3 = 2400.0 }
[[surface]]
name = "tiles"
body = "tile"
solid = "gravel"
roughness = 0.5
width_m = 0.14
height_m = 0.14
micro_relief_m = 2e-6
excitation = "both"
[[surface]]
name = "dune"
sand = { cells = 512, depth_m = 0.05, talus_deg = 30.0 }
width_m = 1.0
height_m = 1.0
[probe]
pad_mass_kg = 1e-4
contact_stiffness_n_m = 5e4
[[actuator]]
output = "displacement"
full_scale = 1e-4
[audio]
gain = 1.0
limit = false
"#;
    let runs = mutation::drive(&[scene.as_bytes().to_vec()], |data| {
        if let Ok(text) = std::str::from_utf8(data)
            && let Err(refusal) = parse(text)
        {
            assert!(refusal.len() > 10 && !refusal.contains('\n'), "{refusal:?}");
        }
    });
    assert!(runs > 50, "{runs}");
}

#[test]
fn excitation_is_a_word_or_a_list_of_exciters() {
    let read = |words: &str| {
        let surface = "[[surface]]\nname = \"s\"\nwidth_m = 0.1\nheight_m = 0.1\nroughness = 0.5\n";
        let text = format!("{surface}excitation = {words}\n");
        let file = SceneFile::parse(&text, Path::new("scene.toml")).map_err(|error| error.to_string())?;
        Ok::<_, String>(file.surfaces[0].excitation)
    };
    assert_eq!(read("\"collisions\""), Ok(Excitation::COLLISIONS));
    assert_eq!(read("[\"force\", \"collisions\"]"), Ok(Excitation::BOTH));
    assert_eq!(read("[]"), Ok(Excitation::NONE));
    for wrong in ["\"magic\"", "[\"magic\"]", "3", "[3]"] {
        let error = read(wrong).unwrap_err();
        assert!(
            error.contains("surface 1 \"s\": excitation") && error.contains("collisions, force"),
            "{error}"
        );
    }
}

#[test]
fn a_tip_starts_from_its_preset_and_a_part_is_refused() {
    let read = |keys: &str| SceneFile::parse(&format!("[probe]\n{keys}"), Path::new("s.toml"));
    let probe = |keys: &str| read(keys).unwrap().probe;
    let steel = probe("preset = \"stylus\"\ntip_material = \"steel\"\nasperity_radius_m = 2e-5");
    let tip = steel.tip.unwrap();
    assert_eq!((tip.mass_kg, tip.material.young_pa, tip.asperity_radius_m), (5e-4, 200e9, 2e-5));
    assert_eq!(probe("preset = \"stylus\"\ntip_mass_kg = 0.0").tip, None);
    let own = probe("tip_mass_kg = 1e-3\ntip_radius_m = 1e-3").tip.unwrap();
    assert_eq!((own.mass_kg, own.contact_radius_m, own.damping_n_s_m), (1e-3, 1e-3, 15.0));
    let crate_of_wood = probe("preset = \"rigid\"\nface_m = 0.4");
    assert_eq!((crate_of_wood.face_m, crate_of_wood.asperities), (0.4, 64.0));
    for (keys, message) in [
        ("tip_damping_n_s_m = 3.0", "probe: tip_damping_n_s_m: stands without tip_mass_kg"),
        ("tip_mass_kg = 1e-3\ntip_material = \"cheese\"", "probe: tip_material: \"cheese\" is unknown"),
        ("face_m = 11.0", "probe: face_m: 11.0 is refused"),
    ] {
        let error = read(keys).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}
