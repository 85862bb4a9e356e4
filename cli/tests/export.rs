//! `asperity export`: bodies as other tools read them, and back.

use crate::support;

use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use support::{asperity, assert_refused, message};

/// Two modes of a tetrahedron.
fn body() -> Value {
    json!({
        "format": "asperity.modes", "version": 2, "source": "made", "impulse_n_s": 1.0, "unit": "relative",
        "modes": [
            {"frequency_hz": 512.25, "decay_per_s": 3.5, "amplitude": 1.0, "phase_rad": 0.0},
            {"frequency_hz": 1730.5, "decay_per_s": 11.0, "amplitude": -0.5, "phase_rad": 0.0},
        ],
        "shapes": {
            "points_m": [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.05]],
            "triangles": [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            "gains": [1.0, 1.0],
            "phi_per_sqrt_kg": [
                [[0.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, -3.0]],
                [[1.0, 0.0, 0.0], [0.0, -1.0, 0.25], [0.0, 0.0, 1.0], [2.0, 0.0, 0.0]],
            ],
            "struck_point": 3,
        },
    })
}

fn put(folder: &Path, name: &str, file: &Value) {
    fs::write(folder.join(name), file.to_string()).unwrap();
}

fn read(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn what_is_exported_and_imported_again_has_its_modes_places_and_shapes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    put(folder, "bell.modes.json", &body());
    for document in ["scene.gltf", "scene.glb"] {
        let (status, out, err) = message(&asperity(
            folder,
            &["export", "bell.modes.json", "--material", "steel", "-o", document, "--json"],
        ));
        assert_eq!((status, err.as_str()), (0, ""));
        let report: Value = serde_json::from_str(&out).unwrap();
        assert_eq!((report["bodies"].as_u64(), report["modes"].as_u64()), (Some(1), Some(2)));
        let (status, _, err) = message(&asperity(folder, &["import", document, "-o", "back"]));
        assert_eq!((status, err.as_str()), (0, ""));
        let (back, sent) = (read(&folder.join("back/bell-0.modes.json")), body());
        for key in ["points_m", "triangles", "phi_per_sqrt_kg"] {
            let numbers = |file: &Value| -> Vec<f64> {
                fn flat(value: &Value, into: &mut Vec<f64>) {
                    match value {
                        Value::Array(items) => items.iter().for_each(|item| flat(item, into)),
                        value => into.push(value.as_f64().unwrap()),
                    }
                }
                let mut all = Vec::new();
                flat(&file["shapes"][key], &mut all);
                all
            };
            let (back, sent) = (numbers(&back), numbers(&sent));
            assert_eq!(back.len(), sent.len());
            assert!(back.iter().zip(&sent).all(|(a, b)| (a - b).abs() < 1e-7), "{document}: {key}");
        }
        for (mode, key) in [(0, "frequency_hz"), (1, "frequency_hz"), (0, "decay_per_s"), (1, "decay_per_s")]
        {
            assert_eq!(back["modes"][mode][key], sent["modes"][mode][key], "{document}: {key}");
        }
        let scene = fs::read_to_string(folder.join("back/scene.toml")).unwrap();
        assert!(scene.contains("young_pa"), "the material goes along");
    }
}

#[test]
fn a_packed_document_has_chunks_of_four_bytes_that_end_right() {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "bell.modes.json", &body());
    let (status, ..) = message(&asperity(folder.path(), &["export", "bell.modes.json", "-o", "bell.glb"]));
    assert_eq!(status, 0);
    let bytes = fs::read(folder.path().join("bell.glb")).unwrap();
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let second = 20 + word(12);
    assert_eq!((word(12) % 4, &bytes[second + 4..second + 8]), (0, &b"BIN\0"[..]));
    assert_eq!(second + 8 + word(second), bytes.len());
    let document: Value = serde_json::from_slice(&bytes[20..second]).unwrap();
    let max = document["accessors"]
        .as_array()
        .unwrap()
        .iter()
        .find_map(|accessor| accessor["max"].as_array())
        .unwrap();
    let apart = max.iter().zip([0.1, 0.2, 0.05]).map(|(found, want)| (found.as_f64().unwrap() - want).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-7, "{max:?}");
}

#[test]
fn bodies_without_shapes_and_other_documents_are_refused_without_remains() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mut plain = body();
    plain["version"] = json!(1);
    let fields = plain.as_object_mut().unwrap();
    fields.remove("shapes");
    fields.remove("unit");
    put(folder, "plain.modes.json", &plain);
    put(folder, "bell.modes.json", &body());
    let refused = |arguments: &[&str], parts: &[&str]| assert_refused(&asperity(folder, arguments), parts);
    refused(
        &["export", "bell.modes.json", "plain.modes.json", "-o", "x.glb"],
        &["plain.modes.json", "shapes"],
    );
    refused(&["export", "bell.modes.json", "-o", "x.obj"], &["x.obj", ".gltf"]);
    refused(&["export", "missing.modes.json", "-o", "x.glb"], &["missing.modes.json"]);
    refused(&["export", "bell.modes.json", "--material", "soap", "-o", "x.glb"], &["soap", "ceramic"]);
    assert_eq!(fs::read_dir(folder).unwrap().count(), 2);
}
