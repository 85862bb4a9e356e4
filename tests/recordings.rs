//! A recording holds the edits of a scene, in memory or streamed to a file, and renders to the bits
//! of the game.

use asperity::files::Memory;
use asperity::files::contact_log::{ContactLog, LogEdit, LogEvent, Names};
use asperity::files::scene_file::SceneFile;
use asperity::load::{Edits, Overrides};
use asperity::offline::{self, Options};
use asperity::{
    Body, BusId, ChannelId, ClockMode, ContactEvent, ContactId, ContactSample, Engine, Extent, Impact,
    Material, NoTap, Renderer, Scene, Stock, Surface, Touching, probe_by_name,
};
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex};

const SCENE: &str = "[[body]]\nname = \"bell\"\nstock = \"bar\"\nsize_m = 0.2\n[[surface]]\nname = \"plate\"\nbody = \"bell\"\n\
    width_m = 0.1\nheight_m = 0.1\nsolid = \"granite\"\n[[audio]]\nname = \"left\"\n[[audio]]\nname = \"right\"\n";

fn file() -> SceneFile {
    SceneFile::parse(SCENE, Path::new("level/scene.toml")).unwrap()
}

/// A surface that no file describes.
fn bumps(names: &Names) -> Surface {
    let extent = Extent { width_m: 0.1, height_m: 0.1, relief_m: 2e-5 };
    let values = (0..64 * 64).map(|i| 0.5 + 0.5 * (f64::from(i) * 0.9).sin()).collect();
    let raster = asperity::surface::raster::Raster { width: 64, height: 64, values };
    let map = asperity::surface::height_map::HeightMap::new(&raster, extent, asperity::Wrap::Repeat).unwrap();
    Surface::new(map, 0.1, 0.1).unwrap().body(names.bodies["bell"])
}

struct Game {
    scene: Scene,
    renderer: Renderer,
    names: Names,
    out: [Vec<f32>; 3],
}

impl Game {
    fn new() -> Self {
        let Engine { scene, renderer, names, .. } =
            Engine::from_scene(&file(), &Overrides::default()).unwrap();
        Self { scene, renderer, names, out: Default::default() }
    }

    fn render(&mut self, frames: usize) {
        let at = self.out[0].len();
        self.out.iter_mut().for_each(|channel| channel.resize(at + frames, 0.0));
        let [haptic, left, right] = &mut self.out;
        self.renderer.render(&mut [&mut haptic[at..]], &mut [&mut left[at..], &mut right[at..]]);
    }

    /// Two seconds of a stroke in blocks of 441, edited in between.
    fn play(&mut self, own_surfaces: bool) {
        let gong = Body::new(Stock::Plate.modes(&Material::BRASS, 0.3).unwrap())
            .material(Material::BRASS)
            .bus(BusId(1));
        let sample = |t: f64| ContactSample {
            uv: [0.1 + 0.6 * t, 0.4],
            velocity_m_s: Some([0.06, 0.0]),
            normal_force_n: 0.8,
            closing_m_s: 0.02,
            ..ContactSample::default()
        };
        let mut added = None;
        for step in 0..200 {
            let t = f64::from(step) / 100.0;
            let names = &self.names;
            let (bell, plate) = (names.bodies["bell"], names.surfaces["plate"]);
            match step {
                30 => added = Some(self.scene.add_body(gong.clone()).unwrap()),
                50 => self.scene.replace_body(bell, gong.clone().bus(BusId(0))).unwrap(),
                60 => self.scene.set_body_bus(bell, BusId(1)).unwrap(),
                70 => self.scene.set_audio_gain(BusId(1), 0.3).unwrap(),
                75 => self.scene.set_haptic_gain(ChannelId(0), 0.5).unwrap(),
                80 => {
                    let softer = file_with("solid = { preset = \"granite\", amplitude_m = 3e-6 }");
                    self.scene.apply(&mut self.names, &file(), &softer, &Overrides::default()).unwrap();
                }
                110 if own_surfaces => self.scene.replace_surface(plate, bumps(&self.names)).unwrap(),
                120 => self.scene.set_body_gain(bell, 0.4).unwrap(),
                125 => self.scene.set_muted(true).unwrap(),
                132 => self.scene.set_muted(false).unwrap(),
                170 => self.scene.fade_all().unwrap(),
                150 => self.scene.remove_body(added.unwrap()).unwrap(),
                _ => {}
            }
            let probe =
                (step == 100).then(|| self.scene.add_probe(probe_by_name("stylus").unwrap()).unwrap());
            let event = match step {
                0 => ContactEvent::begin(ContactId(1), plate, ChannelId(0), sample(t)),
                100 => {
                    let touching = Touching::on(plate).felt_by(ChannelId(0)).probe(probe.unwrap());
                    ContactEvent::begin_with(ContactId(1), touching, sample(t))
                }
                _ => ContactEvent::moved(ContactId(1), sample(t)),
            };
            self.scene.report(t, event).unwrap();
            if step == 40 || step == 90 {
                self.scene.report(t, ContactEvent::Impact(Impact::on(added.unwrap()))).unwrap();
            }
            self.render(441);
        }
    }
}

fn file_with(source: &str) -> SceneFile {
    SceneFile::parse(&SCENE.replace("solid = \"granite\"", source), Path::new("level/scene.toml")).unwrap()
}

fn replay(log: &ContactLog, edits: &mut Edits<'_>) -> Result<[Vec<f32>; 3], String> {
    let Engine { scene, renderer, names, .. } = Engine::from_scene(&file(), &Overrides::default()).unwrap();
    let options = Options { block_frames: 333, tail_s: 1.0, ..Options::default() };
    let render = offline::render_edited(scene, renderer, log, &names, &options, edits, &mut NoTap);
    let render = render.map_err(|error| error.to_string())?;
    let [haptic, audio] = [render.haptic, render.audio];
    Ok([haptic[0].clone(), audio[0].clone(), audio[1].clone()])
}

/// The replay has no look-ahead in front.
fn assert_same_bits(game: &Game, replayed: &[Vec<f32>; 3]) {
    let late = game.renderer.latency_samples();
    assert!(game.out[1..].iter().flatten().any(|x| *x != 0.0));
    for (played, replayed) in game.out.iter().zip(replayed) {
        let played = &played[late..];
        let first = played.iter().zip(replayed).position(|(a, b)| a.to_bits() != b.to_bits());
        assert_eq!(first, None, "the first sample that differs, of {}", played.len());
    }
}

#[test]
fn a_recording_with_edits_renders_to_the_bits_of_the_game() {
    let mut game = Game::new();
    game.scene.start_recording(&game.names);
    game.play(false);
    let log = game.scene.stop_recording();
    let edits = log.lines.iter().filter(|line| matches!(line.event, LogEvent::Edit(_))).count();
    assert_eq!(edits, 12);
    assert!(log.lines.iter().any(
        |line| matches!(&line.event, LogEvent::Edit(LogEdit::ReplaceSurface { is, .. }) if is.is.is_some())
    ));
    let mut text = Vec::new();
    log.write(&mut text).unwrap();
    let read = ContactLog::parse(std::str::from_utf8(&text).unwrap(), "log").unwrap();
    assert_same_bits(
        &game,
        &replay(&read, &mut Edits { files: &Memory::new(), ..Edits::default() }).unwrap(),
    );
}

#[test]
fn what_no_recording_holds_is_taken_from_its_replayer() {
    let mut game = Game::new();
    game.scene.start_recording(&game.names);
    game.play(true);
    let log = game.scene.stop_recording();
    let refused = replay(&log, &mut Edits::default()).unwrap_err();
    assert!(
        refused.starts_with("t = 1.1 s: ")
            && refused.contains("surface \"plate\": the recording: cannot hold"),
        "{refused}"
    );
    let mut own = |name: &str, names: &Names| (name == "plate").then(|| bumps(names));
    let mut edits = Edits { surfaces: Some(&mut own), ..Edits::default() };
    assert_same_bits(&game, &replay(&log, &mut edits).unwrap());
}

/// A file that can be looked into while it is written.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_streamed_recording_is_on_disk_while_the_game_runs() {
    let [mut kept, mut streamed] = [Game::new(), Game::new()];
    kept.scene.start_recording(&kept.names);
    kept.play(false);
    let out = Shared::default();
    streamed.scene.stream_recording(&streamed.names, out.clone()).unwrap();
    streamed.play(false);
    let began = std::time::Instant::now();
    while out.0.lock().unwrap().len() < 10_000 && began.elapsed().as_secs() < 20 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(out.0.lock().unwrap().len() >= 10_000, "nothing is written while the game runs");
    let log = kept.scene.stop_recording();
    assert_eq!(streamed.scene.finish_recording().unwrap(), log.lines.len() as u64);
    let text = String::from_utf8(out.0.lock().unwrap().clone()).unwrap();
    assert_eq!(ContactLog::parse(&text, "stream").unwrap(), log);
}

/// A disk that is full.
struct Full;

impl Write for Full {
    fn write(&mut self, _bytes: &[u8]) -> std::io::Result<usize> {
        Err(std::io::ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_recording_that_cannot_be_written_is_reported_while_the_game_continues() {
    let mut game = Game::new();
    game.scene.stream_recording(&game.names, Full).unwrap();
    game.play(false);
    assert_eq!(game.scene.finish_recording().unwrap_err().kind(), std::io::ErrorKind::StorageFull);
    assert_eq!(game.scene.stats().dropped, 0);
}

#[test]
fn what_a_reset_drops_is_not_in_the_recording() {
    let mut game = Game::new();
    game.scene.start_recording(&game.names);
    let bell = game.names.bodies["bell"];
    game.scene.report(0.001, ContactEvent::Impact(Impact::on(bell))).unwrap();
    game.render(441);
    // It waits for a time that never comes.
    game.scene.report(5.0, ContactEvent::Impact(Impact { speed_m_s: 9.0, ..Impact::on(bell) })).unwrap();
    game.scene.reset().unwrap();
    game.render(441);
    game.scene.report(0.0, ContactEvent::Impact(Impact::on(bell))).unwrap();
    game.render(20_000);
    let log = game.scene.stop_recording();
    assert_eq!(log.lines.len(), 2);
    assert_same_bits(&game, &replay(&log, &mut Edits::default()).unwrap());
}

/// Two fingers on one plate at 60 ticks a second, each tick rendered in a block of 735 frames (44.1
/// kHz), the first one in a shorter one: the order in which an engine like Godot calls.
#[test]
fn a_live_recording_of_fingers_and_a_blow_renders_the_games_bits() {
    let file = SceneFile::parse(TWO_FINGERS, Path::new("plate.toml")).unwrap();
    let live = Overrides {
        sample_rate_hz: Some(44_100.0),
        clock: Some(ClockMode::Live { max_lead_s: 0.2 }),
        live: true,
        ..Overrides::default()
    };
    let Engine { mut scene, mut renderer, names, .. } = Engine::from_scene(&file, &live).unwrap();
    let (plate, body) = (names.surfaces["plate"], names.bodies["plate"]);
    let pressed = |uv: [f64; 2], normal_force_n: f64, velocity_m_s| ContactSample {
        uv: uv.map(|x| f64::from(x as f32)),
        normal_force_n,
        velocity_m_s,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let touching = |channel| Touching::on(plate).felt_by(ChannelId(channel));
    let mut played: [Vec<f32>; 3] = Default::default();
    scene.start_recording(&names);
    let mut t = 0.0;
    for tick in 0..200 {
        t += 1.0 / 60.0;
        let along = f64::from(tick);
        let mut report = |event| scene.report(t, event).unwrap();
        match tick {
            10 => {
                report(ContactEvent::begin_with(ContactId(1), touching(0), pressed([0.2, 0.5], 0.6, None)));
                report(ContactEvent::begin_with(ContactId(2), touching(1), pressed([0.3, 0.3], 0.4, None)));
            }
            11..180 => {
                let first = pressed([0.2 + 0.003 * along, 0.5], 0.6, None);
                let second = pressed([0.3, 0.3 + 0.002 * along], 0.4, Some([0.0, f64::from(0.036_f32)]));
                report(ContactEvent::moved(ContactId(1), first));
                report(ContactEvent::moved(ContactId(2), second));
            }
            180 => [1, 2].map(|n| report(ContactEvent::End { contact: ContactId(n) })).into_iter().collect(),
            _ => {}
        }
        if tick == 90 {
            let blow = Impact { speed_m_s: 0.5, mass_kg: 0.01, radius_m: 0.005, ..Impact::on(body) };
            report(ContactEvent::Impact(Impact { actuator: Some(ChannelId(0)), ..blow }));
        }
        let frames = if tick == 10 { 612 } else { 735 };
        let at = played[0].len();
        played.iter_mut().for_each(|channel| channel.resize(at + frames, 0.0));
        let [first, second, audio] = &mut played;
        renderer.render(&mut [&mut first[at..], &mut second[at..]], &mut [&mut audio[at..]]);
    }
    let mut text = Vec::new();
    scene.stop_recording().write(&mut text).unwrap();
    let log = ContactLog::parse(std::str::from_utf8(&text).unwrap(), "log").unwrap();
    assert_eq!((scene.stats().late, scene.stats().refused, scene.stats().clock_jumps), (0, 0, 0));

    let exact = Overrides { clock: Some(ClockMode::Exact), ..live };
    let Engine { scene, renderer: again, names, .. } = Engine::from_scene(&file, &exact).unwrap();
    let render = offline::render(scene, again, &log, &names, &Options::default()).unwrap();
    let late = renderer.latency_samples();
    let rendered = [&render.haptic[0], &render.haptic[1], &render.audio[0]];
    for (played, rendered) in played.iter().zip(rendered) {
        let pairs = played[late..].iter().zip(rendered);
        let first = pairs.clone().position(|(a, b)| a.to_bits() != b.to_bits());
        let off = pairs.fold(0.0_f32, |worst, (a, b)| worst.max((a - b).abs()));
        assert_eq!(first, None, "the first sample that differs, of {}; at most {off:e} off", played.len());
    }
}

const TWO_FINGERS: &str = "[[body]]\nname = \"plate\"\nstock = \"plate\"\nsize_m = 0.3\nmaterial = \"steel\"\n[[surface]]\n\
    name = \"plate\"\nbody = \"plate\"\nwidth_m = 0.3\nheight_m = 0.3\nroughness = 0.7\n[[actuator]]\n[[actuator]]\n";
