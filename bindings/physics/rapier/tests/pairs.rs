//! Pairs of a rapier world: what strikes, scrapes, rolls and rests is reported as that, with the
//! masses and speeds of mechanics.

use asperity::{
    Body, BodyId, ChannelId, Config, ContactEvent, ContactId, Engine, Impact, LevelPolicy, Material,
    Renderer, Scene, Stock, Surface, SurfaceId,
};
use asperity_rapier::{Adapter, Kind, Mapping, Thing};
use rapier3d::prelude::*;
use std::collections::HashSet;

const STEP_S: f64 = 1.0 / 60.0;
const GRAVITY_M_S2: f64 = 9.81;

struct World {
    physics: PhysicsWorld,
    adapter: Adapter,
    scene: Scene,
    renderer: Renderer,
    slab: BodyId,
    top: SurfaceId,
    steps: u32,
    events: Vec<(f64, ContactEvent)>,
}

impl World {
    /// A floor of 4 m × 4 m whose top lies at height 0.
    fn new() -> Self {
        let Engine { mut scene, renderer, .. } =
            Config { levels: LevelPolicy::AsGiven, ..Config::live(48_000.0) }.build().unwrap();
        let mut physics = PhysicsWorld::default();
        physics.integration_parameters.contact_recycling = false;
        let slab = scene.add_body(Body::stock(Stock::Plate, Material::STONE, 0.5).unwrap()).unwrap();
        let top = Surface::flat(4.0, 4.0).unwrap().material(Material::STONE).body(slab).wraps(false);
        let top = scene.add_surface(top).unwrap();
        let floor = ColliderBuilder::cuboid(2.0, 0.5, 2.0).translation(Vector::new(0.0, -0.5, 0.0));
        let (_, floor) = physics.insert(RigidBodyBuilder::fixed(), floor);
        let mut adapter = Adapter::new(&mut scene).unwrap();
        let mapping = Mapping::plane([-2.0, 0.5, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0]);
        adapter.insert(floor, Thing::of(Material::STONE).ringing(slab).with_surface(top, mapping));
        Self { physics, adapter, scene, renderer, slab, top, steps: 0, events: Vec::new() }
    }

    fn insert(&mut self, body: RigidBodyBuilder, collider: ColliderBuilder, thing: Thing) -> RigidBodyHandle {
        let (body, collider) = self.physics.insert(body, collider);
        self.adapter.insert(collider, thing);
        body
    }

    fn body(&mut self, shape: Stock, size_m: f64, material: Material) -> BodyId {
        self.scene.add_body(Body::stock(shape, material, size_m).unwrap()).unwrap()
    }

    fn run(&mut self, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as u32 {
            self.adapter.before_step(&(&self.physics).into());
            self.physics.step();
            let time_s = f64::from(self.steps) * STEP_S;
            for event in self.adapter.after_step(&(&self.physics).into()) {
                self.report(time_s, event);
            }
            self.steps += 1;
            let (mut haptic, mut audio) = ([0.0; 800], [0.0; 800]);
            self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        }
    }

    fn report(&mut self, time_s: f64, event: ContactEvent) {
        self.scene.report(time_s, event).unwrap();
        self.events.push((time_s, event));
    }

    fn impacts(&self) -> Vec<(f64, Impact)> {
        let impact = |(t, event): &(f64, ContactEvent)| match event {
            ContactEvent::Impact(impact) => Some((*t, *impact)),
            _ => None,
        };
        self.events.iter().filter_map(impact).collect()
    }

    fn kinds(&self) -> Vec<Kind> {
        self.adapter.touches().map(|touch| touch.kind).collect()
    }

    /// Contacts that have begun and not ended; panics where an event has none that it belongs to.
    fn open(&self) -> HashSet<ContactId> {
        let mut open = HashSet::new();
        for (time_s, event) in &self.events {
            match event {
                ContactEvent::Begin { contact, .. } => {
                    assert!(open.insert(*contact), "{time_s} s: {contact:?} begins twice");
                }
                ContactEvent::Moved { contact, .. } => {
                    assert!(open.contains(contact), "{time_s} s: {contact:?} moves before it begins");
                }
                ContactEvent::End { contact } => {
                    assert!(open.remove(contact), "{time_s} s: {contact:?} ends before it begins");
                }
                ContactEvent::Impact(_) | ContactEvent::Motion { .. } => {}
            }
        }
        open
    }
}

fn at(x: f32, y: f32, z: f32) -> RigidBodyBuilder {
    RigidBodyBuilder::dynamic().translation(Vector::new(x, y, z))
}

fn ball(radius_m: f32, mass_kg: f32, restitution: f32) -> ColliderBuilder {
    let volume_m3 = 4.0 / 3.0 * std::f32::consts::PI * radius_m.powi(3);
    ColliderBuilder::ball(radius_m)
        .density(mass_kg / volume_m3)
        .restitution(restitution)
        .restitution_combine_rule(CoefficientCombineRule::Max)
}

#[test]
fn a_dropped_ball_strikes_once_a_bounce_ever_more_slowly() {
    let mut world = World::new();
    world.insert(at(0.0, 0.52, 0.0), ball(0.02, 0.1, 0.7), Thing::of(Material::STEEL));
    world.run(3.0);
    let impacts = world.impacts();
    // From 0.5 m: 3.13 m/s, then 0.7 of it each time, with flights of 2 v / g between.
    let first = impacts[0].1;
    let fall_m_s = (2.0 * GRAVITY_M_S2 * 0.5).sqrt();
    assert!((first.speed_m_s / fall_m_s - 1.0).abs() < 0.06, "{} against {fall_m_s}", first.speed_m_s);
    assert!((first.mass_kg - 0.1).abs() < 1e-3 && (first.radius_m - 0.02).abs() < 1e-6, "{first:?}");
    assert!((first.restitution - 0.7).abs() < 1e-6 && first.body == world.slab && first.other.is_none());
    for (index, pair) in impacts.windows(2).enumerate().take(4) {
        let ((t, now), (later, next)) = (pair[0], pair[1]);
        let flight_s = 2.0 * 0.7 * now.speed_m_s / GRAVITY_M_S2;
        assert!((later - t - flight_s).abs() < 2.5 * STEP_S, "bounce {index}: {} s, {flight_s} s", later - t);
        assert!((next.speed_m_s / now.speed_m_s - 0.7).abs() < 0.15, "bounce {index}");
    }
    let last = impacts.last().unwrap();
    assert!(last.0 < 2.6, "a ball that lies still strikes at {} s", last.0);
    assert!(world.open().is_empty());
}

#[test]
fn a_rod_landing_on_one_end_strikes_with_a_quarter_mass() {
    let mut world = World::new();
    // 1 m long, 5 mm thick, tilted by 0.1: only one end lands.
    let tilted = at(0.0, 0.4, 0.0).rotation(Vector::new(0.0, 0.0, 0.1));
    let rod = ColliderBuilder::cuboid(0.5, 0.0025, 0.0025).density(8000.0);
    world.insert(tilted, rod, Thing::of(Material::STEEL));
    world.run(0.5);
    let (_, first) = world.impacts()[0];
    // n·K n = 1/m + (L/2)² / (m L² / 12) = 4/m.
    let mass_kg = 8000.0 * 1.0 * 0.005 * 0.005;
    assert!(
        (first.mass_kg / (mass_kg / 4.0) - 1.0).abs() < 0.05,
        "{} against {}",
        first.mass_kg,
        mass_kg / 4.0
    );
}

#[test]
fn two_balls_that_collide_both_ring_from_half_the_mass() {
    let mut world = World::new();
    world.physics.gravity = Vector::ZERO;
    let bodies = [(); 2].map(|()| world.body(Stock::Disc, 0.1, Material::BRASS));
    for (x, speed_m_s, body) in [(-0.2, 1.0, bodies[0]), (0.2, -0.5, bodies[1])] {
        let moving = at(x, 1.0, 0.0).linvel(Vector::new(speed_m_s, 0.0, 0.0));
        world.insert(moving, ball(0.03, 0.2, 0.9), Thing::of(Material::BRASS).ringing(body));
    }
    world.run(0.6);
    let impacts = world.impacts();
    assert_eq!(impacts.len(), 1, "{impacts:?}");
    let impact = impacts[0].1;
    assert!((impact.mass_kg - 0.1).abs() < 1e-3 && (impact.radius_m - 0.015).abs() < 1e-5, "{impact:?}");
    assert!((impact.speed_m_s - 1.5).abs() < 0.02, "{impact:?}");
    let rings = HashSet::from([Some(impact.body), impact.other]);
    assert_eq!(rings, bodies.map(Some).into());
    // The momentum that changed hands is what the engine gets: m v (1 + e).
    let impulse_n_s = impact.mass_kg * impact.speed_m_s * (1.0 + impact.restitution);
    let velocity_m_s: f32 =
        world.physics.bodies.iter().map(|(_, body)| body.linvel().x).fold(f32::MAX, f32::min);
    let changed_n_s = 0.2 * (1.0 - f64::from(velocity_m_s));
    assert!((impulse_n_s / changed_n_s - 1.0).abs() < 0.05, "{impulse_n_s} against {changed_n_s}");
}

#[test]
fn a_pushed_box_scrapes_as_far_as_it_slides_and_then_rests() {
    let mut world = World::new();
    let own = world.body(Stock::Block, 0.1, Material::WOOD);
    let sliding = at(-0.5, 0.0505, 0.0).linvel(Vector::new(2.0, 0.0, 0.0));
    let cube = ColliderBuilder::cuboid(0.05, 0.05, 0.05).density(600.0).friction(0.3);
    let body = world.insert(sliding, cube, Thing::of(Material::WOOD).ringing(own));
    world.run(0.3);
    assert_eq!(world.kinds(), [Kind::Scrapes]);
    let touch = world.adapter.touches().next().unwrap();
    // m g of 0.6 kg.
    assert!((f64::from(touch.force_n) - 0.6 * GRAVITY_M_S2).abs() < 0.6, "{touch:?}");
    world.run(2.0);
    let begins: Vec<_> = world
        .events
        .iter()
        .filter_map(|(_, event)| match event {
            ContactEvent::Begin { touching, .. } => Some(*touching),
            _ => None,
        })
        .collect();
    assert_eq!((begins.len(), begins[0].surface, begins[0].holder), (1, world.top, Some(own)));
    assert!(begins[0].actuator.is_none() && begins[0].probe.is_some());
    let uv: Vec<[f64; 2]> = world
        .events
        .iter()
        .filter_map(|(_, event)| match event {
            ContactEvent::Moved { sample, .. } => Some(sample.uv),
            _ => None,
        })
        .collect();
    let slid_m = 4.0 * (uv.last().unwrap()[0] - uv[0][0]);
    let place_m = f64::from(world.physics.bodies[body].translation().x) - (-0.5);
    assert!((slid_m - place_m).abs() < 0.1 && slid_m > 0.4, "{slid_m} of {place_m} m");
    assert!(world.open().is_empty(), "a box that lies still is still reported");
}

#[test]
fn a_rolling_ball_rolls_and_takes_its_place_of_contact_along() {
    let mut world = World::new();
    let radius_m = 0.05;
    // Rolls without slipping from the start: v = ω r.
    let rolling = at(-1.0, radius_m + 0.0005, 0.2).linvel(Vector::new(0.8, 0.0, 0.0)).angvel(Vector::new(
        0.0,
        0.0,
        -0.8 / radius_m,
    ));
    let body = world.insert(rolling, ball(radius_m, 0.5, 0.0).friction(0.6), Thing::of(Material::STEEL));
    world.run(1.0);
    assert_eq!(world.kinds(), [Kind::Rolls]);
    let touch = world.adapter.touches().next().unwrap();
    assert!((touch.path_m_s - 0.8).abs() < 0.08 && touch.slip_m_s < 0.05, "{touch:?}");
    let Some((_, ContactEvent::Moved { sample, .. })) = world.events.last() else {
        panic!("it is not reported")
    };
    let place = world.physics.bodies[body].translation();
    let uv = [place.x, place.z].map(|x| (f64::from(x) + 2.0) / 4.0);
    assert!(
        (sample.uv[0] - uv[0]).abs() < 0.008 && (sample.uv[1] - uv[1]).abs() < 0.004,
        "{sample:?} {uv:?}"
    );
    assert!((sample.velocity_m_s.unwrap()[0] - 0.8).abs() < 0.08, "{sample:?}");
    // What is told of its motion is that it rolls.
    assert!(
        sample.slip_m_s.unwrap() < 0.05 && (sample.roll_radius_m.unwrap() - f64::from(radius_m)).abs() < 1e-6,
        "{sample:?}"
    );
}

#[test]
fn a_finger_lands_as_a_contact_and_a_tool_strikes() {
    let mut world = World::new();
    let down = |x: f32| at(x, 0.05, 0.0).linvel(Vector::new(0.0, -0.5, 0.0)).lock_rotations();
    world.insert(down(-0.5), ball(0.008, 0.02, 0.0), Thing::of(Material::NAIL).felt_by(ChannelId(0)));
    let pen = world.body(Stock::Bar, 0.15, Material::PLASTIC);
    let held = Thing::of(Material::PLASTIC).ringing(pen).felt_by(ChannelId(0));
    world.insert(down(0.5), ball(0.008, 0.02, 0.0), held);
    world.run(0.5);
    let impacts = world.impacts();
    assert_eq!(impacts.len(), 1, "{impacts:?}");
    assert_eq!(
        (impacts[0].1.holder, impacts[0].1.actuator, impacts[0].1.body),
        (Some(pen), Some(ChannelId(0)), world.slab)
    );
    let landing = world.events.iter().find_map(|(_, event)| match event {
        ContactEvent::Begin { touching, sample, .. } if touching.holder.is_none() => {
            Some((*touching, *sample))
        }
        _ => None,
    });
    let (touching, sample) = landing.unwrap();
    assert!(touching.actuator == Some(ChannelId(0)) && touching.probe.is_none(), "{touching:?}");
    assert!((sample.closing_m_s - 1.0).abs() < 0.3, "{sample:?}");
    // A finger that lies still is still there.
    assert_eq!(world.open().len(), 2);
}

#[test]
fn the_events_of_tumbling_things_are_consistent() {
    let mut world = World::new();
    let mut rng = asperity_dsp::rng::Rng::new(11);
    let mut bodies = Vec::new();
    for index in 0..24 {
        let mut up_to = |most: f64| (most * rng.uniform()) as f32;
        let place = at(up_to(0.4) - 0.2, 0.2 + 0.12 * index as f32, up_to(0.4) - 0.2).rotation(Vector::new(
            up_to(3.0),
            up_to(3.0),
            up_to(3.0),
        ));
        let shape = match index % 3 {
            0 => ColliderBuilder::cuboid(0.04, 0.03, 0.02),
            1 => ColliderBuilder::ball(0.03),
            _ => ColliderBuilder::capsule_y(0.04, 0.02),
        };
        let rings = world.body(Stock::Block, 0.08, Material::WOOD);
        let thing = Thing::of(Material::WOOD).ringing(rings);
        bodies.push(world.insert(place, shape.density(700.0).restitution(0.3), thing));
    }
    world.run(3.0);
    assert!(world.impacts().len() > 24, "{}", world.impacts().len());
    let others = world.impacts().iter().filter(|(_, impact)| impact.other.is_some()).count();
    assert!(others > 0 && world.scene.stats().refused == 0);
    for body in bodies {
        world.physics.remove_body(body);
    }
    world.run(2.0 * STEP_S);
    assert!(world.open().is_empty());
    let stats = world.scene.stats();
    assert_eq!((stats.refused, stats.orphaned, stats.quarantined), (0, 0, 0));
}

#[test]
fn a_mesh_gives_its_vertices_coordinates_and_a_removed_collider_ends() {
    let mut world = World::new();
    world.physics.gravity = Vector::new(0.0, -9.81, 0.0);
    let vertices = [[-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0]];
    let vertices = vertices.map(|[x, y, z]: [f32; 3]| Vector::new(x, y, z)).to_vec();
    let mesh = ColliderBuilder::trimesh(vertices, vec![[0, 2, 1], [1, 2, 3]]).unwrap();
    let (_, mesh) = world.physics.insert(RigidBodyBuilder::fixed(), mesh);
    let uv = Mapping::Mesh(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    world.adapter.insert(mesh, Thing::of(Material::STONE).with_surface(world.top, uv));
    let slippery = ball(0.02, 0.1, 0.0).friction(0.0).friction_combine_rule(CoefficientCombineRule::Min);
    let dragged = at(-0.5, 1.0205, 0.25).linvel(Vector::new(0.4, 0.0, 0.0)).lock_rotations();
    world.insert(dragged, slippery, Thing::of(Material::NAIL).felt_by(ChannelId(0)));
    world.run(1.0);
    let Some((_, ContactEvent::Moved { sample, .. })) = world.events.last() else {
        panic!("it is not reported")
    };
    assert!((sample.uv[0] - 0.45).abs() < 0.02 && (sample.uv[1] - 0.625).abs() < 0.01, "{sample:?}");
    world.adapter.remove(mesh);
    world.run(STEP_S);
    assert!(world.open().is_empty());
}
