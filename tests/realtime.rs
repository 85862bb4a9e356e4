//! The audio half never allocates or frees, whatever happens: events of every kind, surfaces and
//! bodies swapped and removed while they sound, voices stolen, contacts lapsing, hostile numbers.

use crate::closed_forms;
use crate::common;
use crate::counting;
use crate::random_game;

use asperity::{ChannelId, Config, ContactEvent, ContactId, ContactSample, Renderer, Scene};
use common::{bar, plate};
use counting::{heap_operations, held_bytes};
use random_game::RandomGame;
#[test]
fn the_counting_allocator_counts() {
    assert!(heap_operations(|| drop(std::hint::black_box(vec![1u8; 100]))) >= 2);
    assert_eq!(heap_operations(|| ()), 0);
}

#[test]
fn the_renderer_can_move_to_the_audio_thread() {
    fn is_send<T: Send>() {}
    is_send::<Renderer>();
    is_send::<Scene>();
}

#[test]
fn ten_minutes_of_randomised_events_touch_no_heap_on_the_audio_half() {
    std::thread::scope(|scope| {
        for seed in [5, 6] {
            scope.spawn(move || five_minutes_of_randomised_events_touch_no_heap(seed));
        }
    });
}

/// One game; its counters are this thread's.
fn five_minutes_of_randomised_events_touch_no_heap(seed: u64) {
    let (mut game, mut renderer) = RandomGame::new(seed);
    let (mut haptic, mut audio) = (vec![0.0f32; 512], vec![0.0f32; 512]);
    let mut touched = 0;
    let mut peak = 0.0f32;
    while game.time_s < 300.0 {
        let until = game.time_s + 0.005;
        while game.time_s < until {
            game.step();
        }
        while (renderer.position() as f64) < game.time_s * renderer.sample_rate_hz() {
            let frames = 1 + game.rng.next_u32() as usize % 512;
            let (h, a) = (&mut haptic[..frames], &mut audio[..frames]);
            touched += heap_operations(|| renderer.render(&mut [&mut *h], &mut [&mut *a]));
            for x in h.iter().chain(a.iter()) {
                assert!(x.is_finite());
                peak = peak.max(x.abs());
            }
        }
        game.scene.collect();
    }
    let stats = game.scene.stats();
    assert_eq!(touched, 0, "heap operations on the audio half, seed {seed}");
    assert!(peak > 0.0);
    for (name, count) in [
        ("events", stats.events),
        ("impacts", stats.impacts),
        ("refused", stats.refused),
        ("stolen", stats.stolen),
        ("lapsed", stats.lapsed),
        ("orphaned", stats.orphaned),
        ("debounced", stats.debounced),
        ("micro_collisions", stats.micro_collisions),
    ] {
        assert!(count > 0, "the random game {seed} never met: {name}");
    }
}

#[test]
fn strikes_strokes_and_holds_anywhere_on_a_body_touch_no_heap() {
    let config = Config { actuators: vec![tangential()], ..Config::default() };
    let asperity::Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let text = closed_forms::modes_file(&closed_forms::plate(), |m| 90.0 * (m + 1) as f64, 5.0);
    let body = scene.add_body(asperity::ModalModel::parse(&text).unwrap()).unwrap();
    let frame = asperity::SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let surface = asperity::Surface::flat(0.4, 0.3).unwrap().frame(frame).body(body);
    let surface = scene.add_surface(surface).unwrap();
    let mut rng = asperity::dsp::rng::Rng::new(12);
    let (mut haptic, mut audio) = ([0.0f32; 300], [0.0f32; 300]);
    let (mut touched, mut peak) = (0, 0.0f32);
    for step in 0..3000 {
        let t = f64::from(step) * 300.0 / 44_100.0;
        let contact = ContactId(u64::from(rng.next_u32() % 24));
        let sample =
            ContactSample::new([rng.uniform(), rng.uniform()], 2.0 * rng.uniform()).sliding([0.1, 0.05]);
        let event = match rng.next_u32() % 8 {
            0 => ContactEvent::begin(contact, surface, ChannelId(0), sample),
            1 => ContactEvent::end(contact),
            2 => {
                let at_m = [0.4 * rng.uniform(), 0.3 * rng.uniform(), 0.0];
                ContactEvent::Impact(asperity::Impact::on(body).at_m(at_m))
            }
            _ => ContactEvent::moved(contact, sample),
        };
        scene.report(t, event).unwrap();
        touched += heap_operations(|| renderer.render(&mut [&mut haptic], &mut [&mut audio]));
        peak = haptic.iter().chain(&audio).fold(peak, |a, x| a.max(x.abs()));
        assert!(peak.is_finite());
    }
    assert_eq!(touched, 0, "heap operations on the audio half");
    assert!(peak > 0.0);
}

fn tangential() -> asperity::ActuatorSettings {
    asperity::ActuatorSettings {
        output: asperity::Quantity::Tangential,
        ..asperity::ActuatorSettings::default()
    }
}

#[test]
fn ten_seconds_of_a_million_events_each_need_no_more_memory() {
    let asperity::Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let body = scene.add_body(bar()).unwrap();
    let surface = scene.add_surface(plate(0.8).body(body)).unwrap();
    let sample = |u: f64| ContactSample {
        uv: [u, 0.5],
        velocity_m_s: Some([0.1, 0.0]),
        normal_force_n: 0.6,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let contacts = 10u64;
    for contact in 0..contacts {
        let event = ContactEvent::begin(ContactId(contact), surface, ChannelId(0), sample(0.1));
        scene.report(0.0, event).unwrap();
    }
    let (mut haptic, mut audio) = ([0.0f32; 256], [0.0f32; 256]);
    let (mut reported, mut handed_back, mut touched) = (contacts, 0u64, 0);
    let mut step = 0.0f64;
    let held = held_bytes();
    let mut most = 0;
    for microsecond in 0..10_000_000u64 {
        let time_s = microsecond as f64 * 1e-6;
        let event = ContactEvent::moved(ContactId(microsecond % contacts), sample(0.1 + 0.7 * time_s));
        reported += 1;
        handed_back += u64::from(scene.report(time_s, event).is_err());
        if microsecond % 64 == 0 {
            most = most.max(held_bytes() - held);
        }
        while (renderer.position() as f64) < time_s * renderer.sample_rate_hz() {
            touched += heap_operations(|| renderer.render(&mut [&mut haptic], &mut [&mut audio]));
            step = haptic.iter().chain(&audio).fold(step, |peak, x| peak.max(f64::from(x.abs())));
        }
    }
    let stats = scene.stats();
    eprintln!("{most} bytes more, {stats:?}");
    assert_eq!(touched, 0);
    assert!(most < 64 * 1024, "{most} bytes");
    assert!(step > 0.0 && step.is_finite());
    assert_eq!(stats.dropped, handed_back);
    let waiting = reported - stats.events - stats.superseded - stats.dropped;
    assert!(waiting <= 4096 + contacts, "{waiting} events are nowhere: {stats:?}");
    assert_eq!((stats.contacts, stats.lapsed), (contacts, 0), "no finger is lost in the flood");
}
