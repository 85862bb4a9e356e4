//! A finger strokes a ceramic plate on the sound card, for three seconds of an app without a
//! window; Bevy's own loop keeps the time.
//!
//! ```sh
//! cargo run --features device --example aloud
//! ```

use bevy::app::ScheduleRunnerPlugin;
use bevy::prelude::*;
use bevy_asperity::asperity::{Body, ContactSample, Material, Stock, Surface};
use bevy_asperity::{
    AsperityPlugin, Output, Touch, TouchBody, TouchError, TouchEvent, TouchProbe, TouchSurface,
};
use std::time::Duration;

const SECONDS: f64 = 3.0;

#[derive(Resource)]
struct Things {
    plate: Entity,
    finger: Entity,
}

fn main() -> AppExit {
    let loops = ScheduleRunnerPlugin::run_loop(Duration::from_secs_f64(1.0 / 60.0));
    App::new()
        .add_plugins(MinimalPlugins.set(loops))
        .add_plugins(AsperityPlugin::to(Output::Device(Default::default())))
        .add_systems(Startup, level)
        .add_systems(FixedUpdate, stroke.run_if(resource_exists::<Touch>))
        .add_systems(Update, complain)
        .run()
}

fn level(mut commands: Commands) {
    let body = Body::stock(Stock::Plate, Material::CERAMIC, 0.4).expect("0.4 m is a plate's size");
    let top = Surface::flat(0.4, 0.4).expect("0.4 m is a surface's size").material(Material::CERAMIC);
    let plate = commands.spawn((TouchBody(body), TouchSurface::new(top))).id();
    let finger = commands.spawn(TouchProbe::felt_by(0)).id();
    commands.insert_resource(Things { plate, finger });
}

/// To and fro over 20 cm, once in two seconds, with 0.7 N.
fn stroke(
    time: Res<Time<Fixed>>,
    things: Res<Things>,
    mut begun: Local<bool>,
    mut events: MessageWriter<TouchEvent>,
    mut touch: ResMut<Touch>,
    mut exit: MessageWriter<AppExit>,
) {
    let t = time.elapsed_secs_f64();
    let (sin, cos) = (std::f64::consts::PI * t).sin_cos();
    let velocity_m_s = [0.1 * std::f64::consts::PI * cos, 0.0];
    let sample = ContactSample::new([0.5 + 0.25 * sin, 0.5], 0.7).sliding(velocity_m_s);
    let &Things { plate, finger } = &*things;
    events.write(if *begun {
        TouchEvent::Move { toucher: finger, sample }
    } else {
        TouchEvent::Begin { toucher: finger, surface: plate, sample }
    });
    *begun = true;
    if t >= SECONDS {
        let stats = touch.stats();
        println!("{SECONDS} s: {} samples, {} reports", stats.position, stats.events);
        exit.write(AppExit::Success);
    }
}

/// Without a sound card this is where the reason comes.
fn complain(mut refused: MessageReader<TouchError>, mut exit: MessageWriter<AppExit>) {
    for error in refused.read() {
        eprintln!("error: {}", error.text);
        exit.write(AppExit::error());
    }
}
