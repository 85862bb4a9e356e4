//! A changed scene file changes what sounds, without a step, or says in words why not.

use asperity::files::Memory;
use asperity::files::contact_log::Names;
use asperity::files::scene_file::SceneFile;
use asperity::load::Overrides;
use asperity::{ChannelId, ContactEvent, ContactId, ContactSample, Engine, Impact, Renderer, Scene};
use std::path::Path;

const SCENE: &str = r#"
[[body]]
name = "bell"
stock = "bar"
size_m = 0.2
material = "brass"
[[surface]]
name = "plate"
body = "bell"
solid = "granite"
micro_relief_m = 0.0
width_m = 0.1
height_m = 0.1
[[actuator]]
full_scale = 1e-4
[audio]
gain = 0.5
"#;

fn file(text: &str) -> SceneFile {
    SceneFile::parse(text, Path::new("scene.toml")).unwrap()
}

struct Game {
    scene: Scene,
    renderer: Renderer,
    names: Names,
    step: u32,
}

impl Game {
    fn new() -> Self {
        let Engine { scene, renderer, names, .. } =
            Engine::from_scene(&file(SCENE), &Overrides::default()).unwrap();
        Self { scene, renderer, names, step: 0 }
    }

    /// A tick of a slow stroke: what is felt and heard of it.
    fn tick(&mut self) -> [Vec<f32>; 2] {
        let t = f64::from(self.step) / 60.0;
        let sample = ContactSample {
            uv: [0.1 + 0.3 * t, 0.4],
            velocity_m_s: Some([0.03, 0.0]),
            normal_force_n: 0.8,
            closing_m_s: 0.0,
            ..ContactSample::default()
        };
        let event = match self.step {
            0 => ContactEvent::begin(ContactId(1), self.names.surfaces["plate"], ChannelId(0), sample),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        self.scene.report(t, event).unwrap();
        self.step += 1;
        let [mut haptic, mut audio] = [vec![0.0f32; 735], vec![0.0f32; 735]];
        self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        [haptic, audio]
    }

    fn apply(&mut self, before: &str, after: &str) -> asperity::load::Changes {
        self.scene.apply(&mut self.names, &file(before), &file(after), &Overrides::default()).unwrap()
    }
}

/// Thirty ticks, with a change after the fifteenth: haptic and audio.
fn run(after: Option<&str>) -> [Vec<f32>; 2] {
    let mut game = Game::new();
    let mut all = [Vec::new(), Vec::new()];
    for step in 0..30 {
        if let Some(after) = after.filter(|_| step == 15) {
            game.apply(SCENE, after);
        }
        let ticked = game.tick();
        all.iter_mut().zip(ticked).for_each(|(all, ticked)| all.extend(ticked));
    }
    all
}

/// Largest difference of neighbouring samples.
fn steepest(samples: &[f32]) -> f32 {
    samples.windows(2).fold(0.0, |most, w| most.max((w[1] - w[0]).abs()))
}

#[test]
fn what_can_change_while_it_sounds_changes_without_a_step() {
    let still = run(None);
    for (what, after) in [
        ("a gain", SCENE.replace("gain = 0.5", "gain = 0.05")),
        ("a surface", SCENE.replace("\"granite\"", "{ preset = \"granite\", amplitude_m = 2e-6 }")),
        ("a body", SCENE.replace("size_m = 0.2", "size_m = 0.25")),
    ] {
        let changed = run(Some(&after));
        let at = 15 * 735;
        assert!(changed.iter().zip(&still).all(|(a, b)| a[..at] == b[..at]), "{what} changes the past");
        assert!(
            changed.iter().zip(&still).any(|(a, b)| a[at + 2000..] != b[at + 2000..]),
            "{what} changes nothing"
        );
        // Another relief under the finger pushes it, and the body sounds of that: what is felt of
        // it has no step.
        let channels = if what == "a surface" { 1 } else { 2 };
        for (channel, still) in changed.iter().zip(&still).take(channels) {
            let around = &channel[at - 100..at + 1500];
            let range =
                around.iter().fold([f32::MAX, f32::MIN], |[low, high], x| [low.min(*x), high.max(*x)]);
            // A step would be all of the range; the crossfade of 20 ms takes 1/470 of it a sample
            // at most.
            let most = 1.5 * steepest(still) + (range[1] - range[0]) / 400.0;
            assert!(steepest(around) <= most, "{what}: {} a sample, at most {most}", steepest(around));
        }
    }
}

#[test]
fn a_bus_gain_is_reached_and_the_rest_is_unchanged() {
    let [still, softer] =
        [None, Some(SCENE.replace("gain = 0.5", "gain = 0.05"))].map(|after| run(after.as_deref()));
    assert_eq!(still[0], softer[0], "what is felt");
    let rms = |samples: &[f32]| samples.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
    let ratio = rms(&softer[1][17 * 735..]) / rms(&still[1][17 * 735..]);
    assert!((ratio - 0.1).abs() < 1e-4, "{ratio}");
}

#[test]
fn ids_stay_and_what_is_new_or_gone_is_told() {
    let mut game = Game::new();
    game.tick();
    let (bell, plate) = (game.names.bodies["bell"], game.names.surfaces["plate"]);
    let after = format!(
        "{}[[probe]]\nname = \"pen\"\npreset = \"stylus\"\n",
        SCENE.replace("0.2", "0.1").replace(
            "[[actuator]]",
            "[[body]]\nname = \"gong\"\nstock = \"plate\"\nsize_m = 0.4\n[[actuator]]"
        )
    );
    let changes = game.apply(SCENE, &after);
    assert_eq!(changes.done, ["probe \"pen\": added", "body \"bell\": changed", "body \"gong\": added"]);
    assert!(changes.waiting.is_empty());
    assert_eq!((game.names.bodies["bell"], game.names.surfaces["plate"]), (bell, plate));
    game.scene.report(0.5, ContactEvent::Impact(Impact::on(game.names.bodies["gong"]))).unwrap();
    let changes = game.apply(&after, SCENE);
    assert_eq!(changes.done, ["body \"bell\": changed", "body \"gong\": removed"]);
    assert_eq!(changes.waiting, ["probe: takes effect when the scene is opened again"]);
    let changes = game.apply(SCENE, &SCENE.replace("full_scale = 1e-4", "full_scale = 1e-3"));
    assert_eq!((changes.done.len(), changes.waiting.len()), (0, 1), "{:?}", changes.waiting);
}

#[test]
fn a_scene_file_that_cannot_be_used_leaves_the_old_scene_sounding() {
    let mut game = Game::new();
    let before: Vec<_> = (0..10).map(|_| game.tick()).collect();
    let broken = SCENE
        .replace("size_m = 0.2", "size_m = 0.3")
        .replace("solid = \"granite\"", "displacement = \"gone.png\"\nrelief_m = 1e-3");
    let files = Memory::new();
    let overrides = Overrides { files: &files, ..Overrides::default() };
    let refused = game
        .scene
        .apply(&mut game.names, &file(SCENE), &file(&broken), &overrides)
        .err()
        .unwrap()
        .to_string();
    assert!(refused.starts_with("scene.toml: surface \"plate\": gone.png: "), "{refused}");
    let after: Vec<_> = (0..20).map(|_| game.tick()).collect();
    let all: Vec<f32> = before.iter().chain(&after).flat_map(|[haptic, _]| haptic.clone()).collect();
    assert_eq!(all, run(None)[0]);
}
