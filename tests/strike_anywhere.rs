//! Bodies that are struck and stroked anywhere, through the whole engine.

use crate::closed_forms;

use asperity::{
    BodyId, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Impact, Material, ModalModel,
    Surface, SurfaceFrame,
};
use closed_forms::{FREE_BAR, PLATE_M, bar, bar_shape, modes_file, plate};
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;

fn bar_hz(mode: usize) -> f64 {
    220.0 * (FREE_BAR[mode] / FREE_BAR[0]).powi(2)
}

fn bar_body() -> ModalModel {
    ModalModel::parse(&modes_file(&bar(), bar_hz, 4.0)).unwrap()
}

fn plate_body() -> ModalModel {
    let hz = |m: usize| {
        let [a, b] = closed_forms::plate_orders(m);
        90.0 * (a * a + b * b * (PLATE_M[0] / PLATE_M[1]).powi(2))
    };
    ModalModel::parse(&modes_file(&plate(), hz, 6.0)).unwrap()
}

fn render(engine: &mut Engine, samples: usize, block: usize) -> Vec<f32> {
    let (mut haptic, mut audio) = (vec![0.0; samples], vec![0.0; samples]);
    for (haptic, audio) in haptic.chunks_mut(block).zip(audio.chunks_mut(block)) {
        engine.renderer.render(&mut [haptic], &mut [audio]);
    }
    audio
}

fn struck(model: ModalModel, blow: impl Fn(BodyId) -> Impact) -> Vec<f32> {
    let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
    let body = engine.scene.add_body(model).unwrap();
    engine.scene.report(0.0, ContactEvent::Impact(blow(body))).unwrap();
    render(&mut engine, 44_100, 512)
}

/// Amplitude at a frequency over the second half, by a window that other modes do not reach into.
fn amplitude(sound: &[f32], hz: f64) -> f64 {
    let tail = &sound[sound.len() / 2..];
    let (mut re, mut im) = (0.0, 0.0);
    for (n, y) in tail.iter().enumerate() {
        let window = (std::f64::consts::PI * n as f64 / tail.len() as f64).sin().powi(4);
        let angle = TAU * hz * n as f64 / RATE_HZ;
        re += window * f64::from(*y) * angle.cos();
        im += window * f64::from(*y) * angle.sin();
    }
    re.hypot(im)
}

fn db(ratio: f64) -> f64 {
    20.0 * ratio.abs().max(1e-12).log10()
}

#[test]
fn a_bar_struck_anywhere_has_the_levels_of_its_closed_form() {
    let end = struck(bar_body(), |body| Impact::on(body).at_m([0.0, 0.015, 0.0]));
    let mut worst = 0.0_f64;
    for x in [0.03, 0.11, 0.2242, 0.31, 0.43, 0.5, 0.72, 0.965] {
        let sound = struck(bar_body(), |body| Impact::on(body).at_m([0.5 * x, 0.01, 0.02]));
        for m in 0..5 {
            let found = db(amplitude(&sound, bar_hz(m)) / amplitude(&end, bar_hz(m)));
            let exact = db(bar_shape(m, x) / 2.0);
            if exact > -20.0 {
                worst = worst.max((found - exact).abs());
            } else {
                assert!(found < -18.0, "{found} dB near a node, {exact}");
            }
        }
    }
    println!("worst {worst:.3} dB");
    assert!(worst <= 0.3, "{worst} dB");
}

#[test]
fn a_mode_struck_on_its_node_line_is_forty_decibels_down() {
    let first_hz = 90.0 * (4.0 + (PLATE_M[0] / PLATE_M[1]).powi(2));
    let sounding = struck(plate_body(), |body| Impact::on(body).at_m([0.25 * PLATE_M[0], 0.12, 0.0]));
    let silent = struck(plate_body(), |body| Impact::on(body).at_m([0.5 * PLATE_M[0], 0.12, 0.0]));
    let level = db(amplitude(&silent, first_hz) / amplitude(&sounding, first_hz));
    println!("{level:.1} dB");
    assert!(level <= -40.0, "{level} dB");
}

#[test]
fn a_strike_where_the_amplitudes_belong_needs_no_place() {
    let shapes = bar();
    let at_m = shapes.points_m[shapes.struck_point];
    let placed = struck(bar_body(), |body| Impact {
        direction: Some([0.0, 0.0, 1.0]),
        ..Impact::on(body).at_m([at_m[0], at_m[1], at_m[2]])
    });
    let plain = struck(bar_body(), Impact::on);
    let error: f64 = placed.iter().zip(&plain).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let size: f64 = plain.iter().map(|y| f64::from(*y).powi(2)).sum();
    assert!(size > 0.0 && 10.0 * (error / size).log10() < -90.0, "{} dB", 10.0 * (error / size).log10());
}

#[test]
fn a_finger_pressing_harder_holds_a_body_alike_in_any_blocks() {
    let squeezed = |block: usize| {
        let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
        let body = engine.scene.add_body(plate_body()).unwrap();
        let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
        let surface =
            Surface::flat(PLATE_M[0], PLATE_M[1]).unwrap().micro_relief_m(0.0).frame(frame).body(body);
        let surface = engine.scene.add_surface(surface).unwrap();
        let blow = Impact::on(body).at_m([0.1, 0.1, 0.0]);
        engine.scene.report(0.0, ContactEvent::Impact(blow)).unwrap();
        for step in 0..50 {
            let t = f64::from(step) / 90.0;
            let sample = ContactSample::new([0.3, 0.4], 0.2 + 8.0 * t).sliding([0.0, 0.0]);
            let event = match step {
                0 => ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample),
                _ => ContactEvent::moved(ContactId(1), sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        render(&mut engine, 25_000, block)
    };
    let whole = squeezed(25_000);
    for block in [17, 100] {
        let split = squeezed(block);
        let first = whole.iter().zip(&split).position(|(a, b)| a.to_bits() != b.to_bits());
        assert_eq!(first, None, "blocks of {block}");
    }
}

/// A finger that slides across the plate and back, while mallets fall on it.
fn slide(block: usize, speed_m_s: f64) -> Vec<f32> {
    let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
    let body = engine.scene.add_body(plate_body()).unwrap();
    let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let surface = Surface::flat(PLATE_M[0], PLATE_M[1])
        .unwrap()
        .material(Material::STEEL)
        .micro_relief_m(4e-6)
        .frame(frame);
    let surface = engine.scene.add_surface(surface.body(body)).unwrap();
    let (finger, other) = (ContactId(1), ContactId(2));
    for step in 0..60 {
        let t = f64::from(step) / 60.0;
        for (contact, v) in [(finger, 0.3), (other, 0.7)] {
            let sample =
                ContactSample::new([0.1 + speed_m_s * t / PLATE_M[0], v], 0.6).sliding([speed_m_s, 0.0]);
            let event = match step {
                0 => ContactEvent::begin(contact, surface, ChannelId(0), sample),
                _ => ContactEvent::moved(contact, sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        if step % 7 == 3 {
            let at_m = [0.05 * f64::from(step % 8), 0.1, 0.0];
            engine.scene.report(t, ContactEvent::Impact(Impact::on(body).at_m(at_m))).unwrap();
        }
    }
    render(&mut engine, 44_100, block)
}

#[test]
fn any_split_into_blocks_renders_the_same_bits() {
    let whole = slide(44_100, 0.25);
    assert!(whole.iter().any(|y| y.abs() > 1e-6));
    for block in [1, 17, 64, 100, 480, 4096] {
        let split = slide(block, 0.25);
        let first = whole.iter().zip(&split).position(|(a, b)| a.to_bits() != b.to_bits());
        assert_eq!(first, None, "blocks of {block}");
    }
}

#[test]
fn a_stroke_along_a_node_line_leaves_that_mode_out() {
    let stroke = |v: f64| {
        let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
        let body = engine.scene.add_body(plate_body()).unwrap();
        let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
        let surface =
            Surface::flat(PLATE_M[0], PLATE_M[1]).unwrap().micro_relief_m(4e-6).frame(frame).body(body);
        let surface = engine.scene.add_surface(surface).unwrap();
        for step in 0..60 {
            let t = f64::from(step) / 60.0;
            let sample = ContactSample::new([0.2 + 0.5 * t, v], 0.6).sliding([0.2, 0.0]);
            let event = match step {
                0 => ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample),
                _ => ContactEvent::moved(ContactId(1), sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        render(&mut engine, 44_100, 512)
    };
    // Mode (1, 2) has its node line in the middle, and swings most a quarter of the way.
    let hz = 90.0 * (1.0 + 4.0 * (PLATE_M[0] / PLATE_M[1]).powi(2));
    let level = db(amplitude(&stroke(0.5), hz) / amplitude(&stroke(0.25), hz));
    println!("{level:.1} dB");
    assert!(level < -20.0, "{level} dB");
}

#[test]
fn a_body_with_shapes_is_written_and_read_again_as_it_was() {
    let model = plate_body();
    assert!(model.shapes.is_some());
    assert_eq!(ModalModel::parse(&model.to_json()).unwrap(), model);
    assert!(model.to_json().contains("\"version\":2"));
    let plain = ModalModel { shapes: None, ..model };
    assert!(plain.to_json().contains("\"version\":1") && !plain.to_json().contains("shapes"));
}

#[test]
fn an_impossible_place_is_refused_by_name() {
    let mut engine = Config::default().build().unwrap();
    let body = engine.scene.add_body(bar_body()).unwrap();
    for (bad, field) in [
        (Impact::on(body).at_m([f64::NAN, 0.0, 0.0]), "at_m"),
        (Impact { direction: Some([0.0; 3]), ..Impact::on(body).at_m([0.0; 3]) }, "direction"),
        (Impact { direction: Some([f64::INFINITY, 0.0, 0.0]), ..Impact::on(body) }, "direction"),
    ] {
        let refused = engine.scene.report(0.0, ContactEvent::Impact(bad)).unwrap_err();
        assert!(refused.to_string().starts_with(field), "{refused}");
    }
    // The nearest point of the body counts: a place far off is held at the limit of places, and
    // counted.
    engine.scene.report(0.0, ContactEvent::Impact(Impact::on(body).at_m([1e9, 0.0, 0.0]))).unwrap();
    assert_eq!(engine.scene.stats().held, 1);
}

/// What is left after a strike of a bar at its end while fingers press, and after they let go.
fn held(fingers: &[(f64, f64)], let_go_s: f64, seconds: f64) -> Vec<f32> {
    let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
    let body = engine.scene.add_body(bar_body()).unwrap();
    let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let surface = Surface::flat(0.5, 0.03).unwrap().micro_relief_m(0.0).frame(frame).body(body);
    let surface = engine.scene.add_surface(surface).unwrap();
    let at = [0.0, 0.015, 0.0];
    for step in 0..(60.0 * let_go_s) as u32 {
        let t = f64::from(step) / 60.0;
        for (i, (x, force_n)) in fingers.iter().enumerate() {
            let sample = ContactSample::new([*x, 0.5], *force_n).sliding([0.0; 2]);
            let event = match step {
                0 => ContactEvent::begin(ContactId(i as u64), surface, ChannelId(0), sample),
                _ => ContactEvent::moved(ContactId(i as u64), sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        if step == 30 {
            engine.scene.report(t, ContactEvent::Impact(Impact::on(body).at_m(at))).unwrap();
        }
    }
    for i in 0..fingers.len() {
        engine.scene.report(let_go_s, ContactEvent::end(ContactId(i as u64))).unwrap();
    }
    let again_s = seconds - 1.0;
    engine.scene.report(again_s, ContactEvent::Impact(Impact::on(body).at_m(at))).unwrap();
    render(&mut engine, (seconds * RATE_HZ) as usize, 512)
}

/// Decay of a mode between two instants, 1/s.
fn decay_per_s(sound: &[f32], hz: f64, from_s: f64, to_s: f64) -> f64 {
    let window = (0.2 * RATE_HZ) as usize;
    let level = |at_s: f64| {
        let at = (at_s * RATE_HZ) as usize;
        // `amplitude` looks at the second half of what it is given.
        amplitude(&sound[at - window..at + window], hz)
    };
    (level(from_s) / level(to_s)).ln() / (to_s - from_s)
}

#[test]
fn a_held_bar_damps_by_body_and_finger_until_released() {
    use asperity::dsp::held::{Hold, Pole, held as poles_held};
    let sound = held(&[(0.28, 1.0)], 1.5, 5.0);
    let free: Vec<Pole> = (0..5).map(|m| Pole { decay_per_s: 4.0, frequency_hz: bar_hz(m) }).collect();
    let phi: Vec<f64> = (0..5).map(|m| bar_shape(m, 0.28) / 0.2_f64.sqrt()).collect();
    let probe = asperity::Probe::default();
    for m in [0, 1] {
        let pole = poles_held(&free, m, &[Hold { probe: &probe, phi_per_sqrt_kg: &phi }]).unwrap();
        let found = decay_per_s(&sound, pole.frequency_hz, 0.75, 1.1);
        println!("mode {m}: {found:.2} 1/s, coupled system {:.2}, free 4", pole.decay_per_s);
        assert!((found / pole.decay_per_s - 1.0).abs() < 0.08, "{found} of {}", pole.decay_per_s);
        assert!(pole.decay_per_s > 4.5, "the finger damps it");
    }
    // Struck again after it was let go: the same as a bar that nobody ever touched.
    let untouched = held(&[], 1.5, 5.0);
    let after = (4.2 * RATE_HZ) as usize;
    let error: f64 =
        sound[after..].iter().zip(&untouched[after..]).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let size: f64 = untouched[after..].iter().map(|y| f64::from(*y).powi(2)).sum();
    let error_db = 10.0 * (error / size).log10();
    println!("let go: {error_db:.1} dB from the free bar");
    assert!(error_db < -60.0, "{error_db} dB");
}

#[test]
fn a_released_body_at_rest_rings_as_if_never_held() {
    let struck = |held_n: Option<f64>, struck_s: f64, from_s: f64| {
        let mut engine = Config::default().build().unwrap();
        let body = engine.scene.add_body(bar_body()).unwrap();
        let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
        let surface = Surface::flat(0.5, 0.03).unwrap().micro_relief_m(0.0).frame(frame).body(body);
        let surface = engine.scene.add_surface(surface).unwrap();
        let mut events = vec![(struck_s, ContactEvent::Impact(Impact::on(body).at_m([0.0, 0.015, 0.0])))];
        if let Some(force_n) = held_n {
            let sample = ContactSample::new([0.28, 0.5], force_n).sliding([0.0; 2]);
            events.push((0.0, ContactEvent::begin(ContactId(0), surface, ChannelId(0), sample)));
            events.extend(
                (1..30).map(|step| (f64::from(step) / 60.0, ContactEvent::moved(ContactId(0), sample))),
            );
            events.push((0.5, ContactEvent::end(ContactId(0))));
        }
        events.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        for (t, event) in events {
            engine.scene.report(t, event).unwrap();
        }
        let sound = render(&mut engine, (13.0 * RATE_HZ) as usize, 512);
        sound[(from_s * RATE_HZ) as usize..].to_vec()
    };
    let untouched = struck(None, 12.0, 12.0);
    assert!(untouched.iter().any(|y| y.abs() > 1e-6));
    assert!(struck(Some(2.0), 12.0, 12.0) == untouched, "let go, but not as it was");
    // Held while it is struck it is another sound, or this shows nothing.
    assert!(struck(Some(2.0), 0.3, 0.3) != struck(None, 0.3, 0.3));
}

#[test]
fn a_contact_with_its_own_place_is_there_not_at_its_surface() {
    let loud = |at_m: Option<[f64; 3]>, frame: bool| {
        let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
        let body = engine.scene.add_body(plate_body()).unwrap();
        // The frame lies along the middle, where the second mode along has a node line.
        let lies =
            SurfaceFrame::new([0.5 * PLATE_M[0], 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]).unwrap();
        let surface = Surface::flat(0.3, 0.1).unwrap().micro_relief_m(4e-6).body(body);
        let surface = if frame { surface.frame(lies) } else { surface };
        let surface = engine.scene.add_surface(surface).unwrap();
        for step in 0..60 {
            let t = f64::from(step) / 60.0;
            let sample = ContactSample::new([0.2 + 0.5 * t, 0.0], 0.6).sliding([0.15, 0.0]);
            let sample = ContactSample { at_m: at_m.map(|[x, y, z]| [x, y + 0.15 * t, z]), ..sample };
            let event = match step {
                0 => ContactEvent::begin(ContactId(1), surface, ChannelId(0), sample),
                _ => ContactEvent::moved(ContactId(1), sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        let second_hz = 90.0 * (4.0 + (PLATE_M[0] / PLATE_M[1]).powi(2));
        amplitude(&render(&mut engine, 44_100, 512), second_hz)
    };
    let on_the_node = loud(None, true);
    let beside = loud(Some([0.25 * PLATE_M[0], 0.06, 0.0]), true);
    let without_a_frame = loud(Some([0.25 * PLATE_M[0], 0.06, 0.0]), false);
    println!("{:.1} dB, {:.1} dB", db(on_the_node / beside), db(without_a_frame / beside));
    assert!(db(on_the_node / beside) < -30.0, "{on_the_node} {beside}");
    assert!(db(without_a_frame / beside).abs() < 6.0, "{without_a_frame} {beside}");
}
