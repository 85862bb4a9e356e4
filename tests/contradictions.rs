//! Logs that contradict themselves are told, with the unit that was meant; right ones are not.

use asperity::{
    Body, Config, ContactEvent, ContactId, ContactSample, Contradiction, Engine, Impact, Likely, Material,
    Scene, SilenceReason, Stock, Surface, Touching, probe_by_name,
};
use asperity_dsp::rng::Rng;
use std::f64::consts::TAU;

/// One report: time, contact, uv, velocity, and whether it begins the contact.
#[derive(Clone, Copy)]
struct Report {
    t: f64,
    contact: u64,
    uv: [f64; 2],
    velocity_m_s: [f64; 2],
    force_n: f64,
    begins: bool,
}

/// A motion over a surface of a size.
#[derive(Clone)]
struct Stroke {
    size_m: [f64; 2],
    reports: Vec<Report>,
}

const MOTIONS: [&str; 6] = ["line", "arc", "circle", "to and fro", "speeding up", "wandering"];

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.uniform()
}

/// Place and velocity along a motion, m and m/s, at a time.
fn motion(kind: &str, rng: &mut Rng) -> impl Fn(f64) -> ([f64; 2], [f64; 2]) + use<> {
    let speed = between(rng, 0.03, 0.25);
    // Along both axes: a motion along one says nothing of the other.
    let quarter = (4.0 * rng.uniform()).floor();
    let angle = between(rng, 0.45, 0.62) + quarter * TAU / 4.0;
    let hz = between(rng, 0.5, 1.5);
    let phases: Vec<f64> = (0..6).map(|_| TAU * rng.uniform()).collect();
    let kind = kind.to_owned();
    move |t: f64| {
        let along = |s: f64, v: f64| ([s * angle.cos(), s * angle.sin()], [v * angle.cos(), v * angle.sin()]);
        let turn = TAU * hz;
        match kind.as_str() {
            "line" => along(speed * t, speed),
            "arc" => {
                let r = speed / 0.7;
                let a = angle + 0.7 * t;
                ([r * a.sin(), -r * a.cos()], [speed * a.cos(), speed * a.sin()])
            }
            "circle" => {
                let r = speed / turn;
                let a = angle + turn * t;
                ([r * a.cos(), r * a.sin()], [-speed * a.sin(), speed * a.cos()])
            }
            "to and fro" => {
                let r = speed / turn;
                along(r * (turn * t).sin(), speed * (turn * t).cos())
            }
            "speeding up" => along(0.5 * speed * t * t + 0.2 * speed * t, speed * t + 0.2 * speed),
            _ => {
                let mut at = along(0.5 * speed * t, 0.5 * speed);
                for (k, phase) in phases.iter().enumerate() {
                    let w = TAU * (0.3 + 0.25 * k as f64);
                    let r = 0.3 * speed / w;
                    at.0[k % 2] += r * (w * t + phase).sin();
                    at.1[k % 2] += 0.3 * speed * (w * t + phase).cos();
                }
                at
            }
        }
    }
}

fn stroke(kind: &str, rng: &mut Rng) -> Stroke {
    let small = rng.uniform() < 0.7;
    let side = |rng: &mut Rng| if small { between(rng, 0.06, 0.42) } else { between(rng, 2.4, 6.0) };
    let size_m = [side(rng), side(rng)];
    let rate_hz = [30.0, 60.0, 90.0, 120.0, 500.0, 1000.0][(6.0 * rng.uniform()) as usize];
    let at = motion(kind, rng);
    let steps = (between(rng, 0.8, 2.5) * rate_hz) as usize;
    let start = [between(rng, 0.1, 0.5), between(rng, 0.1, 0.5)];
    // From a touch to what a finger can press at most.
    let force_n = 0.05 * 1200f64.powf(rng.uniform());
    let report = |i: usize| {
        let t = i as f64 / rate_hz;
        let (place, velocity_m_s) = at(t);
        let uv = [0, 1].map(|c| start[c] + place[c] / size_m[c]);
        Report { t, contact: 1, uv, velocity_m_s, force_n, begins: i == 0 }
    };
    Stroke { size_m, reports: (0..steps).map(report).collect() }
}

fn message(stroke: &Stroke, wraps: bool) -> Vec<Contradiction> {
    contradictions(&reported(stroke, wraps, |_, _| ()))
}

/// A scene that was told a stroke, and beside each of its reports what `also` tells.
fn reported(stroke: &Stroke, wraps: bool, mut also: impl FnMut(&mut Scene, f64)) -> Scene {
    let Engine { mut scene, .. } = Config { queue_capacity: 1 << 15, ..Config::default() }.build().unwrap();
    let [width_m, height_m] = stroke.size_m;
    let surface = Surface::flat(width_m, height_m).unwrap();
    let surface = surface.wraps(wraps);
    let surface = scene.add_surface(surface).unwrap();
    for report in &stroke.reports {
        let sample = ContactSample::new(report.uv, report.force_n).sliding(report.velocity_m_s);
        let contact = ContactId(report.contact);
        let event = if report.begins {
            ContactEvent::begin_with(contact, Touching::on(surface), sample)
        } else {
            ContactEvent::moved(contact, sample)
        };
        scene.report(report.t, event).unwrap();
        also(&mut scene, report.t);
    }
    scene
}

/// Slips that no single report shows: times that stand, forces and blows.
fn habits(scene: &Scene) -> Vec<SilenceReason> {
    let mut found = scene.why_silent();
    found.retain(|reason| {
        matches!(
            reason,
            SilenceReason::TimeStands { .. }
                | SilenceReason::PressedTooHard { .. }
                | SilenceReason::StruckEveryStep { .. }
                | SilenceReason::NeverPressed
        )
    });
    found
}

fn contradictions(scene: &Scene) -> Vec<Contradiction> {
    let found = scene.why_silent().into_iter();
    found
        .filter_map(|reason| if let SilenceReason::Contradicts(found) = reason { Some(found) } else { None })
        .collect()
}

/// A slip, and whether what is told of it is right.
type Slip = (&'static str, fn(&mut Stroke), fn(&Contradiction, &Stroke) -> bool);

fn each(stroke: &mut Stroke, change: impl Fn(&mut Report, [f64; 2])) {
    let size_m = stroke.size_m;
    stroke.reports.iter_mut().for_each(|report| change(report, size_m));
}

fn scaled_uv(stroke: &mut Stroke, scale: f64) {
    each(stroke, |report, size_m| report.uv = [0, 1].map(|c| report.uv[c] * size_m[c] * scale));
}

fn scaled_velocity(stroke: &mut Stroke, scale: f64) {
    each(stroke, |report, _| report.velocity_m_s = report.velocity_m_s.map(|v| v * scale));
}

fn is(found: &Contradiction, meant: Likely) -> bool {
    matches!(found, Contradiction::Speed { likely, .. } if *likely == meant)
}

const PLANE: f64 = 6.0;

fn slips() -> [Slip; 14] {
    [
        ("uv in metres", |s| scaled_uv(s, 1.0), |found, _| is(found, Likely::UvInMetres)),
        ("uv in centimetres", |s| scaled_uv(s, 100.0), |found, _| is(found, Likely::UvInCentimetres)),
        ("uv in millimetres", |s| scaled_uv(s, 1000.0), |found, _| is(found, Likely::UvInMillimetres)),
        (
            "uv in texels",
            |s| each(s, |report, _| report.uv = [report.uv[0] * 1024.0, report.uv[1] * 768.0]),
            |found, s| {
                // 1024 texels over a metre and millimetres are the same motion.
                is(found, Likely::UvInTexels)
                    || s.size_m.iter().zip([1024.0, 768.0]).all(|(m, n)| (m * 1e3 / n).ln().abs() < 0.15)
            },
        ),
        (
            "velocity in uv a second",
            |s| {
                each(s, |report, size_m| {
                    report.velocity_m_s = [0, 1].map(|c| report.velocity_m_s[c] / size_m[c])
                })
            },
            |found, _| is(found, Likely::UvInMetres),
        ),
        (
            "velocity in mm/s",
            |s| scaled_velocity(s, 1000.0),
            |found, _| is(found, Likely::VelocityInMillimetres),
        ),
        (
            "velocity in cm/s",
            |s| scaled_velocity(s, 100.0),
            |found, _| is(found, Likely::VelocityInCentimetres),
        ),
        (
            "velocity backwards",
            |s| scaled_velocity(s, -1.0),
            |found, _| matches!(found, Contradiction::Turned { axes: [true, true], .. }),
        ),
        (
            "v upwards",
            |s| each(s, |report, _| report.velocity_m_s[1] = -report.velocity_m_s[1]),
            |found, _| matches!(found, Contradiction::Turned { axes: [false, true], .. }),
        ),
        (
            "u and v swapped",
            |s| each(s, |report, _| report.velocity_m_s.swap(0, 1)),
            |found, _| matches!(found, Contradiction::Swapped { .. }),
        ),
        (
            "begin at every step",
            |s| each(s, |report, _| report.begins = true),
            |found, _| matches!(found, Contradiction::BeginsAgain { .. }),
        ),
        (
            "two fingers under one number",
            |s| {
                let second =
                    |report: &Report| Report { uv: [report.uv[0] + 0.04 / 0.06, report.uv[1]], ..*report };
                s.reports = s.reports.iter().flat_map(|report| [*report, second(report)]).collect();
            },
            |found, _| matches!(found, Contradiction::TwoPlaces { .. } | Contradiction::BeginsAgain { .. }),
        ),
        (
            "a plane of another size",
            |s| {
                each(s, |report, size_m| {
                    report.uv = [0, 1].map(|c| report.uv[c] * size_m[c] / (PLANE * size_m[c].sqrt()))
                })
            },
            |found, s| match found {
                Contradiction::Speed { likely: Likely::AnotherSize(plane_m), .. } => [0, 1].iter().all(|c| {
                    plane_m[*c].is_none_or(|m| (m / (PLANE * s.size_m[*c].sqrt())).ln().abs() < 0.1)
                }),
                _ => false,
            },
        ),
        (
            "times in milliseconds",
            |s| each(s, |report, _| report.t *= 1000.0),
            |found, _| is(found, Likely::TimesInMilliseconds),
        ),
    ]
}

#[test]
fn a_contradicting_log_is_reported_with_the_likely_unit() {
    let mut rng = Rng::new(54);
    let (mut tried, mut right) = (0, 0);
    let mut missed = Vec::new();
    for kind in MOTIONS {
        for (slip, spoil, is_right) in slips() {
            for _ in 0..8 {
                let mut stroke = stroke(kind, &mut rng);
                let whole = stroke.clone();
                spoil(&mut stroke);
                let found = message(&stroke, true);
                tried += 1;
                if found.len() == 1 && is_right(&found[0], &whole) {
                    right += 1;
                } else {
                    missed.push(format!("{slip}, {kind}: {found:?} of {:?}", whole.size_m));
                }
            }
        }
    }
    println!("{right} of {tried} told with the right unit\n{}", missed.join("\n"));
    assert!(100 * right >= 95 * tried, "{right} of {tried}\n{}", missed.join("\n"));
}

#[test]
fn a_right_log_is_not_called_a_contradiction() {
    let mut rng = Rng::new(500);
    let mut alarms = Vec::new();
    for number in 0..500 {
        let kind = MOTIONS[number % MOTIONS.len()];
        let mut stroke = stroke(kind, &mut rng);
        let wraps = number % 3 != 0;
        let reports = &mut stroke.reports;
        match number / 6 % 6 {
            // Wrapped at the edge, and shifted so that it is crossed.
            0 if wraps => reports.iter_mut().for_each(|r| r.uv = r.uv.map(|x| (x + 0.4).rem_euclid(1.0))),
            // Hitches: reports that never came.
            1 => {
                let mut left = 0;
                reports.retain(|r| {
                    if left == 0 && rng.uniform() < 0.05 {
                        left = (8.0 * rng.uniform()) as u32;
                    }
                    left = left.saturating_sub(1);
                    r.begins || left == 0
                });
            }
            // Teleports.
            2 => {
                let mut shift = [0.0; 2];
                for report in reports.iter_mut() {
                    if rng.uniform() < 0.03 {
                        shift = [rng.uniform(), rng.uniform()];
                    }
                    report.uv = [report.uv[0] + shift[0], report.uv[1] + shift[1]];
                }
            }
            // Places that jitter by a tenth of a millimetre, velocities by a tenth.
            3 => {
                let size_m = stroke.size_m;
                for report in reports.iter_mut() {
                    report.uv = [0, 1].map(|c| report.uv[c] + 1e-4 * rng.normal() / size_m[c]);
                    report.velocity_m_s = report.velocity_m_s.map(|v| v * (1.0 + 0.1 * rng.normal()));
                }
            }
            // Velocities of the step before, as differences of places.
            4 => {
                let size_m = stroke.size_m;
                for i in (1..reports.len()).rev() {
                    let step_s = reports[i].t - reports[i - 1].t;
                    reports[i].velocity_m_s =
                        [0, 1].map(|c| (reports[i].uv[c] - reports[i - 1].uv[c]) * size_m[c] / step_s);
                }
            }
            // Places that are reported twice, between two steps of the physics.
            5 => {
                for i in (1..reports.len()).step_by(2) {
                    (reports[i].uv, reports[i].velocity_m_s) =
                        (reports[i - 1].uv, reports[i - 1].velocity_m_s);
                }
            }
            _ => {}
        }
        // Blows beside it: a drum roll, hail, a few at once as a pile falls, or none.
        let mut body = None;
        let roll_hz = between(&mut rng, 5.0, 32.0);
        let mut due_s = 0.0;
        let scene = reported(&stroke, wraps, |scene, t| {
            let stock = || Body::stock(Stock::Plate, Material::WOOD, 0.2).unwrap();
            let body = *body.get_or_insert_with(|| scene.add_body(stock()).unwrap());
            let count = match number % 4 {
                0 if t >= due_s => 1,
                1 => (-rng.uniform().ln() * 1.5) as u32,
                2 if rng.uniform() < 0.05 => 12,
                _ => 0,
            };
            if count > 0 {
                due_s += 1.0 / roll_hz;
            }
            for _ in 0..count {
                scene.report(t, ContactEvent::Impact(Impact::on(body))).unwrap();
            }
        });
        let found = contradictions(&scene);
        let habits = habits(&scene);
        if !found.is_empty() || !habits.is_empty() {
            alarms.push(format!("{number}, {kind}: {found:?} {habits:?} of {:?}", stroke.size_m));
        }
    }
    assert!(alarms.is_empty(), "{} false alarms\n{}", alarms.len(), alarms.join("\n"));
}

#[test]
fn standing_times_wrong_units_and_constant_blows_are_reported() {
    let mut rng = Rng::new(60);
    for kind in MOTIONS {
        for _ in 0..8 {
            let whole = stroke(kind, &mut rng);
            // What a game reports at every frame, between 50 and 120 times a second.
            let step_s = 1.0 / between(&mut rng, 50.0, 120.0);
            let with = |change: fn(&mut Report)| {
                let mut spoilt = whole.clone();
                for (i, report) in spoilt.reports.iter_mut().enumerate() {
                    report.t = i as f64 * step_s;
                    change(report);
                }
                spoilt
            };
            let silent = |_: &mut Scene, _: f64| ();
            let stands = habits(&reported(&with(|report| report.t = 0.0), true, silent));
            assert!(matches!(stands[..], [SilenceReason::TimeStands { time_s: 0.0, .. }]), "{stands:?}");
            // A light touch in millinewtons is what a finger presses with; 0.3 N and more are told.
            let pressed = with(|report| report.force_n = 1e3 * report.force_n.max(0.3));
            let pressed = habits(&reported(&pressed, true, silent));
            assert!(matches!(pressed[..], [SilenceReason::PressedTooHard { .. }]), "{pressed:?}");
            let unpressed = habits(&reported(&with(|report| report.force_n = 0.0), true, silent));
            assert_eq!(unpressed, [SilenceReason::NeverPressed]);
            let mut body = None;
            let struck = reported(&with(|_| ()), true, |scene, t| {
                let stock = || Body::stock(Stock::Plate, Material::WOOD, 0.2).unwrap();
                let body = *body.get_or_insert_with(|| scene.add_body(stock()).unwrap());
                scene.report(t, ContactEvent::Impact(Impact::on(body))).unwrap();
            });
            let struck = habits(&struck);
            let steps = whole.reports.len() as u64;
            let expected = (steps >= 30).then_some(SilenceReason::StruckEveryStep { count: steps });
            assert_eq!(struck, expected.into_iter().collect::<Vec<_>>());
        }
    }
}

#[test]
fn a_heavy_thing_with_its_own_probe_presses_without_bound() {
    let Engine { mut scene, .. } = Config::default().build().unwrap();
    let surface = scene.add_surface(Surface::flat(4.0, 4.0).unwrap()).unwrap();
    for (number, name) in ["rigid", "sole"].into_iter().enumerate() {
        let probe = scene.add_probe(probe_by_name(name).unwrap()).unwrap();
        let contact = ContactId(number as u64);
        for step in 0..60 {
            let t = f64::from(step) / 60.0;
            let sample = ContactSample::new([0.1 + 0.02 * t, 0.5], 900.0).sliding([0.08, 0.0]);
            let event = match step {
                0 => ContactEvent::begin_with(contact, Touching::on(surface).probe(probe), sample),
                _ => ContactEvent::moved(contact, sample),
            };
            scene.report(number as f64 + t, event).unwrap();
        }
    }
    assert_eq!(habits(&scene), []);
}

#[test]
fn taps_of_one_number_and_a_finger_that_rests_are_right() {
    let Engine { mut scene, .. } = Config::default().build().unwrap();
    let surface = scene.add_surface(Surface::flat(0.1, 0.1).unwrap()).unwrap();
    let mut rng = Rng::new(7);
    for tap in 0..40 {
        let t = 0.1 * f64::from(tap);
        let sample = ContactSample::new([rng.uniform(), rng.uniform()], 0.5);
        let sample = sample.sliding([1e-3 * rng.normal(), 1e-3 * rng.normal()]);
        scene.report(t, ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample)).unwrap();
        scene.report(t + 0.02, ContactEvent::moved(ContactId(1), sample)).unwrap();
        scene.report(t + 0.05, ContactEvent::end(ContactId(1))).unwrap();
    }
    assert_eq!(contradictions(&scene), []);
}

#[test]
fn both_speeds_and_the_unit_stand_in_the_sentence() {
    let mut stroke = stroke("arc", &mut Rng::new(3));
    scaled_velocity(&mut stroke, 1000.0);
    let [found] = message(&stroke, true)[..] else { panic!("nothing was told") };
    let text = found.to_string();
    assert!(text.starts_with("uv moves at 0.") && text.contains("velocity_m_s says "), "{text}");
    assert!(text.contains("is velocity_m_s in mm/s?"), "{text}");
}

/// Columns of a table of numbers; lines that hold none are left out.
fn table(text: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split([',', ' ']).map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    text.lines().filter_map(row).collect()
}

/// A stroke of measured places and velocities, m and m/s, begun anew where time does.
fn measured(rows: impl Iterator<Item = (f64, f64, [f64; 2], [f64; 2])>) -> Stroke {
    let size_m = [0.31, 0.24];
    let mut reports: Vec<Report> = Vec::new();
    let (mut run, mut shift_s) = (f64::NAN, 0.0);
    for (number, t, place_m, velocity_m_s) in rows {
        let begins = number != run;
        if begins {
            run = number;
            shift_s = reports.last().map_or(0.0, |last| last.t + 1.0) - t;
        }
        let uv = [0, 1].map(|c| place_m[c] / size_m[c]);
        reports.push(Report { t: t + shift_s, contact: 1, uv, velocity_m_s, force_n: 0.5, begins });
    }
    Stroke { size_m, reports }
}

#[test]
fn measured_trajectories_are_right_and_in_millimetres_they_are_not() {
    let Some(corpus) = asperity_evidence::corpus::corpus("haptics") else { return };
    let text = |name: &str| std::fs::read_to_string(corpus.join(name)).unwrap();
    // Cubes that are tossed and slide, positions and velocities as a tracker measured them.
    let tosses = table(&text("cube_tosses_148hz.csv"));
    let tosses = measured(tosses.iter().map(|r| (r[0], r[1], [r[2], r[3]], [r[9], r[10]])));
    // A pen that paints: velocities are differences of its places.
    let pen = table(&text("stylus_painting30sec_first_half.dat"));
    let pen = measured(pen.windows(2).map(|r| {
        let velocity = [1, 2].map(|c| 1e-3 * (r[1][c] - r[0][c]) / (r[1][0] - r[0][0]));
        (0.0, r[1][0], [1e-3 * r[1][1], 1e-3 * r[1][2]], velocity)
    }));
    for stroke in [tosses, pen] {
        assert!(stroke.reports.len() > 500, "{}", stroke.reports.len());
        assert_eq!(message(&stroke, false), []);
        let mut spoilt = stroke.clone();
        scaled_uv(&mut spoilt, 1000.0);
        let found = message(&spoilt, false);
        assert!(found.len() == 1 && is(&found[0], Likely::UvInMillimetres), "{found:?}");
    }
}

/// A box that slides at 0.3 m/s for 4 s, whose point hops among its corners every so many ticks.
fn hopping(side_m: f64, every: usize, tells_velocity: bool, seed: u64) -> Vec<Contradiction> {
    let Engine { mut scene, .. } = Config { queue_capacity: 1 << 15, ..Config::default() }.build().unwrap();
    let surface = scene.add_surface(Surface::flat(4.0, 4.0).unwrap()).unwrap();
    let (mut rng, mut corner) = (Rng::new(seed), [0.0; 2]);
    for tick in 0..240 {
        let t = tick as f64 / 60.0;
        if tick % every == 0 {
            corner = [0, 1].map(|_| if rng.uniform() < 0.5 { 0.0 } else { side_m });
        }
        let sample = ContactSample::new([(1.0 + 0.3 * t + corner[0]) / 4.0, (1.0 + corner[1]) / 4.0], 2.0);
        let sample = if tells_velocity { sample.sliding([0.3, 0.0]) } else { sample };
        let event = if tick == 0 {
            ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample)
        } else {
            ContactEvent::moved(ContactId(1), sample)
        };
        scene.report(t, event).unwrap();
    }
    contradictions(&scene)
}

#[test]
fn a_point_hopping_among_corners_without_velocity_is_reported() {
    let mut missed = Vec::new();
    for side_m in [0.05, 0.1, 0.3, 1.0] {
        for every in [1, 2, 3, 5, 10] {
            for seed in 0..8 {
                let found = hopping(side_m, every, false, seed);
                let right = |found: &Contradiction| {
                    matches!(found, Contradiction::Hops { .. } | Contradiction::TwoPlaces { .. })
                };
                if !(found.len() == 1 && right(&found[0])) {
                    missed.push(format!("{side_m} m, every {every}, seed {seed}: {found:?}"));
                }
                let steady = hopping(side_m, every, true, seed);
                assert!(
                    !steady.iter().any(|found| matches!(found, Contradiction::Hops { .. })),
                    "{steady:?}"
                );
            }
        }
    }
    println!("{} of 160 missed\n{}", missed.len(), missed.join("\n"));
    assert!(missed.len() <= 8, "{} missed\n{}", missed.len(), missed.join("\n"));
}

#[test]
fn a_finger_that_tells_no_velocity_does_not_hop() {
    let mut rng = Rng::new(77);
    for number in 0..300 {
        let kind = MOTIONS[number % MOTIONS.len()];
        let stroke = stroke(kind, &mut rng);
        let Engine { mut scene, .. } =
            Config { queue_capacity: 1 << 15, ..Config::default() }.build().unwrap();
        let [width_m, height_m] = stroke.size_m;
        let surface = scene.add_surface(Surface::flat(width_m, height_m).unwrap()).unwrap();
        let mut left = 0;
        for (i, report) in stroke.reports.iter().enumerate() {
            // Hitches, and places that jitter by a tenth of a millimetre.
            if left == 0 && rng.uniform() < 0.02 {
                left = (8.0 * rng.uniform()) as u32;
            }
            left = left.saturating_sub(1);
            if i > 0 && left > 0 {
                continue;
            }
            let uv = [0, 1].map(|c| report.uv[c] + 1e-4 * rng.normal() / stroke.size_m[c]);
            let sample = ContactSample::new(uv, 0.5);
            let event = if i == 0 {
                ContactEvent::begin_with(ContactId(1), Touching::on(surface), sample)
            } else {
                ContactEvent::moved(ContactId(1), sample)
            };
            scene.report(report.t, event).unwrap();
        }
        assert_eq!(contradictions(&scene), [], "{number}, {kind}");
    }
}
