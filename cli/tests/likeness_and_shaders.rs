//! The texture verbs that compare as fingers do, and those that draw a solid elsewhere.

use crate::maps;
use crate::support;
use crate::surfaces;

use asperity_surface::raster::Raster;
use asperity_surface::solid_materials::SolidMaterial;
use asperity_surface::solid_noise::SolidNoise;
use maps::with_maps;
use serde_json::{Value, json};
use support::{Scene, asperity, assert_refused, message};
use surfaces::{fractal, ground, ridges};

fn report(scene: &Scene, arguments: &[&str]) -> Value {
    let all = [&["texture"], arguments, &["--json"]].concat();
    let (status, out, err) = message(&asperity(scene.folder.path(), &all));
    assert_eq!((status, err.as_str()), (0, ""), "{arguments:?}");
    serde_json::from_str(&out).unwrap()
}

/// A folder of two cuts each of three materials, and what is no map.
fn collection() -> Scene {
    let cut = |of: &Raster, x: usize| Raster::from_fn(128, 128, |i, j| of.at(i + x, j));
    let (rough, soil) = (fractal(256, 2.6, 1.0, 9), ground(256));
    let scene = Scene::new();
    std::fs::create_dir(scene.path("maps")).unwrap();
    for (name, of) in [("fractal", &rough), ("ground", &soil)] {
        for (n, x) in [(1, 0), (2, 128)] {
            let map = asperity_surface::image_io::save_gray16(
                scene.path(&format!("maps/{name}-{n}.png")),
                &cut(of, x),
            );
            map.unwrap();
        }
    }
    let path = scene.path("maps/ridges-1.png");
    asperity_surface::image_io::save_gray16(path, &ridges(128)).unwrap();
    scene.write("maps/remarks.txt", "no map");
    scene.write("maps/broken.png", "no picture either");
    scene
}

#[test]
fn a_collection_is_ordered_by_likeness_of_feel() {
    let scene = collection();
    for material in ["fractal", "ground"] {
        let original = format!("maps/{material}-1.png");
        let message = report(&scene, &["rank", &original, "maps", "--strokes", "20"]);
        let ranking = message["ranking"].as_array().unwrap();
        let names: Vec<&str> = ranking.iter().map(|entry| entry["file"].as_str().unwrap()).collect();
        assert_eq!(names.len(), 5, "{message}");
        assert_eq!(names[0], format!("{material}-1.png"));
        assert_eq!(names[1], format!("{material}-2.png"), "{message}");
        let distances: Vec<f64> = ranking.iter().map(|entry| entry["distance"].as_f64().unwrap()).collect();
        assert!(distances[0] == 0.0 && distances.is_sorted() && distances[2] > 2.0, "{distances:?}");
        assert!(message["warnings"][0].as_str().unwrap().contains("broken.png"), "{message}");
    }
    std::fs::create_dir(scene.path("empty")).unwrap();
    for folder in ["empty", "nowhere"] {
        let message = asperity(scene.folder.path(), &["texture", "rank", "maps/ground-1.png", folder]);
        assert_refused(&message, &[folder, "folder of height maps"]);
    }
}

#[test]
fn the_observer_tells_materials_apart_above_peoples_thresholds_only() {
    let scene = with_maps(&[("a.png", fractal(128, 2.6, 1.0, 9)), ("b.png", ground(128))]);
    let compare = |relief: &str, observer: &[&str]| {
        let all =
            [&["compare", "a.png", "b.png", "--strokes", "60", "--relief-m", relief], observer].concat();
        report(&scene, &all)
    };
    let message = compare("0.002", &["--observer"]);
    assert_eq!(message["judge"], "observer");
    assert!(message["originals"]["reference"].as_f64().unwrap() > 0.75, "{message}");
    // A tenth of a micrometre: a machine's business.
    let message = [compare("1e-7", &[]), compare("1e-7", &["--observer"])];
    let [machine, observer] =
        message.each_ref().map(|message| message["originals"]["reference"].as_f64().unwrap());
    assert_eq!(message[0]["judge"], "machine");
    assert!(machine > 0.9 && (observer - 0.5).abs() < 0.13, "{machine} {observer}");
}

#[test]
fn every_solid_is_a_shader_that_is_valid_and_needs_no_uniforms() {
    let scene = Scene::new();
    let solids = [
        "sandpaper",
        "granite",
        "rough-glass",
        "wood",
        "sand",
        "gravel",
        "pebbles",
        "ridged",
        "billow",
        "turbulence",
        "voronoi",
        "grating",
    ];
    for name in solids {
        for kind in if name == "grating" { &["sine", "ridges", "dots"][..] } else { &[""] } {
            let mut arguments = vec!["solid", name, "--shader", "wgsl"];
            if !kind.is_empty() {
                arguments.extend(["--kind", kind]);
            }
            let message = report(&scene, &arguments);
            let (name, text) = (message["name"].as_str().unwrap(), message["shader"].as_str().unwrap());
            let module = naga::front::wgsl::parse_str(text)
                .unwrap_or_else(|error| panic!("{name}: {}\n{text}", error.emit_to_string(text)));
            use naga::valid::{Capabilities, ValidationFlags, Validator};
            Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
            assert!(module.global_variables.is_empty());
            for function in ["height", "picture"] {
                let wanted = format!("{name}_{function}");
                assert!(module.functions.iter().any(|(_, f)| f.name.as_deref() == Some(&wanted)), "{text}");
            }
        }
    }
    let plain = asperity(scene.folder.path(), &["texture", "solid", "gravel", "--shader", "glsl"]);
    let (status, text, _) = message(&plain);
    assert!(
        status == 0 && text.contains("float gravel_height(vec3 at_m) {") && !text.contains('$'),
        "{text}"
    );
    for (arguments, words) in [
        (&["solid", "gravel"][..], &["--output"][..]),
        (&["solid", "gravel", "-o", "a.txt"], &["a.txt", ".png"]),
        (&["solid", "gravel", "--shader", "wgsl", "-o", "a.glsl"], &["a.glsl", ".wgsl"]),
        (&["solid", "gravle", "-o", "a.png"], &["gravle", "voronoi, grating"]),
        (
            &["solid", "gravel", "--duty", "0.5", "-o", "a.png"],
            &["gravel is no grating", "texture solid grating"],
        ),
        (&["solid", "grating", "--duty", "1.5", "-o", "a.png"], &["duty", "0.95"]),
    ] {
        let message = asperity(scene.folder.path(), &[&["texture"], arguments].concat());
        let text = String::from_utf8_lossy(&message.stderr).into_owned();
        assert!(!message.status.success() && text.lines().count() == 1, "{text}");
        assert!(words.iter().all(|word| text.contains(word)), "{arguments:?}: {text}");
        assert!(!scene.path(arguments[arguments.len() - 1]).exists());
    }
}

#[test]
fn a_grating_of_a_scene_is_felt_at_its_pitch() {
    let scene = Scene::new();
    let with = |solid: &str| {
        let toml = support::TOML
            .replace("roughness = 0.7", &format!("roughness = 0.0\nmicro_relief_m = 0.0\nsolid = {solid}"));
        scene.write("scene.toml", toml);
        scene.write("stroke.jsonl", support::stroke(1, 0.6));
    };
    for (kind, amplitude) in [("sine", "4e-5"), ("ridges", "2e-5"), ("dots", "3e-5")] {
        with(&format!(
            "{{ preset = \"grating\", kind = \"{kind}\", pitch_m = 0.002, amplitude_m = {amplitude}, duty = 0.4 }}"
        ));
        scene.report(&["--trace"]);
        let trace = std::fs::read_to_string(scene.path("out.trace.csv")).unwrap();
        let rows = trace.lines().skip(1).map(|row| row.split(',').map(str::to_owned).collect::<Vec<_>>());
        let heights: Vec<f64> = rows.map(|row| row[4].parse().unwrap()).collect();
        let peak = heights.iter().fold(0.0_f64, |peak, height| peak.max(height.abs()));
        assert!((peak / amplitude.parse::<f64>().unwrap() - 1.0).abs() < 0.02, "{kind}: {peak}");
    }
    for (solid, words) in [
        ("{ preset = \"grating\", kind = \"saw\" }", &["kind", "ridges"][..]),
        ("{ preset = \"grating\", duty = 0.0 }", &["duty", "0.05 to 0.95"]),
        ("{ preset = \"grating\", octaves = 2 }", &["octaves"]),
        ("\"gratin\"", &["gratin", "voronoi, grating"]),
    ] {
        with(solid);
        assert_refused(&asperity(scene.folder.path(), &["render", "scene.toml", "-o", "out"]), words);
    }
}

#[test]
fn a_table_of_the_sources_stands_beside_what_is_printed() {
    let scene = Scene::new();
    let (status, list, _) = message(&asperity(scene.folder.path(), &["evidence", "--list"]));
    assert!(status == 0 && list.contains("004-table-6-1"), "{list}");
    let ran = asperity(scene.folder.path(), &["evidence", "001-fig-4", "-o", "out", "--json"]);
    let (status, out, err) = message(&ran);
    assert_eq!((status, err.as_str()), (0, ""));
    let printed: Value = serde_json::from_str(&out).unwrap();
    let written: Value =
        serde_json::from_slice(&std::fs::read(scene.path("out/evidence.json")).unwrap()).unwrap();
    assert_eq!(printed, written);
    assert_eq!(written["document"]["alpha"], serde_json::json!([1.0, 2.0]));
    let alpha = written["ours"]["alpha"].as_array().unwrap();
    assert!((alpha[1].as_f64().unwrap() - 2.0).abs() < 0.1 && written["sentence"].is_string(), "{alpha:?}");
    assert_refused(
        &asperity(scene.folder.path(), &["evidence", "001-fig-5", "-o", "out"]),
        &["001-fig-5", "001-fig-4"],
    );
}

/// A square of 20 mm as glTF, which its node doubles and lifts by 5 mm; texture coordinates times
/// `repeats`.
fn square(repeats: f32, with_coordinates: bool) -> (Value, Vec<u8>) {
    let points = [[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.02, 0.02, 0.0], [0.0, 0.02, 0.0_f32]];
    let uv = [[0.0, 0.0], [repeats, 0.0], [repeats, repeats], [0.0, repeats]];
    let bytes: Vec<u8> =
        points.as_flattened().iter().chain(uv.as_flattened()).flat_map(|x| x.to_le_bytes()).collect();
    let corners: Vec<u8> = [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut attributes = json!({"POSITION": 0});
    if with_coordinates {
        attributes["TEXCOORD_0"] = json!(1);
    }
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [2, 2, 2], "translation": [0, 0, 0.005]}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2}]}],
        "buffers": [{"uri": "square.bin", "byteLength": 92}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4},
            {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 4},
            {"bufferView": 2, "componentType": 5123, "type": "SCALAR", "count": 6},
        ],
    });
    (document, [bytes, corners].concat())
}

#[test]
fn a_solid_is_baked_over_a_mesh_where_its_texels_lie() {
    let scene = Scene::new();
    let folder = scene.folder.path();
    let put = |name: &str, repeats: f32, with_coordinates: bool| {
        let (document, bytes) = square(repeats, with_coordinates);
        std::fs::write(folder.join(name), document.to_string()).unwrap();
        std::fs::write(folder.join("square.bin"), bytes).unwrap();
    };
    // Three quarters of the map, so that a border and a rest are left.
    put("square.gltf", 0.75, true);
    let arguments = ["solid", "granite", "--bake", "square.gltf", "--size", "128", "-o", "granite.png"];
    let message = report(&scene, &arguments);
    assert_eq!(message["warnings"], json!([]), "{message}");
    let texel_m = 0.04 / (0.75 * 128.0);
    let told_m = message["metres_per_px"].as_f64().unwrap();
    assert!((told_m / texel_m - 1.0).abs() < 1e-6, "{told_m} m a texel");
    let grey_m = message["metres_per_grey"].as_f64().unwrap();
    let map = image::open(folder.join("granite.png")).unwrap().into_luma16();
    let parameters = SolidMaterial::Granite.parameters();
    let noise = SolidNoise::new(parameters, 1).unwrap();
    let height_m = |x: u32, y: u32| {
        let [x, y] = [x, y].map(|texel| (f64::from(texel) + 0.5) * texel_m);
        parameters.amplitude_m * noise.definition(&parameters, [x, y, 0.005])
    };
    let first_m = height_m(0, 0) - f64::from(map.get_pixel(0, 0).0[0]) * grey_m;
    // And four texels beyond its rim.
    for (x, y) in (0..100).flat_map(|x| (0..100).map(move |y| (x, y))).filter(|(x, y)| x.max(y) < &99) {
        let grey = f64::from(map.get_pixel(x, y).0[0]);
        let exact = (height_m(x, y) - first_m) / grey_m;
        assert!((grey - exact).abs() < 1.1, "texel {x}, {y}: {grey} for {exact}");
    }
    for (name, repeats, with_coordinates, words) in [
        ("tiled.gltf", 3.0, true, &["tiled.gltf", "run to 3", "must be 0 to 1"][..]),
        ("bare.gltf", 1.0, false, &["bare.gltf", "no texture coordinates", "--unwrap energy"]),
    ] {
        put(name, repeats, with_coordinates);
        let message = asperity(folder, &["texture", "solid", "granite", "--bake", name, "-o", "a.png"]);
        assert_refused(&message, words);
    }
    let message = asperity(folder, &["texture", "solid", "grating", "--bake", "square.gltf", "-o", "a.png"]);
    assert_refused(&message, &["--bake", "takes no grating"]);
    assert!(!folder.join("a.png").exists());
}
