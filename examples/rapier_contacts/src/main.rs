//! A rapier3d world that is heard and felt: a ball is dropped, a box slides, a finger is dragged over a
//! triangle mesh with texture coordinates. What the game reports is recorded, rendered again offline, and
//! must give the same samples.
//!
//! ```sh
//! cargo run --release -p asperity-rapier-contacts [FOLDER]
//! ```
//! writes `rapier.audio.wav`, `rapier.haptic.wav` and `rapier.jsonl` into FOLDER (default: the current one).

mod adapter;
mod mesh;

use adapter::{Ground, Touch, Toucher};
use asperity::files::contact_log::{LogEvent, Names};
use asperity::offline::{self, Options};
use asperity::texture::height_map::HeightMap;
use asperity::{
    Actuator, ActuatorSettings, AudioSettings, ClockMode, Config, Extent, Material, ModalModel, Mode,
    Renderer, Scene, Surface,
};
use mesh::UvMesh;
use rapier3d::prelude::*;
use std::collections::HashMap;
use std::error::Error;
use std::path::PathBuf;

/// Side of the slab, m.
const SIDE_M: f64 = 0.4;
/// Frames a callback of the imagined device.
const BLOCK: usize = 128;
const RATE_HZ: f64 = 48_000.0;
const SECONDS: f64 = 3.0;
/// What the finger presses with, its weight included, N.
const FINGER_N: f32 = 1.0;
const FINGER_KG: f32 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(PathBuf::new, PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let (mut scene, mut renderer, names) = engine(ClockMode::LIVE)?;
    scene.start_recording(&names);
    let live = play(&mut scene, &mut renderer, &names)?;
    let stats = scene.stats();
    println!(
        "live: {} events, {} impacts, {} micro-collisions, {} refused, {} late",
        stats.events, stats.impacts, stats.micro_collisions, stats.refused, stats.late
    );

    // The recording, rendered again, gives the same samples.
    let log = scene.stop_recording();
    log.write(&mut std::fs::File::create(folder.join("rapier.jsonl"))?)?;
    let latency = renderer.latency_samples();
    let (scene, renderer, names) = engine(ClockMode::Exact)?;
    let options = Options { block_frames: 1000, tail_s: 1.0 };
    let take = offline::render(scene, renderer, &log, &names, &options)?;
    let frames = take.audio.len().min(live.audio.len() - latency);
    assert!(live.audio[latency..latency + frames] == take.audio[..frames], "live and offline audio differ");
    for (live, offline) in live.haptic.iter().zip(&take.haptic) {
        assert!(live[latency..latency + frames] == offline[..frames], "live and offline haptics differ");
    }
    assert!(stats.impacts >= 2 && stats.refused == 0 && stats.micro_collisions > 0);
    let travelled = log.lines.iter().rev().find_map(|line| match &line.event {
        LogEvent::Move { contact: 3, sample } => Some(sample.uv[0] - 0.2),
        _ => None,
    });
    assert!(travelled.is_some_and(|u| u * SIDE_M > 0.2), "the finger did not get along: {travelled:?}");
    take.write_audio_wav(folder.join("rapier.audio.wav"))?;
    take.write_haptic_wav(folder.join("rapier.haptic.wav"))?;
    println!(
        "offline: {frames} samples a channel, equal to the last bit; {:.0}x real time",
        take.real_time_factor()
    );
    Ok(())
}

struct Heard {
    audio: Vec<f32>,
    haptic: [Vec<f32>; 2],
}

fn engine(clock: ClockMode) -> Result<(Scene, Renderer, Names), Box<dyn Error>> {
    let actuators = vec![ActuatorSettings::default(); 2];
    // A dropped ball is fifty times louder than a finger; a sound card clips at ±1.
    let audio = AudioSettings { gain: 0.1, limit: true };
    let config = Config { clock, sample_rate_hz: RATE_HZ, actuators, audio, ..Config::default() };
    let asperity::Engine { mut scene, renderer, .. } = config.build()?;
    let mode =
        |frequency_hz, decay_per_s, amplitude| Mode { frequency_hz, decay_per_s, amplitude, phase_rad: 0.0 };
    let modes = vec![mode(412.0, 9.0, 0.3), mode(1133.0, 14.0, 0.25), mode(2219.0, 22.0, 0.2)];
    let slab = scene.add_body_of(ModalModel::new(modes, 0.01)?, Material::CERAMIC)?;
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1.0 };
    let surface = Surface::new(HeightMap::flat(extent, 0.8)?, SIDE_M, SIDE_M)?;
    let surface = scene.add_surface(surface.on(slab).wraps(false))?;
    let names = Names {
        surfaces: HashMap::from([("slab".to_owned(), surface)]),
        bodies: HashMap::from([("slab".to_owned(), slab)]),
    };
    Ok((scene, renderer, names))
}

/// The game: physics at 60 Hz, and between the steps the blocks that a device would ask for.
fn play(scene: &mut Scene, renderer: &mut Renderer, names: &Names) -> Result<Heard, Box<dyn Error>> {
    let mesh = UvMesh::rippled(SIDE_M as f32, 0.0005, 16);
    let mut world = PhysicsWorld::default();
    // By default the contact point stands still while the finger moves.
    world.integration_parameters.contact_recycling = false;
    let step_s = f64::from(world.integration_parameters.dt);
    let collider = ColliderBuilder::trimesh(mesh.vertices.clone(), mesh.indices.clone())?.friction(0.4);
    let (_, collider) = world.insert(RigidBodyBuilder::fixed(), collider);
    let ground = Ground { collider, mesh, surface: names.surfaces["slab"], body: names.bodies["slab"] };
    let mut touchers = [ball(&mut world), sliding_box(&mut world), finger(&mut world)];
    let finger = touchers[2].body;

    let mut heard = Heard { audio: Vec::new(), haptic: [Vec::new(), Vec::new()] };
    for step in 0..(SECONDS / step_s) as u64 {
        // The hand drags the finger; physics finds how hard it presses.
        let along = Vector::new(0.08, world.bodies[finger].linvel().y, 0.0);
        world.bodies[finger].set_linvel(along, true);
        for toucher in &mut touchers {
            toucher.before_step(&world);
        }
        world.step();
        let time_s = step as f64 * step_s;
        for toucher in &mut touchers {
            if let Some(event) = toucher.after_step(&world, &ground, time_s) {
                scene.report(time_s, event)?;
            }
        }
        let next_step = ((step + 1) as f64 * step_s * RATE_HZ) as usize;
        while heard.audio.len() + BLOCK <= next_step {
            heard.render_block(renderer);
        }
    }
    Ok(heard)
}

impl Heard {
    fn render_block(&mut self, renderer: &mut Renderer) {
        let (mut first, mut second, mut audio) = ([0.0f32; BLOCK], [0.0f32; BLOCK], [0.0f32; BLOCK]);
        renderer.render(&mut [&mut first, &mut second], &mut [&mut audio]);
        self.audio.extend(audio);
        self.haptic[0].extend(first);
        self.haptic[1].extend(second);
    }
}

/// Dropped from 15 cm; it bounces.
fn ball(world: &mut PhysicsWorld) -> Toucher {
    let handles = world.insert(
        RigidBodyBuilder::dynamic().translation(Vector::new(-0.1, 0.16, 0.1)),
        ColliderBuilder::ball(0.01)
            .density(7800.0)
            .restitution(0.7)
            .restitution_combine_rule(CoefficientCombineRule::Max),
    );
    Toucher::new(1, handles, Touch::Strikes { radius_m: 0.01, material: Material::STEEL })
}

/// Slides until friction stops it; the hand that pushed it feels it.
fn sliding_box(world: &mut PhysicsWorld) -> Toucher {
    let handles = world.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(-0.12, 0.0212, -0.1))
            .linvel(Vector::new(0.9, 0.0, 0.0)),
        ColliderBuilder::cuboid(0.02, 0.02, 0.02).density(600.0).friction(0.4),
    );
    Toucher::new(2, handles, Touch::Slides { actuator: Actuator(1) })
}

/// A fingertip that presses with 1 N.
fn finger(world: &mut PhysicsWorld) -> Toucher {
    let handles = world.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(-0.12, 0.0092, 0.0))
            .lock_rotations()
            .additional_mass(FINGER_KG),
        // A hand is stronger than friction, which is asperity's own; let it not stop the finger here.
        ColliderBuilder::ball(0.008)
            .density(0.0)
            .friction(0.0)
            .friction_combine_rule(CoefficientCombineRule::Min),
    );
    let push_n = FINGER_N - FINGER_KG * 9.81;
    world.bodies[handles.0].add_force(Vector::new(0.0, -push_n, 0.0), true);
    Toucher::new(3, handles, Touch::Slides { actuator: Actuator(0) })
}
