//! Wrong usage: status 2, one line, nothing on stdout, nothing written.

use crate::support;

use std::path::Path;
use support::{Scene, asperity, message};

#[test]
fn wrong_usage_is_one_line_and_status_2() {
    let scene = Scene::new();
    for arguments in [
        &[][..],
        &["dance"],
        &["render"],
        &["render", "scene.toml"],
        &["render", "scene.toml", "-o"],
        &["render", "scene.toml", "-o", "out", "--block", "0"],
        &["render", "scene.toml", "-o", "out", "--block", "4097"],
        &["render", "scene.toml", "-o", "out", "--rate", "nan"],
        &["render", "scene.toml", "-o", "out", "--rate", "1e300"],
        &["render", "scene.toml", "-o", "out", "--rate", "100"],
        &["render", "scene.toml", "-o", "out", "--seed", "-3"],
        &["render", "scene.toml", "-o", "out", "--integrator", "magic"],
        &["render", "scene.toml", "-o", "out", "--path", "scenic"],
        &["render", "scene.toml", "-o", "out", "--colour"],
        &["demo", "extra"],
    ] {
        let (status, out, err) = message(&asperity(scene.folder.path(), arguments));
        assert_eq!(status, 2, "{arguments:?}: {err}");
        assert_eq!(out, "", "{arguments:?}");
        assert_eq!(err.lines().count(), 1, "{arguments:?}: {err}");
        assert!(err.starts_with("error: "), "{err}");
    }
    assert!(scene.outputs().is_empty());
}

#[test]
fn what_is_no_number_is_answered_with_what_would_be_one() {
    let scene = Scene::new();
    for (arguments, right) in [
        (&["--seed", "-3"][..], "must be a whole number from 0 on"),
        (&["--block", "many"], "must be a whole number from 0 on"),
        (&["--seed", "99999999999999999999"], "must be a smaller number"),
    ] {
        let (status, _, err) = message(&scene.render(arguments));
        assert!(status == 2 && err.contains(right), "{arguments:?}: {err}");
    }
    let (status, _, err) =
        message(&asperity(Path::new("."), &["fit", "a.wav", "-o", "b", "--impulse", "hard"]));
    assert!(status == 2 && err.contains("must be a number"), "{err}");
}

#[test]
fn a_misspelt_choice_is_answered_with_the_choices() {
    let scene = Scene::new();
    let (_, _, err) = message(&scene.render(&["--integrator", "euler"]));
    for name in ["semi-implicit-euler", "exact-event", "energy-conserving"] {
        assert!(err.contains(name), "{err}");
    }
}

#[test]
fn help_and_version_go_to_stdout() {
    for argument in ["--help", "--version"] {
        let (status, out, err) = message(&asperity(Path::new("."), &[argument]));
        assert_eq!((status, err.as_str()), (0, ""));
        assert!(out.contains("asperity"));
    }
    let (_, out, _) = message(&asperity(Path::new("."), &["render", "--help"]));
    for option in
        ["--rate", "--block", "--seed", "--integrator", "--path", "--trace", "--plot", "--force", "--json"]
    {
        assert!(out.contains(option), "{out}");
    }
}

#[test]
fn a_number_below_0_is_answered_with_the_range() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, part) in [
        (&["strike", "bar", "-o", "x", "--speeds", "-1"][..], "must be a number above 0"),
        (&["strike", "bar", "-o", "x", "--mass", "-0.1"], "must be a number above 0"),
        (&["stroke", "wall.png", "-o", "x", "--force", "-2"], "must be a number above 0"),
        (&["texture", "compare", "a.png", "b.png", "--width-m", "-1"], "above 0"),
    ] {
        let (status, _, err) = message(&asperity(folder.path(), arguments));
        assert_eq!((status, err.lines().count()), (2, 1), "{err}");
        assert!(err.contains(part) && !err.contains("use '--"), "{err}");
    }
}
