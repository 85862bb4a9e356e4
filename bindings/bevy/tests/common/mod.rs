//! An app without a window whose time is set by hand: no test sleeps.

// Every test file uses a part of it.
#![allow(dead_code)]

use asperity::files::contact_log::{ContactLog, LogEvent, LogHand, LogLine, Names};
use asperity::offline::{self, Options, Render};
use asperity::{Body, Config, ContactSample, Engine, Material, ModalModel, Stock, Surface};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_asperity::*;
use std::collections::HashMap;
use std::time::Duration;

/// Length of a fixed step, and of a frame unless told otherwise.
pub const STEP: Duration = Duration::from_millis(16);

/// A ringing plate of 40 cm as the tests add it.
pub fn body() -> Body {
    Body::stock(Stock::Plate, Material::CERAMIC, 0.4).unwrap()
}

/// Its top, not on any body yet.
pub fn top() -> Surface {
    Surface::flat(0.4, 0.4).unwrap().material(Material::CERAMIC).wraps(false)
}

pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins)
        .add_plugins(AsperityPlugin::to(Output::Null { keep: true }))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app
}

pub fn plate(app: &mut App) -> Entity {
    app.world_mut().spawn((TouchBody(body()), TouchSurface::new(top()))).id()
}

pub fn touch(app: &mut App) -> Mut<'_, Touch> {
    app.world_mut().resource_mut::<Touch>()
}

/// A frame of another length.
pub fn frame(app: &mut App, length: Duration) {
    app.insert_resource(TimeUpdateStrategy::ManualDuration(length));
    app.update();
    app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
}

/// Where a finger is that slides over the plate.
pub fn sliding(t: f64) -> ContactSample {
    ContactSample::new([0.1 + 0.25 * t, 0.5], 0.7).sliding([0.1, 0.0])
}

/// Everything refused so far.
pub fn errors(app: &mut App) -> Vec<String> {
    app.world_mut().resource_mut::<Messages<TouchError>>().drain().map(|error| error.text).collect()
}

pub fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak, x| peak.max(x.abs()))
}

/// The recording rendered offline in an engine that is built as the app's was: `plates` of
/// [`plate`], then the probes of an adapter.
pub fn offline(log: &ContactLog, names: &Names, plates: usize) -> Render {
    // The recording survives its file.
    let mut text = Vec::new();
    log.write(&mut text).unwrap();
    let log = ContactLog::parse(std::str::from_utf8(&text).unwrap(), "recording").unwrap();
    let Engine { mut scene, renderer, .. } =
        Config { clock: asperity::ClockMode::Exact, ..AsperityPlugin::default().config }.build().unwrap();
    let mut own = Names { surfaces: HashMap::new(), bodies: HashMap::new(), probes: HashMap::new() };
    let mut probes: Vec<&String> = names.probes.keys().collect();
    probes.sort();
    for name in probes {
        let face_m =
            name.split_once(", face of ").map(|(_, face)| face.trim_end_matches(" m").parse().unwrap());
        let probe = face_m.map_or(asperity::THING_PROBE, asperity::thing_with_face);
        own.probes.insert(name.clone(), scene.add_probe(probe).unwrap());
    }
    for i in 0..plates {
        let body = scene.add_body(body()).unwrap();
        own.bodies.insert(format!("body {i}"), body);
        own.surfaces.insert(format!("surface {i}"), scene.add_surface(top().body(body)).unwrap());
    }
    offline::render(scene, renderer, &log, &own, &Options { tail_s: 3.0, ..Options::default() }).unwrap()
}

/// What the null output got is what the recording renders to, to the bit; and it is not silence.
pub fn assert_same_bits(app: &mut App, plates: usize) -> ContactLog {
    let (log, names) = {
        let mut touch = touch(app);
        assert_eq!((touch.stats().refused, touch.stats().dropped, touch.stats().late), (0, 0, 0));
        (touch.stop_recording(), touch.names().clone())
    };
    assert!(!log.lines.is_empty());
    let render = offline(&log, &names, plates);
    let mut output = app.world_mut().resource_mut::<NullOutput>();
    let late = output.latency_samples();
    for (what, played, rendered) in
        [("audio", &output.audio[0], &render.audio[0]), ("haptic", &output.haptic[0], &render.haptic[0])]
    {
        let played = &played[late..];
        let frames = played.len().min(rendered.len());
        assert!(frames > 80_000, "{what}: {frames} samples");
        let first = (0..frames).find(|i| played[*i].to_bits() != rendered[*i].to_bits());
        assert_eq!(first, None, "{what}: the first sample that differs, of {frames}");
    }
    let peaks = [peak(&output.audio[0]), peak(&output.haptic[0])];
    assert!(peaks[0] > 1e-6, "silence");
    assert!(peaks.iter().all(|peak| *peak <= 1.0), "beyond full scale: {peaks:?}");
    log
}

/// A plate of 1 m by 2 cm by 1 m whose upper face moves as cosines, in its own frame.
pub fn shaped_plate() -> Body {
    const SIDE: usize = 17;
    let across = |i: usize| i as f64 / (SIDE - 1) as f64 - 0.5;
    let points: Vec<[f64; 3]> =
        (0..SIDE * SIDE).map(|at| [across(at / SIDE), 0.01, across(at % SIDE)]).collect();
    let squares = (0..SIDE * (SIDE - 1)).filter(|at| at % SIDE != SIDE - 1);
    let triangles: Vec<[usize; 3]> =
        squares.flat_map(|a| [[a, a + 1, a + SIDE], [a + 1, a + SIDE + 1, a + SIDE]]).collect();
    let turn = std::f64::consts::PI;
    let mut modes = Vec::new();
    let mut motions = Vec::new();
    for (m, (a, b)) in [(1.0, 0.0), (0.0, 2.0), (1.0, 1.0), (2.0, 2.0), (3.0, 1.0)].into_iter().enumerate() {
        let hz = 300.0 * (1.0 + 0.7 * m as f64);
        modes.push(format!(r#"{{"frequency_hz": {hz:?}, "decay_per_s": 5.0, "amplitude": 1.0}}"#));
        let moves = |x: f64, z: f64| (turn * a * (x + 0.5)).cos() * (turn * b * (z + 0.5)).cos();
        motions.push(points.iter().map(|[x, _, z]| [0.0, moves(*x, *z), 0.0]).collect::<Vec<_>>());
    }
    let file = format!(
        r#"{{"format": "asperity.modes", "version": 2, "unit": "relative", "modes": [{}], "shapes": {{
            "points_m": {points:?}, "triangles": {triangles:?}, "gains": {:?},
            "phi_per_sqrt_kg": {motions:?}, "struck_point": 0}}}}"#,
        modes.join(","),
        vec![1.0; modes.len()],
    );
    ModalModel::parse(&file).unwrap().into()
}

/// Places of a [`shaped_plate`] that sound apart, x and z, m: the last is the loudest.
pub const PLACES_M: [[f32; 2]; 4] = [[0.0, 0.0], [0.4, 0.0], [0.21, -0.37], [0.45, 0.45]];

/// The one blow of an app on its one body, a [`shaped_plate`], is as loud as the same blow with its
/// place told by hand; its level, dB.
pub fn assert_sounds_as_told_at(app: &mut App, [x, z]: [f32; 2]) -> f64 {
    let mut log = touch(app).stop_recording();
    let blow = log.lines.iter().position(|line| matches!(line.event, LogEvent::Impact { .. })).unwrap();
    log.lines = vec![log.lines.swap_remove(blow)];
    let LogEvent::Impact { at_m, direction, .. } = &mut log.lines[0].event else { unreachable!() };
    assert!(at_m.is_some(), "no place is told");
    (*at_m, *direction) = (Some([f64::from(x), 0.01, f64::from(z)]), None);
    let config = Config { clock: asperity::ClockMode::Exact, ..AsperityPlugin::default().config };
    let Engine { mut scene, renderer, .. } = config.build().unwrap();
    let plate = scene.add_body(shaped_plate()).unwrap();
    let names = Names {
        bodies: HashMap::from([("body 0".to_string(), plate)]),
        surfaces: HashMap::new(),
        probes: HashMap::new(),
    };
    let options = Options { tail_s: 1.0, ..Options::default() };
    let by_hand = offline::render(scene, renderer, &log, &names, &options).unwrap();
    let level_db = |sound: &[f32]| {
        let begins = sound.iter().position(|x| x.abs() > 1e-3 * peak(sound)).unwrap();
        let power: f64 = sound[begins..begins + 9600].iter().map(|x| f64::from(*x).powi(2)).sum();
        10.0 * power.log10()
    };
    let told = level_db(&by_hand.audio[0]);
    let heard = level_db(&app.world().resource::<NullOutput>().audio[0]);
    println!("({x}, {z}) m: {heard:.3} dB, by hand {told:.3}");
    assert!((heard - told).abs() < 0.1, "({x}, {z}) m: {heard} dB, by hand {told}");
    heard
}

/// The blows of a recording: when, m/s, kg, m, rebound.
pub fn impacts(log: &ContactLog) -> Vec<[f64; 5]> {
    let blow = |line: &LogLine| match line.event {
        LogEvent::Impact { speed_m_s, mass_kg, radius_m, restitution, .. } => {
            Some([line.t, speed_m_s, mass_kg, radius_m, restitution])
        }
        _ => None,
    };
    log.lines.iter().filter_map(blow).collect()
}

/// What slid: how often something began and ended, with which probe, and every sample.
pub struct Slid {
    pub begins: Vec<LogHand>,
    pub ends: usize,
    pub samples: Vec<(f64, ContactSample)>,
}

pub fn slid(log: &ContactLog) -> Slid {
    let mut slid = Slid { begins: Vec::new(), ends: 0, samples: Vec::new() };
    for line in &log.lines {
        match &line.event {
            LogEvent::Begin { touching, sample, .. } => {
                slid.begins.push(touching.hand.clone());
                slid.samples.push((line.t, *sample));
            }
            LogEvent::Move { sample, .. } => slid.samples.push((line.t, *sample)),
            LogEvent::End { .. } => slid.ends += 1,
            _ => {}
        }
    }
    slid
}

/// A steel ball of 1 cm that fell 13 cm onto the plate: speeds of free fall, its own mass and
/// radius, each flight as long as its rebound says.
pub fn assert_bounces(log: &ContactLog) {
    let blows = impacts(log);
    assert!(blows.len() >= 2, "{blows:?}");
    let fall_m_s = (2.0 * 9.81 * 0.13_f64).sqrt();
    let mass_kg = 7800.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-6;
    let [_, speed_m_s, mass, radius_m, restitution] = blows[0];
    // A step of 16 ms is 0.16 m/s of fall.
    assert!((speed_m_s / fall_m_s - 1.0).abs() < 0.11, "{speed_m_s} m/s, must be near {fall_m_s}");
    assert!((mass / mass_kg - 1.0).abs() < 0.01, "{mass} kg, must be {mass_kg}");
    assert!((radius_m - 0.01).abs() < 1e-6 && (0.1..0.9).contains(&restitution), "{:?}", blows[0]);
    let [[t, speed, .., e], [later, next, ..]] = [blows[0], blows[1]];
    assert!((later - t - 2.0 * e * speed / 9.81).abs() < 0.045, "{} s of flight", later - t);
    assert!((next / speed - e).abs() < 0.15, "{next} m/s after {speed} m/s, rebound {e}");
    let last = blows.last().unwrap();
    assert!(last[0] - blows[0][0] < 1.0, "a ball that lies still strikes at {} s", last[0]);
}

/// A ball of 1 cm that rolled from 5 cm on at 0.2 m/s.
pub fn assert_rolls(log: &ContactLog) {
    let Slid { begins, samples, .. } = slid(log);
    assert_eq!(begins.len(), 1, "{begins:?}");
    for (t, sample) in samples.iter().skip(5).filter(|(t, _)| *t < 1.0) {
        let (u_m, along_m_s) = (0.4 * sample.uv[0], sample.velocity_m_s.unwrap()[0]);
        assert!((along_m_s - 0.2).abs() < 0.02, "{along_m_s} m/s at {t} s");
        assert!((u_m - (0.05 + 0.2 * t)).abs() < 0.012, "{u_m} m at {t} s");
        let (slip_m_s, radius_m) = (sample.slip_m_s.unwrap(), sample.roll_radius_m.unwrap());
        assert!(slip_m_s < 0.02 && (radius_m - 0.01).abs() < 1e-6, "{sample:?} at {t} s");
    }
}

/// A block of 16 g that slid over the plate from 5 cm on with 0.3 m/s and friction 0.05 until it
/// rested.
pub fn assert_slides(log: &ContactLog, probe: Option<&str>) {
    let Slid { begins, ends, samples } = slid(log);
    assert_eq!(begins.len(), 1, "{begins:?}");
    assert_eq!(begins[0].probe.as_deref(), probe);
    let weight_n = 0.016 * 9.81;
    // Where it lands and where it stops, after 0.61 s, are left out.
    let steady: Vec<_> = samples.iter().filter(|(t, _)| (0.1..0.5).contains(t)).collect();
    assert!(steady.len() > 20, "{} samples", steady.len());
    let force_n = steady.iter().map(|(_, sample)| sample.normal_force_n).sum::<f64>() / steady.len() as f64;
    assert!((force_n / weight_n - 1.0).abs() < 0.1, "{force_n} N, must be near {weight_n}");
    for (t, sample) in &steady {
        let at = |t: f64| 0.05 + 0.3 * t - 0.5 * 0.05 * 9.81 * t * t;
        let (u_m, velocity) = (0.4 * sample.uv[0], sample.velocity_m_s.unwrap());
        // The solver's point leads by as much as friction tips the block.
        assert!((u_m - at(*t)).abs() < 0.015, "at {t} s it is at {u_m} m, must be near {}", at(*t));
        assert!((velocity[0] - (0.3 - 0.05 * 9.81 * t)).abs() < 0.04, "{velocity:?} at {t} s");
        assert!(velocity[1].abs() < 0.01 && (sample.uv[1] - 0.5).abs() < 0.02, "{sample:?}");
    }
    // Its place moves as it slides: no leaps as points of contact come and go.
    for pair in steady.windows(2) {
        let moved_m = 0.4 * (pair[1].1.uv[0] - pair[0].1.uv[0]);
        assert!((-0.001..0.01).contains(&moved_m), "{moved_m} m in a step at {} s", pair[1].0);
    }
    if begins[0].actuator.is_none() {
        assert_eq!(ends, 1, "a block that lies still is still reported");
    }
}
