//! Paths while a game is silent, and after it.

use super::*;
use std::format;

/// A finger at `speed` m/s whose reports come at these times, s.
fn reported_at(times_s: &[f64], speed: f64, reported: bool) -> Vec<PathEvent> {
    let velocity = reported.then_some(speed);
    times_s.iter().map(|t| event((t * RATE_HZ).round() as u64, speed * t, velocity)).collect()
}

/// Fastest and slowest speed of a path over the finger's, as its positions show it, and how far
/// from its own lag it ends, m. Every event has to be followed: a jump is a step.
fn speeds(mode: PathMode, events: &[PathEvent], speed: f64) -> (f64, f64, f64) {
    let design = design(mode);
    let mut path = Trajectory::begin(&design, &events[0]);
    let (mut fastest, mut slowest) = (0.0f64, f64::INFINITY);
    let mut before_m = None;
    let end = events.last().unwrap().sample;
    for pair in events.windows(2) {
        let mut points = vec![PathPoint::default(); (pair[1].sample - pair[0].sample) as usize];
        path.advance(&design, &mut points);
        for point in points {
            let ratio = before_m.map_or(1.0, |before_m| (point.position_m[0] - before_m) * RATE_HZ / speed);
            (fastest, slowest) = (fastest.max(ratio), slowest.min(ratio));
            before_m = Some(point.position_m[0]);
        }
        assert_eq!(
            path.moved(&design, &pair[1]),
            Moved::Followed,
            "{mode:?}: at {} s",
            pair[1].sample as f64 / RATE_HZ
        );
    }
    let lag_m = speed * end as f64 / RATE_HZ - before_m.unwrap();
    (fastest, slowest, lag_m - speed * design.lag_s())
}

/// Reports `report_hz` times a second for 2.5 s; none during a hitch from 0.8 s on.
fn with_hitch(report_hz: f64, hitch_s: f64) -> Vec<f64> {
    let times = (0..(2.5 * report_hz) as u32).map(|n| f64::from(n) / report_hz);
    times.filter(|t| !(0.8..0.8 + hitch_s).contains(t)).collect()
}

#[test]
fn after_a_hitch_the_path_neither_hurries_nor_steps() {
    for mode in [PathMode::Extrapolate, PathMode::Hermite] {
        for report_hz in [30.0, 60.0, 90.0] {
            for hitch_s in [0.02, 0.04, 0.06, 0.1, 0.15, 0.2] {
                for (speed, reported) in [(0.02, true), (0.1, true), (0.1, false), (0.5, true), (0.5, false)]
                {
                    let events = reported_at(&with_hitch(report_hz, hitch_s), speed, reported);
                    let (fastest, slowest, off_m) = speeds(mode, &events, speed);
                    let what = format!("{mode:?}, {report_hz} Hz, {hitch_s} s, {speed} m/s, {reported}");
                    assert!(fastest < 1.45 && slowest > -0.01, "{what}: {slowest} to {fastest}");
                    assert!(off_m.abs() < 1e-3 * speed, "{what}: {off_m} m off a second later");
                }
            }
        }
    }
}

/// A finger whose reports fail to come may stop, or turn.
#[test]
fn a_finger_that_turned_during_a_hitch_is_found_without_hurry() {
    for mode in [PathMode::Extrapolate, PathMode::Hermite] {
        for (turned, hitch_s) in [(0.0, 0.1), (0.0, 0.2), (-1.0, 0.1), (-1.0, 0.2)] {
            let speed = 0.1;
            let place = |t: f64| speed * if t < 0.85 { t } else { 0.85 + turned * (t - 0.85) };
            let events: Vec<PathEvent> = with_hitch(60.0, hitch_s)
                .iter()
                .map(|t| {
                    event(
                        (t * RATE_HZ).round() as u64,
                        place(*t),
                        Some(if *t < 0.85 { speed } else { turned * speed }),
                    )
                })
                .collect();
            let mut path = Trajectory::begin(&design(mode), &events[0]);
            let mut before_m = None;
            for pair in events.windows(2) {
                let mut points = vec![PathPoint::default(); (pair[1].sample - pair[0].sample) as usize];
                path.advance(&design(mode), &mut points);
                for point in points {
                    let now_m = point.position_m[0];
                    let ratio = before_m.map_or(1.0, |before_m: f64| (now_m - before_m) * RATE_HZ / speed);
                    assert!(ratio.abs() < 1.5, "{mode:?}, {turned}, {hitch_s} s: {ratio} at {pair:?}");
                    before_m = Some(now_m);
                }
                assert_eq!(path.moved(&design(mode), &pair[1]), Moved::Followed);
            }
        }
    }
}

#[test]
fn a_game_at_5_to_30_hz_does_not_hurry_at_first() {
    for mode in [PathMode::Extrapolate, PathMode::Hermite] {
        for report_hz in [5.0, 10.0, 20.0, 30.0] {
            for reported in [true, false] {
                let times: Vec<f64> = (0..20).map(|n| f64::from(n) / report_hz).collect();
                let (fastest, slowest, _) = speeds(mode, &reported_at(&times, 0.1, reported), 0.1);
                let what = format!("{mode:?}, {report_hz} Hz, {reported}");
                assert!(fastest < 1.45 && slowest > -0.01, "{what}: {slowest} to {fastest}");
            }
        }
    }
}

#[test]
fn reports_that_get_lost_make_nobody_hurry() {
    for mode in [PathMode::Extrapolate, PathMode::Hermite] {
        for seed in 1..=8 {
            let mut rng = Rng::new(seed);
            let times: Vec<f64> =
                (0..600).filter(|_| rng.uniform() > 0.1).map(|n| f64::from(n) / 60.0).collect();
            let (fastest, slowest, _) = speeds(mode, &reported_at(&times, 0.1, true), 0.1);
            assert!(fastest < 1.45 && slowest > 0.3, "{mode:?}, seed {seed}: {slowest} to {fastest}");
        }
    }
}

#[test]
fn a_finger_that_stops_dead_is_not_thrown_back() {
    let extrapolated = [(30.0, 1.45), (60.0, 1.45), (90.0, 1.2)].map(|rate| (PathMode::Extrapolate, rate));
    let interpolated = [(30.0, 0.5), (60.0, 0.2), (90.0, 0.1)].map(|rate| (PathMode::Hermite, rate));
    for (mode, (report_hz, bound)) in extrapolated.into_iter().chain(interpolated) {
        let design = design(mode);
        let step = (RATE_HZ / report_hz).round() as u64;
        let place = |n: u64| 0.5 * (n.min(20) * step) as f64 / RATE_HZ;
        let mut path = Trajectory::begin(&design, &event(0, 0.0, Some(0.5)));
        let mut points = vec![PathPoint::default(); step as usize];
        let (mut slowest, mut furthest) = (0.0f64, 0.0f64);
        for n in 1..60 {
            path.advance(&design, &mut points);
            slowest = points.iter().fold(slowest, |least, p| least.min(p.velocity_m_s[0] / 0.5));
            furthest = points.iter().fold(furthest, |most, p| most.max(p.position_m[0] - place(20)));
            assert_eq!(
                path.moved(&design, &event(n * step, place(n), Some(if n <= 20 { 0.5 } else { 0.0 }))),
                Moved::Followed
            );
        }
        assert!(slowest > -bound, "{mode:?}, {report_hz} Hz: back at {slowest} times its speed");
        assert!(furthest < 0.5 / report_hz, "{mode:?}, {report_hz} Hz: {furthest} m too far");
        assert!((points.last().unwrap().position_m[0] - place(20)).abs() < 1e-6);
    }
}

#[test]
fn where_a_silent_game_is_too_far_gone_the_path_starts_afresh() {
    for mode in [PathMode::Extrapolate, PathMode::Hermite] {
        let design = design(mode);
        let mut path = Trajectory::begin(&design, &event(0, 0.0, Some(0.1)));
        let mut out = vec![PathPoint::default(); 44_100];
        path.advance(&design, &mut out);
        assert_eq!(path.moved(&design, &event(44_100, 0.1, Some(0.1))), Moved::Teleported);
    }
}

#[test]
fn a_velocity_of_zero_from_a_moving_finger_is_overruled() {
    for mode in [PathMode::Extrapolate, PathMode::Hermite] {
        for speed in [0.02, 0.05, 0.1, 0.5] {
            let events: Vec<PathEvent> =
                (0..120u64).map(|n| event(n * 735, speed * n as f64 / 60.0, Some(0.0))).collect();
            let points = render(&design(mode), &events, 120 * 735);
            let fastest = points.iter().fold(0.0f64, |most, p| most.max(p.velocity_m_s[0] / speed));
            assert!(fastest < 1.5, "{mode:?}, {speed} m/s: {fastest}");
            let late = &points[44_100..];
            let worst = late.iter().fold(0.0f64, |w, p| w.max((p.velocity_m_s[0] / speed - 1.0).abs()));
            assert!(worst < 1e-4, "{mode:?}, {speed} m/s: {worst}");
        }
    }
}
