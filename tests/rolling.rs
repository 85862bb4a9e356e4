//! What rolls is heard and felt otherwise than what slides as fast and as hard: darker, softer, its
//! loudness less even.
//!
//! Direction: rolling is heard through more of a low-pass than sliding (K. van den Doel, P. G. Kry,
//! D. K. Pai, "FoleyAutomatic", 2001), and what presses changes the slower the larger the ball (M.
//! M. J. Houben, A. Kohlrausch, D. J. Hermes 2004, recorded balls).

use crate::common;

use asperity::files::contact_log::{ContactLog, LogEvent};
use asperity::offline::{self, Options, Render};
use asperity::{
    ActuatorSettings, Body, Config, ContactEvent, ContactId, ContactSample, Engine, Material, Quantity,
    Stock, Surface, Touching, probe_by_name,
};
use common::strokes::{brownian, map, power, relief, rms_and_centroid};
use common::{SIDE_M, plate, rms, stroke};

/// A stroke of a second on a plate of a material, whatever its reports say besides.
fn heard(
    surface: Surface,
    material: Material,
    probe: &str,
    (speed_m_s, force_n): (f64, f64),
    block_frames: usize,
    rolls: impl Fn(f64) -> Option<(f64, f64)>,
) -> Render {
    let actuators = vec![ActuatorSettings {
        full_scale: 1.0,
        output: Quantity::Acceleration,
        ..ActuatorSettings::default()
    }];
    let config = Config { probe: probe_by_name(probe).unwrap(), actuators, ..Config::default() };
    let Engine { mut scene, renderer, mut names, .. } = config.build().unwrap();
    let body = scene.add_body(Body::stock(Stock::Plate, material, 0.3).unwrap()).unwrap();
    names.surfaces.insert("s".to_owned(), scene.add_surface(surface.body(body)).unwrap());
    let ContactLog { mut lines } = stroke(SIDE_M, speed_m_s, force_n, 1.0);
    for line in &mut lines {
        if let LogEvent::Begin { sample, .. } | LogEvent::Move { sample, .. } = &mut line.event
            && let Some((slip_m_s, radius_m)) = rolls(line.t)
        {
            *sample = sample.rolling(radius_m).slipping(slip_m_s);
        }
    }
    let options = Options { tail_s: 0.0, block_frames, ..Options::default() };
    offline::render(scene, renderer, &ContactLog { lines }, &names, &options).unwrap()
}

/// How much the loudness of 5 ms frames varies, over its mean, and the mean rate of its changes,
/// Hz.
fn envelope(x: &[f32], rate_hz: f64) -> (f64, f64) {
    let frame = (0.005 * rate_hz) as usize;
    let levels: Vec<f64> = x[(0.3 * rate_hz) as usize..].chunks_exact(frame).map(rms).collect();
    let mean = levels.iter().sum::<f64>() / levels.len() as f64;
    let centred: Vec<f32> = levels.iter().map(|level| (level / mean - 1.0) as f32).collect();
    let depth = rms(&centred);
    let changes: Vec<f32> = centred.windows(2).map(|pair| pair[1] - pair[0]).collect();
    (depth, rms(&changes) / depth * 200.0 / std::f64::consts::TAU)
}

#[test]
fn what_rolls_is_darker_than_what_slides_and_its_envelope_another() {
    let mut grounds: Vec<(String, Box<dyn Fn() -> Surface>)> = Vec::new();
    for r in [0.2, 0.5, 0.8] {
        grounds.push((format!("flat, R {r}"), Box::new(move || plate(r))));
    }
    let raster = brownian(0.6);
    grounds.push(("felt".to_owned(), Box::new(move || relief(&raster, 5e-5))));
    let rock = "Rock003_1K-PNG_Displacement.png";
    if map(rock, 1e-3).is_some() {
        grounds.push(("rock".to_owned(), Box::new(move || map(rock, 1e-3).unwrap())));
    }
    let mut rows = Vec::new();
    for (name, make) in &grounds {
        for (material, called) in [(Material::WOOD, "wood"), (Material::CERAMIC, "ceramic")] {
            for probe in ["rigid", "stylus"] {
                for cell in [(0.2, 0.5), (0.6, 2.0)] {
                    let [slides, rolls] = [None, Some((0.0, 0.01))]
                        .map(|message| heard(make(), material, probe, cell, 512, |_| message));
                    let rate_hz = slides.sample_rate_hz;
                    let of = |render: &Render| {
                        let (level, centroid_hz) =
                            rms_and_centroid(&power(&render.audio[0], rate_hz), 20.0, 16_000.0);
                        let felt = rms(&render.haptic[0][8820..]);
                        (level, centroid_hz, envelope(&render.audio[0], rate_hz), felt)
                    };
                    let (a, b) = (of(&slides), of(&rolls));
                    println!(
                        "{name:>12} {called:>8} {probe:>7} {:.1} m/s: {:6.0} → {:6.0} Hz, {:+.1} dB, depth {:.2} → {:.2}, \
                         rate {:.0} → {:.0} Hz, felt {:+.1} dB",
                        cell.0,
                        a.1,
                        b.1,
                        20.0 * (b.0 / a.0).log10(),
                        a.2.0,
                        b.2.0,
                        a.2.1,
                        b.2.1,
                        20.0 * (b.3 / a.3).log10()
                    );
                    rows.push([b.1 / a.1, b.2.0 / a.2.0, b.2.1 / a.2.1, b.0 / a.0, b.3 / a.3]);
                }
            }
        }
    }
    let median = |of: usize| {
        let mut values: Vec<f64> = rows.iter().map(|row| row[of]).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let [centroid, depth, rate, level, felt] = [0, 1, 2, 3, 4].map(median);
    println!(
        "median of rolling over sliding: centroid {centroid:.2}, depth {depth:.2}, rate {rate:.2}, level {level:.2}, felt {felt:.2}"
    );
    assert!(centroid < 0.8 && depth > 1.2, "centroid {centroid}, depth {depth}");
    // In every cell: by a fifth and more.
    assert!(rows.iter().all(|row| row[0] < 0.8 && row[3] < 1.0), "not darker, or louder, than sliding");
}

#[test]
fn a_continuing_contact_reports_its_whole_speed_in_any_blocks() {
    let plain = heard(plate(0.5), Material::WOOD, "rigid", (0.2, 1.0), 512, |_| None);
    // A hair more than the path, which is a number's rounding; what slips faster spins.
    let message = heard(plate(0.5), Material::WOOD, "rigid", (0.2, 1.0), 512, |_| Some((0.2019, 0.01)));
    assert_eq!(plain.audio, message.audio);
    assert_eq!(plain.haptic, message.haptic);
    // It rolls off, locks, and rolls again.
    let changes = |t: f64| Some((if (0.3..0.6).contains(&t) { 0.2 } else { 0.0 }, 0.02));
    let [long, short] =
        [512, 37].map(|block| heard(plate(0.5), Material::WOOD, "rigid", (0.2, 1.0), block, changes));
    assert_eq!(long.audio, short.audio);
    assert_eq!(long.haptic, short.haptic);
    // Locked it is as loud as what slides, rolling it is softer, and nothing clicks between.
    let part = |render: &Render, from: f64, to: f64| {
        let [from, to] = [from, to].map(|s| (s * render.sample_rate_hz) as usize);
        rms(&render.audio[0][from..to])
    };
    let rolling = part(&long, 0.15, 0.3);
    let locked = part(&long, 0.45, 0.6);
    assert!(rolling < 0.7 * locked, "{rolling} {locked}");
}

/// Level of a second of a wheel of 200 N that stays (or moves at `speed_m_s`) and slips, dB, and
/// what the scene says of silence.
fn wheel_db(speed_m_s: f64, slip_m_s: f64) -> (f64, Vec<String>) {
    let config = Config { probe: probe_by_name("rigid").unwrap(), ..Config::default() };
    let Engine { mut scene, mut renderer, .. } = config.build().unwrap();
    let body = scene.add_body(Body::stock(Stock::Plate, Material::WOOD, 0.5).unwrap()).unwrap();
    let road = scene.add_surface(plate(0.5).body(body)).unwrap();
    let (contact, tick) = (ContactId(1), 441);
    let mut out = Vec::new();
    for n in 0..60 {
        let t = f64::from(n) / 100.0;
        let uv = [0.2 + speed_m_s * t / SIDE_M, 0.5];
        let sample = ContactSample::new(uv, 200.0).sliding([speed_m_s, 0.0]);
        let sample = sample.rolling(0.3).slipping(slip_m_s);
        let event = if n == 0 {
            ContactEvent::begin_with(contact, Touching::on(road), sample)
        } else {
            ContactEvent::moved(contact, sample)
        };
        scene.report(t, event).unwrap();
        let mut audio = vec![0.0; tick];
        renderer.render(&mut [], &mut [&mut audio]);
        out.extend(audio);
    }
    let why = scene.why_silent().iter().map(ToString::to_string).collect();
    (20.0 * rms(&out[13_230..]).max(1e-12).log10(), why)
}

#[test]
fn a_wheel_spinning_on_the_spot_is_louder_with_more_slip() {
    let levels = [1.0, 4.0, 13.0].map(|slip_m_s| wheel_db(0.0, slip_m_s));
    println!("{levels:?}");
    assert!(levels.iter().all(|(_, why)| why.is_empty()));
    assert!(levels[0].0 > -60.0 && levels[1].0 > levels[0].0 + 3.0 && levels[2].0 > levels[1].0 + 3.0);
    // A wheel that rolls, one that is braked, one that spins on its way.
    let [rolls, braked, spins] = [0.0, 1.0, 13.0].map(|slip_m_s| wheel_db(1.0, slip_m_s).0);
    println!("{rolls} {braked} {spins}");
    assert!(braked > rolls && spins > braked + 6.0);
    // A wheel that spins is as loud as one that slides as fast, on the same kind of ground.
    let locked = wheel_db(4.0, 4.0).0;
    assert!((levels[1].0 - locked).abs() < 3.0, "{} and {locked}", levels[1].0);
    assert!(wheel_db(0.0, 0.0).0 < -100.0);
}
