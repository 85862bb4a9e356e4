//! Randomised events, swaps, removals, ports and late blocks, on one thread and on
//! several, through every call of the audio half, rendered inside functions that the real-time
//! sanitizer watches: any allocation, lock or blocking system call in them ends the program with a
//! trace.

#[path = "../../common/mod.rs"]
mod common;
#[path = "../../common/random_game.rs"]
#[allow(dead_code)]
mod random_game;

use asperity::live::channel_map::{ChannelMap, Interleaver};
use asperity::live::ports::{
    Feed, Levels, LevelsPort, Pcm, PcmPort, PointSettings, Points, PointsPort, Tone,
};
use asperity::{ChannelId, Config, ContactBlock, Engine, Renderer, Tap};
use random_game::RandomGame;
use rtsan_standalone::nonblocking;
use std::sync::Mutex;

/// Frames of a callback.
const FRAMES: usize = 256;

/// Sums what is pressed with.
struct Pressed(f64);

impl Tap for Pressed {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.0 += block.force_n.iter().map(|[_, _, out]| out).sum::<f64>();
    }
}

#[nonblocking]
fn planes(renderer: &mut Renderer, haptic: &mut [f32], audio: &mut [f32], tap: &mut Pressed, late: bool) {
    if late {
        renderer.report_load(1.5);
        renderer.render_tapped(&mut [haptic], &mut [audio], tap);
    } else {
        renderer.report_load(0.2);
        renderer.render(&mut [haptic], &mut [audio]);
    }
}

#[nonblocking]
fn interleaved(device: &mut Interleaver, out: &mut [f32]) {
    device.fill(out, 4);
}

#[nonblocking]
fn read(ports: &mut (PcmPort, LevelsPort, PointsPort), felt: &mut [f32]) -> usize {
    while ports.1.read().is_some() {}
    while ports.2.read().is_some() {}
    ports.0.read(felt)
}

/// A game of so many threads until `ends_s`, and once at another rate.
fn play(seed: u64, threads: usize, ends_s: f64) {
    let (mut game, renderer) = RandomGame::with(seed, Config { threads, ..Config::default() });
    let map = ChannelMap::stereo_then_haptics(renderer.haptic_channels());
    let mut device = Interleaver::new(renderer, map.clone());
    let (mut haptic, mut audio, mut out) = ([0.0; FRAMES], [0.0; FRAMES], [0.0; 4 * FRAMES]);
    let (mut tap, mut rate_hz, mut began_s, mut blocks) = (Pressed(0.0), 48_000.0, 0.0, 0u64);
    let from = Feed::Haptic(ChannelId(0));
    let open = |game: &mut RandomGame| {
        let pcm = game.scene.open_port(Pcm { from, holds_s: 0.1 });
        let levels = game.scene.open_port(Levels { from, rate_hz: 30.0, holds_s: 0.1 });
        let settings = PointSettings { rate_hz: 100.0, band_hz: [50.0, 300.0], tone: Tone::Strongest };
        let points = game.scene.open_port(Points { from, settings, holds_s: 0.1 });
        (pcm.expect("a port"), levels.expect("a port"), points.expect("a port"))
    };
    let mut ports = open(&mut game);
    while game.time_s < ends_s {
        game.step();
        while (device.renderer().position() as f64)
            < (game.time_s - began_s) * device.renderer().sample_rate_hz()
        {
            blocks += 1;
            if blocks.is_multiple_of(3) {
                interleaved(&mut device, &mut out);
            } else {
                let late = blocks % 200 < 80;
                planes(device.renderer(), &mut haptic, &mut audio, &mut tap, late);
            }
            read(&mut ports, &mut out);
        }
        game.scene.collect();
        if rate_hz > 0.0 && game.time_s > 0.5 * ends_s {
            let renderer =
                game.scene.at_rate(device.into_renderer(), rate_hz).expect("a usual rate").renderer;
            began_s = game.time_s - renderer.position() as f64 / rate_hz;
            device = Interleaver::new(renderer, map.clone());
            (ports, rate_hz) = (open(&mut game), 0.0);
        }
    }
    let stats = game.scene.stats();
    assert!(stats.shed > 0 && stats.events > 1000 && tap.0 > 0.0, "not everything was tried: {stats:?}");
    println!(
        "{threads} threads, {blocks} blocks: no blocking call; {} events, {} shed",
        stats.events, stats.shed
    );
}

#[nonblocking]
fn allocates() -> usize {
    std::hint::black_box(vec![0u8; 1000]).len()
}

#[nonblocking]
fn locks(by: &Mutex<usize>) -> usize {
    // Somebody holds it: waiting for it asks the system.
    std::hint::black_box(by).lock().map_or(0, |held| *held)
}

fn main() {
    rtsan_standalone::ensure_initialized();
    match std::env::args().nth(1).as_deref() {
        Some("--broken") => println!("{} bytes allocated unnoticed: the sanitizer is off", allocates()),
        Some("--locked") => {
            let by = Mutex::new(1);
            std::thread::scope(|scope| {
                let held = by.lock();
                scope.spawn(|| println!("{} locked unnoticed: the sanitizer is off", locks(&by)));
                std::thread::sleep(std::time::Duration::from_millis(200));
                drop(held);
            });
        }
        _ => {
            play(11, 1, 20.0);
            play(12, 3, 20.0);
            let Engine { mut scene, mut renderer, .. } =
                Config::default().build().expect("the default config");
            let (mut haptic, mut audio) = ([0.0; FRAMES], [0.0; FRAMES]);
            scene.set_muted(true).expect("there is room");
            planes(&mut renderer, &mut haptic, &mut audio, &mut Pressed(0.0), false);
        }
    }
}
