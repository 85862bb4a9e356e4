//! A finger on a plate in an app without a window.

mod common;

use asperity::{ContactSample, Impact};
use bevy::prelude::*;
use bevy_asperity::*;
use common::*;
use std::time::Duration;

fn tell(app: &mut App, event: TouchEvent) {
    app.world_mut().write_message(event);
}

/// A finger strokes the plate for so many frames from `from` on, and stays on it.
fn stroke(app: &mut App, [toucher, surface]: [Entity; 2], frames: std::ops::Range<u32>) {
    for i in frames {
        let sample = sliding(f64::from(i) * STEP.as_secs_f64());
        let event = if i == 0 {
            TouchEvent::Begin { toucher, surface, sample }
        } else {
            TouchEvent::Move { toucher, sample }
        };
        tell(app, event);
        app.update();
    }
}

fn finger_and_plate(app: &mut App) -> [Entity; 2] {
    let plate = plate(app);
    [app.world_mut().spawn(TouchProbe::felt_by(0)).id(), plate]
}

fn played(app: &App) -> usize {
    app.world().resource::<NullOutput>().audio[0].len()
}

/// Peak of what was heard since sample `from`.
fn heard(app: &App, from: usize) -> f32 {
    peak(&app.world().resource::<NullOutput>().audio[0][from..])
}

#[test]
fn two_recorded_seconds_of_a_finger_render_the_same() {
    let mut app = app();
    let both = finger_and_plate(&mut app);
    touch(&mut app).start_recording();
    stroke(&mut app, both, 0..110);
    tell(&mut app, TouchEvent::End { toucher: both[0] });
    for _ in 0..15 {
        app.update();
    }
    assert_eq!(errors(&mut app), [""; 0]);
    assert!(peak(&app.world().resource::<NullOutput>().haptic[0]) > 1e-6);
    assert_same_bits(&mut app, 1);
}

#[test]
fn two_runs_of_the_same_app_give_the_same_samples() {
    let run = || {
        let mut app = app();
        let both = finger_and_plate(&mut app);
        stroke(&mut app, both, 0..60);
        app.world_mut().resource_mut::<NullOutput>().audio[0].clone()
    };
    assert_eq!(run(), run());
}

#[test]
fn the_null_output_renders_exactly_the_apps_own_time() {
    let mut app = app();
    for _ in 0..50 {
        app.update();
    }
    let elapsed = app.world().resource::<Time<Real>>().elapsed_secs_f64();
    assert_eq!(played(&app), (elapsed * 48_000.0) as usize);
    assert!(elapsed > 0.7);
}

#[test]
fn a_despawned_plate_rings_out_and_the_app_continues() {
    let mut app = app();
    let both = finger_and_plate(&mut app);
    stroke(&mut app, both, 0..30);
    assert!(heard(&app, 0) > 1e-6);
    app.world_mut().despawn(both[1]);
    assert_eq!((touch(&mut app).body(both[1]), touch(&mut app).surface(both[1])), (None, None));
    stroke(&mut app, both, 30..50);
    let mut levels = Vec::new();
    while levels.last() != Some(&0.0) {
        assert!(levels.len() < 40, "{levels:?}");
        let from = played(&app);
        (0..30).for_each(|_| app.update());
        levels.push(heard(&app, from));
    }
    assert!(levels.is_sorted_by(|before, after| after <= before), "{levels:?}");
    // The finger is told that it touches nothing, and can begin elsewhere.
    assert!(errors(&mut app).iter().all(|error| error.contains("touches nothing")));
    let other = plate(&mut app);
    let from = played(&app);
    stroke(&mut app, [both[0], other], 0..30);
    assert!(heard(&app, from) > 1e-6);
}

#[test]
fn a_finger_that_is_despawned_lifts_off() {
    let mut app = app();
    let both = finger_and_plate(&mut app);
    stroke(&mut app, both, 0..30);
    app.world_mut().despawn(both[0]);
    for _ in 0..5 {
        app.update();
    }
    let haptic = &app.world().resource::<NullOutput>().haptic[0];
    assert!(peak(haptic) > 1e-6);
    let from = haptic.len();
    app.update();
    assert!(peak(&app.world().resource::<NullOutput>().haptic[0][from..]) < 1e-6);
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn a_hitch_of_200_ms_leaves_no_hole_and_no_stuck_contact() {
    let mut app = app();
    let both = finger_and_plate(&mut app);
    stroke(&mut app, both, 0..40);
    frame(&mut app, Duration::from_millis(200));
    let from = played(&app);
    stroke(&mut app, both, 40..110);
    assert!(heard(&app, from) > 1e-6);
    let stats = touch(&mut app).stats();
    assert_eq!((stats.refused, stats.dropped, stats.quarantined), (0, 0, 0));
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn a_paused_game_is_silent_and_goes_on_where_it_was() {
    let mut app = app();
    let both = finger_and_plate(&mut app);
    stroke(&mut app, both, 0..30);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    for _ in 0..10 {
        app.update();
    }
    let from = played(&app);
    for _ in 0..60 {
        app.update();
    }
    assert_eq!(heard(&app, from), 0.0);
    assert!(played(&app) > from, "the output goes on");
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    let from = played(&app);
    stroke(&mut app, both, 30..60);
    assert!(heard(&app, from) > 1e-6);
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn components_that_come_and_go_keep_the_scene_in_step() {
    let mut app = app();
    let plate = plate(&mut app);
    let (body, surface) = (touch(&mut app).body(plate), touch(&mut app).surface(plate));
    assert!(body.is_some() && surface.is_some());
    // Inserted again they are replaced, under the same ids.
    app.world_mut().entity_mut(plate).insert((TouchBody(common::body()), TouchSurface::new(top())));
    assert_eq!((touch(&mut app).body(plate), touch(&mut app).surface(plate)), (body, surface));
    app.world_mut().entity_mut(plate).remove::<TouchSurface>();
    assert_eq!((touch(&mut app).body(plate), touch(&mut app).surface(plate)), (body, None));
    let skin = app.world_mut().spawn(TouchSurface::new(top()).on(plate)).id();
    assert!(touch(&mut app).surface(skin).is_some());
    app.world_mut().entity_mut(plate).remove::<TouchBody>();
    assert_eq!(touch(&mut app).body(plate), None);
    app.update();
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn thousands_of_plates_come_and_go_without_filling_the_scene() {
    let mut app = app();
    for _ in 0..600 {
        let plate = plate(&mut app);
        app.world_mut().despawn(plate);
        app.update();
    }
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn what_is_refused_is_told_as_a_message_in_the_engines_words() {
    let mut app = app();
    let [toucher, surface] = finger_and_plate(&mut app);
    let empty = app.world_mut().spawn_empty().id();
    let good = sliding(0.0);
    tell(
        &mut app,
        TouchEvent::Begin { toucher, surface, sample: ContactSample { normal_force_n: f64::NAN, ..good } },
    );
    tell(&mut app, TouchEvent::Begin { toucher, surface: empty, sample: good });
    tell(&mut app, TouchEvent::Move { toucher, sample: good });
    let impact = Impact { speed_m_s: -1.0, ..Impact::on(asperity::BodyId::from_bits(0)) };
    tell(&mut app, TouchEvent::Impact { body: surface, impact });
    tell(&mut app, TouchEvent::Impact { body: empty, impact });
    app.world_mut().spawn((TouchProbe::felt_by(7), Name::new("no such finger")));
    app.update();
    app.update();
    let told = errors(&mut app);
    let starts = [
        "normal_force_n",
        "surface: the entity has no TouchSurface",
        "toucher: touches nothing",
        "speed_m_s",
        "body: the entity has no TouchBody",
    ];
    assert_eq!(told.len(), starts.len(), "{told:?}");
    for (told, start) in told.iter().zip(starts) {
        assert!(told.starts_with(start), "{told:?} must start with {start:?}");
    }
}

#[test]
fn a_blow_that_a_finger_feels_stays_within_full_scale() {
    let mut app = app();
    let [_, body] = finger_and_plate(&mut app);
    let of_a_hammer = Impact { mass_kg: 0.02, ..Impact::on(asperity::BodyId::from_bits(0)) };
    let impact = Impact { speed_m_s: 1.0, actuator: Some(asperity::ChannelId(0)), ..of_a_hammer };
    tell(&mut app, TouchEvent::Impact { body, impact });
    for _ in 0..30 {
        app.update();
    }
    assert_eq!(errors(&mut app), [""; 0]);
    let felt = peak(&app.world().resource::<NullOutput>().haptic[0]);
    assert!(felt > 0.5 && felt <= 1.0, "{felt}");
}

#[test]
fn an_impossible_config_is_no_panic_and_the_app_runs_on() {
    let mut app = App::new();
    let config = asperity::Config { sample_rate_hz: -1.0, ..asperity::Config::default() };
    app.add_plugins(MinimalPlugins).add_plugins(AsperityPlugin { config, output: Output::default() });
    plate(&mut app);
    app.update();
    assert!(!app.world().contains_resource::<Touch>());
}
