//! Shapes, faces, belts and hands of a rapier world: what rolls is no louder than what slides,
//! every side of a box sounds as its top, what rests on a belt is silent, and a blow lands where it
//! lands.

use asperity::{
    Body, ChannelId, Config, ContactEvent, Engine, Impact, LevelPolicy, Material, ModalModel, Renderer,
    Scene, Stock, Surface, SurfaceId,
};
use asperity_rapier::{Adapter, Kind, Mapping, Notice, Thing};
use rapier3d::prelude::*;

const STEP_S: f64 = 1.0 / 60.0;

struct World {
    physics: PhysicsWorld,
    adapter: Adapter,
    scene: Scene,
    renderer: Renderer,
    top: SurfaceId,
    steps: u32,
    events: Vec<ContactEvent>,
    /// What was heard in the last run.
    heard: Vec<f32>,
}

impl World {
    /// A block of stone of 40 m by 1 m by 40 m whose top lies at height 0, every side of which is
    /// mapped.
    fn new(mapping: Mapping) -> Self {
        let mut config = Config::live(48_000.0);
        config.audio[0].limit = false;
        config.levels = LevelPolicy::AsGiven;
        let Engine { mut scene, renderer, .. } = config.build().unwrap();
        let mut physics = PhysicsWorld::default();
        physics.integration_parameters.contact_recycling = false;
        let slab = scene.add_body(Body::stock(Stock::Plate, Material::STONE, 0.5).unwrap()).unwrap();
        let top = Surface::flat(1.0, 1.0).unwrap().material(Material::STONE).body(slab);
        let top = scene.add_surface(top).unwrap();
        let floor = ColliderBuilder::cuboid(20.0, 20.0, 20.0).translation(Vector::new(0.0, -20.0, 0.0));
        let (_, floor) = physics.insert(RigidBodyBuilder::fixed(), floor);
        let mut adapter = Adapter::new(&mut scene).unwrap();
        adapter.insert(floor, Thing::of(Material::STONE).ringing(slab).with_surface(top, mapping));
        Self { physics, adapter, scene, renderer, top, steps: 0, events: Vec::new(), heard: Vec::new() }
    }

    fn insert(&mut self, body: RigidBodyBuilder, collider: ColliderBuilder, thing: Thing) -> RigidBodyHandle {
        let (body, collider) = self.physics.insert(body, collider);
        self.adapter.insert(collider, thing);
        body
    }

    fn run(&mut self, seconds: f64) {
        self.run_by(seconds, |_| ());
    }

    fn run_by(&mut self, seconds: f64, mut before: impl FnMut(&mut PhysicsWorld)) {
        self.heard.clear();
        for _ in 0..(seconds / STEP_S).round() as u32 {
            before(&mut self.physics);
            self.adapter.before_step(&(&self.physics).into());
            self.physics.step();
            for event in self.adapter.after_step(&(&self.physics).into()) {
                self.scene.report(f64::from(self.steps) * STEP_S, event).unwrap();
                self.events.push(event);
            }
            self.steps += 1;
            let (mut haptic, mut audio) = ([0.0; 800], [0.0; 800]);
            self.renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            self.heard.extend(audio);
        }
    }

    /// Rms of what was heard in the last run, dB.
    fn level_db(&self) -> f64 {
        let power: f64 = self.heard.iter().map(|x| f64::from(*x).powi(2)).sum();
        10.0 * (power / self.heard.len() as f64).max(1e-30).log10()
    }

    fn impacts(&self) -> Vec<Impact> {
        self.events
            .iter()
            .filter_map(|event| if let ContactEvent::Impact(impact) = event { Some(*impact) } else { None })
            .collect()
    }

    /// Velocity and uv of the last report.
    fn last(&self) -> ([f64; 2], [f64; 2]) {
        let reported = self.events.iter().rev().find_map(|event| match event {
            ContactEvent::Moved { sample, .. } => Some((sample.velocity_m_s.unwrap(), sample.uv)),
            _ => None,
        });
        reported.expect("nothing moves")
    }
}

fn at(x: f32, y: f32, z: f32) -> RigidBodyBuilder {
    RigidBodyBuilder::dynamic().translation(Vector::new(x, y, z))
}

fn faces() -> Mapping {
    Mapping::by_normal([1.0, 1.0])
}

fn of_mass(collider: ColliderBuilder, mass_kg: f32) -> ColliderBuilder {
    collider.mass(mass_kg)
}

/// Level while a round thing of 20 kg and 0.3 m rolls at a speed, or slides without turning.
fn round_db(shape: &str, speed_m_s: f32, rolls: bool) -> f64 {
    let mut world = World::new(faces());
    let collider = match shape {
        "ball" => ColliderBuilder::ball(0.3),
        "capsule" => ColliderBuilder::capsule_z(0.4, 0.3),
        "cylinder" => ColliderBuilder::cylinder(0.4, 0.3),
        _ => ColliderBuilder::round_cylinder(0.35, 0.25, 0.05),
    };
    let mut body = at(-15.0, 0.301, 0.0).linvel(Vector::new(speed_m_s, 0.0, 0.0));
    if shape.ends_with("cylinder") {
        body = body.rotation(Vector::new(std::f32::consts::FRAC_PI_2, 0.0, 0.0));
    }
    let body =
        if rolls { body.angvel(Vector::new(0.0, 0.0, -speed_m_s / 0.3)) } else { body.lock_rotations() };
    let collider = of_mass(collider, 20.0).friction(if rolls { 0.8 } else { 0.0 });
    let collider = collider.friction_combine_rule(if rolls {
        CoefficientCombineRule::Max
    } else {
        CoefficientCombineRule::Min
    });
    world.insert(body, collider, Thing::of(Material::STEEL));
    world.run(0.7);
    world.run(1.0);
    let kinds: Vec<Kind> = world.adapter.touches().map(|touch| touch.kind).collect();
    let wanted = if rolls { Kind::Rolls } else { Kind::Scrapes };
    assert!(kinds.iter().all(|kind| *kind == wanted), "{shape} at {speed_m_s} m/s: {kinds:?}");
    assert_eq!(world.scene.stats().refused, 0);
    world.level_db()
}

#[test]
fn a_rolling_barrel_is_as_soft_as_a_ball_sliding_is_louder() {
    for speed_m_s in [0.5, 3.0, 8.0] {
        let level = |shape, rolls| round_db(shape, speed_m_s, rolls);
        let capsule = level("capsule", true);
        for shape in ["ball", "cylinder", "round cylinder"] {
            let (rolling, sliding) = (level(shape, true), level(shape, false));
            println!("{shape} {speed_m_s} m/s: rolls {rolling:.1} slides {sliding:.1}, capsule {capsule:.1}");
            assert!(rolling < sliding, "{shape} at {speed_m_s} m/s: {rolling} against {sliding} dB");
            if shape == "cylinder" {
                assert!((rolling - capsule).abs() < 6.0, "{speed_m_s} m/s: {rolling} against {capsule} dB");
            }
        }
    }
}

/// Level, and velocity told, while a box is pressed onto a side of the block and driven along it.
fn along_db(mapping: Mapping, face: usize, sign: f32, along: usize, speed_m_s: f32) -> (f64, [f64; 2]) {
    let mut world = World::new(mapping);
    let axis = |index: usize, length: f32| {
        let mut v = [0.0; 3];
        v[index] = length;
        Vector::from_array(v)
    };
    // The block's middle lies at (0, −20, 0).
    let place = Vector::new(0.0, -20.0, 0.0) + axis(face, sign * 20.1005);
    world.physics.gravity = axis(face, -sign * 9.81);
    let body = RigidBodyBuilder::dynamic().translation(place).lock_rotations().can_sleep(false);
    let cube = of_mass(ColliderBuilder::cuboid(0.1, 0.1, 0.1), 8.0).friction(0.0);
    let cube = cube.friction_combine_rule(CoefficientCombineRule::Min);
    let body = world.insert(body, cube, Thing::of(Material::STEEL));
    let drive = |physics: &mut PhysicsWorld| {
        let body = &mut physics.bodies[body];
        let falls = body.linvel().to_array()[face];
        body.set_linvel(axis(along, speed_m_s) + axis(face, falls), true);
    };
    world.run_by(0.5, drive);
    world.run_by(1.0, drive);
    assert!(world.adapter.touches().all(|touch| touch.contact.is_some() && !touch.is_unplaced));
    (world.level_db(), world.last().0)
}

#[test]
fn every_side_of_a_box_sounds_as_its_top() {
    let top = Mapping::plane([-20.0, 20.0, -20.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    for mapping in [faces(), top] {
        let (reference, _) = along_db(faces(), 1, 1.0, 0, 0.5);
        for face in 0..3 {
            for sign in [-1.0, 1.0] {
                for along in (0..3).filter(|along| *along != face) {
                    let (level, reported) = along_db(mapping.clone(), face, sign, along, 0.5);
                    println!(
                        "face {face} {sign} along {along}: {level:.2} dB of {reference:.2}, {reported:?}"
                    );
                    assert!(
                        (level - reference).abs() < 1.5,
                        "{face} {sign} {along}: {level} of {reference} dB"
                    );
                    let axes = reported.map(|v| (v.abs() > 0.4) as u8);
                    assert_eq!(axes.iter().sum::<u8>(), 1, "goes along one of both axes: {reported:?}");
                }
            }
        }
    }
}

#[test]
fn things_on_a_belt_are_silent_and_still_ones_above_sound() {
    for belt_m_s in [2.0f32, -2.0] {
        let level_db = |riding: bool| {
            let mut world = World::new(faces());
            let belt = world.adapter.rigid_probe();
            let (_, floor) = world.physics.insert(
                RigidBodyBuilder::fixed(),
                ColliderBuilder::cuboid(19.0, 0.1, 1.0).translation(Vector::new(0.0, 0.1, 0.0)),
            );
            let belt_of = Thing::of(Material::STONE).running([belt_m_s, 0.0, 0.0]).touching_with(belt);
            world.adapter.insert(floor, belt_of.with_surface(world.top, faces()));
            let body = at(0.0, 0.3005, 0.0).lock_rotations().can_sleep(false);
            let cube = of_mass(ColliderBuilder::cuboid(0.1, 0.1, 0.1), 2.0).friction(0.0);
            let cube = cube.friction_combine_rule(CoefficientCombineRule::Min);
            let body = world.insert(body, cube, Thing::of(Material::STEEL));
            let drive = |physics: &mut PhysicsWorld| {
                let falls = physics.bodies[body].linvel().y;
                let along = if riding { belt_m_s } else { 0.0 };
                physics.bodies[body].set_linvel(Vector::new(along, falls, 0.0), true);
            };
            world.run_by(1.5, drive);
            world.run_by(1.0, drive);
            (world.level_db(), world.adapter.touches().next().unwrap().kind)
        };
        let (riding, kind) = level_db(true);
        assert!(riding < -100.0 && kind == Kind::Rests, "{belt_m_s} m/s: {riding} dB, {kind:?}");
        let (held, kind) = level_db(false);
        assert!(held > -60.0 && kind == Kind::Scrapes, "{belt_m_s} m/s: {held} dB, {kind:?}");
    }
}

#[test]
fn a_wheel_that_spins_on_the_spot_is_reported_with_its_slip() {
    for spin_rad_s in [1.0f32, 10.0, 60.0] {
        let mut world = World::new(faces());
        let wheel = at(0.0, 0.301, 0.0).can_sleep(false).enabled_translations(false, true, false);
        let ball = of_mass(ColliderBuilder::ball(0.3), 20.0).friction(0.0);
        let ball = ball.friction_combine_rule(CoefficientCombineRule::Min);
        let wheel = wheel.angvel(Vector::new(0.0, 0.0, spin_rad_s));
        let wheel = world.insert(wheel, ball, Thing::of(Material::STEEL));
        world.run(1.0);
        // The solver takes some of a spin of a radian a step by itself.
        let spins_rad_s = world.physics.bodies[wheel].angvel().z;
        println!("{spin_rad_s} rad/s at first, {spins_rad_s} after 1 s");
        assert!(spins_rad_s > 0.7 * spin_rad_s);
        let touch = world.adapter.touches().next().unwrap();
        assert!(touch.kind == Kind::Scrapes && touch.contact.is_some(), "{touch:?}");
        assert!((touch.slip_m_s / (0.3 * spins_rad_s) - 1.0).abs() < 0.05, "{touch:?}");
    }
}

#[test]
fn a_hundred_tonnes_or_a_kilometre_a_second_is_not_refused() {
    for mass_kg in [1e-3, 1.0, 1.1e3, 1e5] {
        let mut world = World::new(faces());
        let cube = of_mass(ColliderBuilder::cuboid(0.5, 0.5, 0.5), mass_kg).friction(0.0);
        let cube = cube.friction_combine_rule(CoefficientCombineRule::Min);
        let body = at(-5.0, 0.51, 0.0).linvel(Vector::new(2.0, -1.0, 0.0)).lock_rotations();
        world.insert(body, cube, Thing::of(Material::STONE));
        world.run(1.0);
        let stats = world.scene.stats();
        assert_eq!((stats.refused, stats.lapsed), (0, 0), "{mass_kg} kg");
        assert!(world.level_db() > -140.0, "{mass_kg} kg: {} dB", world.level_db());
        assert_eq!(stats.held > 0, mass_kg > 1e3, "{mass_kg} kg: {} held", stats.held);
    }
    for speed_m_s in [1e-3, 50.0, 105.0, 400.0, 1000.0] {
        let mut world = World::new(faces());
        let bullet = at(0.0, 1.0, 0.0).linvel(Vector::new(0.0, -speed_m_s, 0.0)).ccd_enabled(true);
        world.insert(bullet, of_mass(ColliderBuilder::ball(0.005), 0.008), Thing::of(Material::STEEL));
        world.run(1.0);
        assert_eq!(world.scene.stats().refused, 0, "{speed_m_s} m/s");
        assert!(!world.impacts().is_empty(), "{speed_m_s} m/s: no blow");
        let reported = world.scene.why_silent().iter().any(|reason| reason.to_string().contains("100 m/s"));
        assert_eq!(reported, speed_m_s > 100.0, "{speed_m_s} m/s: {:?}", world.scene.why_silent());
    }
}

#[test]
fn a_blow_has_its_place_in_the_struck_bodys_frame() {
    for (x, z) in [(0.0, 0.0), (0.9, 0.0), (-0.9, 0.9)] {
        let mut world = World::new(faces());
        let plate = world.scene.add_body(Body::stock(Stock::Plate, Material::STEEL, 1.0).unwrap()).unwrap();
        // A plate of 2 m by 2 m on end, turned by a right angle about z: its own y looks along −x.
        let turned = RigidBodyBuilder::fixed().translation(Vector::new(0.0, 1.0, 0.0)).rotation(Vector::new(
            0.0,
            0.0,
            std::f32::consts::FRAC_PI_2,
        ));
        world.insert(
            turned,
            ColliderBuilder::cuboid(0.01, 1.0, 1.0),
            Thing::of(Material::STEEL).ringing(plate),
        );
        let ball = of_mass(ColliderBuilder::ball(0.02), 0.1);
        let falling = at(x, 1.2, z).linvel(Vector::new(0.0, -2.0, 0.0));
        world.insert(falling, ball, Thing::of(Material::STEEL));
        world.run(0.4);
        let impact = world.impacts()[0];
        let at_m = impact.at_m.expect("it tells its place");
        // Turned back: (x, y) → (y, −x) about the plate's middle.
        let wanted = [0.01, -f64::from(x), f64::from(z)];
        let far: f64 = at_m.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        assert!(impact.body == plate && far < 0.005, "{at_m:?} against {wanted:?}");
    }
}

#[test]
fn a_kinematic_hand_on_a_fixed_table_sounds_by_a_nominal_force() {
    for listed in [true, false] {
        let mut world = World::new(faces());
        let hand = RigidBodyBuilder::kinematic_velocity_based()
            .translation(Vector::new(0.0, 0.048, 0.0))
            .linvel(Vector::new(0.3, 0.0, 0.0));
        let mut collider = ColliderBuilder::cuboid(0.05, 0.05, 0.05);
        if listed {
            collider = collider.active_collision_types(ActiveCollisionTypes::all());
        }
        world.insert(hand, collider, Thing::of(Material::NAIL).felt_by(ChannelId(0)));
        world.run(1.0);
        let warnings: Vec<Notice> = world.adapter.warnings().iter().map(|warning| warning.notice).collect();
        if listed {
            let touch = world.adapter.touches().next().expect("it touches");
            assert!(touch.contact.is_some() && (touch.force_n - 1.0).abs() < 1e-3, "{touch:?}");
            assert!((world.last().0[0].hypot(world.last().0[1]) - 0.3).abs() < 0.02, "{:?}", world.last());
            assert!(warnings.is_empty() && world.impacts().is_empty(), "{warnings:?}");
        } else {
            assert_eq!(warnings, [Notice::Unlisted]);
        }
    }
}

#[test]
fn mapping_what_is_no_mesh_and_centimetres_warn_once() {
    let mut world = World::new(Mapping::Mesh(vec![[0.0, 0.0]]));
    world.physics.gravity = Vector::new(0.0, -981.0, 0.0);
    let cube = of_mass(ColliderBuilder::cuboid(0.1, 0.1, 0.1), 1.0);
    let body = at(0.0, 0.1, 0.0).linvel(Vector::new(30.0, 0.0, 0.0));
    world.insert(body, cube, Thing::of(Material::STEEL));
    world.run(0.5);
    assert!(world.adapter.touches().all(|touch| touch.is_unplaced || touch.kind == Kind::Rests));
    let warnings = world.adapter.warnings();
    let notices: Vec<Notice> = warnings.iter().map(|warning| warning.notice).collect();
    assert_eq!(notices, [Notice::Gravity { m_s2: 981.0 }, Notice::Unplaced], "{warnings:?}");
    assert!(warnings[1].collider.is_some() && warnings[1].to_string().contains("plane"));
    world.run(0.5);
    assert!(world.adapter.warnings().is_empty());
}

/// A plate of 1 m by 2 cm by 1 m whose upper face moves as cosines, in its own frame.
fn shaped_plate() -> ModalModel {
    const SIDE: usize = 33;
    let across = |i: usize| i as f64 / (SIDE - 1) as f64 - 0.5;
    let points: Vec<[f64; 3]> =
        (0..SIDE * SIDE).map(|at| [across(at / SIDE), 0.01, across(at % SIDE)]).collect();
    let squares = (0..SIDE * (SIDE - 1)).filter(|at| at % SIDE != SIDE - 1);
    let triangles: Vec<[usize; 3]> =
        squares.flat_map(|a| [[a, a + 1, a + SIDE], [a + 1, a + SIDE + 1, a + SIDE]]).collect();
    let orders = [(1.0, 0.0), (0.0, 2.0), (1.0, 1.0), (2.0, 2.0), (3.0, 1.0)];
    let turn = std::f64::consts::PI;
    let motion = |(a, b): (f64, f64)| -> Vec<[f64; 3]> {
        let at =
            |[x, _, z]: &[f64; 3]| [0.0, (turn * a * (x + 0.5)).cos() * (turn * b * (z + 0.5)).cos(), 0.0];
        points.iter().map(at).collect()
    };
    let modes: Vec<String> = (0..orders.len())
        .map(|m| {
            let hz = 300.0 * (1.0 + 0.7 * m as f64);
            format!(
                r#"{{"frequency_hz": {hz:?}, "decay_per_s": 5.0, "amplitude": 1.0, "phase_rad": 1.5707963267948966}}"#
            )
        })
        .collect();
    let motions: Vec<Vec<[f64; 3]>> = orders.into_iter().map(motion).collect();
    let file = format!(
        r#"{{"format": "asperity.modes", "version": 2, "unit": "relative", "modes": [{}], "shapes": {{
            "points_m": {points:?}, "triangles": {triangles:?}, "gains": {:?},
            "phi_per_sqrt_kg": {motions:?}, "struck_point": 0}}}}"#,
        modes.join(","),
        vec![1.0; orders.len()],
    );
    ModalModel::parse(&file).unwrap()
}

#[test]
fn a_struck_plate_sounds_by_hand_in_middle_edge_and_corner() {
    let mut levels = Vec::new();
    for (x, z) in [(0.0, 0.0), (0.4, 0.0), (0.45, 0.45), (0.21, -0.37)] {
        let mut world = World::new(faces());
        let plate = world.scene.add_body(shaped_plate()).unwrap();
        let lies = RigidBodyBuilder::fixed().translation(Vector::new(0.0, 1.0, 0.0));
        let thing = Thing::of(Material::STEEL).ringing(plate);
        world.insert(lies, ColliderBuilder::cuboid(0.5, 0.01, 0.5), thing);
        let ball = of_mass(ColliderBuilder::ball(0.02), 0.05);
        let falling = at(x, 1.2, z).linvel(Vector::new(0.0, -2.0, 0.0));
        world.insert(falling, ball, Thing::of(Material::STEEL));
        world.run(0.6);
        let reported = world.impacts();
        let Engine { mut scene, mut renderer, .. } = {
            let mut config = Config::default();
            (config.sample_rate_hz, config.audio[0].limit) = (48_000.0, false);
            config.build().unwrap()
        };
        let by_hand = scene.add_body(shaped_plate()).unwrap();
        let impact = Impact { body: by_hand, at_m: None, direction: None, ..reported[0] };
        let impact = impact.at_m([f64::from(x), 0.01, f64::from(z)]);
        scene.report(0.0, ContactEvent::Impact(impact)).unwrap();
        let mut audio = vec![0.0; 28_800];
        renderer.render(&mut [&mut vec![0.0; audio.len()]], &mut [&mut audio]);
        let level_db = |sound: &[f32]| {
            let loudest = sound.iter().fold(0.0f32, |most, x| most.max(x.abs()));
            let begins = sound.iter().position(|x| x.abs() > 1e-3 * loudest).unwrap();
            let power: f64 = sound[begins..begins + 9600].iter().map(|x| f64::from(*x).powi(2)).sum();
            10.0 * power.log10()
        };
        let (through, hand) = (level_db(&world.heard), level_db(&audio));
        println!("({x}, {z}): {through:.3} dB, by hand {hand:.3}, {} blows", reported.len());
        assert!((through - hand).abs() < 0.1, "({x}, {z}): {through} dB, by hand {hand}");
        levels.push(hand);
    }
    assert!(levels[2] - levels[0] > 3.0, "places differ: {levels:?}");
}

/// A collider 0.6 m long and wide.
fn shape_of(name: &str) -> ColliderBuilder {
    match name {
        "ball" => ColliderBuilder::ball(0.3),
        "box" => ColliderBuilder::cuboid(0.3, 0.3, 0.3),
        "capsule" => ColliderBuilder::capsule_z(0.3, 0.3),
        "cylinder" => ColliderBuilder::cylinder(0.3, 0.3),
        "cone" => ColliderBuilder::cone(0.3, 0.3),
        _ => {
            let corners: Vec<Vector> = [-0.3, 0.3]
                .into_iter()
                .flat_map(|x| [-0.3, 0.0].map(|y| [x, y]))
                .flat_map(|[x, y]| [-0.2, 0.2].map(|z| Vector::new(x, y, z)))
                .collect();
            ColliderBuilder::convex_hull(&corners).unwrap()
        }
    }
}

#[test]
fn whatever_scrapes_or_rolls_has_a_contact_or_says_why_not() {
    let mut touching = 0;
    for shape in ["ball", "box", "capsule", "cylinder", "cone", "hull"] {
        for case in ["slides", "rolls", "spins", "belt", "wall", "hand", "unmapped"] {
            let mapping = if case == "unmapped" { Mapping::Mesh(vec![[0.0, 0.0]]) } else { faces() };
            let mut world = World::new(mapping);
            if case == "belt" {
                let (_, belt) = world.physics.insert(
                    RigidBodyBuilder::fixed(),
                    ColliderBuilder::cuboid(19.0, 0.1, 2.0).translation(Vector::new(0.0, -0.09, 0.0)),
                );
                let running = Thing::of(Material::STONE).running([1.0, 0.0, 0.0]);
                world.adapter.insert(belt, running.with_surface(world.top, faces()));
            }
            let (mut place, mut speed) = (Vector::new(-10.0, 0.305, 0.0), Vector::new(2.0, 0.0, 0.0));
            if case == "wall" {
                place = Vector::new(20.305, -10.0, 0.0);
                world.physics.gravity = Vector::new(-9.81, 0.0, 0.0);
                speed = Vector::new(0.0, -2.0, 0.0);
            }
            let body = match case {
                "hand" => RigidBodyBuilder::kinematic_velocity_based()
                    .translation(place - Vector::new(0.0, 0.01, 0.0)),
                _ => RigidBodyBuilder::dynamic().translation(place).can_sleep(false),
            };
            let body = match case {
                "spins" => {
                    body.enabled_translations(false, true, false).angvel(Vector::new(0.0, 20.0, -20.0))
                }
                "rolls" => body.linvel(speed).angvel(Vector::new(0.0, 0.0, -2.0 / 0.3)),
                "belt" => body.lock_rotations(),
                _ => body.linvel(speed).lock_rotations(),
            };
            let body = if shape == "cylinder" || shape == "cone" {
                body.rotation(Vector::new(std::f32::consts::FRAC_PI_2, 0.0, 0.0))
            } else {
                body
            };
            let collider = of_mass(shape_of(shape), 20.0)
                .friction(if case == "rolls" { 0.8 } else { 0.05 })
                .active_collision_types(ActiveCollisionTypes::all());
            let thing = Thing::of(Material::STEEL);
            let thing = if case == "hand" { thing.felt_by(ChannelId(0)) } else { thing };
            world.insert(body, collider, thing);
            let mut warned = Vec::new();
            for step in 0..60 {
                let reported = world.events.len();
                world.run(STEP_S);
                // What has just struck leaves again, or slides from the next step on.
                let is_impact = |event: &ContactEvent| matches!(event, ContactEvent::Impact(_));
                let struck = world.events[reported..].iter().any(is_impact);
                warned.extend(world.adapter.warnings().into_iter().map(|warning| warning.notice));
                let silent = world.scene.why_silent();
                for touch in world.adapter.touches().filter(|touch| touch.kind != Kind::Rests) {
                    touching += 1;
                    let says = touch.is_unplaced && warned.contains(&Notice::Unplaced) || !silent.is_empty();
                    assert!(
                        touch.contact.is_some() || struck || says,
                        "{shape} {case}, step {step}: {touch:?}, {warned:?}, {silent:?}"
                    );
                }
            }
            assert_eq!(world.scene.stats().refused, 0, "{shape} {case}");
        }
    }
    println!("{touching} touches");
    assert!(touching > 1000, "{touching} touches");
}

#[test]
fn from_a_gram_to_a_hundred_tonnes_nothing_is_refused() {
    let mut rng = asperity_dsp::rng::Rng::new(52);
    for run in 0..48 {
        let mass_kg = 1e-3 * 10f64.powf(8.0 * rng.uniform());
        let speed_m_s = 1e-3 * 10f64.powf(6.0 * rng.uniform());
        let spin_rad_s = 60f64.powf(rng.uniform());
        let half_m = (0.01 + 0.5 * rng.uniform()) as f32;
        let mut world = World::new(faces());
        let collider = match run % 3 {
            0 => ColliderBuilder::ball(half_m),
            1 => ColliderBuilder::cuboid(half_m, half_m, half_m),
            _ => ColliderBuilder::cylinder(half_m, half_m),
        };
        let (along, down) = ((speed_m_s * rng.uniform()) as f32, -(speed_m_s * rng.uniform()) as f32);
        let body = at(-15.0, 1.1 * half_m, 0.0).linvel(Vector::new(along, down, 0.0)).ccd_enabled(true);
        let body = body.angvel(Vector::new(spin_rad_s as f32, 0.0, -spin_rad_s as f32));
        world.insert(body, of_mass(collider, mass_kg as f32), Thing::of(Material::STONE));
        world.run(0.5);
        let stats = world.scene.stats();
        let what = format!("{mass_kg:.3} kg, {speed_m_s:.3} m/s, {spin_rad_s:.1} rad/s");
        assert_eq!(stats.refused, 0, "{what}: {:?}", world.scene.why_silent());
        assert!(world.heard.iter().all(|x| x.is_finite()), "{what}");
    }
}

#[test]
fn a_spinning_ball_is_heard_the_louder_the_faster_it_slips() {
    let mut before_db = f64::NEG_INFINITY;
    for spin_rad_s in [3.0f32, 6.0, 12.0, 25.0, 60.0] {
        let mut world = World::new(faces());
        let ball = of_mass(ColliderBuilder::ball(0.3), 20.0).friction(0.0);
        let ball = ball.friction_combine_rule(CoefficientCombineRule::Min);
        let wheel = at(0.0, 0.301, 0.0).can_sleep(false).enabled_translations(false, true, false);
        let wheel = world.insert(wheel, ball, Thing::of(Material::STEEL));
        let spin = |physics: &mut PhysicsWorld| {
            physics.bodies[wheel].set_angvel(Vector::new(0.0, 0.0, spin_rad_s), true);
        };
        world.run_by(1.0, spin);
        world.run_by(1.0, spin);
        let level_db = world.level_db();
        println!("{spin_rad_s} rad/s: {level_db:.1} dB");
        assert!(level_db > before_db + 1.0, "{spin_rad_s} rad/s: {level_db} dB after {before_db}");
        before_db = level_db;
    }
    assert!(before_db > -60.0);
}
