//! Who reads force rows, and what of.

use super::stroke::{Felt, SIDE_M, block_of};
use asperity::live::ports::{Force, ForceRow, Of};
use asperity::surface::solid_materials::SolidMaterial;
use asperity::{ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Surface, SurfaceId};

#[test]
fn slow_fast_and_double_force_readers_count_their_losses() {
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let surface: SurfaceId = scene.add_surface(block_of(SolidMaterial::Gravel)).unwrap();
    let port = |holds_s| Force { rate_hz: 1000.0, holds_s };
    let mut all = scene.open_port(port(4.0)).unwrap();
    let mut hurried = scene.open_port(port(0.1)).unwrap();
    let mut stalled = scene.open_port(port(0.1)).unwrap();
    let (mut haptic, mut audio, mut in_a_hurry) = ([0.0f32; 64], [0.0f32; 64], Vec::new());
    for step in 0..120u32 {
        let t = f64::from(step) / 60.0;
        let sample = ContactSample::new([(0.02 + 0.07 * t) / SIDE_M, 0.5], 0.5).sliding([0.07, 0.0]);
        let event = if step == 0 {
            ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        scene.report(t, event).unwrap();
        while (renderer.position() as f64) < (t + 1.0 / 60.0) * 44_100.0 {
            renderer.render(&mut [&mut haptic], &mut [&mut audio]);
            // Twice as often as there are rows.
            for _ in 0..3 {
                in_a_hurry.extend(hurried.read());
            }
        }
    }
    in_a_hurry.extend(std::iter::from_fn(|| hurried.read()));
    let received: Vec<ForceRow> = std::iter::from_fn(|| all.read()).collect();
    assert_eq!((all.lost(), hurried.lost()), (0, 0));
    assert!(received == in_a_hurry && received.len() > 3900, "{} and {}", received.len(), in_a_hurry.len());
    let late: Vec<ForceRow> = std::iter::from_fn(|| stalled.read()).collect();
    assert_eq!(late.len() as u64 + stalled.lost(), received.len() as u64);
    assert!(stalled.lost() > 2000 && late[..] == received[received.len() - late.len()..]);
}

/// Between two landings of one contact, 10 N and then 1 N, the first of which still fades: what a
/// row tells is the second.
#[test]
fn a_contact_that_lifts_and_lands_elsewhere_is_felt_there() {
    let Engine { mut scene, mut renderer, .. } = Config::default().build().unwrap();
    let plate = Surface::flat(SIDE_M, SIDE_M).unwrap();
    let surface: SurfaceId = scene.add_surface(plate).unwrap();
    let mut felt = Felt::new(1000.0, 44_100.0);
    let landing = |u, force_n| {
        ContactEvent::begin(ContactId(1), surface, ChannelId(0), ContactSample::new([u, 0.5], force_n))
    };
    let stays = |u, force_n| {
        ContactEvent::moved(ContactId(1), ContactSample::new([u, 0.5], force_n).sliding([0.0; 2]))
    };
    scene.report(0.0, landing(0.2, 10.0)).unwrap();
    for tenth in 1..5 {
        scene.report(f64::from(tenth) / 10.0, stays(0.2, 10.0)).unwrap();
    }
    scene.report(0.5, ContactEvent::end(ContactId(1))).unwrap();
    scene.report(0.5, landing(0.8, 1.0)).unwrap();
    scene.report(0.6, stays(0.8, 1.0)).unwrap();
    let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
    while renderer.position() < 30_000 {
        renderer.render_tapped(&mut [&mut haptic], &mut [&mut audio], &mut felt);
    }
    let Felt { rows, received, .. } = &mut felt;
    rows.close(u64::MAX, |row| received.push(row));
    let normal_n = |row: &ForceRow| row.force_n[2];
    for of in [Of::Contact(ContactId(1)), Of::Hand(ChannelId(0))] {
        let at = |tick: u64| {
            let mut rows = received.iter().filter(|row| row.of == of && row.tick == tick);
            let row = rows.next().map(normal_n).unwrap();
            assert!(rows.next().is_none(), "tick {tick} is told twice");
            row
        };
        assert!((at(490) - 10.0).abs() < 0.01, "{}", at(490));
        // Four ticks on, the kernel sees the new place alone.
        for tick in 506..600 {
            assert!((at(tick) - 1.0).abs() < 0.02, "tick {tick}: {} N", at(tick));
        }
    }
}
