//! Hostile games: bad numbers, floods, stalls, too many contacts. Nothing panics, every sample is
//! finite, every loss is counted.

use crate::common;

use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Refusal, Renderer, Scene, SurfaceId,
};
use common::{bar, plate};

fn engine(config: Config) -> (Scene, Renderer, SurfaceId) {
    let asperity::Engine { mut scene, renderer, .. } = config.build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(plate(0.8).body(body)).unwrap();
    (scene, renderer, surface)
}

fn sample(u: f64) -> ContactSample {
    ContactSample {
        uv: [u, 0.5],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    }
}

fn run(renderer: &mut Renderer, frames: usize) -> f32 {
    let (mut haptic, mut audio) = (vec![0.0; frames], vec![0.0; frames]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    haptic.iter().chain(&audio).fold(0.0, |peak, x| {
        assert!(x.is_finite());
        f32::max(peak, x.abs())
    })
}

#[test]
fn bad_numbers_are_handed_back_with_the_name_of_their_field() {
    let (mut scene, mut renderer, surface) = engine(Config::default());
    let contact = ContactId(1);
    scene.report(0.0, ContactEvent::begin(contact, surface, ChannelId(0), sample(0.1))).unwrap();
    for bad in [f64::NAN, f64::INFINITY] {
        let event = ContactEvent::moved(contact, ContactSample { normal_force_n: bad, ..sample(0.1) });
        let refused = scene.report(0.01, event).unwrap_err();
        assert!(refused.to_string().starts_with("normal_force_n: "), "{refused}");
    }
    assert!(matches!(
        scene.report(-1.0, ContactEvent::end(contact)).unwrap_err().reason,
        Refusal::BadValue(_)
    ));
    scene.report(0.02, ContactEvent::moved(contact, sample(0.11))).unwrap();
    let backwards = scene.report(0.01, ContactEvent::end(contact)).unwrap_err();
    assert!(matches!(backwards.reason, Refusal::TimeBackwards { .. }));
    let elsewhere = ContactEvent::begin(ContactId(2), surface, ChannelId(7), sample(0.1));
    let refused = scene.report(0.03, elsewhere).unwrap_err();
    assert_eq!(refused.to_string(), "actuator: 7 is refused; must be below 1, the number of actuators");
    run(&mut renderer, 4096);
    assert_eq!((scene.stats().refused, scene.stats().held), (5, 0));
}

#[test]
fn a_lorry_and_a_bullet_are_limited_and_their_unit_questioned() {
    let (mut scene, mut renderer, surface) = engine(Config::default());
    let contact = ContactId(1);
    let lorry = ContactSample { normal_force_n: 1e300, ..sample(0.1) };
    scene.report(0.0, ContactEvent::begin(contact, surface, ChannelId(0), lorry)).unwrap();
    for step in 1..30 {
        let fast = ContactSample { normal_force_n: 2e4, ..sample(0.1 + 0.01 * f64::from(step)) };
        scene
            .report(0.01 * f64::from(step), ContactEvent::moved(contact, fast.sliding([300.0, 0.0])))
            .unwrap();
    }
    run(&mut renderer, 16_384);
    assert_eq!((scene.stats().refused, scene.stats().held), (0, 30));
    assert!(scene.why_silent().iter().any(|reason| reason.to_string().contains("centimetre")));
}

#[test]
fn a_thousand_contacts_leave_sixty_four_sounding() {
    let (mut scene, mut renderer, surface) = engine(Config::default());
    for contact in 0..1000 {
        let event =
            ContactEvent::begin(ContactId(contact), surface, ChannelId(0), sample(contact as f64 * 0.01));
        scene.report(0.0, event).unwrap();
    }
    run(&mut renderer, 2048);
    let stats = scene.stats();
    assert_eq!((stats.contacts, stats.stolen, stats.events), (64, 936, 1000));
}

#[test]
fn a_flood_of_events_is_bounded_and_every_event_is_counted() {
    let (mut scene, mut renderer, surface) = engine(Config::default());
    let contacts = 10u64;
    for contact in 0..contacts {
        let event = ContactEvent::begin(ContactId(contact), surface, ChannelId(0), sample(0.1));
        scene.report(0.0, event).unwrap();
    }
    let (mut reported, mut handed_back, mut peak) = (contacts, 0u64, 0.0f32);
    for block in 0..500u32 {
        // 64 frames are 1.45 ms: 1451 events each.
        for i in 0..1451u64 {
            let time_s = f64::from(block) * 64.0 / 44_100.0 + i as f64 * 1e-6;
            let event = ContactEvent::moved(ContactId(i % contacts), sample(0.1 + 0.1 * time_s / 0.14));
            reported += 1;
            handed_back += u64::from(scene.report(time_s, event).is_err());
        }
        peak = peak.max(run(&mut renderer, 64));
    }
    let stats = scene.stats();
    assert!(peak > 0.0);
    assert_eq!(stats.dropped, handed_back);
    let held = reported - stats.events - stats.superseded - stats.dropped;
    assert!(held <= 5000, "{held} events are nowhere: {stats:?}");
}

#[test]
fn without_rendering_the_newest_moves_are_kept_and_the_rest_is_counted() {
    let (mut scene, mut renderer, surface) = engine(Config { queue_capacity: 64, ..Config::default() });
    let contact = ContactId(1);
    scene.report(0.0, ContactEvent::begin(contact, surface, ChannelId(0), sample(0.1))).unwrap();
    for step in 1..10_000 {
        let time_s = f64::from(step) * 1e-3;
        scene.report(time_s, ContactEvent::moved(contact, sample(0.1 + time_s))).unwrap();
    }
    assert!(scene.stats().superseded > 9_000);
    run(&mut renderer, 64);
    // Landings and lift-offs still fit.
    scene.report(10.0, ContactEvent::end(contact)).unwrap();
}

#[test]
fn a_full_queue_hands_the_event_back() {
    let (mut scene, mut renderer, surface) = engine(Config { queue_capacity: 8, ..Config::default() });
    let mut refused = 0;
    for contact in 0..100 {
        let event = ContactEvent::begin(ContactId(contact), surface, ChannelId(0), sample(0.1));
        if let Err(error) = scene.report(0.0, event) {
            assert_eq!((error.reason, error.event), (Refusal::QueueFull, event));
            refused += 1;
        }
    }
    assert_eq!(scene.stats().dropped, refused);
    assert!(refused > 90);
    run(&mut renderer, 64);
    scene.report(0.0, ContactEvent::end(ContactId(1))).unwrap();
}

#[test]
fn a_contact_whose_end_was_lost_fades_and_returns_on_move() {
    let (mut scene, mut renderer, surface) = engine(Config::default());
    scene.report(0.0, ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample(0.1))).unwrap();
    run(&mut renderer, 8_000);
    assert_eq!(scene.stats().contacts, 1);
    run(&mut renderer, 8_000);
    let stats = scene.stats();
    assert_eq!((stats.contacts, stats.lapsed), (0, 1));
    scene.report(0.4, ContactEvent::moved(ContactId(1), sample(0.2))).unwrap();
    run(&mut renderer, 4_000);
    assert_eq!(scene.stats().contacts, 1);
    scene.report(0.5, ContactEvent::moved(ContactId(9), sample(0.2))).unwrap();
    run(&mut renderer, 4_000);
    assert_eq!(scene.stats().orphaned, 1);
}
