//! Impacts, sample by sample, against the modes; their level at every rate.

use asperity::{Config, ContactEvent, Impact, Integrator, Material, ModalModel, Mode};
use std::f64::consts::PI;

const RATES_HZ: [f64; 5] = [22_050.0, 44_100.0, 48_000.0, 96_000.0, 192_000.0];

fn body() -> Vec<Mode> {
    let mode = |i: i32| Mode {
        frequency_hz: 420.0 * 1.36f64.powi(i),
        decay_per_s: 20.0 + 35.0 * f64::from(i),
        amplitude: 0.3 + 0.1 * f64::from((7 * i) % 5),
        phase_rad: 0.4 * f64::from(i % 3),
    };
    (0..10).map(mode).collect()
}

const SPEED_M_S: f64 = 0.5;
const RADIUS_M: f64 = 0.005;

/// What bead and plate are both made of: nylon, or foam for the long contacts.
fn material(contact_s: f64) -> Material {
    let young_pa = if contact_s < 2e-3 { 2e9 } else { 1e5 };
    Material { young_pa, poisson: 0.3, ..Material::STEEL }
}

/// Mass of a bead that touches for `contact_s`: τ = 2.868 (m²/(R E*² v))^(1/5).
fn mass_kg(contact_s: f64) -> f64 {
    let Material { young_pa, poisson, .. } = material(contact_s);
    let effective_pa = young_pa / (2.0 * (1.0 - poisson * poisson));
    effective_pa * (RADIUS_M * SPEED_M_S * (contact_s / 2.868_265_7).powi(5)).sqrt()
}

/// The sound of an impact at `at` samples, on the scale of its own impulse.
fn struck(modes: &[Mode], contact_s: f64, at: f64, rate_hz: f64, integrator: Integrator) -> Vec<f32> {
    parted(modes, contact_s, at, rate_hz, integrator, 1.0)
}

/// The same, of a bead that parts so fast.
fn parted(
    modes: &[Mode],
    contact_s: f64,
    at: f64,
    rate_hz: f64,
    integrator: Integrator,
    restitution: f64,
) -> Vec<f32> {
    let config = Config { sample_rate_hz: rate_hz, integrator, culling: None, ..Config::default() };
    let asperity::Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    // Full scale is an impact like this one: what is 160 dB below it is put to rest.
    let model = ModalModel::new(modes.to_vec(), 2.0 * mass_kg(contact_s) * SPEED_M_S).unwrap();
    let body = scene.add_body(asperity::Body::new(model).material(material(contact_s))).unwrap();
    let impact = Impact {
        body,
        other: None,
        speed_m_s: SPEED_M_S,
        mass_kg: mass_kg(contact_s),
        radius_m: RADIUS_M,
        striker: material(contact_s),
        restitution,
        position: 0,
        ..Impact::on(body)
    };
    scene.report(at / rate_hz, ContactEvent::Impact(impact)).unwrap();
    let late = renderer.audio_latency_samples();
    let count = (at + 0.06 * rate_hz) as usize;
    let (mut haptic, mut audio) = (vec![0.0f32; count], vec![0.0f32; count]);
    renderer.render(&mut [&mut haptic], &mut [&mut audio]);
    audio.drain(..late);
    audio
}

/// The Hertz force by Runge–Kutta, convolved with the modes by small steps.
fn convolved(modes: &[Mode], contact_s: f64, at: f64, rate_hz: f64, count: usize) -> Vec<f64> {
    const POINTS: usize = 3000;
    let force = |x: f64| x.max(0.0).powf(1.5);
    let step = 2.943_275_18 * 1.25_f64.powf(0.4) / POINTS as f64;
    let (mut x, mut v) = (0.0, 1.0);
    let mut pulse = vec![0.0];
    for _ in 0..POINTS {
        let (k1, l1) = (v, -force(x));
        let (k2, l2) = (v + 0.5 * step * l1, -force(x + 0.5 * step * k1));
        let (k3, l3) = (v + 0.5 * step * l2, -force(x + 0.5 * step * k2));
        let (k4, l4) = (v + step * l3, -force(x + step * k3));
        x += step / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        v += step / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
        pulse.push(force(x));
    }
    let area: f64 = pulse.iter().sum();
    let mut out = vec![0.0; count];
    for mode in modes.iter().filter(|mode| mode.frequency_hz < 0.5 * rate_hz) {
        let omega = 2.0 * PI * mode.frequency_hz;
        let (mut re, mut im) = (0.0, 0.0);
        let sums: Vec<[f64; 2]> = (0..=POINTS)
            .map(|i| {
                let t = contact_s * i as f64 / POINTS as f64;
                let g = pulse[i] / area * (mode.decay_per_s * t).exp();
                let (half_re, half_im) = (0.5 * g * (omega * t).cos(), -0.5 * g * (omega * t).sin());
                let now = [re + half_re, im + half_im];
                (re, im) = (re + 2.0 * half_re, im + 2.0 * half_im);
                now
            })
            .collect();
        for (n, y) in out.iter_mut().enumerate() {
            let t = (n as f64 - at) / rate_hz;
            if t > 0.0 {
                let place = (t / contact_s * POINTS as f64).min(POINTS as f64 - 1e-9);
                let (i, share) = (place as usize, place.fract());
                let [re, im] = [0, 1].map(|k| sums[i][k] + share * (sums[i + 1][k] - sums[i][k]));
                let (sin, cos) = (omega * t + mode.phase_rad).sin_cos();
                *y += mode.amplitude * (-mode.decay_per_s * t).exp() * (re * sin + im * cos);
            }
        }
    }
    out
}

#[test]
fn every_strike_is_its_modes_from_the_first_sample_on() {
    let modes = body();
    for rate_hz in RATES_HZ {
        let mut worst: (f64, f64) = (0.0, 0.0);
        for contact_s in [1e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3] {
            for at in [200.0, 231.25, 263.5] {
                for integrator in [Integrator::ExactEvent, Integrator::SemiImplicitEuler] {
                    let found = struck(&modes, contact_s, at, rate_hz, integrator);
                    let wanted = convolved(&modes, contact_s, at, rate_hz, found.len());
                    // The ring's two samples before a strike are nothing but rounding.
                    let loudest = wanted.iter().fold(0.0_f64, |loudest, y| loudest.max(y.abs()));
                    let before = found[..=at as usize].iter().fold(0.0_f32, |most, y| most.max(y.abs()));
                    assert!(f64::from(before) < 1e-5 * loudest, "{rate_hz} Hz: {before} before {at}");
                    let square = |x: f64| x * x;
                    let wrong: f64 = found.iter().zip(&wanted).map(|(f, w)| square(f64::from(*f) - w)).sum();
                    let all: f64 = wanted.iter().map(|w| square(*w)).sum();
                    let error = (wrong / all).sqrt();
                    worst = if error > worst.0 { (error, contact_s) } else { worst };
                }
            }
        }
        println!("{rate_hz} Hz: {:.3} % of the event's rms, at {:.0e} s", 100.0 * worst.0, worst.1);
        assert!(worst.0 < 0.01, "{rate_hz} Hz: {:.3} % at {:.0e} s", 100.0 * worst.0, worst.1);
    }
}

#[test]
fn a_blow_that_loses_energy_is_brighter_as_its_law_says() {
    // Contact time, third octaves in units of it, and levels over the loss-free blow's there, dB,
    // each of one impulse: `dsp/tests/independent/hertz_restitution.py`'s integration.
    let contact_s = 1e-3;
    for (restitution, gains_db) in [(0.5, [0.1, 0.5, 3.6, 15.4]), (0.2, [0.8, 2.4, 8.0, 22.9])] {
        for (band, gain_db) in [0.5, 0.794, 1.26, 2.0].into_iter().zip(gains_db) {
            let mode = |i: i32| Mode {
                frequency_hz: band / contact_s * 2f64.powf(f64::from(i) / 24.0),
                decay_per_s: 60.0,
                amplitude: 1.0,
                phase_rad: 0.0,
            };
            let level = |restitution: f64| -> f64 {
                let alone = |i: i32| -> f64 {
                    let integrator = Integrator::default();
                    let audio = parted(&[mode(i)], contact_s, 100.0, 44_100.0, integrator, restitution);
                    audio[300..].iter().map(|y| f64::from(*y).powi(2)).sum()
                };
                10.0 * (-3..=3).map(alone).sum::<f64>().log10()
            };
            let impulse_db = 20.0 * f64::log10(0.5 * (1.0 + restitution));
            let apart_db = level(restitution) - level(1.0) - impulse_db - gain_db;
            println!("e {restitution} at {band} / τ: {apart_db:+.2} dB beside {gain_db}");
            assert!(apart_db.abs() < 1.8, "e {restitution} at {band} / τ: {apart_db} dB beside {gain_db}");
        }
    }
}

#[test]
fn soft_and_long_impacts_are_equally_loud_at_every_rate() {
    // Low modes, so that what is heard lies within every contact's spectrum.
    let modes: Vec<Mode> = (1..6)
        .map(|i| Mode { frequency_hz: 37.0 * f64::from(i), decay_per_s: 9.0, amplitude: 0.4, phase_rad: 0.0 })
        .collect();
    for contact_s in [1e-3, 5e-3, 2e-2, 5e-2] {
        let level = |rate_hz: f64| {
            let audio = struck(&modes, contact_s, 100.0, rate_hz, Integrator::default());
            audio[100..].iter().map(|y| f64::from(*y).powi(2)).sum::<f64>() / rate_hz
        };
        let reference = level(44_100.0);
        for rate_hz in RATES_HZ {
            let db = 10.0 * (level(rate_hz) / reference).log10();
            println!("{contact_s} s at {rate_hz} Hz: {db:+.3} dB");
            assert!(db.abs() <= 0.1, "{contact_s} s at {rate_hz} Hz: {db} dB");
        }
    }
}

/// Loudest sample of a 1 kg foam ball that lands on foam: about 100 ms of contact.
fn foam(mass_kg: f64, rate_hz: f64) -> (f64, u64) {
    let asperity::Engine { mut scene, mut renderer, .. } =
        Config { sample_rate_hz: rate_hz, ..Config::default() }.build().unwrap();
    let foam = Material { young_pa: 5e4, poisson: 0.3, ..Material::RUBBER };
    let mode = Mode { frequency_hz: 60.0, decay_per_s: 8.0, amplitude: 1.0, phase_rad: 0.0 };
    let body = scene
        .add_body(asperity::Body::new(ModalModel::new(vec![mode], 1.0).unwrap()).material(foam))
        .unwrap();
    let impact = Impact {
        body,
        other: None,
        speed_m_s: 0.1,
        mass_kg,
        radius_m: 0.05,
        striker: foam,
        restitution: 1.0,
        position: 0,
        ..Impact::on(body)
    };
    scene.report(0.01, ContactEvent::Impact(impact)).unwrap();
    let mut loudest = 0.0f64;
    for _ in 0..(0.5 * rate_hz) as usize / 512 {
        let (mut haptic, mut audio) = ([0.0f32; 512], [0.0f32; 512]);
        renderer.render(&mut [&mut haptic], &mut [&mut audio]);
        loudest = audio.iter().fold(loudest, |peak, y| peak.max(f64::from(y.abs())));
    }
    (loudest, scene.stats().shortened)
}

#[test]
fn a_pillow_is_equally_loud_at_every_rate() {
    for mass_kg in [1.0, 10.0] {
        let (reference, shortened) = foam(mass_kg, 44_100.0);
        assert_eq!(shortened, u64::from(mass_kg > 5.0), "{mass_kg} kg");
        for rate_hz in RATES_HZ {
            let (peak, message) = foam(mass_kg, rate_hz);
            let db = 20.0 * (peak / reference).log10();
            println!("{mass_kg} kg at {rate_hz} Hz: {db:+.3} dB");
            assert!(
                db.abs() <= 0.1 && message == shortened,
                "{mass_kg} kg at {rate_hz} Hz: {db} dB, {message} told"
            );
        }
    }
}
