//! Bowed and squealing bodies through the whole engine.

use crate::closed_forms;
use crate::counting;

use asperity::{
    AddError, Body, ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Excitation, Exciter,
    Friction, Impact, Material, ModalModel, Mode, Stock, Surface, SurfaceFrame, Touching,
};
use asperity_dsp::rng::Rng;
use closed_forms::{FREE_BAR, bar, modes_file};
use std::f64::consts::{PI, TAU};

const COULOMB: Friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 1e-9 };
const ROSIN: Friction = Friction { mu_static: 0.8, mu_kinetic: 0.3, slip_speed_m_s: 0.05 };

/// A smooth flat thing that nothing but friction rings.
fn smooth(friction: Friction) -> Surface {
    Surface::flat(0.5, 0.1).unwrap().micro_relief_m(0.0).excitation(Excitation::NONE).stick_slip(friction)
}

/// A bow that is laid on and, a fifth of a second later, drawn along u, reported 60 times a second.
fn draw(engine: &mut Engine, surface: asperity::SurfaceId, speed_m_s: f64, force_n: f64, seconds: f64) {
    for step in 0..(60.0 * seconds) as u32 {
        let t = f64::from(step) / 60.0;
        let drawn_s = (t - 0.2).max(0.0);
        let speed_m_s = if drawn_s > 0.0 { speed_m_s } else { 0.0 };
        let sample =
            ContactSample::new([0.1 + speed_m_s * drawn_s / 0.5, 0.5], force_n).sliding([speed_m_s, 0.0]);
        let event = match step {
            0 => ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample),
            _ => ContactEvent::moved(ContactId(1), sample),
        };
        engine.scene.report(t, event).unwrap();
    }
}

fn render(engine: &mut Engine, samples: usize, mut block: impl FnMut() -> usize) -> Vec<f32> {
    let mut audio = vec![0.0; samples];
    let mut haptic = vec![0.0; samples];
    let mut at = 0;
    while at < samples {
        let n = block().clamp(1, samples - at);
        engine.renderer.render(&mut [&mut haptic[at..at + n]], &mut [&mut audio[at..at + n]]);
        at += n;
    }
    audio
}

/// Mean period of a sound, s: between the first and the last time that it rises through its mean.
fn period_s(sound: &[f32], rate_hz: f64) -> f64 {
    let mean = sound.iter().map(|y| f64::from(*y)).sum::<f64>() / sound.len() as f64;
    let most = sound.iter().fold(0.0, |most: f64, y| most.max((f64::from(*y) - mean).abs()));
    let (mut low, mut rises, mut before) = (false, Vec::new(), 0.0);
    for (n, y) in sound.iter().enumerate() {
        let y = f64::from(*y) - mean;
        low |= y < -0.3 * most;
        if low && before < 0.0 && y >= 0.0 {
            rises.push(n as f64 - y / (y - before));
            low = false;
        }
        before = y;
    }
    assert!(rises.len() > 20, "only {} periods", rises.len());
    (rises[rises.len() - 1] - rises[0]) / (rises.len() - 1) as f64 / rate_hz
}

/// The whole number of Hz below 5 kHz at which a sound of a second at 44.1 kHz is strongest.
fn strongest_hz(sound: &[f32]) -> f64 {
    let power = |hz: u32| {
        // Goertzel.
        let turn = 2.0 * (TAU * f64::from(hz) / 44_100.0).cos();
        let (a, b) = sound.iter().fold((0.0, 0.0), |(a, b), y| (f64::from(*y) + turn * a - b, a));
        a * a + b * b - turn * a * b
    };
    f64::from((60..5_000).max_by(|a, b| power(*a).total_cmp(&power(*b))).unwrap_or(0))
}

#[test]
fn a_bowed_oscillators_period_is_its_closed_form_at_every_rate() {
    let mut worst = 0.0_f64;
    for (frequency_hz, mass_kg, depth) in
        [(50.0, 0.5, 3.0), (220.0, 0.08, 5.0), (430.0, 0.02, 2.0), (800.0, 0.004, 8.0)]
    {
        for sample_rate_hz in [44_100.0, 96_000.0, 192_000.0] {
            let config = Config { culling: None, sample_rate_hz, ..Config::default() };
            let mut engine = config.build().unwrap();
            let mode = Mode { frequency_hz, decay_per_s: 0.0, amplitude: 1e3, phase_rad: 0.0 };
            // Where it swings most a mode of a body weighs half of it.
            let body = Body::new(ModalModel::new(vec![mode], 1.0).unwrap()).mass_kg(2.0 * mass_kg);
            let body = engine.scene.add_body(body).unwrap();
            let surface = engine.scene.add_surface(smooth(COULOMB).body(body)).unwrap();
            let w = TAU * frequency_hz;
            let force_n = 1.5;
            let a = force_n * 0.5 / (mass_kg * w * w);
            let speed_m_s = a * w / depth;
            let exact = 2.0 * a / speed_m_s + 2.0 / w * (PI - (a * w / speed_m_s).atan());
            let seconds = 1.0 + 200.0 / frequency_hz;
            draw(&mut engine, surface, speed_m_s, force_n, seconds);
            let sound = render(&mut engine, (seconds * sample_rate_hz) as usize, || 512);
            let steady = &sound[sound.len() / 4..sound.len() * 19 / 20];
            let error = 100.0 * (period_s(steady, sample_rate_hz) / exact - 1.0);
            println!("{frequency_hz} Hz at {sample_rate_hz} Hz: {error:+.3} %");
            worst = worst.max(error.abs());
        }
    }
    assert!(worst <= 0.2, "worst {worst:.3} %");
}

fn bowed_bar(friction: Friction) -> (Engine, asperity::BodyId, asperity::SurfaceId) {
    let mut engine = Config { culling: None, ..Config::default() }.build().unwrap();
    let hz = |mode: usize| 220.0 * (FREE_BAR[mode] / FREE_BAR[0]).powi(2);
    let body = engine.scene.add_body(ModalModel::parse(&modes_file(&bar(), hz, 4.0)).unwrap()).unwrap();
    // The edge at the bar's end, bowed across: u runs out of the bar's plane.
    let frame = SurfaceFrame::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]).unwrap();
    let surface = engine.scene.add_surface(smooth(friction).frame(frame).body(body)).unwrap();
    (engine, body, surface)
}

#[test]
fn a_bar_bowed_at_its_end_sings_near_a_mode_until_released() {
    let (mut engine, _, surface) = bowed_bar(ROSIN);
    draw(&mut engine, surface, 0.08, 2.0, 2.0);
    let end = ContactEvent::End { contact: ContactId(1) };
    engine.scene.report(2.0, end).unwrap();
    let sound = render(&mut engine, 4 * 44_100, || 512);
    let hz = strongest_hz(&sound[44_100..2 * 44_100]);
    println!("{hz} Hz");
    let mode_hz = |mode: usize| 220.0 * (FREE_BAR[mode] / FREE_BAR[0]).powi(2);
    assert!((0..5).any(|mode| (hz / mode_hz(mode) - 1.0).abs() < 0.03), "{hz} Hz");
    let level = |from_s: f64| {
        let from = (from_s * 44_100.0) as usize;
        sound[from..from + 4410].iter().map(|y| f64::from(*y).powi(2)).sum::<f64>().sqrt()
    };
    // Sustained while it is drawn; then it rings out with its own decay, 4/s.
    assert!((level(1.8) / level(1.0) - 1.0).abs() < 0.2, "{} {}", level(1.0), level(1.8));
    let fell_db = 20.0 * (level(3.2) / level(2.2)).log10();
    assert!((fell_db + 34.7).abs() < 2.0, "{fell_db} dB in a second");
}

#[test]
fn a_resting_finger_damps_a_struck_bar_and_never_feeds_it() {
    let struck = |pressed: bool| {
        let (mut engine, body, surface) = bowed_bar(ROSIN);
        if pressed {
            let sample = ContactSample::new([0.1, 0.5], 2.0).sliding([0.0, 0.0]);
            let touching = Touching::on(surface);
            engine.scene.report(0.0, ContactEvent::begin_with(ContactId(1), touching, sample)).unwrap();
            for step in 1..30 {
                let t = 0.05 * f64::from(step);
                engine.scene.report(t, ContactEvent::moved(ContactId(1), sample)).unwrap();
                if step == 4 {
                    engine
                        .scene
                        .report(t, ContactEvent::Impact(Impact::on(body).at_m([0.5, 0.015, 0.0])))
                        .unwrap();
                }
            }
        } else {
            engine.scene.report(0.2, ContactEvent::Impact(Impact::on(body).at_m([0.5, 0.015, 0.0]))).unwrap();
        }
        let sound = render(&mut engine, 44_100, || 512);
        let energy =
            |from: usize| sound[from..from + 4410].iter().map(|y| f64::from(*y).powi(2)).sum::<f64>();
        (energy(9_000), energy(30_000))
    };
    let ((_, free), (early, late)) = (struck(false), struck(true));
    println!("free {free:e}, pressed {early:e} then {late:e}");
    assert!(late < 0.1 * free, "{late} of {free}");
    assert!(late < early);
}

/// A bow that goes to and fro over a plate while mallets fall on it and another hand rubs too.
fn busy(mut block: impl FnMut() -> usize) -> (Vec<f32>, u64, asperity::Stats) {
    let (mut engine, body, surface) = bowed_bar(ROSIN);
    let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
    let flat =
        Surface::flat(0.5, 0.03).unwrap().micro_relief_m(4e-6).frame(frame).body(body).stick_slip(ROSIN);
    let flat = engine.scene.add_surface(flat).unwrap();
    for step in 0..90 {
        let t = f64::from(step) / 90.0;
        for (contact, surface, from_s) in [(1, surface, 0), (2, flat, 20)] {
            let speed_m_s = 0.2 * (7.0 * t).cos();
            let u = 0.3 + 0.2 * (7.0 * t).sin() / 7.0 / 0.5;
            let sample = ContactSample::new([u, 0.4], 1.0 + t).sliding([speed_m_s, 0.0]);
            let event = match step - from_s {
                ..0 => continue,
                0 => ContactEvent::begin(ContactId(contact), surface, ChannelId(0), sample),
                50 => ContactEvent::End { contact: ContactId(contact) },
                51.. => continue,
                _ => ContactEvent::moved(ContactId(contact), sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        if step % 11 == 3 {
            engine.scene.report(t, ContactEvent::Impact(Impact::on(body).at_m([0.1, 0.01, 0.0]))).unwrap();
        }
    }
    let samples = 60_000;
    let (mut audio, mut haptic) = (vec![0.0; samples], vec![0.0; samples]);
    let mut heap = 0;
    let mut at = 0;
    while at < samples {
        let n = block().clamp(1, samples - at);
        let (haptic, audio) = (&mut haptic[at..at + n], &mut audio[at..at + n]);
        heap += counting::heap_operations(|| engine.renderer.render(&mut [haptic], &mut [audio]));
        at += n;
    }
    (audio, heap, engine.scene.stats())
}

#[test]
fn blocks_rub_the_same_bits_and_waiting_contacts_are_counted() {
    let (whole, heap, stats) = busy(|| 60_000);
    assert!(whole.iter().all(|y| y.is_finite()) && whole.iter().any(|y| y.abs() > 1e-6));
    assert_eq!(heap, 0);
    // The other hand comes at 0.22 s and waits until the first has gone at 0.55 s; a cell is 1.45
    // ms.
    assert!((200..260).contains(&stats.rubs_crowded_out), "{}", stats.rubs_crowded_out);
    for block in [4096, 480, 64, 17, 1] {
        let (split, heap, _) = busy(|| block);
        let first = whole.iter().zip(&split).position(|(a, b)| a.to_bits() != b.to_bits());
        println!("blocks of {block}: {first:?}");
        assert_eq!((first, heap), (None, 0), "blocks of {block}");
    }
}

#[test]
fn random_strokes_stay_finite_and_below_what_friction_can_drive() {
    let mut rng = Rng::new(30);
    for game in 0..60 {
        let stocks = [Stock::Bar, Stock::Plate, Stock::Bowl, Stock::Tube, Stock::Disc, Stock::Block];
        let stock = stocks[game % stocks.len()];
        let size_m = 10.0_f64.powf(-1.5 + 1.5 * rng.uniform());
        let mut engine = Config::default().build().unwrap();
        let body =
            Body::stock(stock, [Material::STEEL, Material::GLASS, Material::WOOD][game % 3], size_m).unwrap();
        let body = engine.scene.add_body(body).unwrap();
        let mu_static = 2.0 * rng.uniform();
        let friction = Friction {
            mu_static,
            mu_kinetic: mu_static * rng.uniform(),
            slip_speed_m_s: 10.0_f64.powf(-6.0 + 6.0 * rng.uniform()),
        };
        let surface =
            Surface::flat(0.5, 0.1).unwrap().stick_slip(friction).at_strike_position(game % 4).body(body);
        let surface = engine.scene.add_surface(surface).unwrap();
        for step in 0..40 {
            let t = f64::from(step) / 60.0;
            let force_n = 10.0_f64.powf(-2.0 + 4.0 * rng.uniform());
            let velocity = [2.0 * rng.normal(), 2.0 * rng.normal()];
            let sample = ContactSample::new([rng.uniform(), rng.uniform()], force_n).sliding(velocity);
            let event = match step {
                0 => ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample),
                _ => ContactEvent::moved(ContactId(1), sample),
            };
            engine.scene.report(t, event).unwrap();
        }
        let sound = render(&mut engine, 44_100, || 480);
        let peak = sound.iter().fold(0.0_f32, |peak, y| peak.max(y.abs()));
        assert!(
            sound.iter().all(|y| y.is_finite()) && peak < 1e4,
            "{stock:?} {size_m} m {friction:?}: {peak}"
        );
        assert_eq!(engine.scene.stats().quarantined, 0);
    }
}

#[test]
fn friction_on_what_nobody_knows_the_motion_of_is_refused_by_name() {
    let mut engine = Config::default().build().unwrap();
    let mode = Mode { frequency_hz: 300.0, decay_per_s: 4.0, amplitude: 1.0, phase_rad: 0.0 };
    let model = ModalModel::new(vec![mode], 1.0).unwrap();
    let unknown = engine.scene.add_body(model.clone()).unwrap();
    assert!(matches!(engine.scene.add_surface(smooth(ROSIN).body(unknown)), Err(AddError::CannotRub)));
    assert!(matches!(engine.scene.add_surface(smooth(ROSIN)), Err(AddError::CannotRub)));
    let known = engine.scene.add_body(Body::new(model.clone()).mass_kg(0.3)).unwrap();
    engine.scene.add_surface(smooth(ROSIN).body(known)).unwrap();
    // And it stays so: the body under it may not become one that cannot be rubbed.
    assert!(matches!(engine.scene.replace_body(known, model), Err(AddError::CannotRub)));
    let shaped = ModalModel::parse(&modes_file(&bar(), |m| 220.0 * (1 + m) as f64, 4.0)).unwrap();
    let shaped = engine.scene.add_body(shaped).unwrap();
    let error = engine.scene.add_surface(smooth(ROSIN).body(shaped)).unwrap_err().to_string();
    assert!(error.contains("frame"), "{error}");
    let slippery = Friction { mu_kinetic: 0.9, ..ROSIN };
    let error = engine.scene.add_surface(smooth(slippery).body(known)).unwrap_err().to_string();
    assert!(error.starts_with("mu_kinetic"), "{error}");
    let heavy = Body::new(ModalModel::new(vec![mode], 1.0).unwrap()).mass_kg(0.0);
    assert!(engine.scene.add_body(heavy).unwrap_err().to_string().starts_with("mass_kg"));
    // Without friction among the exciters its numbers ring nothing and nobody has to know how the
    // body moves.
    engine.scene.add_surface(smooth(ROSIN).excitation(Excitation::BOTH).body(unknown)).unwrap();
    assert!(Excitation::FRICTION.has(Exciter::Friction));
}
