//! A depth in, a force out: sand, soft maps, and loops that nobody prepared.

use super::stroke::{Felt, SIDE_M, Stroke, sand};
use asperity::dsp::rng::Rng;
use asperity::live::ports::{Force, ForceRow};
use asperity::surface::raster::Raster;
use asperity::surface::sand::SandLaw;
use asperity::{
    ChannelId, Config, ContactEvent, ContactId, ContactSample, Engine, Extent, Refusal, Surface,
    SurfaceFrame, TipLaw, Wrap,
};

#[test]
fn sand_drags_with_its_law_from_touch_on_and_with_nothing_before() {
    // The scene of a landing at 5 cm/s with 3 N while the hand is already moving.
    let stroke = Stroke { sample_rate_hz: 44_100.0, rows_hz: 1000.0, reports_hz: 60.0, seconds: 0.4 };
    let felt = stroke.run(sand(SandLaw::default()), |t| {
        let sample = ContactSample::new([(0.05 + 0.08 * t) / SIDE_M, 0.5], 3.005).sliding([0.08, 0.0]);
        sample.landing(if t == 0.0 { 0.05 } else { 0.0 })
    });
    for row in &felt.received {
        let [x, y, z] = row.force_n;
        // Eq. 3 in every row, the landing's as well; a row spans 4 ticks either way.
        assert!((x + 20.0 * 0.08 * z).abs() <= 0.01 * x.abs() + 0.02 && y.abs() < 1e-9, "{row:?}");
        assert!((x * x + y * y + z * z).sqrt() <= 20.0 + 1e-9);
    }
    let [x, _, z] = felt.received[0].force_n;
    println!("first row: {x:.4} N along, {z:.4} N out; last: {:?}", felt.received.last().unwrap().force_n);
}

#[test]
fn depth_in_gives_the_documents_force_out() {
    let wet = SandLaw { wetness: 0.7, ..SandLaw::default() };
    let curved = SandLaw { stiffness_n: 8.0, exponent_per_m: 150.0, ..SandLaw::default() };
    for law in [SandLaw::default(), wet, curved] {
        for (depth_m, velocity) in [(0.003, [0.0, 0.0]), (0.002, [0.08, 0.0]), (0.004, [-0.06, 0.05])] {
            let stroke =
                Stroke { sample_rate_hz: 44_100.0, rows_hz: 1000.0, reports_hz: 1000.0, seconds: 0.6 };
            let felt = stroke.run(sand(law), |t| {
                let uv = [0, 1].map(|a| (0.1 + velocity[a] * (t - 0.3)) / SIDE_M);
                ContactSample::at_depth(uv, depth_m).sliding(velocity)
            });
            let wanted = law.answer_n(depth_m, velocity);
            assert!(felt.received.len() > 590);
            let mut worst = [0.0f64; 3];
            for row in felt.received.iter().filter(|row| row.tick > 60) {
                for a in 0..3 {
                    worst[a] = worst[a].max((row.force_n[a] - wanted[a]).abs());
                }
            }
            println!("{depth_m} m, {velocity:?}: {wanted:.3?} N, off by {worst:.4?}");
            assert!((0..3).all(|a| worst[a] <= 0.01 * wanted[a].abs() + 1e-9), "{wanted:?} {worst:?}");
        }
    }
}

#[test]
fn a_tip_above_the_sand_feels_nothing_until_it_dips() {
    let stroke = Stroke { sample_rate_hz: 44_100.0, rows_hz: 1000.0, reports_hz: 1000.0, seconds: 0.6 };
    // Down at 2 cm/s from 2 mm above to 4 mm below, and up again.
    let depth_m = |t: f64| if t < 0.3 { -0.002 + 0.02 * t } else { 0.004 - 0.02 * (t - 0.3) };
    let felt = stroke.run(sand(SandLaw::default()), |t| ContactSample::at_depth([0.5, 0.5], depth_m(t)));
    let law = SandLaw::default();
    for row in &felt.received {
        let t = row.tick as f64 / 1000.0;
        // A report holds for a millisecond.
        let (low, high) = (law.force_n(depth_m(t) - 1e-4), law.force_n(depth_m(t) + 1e-4));
        let z = row.force_n[2];
        assert!(z >= low - 0.03 && z <= high + 0.03, "{t} s: {z} N, between {low} and {high}");
        assert!(row.force_n[0].hypot(row.force_n[1]) <= 0.01 * z.abs() + 1e-12, "{row:?}");
    }
    let most = felt.received.iter().fold(0.0f64, |most, row| most.max(row.force_n[2]));
    assert!((most / law.force_n(0.004) - 1.0).abs() < 0.03, "{most} N");
}

/// Depths as games report them: a tip that comes down steeply at a random instant, wanders, leaves,
/// and comes again.
fn depths_of_a_game(rng: &mut Rng, seconds: f64) -> impl Fn(f64) -> f64 + use<> {
    let strokes: Vec<[f64; 4]> = (0..(4.0 * seconds) as usize)
        .map(|_| {
            let depth_m = 0.002 + 0.038 * rng.uniform();
            [0.05 + 0.07 * rng.uniform(), depth_m, 0.003 * rng.uniform(), 20.0 * rng.uniform()]
        })
        .collect();
    move |t: f64| {
        let [down_s, depth_m, wanders_m, hz] = strokes[((4.0 * t) as usize).min(strokes.len() - 1)];
        let within_s = t - 0.25 * (4.0 * t).floor();
        if within_s < down_s || within_s > 0.22 { -0.08 } else { depth_m + wanders_m * (hz * t).sin() }
    }
}

#[test]
fn steep_landings_keep_to_the_cap_and_0_n_in_air() {
    let mut rng = Rng::new(2931);
    let (mut most_n, mut landings, mut in_the_air) = (0.0_f64, 0, 0);
    for game in 0..24 {
        let reports_hz = 30.0 + 60.0 * rng.uniform();
        let rows_hz = [1000.0, 2000.0, 5000.0][game % 3];
        let cap_n = [20.0, 12.0][game % 2];
        let per_s = [0, 1].map(|_| 8.0 * rng.normal());
        let depth_m = depths_of_a_game(&mut rng, 2.0);
        let stroke = Stroke { sample_rate_hz: 44_100.0, rows_hz, reports_hz, seconds: 2.0 };
        let felt = stroke.run(sand(SandLaw { cap_n, ..SandLaw::default() }), |t| {
            let uv = per_s.map(|turn| 0.5 + 0.2 * (turn * t).sin());
            let velocity = per_s.map(|turn| 0.2 * SIDE_M * turn * (turn * t).cos());
            ContactSample::at_depth(uv, depth_m(t)).sliding(velocity)
        });
        let report_s = |t: f64| (t * reports_hz).floor() / reports_hz;
        let mut above_s = f64::NEG_INFINITY;
        for row in &felt.received {
            let size_n = row.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
            assert!(size_n <= cap_n * (1.0 + 1e-12), "game {game}, tick {}: {size_n} of {cap_n} N", row.tick);
            most_n = most_n.max(size_n / cap_n);
            let t = row.tick as f64 / rows_hz;
            // A report counts from the sample on in which it falls, and heaps stand higher than the
            // untouched sand.
            if depth_m(report_s(t)).max(depth_m(report_s(t + 1.0 / 44_100.0))) > -0.04 {
                landings += usize::from(above_s > f64::NEG_INFINITY);
                above_s = f64::NEG_INFINITY;
                continue;
            }
            above_s = if above_s.is_finite() { above_s } else { t };
            // A row still hears what ended 4 ticks ago; before a landing it hears nothing.
            if t > above_s + 5.0 / rows_hz {
                in_the_air += 1;
                assert_eq!(row.force_n, [0.0; 3], "game {game}, {t} s, since {above_s}");
            }
        }
    }
    println!("{landings} landings, {in_the_air} rows in the air; at most {most_n:.4} of the cap");
    assert!(landings > 100 && in_the_air > 10_000 && most_n > 0.999);
}

/// A sensor that now and then tells what it should not: no number, infinity, a jump, the last value
/// again.
fn seen_m(depth_m: f64, last_m: f64, rng: &mut Rng) -> f64 {
    match (200.0 * rng.uniform()) as u32 {
        0 => f64::NAN,
        1 => [f64::INFINITY, f64::NEG_INFINITY][usize::from(rng.uniform() < 0.5)],
        2 => depth_m + 0.2 * (rng.uniform() - 0.5),
        3 => 1e300,
        4..=8 => last_m,
        _ => depth_m,
    }
}

#[test]
fn twenty_unprepared_loops_get_finite_forces_within_the_cap() {
    let mut rng = Rng::new(1224);
    for case in 0..20 {
        let between = |low: f64, high: f64, rng: &mut Rng| low * (high / low).powf(rng.uniform());
        let (mass_kg, rate_hz) = (between(0.02, 1.0, &mut rng), between(1000.0, 5000.0, &mut rng).round());
        let damping_n_s_m = between(1.0, 10.0, &mut rng);
        let limit_n_m = 2.0 * damping_n_s_m * rate_hz;
        // As stiff as the limit allows, and far softer.
        let stiffness_n_m = limit_n_m * between(0.02, 0.9, &mut rng);
        let cap_n = between(5.0, 50.0, &mut rng);
        let is_sand = case % 2 == 0;
        let surface = if is_sand {
            let law = SandLaw {
                stiffness_n: stiffness_n_m,
                drag_s_per_m: between(1.0, 1e3, &mut rng),
                wetness: 0.0,
                cap_n,
                ..SandLaw::default()
            };
            sand(law)
        } else {
            let flat = Surface::flat(SIDE_M, SIDE_M).unwrap().friction(2.0 * rng.uniform());
            flat.compliance_m_n((1.0 / stiffness_n_m).min(0.1))
        };
        let sample_rate_hz = [22_050.0, 44_100.0, 48_000.0, 96_000.0][case % 4];
        let Engine { mut scene, mut renderer, .. } =
            Config { sample_rate_hz, ..Config::default() }.build().unwrap();
        let id = scene.add_surface(surface).unwrap();
        let law = scene.tip_law(id).unwrap().unwrap();
        let mut port = scene.open_port(Force { rate_hz, holds_s: 2.0 }).unwrap();
        let (mut x, mut v, mut last_m, mut refused, mut begun) = (-0.01 * rng.uniform(), 0.0, 0.0, 0, false);
        let (mut haptic, mut audio) = ([0.0f32; 64], [0.0f32; 64]);
        let ticks = rate_hz as u32;
        for tick in 0..ticks {
            let t = f64::from(tick) / rate_hz;
            let told_m = seen_m(x, last_m, &mut rng);
            let speed = [0.4 * (9.0 * t).sin(), 0.3 * rng.normal()];
            // A cap keeps the direction: what drags as hard as it can does not carry as well.
            let across = if is_sand { [0.0; 2] } else { speed };
            let force_n = law.answer_at_n([0.1, 0.1], told_m, across);
            assert!(force_n.iter().all(|f| f.is_finite()), "case {case}: {told_m} m: {force_n:?}");
            // The device limits what it is given, as any does.
            let given_n = force_n[2].min(cap_n);
            v += (2.0 - given_n - damping_n_s_m * v) / mass_kg / rate_hz;
            x += v / rate_hz;
            last_m = told_m;
            let sample = ContactSample::at_depth([0.5 + 0.1 * (9.0 * t).cos(), 0.5], told_m).sliding(speed);
            let event = if begun {
                ContactEvent::moved(ContactId(1), sample)
            } else {
                ContactEvent::begin(ContactId(1), id, ChannelId(0), sample)
            };
            let taken = scene.report(t, event).is_ok();
            assert_eq!(
                taken,
                told_m.is_finite() && told_m < 1.0 && told_m > -1000.0,
                "case {case}: {told_m}"
            );
            (begun, refused) = (begun || taken, refused + u32::from(!taken));
            while (renderer.position() as f64) < t * sample_rate_hz {
                renderer.render(&mut [&mut haptic], &mut [&mut audio]);
                assert!(haptic.iter().chain(&audio).all(|y| y.is_finite()));
            }
        }
        let rows: Vec<ForceRow> = std::iter::from_fn(|| port.read()).collect();
        let size_n = |row: &ForceRow| row.force_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        let most_n = rows.iter().map(size_n).fold(0.0, f64::max);
        println!(
            "case {case}: {mass_kg:.2} kg, {rate_hz} Hz, {stiffness_n_m:.0} N/m: {refused} refused, rows to {most_n:.1} N, ends at {:.2} mm, {v:.3} m/s",
            1e3 * x
        );
        assert!(refused > 0 && rows.len() as f64 > 0.9 * rate_hz && most_n.is_finite());
        assert!(!is_sand || most_n <= cap_n * (1.0 + 1e-12), "case {case}: {most_n} of {cap_n} N");
        // A hand of 2 N falls at 2 N / b at most and stands at 2 N / k; what glitches throw away
        // dies down.
        assert!(x.abs() < 0.01 + 8.0 / stiffness_n_m + cap_n / damping_n_s_m * 0.05, "case {case}: {x} m");
        assert!(v.abs() <= cap_n / damping_n_s_m, "case {case}: {v} m/s");
    }
}

#[test]
fn a_soft_map_is_a_spring_and_a_hard_one_refuses_depth() {
    let extent = Extent { width_m: SIDE_M, height_m: SIDE_M, relief_m: 1e-4 };
    let mut rng = Rng::new(5);
    let heights = Raster::from_fn(64, 64, |_, _| rng.uniform());
    let cloth = || {
        let map = asperity::surface::height_map::HeightMap::new(&heights, extent, Wrap::Repeat);
        Surface::from_map(map.unwrap()).unwrap().friction(0.0)
    };
    let stroke = Stroke { sample_rate_hz: 44_100.0, rows_hz: 1000.0, reports_hz: 1000.0, seconds: 0.3 };
    for (compliance_m_n, depth_m) in [(1e-3, 0.002), (2.5e-3, 0.001)] {
        let felt = stroke.run(cloth().compliance_m_n(compliance_m_n), |t| {
            ContactSample::at_depth([0.2 + 0.1 * t, 0.3], depth_m)
        });
        let wanted = depth_m / compliance_m_n;
        let off = felt.received.iter().skip(40).map(|row| (row.force_n[2] / wanted - 1.0).abs());
        let off = off.fold(0.0f64, f64::max);
        println!("{compliance_m_n} m/N, {depth_m} m: {wanted} N, {:.3} % off", 1e2 * off);
        assert!(off < 0.01);
        // And lies lower by as much as it is pressed in.
        let mean = |felt: &Felt| {
            felt.path[8000..].iter().map(|p| p.2).sum::<f64>() / (felt.path.len() - 8000) as f64
        };
        let hard = stroke.run(cloth(), |t| ContactSample::new([0.2 + 0.1 * t, 0.3], wanted));
        let sunk = (mean(&hard) - mean(&felt)) / depth_m;
        assert!((sunk - 1.0).abs() < 0.01, "sunk by {sunk} of the depth");
    }
    let Engine { mut scene, .. } = Config::default().build().unwrap();
    let hard = scene.add_surface(cloth()).unwrap();
    let event = |sample| ContactEvent::begin(ContactId(1), hard, ChannelId(0), sample);
    let refused = scene.report(0.0, event(ContactSample::at_depth([0.5; 2], 0.001))).unwrap_err();
    assert_eq!(refused.reason, Refusal::Hard);
    assert!(refused.to_string().starts_with("depth_m: the surface is hard"), "{refused}");
    scene.report(0.0, event(ContactSample::new([0.5; 2], 0.5))).unwrap();
    let deeper = ContactEvent::moved(ContactId(1), ContactSample::at_depth([0.5; 2], 0.001));
    assert_eq!(scene.report(0.01, deeper).unwrap_err().reason, Refusal::Hard);
    assert_eq!(scene.tip_law(hard).unwrap(), None);
    let soft = scene.add_surface(cloth().compliance_m_n(1e-3)).unwrap();
    let law = TipLaw::Spring { compliance_m_n: 1e-3, friction: 0.0 };
    assert_eq!(scene.tip_law(soft).unwrap(), Some(law));
}

#[test]
fn a_place_below_the_frame_is_a_depth() {
    let frame = SurfaceFrame::new([0.1, 0.2, 0.3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]).unwrap();
    let surface = || Surface::flat(SIDE_M, SIDE_M).unwrap().compliance_m_n(1e-3).friction(0.0).frame(frame);
    let stroke = Stroke { sample_rate_hz: 44_100.0, rows_hz: 1000.0, reports_hz: 1000.0, seconds: 0.2 };
    // The normal is u × v, the body's x: 2 mm below is 2 mm before the plane.
    let felt = stroke.run(surface(), |t| ContactSample::tip_at([0.098, 0.25 + 0.05 * t, 0.35]));
    let last = felt.received[felt.received.len() - 10].force_n;
    assert!((last[2] - 2.0).abs() < 0.02, "{last:?}");
    let at = felt.path.last().unwrap().0;
    assert!((at[1] - 0.05).abs() < 1e-9 && at[0] > 0.055, "{at:?}");
}
