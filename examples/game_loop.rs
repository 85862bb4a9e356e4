//! A game loop at 60 Hz with asperity in it: paste from here.
//!
//! ```sh
//! cargo run --release --example game_loop                      # silent, on any machine
//! cargo run --release --example game_loop -- FOLDER            # the same, and FOLDER/game_loop.wav to listen to
//! cargo run --release --example game_loop --features device    # through the sound card
//! ```
//!
//! A finger circles over a grooved plate for three seconds, lifts off, and a steel ball hits the
//! plate.
//!
//! In a game of your own paste these lines into the `Cargo.toml` of the workspace as well: an
//! unoptimised development build renders three objects at 0.9 times real time and crackles.
//!
//! ```toml
//! [profile.dev.package.asperity]
//! opt-level = 3
//! [profile.dev.package.asperity-dsp]
//! opt-level = 3
//! [profile.dev.package.asperity-surface]
//! opt-level = 3
//! [profile.dev.package.libm]
//! opt-level = 3
//! ```

use asperity::offline::{self, Options};
use asperity::surface::height_map::HeightMap;
use asperity::surface::raster::Raster;
use asperity::{
    Body, BodyId, ChannelId, ClockMode, Config, ContactEvent, ContactId, ContactSample, Engine, Extent,
    Impact, Material, ModalModel, Mode, Scene, Surface, SurfaceId, Wrap,
};
use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Side of the plate, m.
const SIDE_M: f64 = 0.14;
/// The physics step.
const STEP: Duration = Duration::from_micros(16_667);

fn main() -> Result<(), Box<dyn Error>> {
    // 1. LIVE ties game time to the audio clock; ask the device for its rate first.
    let Engine { mut scene, renderer, names, .. } = setup(ClockMode::LIVE)?;
    let (tile, plate) = (names.bodies["tile"], names.surfaces["plate"]);
    scene.start_recording(&names);

    // 3. Hand the audio half to the sound card.
    let output = start(renderer)?;

    // 4. The game loop: report what the physics found. Nothing here ever waits for the audio.
    let mut finger = Finger { touching: false };
    let mut struck = false;
    let began = Instant::now();
    while began.elapsed() < Duration::from_millis(3500) {
        let time_s = began.elapsed().as_secs_f64();
        finger.step(&mut scene, plate, time_s)?;
        if time_s > 3.1 && !struck {
            struck = true;
            report(&mut scene, time_s, steel_ball_on(tile))?;
        }
        scene.collect(); // frees what the audio half no longer needs
        std::thread::sleep(STEP);
    }

    // 5. What happened.
    let stats = scene.stats();
    println!(
        "{} events, {} impacts, {} micro-collisions, {} late, {} dropped; load {:.1} %",
        stats.events,
        stats.impacts,
        stats.micro_collisions,
        stats.late,
        stats.dropped,
        100.0 * stats.load
    );
    stop(output);

    // 6. What was recorded sounds the same offline.
    if let Some(folder) = std::env::args().nth(1).map(PathBuf::from) {
        let log = scene.stop_recording();
        let Engine { scene, renderer, names, .. } = setup(ClockMode::Exact)?;
        let take = offline::render(scene, renderer, &log, &names, &Options::default())?;
        std::fs::create_dir_all(&folder)?;
        take.write_audio_wav(folder.join("game_loop.wav"))?;
        println!("{}", folder.join("game_loop.wav").display());
    }
    Ok(())
}

/// 2. Build the engine; say what can be touched, and what rings when it is.
fn setup(clock: ClockMode) -> Result<Engine, Box<dyn Error>> {
    // Levels are found as things are added, and a limiter stands behind: a sound card clips at ±1.
    let config = Config { clock, ..Config::live(rate_hz()) };
    let mut engine = config.build()?;
    let tile = engine.scene.add_body(Body::new(tile()?).material(Material::CERAMIC))?; // or Body::stock(…)
    let plate = engine.scene.add_surface(grooves()?.body(tile))?; // or Surface::from_maps("disp.png", "rough.png", …)
    engine.names.bodies.insert("tile".into(), tile);
    engine.names.surfaces.insert("plate".into(), plate);
    Ok(engine)
}

/// A finger as the game knows it; your physics engine's contact goes here.
struct Finger {
    touching: bool,
}

impl Finger {
    fn step(&mut self, scene: &mut Scene, plate: SurfaceId, time_s: f64) -> Result<(), Box<dyn Error>> {
        let id = ContactId(1);
        let touches = time_s < 3.0;
        // A circle of 3 cm, once a second.
        let (radius_m, turn) = (0.03, std::f64::consts::TAU * time_s);
        let speed_m_s = radius_m * std::f64::consts::TAU;
        let uv = [0.5 + radius_m * turn.cos() / SIDE_M, 0.5 + radius_m * turn.sin() / SIDE_M];
        let velocity_m_s = [-speed_m_s * turn.sin(), speed_m_s * turn.cos()];
        let sample = ContactSample::new(uv, 0.6).sliding(velocity_m_s).landing(0.03);
        let event = match (self.touching, touches) {
            (false, true) => ContactEvent::begin(id, plate, ChannelId(0), sample),
            (true, true) => ContactEvent::moved(id, sample),
            (true, false) => ContactEvent::end(id),
            (false, false) => return Ok(()),
        };
        self.touching = touches;
        report(scene, time_s, event)
    }
}

/// A full queue hands the event back: drop it, the next step reports again. A lost end fades by
/// itself.
fn report(scene: &mut Scene, time_s: f64, event: ContactEvent) -> Result<(), Box<dyn Error>> {
    match scene.report(time_s, event) {
        Err(refused) if refused.reason == asperity::Refusal::QueueFull => Ok(()),
        outcome => Ok(outcome?),
    }
}

fn steel_ball_on(body: BodyId) -> ContactEvent {
    ContactEvent::Impact(Impact::on(body).striker(Material::STEEL, 0.01, 0.005).at_speed(0.8).rebounding(0.8))
}

/// A tile of four modes; `ModalModel::load("tile.modes.json")` reads what `asperity fit` wrote.
fn tile() -> Result<ModalModel, Box<dyn Error>> {
    let mode =
        |frequency_hz, decay_per_s, amplitude| Mode { frequency_hz, decay_per_s, amplitude, phase_rad: 0.0 };
    let modes = vec![
        mode(812.0, 14.0, 0.31),
        mode(1874.0, 22.0, 0.2),
        mode(3120.0, 35.0, 0.12),
        mode(4710.0, 60.0, 0.06),
    ];
    Ok(ModalModel::new(modes, 0.01)?)
}

/// Grooves of 2 mm, 20 µm deep.
fn grooves() -> Result<Surface, Box<dyn Error>> {
    let (grooves, width) = (70.0, 70 * 16);
    let height = |i: usize| (std::f64::consts::TAU * grooves * (i as f64 + 0.5) / width as f64).sin();
    let values = (0..4 * width).map(|i| height(i % width)).collect();
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1e-5 };
    let map = HeightMap::new(&Raster { width, height: 4, values }, extent, Wrap::Repeat)?;
    Ok(Surface::from_map(map)?)
}

#[cfg(feature = "device")]
fn rate_hz() -> f64 {
    asperity::live::device::sample_rate_hz(&asperity::live::device::DeviceOptions::default())
        .unwrap_or(48_000.0)
}

#[cfg(feature = "device")]
fn start(renderer: asperity::Renderer) -> Result<asperity::live::device::Player, Box<dyn Error>> {
    let player = asperity::live::device::play(renderer)?;
    if let Some(why) = player.silent_because() {
        eprintln!("playing silently: {why}");
    }
    Ok(player)
}

#[cfg(feature = "device")]
fn stop(player: asperity::live::device::Player) {
    let report = player.stop();
    println!("{} underruns, peak load {:.1} %", report.underruns, 100.0 * report.peak_load);
}

#[cfg(not(feature = "device"))]
fn rate_hz() -> f64 {
    48_000.0
}

/// Without a device the engine runs just the same, into a sink that nobody hears.
#[cfg(not(feature = "device"))]
fn start(renderer: asperity::Renderer) -> Result<asperity::live::null_sink::NullSink, Box<dyn Error>> {
    use asperity::live::channel_map::{ChannelMap, Interleaver};
    let device = Interleaver::new(renderer, ChannelMap::stereo_then_haptics(1));
    Ok(asperity::live::null_sink::NullSink::start(device, 256)?)
}

#[cfg(not(feature = "device"))]
fn stop(sink: asperity::live::null_sink::NullSink) {
    if let Some((_, pace)) = sink.stop() {
        println!("{} blocks, {} late, mean load {:.1} %", pace.blocks, pace.late, 100.0 * pace.load);
    }
}
