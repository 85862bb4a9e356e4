//! Several contacts on one body, several surfaces on one body, one actuator a finger: everything
//! adds up.

use crate::common;

use asperity::files::contact_log::{ContactLog, LogEvent, Names};
use asperity::offline::{self, Options, Render};
use asperity::{ActuatorSettings, Config};
use common::{SIDE_M, bar, grating, peak, plate, stroke_of};
use std::collections::HashMap;

fn take(log: &ContactLog) -> Render {
    let actuators = vec![ActuatorSettings { full_scale: 1.0, ..ActuatorSettings::default() }; 2];
    let asperity::Engine { mut scene, renderer, .. } =
        Config { actuators, ..Config::default() }.build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surfaces = HashMap::from([
        ("s".to_owned(), scene.add_surface(grating(2e-3, 2e-5).body(body)).unwrap()),
        ("other".to_owned(), scene.add_surface(plate(0.9).body(body)).unwrap()),
    ]);
    let names = Names { surfaces, bodies: HashMap::from([("b".to_owned(), body)]), ..Names::default() };
    offline::render(scene, renderer, log, &names, &Options::default()).unwrap()
}

/// A stroke on a surface, felt by one actuator.
fn finger(contact: u64, on: &str, channel: u16, speed_m_s: f64) -> ContactLog {
    let mut log = stroke_of(contact, SIDE_M, speed_m_s, 0.7, 0.5);
    for line in &mut log.lines {
        if let LogEvent::Begin { touching, .. } = &mut line.event {
            (touching.surface, touching.hand.actuator) = (on.to_owned(), Some(channel));
        }
    }
    log
}

fn together(a: &ContactLog, b: &ContactLog) -> ContactLog {
    let mut lines = [a.lines.clone(), b.lines.clone()].concat();
    lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    ContactLog { lines }
}

fn assert_adds_up(a: &ContactLog, b: &ContactLog) {
    let (first, second, both) = (take(a), take(b), take(&together(a, b)));
    let worst = both.audio[0]
        .iter()
        .zip(first.audio[0].iter().zip(&second.audio[0]))
        .map(|(both, (first, second))| f64::from((both - (first + second)).abs()))
        .fold(0.0, f64::max);
    assert!(peak(&first.audio[0]) > 0.0 && peak(&second.audio[0]) > 0.0);
    // The bank runs in f32, and modes fall asleep at an absolute level, each about −120 dB of full
    // scale, later when both fingers keep them awake.
    assert!(worst <= 2e-5 + 1e-5 * peak(&both.audio[0]), "{worst} of {}", peak(&both.audio[0]));
    assert!(worst <= 0.1 * peak(&both.audio[0]), "{worst} of {}", peak(&both.audio[0]));
    assert!(both.haptic[0] == first.haptic[0], "the first finger's actuator feels the second finger");
    assert!(both.haptic[1] == second.haptic[1], "the second finger's actuator feels the first finger");
    assert_eq!(peak(&first.haptic[1]), 0.0);
}

#[test]
fn two_contacts_on_one_body_sum_and_are_felt_apart() {
    assert_adds_up(&finger(1, "s", 0, 0.1), &finger(2, "s", 1, 0.17));
}

#[test]
fn two_surfaces_on_one_body_sound_as_their_sum() {
    assert_adds_up(&finger(1, "s", 0, 0.1), &finger(2, "other", 1, 0.13));
}

#[test]
fn two_contacts_on_one_actuator_are_felt_as_their_sum() {
    let (a, b) = (finger(1, "s", 0, 0.1), finger(2, "other", 0, 0.13));
    let (first, second, both) = (take(&a), take(&b), take(&together(&a, &b)));
    let scale = peak(&both.haptic[0]);
    for ((both, first), second) in both.haptic[0].iter().zip(&first.haptic[0]).zip(&second.haptic[0]) {
        assert!(f64::from((both - (first + second)).abs()) <= 1e-6 * scale);
    }
}
