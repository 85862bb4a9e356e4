//! Fuzz targets, which must survive any bytes: reading them, and using whatever they are taken for.
//! A target panics when it finds a fault. What each door is given first lies in `seeds/`.
#![allow(dead_code)]

use asperity::files::Memory;
use asperity::files::contact_log::{ContactLog, Names};
use asperity::files::scene_file::SceneFile;
use asperity::live::channel_map::ChannelMap;
use asperity::load::Overrides;
use asperity::offline::{self, Options};
use asperity::{ActuatorPreset, Config, Engine, Extent, ModalModel, Scene, Surface, Wrap};
use asperity_surface::height_map::HeightMap;
use asperity_surface::image_io::{self, Channel};
use asperity_surface::picture::{Picture, Samples};
use asperity_surface::raster::Raster;
use std::collections::HashMap;
use std::path::Path;

/// A door's name, and what any bytes do there.
pub type Door = (&'static str, fn(&[u8]));

/// Doors of the engine: a name, and what any bytes do there.
pub const DOORS: &[Door] = &[
    ("log", log),
    ("modes", modes),
    ("shapes", shapes),
    ("scene", scene),
    ("parts", parts),
    ("actuator", actuator),
    ("channels", channel_map),
    ("png", image),
    ("jpeg", image),
    ("gif", image),
    ("pgm", image),
    ("exr", image),
    ("tiff", image),
    ("webp", image),
    ("tga", image),
    ("bmp", image),
];

/// Modes that a scene may name.
const MODES: &str = r#"{"format":"asperity.modes","version":1,"modes":[{"frequency_hz":700,"decay_per_s":9,"amplitude":0.4}]}"#;

/// Longest log that is rendered, s.
const LONGEST_S: f64 = 2.0;

/// A refusal is one line.
pub fn one_line(refused: &impl std::fmt::Display) {
    let text = refused.to_string();
    assert!(!text.is_empty() && !text.contains('\n'), "an error is one line: {text}");
}

/// Hands `read` a file of these bytes.
pub fn as_file(ending: &str, data: &[u8], read: impl FnOnce(&Path)) {
    let name = format!("asperity-fuzz-{}-{:?}.{ending}", std::process::id(), std::thread::current().id());
    let path = std::env::temp_dir().join(name);
    if std::fs::write(&path, data).is_ok() {
        read(&path);
        let _ = std::fs::remove_file(&path);
    }
}

fn flat() -> Surface {
    let extent = Extent { width_m: 0.1, height_m: 0.1, relief_m: 1.0 };
    let map = HeightMap::flat(extent, 0.5).expect("a plane is a map");
    Surface::new(map, 0.1, 0.1).expect("a size that is accepted")
}

/// Renders a log on a body and demands numbers.
fn render(model: ModalModel, log: &ContactLog) {
    let Engine { mut scene, renderer, .. } =
        Config::default().build().expect("the default config is accepted");
    let Ok(body) = scene.add_body(model) else { return };
    let surface = scene.add_surface(flat().body(body)).expect("a surface that is accepted");
    let names = Names {
        surfaces: HashMap::from([("tiles".to_owned(), surface)]),
        bodies: HashMap::from([("tile".to_owned(), body)]),
        ..Default::default()
    };
    if log.end_s().is_nan() || log.end_s() > LONGEST_S {
        return;
    }
    if let Ok(take) = offline::render(
        scene,
        renderer,
        log,
        &names,
        &Options { block_frames: 256, tail_s: 0.01, ..Options::default() },
    ) {
        assert!(take.audio[0].iter().chain(take.haptic.iter().flatten()).all(|x| x.is_finite()));
    }
}

/// A contact log, read and rendered.
pub fn log(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(log) = ContactLog::parse(text, "fuzz.jsonl") {
        let mut written = Vec::new();
        log.write(&mut written).expect("memory takes all");
        let again = std::str::from_utf8(&written).expect("a log is text");
        assert_eq!(ContactLog::parse(again, "again").as_ref().ok(), Some(&log), "a log survives its file");
        let mode = asperity::Mode { frequency_hz: 700.0, decay_per_s: 9.0, amplitude: 0.4, phase_rad: 0.0 };
        render(ModalModel::new(vec![mode], 0.01).expect("a mode that is accepted"), &log);
    }
}

/// A modes file, read and struck.
pub fn modes(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(model) = ModalModel::parse(text) {
        assert_eq!(
            ModalModel::parse(&model.to_json()).ok().as_ref(),
            Some(&model),
            "modes survive their file"
        );
        let strike = r#"{"t":0.001,"event":"impact","body":"tile","speed_m_s":0.8,"mass_kg":0.01,"radius_m":0.005,"striker":"steel"}"#;
        render(model, &ContactLog::parse(strike, "strike").expect("a log that is accepted"));
    }
}

/// A picture, read and made a map.
pub fn image(data: &[u8]) {
    let picture = match image_io::read_channel(data, Channel::Luma) {
        Ok(picture) => picture,
        Err(refused) => return one_line(&refused),
    };
    let Raster { width, height, ref values } = picture.raster;
    assert!(width > 0 && height > 0 && values.len() == width * height);
    assert!(values.iter().all(|v| v.is_finite()));
    if values.len() < 1 << 14 {
        let extent = Extent { width_m: 0.1, height_m: 0.1, relief_m: 1e-3 };
        HeightMap::new(&picture.debanded(Wrap::Repeat), extent, Wrap::Repeat).expect("a picture is a map");
    }
}

/// A scene file, read; and built with what it names, where that is small.
pub fn scene(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let read = SceneFile::parse(text, Path::new("scene.toml"));
    let file = match read {
        Ok(file) => file,
        Err(refused) => return one_line(&refused),
    };
    // Grids of millions of cells take seconds to make.
    if text.contains("cells") || text.contains("sand") || text.contains("brownian") {
        return;
    }
    let mut files = Memory::new();
    files.add("tile.modes.json", MODES);
    let grey = Picture::new(4, 4, Samples::U8((0..16).collect())).expect("sixteen samples");
    files.add_picture("grey.png", grey);
    let overrides = Overrides { files: &files, ..Overrides::default() };
    match Engine::from_scene(&file, &overrides) {
        Ok(Engine { mut renderer, .. }) => {
            let (mut haptic, mut audio) = ([0.0; 64], [0.0; 64]);
            renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            assert!(haptic.iter().chain(&audio).all(|x| x.is_finite()));
        }
        Err(refused) => one_line(&refused),
    }
}

/// Keys of one body, surface and probe, as bindings take them.
fn parts(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if text.contains("cells") || text.contains("sand") || text.contains("brownian") {
        return;
    }
    let Engine { mut scene, names, .. } = Config::default().build().expect("the default config is accepted");
    let files = Memory::new();
    let overrides = Overrides { files: &files, ..Overrides::default() };
    match scene.read_body(text, Path::new(""), &overrides) {
        Ok(body) => drop(scene.add_body(body).expect("a body that was read is accepted")),
        Err(refused) => one_line(&refused),
    }
    match scene.read_surface(text, Path::new(""), None, &names, &overrides) {
        Ok(read) => drop(scene.add_surface(read.surface).expect("a surface that was read is accepted")),
        Err(refused) => one_line(&refused),
    }
    match Scene::read_probe(text) {
        Ok(probe) => drop(scene.add_probe(probe)),
        Err(refused) => one_line(&refused),
    }
}

/// Shapes beside a modes file, packed or as `.glb`.
fn shapes(data: &[u8]) {
    match asperity::shapes_from_bytes(data, 2) {
        Ok(shapes) => {
            for name in ["a.shapes", "a.glb"] {
                let again = asperity::shapes_from_bytes(&asperity::shapes_to_file(&shapes, name), 2);
                again.expect("shapes survive their file");
            }
        }
        Err(refused) => one_line(&refused),
    }
}

fn actuator(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Err(refused) = ActuatorPreset::parse(text, "fuzz.toml") {
        one_line(&refused);
    }
}

fn channel_map(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match ChannelMap::parse(text) {
        Ok(map) => assert!(map.width() > 0),
        Err(refused) => one_line(&refused),
    }
}
