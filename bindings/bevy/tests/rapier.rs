//! Contacts of bevy_rapier: a ball dropped on a plate, a block that slides over it.
#![cfg(feature = "rapier")]

mod common;

use asperity::Material;
use bevy::prelude::*;
use bevy_asperity::rapier::RapierTouchPlugin;
use bevy_asperity::*;
use bevy_rapier3d::prelude::*;
use common::*;

fn with_physics() -> App {
    let mut app = app();
    app.add_plugins(TransformPlugin)
        .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule())
        .insert_resource(TimestepMode::Fixed { dt: STEP.as_secs_f32(), substeps: 1 })
        .add_plugins(RapierTouchPlugin);
    app
}

fn world() -> (App, Entity) {
    let mut app = with_physics();
    let plate = plate(&mut app);
    app.world_mut().entity_mut(plate).insert((
        RigidBody::Fixed,
        Collider::cuboid(0.2, 0.01, 0.2),
        Friction::coefficient(0.05),
        Transform::default(),
        TouchThing::of(Material::CERAMIC).plane([-0.2, 0.01, -0.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4]),
    ));
    touch(&mut app).start_recording();
    (app, plate)
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
        Collider::ball(0.01),
        ColliderMassProperties::Density(7800.0),
        Restitution::coefficient(0.6),
        Transform::from_xyz(0.0, 0.15, 0.0),
        TouchThing::of(Material::STEEL),
    ));
    run(&mut app);
    let impacts = touch(&mut app).stats().impacts;
    assert!((2..40).contains(&impacts), "{impacts} impacts");
    assert_bounces(&assert_same_bits(&mut app, 1));
}

/// A block of 16 g that slides at 0.3 m/s.
fn block() -> impl Bundle {
    (
        RigidBody::Dynamic,
        Collider::cuboid(0.01, 0.01, 0.01),
        ColliderMassProperties::Density(2000.0),
        Friction::coefficient(0.05),
        Transform::from_xyz(-0.15, 0.021, 0.0),
        Velocity::linear(Vec3::new(0.3, 0.0, 0.0)),
    )
}

#[test]
fn a_sliding_block_and_its_recording_render_the_same_bits() {
    let (mut app, _) = world();
    app.world_mut().spawn((block(), TouchThing::of(Material::STEEL).felt_by(0)));
    run(&mut app);
    assert!(peak(&app.world().resource::<NullOutput>().haptic[0]) > 1e-6);
    assert_slides(&assert_same_bits(&mut app, 1), None);
}

#[test]
fn a_rolling_ball_reports_radius_and_little_slip_and_a_block_neither() {
    let (mut app, _) = world();
    app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::ball(0.01),
        ColliderMassProperties::Density(7800.0),
        Friction::coefficient(0.6),
        Transform::from_xyz(-0.15, 0.0201, 0.0),
        Velocity { linear: Vec3::new(0.2, 0.0, 0.0), angular: Vec3::new(0.0, 0.0, -20.0) },
        TouchThing::of(Material::STEEL),
    ));
    run(&mut app);
    assert_rolls(&assert_same_bits(&mut app, 1));
    let (mut app, _) = world();
    app.world_mut().spawn((block(), TouchThing::of(Material::STEEL)));
    run(&mut app);
    let log = assert_same_bits(&mut app, 1);
    let Slid { samples, .. } = slid(&log);
    assert!(samples.iter().all(|(_, sample)| sample.slip_m_s.is_none()) && samples.len() > 20);
}

#[test]
fn a_plate_despawned_under_a_sliding_block_is_no_panic() {
    let (mut app, plate) = world();
    app.world_mut().spawn((
        RigidBody::Dynamic,
        Collider::cuboid(0.01, 0.01, 0.01),
        Friction::coefficient(0.05),
        Transform::from_xyz(-0.15, 0.021, 0.0),
        Velocity::linear(Vec3::new(0.3, 0.0, 0.0)),
        TouchThing::of(Material::STEEL).felt_by(0),
    ));
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
            RigidBody::Fixed,
            Collider::cuboid(0.5, 0.01, 0.5),
            Transform::default(),
            TouchThing::of(Material::STEEL),
        ));
        touch(&mut app).start_recording();
        app.world_mut().spawn((
            RigidBody::Dynamic,
            Collider::ball(0.02),
            ColliderMassProperties::Density(1500.0),
            Transform::from_xyz(x, 0.2, z),
            Velocity::linear(Vec3::new(0.0, -2.0, 0.0)),
            TouchThing::of(Material::STEEL),
        ));
        run(&mut app);
        assert_sounds_as_told_at(&mut app, [x, z])
    });
    assert!(levels_db[3] - levels_db[0] > 3.0, "places differ: {levels_db:?}");
}
