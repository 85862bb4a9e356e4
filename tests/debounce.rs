//! A contact that flickers (an end and a begin of the same contact at the same place, a frame
//! apart) neither clicks nor sounds twice; a real landing does sound.

use crate::common;
use crate::steps;

use asperity::files::contact_log::{ContactLog, ContactSample, LogEvent, LogLine, Names};
use asperity::offline::{self, Options, Render};
use asperity::{ModalModel, Mode};
use common::{SIDE_M, grating, peak, rms, si_config, stroke};
use std::collections::HashMap;
use steps::largest_step;

/// Loud, because modes fall asleep at −120 dB of full scale, which must lie far below −60 dB of the
/// signal.
fn low_body() -> ModalModel {
    let mode = Mode { frequency_hz: 220.0, decay_per_s: 8.0, amplitude: 90.0, phase_rad: 0.0 };
    ModalModel::new(vec![mode], 0.01).unwrap()
}

fn take(log: &ContactLog) -> Render {
    let asperity::Engine { mut scene, renderer, .. } = si_config().build().unwrap();
    let body = scene.add_body(low_body()).unwrap();
    let surface = scene.add_surface(grating(2e-3, 2e-5).body(body)).unwrap();
    let names = Names {
        surfaces: HashMap::from([("s".to_owned(), surface)]),
        bodies: HashMap::from([("b".to_owned(), body)]),
        ..Default::default()
    };
    offline::render(scene, renderer, log, &names, &Options::default()).unwrap()
}

/// The stroke, lifted off after half a second for `gap_s`, landing with `closing_m_s` at `uv_off`
/// away.
fn flickering(gap_s: f64, closing_m_s: f64, uv_off: f64) -> ContactLog {
    let mut lines = stroke(SIDE_M, 0.1, 0.6, 1.0).lines;
    let at = lines.iter().position(|line| line.t > 0.5).unwrap();
    let off_s = lines[at].t;
    let LogEvent::Move { sample, .. } = lines[at].event.clone() else { panic!("a stroke moves") };
    let u = sample.uv[0] + uv_off + 0.1 * gap_s / SIDE_M;
    let landed = ContactSample { uv: [u, sample.uv[1]], closing_m_s, ..sample };
    let lift_off = LogLine { t: off_s, event: LogEvent::End { contact: 1 } };
    let landing = LogLine { t: off_s + gap_s, event: LogEvent::begin(1, "s", 0, landed) };
    lines.splice(at..=at, [lift_off, landing]);
    lines.sort_by(|a, b| a.t.total_cmp(&b.t));
    ContactLog { lines }
}

#[test]
fn a_contact_that_flickers_goes_on_as_if_nothing_had_been() {
    let whole = take(&stroke(SIDE_M, 0.1, 0.6, 1.0));
    for gap_s in [0.0, 0.002, 0.008, 1.0 / 60.0] {
        let flicker = take(&flickering(gap_s, 0.05, 0.0));
        assert_eq!(flicker.stats.debounced, 1, "{gap_s} s");
        for (name, x, reference) in
            [("felt", &flicker.haptic[0], &whole.haptic[0]), ("heard", &flicker.audio[0], &whole.audio[0])]
        {
            let range = 15_000..35_000;
            let step = largest_step(&x[range.clone()]) / peak(reference);
            eprintln!("gap {gap_s} s, {name}: largest step {:.1} dB", 20.0 * step.log10());
            assert!(step < 1e-3, "{name} after {gap_s} s: a step of {:.1} dB", 20.0 * step.log10());
            // No second landing: never louder than the stroke itself.
            assert!(peak(&x[range.clone()]) <= 1.05 * peak(&reference[range]), "{name} after {gap_s} s");
        }
        let energy = rms(&flicker.audio[0]) / rms(&whole.audio[0]);
        assert!((0.8..=1.02).contains(&energy), "{energy}");
    }
}

#[test]
fn a_landing_elsewhere_or_later_is_a_landing() {
    for (gap_s, uv_off) in [(0.1, 0.0), (0.008, 0.4)] {
        let landed = take(&flickering(gap_s, 0.05, uv_off));
        assert_eq!(landed.stats.debounced, 0);
        let whole = take(&stroke(SIDE_M, 0.1, 0.6, 1.0));
        assert!(peak(&landed.audio[0]) > 2.0 * peak(&whole.audio[0]), "a landing at 5 cm/s is heard");
    }
}
