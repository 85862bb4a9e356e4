//! Hands that speed up, slow down and stop dead, reported 60 times a second.

use super::*;

/// Samples between two reports.
const EVERY: u64 = 735;

/// A reach of `far_m` within `time_s`, minimum jerk: place and velocity.
fn reach(far_m: f64, time_s: f64, t: f64) -> [f64; 2] {
    let x = (t / time_s).clamp(0.0, 1.0);
    let rate = 30.0 * x * x * (1.0 - x) * (1.0 - x) / time_s;
    [far_m * x * x * x * (10.0 + x * (6.0 * x - 15.0)), far_m * rate]
}

/// Places a path makes of a motion, and its speeds, a sample each.
fn followed(mode: PathMode, motion: impl Fn(f64) -> [f64; 2], seconds: f64) -> Vec<PathPoint> {
    let events: Vec<PathEvent> = (0..(60.0 * seconds) as u64)
        .map(|n| {
            let [x, v] = motion((n * EVERY) as f64 / RATE_HZ);
            event(n * EVERY, x, Some(v))
        })
        .collect();
    render(&design(mode), &events, (seconds * RATE_HZ) as u64)
}

// A hand's 90 mm in 0.55 s: dead reckoning without the bend errs by 61 µm rms.
#[test]
fn a_reaching_hand_is_followed_to_micrometres_between_reports() {
    for (mode, most_m) in [(PathMode::Extrapolate, 2e-6), (PathMode::BandLimited, 4e-6)] {
        let design = design(mode);
        let points = followed(mode, |t| reach(0.09, 0.55, t), 0.55);
        // Three velocities make a bend, and trust takes another.
        let counted = (0.1 * RATE_HZ) as usize..(0.53 * RATE_HZ) as usize;
        let square: f64 = counted
            .clone()
            .map(|n| {
                let [truth_m, _] = reach(0.09, 0.55, n as f64 / RATE_HZ - design.lag_s());
                (points[n].position_m[0] - truth_m).powi(2)
            })
            .sum();
        let rms_m = (square / counted.len() as f64).sqrt();
        std::println!("{mode:?}: {:.2} µm", 1e6 * rms_m);
        assert!(rms_m < most_m, "{mode:?}: {rms_m}");
    }
}

/// Distance and speed of a path beyond a finger that stops dead at some time between two
/// reports, m and m/s.
fn beyond_a_stop(mode: PathMode, motion: impl Fn(f64) -> [f64; 2], stop_s: f64) -> [f64; 2] {
    let [stop_m, stop_m_s] = motion(stop_s);
    let stopped = |t: f64| if t < stop_s { motion(t) } else { [stop_m, 0.0] };
    let points = followed(mode, stopped, stop_s + 1.2);
    let after = &points[(stop_s * RATE_HZ) as usize..];
    let further_m = after.iter().map(|point| point.position_m[0] - stop_m).fold(0.0, f64::max);
    let speed_m_s = after.iter().map(|point| point.velocity_m_s[0].abs()).fold(0.0, f64::max);
    let last = after[after.len() - 1];
    assert!((last.position_m[0] - stop_m).abs() < 1e-5, "{mode:?} comes back: {last:?}");
    [further_m / stop_m_s, speed_m_s / stop_m_s]
}

#[test]
fn a_stopped_finger_overshoots_by_one_report_at_most() {
    let mut rng = Rng::new(11);
    for mode in [PathMode::Extrapolate, PathMode::BandLimited] {
        let mut worst = [0.0f64; 2];
        for _ in 0..40 {
            let stop_s = 0.25 + 0.2 * rng.uniform();
            let (speed_m_s, far_m) = (0.02 + 0.3 * rng.uniform(), 0.04 + 0.08 * rng.uniform());
            for [time_s, speed] in [
                beyond_a_stop(mode, |t| [speed_m_s * t, speed_m_s], stop_s),
                // While it speeds up, and while it slows down.
                beyond_a_stop(mode, |t| reach(far_m, 0.6, t), stop_s),
            ] {
                worst = [worst[0].max(time_s), worst[1].max(speed)];
            }
        }
        std::println!("{mode:?}: {:.1} ms further, {:.2} times as fast", 1e3 * worst[0], worst[1]);
        // A report comes at most 16.7 ms late; the filter's way back is no faster than the finger
        // was.
        assert!(worst[0] < 0.018 && worst[1] < 1.2, "{mode:?}: {worst:?}");
    }
}

#[test]
fn velocities_that_do_not_belong_to_their_places_bend_nothing() {
    // A tick that moves by the velocity it ends with, another with a tenth of noise, and one with a
    // tracker's places.
    let mut rng = Rng::new(5);
    for (late_s, rough, noise_m) in [(1.0 / 60.0, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 5e-5)] {
        let motion = |t: f64| reach(0.09, 0.55, t);
        let events: Vec<PathEvent> = (0..33u64)
            .map(|n| {
                let t = (n * EVERY) as f64 / RATE_HZ;
                let v = motion(t - late_s)[1] * (1.0 + rough * rng.normal());
                event(n * EVERY, motion(t)[0] + noise_m * rng.normal(), Some(v))
            })
            .collect();
        let points = render(&design(PathMode::Extrapolate), &events, (0.55 * RATE_HZ) as u64);
        let fastest = points.iter().map(|point| point.velocity_m_s[0].abs()).fold(0.0, f64::max);
        let true_m_s = motion(0.275)[1];
        assert!(fastest < 1.3 * true_m_s, "{late_s}, {rough}, {noise_m}: {fastest} of {true_m_s}");
    }
}
