//! Levels of live engines that a rapier world plays: nothing has a gain of its own, and what drops
//! and slides stays within full scale.

mod drawn;

use asperity::{Config, ContactEvent, Engine};
use asperity_rapier::{Adapter, Mapping, Thing};
use drawn::{Drawn, within};
use rapier3d::prelude::*;

const STEP_S: f64 = 1.0 / 60.0;

fn collider(drawn: &Drawn) -> ColliderBuilder {
    let half_m = drawn.half_m;
    let shape = match drawn.shape {
        0 => ColliderBuilder::ball(half_m),
        1 => ColliderBuilder::cylinder(half_m, half_m),
        _ => ColliderBuilder::cuboid(1.5 * half_m, half_m, half_m),
    };
    shape.mass(drawn.mass_kg as f32).friction(0.1)
}

/// A thing that falls 0.3 m and goes on at 1 m/s, then 1.2 m and at 2 m/s; by how much limiters
/// turn down, dB, where all of it is reported or its blows alone.
fn limited_db(drawn: Drawn, strokes: bool) -> f64 {
    let (mass_kg, half_m, shape) = (drawn.mass_kg, drawn.half_m, collider(&drawn));
    let Engine { mut scene, mut renderer, .. } = Config::live(48_000.0).build().unwrap();
    let mut adapter = Adapter::new(&mut scene).unwrap();
    let mut physics = PhysicsWorld::default();
    physics.integration_parameters.contact_recycling = false;
    let (mut floor, mut ground) = (Thing::of(drawn.ground_of), drawn.ground);
    if let Some(slab) = drawn.slab.map(|slab| scene.add_body(slab).unwrap()) {
        floor = floor.ringing(slab);
        ground = ground.body(slab);
    }
    let top = scene.add_surface(ground).unwrap();
    let place = ColliderBuilder::cuboid(4.0, 0.5, 4.0).translation(Vector::new(0.0, -0.5, 0.0));
    let (_, place) = physics.insert(RigidBodyBuilder::fixed(), place.friction(0.1));
    let plane = Mapping::plane([-4.0, 0.5, -4.0], [8.0, 0.0, 0.0], [0.0, 0.0, 8.0]);
    adapter.insert(place, floor.with_surface(top, plane));
    let rings = scene.add_body(drawn.thing).unwrap();
    let lies = RigidBodyBuilder::dynamic().translation(Vector::new(0.0, 10.0, 0.0));
    let (body, shape) = physics.insert(lies, shape);
    adapter.insert(shape, Thing::of(drawn.thing_of).ringing(rings));
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

#[test]
fn sixty_things_that_drop_without_a_gain_need_next_to_no_limiter() {
    assert!(within(|drawn| limited_db(drawn, false)) >= 55);
}

#[test]
fn sixty_dropped_things_stay_within_full_scale() {
    assert!(within(|drawn| limited_db(drawn, true)) >= 54);
}
