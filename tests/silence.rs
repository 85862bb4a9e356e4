//! Nothing sounds or moves at rest, and a contact begins and ends without a click.

use crate::common;

use asperity::files::contact_log::{ContactSample, LogEvent, LogLine};
use asperity::offline::Options;
use common::{SIDE_M, grating, peak, plate, render, si_config, stroke};

#[test]
fn a_resting_finger_gives_exactly_zero() {
    let log = stroke(SIDE_M, 0.0, 0.7, 3.0);
    let take = render(si_config(), plate(1.0), &log, &Options::default());
    assert_eq!(peak(&take.haptic[0]), 0.0);
    assert_eq!(peak(&take.audio[0]), 0.0);
}

#[test]
fn after_a_stroke_everything_becomes_exactly_zero() {
    let log = stroke(SIDE_M, 0.1, 0.7, 0.5);
    let take = render(si_config(), plate(1.0), &log, &Options { tail_s: 4.0, ..Options::default() });
    let tail = take.audio[0].len() - 1000;
    assert!(peak(&take.haptic[0]) > 0.0 && peak(&take.audio[0]) > 0.0);
    assert_eq!(peak(&take.haptic[0][tail..]), 0.0);
    assert_eq!(peak(&take.audio[0][tail..]), 0.0);
}

/// Energy in the second difference, which a click raises and a smooth fade does not.
fn roughest(x: &[f32]) -> f64 {
    x.windows(3).map(|w| f64::from(w[0] - 2.0 * w[1] + w[2]).abs()).fold(0.0, f64::max)
}

#[test]
fn begin_and_end_are_no_rougher_than_the_stroke_itself() {
    let log = stroke(SIDE_M, 0.1, 0.7, 0.6);
    let take = render(si_config(), grating(2e-3, 5e-5), &log, &Options::default());
    for (name, x) in [("haptic", &take.haptic[0]), ("audio", &take.audio[0])] {
        let at = |seconds: f64| (seconds * take.sample_rate_hz) as usize;
        let during = roughest(&x[at(0.2)..at(0.5)]);
        let allowed = during + 1e-3 * peak(x);
        let begin = roughest(&x[..at(0.05)]);
        assert!(
            begin <= allowed,
            "{name}: a click at the beginning: {begin} against {during} and a peak of {}",
            peak(x)
        );
        assert!(roughest(&x[at(0.59)..at(0.65)]) <= allowed, "{name}: a click at the end");
    }
}

/// As a pen lifts: 125 reports a second, the force falls from 1.3 N to almost nothing in 40 ms,
/// then the end.
#[test]
fn lifting_off_is_not_felt_as_a_thump() {
    let mut log = stroke(SIDE_M, 0.02, 1.3, 0.6);
    log.lines.pop();
    let LogEvent::Move { contact, sample, .. } = log.lines[20].event else { panic!("a move") };
    for (step, normal_force_n) in [1.1, 0.9, 0.5, 0.05].into_iter().enumerate() {
        let t = 0.6 + 0.008 * step as f64;
        let uv = [0.1 + 0.02 * t / SIDE_M, sample.uv[1]];
        let event = LogEvent::moved(contact, ContactSample { uv, normal_force_n, ..sample });
        log.lines.push(LogLine { t, event });
    }
    log.lines.push(LogLine { t: 0.632, event: LogEvent::End { contact } });
    let take = render(si_config(), grating(1e-3, 1e-5), &log, &Options::default());
    let at = |seconds: f64| (seconds * take.sample_rate_hz) as usize;
    let (during, lifting) =
        (peak(&take.haptic[0][at(0.2)..at(0.6)]), peak(&take.haptic[0][at(0.6)..at(0.8)]));
    assert!(lifting < 1.5 * during, "{lifting} m while lifting, {during} m before");
}
