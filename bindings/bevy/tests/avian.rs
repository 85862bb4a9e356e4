//! Contacts of avian: a ball dropped on a plate, a block that slides over it.
#![cfg(feature = "avian")]

mod common;

use asperity::Material;
use avian3d::prelude::*;
use bevy::prelude::*;
use bevy_asperity::avian::AvianTouchPlugin;
use bevy_asperity::*;
use common::*;

fn world() -> (App, Entity) {
    let mut app = app();
    app.add_plugins(TransformPlugin).add_plugins(PhysicsPlugins::default()).add_plugins(AvianTouchPlugin);
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
fn a_ball_dropped_on_a_plate_strikes_it_and_the_recording_renders_to_the_same_bits() {
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
    assert_same_bits(&mut app, 1);
}

#[test]
fn a_block_that_slides_over_a_plate_is_heard_and_felt_and_the_recording_renders_to_the_same_bits() {
    let (mut app, _) = world();
    app.world_mut().spawn(block());
    run(&mut app);
    assert!(peak(&app.world().resource::<NullOutput>().haptic[0]) > 1e-6);
    assert_same_bits(&mut app, 1);
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
