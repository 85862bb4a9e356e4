//! A steel ball dropped on a ceramic plate: rapier moves it, asperity sounds. Without a window and
//! without a sound card; what would be heard is told in words.
//!
//! ```sh
//! cargo run --features rapier --example dropped_ball
//! ```

use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_asperity::asperity::{Body, Material, Stock, Surface};
use bevy_asperity::rapier::RapierTouchPlugin;
use bevy_asperity::{
    AsperityPlugin, NullOutput, Output, Touch, TouchBody, TouchError, TouchSurface, TouchThing,
};
use bevy_rapier3d::prelude::*;
use std::time::Duration;

const STEP: Duration = Duration::from_millis(16);

fn main() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin))
        .add_plugins(RapierPhysicsPlugin::<NoUserData>::default().in_fixed_schedule())
        .insert_resource(TimestepMode::Fixed { dt: STEP.as_secs_f32(), substeps: 1 })
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        // The app's time by hand, so that the example does not take as long as the ball.
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP))
        .add_plugins(AsperityPlugin::to(Output::Null { keep: true }))
        .add_plugins(RapierTouchPlugin)
        .add_systems(Startup, level)
        .add_systems(Update, complain);
    for _ in 0..125 {
        app.update();
    }
    let impacts = app.world_mut().resource_mut::<Touch>().stats().impacts;
    let played = &app.world().resource::<NullOutput>().audio[0];
    println!("{} s, {impacts} impacts", played.len() / 48_000);
    for (i, tenth) in played.chunks(4800).enumerate() {
        let peak = tenth.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        println!("{:.1} s {}", i as f32 / 10.0, "#".repeat((40.0 * peak.sqrt()) as usize));
    }
}

fn level(mut commands: Commands) {
    let plate = Body::stock(Stock::Plate, Material::CERAMIC, 0.4).expect("0.4 m is a plate's size");
    let top =
        Surface::flat(0.4, 0.4).expect("0.4 m is a surface's size").material(Material::CERAMIC).wraps(false);
    commands.spawn((
        TouchBody(plate),
        TouchSurface::new(top),
        TouchThing::of(Material::CERAMIC).plane([-0.2, 0.01, -0.2], [0.4, 0.0, 0.0], [0.0, 0.0, 0.4]),
        RigidBody::Fixed,
        Collider::cuboid(0.2, 0.01, 0.2),
        Transform::default(),
    ));
    commands.spawn((
        TouchThing::of(Material::STEEL),
        RigidBody::Dynamic,
        Collider::ball(0.01),
        ColliderMassProperties::Density(7800.0),
        Restitution::coefficient(0.7),
        Transform::from_xyz(0.0, 0.15, 0.0),
    ));
}

fn complain(mut refused: MessageReader<TouchError>) {
    for error in refused.read() {
        eprintln!("{:?}: {}", error.entity, error.text);
    }
}
