//! A scene need not lie on a disk: files from memory, pictures that the game has decoded already.

use asperity::files::contact_log::ContactLog;
use asperity::files::contact_log::{LogEvent, LogLine};
use asperity::files::{Files, Memory};
use asperity::offline::{self, Options, Render};
use asperity::surface::picture::{Picture, Samples};
use asperity::{ContactSample, Engine};
use std::borrow::Cow;
use std::cell::RefCell;
use std::path::{Path, PathBuf};

const MODES: &str = r#"{"format":"asperity.modes","version":1,
    "modes":[{"frequency_hz":812.0,"decay_per_s":12.0,"amplitude":40.0}]}"#;
const DEVICE: &str = "label = \"mine\"\nresonance_hz = 160.0\nquality = 6.0\nfelt_at_resonance_m = 1e-5\n\
    excursion_m = 2e-5\nband_hz = [60.0, 400.0]\nrated_drive = 0.7\nthermal_time_s = 5.0\n";
const SCENE: &str = r#"
[[body]]
name = "tile"
modes = "../tile.modes.json"
[[surface]]
name = "tiles"
body = "tile"
displacement = "maps/disp.png"
channel = "g"
roughness = "maps/rough.png"
width_m = 0.05
height_m = 0.05
relief_m = 1e-3
[[actuator]]
equalise = "mine.toml"
"#;

/// Bumps of 64 texels, red only noise, green what counts.
fn bumps() -> Picture {
    let texel = |i: u32| {
        let (x, y) = (i % 64, i / 64);
        [
            (i * 37 % 251) as u8,
            (127.0 + 120.0 * (f64::from(x) * 0.7).sin() * (f64::from(y) * 0.4).cos()) as u8,
            9,
        ]
    };
    Picture::new(64, 64, Samples::U8((0..64 * 64).flat_map(texel).collect())).unwrap()
}

fn memory() -> Memory {
    let mut files = Memory::new();
    files.add("level/scene.toml", SCENE);
    files.add("tile.modes.json", MODES);
    files.add("level/mine.toml", DEVICE);
    files.add_picture("level/maps/disp.png", bumps());
    files.add_picture("level/maps/rough.png", Picture::new(1, 1, Samples::F32(vec![0.7])).unwrap());
    files
}

fn stroke(engine: Engine) -> Render {
    let sample = |t: f64| ContactSample {
        uv: [0.1 + 2.0 * t, 0.4],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.02,
        ..ContactSample::default()
    };
    let mut lines = vec![LogLine { t: 0.0, event: LogEvent::begin(1, "tiles", 0, sample(0.0)) }];
    lines.extend((1..20).map(|i| {
        let t = f64::from(i) / 60.0;
        LogLine { t, event: LogEvent::moved(1, sample(t)) }
    }));
    let Engine { scene, renderer, names, .. } = engine;
    offline::render(scene, renderer, &ContactLog { lines }, &names, &Options::default()).unwrap()
}

#[test]
fn a_scene_in_memory_is_felt_and_heard_without_a_decoder() {
    let render = stroke(Engine::open_from(&memory(), "level/scene.toml").unwrap());
    let peak = |channel: &[f32]| channel.iter().fold(0.0_f32, |peak, x| peak.max(x.abs()));
    assert!(peak(&render.haptic[0]) > 1e-3 && peak(&render.audio[0]) > 1e-6);
}

#[cfg(feature = "image")]
#[test]
fn decoded_pictures_give_the_bits_of_their_files() {
    let folder = std::env::temp_dir().join(format!("asperity-storage-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("level/maps")).unwrap();
    for (name, text) in [("level/scene.toml", SCENE), ("tile.modes.json", MODES), ("level/mine.toml", DEVICE)]
    {
        std::fs::write(
            folder.join(name),
            text.replace("rough.png\"", "rough.png\"\nroughness_channel = \"luma\""),
        )
        .unwrap();
    }
    let green = bumps().channel(asperity::surface::picture::Channel::G).unwrap().raster.values;
    let texels: Vec<u8> = green.iter().flat_map(|g| [3, (255.0 * g).round() as u8, 9]).collect();
    image::RgbImage::from_raw(64, 64, texels).unwrap().save(folder.join("level/maps/disp.png")).unwrap();
    let rough = image::GrayImage::from_pixel(1, 1, image::Luma([51]));
    rough.save(folder.join("level/maps/rough.png")).unwrap();

    let mut files = memory();
    files.add_picture("level/maps/rough.png", Picture::new(1, 1, Samples::U8(vec![51])).unwrap());
    let from_disk = stroke(Engine::open(folder.join("level/scene.toml")).unwrap());
    let from_memory = stroke(Engine::open_from(&files, "level/scene.toml").unwrap());
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(from_disk.haptic == from_memory.haptic && from_disk.audio == from_memory.audio);
}

/// Notes what is asked for.
struct Asked<'a>(&'a Memory, RefCell<Vec<PathBuf>>);

impl Files for Asked<'_> {
    fn read(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        self.1.borrow_mut().push(path.to_owned());
        self.0.read(path)
    }

    fn picture(&self, path: &Path) -> Option<Cow<'_, Picture>> {
        self.1.borrow_mut().push(path.to_owned());
        self.0.picture(path)
    }
}

#[test]
fn everything_a_scene_names_comes_through_the_files_it_was_opened_from() {
    let memory = memory();
    let asked = Asked(&memory, RefCell::default());
    Engine::open_from(&asked, "level/scene.toml").unwrap();
    let mut asked: Vec<String> = asked.1.borrow().iter().map(|path| path.display().to_string()).collect();
    asked.sort_unstable();
    // A scene that writes no levels is opened twice: they are found by a trial.
    asked.dedup();
    let named =
        ["level/../tile.modes.json", "level/maps/disp.png", "level/maps/rough.png", "level/mine.toml"];
    assert_eq!(asked, [named[0], named[1], named[2], named[3], "level/scene.toml"]);
}

#[test]
fn what_is_missing_is_named_with_what_would_be_right() {
    let refusal = |files: &Memory| Engine::open_from(files, "level/scene.toml").err().unwrap().to_string();
    let mut files = Memory::new();
    assert_eq!(refusal(&files), "level/scene.toml: no such file; name a file that exists");
    files.add("level/scene.toml", SCENE);
    files.add("level/mine.toml", DEVICE);
    let line = refusal(&files);
    assert!(line.contains("body \"tile\"") && line.contains("level/../tile.modes.json"), "{line}");
    files.add("tile.modes.json", MODES);
    let line = refusal(&files);
    assert!(line.contains("surface \"tiles\"") && line.contains("level/maps/disp.png: "), "{line}");
    let right =
        if cfg!(feature = "image") { "name a file that exists" } else { "hand the picture over decoded" };
    assert!(line.contains(right), "{line}");
    files.add_picture("level/maps/disp.png", Picture::new(1, 1, Samples::U8(vec![9])).unwrap());
    files.add_picture("level/maps/rough.png", Picture::new(1, 1, Samples::F32(vec![f32::NAN])).unwrap());
    assert!(refusal(&files).contains("level/maps/rough.png: the value at column 0, row 0 is not finite"));
}

#[test]
fn a_coloured_map_without_a_channel_warns_with_the_key() {
    assert!(Engine::open_from(&memory(), "level/scene.toml").unwrap().remarks.is_empty());
    let mut files = memory();
    files.add("level/scene.toml", SCENE.replace("channel = \"g\"\n", ""));
    let remarks = Engine::open_from(&files, "level/scene.toml").unwrap().remarks;
    assert_eq!(remarks.len(), 1, "{remarks:?}");
    assert!(
        remarks[0].contains("disp.png: is coloured") && remarks[0].contains("channel = \"r\""),
        "{remarks:?}"
    );
}
