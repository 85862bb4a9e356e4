//! An output that is an input is refused by every verb, by whatever path, and the input is as it
//! was.

#![cfg(unix)]

use crate::support;

use image::{GrayImage, Luma, RgbImage};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use support::{MODES, asperity, assert_refused, message, stroke};

/// A verb and its inputs, `OUT` standing for the output, and which file the output is.
type Case = (&'static [&'static str], &'static str);

const CASES: [Case; 29] = [
    (&["fit", "hit.json", "-o", "OUT"], "hit.json"),
    (&["fit", "hit.wav", "-o", "a.json", "--residual", "OUT"], "hit.wav"),
    (&["fit", "hit.wav", "-o", "a.json", "--resynthesis", "OUT"], "hit.wav"),
    (&["fit", "hit.wav", "--merge", "other.wav", "-o", "a.json", "--residual", "OUT"], "other.wav"),
    (&["fit", "hit.wav", "--merge", "other.wav", "--mesh", "shape.json", "-o", "OUT"], "shape.json"),
    (&["fit", "hit.wav", "other.wav", "--family", "-o", "a.json", "--residual", "OUT"], "other.wav"),
    (&["fit", "hit.svg", "-o", "a.json", "--plot", "OUT"], "hit.svg"),
    (&["fit", "hit.csv", "-o", "a.json", "--csv", "OUT"], "hit.csv"),
    (&["modes", "mesh.json", "-o", "OUT"], "mesh.json"),
    (&["modes", "mesh.svg", "-o", "a.json", "--plot", "OUT"], "mesh.svg"),
    (&["modes", "mesh.obj", "--damping-from", "bar.modes.json", "-o", "OUT"], "bar.modes.json"),
    (&["haptic", "hit.wav", "-o", "OUT"], "hit.wav"),
    (&["haptic", "clip.haptic", "-o", "OUT"], "clip.haptic"),
    (&["haptic", "hit.svg", "-o", "a.haptic", "--plot", "OUT"], "hit.svg"),
    (&["haptic", "hit.wav", "--device", "mine.haptic", "-o", "OUT"], "mine.haptic"),
    (&["haptic", "scene.toml", "-o", "OUT"], "log.haptic"),
    (&["render", "scene.toml", "-o", "take", "--port", "OUT"], "log.haptic"),
    (&["export", "shape.glb", "-o", "OUT"], "shape.glb"),
    (&["texture", "metamer", "a.png", "b.png", "-o", "OUT"], "a.png"),
    (&["texture", "metamer", "a.png", "b.png", "-o", "OUT"], "b.png"),
    (&["texture", "metamer", "a.stl", "b.png", "-o", "c.png", "--stl", "OUT"], "a.stl"),
    (&["texture", "from-normals", "a.png", "-o", "OUT"], "a.png"),
    (&["texture", "from-normals", "a.stl", "-o", "c.png", "--stl", "OUT"], "a.stl"),
    (&["texture", "analyze", "a.png", "--primitive", "OUT"], "a.png"),
    (&["texture", "solid-of", "a.stl", "-o", "OUT"], "a.stl"),
    (&["texture", "from-photo", "a.stl", "-o", "photo", "--stl", "OUT"], "a.stl"),
    (
        &[
            "texture",
            "from-photo",
            "a.png",
            "--known",
            "a.stl",
            "--known-relief-m",
            "0.001",
            "-o",
            "photo",
            "--stl",
            "OUT",
        ],
        "a.stl",
    ),
    (&["fit", "other.wav", "-o", "a.json", "--plot", "b.svg", "--residual", "OUT"], "other.wav"),
    (
        &["modes", "mesh.obj", "-o", "shape.json", "--damping-from", "shape.json", "--plot", "a.svg"],
        "shape.json",
    ),
];

/// A verb whose outputs get their names from a stem or a folder, and the input that one of them
/// would be.
const NAMED: [Case; 14] = [
    (&["render", "named.toml", "-o", "OUTtake", "--trace"], "take.trace.csv"),
    (&["render", "log-is-audio.toml", "-o", "OUTtake"], "take.audio.wav"),
    (&["render", "log-is-force.toml", "-o", "OUTtake", "--force"], "take.force.csv"),
    (&["render", "map-is-plot.toml", "-o", "OUTtake", "--plot"], "take.svg"),
    (&["render", "sand.toml", "-o", "OUTtake"], "take.bed.sand.png"),
    (&["texture", "from-photo", "roughness.png", "-o", "OUT."], "roughness.png"),
    (&["texture", "from-photo", "overview.png", "-o", "OUT."], "overview.png"),
    (&["texture", "from-photo", "displacement.png", "-o", "OUT."], "displacement.png"),
    (
        &[
            "texture",
            "from-photo",
            "a.png",
            "--known",
            "symmetric.png",
            "--known-relief-m",
            "0.001",
            "-o",
            "OUT.",
        ],
        "symmetric.png",
    ),
    (&["import", "scene.toml", "-o", "OUT."], "scene.toml"),
    (&["modes", "ball.glb", "--shapes-glb", "-o", "OUTball.json"], "ball.glb"),
    (&["import", "doc.gltf", "-o", "OUT."], "contacts.jsonl"),
    (&["haptic", "strokes.ahap", "-o", "OUTstrokes.transients.ahap"], "strokes.transients.ahap"),
    (&["export", "bell.json", "-o", "OUTbell.glb"], "bell.glb"),
];

fn fill(folder: &Path) {
    let put = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).unwrap();
    let hit = fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/tile_strike.wav")).unwrap();
    for name in ["hit.wav", "other.wav", "hit.svg", "hit.csv", "hit.json"] {
        put(name, &hit);
    }
    let tetrahedron = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    for name in ["mesh.obj", "mesh.json", "mesh.svg", "ball.glb"] {
        put(name, tetrahedron.as_bytes());
    }
    for name in ["bar.modes.json", "shape.json", "shape.glb", "bell.json", "bell.glb"] {
        put(name, MODES.as_bytes());
    }
    put("clip.haptic", b"{}");
    put("mine.haptic", b"label = \"x\"");
    let picture = RgbImage::from_fn(96, 96, |x, y| image::Rgb([(x * 37 + y * 11) as u8, (x * y) as u8, 128]));
    let map = GrayImage::from_fn(96, 96, |x, y| Luma([(x * 37 + y * 11) as u8]));
    let png = |name: &str| {
        let path = folder.join("now.png");
        if name == "map" {
            map.save(&path).unwrap()
        } else {
            picture.save(&path).unwrap()
        }
        let bytes = fs::read(&path).unwrap();
        fs::remove_file(&path).unwrap();
        bytes
    };
    for name in
        ["a.png", "b.png", "a.stl", "roughness.png", "overview.png", "displacement.png", "symmetric.png"]
    {
        put(name, &png("picture"));
    }
    for name in ["take.svg", "take.bed.sand.png"] {
        put(name, &png("map"));
    }
    let log = stroke(1, 0.2);
    for name in ["log.haptic", "take.trace.csv", "take.audio.wav", "take.force.csv"] {
        put(name, log.as_bytes());
    }
    put("stroke.jsonl", log.as_bytes());
    let scene = |log: &str, keys: &str| {
        format!("contacts = \"{log}\"\n[[surface]]\nname = \"plate\"\nwidth_m = 0.1\nheight_m = 0.1\n{keys}")
    };
    put("scene.toml", scene("log.haptic", "").as_bytes());
    put("named.toml", scene("take.trace.csv", "").as_bytes());
    put("log-is-audio.toml", scene("take.audio.wav", "").as_bytes());
    put("log-is-force.toml", scene("take.force.csv", "").as_bytes());
    put(
        "map-is-plot.toml",
        scene("stroke.jsonl", "displacement = \"take.svg\"\nrelief_m = 1e-4\n").as_bytes(),
    );
    let bed = "[[surface]]\nname = \"bed\"\nwidth_m = 0.1\nheight_m = 0.1\nsand = {}\n";
    let map = "displacement = \"take.bed.sand.png\"\nrelief_m = 1e-4\n";
    put("sand.toml", format!("{}{bed}", scene("stroke.jsonl", map)).as_bytes());
    let gltf = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"contacts.jsonl","byteLength":4}],"nodes":[],
        "extensions":{"KHR_audio_rigid_bodies":{"acousticMaterials":[],"acousticSurfaces":[],"modalModels":[]}}}"#;
    put("doc.gltf", gltf.as_bytes());
    put("contacts.jsonl", b"1234");
    put("strokes.ahap", b"{\"Version\":1.0,\"Pattern\":[]}");
    put("strokes.transients.ahap", b"{\"Version\":1.0,\"Pattern\":[]}");
}

fn everything(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn an_output_that_is_an_input_is_refused_by_every_verb() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fill(at);
    fs::create_dir(at.join("photo")).unwrap();
    fs::create_dir(at.join("below")).unwrap();
    symlink(at, at.join("here")).unwrap();
    let mut refused = 0;
    for (arguments, input) in CASES {
        let ending = &input[input.find('.').unwrap()..];
        let (link, hard) = (format!("link{ending}"), format!("hard{ending}"));
        symlink(at.join(input), at.join(&link)).unwrap();
        fs::hard_link(at.join(input), at.join(&hard)).unwrap();
        let before = everything(at);
        let absolute = at.join(input).display().to_string();
        let ways = [
            input.to_owned(),
            format!("./{input}"),
            format!("below/../{input}"),
            format!("here/{input}"),
            absolute,
            link.clone(),
            hard.clone(),
        ];
        for way in ways {
            let arguments: Vec<&str> =
                arguments.iter().map(|part| if *part == "OUT" { &*way } else { *part }).collect();
            assert_refused(&asperity(at, &arguments), &["read", "write somewhere else"]);
            assert_eq!(everything(at), before, "{arguments:?}");
            refused += 1;
        }
        fs::remove_file(at.join(link)).unwrap();
        fs::remove_file(at.join(hard)).unwrap();
    }
    assert_eq!(refused, 7 * CASES.len());
}

#[test]
fn an_output_named_by_a_stem_or_folder_is_never_an_input() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    fill(at);
    fs::create_dir(at.join("below")).unwrap();
    symlink(at, at.join("here")).unwrap();
    let before = everything(at);
    for (arguments, input) in NAMED {
        for way in ["", "./", "below/../", "here/"] {
            let arguments: Vec<String> = arguments.iter().map(|part| part.replace("OUT", way)).collect();
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let (status, out, err) = message(&asperity(at, &arguments));
            assert_eq!((status, out.as_str()), (1, ""), "{arguments:?}: {err}");
            let now = everything(at);
            let kept = |files: &[(String, Vec<u8>)]| files.iter().find(|(name, _)| name == input).cloned();
            assert_eq!(kept(&now), kept(&before), "{arguments:?}");
            assert_eq!(now.len(), before.len(), "{arguments:?}: {err}");
        }
    }
}

#[test]
fn a_file_that_is_no_input_is_replaced_as_ever() {
    let folder = tempfile::tempdir().unwrap();
    for _ in 0..2 {
        let (status, _, err) = message(&asperity(
            folder.path(),
            &["texture", "solid", "granite", "--size", "64", "-o", "granite.png"],
        ));
        assert_eq!((status, err.as_str()), (0, ""));
    }
}
