//! Levels that nobody wrote, over the grid of speeds and forces on which tools are measured:
//! nothing passes full scale, the limiter, which keeps it so, is seldom heard, and what nobody
//! would feel or hear is listed and not lifted.

use crate::common;
use crate::slanting;

use asperity::files::Memory;
use asperity::files::contact_log::ContactLog;
use asperity::offline::Render;
use asperity_evidence::observer::constants::{LISTENING_PA, hearing_threshold_db, touch_threshold_m};
use common::peak;
use common::strokes::{power, third_octaves_db};
use slanting::{ceramic_scene, grounds, open, slanting_stroke};
use std::f64::consts::TAU;

/// The grid's ends; all nine cells of seven grounds and three probes are within 1.7 dB (189 of
/// 189).
const SPEEDS_M_S: [f64; 2] = [0.04, 0.24];
const FORCES_N: [f64; 2] = [0.3, 5.0];
/// What a limiter may take off in nineteen strokes of twenty, dB.
const SELDOM_MORE_DB: f64 = 6.0;

/// How far the strongest third octave of an acceleration, m/s² at sample value 1, lies above what
/// fingers feel, dB.
fn felt_db(render: &Render, full_scale_m_s2: f64) -> f64 {
    let thirds = third_octaves_db(&power(&render.haptic[0], render.sample_rate_hz), 25.0, 17);
    let over = |(band, db): (i32, f64)| {
        let frequency_hz = 25.0 * 2f64.powf(f64::from(band) / 3.0);
        let moved_m = full_scale_m_s2 / (TAU * frequency_hz).powi(2);
        db + 20.0 * (moved_m / touch_threshold_m(frequency_hz)).log10()
    };
    (0..).zip(thirds).map(over).fold(f64::NEG_INFINITY, f64::max)
}

/// How far the loudest third octave of a sound, 94 dB SPL at full scale, lies above what ears hear,
/// dB.
fn heard_db(render: &Render) -> f64 {
    let thirds = third_octaves_db(&power(&render.audio[0], render.sample_rate_hz), 50.0, 25);
    let full_scale_db_spl = 20.0 * (LISTENING_PA / 2e-5).log10();
    let over = |(band, db): (i32, f64)| {
        full_scale_db_spl + db - hearing_threshold_db(50.0 * 2f64.powf(f64::from(band) / 3.0))
    };
    (0..).zip(thirds).map(over).fold(f64::NEG_INFINITY, f64::max)
}

/// A stroke, and what full scale of its channel stands for.
fn rendered(probe: &str, ground: &str, files: &Memory, log: &ContactLog) -> (Render, f64) {
    let engine = open(&ceramic_scene(probe, ground, "output = \"acceleration\""), files);
    let full_scale = engine.levels.full_scale[0];
    (slanting::rendered(engine, log, asperity::offline::Options::default().block_frames), full_scale)
}

#[test]
fn no_stroke_passes_full_scale_and_few_need_the_limiter() {
    let mut files = Memory::new();
    let grounds = grounds(&[0.2, 0.9], 1e-3, &mut files);
    let (mut seldom, mut cells, mut below) = (0, 0, Vec::new());
    for probe in ["fingertip", "stylus", "rigid"] {
        for (name, ground) in &grounds {
            let (mut by_db, mut least_db) = (Vec::new(), Vec::new());
            for speed_m_s in SPEEDS_M_S {
                for force_n in FORCES_N {
                    let (render, full_scale) =
                        rendered(probe, ground, &files, &slanting_stroke(speed_m_s, |_| force_n));
                    let over_db = [felt_db(&render, full_scale), heard_db(&render)];
                    for (sense, over_db) in ["felt", "heard"].into_iter().zip(over_db) {
                        least_db.push(over_db);
                        if over_db < 0.0 {
                            below.push(format!(
                                "{probe}, {name}, {speed_m_s} m/s, {force_n} N: not {sense}, {over_db:.1} dB"
                            ));
                        }
                    }
                    let most = peak(&render.audio[0]).max(peak(&render.haptic[0]));
                    assert!(most <= 1.0, "{probe}, {name}, {speed_m_s} m/s, {force_n} N: peak {most}");
                    by_db.push(render.limiter_db);
                }
            }
            println!(
                "{probe:>10} {name:>8}: limiter {by_db:.1?} dB, over threshold felt and heard {least_db:.0?} dB"
            );
            cells += by_db.len();
            seldom += by_db.iter().filter(|db| **db <= SELDOM_MORE_DB).count();
        }
    }
    println!("below threshold: {below:#?}");
    assert!(below.is_empty(), "docs/lab/feel.md says that there is none");
    println!("{seldom} of {cells} strokes lose {SELDOM_MORE_DB} dB or less");
    assert!(20 * seldom >= 19 * cells);
}
