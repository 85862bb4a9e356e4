//! Pickups: what is read of a body's vibration is its modes' closed forms in SI units, whatever the
//! levels of what is heard.

use crate::closed_forms;
use crate::counting::held_bytes;

use asperity::{
    Body, BodyId, Config, ContactEvent, ContactId, ContactSample, Engine, Impact, Material, ModalModel, Mode,
    Pickup, PickupQuantity, RigidMotion, SensorProfile, Stock, Surface, SurfaceFrame, Touching,
};
use closed_forms::{
    FREE_BAR, PLATE_M, bar, bar_shape, modes_file, plate_of, plate_orders, plate_shape, shapes, sheet,
};
use std::f64::consts::TAU;

const RATE_HZ: f64 = 44_100.0;
const DECAY_PER_S: f64 = 4.0;
/// A hard, light ball: a contact of some microseconds.
const BLOW_N_S: f64 = 1e-4;

fn bar_hz(mode: usize) -> f64 {
    220.0 * (FREE_BAR[mode] / FREE_BAR[0]).powi(2)
}

fn plate_hz(mode: usize) -> f64 {
    let [a, b] = plate_orders(mode);
    90.0 * (a * a + b * b * (PLATE_M[0] / PLATE_M[1]).powi(2))
}

fn bar_body() -> ModalModel {
    ModalModel::parse(&modes_file(&bar(), bar_hz, DECAY_PER_S)).unwrap()
}

fn plate_body() -> ModalModel {
    ModalModel::parse(&modes_file(&plate_of([160, 120]), plate_hz, DECAY_PER_S)).unwrap()
}

fn tap(body: BodyId, at_m: [f64; 3]) -> ContactEvent {
    // 2 mg of steel at 25 m/s, which stays: 1 N·s a kilogram.
    let blow = Impact::on(body).striker(Material::STEEL, BLOW_N_S / 50.0, 2e-4).at_speed(25.0).at_m(at_m);
    ContactEvent::Impact(Impact { direction: Some([0.0, 0.0, 1.0]), ..blow })
}

fn config(channels: usize) -> Config {
    Config { pickups: vec![None; channels], actuators: vec![Default::default()], ..Config::default() }
}

/// Readings of a body that is tapped once.
fn tapped(body: impl Into<Body>, at_m: [f64; 3], samples: usize, block: usize) -> Vec<Vec<f32>> {
    let body = body.into();
    let channels = 1 + 4;
    let mut engine = config(channels).build().unwrap();
    let id = engine.scene.add_body(body).unwrap();
    engine.scene.report(0.0, tap(id, at_m)).unwrap();
    read(&mut engine, channels, samples, block)
}

fn read(engine: &mut Engine, channels: usize, samples: usize, block: usize) -> Vec<Vec<f32>> {
    let mut all = vec![vec![0.0; samples]; channels];
    let mut at = 0;
    while at < samples {
        let to = (at + block).min(samples);
        let mut slices: Vec<&mut [f32]> = all.iter_mut().map(|channel| &mut channel[at..to]).collect();
        engine.renderer.render_with_pickups(&mut [], &mut [], &mut slices);
        at = to;
    }
    all
}

fn up(at_m: [f64; 3]) -> Pickup {
    Pickup::at(at_m).along([0.0, 0.0, 1.0])
}

/// Amplitude of each mode at the onset, by least squares over what rings from the 64th sample on.
fn amplitudes(read: &[f32], hz: &[f64], decay_per_s: f64) -> Vec<f64> {
    let n = hz.len();
    let (mut normal, mut right) = (vec![vec![0.0; 2 * n]; 2 * n], vec![0.0; 2 * n]);
    for (i, y) in read.iter().enumerate().skip(64).step_by(2) {
        let t = i as f64 / RATE_HZ;
        let row: Vec<f64> = hz
            .iter()
            .flat_map(|hz| [(TAU * hz * t).sin(), (TAU * hz * t).cos()])
            .map(|x| x * (-decay_per_s * t).exp())
            .collect();
        for (a, sum) in row.iter().zip(&mut right) {
            *sum += a * f64::from(*y);
        }
        for (a, line) in row.iter().zip(&mut normal) {
            line.iter_mut().zip(&row).for_each(|(sum, b)| *sum += a * b);
        }
    }
    let found = solve(normal, right);
    found.chunks(2).map(|pair| pair[0].hypot(pair[1])).collect()
}

/// Gauss's elimination.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for i in 0..n {
        let pivot = a[i].clone();
        for j in i + 1..n {
            let factor = a[j][i] / pivot[i];
            a[j].iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
            b[j] -= factor * b[i];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[i][j] * b[j]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

/// Greatest error of the modes of a tap, dB. One that is weaker than 3 % of its greatest must be
/// within 3 % of that.
fn worst_db(found: &[f64], exact: &[f64], most: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for ((found, exact), most) in found.iter().zip(exact).zip(most) {
        let (exact, weak) = (exact.abs(), 0.03 * most);
        if exact < weak {
            assert!((found - exact).abs() <= weak, "{found} of {exact}, at most {most}");
        } else {
            worst = worst.max((20.0 * (found / exact).log10()).abs());
        }
    }
    worst
}

/// A sequence between 0 and 1 that fills it evenly.
fn even(i: usize, step: f64) -> f64 {
    (0.5 + step * i as f64).fract()
}

#[test]
fn a_tap_on_a_free_bar_is_read_as_its_closed_form() {
    let kg = 0.2_f64;
    let hz: Vec<f64> = (0..5).map(bar_hz).collect();
    let mut worst = 0.0_f64;
    for pair in 0..50 {
        let (x, p) = (even(pair, 0.618_034), even(pair, 0.754_878));
        let at = |x: f64| [0.5 * x, 0.015, 0.0];
        let pickups = [PickupQuantity::Acceleration, PickupQuantity::Velocity, PickupQuantity::Displacement];
        let mut body = Body::new(bar_body()).strike_gain(0.01);
        for (channel, quantity) in pickups.into_iter().enumerate() {
            body = body.pickup(up(at(p)).reading(quantity).on_channel(channel));
        }
        let readings = tapped(body, at(x), 22_050, 512);
        for (channel, power) in [(0, 1.0), (1, 0.0), (2, -1.0)] {
            let found = amplitudes(&readings[channel], &hz, DECAY_PER_S);
            let scale = |m: usize| BLOW_N_S / kg * (TAU * hz[m]).hypot(DECAY_PER_S).powf(power);
            let exact: Vec<f64> = (0..5).map(|m| scale(m) * bar_shape(m, x) * bar_shape(m, p)).collect();
            let most: Vec<f64> = (0..5).map(|m| 4.0 * scale(m)).collect();
            worst = worst.max(worst_db(&found, &exact, &most));
        }
    }
    println!("worst {worst:.3} dB");
    assert!(worst <= 0.5, "{worst} dB");
}

#[test]
fn a_tap_on_a_clamped_plate_is_its_closed_form() {
    // (5, 4) and (3, 5) are one pitch: what is read of it is their sum.
    let (twin, other) = (22, 26);
    assert_eq!(plate_orders(twin).map(|x| x as i32), [5, 4]);
    assert_eq!(plate_orders(other).map(|x| x as i32), [3, 5]);
    let without = |all: Vec<f64>| -> Vec<f64> {
        all.into_iter().enumerate().filter(|(m, _)| *m != other).map(|(_, x)| x).collect()
    };
    let hz = without((0..30).map(plate_hz).collect());
    let plate = plate_body();
    let mut worst = 0.0_f64;
    for pair in 0..50 {
        let at = |u: f64, v: f64| [PLATE_M[0] * u, PLATE_M[1] * v, 0.0];
        let struck = at(even(pair, 0.618_034), even(pair, 0.754_878));
        let heard = at(even(pair, 0.819_173), even(pair, 0.671_044));
        let body = Body::new(plate.clone()).pickup(up(heard));
        let readings = tapped(body, struck, 22_050, 512);
        let found = amplitudes(&readings[0], &hz, DECAY_PER_S);
        let scale = |m: usize| BLOW_N_S * (TAU * plate_hz(m)).hypot(DECAY_PER_S);
        let one = |m: usize| scale(m) * plate_shape(m, struck) * plate_shape(m, heard);
        let exact = (0..30).map(|m| one(m) + if m == twin { one(other) } else { 0.0 }).collect();
        let most = (0..30).map(|m| 4.0 * scale(m)).collect();
        worst = worst.max(worst_db(&found, &without(exact), &without(most)));
    }
    println!("worst {worst:.3} dB");
    assert!(worst <= 0.5, "{worst} dB");
}

#[test]
fn a_tap_here_is_read_there_as_one_there_is_read_here() {
    let (mut worst, plate) = (0.0_f64, plate_body());
    for pair in 0..50 {
        let at = |u: f64, v: f64| [PLATE_M[0] * u, PLATE_M[1] * v, 0.0];
        let here = at(even(pair, 0.618_034), even(pair, 0.754_878));
        let there = at(even(pair, 0.819_173), even(pair, 0.671_044));
        let one = tapped(Body::new(plate.clone()).pickup(up(there)), here, 4410, 512);
        let other = tapped(Body::new(plate.clone()).pickup(up(here)), there, 4410, 512);
        let peak = one[0].iter().fold(0.0_f32, |most, x| most.max(x.abs()));
        let apart = one[0].iter().zip(&other[0]).fold(0.0_f32, |most, (a, b)| most.max((a - b).abs()));
        worst = worst.max(f64::from(apart / peak));
    }
    println!("worst {worst:.2e}");
    assert!(worst <= 1e-6, "{worst}");
}

#[test]
fn readings_do_not_depend_on_blocks_and_leave_the_sound_alone() {
    let plain = Body::new(plate_body()).pickup(up([0.1, 0.1, 0.0]));
    let loud = plain.clone().strike_gain(0.03).gain(7.0);
    let one = tapped(plain.clone(), [0.2, 0.13, 0.0], 8000, 512);
    assert!(one == tapped(plain.clone(), [0.2, 0.13, 0.0], 8000, 37));
    let two = tapped(loud, [0.2, 0.13, 0.0], 8000, 512);
    let peak = one[0].iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    let apart = one[0].iter().zip(&two[0]).fold(0.0_f32, |most, (a, b)| most.max((a - b).abs()));
    assert!(apart < 3e-6 * peak, "{}", apart / peak);
    let heard = |body: Body| {
        let mut engine = Config { culling: None, ..config(5) }.build().unwrap();
        let id = engine.scene.add_body(body).unwrap();
        engine.scene.report(0.0, tap(id, [0.2, 0.13, 0.0])).unwrap();
        let mut audio = vec![0.0; 8000];
        engine.renderer.render(&mut [], &mut [&mut audio]);
        audio
    };
    assert!(heard(plain) == heard(Body::new(plate_body())));
}

#[test]
fn a_body_that_no_bus_hears_is_read_as_one_that_sounds() {
    let readings = |buses: usize| {
        let config = Config { audio: vec![Default::default(); buses], ..config(1) };
        let mut engine = config.build().unwrap();
        let body = Body::new(plate_body()).pickup(up([0.1, 0.1, 0.0]));
        let body = engine.scene.add_body(body).unwrap();
        engine.scene.report(0.0, tap(body, [0.2, 0.13, 0.0])).unwrap();
        let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
        let surface = Surface::flat(PLATE_M[0], PLATE_M[1]).unwrap().frame(frame).body(body);
        let surface = engine.scene.add_surface(surface).unwrap();
        for step in 0..12 {
            let t = f64::from(step) / 60.0;
            let sample = ContactSample::new([0.2 + t, 0.4], 0.5).sliding([PLATE_M[0], 0.0]);
            let event = match step {
                0 => ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample),
                11 => ContactEvent::end(ContactId(1)),
                _ => ContactEvent::moved(ContactId(1), sample),
            };
            engine.scene.report(0.1 + t, event).unwrap();
        }
        assert_eq!(engine.renderer.audio_buses(), buses);
        // Taken away while it rings, and until nothing rings.
        let mut all = read(&mut engine, 1, 20_000, 512).remove(0);
        engine.scene.remove_body(body).unwrap();
        all.extend(read(&mut engine, 1, 2 * 44_100, 512).remove(0));
        all
    };
    let heard = readings(1);
    assert!(heard[8000..12_000].iter().any(|x| x.abs() > 1e-3));
    assert!(readings(0) == heard);
}

#[test]
fn a_body_without_pickups_holds_nothing_for_those_of_others() {
    let plate = |listened: bool| {
        let plain = Body::new(plate_body());
        if listened { plain.pickup(up([0.1, 0.1, 0.0])) } else { plain }
    };
    let held = |channels: usize, beside: bool, own: bool| {
        let mut engine = config(channels).build().unwrap();
        engine.scene.add_body(plate(beside)).unwrap();
        let (body, before) = (plate(own), held_bytes());
        engine.scene.add_body(body).unwrap();
        held_bytes() - before
    };
    let [alone, beside, listened] = [(0, false, false), (1, true, false), (1, true, true)]
        .map(|(channels, beside, own)| held(channels, beside, own));
    assert!(beside == alone && listened != alone, "{alone} {beside} {listened}");
}

#[test]
fn a_tap_moves_a_place_no_further_than_its_modes_can() {
    let mut engine = config(1).build().unwrap();
    let pickup = up([0.12, 0.1, 0.0]).reading(PickupQuantity::Displacement);
    let body = engine.scene.add_body(Body::new(plate_body()).pickup(pickup)).unwrap();
    let mut peak = 0.0_f32;
    engine.scene.report(0.0, tap(body, [0.2, 0.13, 0.0])).unwrap();
    let reading = read(&mut engine, 1, 44_100, 512);
    for x in &reading[0] {
        peak = peak.max(x.abs());
    }
    // Σ φφ/ω J, at most.
    let most: f64 = (0..30).map(|m| 4.0 * BLOW_N_S / (TAU * plate_hz(m))).sum();
    assert!(f64::from(peak) <= most && f64::from(peak) > 0.05 * most, "{peak} of {most}");
}

#[test]
fn a_body_under_a_finger_is_read_as_damped_as_it_sounds() {
    // One mode: what is read and what is heard of it differ by a factor.
    let shapes = shapes(sheet(PLATE_M, [40, 30]), 1, |_| [0.0, 0.0, 1.0], plate_shape);
    let model = ModalModel::parse(&modes_file(&shapes, plate_hz, DECAY_PER_S)).unwrap();
    let ringing = |held: bool| {
        let mut engine = config(1).build().unwrap();
        let body = Body::new(model.clone()).pickup(up([0.12, 0.1, 0.0]));
        let body = engine.scene.add_body(body).unwrap();
        let frame = SurfaceFrame::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap();
        let surface = Surface::flat(PLATE_M[0], PLATE_M[1]).unwrap().micro_relief_m(0.0).frame(frame);
        let surface = engine.scene.add_surface(surface.body(body)).unwrap();
        engine.scene.report(0.0, tap(body, [0.2, 0.13, 0.0])).unwrap();
        for step in 0..40 {
            let sample = ContactSample::new([0.4, 0.4], 5.0).sliding([0.0, 0.0]);
            let event = match step {
                _ if !held => continue,
                0 => ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample),
                _ => ContactEvent::moved(ContactId(1), sample),
            };
            engine.scene.report(f64::from(step) / 60.0, event).unwrap();
        }
        let (mut audio, mut read) = (vec![0.0; 26_460], vec![0.0; 26_460]);
        engine.renderer.render_with_pickups(&mut [], &mut [&mut audio], &mut [&mut read]);
        let energy = |all: &[f32]| all[22_050..].iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
        [energy(&audio), energy(&read)]
    };
    let (free, held) = (ringing(false), ringing(true));
    let [heard, read] = [held[0] / free[0], held[1] / free[1]];
    println!("{:.1} dB heard, {:.1} dB read", 10.0 * heard.log10(), 10.0 * read.log10());
    assert!(heard < 0.5 && (read / heard - 1.0).abs() < 0.05, "{read} of {heard}");
}

#[test]
fn a_body_twice_as_large_is_moved_as_its_mass_says() {
    // A tap moves each mode as slowly as its mass says.
    let speed = |size: f64| {
        let model = bar_body().scaled(size, &Material::STEEL).unwrap();
        let (hz, decay_per_s) = (model.modes[0].frequency_hz, model.modes[0].decay_per_s);
        let at = |x: f64| [x * size, 0.015 * size, 0.0];
        let body = Body::new(model).pickup(up(at(0.1)).reading(PickupQuantity::Velocity));
        let readings = tapped(body, at(0.2), 22_050, 512);
        let hz: Vec<f64> = (0..5).map(|m| hz * (FREE_BAR[m] / FREE_BAR[0]).powi(2)).collect();
        amplitudes(&readings[0], &hz, decay_per_s)[0]
    };
    let ratio = speed(1.0) / speed(2.0);
    assert!((ratio / 8.0 - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn a_pickup_on_a_body_without_shapes_moves_as_its_factor_says() {
    let bowl = Body::stock(Stock::Bowl, Material::STEEL, 0.1).unwrap();
    let mut engine = config(2).build().unwrap();
    let body = bowl.pickup(Pickup::at_share(1.0)).pickup(Pickup::at_share(-0.5).on_channel(1));
    let id = engine.scene.add_body(body).unwrap();
    engine.scene.report(0.0, ContactEvent::Impact(Impact::on(id))).unwrap();
    let readings = read(&mut engine, 2, 4096, 512);
    let peak = readings[0].iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    assert!(peak > 1.0);
    assert!(readings[0].iter().zip(&readings[1]).all(|(a, b)| (a + 2.0 * b).abs() < 1e-5 * peak));
}

fn rigid(motions: &[(f64, RigidMotion)], seconds: f64) -> Vec<f32> {
    let mut engine = config(1).build().unwrap();
    let body = engine.scene.add_body(Body::new(plate_body()).pickup(Pickup::at([0.3, 0.1, 0.0]))).unwrap();
    for (t, motion) in motions {
        engine.scene.report(*t, ContactEvent::Motion { body, motion: *motion }).unwrap();
    }
    read(&mut engine, 1, (seconds * RATE_HZ) as usize, 512).remove(0)
}

#[test]
fn an_accelerometer_reads_gravity_at_rest_and_nothing_falling() {
    let gravity_m_s2 = [0.0, 0.0, -9.81];
    let rest = RigidMotion { gravity_m_s2, ..RigidMotion::default() };
    let falling = RigidMotion { acceleration_m_s2: gravity_m_s2, ..rest };
    let read = rigid(&[(0.0, rest), (0.1, rest), (0.2, falling), (0.3, falling)], 0.5);
    assert!((read[4410] / 9.81 - 1.0).abs() < 1e-3, "{}", read[4410]);
    assert!(read[20_000].abs() < 9.81e-3, "{}", read[20_000]);
}

#[test]
fn an_accelerometer_that_spins_reads_what_pulls_it_inwards() {
    let mut engine = config(1).build().unwrap();
    let pickup = Pickup::at([0.3, 0.1, 0.0]).along([-1.0, 0.0, 0.0]);
    let body = engine.scene.add_body(Body::new(plate_body()).pickup(pickup)).unwrap();
    let motion = RigidMotion {
        angular_velocity_rad_s: [0.0, 0.0, 20.0],
        centre_m: [0.1, 0.1, 0.0],
        ..RigidMotion::default()
    };
    for step in 0..10 {
        let event = ContactEvent::Motion { body, motion };
        engine.scene.report(f64::from(step) / 100.0, event).unwrap();
    }
    let read = read(&mut engine, 1, 4410, 512);
    let exact = 20.0 * 20.0 * 0.2;
    assert!((f64::from(read[0][4000]) / exact - 1.0).abs() < 1e-3, "{}", read[0][4000]);
}

#[test]
fn a_sensor_hears_with_its_resonance_and_gives_volts() {
    let sensor = SensorProfile {
        resonance_hz: 5000.0,
        quality: 10.0,
        band_hz: [0.0, 1e6],
        noise_m_s2_rthz: 0.0,
        clip_m_s2: 1e9,
        gain_v_per_m_s2: 0.01,
        adc_bits: 0,
    };
    let read_by = |sensor: Option<SensorProfile>, sample_rate_hz: f64| {
        let config = Config { pickups: vec![sensor], sample_rate_hz, ..Config::default() };
        let mut engine = config.build().unwrap();
        let mode = Mode { frequency_hz: 4000.0, decay_per_s: 2.0, amplitude: 1.0, phase_rad: 0.0 };
        let model = ModalModel::new(vec![mode], 1.0).unwrap();
        let body = Body::new(model).mass_kg(0.1).pickup(Pickup::at_share(1.0));
        let id = engine.scene.add_body(body).unwrap();
        engine.scene.report(0.0, ContactEvent::Impact(Impact::on(id))).unwrap();
        let read = read(&mut engine, 1, (0.2 * sample_rate_hz) as usize, 512);
        let tail = &read[0][read[0].len() / 2..];
        tail.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt()
    };
    for rate_hz in [44_100.0, 16_000.0] {
        let ratio = read_by(Some(sensor), rate_hz) / read_by(None, rate_hz) / 0.01;
        let db = 20.0 * (ratio / sensor.response(4000.0)).log10();
        assert!(db.abs() < 0.1, "{db} dB at {rate_hz} Hz");
    }
}

#[test]
fn a_pickup_that_reads_nothing_is_refused_in_one_line() {
    let refused = |body: Body, channels: usize| {
        config(channels).build().unwrap().scene.add_body(body).unwrap_err().to_string()
    };
    let plate = || Body::new(plate_body());
    let off = refused(plate().pickup(Pickup::at([0.1, 0.1, 0.02])), 1);
    assert!(off.starts_with("pickup 1: at_m: is 0.02 m off the surface; must be within 1 %"), "{off}");
    let none = refused(plate().pickup(Pickup::at([0.1, 0.1, 0.0])), 0);
    assert!(none.starts_with("pickup 1: channel: 0 is refused"), "{none}");
    let shares = refused(plate().pickup(Pickup::at_share(1.0)), 1);
    assert!(shares.starts_with("pickup 1: factor: "), "{shares}");
    let bowl = Body::stock(Stock::Bowl, Material::STEEL, 0.1).unwrap();
    let place = refused(bowl.pickup(Pickup::at([0.0; 3])), 1);
    assert!(place.starts_with("pickup 1: at_m: the body has no shapes; write factor"), "{place}");
    let nan = refused(plate().pickup(Pickup::at([f64::NAN, 0.0, 0.0])), 1);
    assert!(nan.starts_with("pickup 1: at_m: NaN"), "{nan}");
}
