//! A disk without room: every verb that writes says so in one line, and nothing half-written is
//! left.

#![cfg(unix)]

use crate::support::{Scene, asperity, message};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

/// Runs the program where no file gets longer than a kilobyte.
fn without_room(folder: &Path, arguments: &[&str]) -> Output {
    // Writing further fails as on a full disk, once the signal for it is ignored.
    let script = "trap '' XFSZ; ulimit -f 2; exec \"$0\" \"$@\"";
    let mut shell = Command::new("sh");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_asperity")]).args(arguments);
    shell.current_dir(folder).output().unwrap()
}

/// Made files that the fuzzer begins with are inputs here.
fn seeded(scene: &Scene, name: &str) {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/fuzz/seeds");
    fs::copy(seeds.join(name), scene.path(name.rsplit('/').next().unwrap())).unwrap();
}

#[test]
fn a_verb_without_disk_space_says_so_and_leaves_nothing() {
    let scene = Scene::new();
    for name in ["wav/tone.wav", "obj/brick.obj", "gltf/draft.gltf", "gltf/plain.gltf", "batch/strokes.toml"]
    {
        seeded(&scene, name);
    }
    fs::write(scene.path("ground.toml"), "[[surface]]\nname = \"a\"\nwidth_m = 0.1\nheight_m = 0.1\n")
        .unwrap();
    asperity(scene.folder.path(), &["texture", "solid", "granite", "-o", "granite.png"]);
    for arguments in [
        &["render", "scene.toml", "-o", "out/take"][..],
        &["render", "scene.toml", "-o", "out/take", "--plot"],
        &["strike", "bowl", "-o", "out"],
        &["stroke", "ground.toml", "-o", "out"],
        &["fit", "tone.wav", "-o", "out/tone.modes.json", "--plot", "out/tone.svg"],
        &["fit", "tone.wav", "-o", "out/tone.modes.json", "--resynthesis", "out/tone.wav"],
        &["modes", "brick.obj", "--material", "glass", "--max-modes", "4", "-o", "out/brick.modes.json"],
        &["haptic", "scene.toml", "-o", "out/clip.wav"],
        &["haptic", "tone.wav", "-o", "out/clip.haptic", "--plot", "out/clip.svg"],
        &["haptic", "tone.wav", "-o", "out/clip.hjif"],
        &["import", "draft.gltf", "-o", "out"],
        &["texture", "solid", "granite", "-o", "out/granite.png"],
        &["texture", "from-photo", "granite.png", "-o", "out"],
        &["texture", "metamer", "granite.png", "granite.png", "--iterations", "1", "-o", "out/like.png"],
        &["batch", "strokes.toml", "--shard", "1/4", "-o", "out"],
    ] {
        fs::create_dir_all(scene.path("out")).unwrap();
        let (status, _, err) = message(&without_room(scene.folder.path(), arguments));
        assert_eq!((status, err.lines().count()), (1, 1), "{arguments:?}: {err}");
        assert!(err.contains("cannot be written") && err.contains("; "), "{arguments:?}: {err}");
        assert!(!err.contains(".part"), "{arguments:?}: {err}");
        // A data set keeps what the next run goes on from.
        let kept = |name: &str| arguments[0] == "batch" && [".manifest.lock", "spec.toml"].contains(&name);
        let entries = fs::read_dir(scene.path("out")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let left: Vec<_> = names.filter(|name| !kept(name)).collect();
        assert!(left.is_empty(), "{arguments:?} leaves {left:?}");
        fs::remove_dir_all(scene.path("out")).unwrap();
    }
}

#[test]
fn a_report_that_finds_no_room_is_no_success() {
    if !Path::new("/dev/full").exists() {
        return println!("skipped: this system has no /dev/full");
    }
    let scene = Scene::new();
    let program = env!("CARGO_BIN_EXE_asperity");
    let mut render = Command::new(program);
    render.args(["render", "scene.toml", "-o", "out", "--json"]).current_dir(scene.folder.path());
    let output = render.stdout(File::options().write(true).open("/dev/full").unwrap()).output().unwrap();
    let (status, _, err) = message(&output);
    assert_eq!((status, err.lines().count()), (1, 1), "{err}");
    assert!(err.starts_with("error: stdout: cannot be written"), "{err}");
    assert_eq!(message(&asperity(scene.folder.path(), &["--version"])).0, 0);
}
