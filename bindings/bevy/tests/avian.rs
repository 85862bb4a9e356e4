//! Contacts of avian: a ball dropped on a plate, a block that slides over it.
#![cfg(feature = "avian")]

mod common;
#[path = "../../physics/rapier/tests/drawn/mod.rs"]
mod drawn;

use asperity::Material;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_asperity::avian::{self, AvianTouchPlugin};
use bevy_asperity::*;
use common::*;
use drawn::{Drawn, within};

fn with_physics() -> App {
    let mut app = app();
    app.add_plugins(TransformPlugin).add_plugins(PhysicsPlugins::default()).add_plugins(AvianTouchPlugin);
    app
}

fn world() -> (App, Entity) {
    let mut app = with_physics();
    let plate = plate(&mut app);
    app.world_mut().entity_mut(plate).insert((
        RigidBody::Static,
        Collider::cuboid(0.4, 0.02, 0.4),
        Friction::new(0.05),
        Transform::default(),
        TouchThing::of(Material::CERAMIC).plane([-0.2, 0.01, -0.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4]),
    ));
    app.finish();
    app.cleanup();
    touch(&mut app).start_recording();
    (app, plate)
}

fn block() -> impl Bundle {
    (
        RigidBody::Dynamic,
        Collider::cuboid(0.02, 0.02, 0.02),
        ColliderDensity(2000.0),
        Friction::new(0.05),
        Transform::from_xyz(-0.15, 0.021, 0.0),
        LinearVelocity(Vec3::new(0.3, 0.0, 0.0)),
        TouchThing::of(Material::STEEL).felt_by(0),
    )
}

fn run(app: &mut App) {
    for _ in 0..126 {
        app.update();
    }
    assert_eq!(errors(app), [""; 0]);
}

#[test]
fn a_ball_dropped_on_a_plate_and_its_recording_sound_alike() {
    let (mut app, _) = world();
    app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::sphere(0.01),
        ColliderDensity(7800.0),
        Restitution::new(0.6),
        Transform::from_xyz(0.0, 0.15, 0.0),
        TouchThing::of(Material::STEEL),
    ));
    run(&mut app);
    let impacts = touch(&mut app).stats().impacts;
    assert!((2..40).contains(&impacts), "{impacts} impacts");
    assert_bounces(&assert_same_bits(&mut app, 1));
}

#[test]
fn a_sliding_block_and_its_recording_render_the_same_bits() {
    let (mut app, _) = world();
    app.world_mut().spawn(block());
    run(&mut app);
    assert!(peak(&app.world().resource::<NullOutput>().haptic[0]) > 1e-6);
    assert_slides(&assert_same_bits(&mut app, 1), None);
}

#[test]
fn a_loose_block_scrapes_as_a_rigid_thing_and_rests_silently() {
    let (mut app, _) = world();
    let block = app.world_mut().spawn(block()).id();
    app.world_mut().entity_mut(block).insert(TouchThing::of(Material::STEEL));
    run(&mut app);
    assert_slides(&assert_same_bits(&mut app, 1), Some(avian::RIGID_PROBE));
}

#[test]
fn a_rolling_ball_carries_its_contact_and_a_finger_lands_as_one() {
    let (mut app, _) = world();
    app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::sphere(0.01),
        ColliderDensity(7800.0),
        Friction::new(0.6),
        Transform::from_xyz(-0.15, 0.0201, 0.0),
        LinearVelocity(Vec3::new(0.2, 0.0, 0.0)),
        AngularVelocity(Vec3::new(0.0, 0.0, -20.0)),
        TouchThing::of(Material::STEEL),
    ));
    run(&mut app);
    assert_rolls(&assert_same_bits(&mut app, 1));
    // A finger that comes down.
    let (mut app, _) = world();
    app.world_mut().spawn((
        RigidBody::Dynamic,
        LockedAxes::ROTATION_LOCKED,
        Collider::sphere(0.008),
        Transform::from_xyz(0.0, 0.05, 0.0),
        LinearVelocity(Vec3::new(0.0, -0.5, 0.0)),
        TouchThing::of(Material::NAIL).felt_by(0),
    ));
    run(&mut app);
    let log = assert_same_bits(&mut app, 1);
    assert!(impacts(&log).is_empty(), "a finger strikes");
    let Slid { begins, samples, .. } = slid(&log);
    assert!(begins[0].actuator == Some(0) && begins[0].probe.is_none(), "{begins:?}");
    // 0.5 m/s and 3.2 cm of fall: 0.94 m/s.
    assert!((samples[0].1.closing_m_s - 0.94).abs() < 0.2, "{:?}", samples[0]);
}

#[test]
fn landing_rods_strike_with_a_quarter_mass_and_two_balls_with_half() {
    let (mut app, _) = world();
    app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::cuboid(0.2, 0.001, 0.001),
        ColliderDensity(8000.0),
        Transform::from_xyz(0.0, 0.1, 0.0).with_rotation(Quat::from_rotation_z(0.1)),
        TouchThing::of(Material::STEEL),
    ));
    run(&mut app);
    let blows = impacts(&touch(&mut app).stop_recording());
    // n·K n = 1/m + (L/2)² / (m L² / 12) = 4/m.
    let quarter_kg = 8000.0 * 0.2e-6 / 4.0;
    assert!((blows[0][2] / quarter_kg - 1.0).abs() < 0.05, "{} kg, must be near {quarter_kg}", blows[0][2]);
    let (mut app, _) = world();
    app.insert_resource(Gravity(Vec3::ZERO));
    for (x, speed_m_s) in [(-0.1, 1.0), (0.1, -0.5)] {
        app.world_mut().spawn((
            RigidBody::Dynamic,
            Collider::sphere(0.02),
            ColliderDensity(2000.0),
            Restitution::new(0.9),
            Transform::from_xyz(x, 0.5, 0.0),
            LinearVelocity(Vec3::new(speed_m_s, 0.0, 0.0)),
            TouchBody(body()),
            TouchThing::of(Material::BRASS),
        ));
    }
    run(&mut app);
    let blows = impacts(&touch(&mut app).stop_recording());
    assert_eq!(blows.len(), 1, "{blows:?}");
    let mass_kg = 2000.0 * 4.0 / 3.0 * std::f64::consts::PI * 8e-6;
    let [_, speed_m_s, mass, radius_m, _] = blows[0];
    assert!((speed_m_s - 1.5).abs() < 0.02 && (radius_m - 0.01).abs() < 1e-6, "{:?}", blows[0]);
    assert!((mass / (mass_kg / 2.0) - 1.0).abs() < 0.01, "{mass} kg, must be half of {mass_kg}");
}

#[test]
fn a_plate_despawned_under_a_sliding_block_is_no_panic() {
    let (mut app, plate) = world();
    app.world_mut().spawn(block());
    for _ in 0..20 {
        app.update();
    }
    app.world_mut().despawn(plate);
    run(&mut app);
}

#[test]
fn a_struck_plate_sounds_by_hand_in_middle_edge_and_corner() {
    let levels_db = PLACES_M.map(|[x, z]| {
        let mut app = with_physics();
        app.world_mut().spawn((
            TouchBody(shaped_plate()),
            RigidBody::Static,
            Collider::cuboid(1.0, 0.02, 1.0),
            Transform::default(),
            TouchThing::of(Material::STEEL),
        ));
        app.finish();
        app.cleanup();
        touch(&mut app).start_recording();
        app.world_mut().spawn((
            RigidBody::Dynamic,
            Collider::sphere(0.02),
            ColliderDensity(1500.0),
            Transform::from_xyz(x, 0.2, z),
            LinearVelocity(Vec3::new(0.0, -2.0, 0.0)),
            TouchThing::of(Material::STEEL),
        ));
        run(&mut app);
        assert_sounds_as_told_at(&mut app, [x, z])
    });
    assert!(levels_db[3] - levels_db[0] > 3.0, "places differ: {levels_db:?}");
}

/// A thing that falls 0.3 m and goes on at 1 m/s, then 1.2 m and at 2 m/s; by how much limiters
/// turn down, dB, rounded up.
fn limited_db(drawn: Drawn) -> f64 {
    let (mass_kg, half_m) = (drawn.mass_kg, drawn.half_m);
    let mut app = with_physics();
    let mut ground = app.world_mut().spawn((
        RigidBody::Static,
        Collider::cuboid(8.0, 1.0, 8.0),
        Friction::new(0.1),
        Transform::from_xyz(0.0, -0.5, 0.0),
        TouchThing::of(drawn.ground_of).plane([-4.0, 0.5, -4.0], [8.0, 0.0, 0.0], [0.0, 0.0, 8.0]),
    ));
    if let Some(slab) = drawn.slab {
        ground.insert(TouchBody(slab));
    }
    ground.insert(TouchSurface::new(drawn.ground));
    let shape = match drawn.shape {
        0 => Collider::sphere(half_m),
        1 => Collider::cylinder(half_m, 2.0 * half_m),
        _ => Collider::cuboid(3.0 * half_m, 2.0 * half_m, 2.0 * half_m),
    };
    let density = ColliderDensity(mass_kg as f32 / shape.mass_properties(1.0).mass);
    let (ringing, of) = (TouchBody(drawn.thing), TouchThing::of(drawn.thing_of));
    let thing = (RigidBody::Dynamic, shape, density, Friction::new(0.1), ringing, of);
    let thing = app.world_mut().spawn(thing).id();
    app.finish();
    app.cleanup();
    for faster in [1.0, 2.0] {
        app.world_mut().entity_mut(thing).insert((
            Transform::from_xyz(-2.0, half_m + 0.3 * faster * faster, 0.0),
            LinearVelocity(faster * Vec3::new(0.8, 0.0, 0.6)),
            AngularVelocity(Vec3::ZERO),
        ));
        (0..75).for_each(|_| app.update());
    }
    assert_eq!(errors(&mut app), [""; 0]);
    let stats = touch(&mut app).stats();
    let played = app.world().resource::<NullOutput>();
    let most = peak(&played.audio[0]).max(peak(&played.haptic[0]));
    assert!(stats.impacts > 1 && most > 1e-6, "{mass_kg} kg: {most}, {stats:?}");
    assert!(most <= 1.0, "{mass_kg} kg: {most} over full scale");
    // It is counted in whole dB, of which a part is cut off.
    stats.limiter_db as f64 + 1.0
}

#[test]
fn sixty_dropped_things_stay_within_full_scale() {
    // 54 when it was written; a drop is chaotic, and processors round differently.
    assert!(within(limited_db) >= 52);
}
