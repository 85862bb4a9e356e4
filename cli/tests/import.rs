//! `asperity import`: scenes of the draft `KHR_audio_rigid_bodies`, and what is none.

use crate::support;

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use support::{asperity, assert_refused, message};

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// Two modes at three points, a triangle, and a floor that makes no sound.
fn document() -> (Value, Vec<u8>) {
    let mut bytes = floats(&[500.0, 1300.0, 12.0, 40.0]);
    bytes.extend(floats(&[0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.1, 0.0]));
    bytes.extend(floats(&[
        0.0, 0.0, 2.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, -2.0,
    ]));
    bytes.extend([0_u16, 1, 2].iter().flat_map(|x| x.to_le_bytes()));
    let view =
        |offset: usize, length: usize| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    let accessor = |view: usize, kind: &str, count: usize| json!({"bufferView": view, "componentType": 5126, "type": kind, "count": count});
    let mut indices = accessor(4, "SCALAR", 3);
    indices["componentType"] = json!(5123);
    let document = json!({
        "asset": {"version": "2.0"}, "buffers": [{"uri": "scene.bin", "byteLength": bytes.len()}],
        "bufferViews": [view(0, 8), view(8, 8), view(16, 36), view(52, 72), view(124, 6)],
        "accessors": [accessor(0, "SCALAR", 2), accessor(1, "SCALAR", 2), accessor(2, "VEC3", 3), accessor(3, "VEC3", 6), indices],
        "nodes": [
            {"name": "Bell", "extensions": {"KHR_audio_rigid_bodies": {"modalModel": 0, "acousticSurface": 0, "gain": 0.5}}},
            {"name": "Floor", "extensions": {"KHR_audio_rigid_bodies": {"acousticSurface": 0}}},
        ],
        "extensions": {"KHR_audio_rigid_bodies": {
            "acousticMaterials": [{"density": 2700, "youngsModulus": 7.2e10, "poissonRatio": 0.19}],
            "acousticSurfaces": [{"roughness": 2e-5, "correlationLength": 5e-4, "spectralSlope": -2.0, "material": 0}],
            "modalModels": [{"frequencies": 0, "decayRates": 1, "positions": 2, "shapes": 3, "indices": 4, "material": 0}],
        }},
    });
    (document, bytes)
}

fn put(folder: &Path, document: &Value, bytes: &[u8]) {
    fs::write(folder.join("scene.gltf"), document.to_string()).unwrap();
    fs::write(folder.join("scene.bin"), bytes).unwrap();
}

fn import_and_render(folder: &Path, document: &str) -> Value {
    let (status, _, err) = message(&asperity(folder, &["import", document, "-o", "out"]));
    assert_eq!((status, err.as_str()), (0, ""), "{document}");
    let (status, out, err) =
        message(&asperity(folder, &["render", "out/scene.toml", "-o", "take", "--json"]));
    assert_eq!((status, err.as_str()), (0, ""), "{document}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn a_body_with_two_surfaces_renders_with_its_frequency_and_decay() {
    let folder = tempfile::tempdir().unwrap();
    let (document, bytes) = document();
    put(folder.path(), &document, &bytes);
    let report = import_and_render(folder.path(), "scene.gltf");
    assert!(
        report["audio_peak"].as_f64().unwrap() > 1e-4 && report["haptic_peak"][0].as_f64().unwrap() > 0.0,
        "{report}"
    );
    let modes: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("out/Bell-0.modes.json")).unwrap())
            .unwrap();
    assert_eq!(
        (modes["version"].as_u64(), modes["modes"][1]["frequency_hz"].as_f64()),
        (Some(2), Some(1300.0))
    );
    assert_eq!(modes["modes"][0]["decay_per_s"].as_f64(), Some(12.0));
    // φ·n at the three points, which share the triangle alike: 2, −1, 0.5; half of the gain.
    let rms = ((4.0 + 1.0 + 0.25_f64) / 3.0).sqrt();
    assert!((modes["shapes"]["gains"][0].as_f64().unwrap() - 0.5 * rms).abs() < 1e-6);
}

#[test]
fn what_breaks_the_draft_is_refused_where_it_stands() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (good, bytes) = document();
    let model = "/extensions/KHR_audio_rigid_bodies/modalModels/0";
    for (place, value, parts) in [
        ("/asset/version", json!("1.0"), vec!["asset.version"]),
        (
            "/nodes/0/extensions/KHR_audio_rigid_bodies/modalModel",
            json!(7),
            vec!["nodes[0]", "modalModel", "modalModels"],
        ),
        ("/nodes/0/extensions/KHR_audio_rigid_bodies/gain", json!(-1), vec!["nodes[0]", "gain"]),
        ("/nodes", json!([]), vec!["nodes", "KHR_audio_rigid_bodies"]),
        ("/accessors/0/count", json!(0), vec!["frequencies"]),
        ("/accessors/0/count", json!(1_u64 << 60), vec!["frequencies"]),
        ("/accessors/3/count", json!(5), vec!["shapes"]),
        ("/accessors/0/type", json!("VEC3"), vec!["frequencies"]),
        ("/bufferViews/3/byteLength", json!(4000), vec!["shapes", "buffer"]),
        ("/buffers/0/uri", json!("../elsewhere.bin"), vec!["buffers[0].uri"]),
        ("/buffers/0/uri", json!("data:x;base64,***"), vec!["base64"]),
        (&format!("{model}/indices"), json!(0), vec!["indices"]),
        (&format!("{model}/decayRates"), json!(null), vec!["decayRates"]),
        ("/extensions/KHR_audio_rigid_bodies/acousticSurfaces/0/roughness", json!(-1), vec!["roughness"]),
        (
            "/extensions/KHR_audio_rigid_bodies/acousticMaterials/0/poissonRatio",
            json!(5.19),
            vec!["scene.gltf", "Bell-0", "poisson", "5.19 is refused", "0.5"],
        ),
        (
            "/extensions/KHR_audio_rigid_bodies/acousticMaterials/0/youngsModulus",
            json!(-1),
            vec!["scene.gltf", "Bell-0", "young_pa"],
        ),
        (
            "/extensions/KHR_audio_rigid_bodies/acousticSurfaces/0/spectralSlope",
            json!("steep"),
            vec!["spectralSlope"],
        ),
    ] {
        let mut broken = good.clone();
        *broken.pointer_mut(place).unwrap() = value;
        put(folder, &broken, &bytes);
        assert_refused(&asperity(folder, &["import", "scene.gltf", "-o", "out"]), &parts);
    }
    fs::write(folder.join("x.glb"), b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON").unwrap();
    assert_refused(&asperity(folder, &["import", "x.glb", "-o", "out"]), &["x.glb"]);
    fs::write(folder.join("x.gltf"), "not json").unwrap();
    assert_refused(&asperity(folder, &["import", "x.gltf", "-o", "out"]), &["x.gltf"]);
}

fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let path = entry.path();
        if path.is_dir() {
            documents(&path, found);
        } else if path.extension().is_some_and(|e| e == "gltf")
            && fs::read_to_string(&path).unwrap().contains("KHR_audio_rigid_bodies")
        {
            found.push(path);
        }
    }
}

/// `ASPERITY_KHR_SAMPLES` names a folder with the draft's sample scenes.
#[test]
fn every_sample_scene_of_the_draft_is_read_and_five_render() {
    let Some(samples) = std::env::var_os("ASPERITY_KHR_SAMPLES") else {
        println!("skipped: ASPERITY_KHR_SAMPLES names no folder with the draft's sample scenes");
        return;
    };
    let mut found = Vec::new();
    documents(Path::new(&samples), &mut found);
    found.sort();
    assert!(found.len() >= 50, "{}", found.len());
    let folder = tempfile::tempdir().unwrap();
    for (index, path) in found.iter().enumerate() {
        let path = path.to_str().unwrap();
        let (status, _, err) = message(&asperity(folder.path(), &["import", path, "-o", "parsed"]));
        assert_eq!((status, err.as_str()), (0, ""), "{path}");
        if index % (found.len() / 5) == 0 {
            let report = import_and_render(folder.path(), path);
            // Small bodies of the samples ring above what is heard; their surfaces are felt all the
            // same.
            let peak = |value: &Value| value.as_f64().unwrap();
            assert!(
                peak(&report["audio_peak"]) > 0.0 || peak(&report["haptic_peak"][0]) > 0.0,
                "{path}: {report}"
            );
            println!("{path}: audio {}, haptic {}", report["audio_peak"], report["haptic_peak"]);
        }
    }
    println!("{} documents read", found.len());
}

/// A box of 0.1 × 0.05 × 0.02 m whose material has a normal texture, and the node that places it.
fn textured_box(node: &Value, transform: &Value) -> (Value, Vec<u8>) {
    let corners: Vec<[f32; 3]> = (0..8_u8)
        .map(|i| [0.1 * f32::from(i & 1), 0.05 * f32::from(i >> 1 & 1), 0.02 * f32::from(i >> 2)])
        .collect();
    let quads: [[u16; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    // Coordinates over the top: four repeats along x, two along y; the walls have none to speak of.
    bytes.extend(corners.iter().flat_map(|[x, y, _]| [40.0 * x, 40.0 * y]).flat_map(f32::to_le_bytes));
    let indices = quads.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]);
    bytes.extend(indices.flat_map(u16::to_le_bytes));
    let mut png = Vec::new();
    let picture = image::RgbImage::from_fn(64, 64, |x, _| {
        let slope = 0.3 * (std::f64::consts::TAU * (f64::from(x) + 0.5) / 16.0).cos();
        let unit = 1.0 / (1.0 + slope * slope).sqrt();
        let byte = |c: f64| ((0.5 + 0.5 * c) * 255.0).round() as u8;
        image::Rgb([byte(-slope * unit), 128, byte(unit)])
    });
    picture.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
    fs::create_dir_all(std::env::temp_dir()).unwrap();
    let view =
        |offset: usize, length: usize| json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
    let accessor = |view: usize, of: u32, kind: &str, count: usize| json!({"bufferView": view, "componentType": of, "type": kind, "count": count});
    let document = json!({
        "asset": {"version": "2.0"}, "buffers": [{"uri": "scene.bin", "byteLength": bytes.len()}],
        "bufferViews": [view(0, 96), view(96, 64), view(160, 72)],
        "accessors": [accessor(0, 5126, "VEC3", 8), accessor(1, 5126, "VEC2", 8), accessor(2, 5123, "SCALAR", 36)],
        "meshes": [{"name": "brick", "primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"name": "clay", "pbrMetallicRoughness": {"roughnessFactor": 0.7},
            "normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": transform}}}],
        "textures": [{"source": 0}], "images": [{"uri": "my%20normals.png"}],
        "nodes": [node, {"mesh": 0}],
    });
    (document, [bytes, png].concat())
}

#[test]
fn a_document_without_the_draft_gives_body_and_surface_in_metres() {
    let plain = json!({"children": [1]});
    let halved = json!({"children": [1], "scale": [0.5, 0.5, 0.5]});
    let matrix = json!({"children": [1], "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 1, 1, 1]});
    for (node, transform, factor, repeats) in [
        (&plain, json!({}), 1.0, 1.0),
        (&halved, json!({}), 0.5, 1.0),
        (&matrix, json!({"scale": [2, 2]}), 2.0, 2.0),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (document, bytes) = textured_box(node, &transform);
        put(folder.path(), &document, &bytes[..232]);
        fs::write(folder.path().join("my normals.png"), &bytes[232..]).unwrap();
        let (status, out, err) =
            message(&asperity(folder.path(), &["import", "scene.gltf", "-o", "out", "--json"]));
        assert_eq!((status, err.as_str()), (0, ""), "{out}");
        let report: Value = serde_json::from_str(&out).unwrap();
        assert_eq!((report["bodies"].as_u64(), report["surfaces"].as_u64()), (Some(1), Some(1)), "{report}");
        let scene: toml::Value =
            toml::from_str(&fs::read_to_string(folder.path().join("out/scene.toml")).unwrap()).unwrap();
        let surface = &scene["surface"][0];
        let number = |key: &str| surface[key].as_float().unwrap();
        // One repeat spans 25 mm on the faces that have coordinates; slopes of 0.3 over 4 periods
        // of it.
        let width_m = 0.025 * factor / repeats;
        assert!((number("width_m") / width_m - 1.0).abs() < 0.01, "{}", number("width_m"));
        let relief_m = 2.0 * 0.3 * (width_m / 4.0) / std::f64::consts::TAU;
        assert!((number("relief_m") / relief_m - 1.0).abs() < 0.03, "{} {relief_m}", number("relief_m"));
        assert_eq!(surface["body"].as_str(), scene["body"][0]["name"].as_str());
    }
}

#[test]
fn surfaces_of_a_level_come_without_waiting_for_bodies() {
    let folder = tempfile::tempdir().unwrap();
    let (document, bytes) = textured_box(&json!({"children": [1]}), &json!({}));
    put(folder.path(), &document, &bytes[..232]);
    fs::write(folder.path().join("my normals.png"), &bytes[232..]).unwrap();
    let arguments = ["import", "scene.gltf", "-o", "out", "--surfaces-only", "--json"];
    let (status, out, err) = message(&asperity(folder.path(), &arguments));
    assert_eq!((status, err.as_str()), (0, ""), "{out}");
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((report["bodies"].as_u64(), report["surfaces"].as_u64()), (Some(0), Some(1)), "{report}");
}

/// A document of one sheet without texture coordinates, `open` or closed to a box.
fn sheet(open: bool) -> (Value, Vec<u8>) {
    let (mut document, bytes) = textured_box(&json!({"children": [1]}), &json!({}));
    document["materials"] = json!([{"name": "clay"}]);
    let mesh = &mut document["meshes"][0]["primitives"][0];
    mesh["attributes"] = json!({"POSITION": 0});
    if open {
        // Front, top and back: a channel that can be laid flat.
        document["accessors"][2]["count"] = json!(18);
        document["accessors"][2]["byteOffset"] = json!(12);
    }
    (document, bytes[..232].to_vec())
}

#[test]
fn a_mesh_without_coordinates_is_unwrapped_in_metres_or_told_why_not() {
    for (method, open) in [("energy", true), ("smooth", true), ("energy", false)] {
        let folder = tempfile::tempdir().unwrap();
        let (document, bytes) = sheet(open);
        put(folder.path(), &document, &bytes);
        let arguments = ["import", "scene.gltf", "-o", "out", "--unwrap", method, "--json"];
        let (status, out, err) = message(&asperity(folder.path(), &arguments));
        assert_eq!((status, err.as_str()), (0, ""), "{out}");
        let report: Value = serde_json::from_str(&out).unwrap();
        let file = folder.path().join("out/brick-0.glb");
        if !open {
            assert!(report["unwrap"].is_null() && !file.exists(), "{report}");
            assert!(
                report["warnings"].to_string().contains("not unwrapped: the surface is closed"),
                "{report}"
            );
            continue;
        }
        let unwrap = &report["unwrap"];
        assert_eq!(unwrap["method"], method);
        assert_eq!(unwrap["phi"].as_f64(), (method == "energy").then_some(0.2));
        assert_eq!(
            (unwrap["flipped"].as_u64(), unwrap["area_distortion"]["mean"].as_f64()),
            (Some(0), Some(1.0))
        );
        let glb = fs::read(file).unwrap();
        let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        let made: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
        let attributes = &made["meshes"][0]["primitives"][0]["attributes"];
        let accessor = |key: &str| &made["accessors"][attributes[key].as_u64().unwrap() as usize];
        assert_eq!(accessor("TEXCOORD_0")["type"], "VEC2");
        assert_eq!(accessor("TEXCOORD_0")["count"], accessor("POSITION")["count"]);
        let view = &made["bufferViews"][accessor("TEXCOORD_0")["bufferView"].as_u64().unwrap() as usize];
        let at = 28 + length + view["byteOffset"].as_u64().unwrap() as usize;
        let bytes = &glb[at..at + view["byteLength"].as_u64().unwrap() as usize];
        let uv: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
        let widest = uv.iter().fold(0.0_f32, |widest, x| widest.max(*x));
        assert!((0.03..0.2).contains(&widest), "metres of a box of 0.1 × 0.05 × 0.02: {widest}");
    }
    let folder = tempfile::tempdir().unwrap();
    let message =
        asperity(folder.path(), &["import", "scene.gltf", "-o", "out", "--unwrap", "energy", "--phi", "2"]);
    assert!(String::from_utf8_lossy(&message.stderr).contains("must be 0 to 1"));
}

#[test]
fn an_extension_that_a_document_requires_and_nobody_reads_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (mut document, bytes) = document();
    document["extensionsRequired"] = json!(["EXT_unknown", "KHR_mesh_quantization"]);
    put(folder.path(), &document, &bytes);
    let (status, out, _) =
        message(&asperity(folder.path(), &["import", "scene.gltf", "-o", "out", "--json"]));
    let report: Value = serde_json::from_str(&out).unwrap();
    let warnings = report["warnings"].to_string();
    assert!(
        status == 0 && warnings.contains("EXT_unknown") && !warnings.contains("quantization"),
        "{warnings}"
    );
}
