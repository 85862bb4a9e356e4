//! Support of the black-box tests: running the program, and small scenes to run it on.
#![allow(dead_code)]

pub mod oracle;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Runs the program in a folder.
pub fn asperity(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_asperity")).args(arguments).current_dir(folder).output().unwrap()
}

/// Status, stdout and stderr as text.
pub fn message(output: &Output) -> (i32, String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code().unwrap_or(-1), text(&output.stdout), text(&output.stderr))
}

/// Checks that a run failed as it should: status 1, nothing on stdout, one `error:` line with all
/// parts.
pub fn assert_refused(output: &Output, parts: &[&str]) {
    let (status, out, err) = message(output);
    assert_eq!(status, 1, "stdout: {out}\nstderr: {err}");
    assert_eq!(out, "");
    assert_eq!(err.lines().count(), 1, "{err}");
    assert!(err.starts_with("error: "), "{err}");
    assert!(err.contains("; "), "says no remedy: {err}");
    for part in parts {
        assert!(err.contains(part), "{err}\nlacks\n{part}");
    }
}

/// A folder with a plain scene: one flat surface on one body, one stroke, one impact.
pub struct Scene {
    /// Disappears with the scene.
    pub folder: tempfile::TempDir,
}

/// Modes of the body `bar`.
pub const MODES: &str = r#"{"format":"asperity.modes","version":1,"source":"test","impulse_n_s":0.01,"modes":[
{"frequency_hz":700.0,"decay_per_s":20.0,"amplitude":0.3,"phase_rad":0.0},
{"frequency_hz":1900.0,"decay_per_s":30.0,"amplitude":0.1,"phase_rad":0.0}]}"#;

/// The scene file of [`Scene::new`].
pub const TOML: &str = r#"contacts = "stroke.jsonl"
tail_s = 0.2

[[body]]
name = "bar"
modes = "bar.modes.json"
material = "steel"

[[surface]]
name = "plate"
body = "bar"
width_m = 0.1
height_m = 0.1
roughness = 0.7

[[actuator]]
full_scale = 1.0
"#;

impl Scene {
    /// The plain scene with a stroke of half a second.
    pub fn new() -> Self {
        let scene = Self { folder: tempfile::tempdir().unwrap() };
        scene.write("bar.modes.json", MODES);
        scene.write("scene.toml", TOML);
        scene.write("stroke.jsonl", stroke(1, 0.5));
        scene
    }

    /// Writes a file.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.folder.path().join(name), content).unwrap();
    }

    /// Path of a file.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs `render scene.toml -o out` with more arguments.
    pub fn render(&self, more: &[&str]) -> Output {
        let mut arguments = vec!["render", "scene.toml", "-o", "out"];
        arguments.extend(more);
        asperity(self.folder.path(), &arguments)
    }

    /// Renders with `--json` and returns the object.
    pub fn report(&self, more: &[&str]) -> serde_json::Value {
        let mut arguments = vec!["--json"];
        arguments.extend(more);
        let (status, out, err) = message(&self.render(&arguments));
        assert_eq!((status, err.as_str()), (0, ""));
        serde_json::from_str(&out).unwrap()
    }

    /// Names of the files that begin with `out` or a dot.
    pub fn outputs(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.starts_with("out") || name.starts_with('.'))
            .collect();
        names.sort();
        names
    }

    /// Samples of a WAV file, interleaved.
    pub fn samples(&self, name: &str) -> Vec<f32> {
        let mut reader = hound::WavReader::open(self.path(name)).unwrap();
        assert_eq!(
            (reader.spec().bits_per_sample, reader.spec().sample_format),
            (32, hound::SampleFormat::Float)
        );
        reader.samples::<f32>().map(Result::unwrap).collect()
    }
}

/// A stroke at 80 mm/s, 60 events a second.
pub fn stroke(contact: u64, seconds: f64) -> String {
    let mut lines = String::new();
    let events = (seconds * 60.0) as u32;
    for index in 0..events {
        let t = f64::from(index) / 60.0;
        let kind = if index == 0 {
            r#""event":"begin","surface":"plate","actuator":0,"closing_m_s":0.05"#
        } else {
            r#""event":"move""#
        };
        let u = 0.1 + 0.8 * t;
        let _ = writeln!(
            lines,
            r#"{{"t":{t},{kind},"contact":{contact},"uv":[{u},0.5],"velocity_m_s":[0.08,0.0],"normal_force_n":0.6}}"#
        );
    }
    let _ = writeln!(lines, r#"{{"t":{seconds},"event":"end","contact":{contact}}}"#);
    lines
}

/// One impact on the bar.
pub fn impact(t: f64) -> String {
    format!(
        r#"{{"t":{t},"event":"impact","body":"bar","speed_m_s":0.5,"mass_kg":0.01,"radius_m":0.005,"striker":"steel"}}"#
    ) + "\n"
}
