//! Scenes of one probe on one ground whose levels nobody wrote, and a slanting stroke over another
//! place than the reference strokes.
#![allow(dead_code)]

use crate::common::SIDE_M;
use asperity::Engine;
use asperity::files::Memory;
use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine};
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::offline::{self, Options, Render};
use asperity_evidence::corpus::corpus;
use std::path::Path;

const STROKE_S: f64 = 0.6;

/// Reported 60 times a second under a force that may change on its way.
pub fn slanting_stroke(speed_m_s: f64, normal_force_n: impl Fn(f64) -> f64) -> ContactLog {
    let (u, v) = (0.8 * speed_m_s, 0.6 * speed_m_s);
    let sample = |t: f64| ContactSample {
        uv: [0.05 + u * t / SIDE_M, 0.1 + v * t / SIDE_M],
        velocity_m_s: Some([u, v]),
        normal_force_n: normal_force_n(t),
        ..ContactSample::default()
    };
    let mut lines = vec![LogLine { t: 0.0, event: LogEvent::begin(1, "s", 0, sample(0.0)) }];
    lines.extend((1..36).map(|step| {
        let t = f64::from(step) / 60.0;
        LogLine { t, event: LogEvent::moved(1, sample(t)) }
    }));
    lines.push(LogLine { t: STROKE_S, event: LogEvent::End { contact: 1 } });
    ContactLog { lines }
}

/// A ceramic plate; `ground` and `actuator` are keys of their tables.
pub fn ceramic_scene(probe: &str, ground: &str, actuator: &str) -> String {
    format!(
        "[[body]]\nname = \"b\"\nstock = \"plate\"\nsize_m = {SIDE_M}\nmaterial = \"ceramic\"\n\
         [[surface]]\nname = \"s\"\nbody = \"b\"\n{ground}\nwidth_m = {SIDE_M}\nheight_m = {SIDE_M}\n\
         [probe]\npreset = \"{probe}\"\n[[actuator]]\n{actuator}\n"
    )
}

pub fn open(toml: &str, files: &Memory) -> Engine {
    let file = SceneFile::parse(toml, Path::new("scene.toml")).unwrap();
    Engine::from_scene(&file, &Overrides { files, ..Overrides::default() }).unwrap()
}

pub fn rendered(engine: Engine, log: &ContactLog, block: usize) -> Render {
    let Engine { scene, renderer, names, .. } = engine;
    let options = Options { tail_s: 0.0, block_frames: block, ..Options::default() };
    offline::render(scene, renderer, log, &names, &options).unwrap()
}

/// Micro-relief of these roughnesses, granite, and a rock and a fabric of the corpus, this high:
/// names and keys.
pub fn grounds(roughnesses: &[f64], relief_m: f64, files: &mut Memory) -> Vec<(String, String)> {
    let mut grounds: Vec<(String, String)> =
        roughnesses.iter().map(|r| (format!("R {r}"), format!("roughness = {r}"))).collect();
    grounds.push(("granite".to_owned(), "solid = \"granite\"".to_owned()));
    for name in ["Rock003_1K-PNG_Displacement.png", "Fabric061_1K-PNG_Displacement.png"] {
        if let Some(file) = corpus(&format!("textures/{name}")) {
            files.add(name, std::fs::read(file).unwrap());
            grounds
                .push((name[..7].to_owned(), format!("displacement = \"{name}\"\nrelief_m = {relief_m:e}")));
        }
    }
    grounds
}
