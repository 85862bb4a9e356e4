//! A tracked finger in, a gamepad and a headset out, in an app without a window.

mod common;

use asperity::live::ports::{FramePoint, FrameStage};
use asperity::{Surface, SurfaceFrame};
use bevy::prelude::*;
use bevy_asperity::*;
use bevy_input::gamepad::GamepadRumbleRequest;
use common::*;

/// A plate of 40 cm whose top lies at height 0.
fn framed(app: &mut App) -> Entity {
    let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let top: Surface = top().frame(frame);
    app.world_mut().spawn((TouchBody(body()), TouchSurface::new(top))).id()
}

fn hand(app: &mut App) -> [Entity; 2] {
    let plate = framed(app);
    [app.world_mut().spawn((TouchProbe::felt_by(0), TouchTip::over([plate]))).id(), plate]
}

/// Frames of a hand that comes down to 5 mm below the top at 0.25 m/s and goes on along it
/// at 0.1 m/s.
fn follow(app: &mut App, finger: Entity, frames: std::ops::Range<u32>) {
    for frame in frames {
        let t = f64::from(frame) * STEP.as_secs_f64();
        let at = [0.05 + 0.1 * t, 0.2, (0.02 - 0.25 * t).max(-0.005)];
        app.world_mut().get_mut::<TouchTip>(finger).unwrap().position_m = Some(at);
        app.update();
    }
}

fn lift(app: &mut App, finger: Entity) {
    app.world_mut().get_mut::<TouchTip>(finger).unwrap().position_m = None;
    app.update();
}

#[test]
fn a_tracked_finger_presses_with_stiffness_times_depth() {
    let mut app = app();
    let [finger, _] = hand(&mut app);
    touch(&mut app).start_recording();
    follow(&mut app, finger, 0..110);
    lift(&mut app, finger);
    assert_eq!(errors(&mut app), [""; 0]);
    let log = assert_same_bits(&mut app, 1);
    let Slid { begins, ends, samples } = slid(&log);
    assert_eq!((begins.len(), begins[0].actuator, ends), (1, Some(0), 1));
    for (t, sample) in samples.iter().filter(|(t, _)| *t > 1.0) {
        assert!((sample.normal_force_n - 1.0).abs() < 1e-9, "200 N/m × 5 mm: {sample:?}");
        let [along_m_s, across_m_s] = sample.velocity_m_s.unwrap();
        assert!((along_m_s - 0.1).abs() < 1e-3 && across_m_s.abs() < 1e-9, "{sample:?}");
        // 2 √(m/k) behind the hand, whose frame is as old as the step.
        let u_m = 0.05 + 0.1 * (t - 0.0447);
        assert!((0.4 * sample.uv[0] - u_m).abs() < 0.1 * 2.0 * STEP.as_secs_f64(), "{sample:?} at {t} s");
    }
    assert!(peak(&app.world().resource::<NullOutput>().haptic[0]) > 1e-6);
}

#[test]
fn a_finger_on_a_plate_that_is_gone_touches_nothing() {
    let mut app = app();
    let [finger, plate] = hand(&mut app);
    follow(&mut app, finger, 0..30);
    assert_eq!(touch(&mut app).stats().contacts, 1);
    app.world_mut().despawn(plate);
    follow(&mut app, finger, 30..60);
    assert_eq!(touch(&mut app).stats().contacts, 0);
    let [other, _] = hand(&mut app);
    follow(&mut app, other, 0..30);
    assert_eq!(touch(&mut app).stats().contacts, 1);
    app.world_mut().despawn(other);
    (0..10).for_each(|_| app.update());
    assert_eq!(touch(&mut app).stats().contacts, 0);
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn a_surface_without_a_frame_is_told_once() {
    let mut app = app();
    let plate = plate(&mut app);
    let finger = app.world_mut().spawn(TouchTip::over([plate])).id();
    let mut told = Vec::new();
    for frame in 0..30 {
        follow(&mut app, finger, frame..frame + 1);
        told.extend(errors(&mut app));
    }
    assert!(told.len() == 1 && told[0].contains("frame"), "{told:?}");
}

#[test]
fn a_gamepad_rumbles_while_a_finger_slides_and_stops_with_it() {
    let mut app = app();
    let [finger, _] = hand(&mut app);
    let pad = app.world_mut().spawn(TouchRumble::of(0).fully_at(0.1)).id();
    let requests = |app: &mut App| -> Vec<GamepadRumbleRequest> {
        app.world_mut().resource_mut::<Messages<GamepadRumbleRequest>>().drain().collect()
    };
    app.update();
    assert!(requests(&mut app).is_empty(), "nothing is felt yet");
    let mut added = Vec::new();
    for frame in 0..100 {
        follow(&mut app, finger, frame..frame + 1);
        let told = requests(&mut app);
        assert!(told.iter().all(|request| match request {
            GamepadRumbleRequest::Add { gamepad, .. } | GamepadRumbleRequest::Stop { gamepad } =>
                *gamepad == pad,
        }));
        // What rumbled before is stopped first: rumbles add up.
        assert!(told.is_empty() || matches!(told[0], GamepadRumbleRequest::Stop { .. }));
        added.extend(told.iter().filter_map(|request| match request {
            GamepadRumbleRequest::Add { intensity, .. } => Some(*intensity),
            GamepadRumbleRequest::Stop { .. } => None,
        }));
    }
    assert!((30..=52).contains(&added.len()), "{} requests", added.len());
    assert!(added.iter().all(|level| (0.0..=1.0).contains(&level.strong_motor)));
    assert!(added.iter().any(|level| level.weak_motor > 0.02 || level.strong_motor > 0.02), "{added:?}");
    lift(&mut app, finger);
    let mut told = Vec::new();
    for _ in 0..40 {
        app.update();
        told.extend(requests(&mut app));
    }
    assert!(matches!(told.last(), Some(GamepadRumbleRequest::Stop { .. })));
    (0..10).for_each(|_| app.update());
    assert!(requests(&mut app).is_empty(), "a pad that stands is left alone");
    assert_eq!(errors(&mut app), [""; 0]);
}

#[test]
fn a_headset_gets_frames_in_the_order_of_the_extension() {
    let mut app = app();
    let [finger, _] = hand(&mut app);
    let controller = app.world_mut().spawn(TouchHeadset::of(0)).id();
    let [mut firsts, mut lasts, mut streams, mut ends_ns] = [0i64; 4];
    for frame in 0..180 {
        if frame < 100 {
            follow(&mut app, finger, frame..frame + 1);
        } else {
            lift(&mut app, finger);
        }
        for frame in app.world().get::<TouchHeadset>(controller).unwrap().frames() {
            let begins = frame.stage == FrameStage::First;
            assert_eq!((streams == 0, frame.band_hz.is_some()), (begins, begins));
            let from = if begins { 0 } else { ends_ns };
            let times: Vec<i64> = frame.points.iter().map(|point| point.time_ns).collect();
            assert!(times.is_sorted() && times[0] >= from && !(begins && times[0] != 0), "{frame:?}");
            let share = |x: f32| (0.0..=1.0).contains(&x);
            assert!(
                frame.points.iter().all(|FramePoint { amplitude, frequency, .. }| {
                    share(*amplitude) && share(*frequency)
                })
            );
            ends_ns = *times.last().unwrap();
            assert!(!begins || ends_ns >= 50_000_000);
            firsts += i64::from(begins);
            lasts += i64::from(frame.stage == FrameStage::Last);
            streams = i64::from(frame.stage != FrameStage::Last);
        }
    }
    assert!(firsts == 1 && lasts == 1, "{firsts} begun, {lasts} ended");
    let counts = app.world().get::<TouchHeadset>(controller).unwrap().counts();
    assert!(counts.framed > 100 && counts.dropped == 0, "{counts:?}");
    // The first frame takes no time, the last one is played when its points have been read.
    assert_eq!(counts.framed + counts.silent, 178 * 16 / 10, "{counts:?}");
    assert_eq!(errors(&mut app), [""; 0]);
    let nobody = app.world_mut().spawn(TouchHeadset::of(7)).id();
    app.update();
    app.update();
    assert!(errors(&mut app)[0].starts_with("actuator"));
    assert!(app.world().get::<TouchHeadset>(nobody).unwrap().frames().is_empty());
}
