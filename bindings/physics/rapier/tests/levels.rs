//! Levels of live engines that a rapier world plays: nothing has a gain of its own, and what drops
//! and slides stays within full scale.

use asperity::{Body, Config, ContactEvent, Engine, Material, Stock, Surface};
use asperity_dsp::rng::Rng;
use asperity_rapier::{Adapter, Mapping, Thing};
use rapier3d::prelude::*;

const STEP_S: f64 = 1.0 / 60.0;

fn material(rng: &mut Rng) -> Material {
    Material::PRESETS[(rng.uniform() * Material::PRESETS.len() as f64) as usize].material
}

fn stock(rng: &mut Rng) -> Stock {
    Stock::ALL[(rng.uniform() * Stock::ALL.len() as f64) as usize].1
}

/// A collider of a mass, about as large as wood of it, and half its height, m.
fn collider(rng: &mut Rng, mass_kg: f64) -> (ColliderBuilder, f32) {
    let half_m = (0.5 * (mass_kg / 700.0).cbrt()) as f32;
    let shape = match (4.0 * rng.uniform()) as u32 {
        0 => ColliderBuilder::ball(half_m),
        1 => ColliderBuilder::cylinder(half_m, half_m),
        _ => ColliderBuilder::cuboid(1.5 * half_m, half_m, half_m),
    };
    (shape.mass(mass_kg as f32).friction(0.1), half_m)
}

/// A thing of 10 g to 100 kg that falls 0.3 m onto ground of 1 µm to 1 mm and goes on at 1 m/s,
/// then 1.2 m and at 2 m/s; by how much limiters turn down, dB, where all of it is reported or its
/// blows alone.
fn limited_db(rng: &mut Rng, strokes: bool) -> f64 {
    let [mass_kg, relief_m] =
        [10f64.powf(-2.0 + 4.0 * rng.uniform()), 10f64.powf(-6.0 + 3.0 * rng.uniform())];
    let Engine { mut scene, mut renderer, .. } = Config::live(48_000.0).build().unwrap();
    let mut adapter = Adapter::new(&mut scene).unwrap();
    let mut physics = PhysicsWorld::default();
    physics.integration_parameters.contact_recycling = false;
    let of = material(rng);
    let ground = Surface::flat(8.0, 8.0).unwrap().material(of).micro_relief_m(relief_m).wraps(false);
    let mut floor = Thing::of(of);
    let ground = if rng.uniform() < 0.7 {
        let slab = scene.add_body(Body::stock(Stock::Plate, of, 0.5).unwrap()).unwrap();
        floor = floor.ringing(slab);
        ground.body(slab)
    } else {
        ground
    };
    let top = scene.add_surface(ground).unwrap();
    let place = ColliderBuilder::cuboid(4.0, 0.5, 4.0).translation(Vector::new(0.0, -0.5, 0.0));
    let (_, place) = physics.insert(RigidBodyBuilder::fixed(), place.friction(0.1));
    let plane = Mapping::plane([-4.0, 0.5, -4.0], [8.0, 0.0, 0.0], [0.0, 0.0, 8.0]);
    adapter.insert(place, floor.with_surface(top, plane));
    let size_m = 0.3 * (mass_kg / 5.0).cbrt().clamp(0.1, 3.0);
    let (kind, of) = (stock(rng), material(rng));
    let rings = scene.add_body(Body::stock(kind, of, size_m).unwrap()).unwrap();
    let (shape, half_m) = collider(rng, mass_kg);
    let lies = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 10.0, 0.0));
    let (body, shape) = physics.insert(lies, shape);
    adapter.insert(shape, Thing::of(of).ringing(rings));
    let (mut steps, mut most) = (0u32, 0.0f32);
    for faster in [1.0f32, 2.0] {
        let thing = &mut physics.bodies[body];
        thing.set_position(
            Pose::from_translation(Vector::new(-2.0, half_m + 0.3 * faster * faster, 0.0)),
            true,
        );
        thing.set_linvel(faster * Vector::new(0.8, 0.0, 0.6), true);
        thing.set_angvel(Vector::ZERO, true);
        for _ in 0..72 {
            adapter.before_step(&(&physics).into());
            physics.step();
            let reported = adapter.after_step(&(&physics).into()).into_iter();
            for event in reported.filter(|event| strokes || matches!(event, ContactEvent::Impact(_))) {
                scene.report(f64::from(steps) * STEP_S, event).unwrap();
            }
            steps += 1;
            let (mut haptic, mut audio) = ([0.0; 800], [0.0; 800]);
            renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            most = haptic.iter().chain(&audio).fold(most, |most, x| most.max(x.abs()));
        }
    }
    assert!(scene.stats().impacts > 1, "{mass_kg} kg: {:?}", scene.stats());
    assert!(most <= 1.0, "{mass_kg} kg: {most} over full scale");
    renderer.limiter_db()
}

/// Number of sixty of which limiters take 6 dB at most.
fn within(strokes: bool) -> usize {
    let mut rng = Rng::new(5460);
    let limited: Vec<f64> = (0..60).map(|_| limited_db(&mut rng, strokes)).collect();
    let within = limited.iter().filter(|by_db| **by_db <= 6.0).count();
    let most_db = limited.iter().fold(0.0, |a, b| f64::max(a, *b));
    println!("limiter ≤ 6 dB in {within} of 60, at most {most_db:.1} dB");
    within
}

#[test]
fn sixty_things_that_drop_without_a_gain_need_next_to_no_limiter() {
    assert!(within(false) >= 55);
}

#[test]
fn sixty_dropped_things_stay_within_full_scale() {
    assert!(within(true) >= 54);
}
