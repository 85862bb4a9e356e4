//! A rapier3d world that is heard and felt through `asperity-rapier`: a ball is dropped, a box
//! slides, two balls meet, a finger is dragged over a triangle mesh with texture coordinates. What
//! the game reports is recorded, rendered again offline, and must give the same samples.
//!
//! ```sh
//! cargo run --release -p asperity-rapier-contacts [FOLDER]
//! ```
//! writes `rapier.audio.wav`, `rapier.haptic.wav` and `rapier.jsonl` into FOLDER (default: the
//! current one).

mod mesh;

use asperity::files::contact_log::{LogEvent, Names};
use asperity::offline::{self, Options};
use asperity::{
    ActuatorSettings, AudioBus, Body, ChannelId, ClockMode, Config, Material, Renderer, Scene, Stock, Surface,
};
use asperity_rapier::{Adapter, Mapping, Thing};
use mesh::UvMesh;
use rapier3d::prelude::*;
use std::error::Error;
use std::path::PathBuf;

/// Side of the slab, m.
const SIDE_M: f64 = 0.4;
/// Frames a callback of the imagined device.
const BLOCK: usize = 128;
const RATE_HZ: f64 = 48_000.0;
const SECONDS: f64 = 3.0;
/// What rings.
const BODIES: [(&str, Stock, f64, Material); 3] = [
    ("slab", Stock::Plate, SIDE_M, Material::CERAMIC),
    ("box", Stock::Block, 0.04, Material::WOOD),
    ("ball", Stock::Disc, 0.05, Material::BRASS),
];
/// What the finger presses with, its weight included, N.
const FINGER_N: f32 = 1.0;
const FINGER_KG: f32 = 0.02;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(PathBuf::new, PathBuf::from);
    std::fs::create_dir_all(&folder)?;
    let (mut scene, mut renderer, names, adapter) = engine(ClockMode::LIVE)?;
    scene.start_recording(&names);
    let live = play((&mut scene, &mut renderer), adapter, &names)?;
    let stats = scene.stats();
    println!(
        "live: {} events, {} impacts, {} micro-collisions, {} refused, {} late",
        stats.events, stats.impacts, stats.micro_collisions, stats.refused, stats.late
    );

    // The recording, rendered again, gives the same samples.
    let log = scene.stop_recording();
    log.write(&mut std::fs::File::create(folder.join("rapier.jsonl"))?)?;
    let latency = renderer.latency_samples();
    let (scene, renderer, names, _) = engine(ClockMode::Exact)?;
    let options = Options { block_frames: 1000, tail_s: 1.0, ..Options::default() };
    let take = offline::render(scene, renderer, &log, &names, &options)?;
    let frames = take.audio[0].len().min(live.audio.len() - latency);
    assert!(
        live.audio[latency..latency + frames] == take.audio[0][..frames],
        "live and offline audio differ"
    );
    for (live, offline) in live.haptic.iter().zip(&take.haptic) {
        assert!(live[latency..latency + frames] == offline[..frames], "live and offline haptics differ");
    }
    assert!(stats.impacts >= 6 && stats.refused == 0 && stats.micro_collisions > 0);
    // The finger is the contact that channel 0 feels and nothing holds; it begins at u = 0.2.
    let fingers: Vec<u64> = log
        .lines
        .iter()
        .filter_map(|line| match &line.event {
            LogEvent::Begin { contact, touching, .. } if touching.hand.actuator == Some(0) => Some(*contact),
            _ => None,
        })
        .collect();
    let travelled = log.lines.iter().rev().find_map(|line| match &line.event {
        LogEvent::Move { contact, sample, .. } if fingers.contains(contact) => Some(sample.uv[0] - 0.2),
        _ => None,
    });
    assert!(travelled.is_some_and(|u| u * SIDE_M > 0.2), "the finger did not get along: {travelled:?}");
    take.write_audio_wav(folder.join("rapier.audio.wav"))?;
    take.write_haptic_wav(folder.join("rapier.haptic.wav"))?;
    println!("offline: {frames} samples a channel, equal to the last bit");
    Ok(())
}

struct Heard {
    audio: Vec<f32>,
    haptic: [Vec<f32>; 2],
}

fn engine(clock: ClockMode) -> Result<(Scene, Renderer, Names, Adapter), Box<dyn Error>> {
    let actuators = vec![ActuatorSettings::default(); 2];
    // A dropped ball is fifty times louder than a finger; a sound card clips at ±1.
    let audio = vec![AudioBus { gain: 0.1, limit: true, ..AudioBus::default() }];
    let config = Config { clock, sample_rate_hz: RATE_HZ, actuators, audio, ..Config::default() };
    let asperity::Engine { mut scene, renderer, .. } = config.build()?;
    let mut names = Names::default();
    for (name, shape, size_m, material) in BODIES {
        names.bodies.insert(name.to_owned(), scene.add_body(Body::stock(shape, material, size_m)?)?);
    }
    let slab =
        Surface::flat(SIDE_M, SIDE_M)?.material(Material::CERAMIC).body(names.bodies["slab"]).wraps(false);
    names.surfaces.insert("slab".to_owned(), scene.add_surface(slab)?);
    let adapter = Adapter::new(&mut scene)?;
    names.probes.extend(adapter.named_probes("rigid"));
    Ok((scene, renderer, names, adapter))
}

/// The game: physics at 60 Hz, and between the steps the blocks that a device would ask for.
fn play(
    (scene, renderer): (&mut Scene, &mut Renderer),
    mut adapter: Adapter,
    names: &Names,
) -> Result<Heard, Box<dyn Error>> {
    let mesh = UvMesh::rippled(SIDE_M as f32, 0.0005, 16);
    let mut world = PhysicsWorld::default();
    // By default the contact point stands still while the finger moves.
    world.integration_parameters.contact_recycling = false;
    let step_s = f64::from(world.integration_parameters.dt);
    let slab = ColliderBuilder::trimesh(mesh.vertices, mesh.indices)?.friction(0.4);
    let (_, slab) = world.insert(RigidBodyBuilder::fixed(), slab);
    let ground = Thing::of(Material::CERAMIC).ringing(names.bodies["slab"]);
    adapter.insert(slab, ground.with_surface(names.surfaces["slab"], Mapping::Mesh(mesh.uv)));
    let (_, dropped) = ball(&mut world, -0.1, 0.16);
    adapter.insert(dropped, Thing::of(Material::STEEL));
    for height_m in [0.05, 0.25] {
        let (_, brass) = ball(&mut world, 0.1, height_m);
        adapter.insert(brass, Thing::of(Material::BRASS).ringing(names.bodies["ball"]));
    }
    // The hand that pushed the box feels it.
    let (_, sliding) = sliding_box(&mut world);
    let wood = Thing::of(Material::WOOD).ringing(names.bodies["box"]).felt_by(ChannelId(1));
    adapter.insert(sliding, wood);
    let (finger, tip) = finger(&mut world);
    adapter.insert(tip, Thing::of(Material::NAIL).felt_by(ChannelId(0)));

    let mut heard = Heard { audio: Vec::new(), haptic: [Vec::new(), Vec::new()] };
    for step in 0..(SECONDS / step_s) as u64 {
        // The hand drags the finger; physics finds how hard it presses.
        let along = Vector::new(0.08, world.bodies[finger].linvel().y, 0.0);
        world.bodies[finger].set_linvel(along, true);
        adapter.before_step(&(&world).into());
        world.step();
        let time_s = step as f64 * step_s;
        for event in adapter.after_step(&(&world).into()) {
            scene.report(time_s, event)?;
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

type Handles = (RigidBodyHandle, ColliderHandle);

/// Dropped from a height; it bounces.
fn ball(world: &mut PhysicsWorld, x_m: f32, height_m: f32) -> Handles {
    world.insert(
        RigidBodyBuilder::dynamic().translation(Vector::new(x_m, height_m, 0.1)),
        ColliderBuilder::ball(0.01)
            .density(7800.0)
            .restitution(0.7)
            .restitution_combine_rule(CoefficientCombineRule::Max),
    )
}

/// Slides until friction stops it.
fn sliding_box(world: &mut PhysicsWorld) -> Handles {
    world.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(-0.12, 0.0212, -0.1))
            .linvel(Vector::new(0.9, 0.0, 0.0)),
        ColliderBuilder::cuboid(0.02, 0.02, 0.02).density(600.0).friction(0.4),
    )
}

/// A fingertip that presses with 1 N.
fn finger(world: &mut PhysicsWorld) -> Handles {
    let handles = world.insert(
        RigidBodyBuilder::dynamic()
            .translation(Vector::new(-0.12, 0.0092, 0.0))
            .lock_rotations()
            .additional_mass(FINGER_KG),
        // A hand is stronger than friction, which is asperity's own; let it not stop the finger
        // here.
        ColliderBuilder::ball(0.008)
            .density(0.0)
            .friction(0.0)
            .friction_combine_rule(CoefficientCombineRule::Min),
    );
    let push_n = FINGER_N - FINGER_KG * 9.81;
    world.bodies[handles.0].add_force(Vector::new(0.0, -push_n, 0.0), true);
    handles
}
