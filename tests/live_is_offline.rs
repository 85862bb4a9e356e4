//! A log rendered live, block by block with a device's clock, gives the same samples as the same
//! log rendered offline.

use crate::common;

use asperity::files::contact_log::ContactLog;
use asperity::files::contact_log::Names;
use asperity::offline::{self, Options};
use asperity::{ClockMode, Config, Scene};
use common::{SIDE_M, bar, plate, stroke_of};
use std::collections::HashMap;

fn scene_of(config: Config) -> (Scene, asperity::Renderer, Names) {
    let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(plate(0.9).body(body)).unwrap();
    let names = Names {
        surfaces: HashMap::from([("s".to_owned(), surface)]),
        bodies: HashMap::from([("b".to_owned(), body)]),
        ..Default::default()
    };
    (scene, renderer, names)
}

fn two_fingers() -> ContactLog {
    let mut lines = stroke_of(1, SIDE_M, 0.1, 0.6, 0.5).lines;
    lines.extend(stroke_of(2, SIDE_M, 0.23, 1.1, 0.4).lines);
    lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    ContactLog { lines }
}

#[test]
fn a_recorded_live_run_matches_its_offline_render_to_the_bit() {
    let log = two_fingers();
    let block_frames = 128;
    let (mut scene, mut renderer, names) = scene_of(Config { clock: ClockMode::LIVE, ..Config::default() });
    scene.start_recording(&names);
    let mut lines = log.lines.iter().peekable();
    let (mut haptic, mut audio) = (Vec::new(), Vec::new());
    while audio.len() < 40_000 {
        // The game reports what happens during the coming block before the device asks for it; its
        // clock began somewhere else and runs 100 ppm fast.
        let block_end_s = (renderer.position() as f64 + f64::from(block_frames)) / renderer.sample_rate_hz();
        while let Some(line) = lines.next_if(|line| line.t < block_end_s) {
            let game_s = 77.7 + 1.0001 * line.t;
            scene.report(game_s, line.event.resolve(&names).unwrap()).unwrap();
        }
        let (mut h, mut a) = (vec![0.0f32; 128], vec![0.0f32; 128]);
        renderer.render(&mut [&mut h], &mut [&mut a]);
        haptic.extend(h);
        audio.extend(a);
    }
    assert_eq!((scene.stats().late, scene.stats().clock_jumps), (0, 0));
    let recorded = scene.stop_recording();
    assert_eq!(recorded.lines.len(), log.lines.len());
    // The recording survives its file.
    let mut text = Vec::new();
    recorded.write(&mut text).unwrap();
    let recorded = ContactLog::parse(std::str::from_utf8(&text).unwrap(), "recording").unwrap();

    let (scene, offline_renderer, names) = scene_of(Config::default());
    let options = Options { block_frames: 4096, tail_s: 0.2, ..Options::default() };
    let offline = offline::render(scene, offline_renderer, &recorded, &names, &options).unwrap();
    let latency = renderer.latency_samples();
    let frames = offline.audio[0].len().min(audio.len() - latency);
    assert!(frames > 30_000 && common::peak(&offline.audio[0]) > 0.0);
    let same = |live: &[f32], offline: &[f32]| live[latency..latency + frames] == offline[..frames];
    assert!(same(&audio, &offline.audio[0]), "audio differs");
    assert!(same(&haptic, &offline.haptic[0]), "haptics differ");
}
