//! Any probe, held by any body, felt by any channel or none: contacts and blows.

use crate::common;

use asperity::files::contact_log::LogEvent;
use asperity::{
    ActuatorSettings, AudioBus, Body, BodyId, BusId, ChannelId, Config, ContactBlock, ContactEvent,
    ContactId, ContactSample, Engine, Impact, Material, NoTap, PROBE_PRESETS, Probe, ProbeId, Refusal,
    Renderer, Scene, Tap, Touching, probe_by_name,
};
use asperity_dsp::hertz::{Elastic, HertzContact, pulse_shape};
use asperity_dsp::mobility::Mobility;
use common::{SIDE_M, bar, grating, peak, plate, stroke};
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;

/// Two buses, three channels in metres without a high-pass.
fn config() -> Config {
    let si = ActuatorSettings { full_scale: 1.0, highpass_hz: 0.0, ..ActuatorSettings::default() };
    Config { actuators: vec![si; 3], audio: vec![AudioBus::default(); 2], ..Config::default() }
}

fn build(config: Config) -> (Scene, Renderer) {
    let Engine { scene, renderer, .. } = config.build().unwrap();
    (scene, renderer)
}

/// Renders three channels and two buses in blocks.
fn render(renderer: &mut Renderer, frames: usize, block: usize, tap: &mut dyn Tap) -> [Vec<f32>; 5] {
    let mut all: [Vec<f32>; 5] = std::array::from_fn(|_| vec![0.0; frames]);
    let mut at = 0;
    while at < frames {
        let n = block.min(frames - at);
        let [a, b, c, d, e] = &mut all;
        renderer.render_tapped(
            &mut [&mut a[at..at + n], &mut b[at..at + n], &mut c[at..at + n]],
            &mut [&mut d[at..at + n], &mut e[at..at + n]],
            tap,
        );
        at += n;
    }
    all
}

/// A stroke whose begin says what it says.
fn report(scene: &mut Scene, touching: Touching, contact: u64) {
    for line in stroke(SIDE_M, 0.1, 0.6, 0.3).lines {
        let event = match line.event {
            LogEvent::Begin { sample, .. } => ContactEvent::begin_with(ContactId(contact), touching, sample),
            LogEvent::Move { sample, .. } => ContactEvent::moved(ContactId(contact), sample),
            LogEvent::End { .. } | LogEvent::Impact { .. } | LogEvent::Motion { .. } | LogEvent::Edit(_) => {
                ContactEvent::end(ContactId(contact))
            }
        };
        scene.report(line.t, event).unwrap();
    }
}

fn preset(name: &str) -> Probe {
    probe_by_name(name).unwrap()
}

#[test]
fn each_probe_of_a_scene_feels_what_it_feels_alone() {
    let names = ["fingertip", "stylus", "rigid"];
    let alone = names.map(|name| {
        let (mut scene, mut renderer) = build(Config { probe: preset(name), ..config() });
        let surface = scene.add_surface(plate(0.7)).unwrap();
        report(&mut scene, Touching::on(surface).felt_by(ChannelId(0)), 1);
        let [felt, ..] = render(&mut renderer, 16_000, 256, &mut NoTap);
        felt
    });
    let (mut scene, mut renderer) = build(config());
    let surface = scene.add_surface(plate(0.7)).unwrap();
    let probes = names.map(|name| scene.add_probe(preset(name)).unwrap());
    let log = stroke(SIDE_M, 0.1, 0.6, 0.3);
    for line in log.lines {
        for (index, probe) in probes.into_iter().enumerate() {
            let contact = ContactId(1 + index as u64);
            let touching = Touching::on(surface).felt_by(ChannelId(index as u16)).probe(probe);
            let event = match line.event.clone() {
                LogEvent::Begin { sample, .. } => ContactEvent::begin_with(contact, touching, sample),
                LogEvent::Move { sample, .. } => ContactEvent::moved(contact, sample),
                _ => ContactEvent::end(contact),
            };
            scene.report(line.t, event).unwrap();
        }
    }
    let [a, b, c, ..] = render(&mut renderer, 16_000, 100, &mut NoTap);
    for (name, (alone, together)) in names.iter().zip(alone.iter().zip([a, b, c])) {
        assert!(peak(alone) > 1e-7, "{name} feels nothing");
        assert!(*alone == together, "{name} feels something else beside others");
    }
}

/// Pad and profile of a contact, sample by sample.
#[derive(Default)]
struct Rows {
    pad_m: Vec<f64>,
    height_m: Vec<f64>,
}

impl Tap for Rows {
    fn contact(&mut self, block: &ContactBlock<'_>) {
        self.pad_m.extend(block.contact_samples.iter().map(|row| row.pad_m));
        self.height_m.extend(block.contact_samples.iter().map(|row| row.height_m));
    }
}

/// k_m Fⁿ under the 0.6 N of these strokes.
fn stiffness_n_m(probe: &Probe) -> f64 {
    probe.contact_stiffness_n_m * 0.6f64.powf(probe.force_exponent)
}

/// |x_s / x_m| of a pressed probe: k_m over k_m and the probe's dynamic stiffness.
fn pressed_gain(probe: &Probe, frequency_hz: f64) -> f64 {
    let w = TAU * frequency_hz;
    let multiply = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let tie = [probe.pad_stiffness_n_m, w * probe.pad_damping_n_s_m];
    let mass = -probe.finger_mass_kg * w * w;
    let below = [tie[0] + mass, tie[1]];
    let square = below[0] * below[0] + below[1] * below[1];
    let behind = multiply(multiply(tie, [mass, 0.0]), [below[0] / square, -below[1] / square]);
    let stiffness_n_m = stiffness_n_m(probe);
    let all = [stiffness_n_m - probe.pad_mass_kg * w * w + behind[0], behind[1]];
    stiffness_n_m / all[0].hypot(all[1])
}

fn amplitude(x: &[f64], frequency_hz: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (i, x) in x.iter().enumerate() {
        let window = 1.0 - (TAU * i as f64 / f64::from(WINDOW)).cos();
        let angle = TAU * frequency_hz * i as f64 / RATE_HZ;
        re += window * x * angle.cos();
        im += window * x * angle.sin();
    }
    re.hypot(im)
}

const WINDOW: u32 = 44_100;

#[test]
fn pads_of_three_probes_move_on_a_plate_as_closed_forms() {
    for name in ["fingertip", "stylus", "rigid"] {
        let probe = preset(name);
        for frequency_hz in [20.0, 40.0, 80.0, 160.0, 315.0, 630.0, 1000.0] {
            // So low that the probe never leaves it: a tenth of what it is pressed in, at the
            // wave's own acceleration.
            let w = TAU * frequency_hz;
            let dynamic = stiffness_n_m(&probe) * pressed_gain(&probe, frequency_hz);
            let amplitude_m = (0.05 * 0.6 / dynamic).min(0.02 * 0.6 / ((probe.pad_mass_kg + 0.02) * w * w));
            let speed_m_s = 0.1;
            let wavelength_m = speed_m_s / frequency_hz;
            let (mut scene, mut renderer) = build(config());
            let own = scene.add_probe(probe).unwrap();
            let surface = grating(wavelength_m, amplitude_m);
            let surface = scene.add_surface(surface.wraps(true)).unwrap();
            let mut rows = Rows::default();
            for step in 0..90 {
                let t = f64::from(step) / 60.0;
                // The grating is a whole number of periods long, near SIDE_M.
                let width_m = (SIDE_M / wavelength_m).round().max(1.0) * wavelength_m;
                let sample = ContactSample {
                    uv: [speed_m_s * t / width_m, 0.5],
                    velocity_m_s: Some([speed_m_s, 0.0]),
                    normal_force_n: 0.6,
                    closing_m_s: 0.0,
                    ..ContactSample::default()
                };
                let event = match step {
                    0 => ContactEvent::begin_with(
                        ContactId(1),
                        Touching::on(surface).felt_by(ChannelId(0)).probe(own),
                        sample,
                    ),
                    _ => ContactEvent::moved(ContactId(1), sample),
                };
                scene.report(t, event).unwrap();
            }
            render(&mut renderer, 66_000, 256, &mut rows);
            let from = rows.pad_m.len() - WINDOW as usize;
            let [pad, height] =
                [&rows.pad_m[from..], &rows.height_m[from..]].map(|x| amplitude(x, frequency_hz));
            let (measured, exact) = (pad / height, pressed_gain(&probe, frequency_hz));
            let off_db = 20.0 * (measured / exact).log10();
            assert!(off_db.abs() < 1.0, "{name} at {frequency_hz} Hz: {measured} for {exact}, {off_db} dB");
        }
    }
}

/// Two bodies alike, one on each bus.
fn pen_and_plate(scene: &mut Scene) -> [BodyId; 2] {
    [0, 1].map(|bus| scene.add_body(Body::new(bar()).bus(BusId(bus))).unwrap())
}

#[test]
fn a_held_pen_rings_by_the_plates_impulses_with_opposite_sign() {
    let (mut scene, mut renderer) = build(config());
    let [wood, pen] = pen_and_plate(&mut scene);
    let surface = scene.add_surface(plate(0.9).body(wood)).unwrap();
    report(&mut scene, Touching::on(surface).felt_by(ChannelId(0)).held_by(pen), 1);
    let [felt, _, _, plate, held] = render(&mut renderer, 16_000, 256, &mut NoTap);
    assert!(peak(&felt) > 0.0 && peak(&plate) > 1e-5);
    assert!(plate.iter().zip(&held).all(|(plate, held)| *plate == -*held), "not equal and opposite");
}

#[test]
fn a_held_pen_rings_from_its_strike_as_its_mobility_says() {
    for name in ["fingertip", "stylus", "rigid"] {
        let (mut scene, mut renderer) = build(config());
        let [wood, pen] = pen_and_plate(&mut scene);
        let probe = scene.add_probe(preset(name)).unwrap();
        let blow = Impact { holder: Some(pen), probe: Some(probe), speed_m_s: 0.3, ..Impact::on(wood) };
        scene.report(0.01, ContactEvent::Impact(blow)).unwrap();
        let [felt, elsewhere, _, plate, held] = render(&mut renderer, 88_200, 256, &mut NoTap);
        assert!(peak(&plate) > 1e-3);
        assert!(plate.iter().zip(&held).all(|(plate, held)| *plate == -*held), "not equal and opposite");
        assert!(elsewhere.iter().all(|x| *x == 0.0), "felt by another hand");
        let impulse_n_s = blow.mass_kg * blow.speed_m_s * (1.0 + blow.restitution);
        let mobility = Mobility::new(&preset(name), RATE_HZ).unwrap();
        for frequency_hz in [20.0, 50.0, 100.0, 250.0, 500.0, 1000.0] {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, x) in felt.iter().enumerate() {
                let angle = TAU * frequency_hz * i as f64 / RATE_HZ;
                re += f64::from(*x) * angle.cos();
                im += f64::from(*x) * angle.sin();
            }
            let [a, b] = mobility.compliance_m_n(frequency_hz);
            let exact = impulse_n_s * pulse_spectrum(frequency_hz, &blow) * a.hypot(b);
            let measured = re.hypot(im) / RATE_HZ;
            let off = (measured / exact - 1.0).abs();
            assert!(off < 0.01, "{name} at {frequency_hz} Hz: {measured} for {exact}, {off}");
        }
    }
}

/// |P(f)| of the Hertz pulse of a blow on PLA, of area 1, by quadrature.
fn pulse_spectrum(frequency_hz: f64, blow: &Impact) -> f64 {
    let elastic = |m: Material| Elastic { young_pa: m.young_pa, poisson: m.poisson };
    let (striker, body) = (elastic(blow.striker), elastic(Material::PLA));
    let contact = HertzContact::new(&striker, &body, blow.radius_m, blow.mass_kg).unwrap();
    let turns = frequency_hz * contact.contact_time_s(blow.speed_m_s);
    let (mut re, mut im) = (0.0, 0.0);
    for i in 0..1000 {
        let u = (f64::from(i) + 0.5) / 1000.0;
        re += 1e-3 * pulse_shape(u) * (TAU * turns * u).cos();
        im += 1e-3 * pulse_shape(u) * (TAU * turns * u).sin();
    }
    re.hypot(im)
}

#[test]
fn a_strike_is_felt_only_on_the_channel_it_names() {
    let felt = |actuator: Option<ChannelId>| {
        let (mut scene, mut renderer) = build(config());
        let [wood, _] = pen_and_plate(&mut scene);
        scene.report(0.01, ContactEvent::Impact(Impact { actuator, ..Impact::on(wood) })).unwrap();
        render(&mut renderer, 20_000, 256, &mut NoTap).map(|x| peak(&x) > 0.0)
    };
    assert_eq!(felt(Some(ChannelId(2))), [false, false, true, true, false]);
    assert_eq!(felt(None), [false, false, false, true, false]);
}

#[test]
fn blows_and_held_strokes_have_the_same_bits_in_blocks() {
    let game = |block: usize| {
        let (mut scene, mut renderer) = build(config());
        let [wood, pen] = pen_and_plate(&mut scene);
        let stylus = scene.add_probe(preset("stylus")).unwrap();
        let surface = scene.add_surface(plate(0.6).body(wood)).unwrap();
        let touching = Touching::on(surface).felt_by(ChannelId(1)).held_by(pen).probe(stylus).gain(0.7);
        report(&mut scene, touching, 1);
        for step in 0..3 {
            let blow = Impact { holder: Some(pen), gain: 0.5, ..Impact::on(wood) };
            scene.report(0.3 + 0.0101 * f64::from(step), ContactEvent::Impact(blow)).unwrap();
        }
        render(&mut renderer, 20_000, block, &mut NoTap)
    };
    let reference = game(256);
    assert!(reference.iter().enumerate().all(|(i, x)| (peak(x) > 0.0) == (i != 2)));
    for block in [1, 7, 63, 64, 441, 4096] {
        assert!(game(block) == reference, "blocks of {block} differ");
    }
}

#[test]
fn a_contact_without_a_channel_is_heard_and_not_felt() {
    let game = |actuator: Option<ChannelId>, gain: f64| {
        let (mut scene, mut renderer) = build(config());
        let [wood, _] = pen_and_plate(&mut scene);
        let surface = scene.add_surface(plate(0.9).body(wood)).unwrap();
        let mut touching = Touching::on(surface).gain(gain);
        touching.actuator = actuator;
        report(&mut scene, touching, 1);
        render(&mut renderer, 16_000, 256, &mut NoTap)
    };
    let ([felt, _, _, heard, _], [nothing, _, _, same, _]) = (game(Some(ChannelId(0)), 1.0), game(None, 1.0));
    assert!(peak(&felt) > 0.0 && peak(&heard) > 0.0);
    assert!(nothing.iter().all(|x| *x == 0.0) && same == heard);
    let [_, _, _, louder, _] = game(None, 2.0);
    let ratio = peak(&louder) / peak(&heard);
    assert!((ratio - 2.0).abs() < 1e-3, "a gain of 2 gives {ratio}");
}

#[test]
fn a_missing_probe_holder_or_channel_is_refused() {
    let (mut scene, _renderer) = build(config());
    let [wood, pen] = pen_and_plate(&mut scene);
    let surface = scene.add_surface(plate(0.5).body(wood)).unwrap();
    let sample = ContactSample {
        uv: [0.1, 0.1],
        velocity_m_s: None,
        normal_force_n: 0.5,
        closing_m_s: 0.0,
        ..ContactSample::default()
    };
    let mut refused = |touching: Touching| {
        scene.report(0.0, ContactEvent::begin_with(ContactId(1), touching, sample)).unwrap_err().reason
    };
    let here = Touching::on(surface);
    assert_eq!(refused(here.probe(ProbeId::from_bits(1 << 32))), Refusal::UnknownProbe);
    assert_eq!(refused(here.felt_by(ChannelId(3))), Refusal::UnknownActuator { index: 3, channels: 3 });
    assert!(matches!(refused(here.gain(-1.0)), Refusal::BadValue(_)));
    assert!(matches!(refused(here.importance(f64::NAN)), Refusal::BadValue(_)));
    scene.remove_body(pen).unwrap();
    let blow = Impact { holder: Some(pen), ..Impact::on(wood) };
    assert_eq!(scene.report(0.0, ContactEvent::Impact(blow)).unwrap_err().reason, Refusal::UnknownBody);
}

#[test]
fn every_preset_is_a_probe_that_the_engine_takes() {
    let (mut scene, _renderer) = build(config());
    for (name, probe) in PROBE_PRESETS {
        assert!(scene.add_probe(probe).is_ok(), "{name}");
    }
    assert_eq!(probe_by_name("fingertip"), Some(Probe::default()));
    assert_eq!(probe_by_name("broom"), None);
}
